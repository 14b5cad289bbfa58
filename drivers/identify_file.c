/* SPDX-License-Identifier: BSD-3-Clause */
/* Device dynamics from a file: lines "name=value" (identify.h). */
#include <stdio.h>
#include <string.h>

#include "base/return_if_error.h"
#include "base/sized.h"
#include "dynpoint/identify.h"
#include "settings.h"
#include "text/parse_number.h"

enum { FILE_MAX = 65536, LINE_MAX_BYTES = 160 };

/* The values of one name: itself, and the ends of its interval. */
enum { VALUE, LOW, HIGH, KINDS };

struct dynamics_file {
    const char *path;
    int line; /* the present one, from 1 */
    dpt_device_error *error;
    struct dynamics dynamics;
    struct setting settings[DYNAMICS_SETTINGS];
    double value[DYNAMICS_SETTINGS][KINDS];
    int is_set[DYNAMICS_SETTINGS][KINDS];
};

static dpt_result complain(const struct dynamics_file *file, const char *reason, const char *what,
                           size_t length)
{
    return device_error(file->error, DPT_E_SYNTAX, "%.100s: line %d: '%.*s' %s", file->path,
                        file->line, (int)(length < 40 ? length : 40), what, reason);
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

static dpt_result read_line(struct dynamics_file *file, const char *text, const char *end)
{
    const char *equals = memchr(text, '=', (size_t)(end - text));
    const size_t length = (size_t)(end - text), name = equals ? (size_t)(equals - text) : length;
    int kind;
    double number;
    if (length == 0 || *text == '#')
        return DPT_OK;
    if (!equals)
        return complain(file, "is not name=value", text, length);
    const int i = find_name(file, text, name, &kind);
    if (i < 0)
        return complain(file, "is no name of a value", text, name);
    if (file->is_set[i][kind])
        return complain(file, "comes twice", text, name);
    if (parse_double(equals + 1, end, &number) != end)
        return complain(file, "is not a number", equals + 1, length - name - 1);
    if (!(number >= file->settings[i].min && (kind != VALUE || number <= file->settings[i].max)))
        return complain(file, "is out of range", text, length);
    file->is_set[i][kind] = 1;
    file->value[i][kind] = number;
    return DPT_OK;
}

/* The ends of an interval must have their value between them. */
static dpt_result check_intervals(const struct dynamics_file *file)
{
    for (int i = 0; i < DYNAMICS_SETTINGS; i++) {
        const double *value = file->value[i];
        const int *is_set = file->is_set[i];
        if (((is_set[LOW] || is_set[HIGH]) && !is_set[VALUE]) ||
            (is_set[LOW] && value[LOW] > value[VALUE]) ||
            (is_set[HIGH] && value[HIGH] < value[VALUE]))
            return device_error(file->error, DPT_E_SYNTAX, "%.100s: %s is not within its interval",
                                file->path, file->settings[i].name);
    }
    return DPT_OK;
}

static dpt_result read_lines(struct dynamics_file *file, FILE *stream)
{
    char text[LINE_MAX_BYTES];
    size_t bytes = 0;
    for (file->line = 1; fgets(text, sizeof text, stream); file->line++) {
        size_t length = strlen(text);
        const int is_whole = (length > 0 && text[length - 1] == '\n') || feof(stream);
        if (!is_whole && *text != '#')
            return complain(file, "is too long", text, length);
        for (int c = is_whole ? '\n' : 0; c != '\n' && c != EOF && bytes <= FILE_MAX; bytes++)
            c = getc(stream);
        bytes += length;
        if (bytes > FILE_MAX)
            return device_error(file->error, DPT_E_LIMIT, "%.100s: it has more than 64 KiB",
                                file->path);
        while (length > 0 && strchr(" \t\r\n", text[length - 1]))
            length--;
        DPT_TRY(read_line(file, text, text + length));
    }
    if (ferror(stream))
        return device_error(file->error, DPT_E_OPEN, "%.100s: it cannot be read", file->path);
    return check_intervals(file);
}

static void replace(const struct dynamics_file *file, dpt_device_info *info)
{
    double *const fields[DYNAMICS_SETTINGS] = { &info->mass,      &info->inertia,
                                                &info->damping,   &info->spin_damping,
                                                &info->friction,  &info->spin_friction,
                                                &info->delay,     &info->position_step,
                                                &info->angle_step };
    for (int i = 0; i < DYNAMICS_SETTINGS; i++)
        if (file->is_set[i][VALUE])
            *fields[i] = file->value[i][VALUE];
}

static dpt_result read_file(const char *path, dpt_device_info *info, dpt_device_error *error)
{
    dpt_device_info own = { .size = sizeof own };
    struct dynamics_file file = { .path = path, .error = error };
    if (!path || !info)
        return device_error(error, DPT_E_ARGUMENT, "there is no file, or no info");
    DPT_TRY(sized_read(info, sizeof own, &own, sizeof own));
    FILE *stream = fopen(path, "r");
    if (!stream)
        return device_error(error, DPT_E_OPEN, "%.100s: it cannot be opened", path);
    dynamics_settings(&file.dynamics, file.settings);
    const dpt_result result = read_lines(&file, stream);
    fclose(stream);
    DPT_TRY(result);
    replace(&file, &own);
    sized_write(info, info->size, &own, sizeof own);
    return DPT_OK;
}

dpt_result dpt_device_dynamics_read(const char *path, dpt_device_info *info,
                                    dpt_device_error *error)
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
