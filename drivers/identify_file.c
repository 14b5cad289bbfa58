/* SPDX-License-Identifier: BSD-3-Clause */
/* Device dynamics from a file: lines "name=value" (identify.h). */
#include <string.h>

#include "base/return_if_error.h"
#include "base/sized.h"
#include "dynpoint/identify.h"
#include "settings.h"
#include "settings_file.h"
#include "text/parse_number.h"

/* The values of one name: itself, and the ends of its interval. */
enum { VALUE, LOW, HIGH, KINDS };

struct dynamics_file {
    const char *path;
    struct dynamics dynamics;
    struct setting settings[DYNAMICS_SETTINGS];
    double value[DYNAMICS_SETTINGS][KINDS];
    int is_set[DYNAMICS_SETTINGS][KINDS];
};

static dpt_result complain(const struct settings_line *line, dpt_device_error *error, const char *what, size_t length,
                           const char *reason)
{
    return device_error(error, DPT_E_SYNTAX, "%.100s: line %d: '%.*s' %s", line->path, line->number,
                        (int)(length < 40 ? length : 40), what, reason);
}

/* The setting of a name that may end in _low or _high; -1: none. */
static int find_name(const struct dynamics_file *file, const char *name, size_t length, int *kind)
{
    static const char *const ends[KINDS] = { "", "_low", "_high" };
    for (int i = 0; i < DYNAMICS_SETTINGS; i++)
        for (*kind = 0; *kind < KINDS; ++*kind) {
            const size_t own = strlen(file->settings[i].name), more = strlen(ends[*kind]);
            if (length == own + more && !memcmp(name, file->settings[i].name, own) &&
                !memcmp(name + own, ends[*kind], more))
                return i;
        }
    return -1;
}

static dpt_result take_line(void *user, const struct settings_line *line, dpt_device_error *error)
{
    struct dynamics_file *file = user;
    const char *text = line->text;
    const size_t length = (size_t)(line->end - text);
    const size_t name = line->equals ? (size_t)(line->equals - text) : length;
    int kind;
    double number;
    if (!line->equals)
        return complain(line, error, text, length, "is not name=value");
    const int i = find_name(file, text, name, &kind);
    if (i < 0)
        return complain(line, error, text, name, "is no name of a value");
    if (file->is_set[i][kind])
        return complain(line, error, text, name, "comes twice");
    if (parse_double(line->equals + 1, line->end, &number) != line->end)
        return complain(line, error, line->equals + 1, length - name - 1, "is not a number");
    if (!(number >= file->settings[i].min && (kind != VALUE || number <= file->settings[i].max)))
        return complain(line, error, text, length, "is out of range");
    file->is_set[i][kind] = 1;
    file->value[i][kind] = number;
    return DPT_OK;
}

/* The ends of an interval must have their value between them. */
static dpt_result check_intervals(const struct dynamics_file *file, dpt_device_error *error)
{
    for (int i = 0; i < DYNAMICS_SETTINGS; i++) {
        const double *value = file->value[i];
        const int *is_set = file->is_set[i];
        if (((is_set[LOW] || is_set[HIGH]) && !is_set[VALUE]) || (is_set[LOW] && value[LOW] > value[VALUE]) ||
            (is_set[HIGH] && value[HIGH] < value[VALUE]))
            return device_error(error, DPT_E_SYNTAX, "%.100s: %s is not within its interval", file->path,
                                file->settings[i].name);
    }
    return DPT_OK;
}

static void replace(const struct dynamics_file *file, dpt_device_info *info)
{
    double *const fields[DYNAMICS_SETTINGS] = { &info->mass,         &info->inertia,       &info->damping,
                                                &info->spin_damping, &info->friction,      &info->spin_friction,
                                                &info->delay,        &info->position_step, &info->angle_step };
    for (int i = 0; i < DYNAMICS_SETTINGS; i++)
        if (file->is_set[i][VALUE])
            *fields[i] = file->value[i][VALUE];
}

static dpt_result read_file(const char *path, dpt_device_info *info, dpt_device_error *error)
{
    dpt_device_info own = { .size = sizeof own };
    struct dynamics_file file = { .path = path };
    if (!path || !info)
        return device_error(error, DPT_E_ARGUMENT, "there is no file, or no info");
    DPT_TRY(sized_read(info, sizeof own, &own, sizeof own));
    dynamics_settings(&file.dynamics, file.settings);
    DPT_TRY(settings_file_read(path, take_line, &file, error));
    DPT_TRY(check_intervals(&file, error));
    replace(&file, &own);
    sized_write(info, info->size, &own, sizeof own);
    return DPT_OK;
}

dpt_result dpt_device_dynamics_read(const char *path, dpt_device_info *info, dpt_device_error *error)
{
    dpt_device_error own = { .size = sizeof own };
    if (error)
        DPT_TRY(sized_check(error, sizeof *error, 0));
    own.code = read_file(path, info, &own);
    if (own.code != DPT_OK && !own.text[0])
        device_error(&own, own.code, "%s", dpt_result_text(own.code));
    if (error)
        sized_write(error, error->size, &own, sizeof own);
    return own.code;
}
