/* SPDX-License-Identifier: BSD-3-Clause */
#include "settings.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/return_if_error.h"
#include "text/near_word.h"
#include "text/open_file.h"
#include "text/parse_number.h"

/* The setting that every driver has: a file with more of them. */
#define FILE_SETTING "settings"

enum { PATH_ROOM = 1024 };

dpt_result device_error(dpt_device_error *error, dpt_result code, const char *format, ...)
{
    if (error) {
        va_list arguments;
        va_start(arguments, format);
        vsnprintf(error->text, sizeof error->text, format, arguments);
        va_end(arguments);
        error->code = code;
    }
    return code;
}

dpt_result device_error_meant(dpt_device_error *error, dpt_result code, const char *word)
{
    if (error && word) {
        const size_t length = strlen(error->text);
        snprintf(error->text + length, sizeof error->text - length, "; did you mean %s?", word);
    }
    return code;
}

static dpt_result set_value(const struct setting *setting, const char *value, const char *end, dpt_device_error *error)
{
    const size_t bytes = (size_t)(end - value);
    if (setting->text) {
        if (bytes >= setting->text_bytes)
            return device_error(error, DPT_E_SETTING, "%s is too long", setting->name);
        memcpy(setting->text, value, bytes);
        setting->text[bytes] = '\0';
        return DPT_OK;
    }
    double number;
    if (parse_double(value, end, &number) != end)
        return device_error(error, DPT_E_SETTING, "%s: '%.*s' is not a number", setting->name, (int)bytes, value);
    if (!(number >= setting->min && number <= setting->max))
        return device_error(error, DPT_E_SETTING, "%s is not within %g and %g", setting->name, setting->min,
                            setting->max);
    *setting->number = number;
    return DPT_OK;
}

static const struct setting *find_setting(const struct setting *settings, size_t count, const char *name, size_t length)
{
    for (size_t i = 0; i < count; i++)
        if (strlen(settings[i].name) == length && !memcmp(settings[i].name, name, length))
            return &settings[i];
    return NULL;
}

void dynamics_settings(struct dynamics *dynamics, struct setting settings[DYNAMICS_SETTINGS])
{
    const struct setting all[DYNAMICS_SETTINGS] = {
        { .name = "mass", .number = &dynamics->mass, .max = 100.0 },
        { .name = "inertia", .number = &dynamics->inertia, .max = 10.0 },
        { .name = "damping", .number = &dynamics->damping, .max = 1e3 },
        { .name = "spin_damping", .number = &dynamics->spin_damping, .max = 10.0 },
        { .name = "friction", .number = &dynamics->friction, .max = 100.0 },
        { .name = "spin_friction", .number = &dynamics->spin_friction, .max = 10.0 },
        { .name = "delay", .number = &dynamics->delay, .max = 1.0 },
        { .name = "position_step", .number = &dynamics->position_step, .max = 0.01 },
        { .name = "angle_step", .number = &dynamics->angle_step, .max = 0.1 },
    };
    memcpy(settings, all, sizeof all);
}

/* The settings that a driver knows. */
struct known_settings {
    const struct setting *settings;
    size_t count;
    struct dynamics *dynamics; /* NULL: the driver has such settings of its own */
};

static dpt_result set_one(const struct known_settings *known, const char *at, const char *end, dpt_device_error *error)
{
    const char *equals = memchr(at, '=', (size_t)(end - at));
    const size_t length = (size_t)((equals ? equals : end) - at);
    const struct setting *setting = equals ? find_setting(known->settings, known->count, at, length) : NULL;
    struct setting common[DYNAMICS_SETTINGS];
    if (known->dynamics)
        dynamics_settings(known->dynamics, common);
    if (equals && !setting && known->dynamics)
        setting = find_setting(common, DYNAMICS_SETTINGS, at, length);
    if (setting)
        return set_value(setting, equals + 1, end, error);
    struct near_word near = near_word_begin(at, length);
    for (size_t i = 0; i < known->count; i++)
        near_word_try(&near, known->settings[i].name);
    for (size_t i = 0; known->dynamics && i < DYNAMICS_SETTINGS; i++)
        near_word_try(&near, common[i].name);
    if (near.word && !near.distance)
        return device_error(error, DPT_E_SETTING, "the setting '%s' needs a value: %s=...", near.word, near.word);
    device_error(error, DPT_E_SETTING, "no setting '%.*s'", (int)length, at);
    return device_error_meant(error, DPT_E_SETTING, near.word);
}

static void override(double setting, double *reported)
{
    if (setting > 0.0)
        *reported = setting;
}

void dynamics_override(const struct dynamics *dynamics, dpt_device_info *info)
{
    override(dynamics->mass, &info->mass);
    override(dynamics->inertia, &info->inertia);
    override(dynamics->damping, &info->damping);
    override(dynamics->spin_damping, &info->spin_damping);
    override(dynamics->friction, &info->friction);
    override(dynamics->spin_friction, &info->spin_friction);
    override(dynamics->delay, &info->delay);
    override(dynamics->position_step, &info->position_step);
    override(dynamics->angle_step, &info->angle_step);
}

static int is_name(const char *at, const char *end, const char *name)
{
    const size_t length = strlen(name);
    return (size_t)(end - at) > length && !memcmp(at, name, length) && at[length] == '=';
}

/* The ends of an interval, as an identification writes them beside a value. */
static int is_interval(const struct settings_line *line)
{
    const char *name = line->text, *end = line->equals;
    return end && ((end - name > 4 && !memcmp(end - 4, "_low", 4)) || (end - name > 5 && !memcmp(end - 5, "_high", 5)));
}

static dpt_result take_line(void *user, const struct settings_line *line, dpt_device_error *error)
{
    dpt_device_error own = { .size = sizeof own };
    if (is_interval(line))
        return DPT_OK;
    const dpt_result result = set_one(user, line->text, line->end, &own);
    if (result == DPT_OK)
        return result;
    return device_error(error, result, "%.100s: line %d: %.100s", line->path, line->number, own.text);
}

/* settings=FILE: all of its lines. */
static dpt_result set_all(struct known_settings *known, const char *value, const char *end, dpt_device_error *error)
{
    char path[PATH_ROOM];
    const size_t length = (size_t)(end - value);
    if (length >= sizeof path)
        return device_error(error, DPT_E_SETTING, "settings: '%.60s...' is too long", value);
    memcpy(path, value, length);
    path[length] = '\0';
    return settings_file_read(path, take_line, known, error);
}

dpt_result settings_read(const char *where, char *address, size_t address_bytes, const struct setting *settings,
                         size_t count, struct dynamics *dynamics, dpt_device_error *error)
{
    struct known_settings known = { settings, count, dynamics };
    where = where ? where : "";
    size_t length = strcspn(where, "?");
    if (length >= address_bytes)
        return device_error(error, DPT_E_SETTING, "'%.60s...' is too long", where);
    memcpy(address, where, length);
    address[length] = '\0';
    const char *at = where + length;
    while (*at) {
        at++;
        const char *end = at + strcspn(at, "&");
        DPT_TRY(is_name(at, end, FILE_SETTING) ? set_all(&known, at + sizeof FILE_SETTING, end, error)
                                               : set_one(&known, at, end, error));
        at = end;
    }
    return DPT_OK;
}

/* ---- lines of a file ---- */

enum { FILE_MAX = 65536, LINE_ROOM = 512 };

static dpt_result split_line(const char *path, int number, const char *text, size_t length, settings_line_fn *take,
                             void *user, dpt_device_error *error)
{
    while (length > 0 && strchr(" \t\r\n", text[length - 1]))
        length--;
    if (length == 0 || *text == '#')
        return DPT_OK;
    const struct settings_line line = {
        .path = path, .number = number, .text = text, .end = text + length, .equals = memchr(text, '=', length)
    };
    return take(user, &line, error);
}

static dpt_result read_lines(const char *path, FILE *stream, settings_line_fn *take, void *user,
                             dpt_device_error *error)
{
    char text[LINE_ROOM];
    size_t bytes = 0;
    for (int number = 1; fgets(text, sizeof text, stream); number++) {
        if (number == 1 && strncmp(text, "\xef\xbb\xbf", 3) == 0) /* a byte order mark */
            memmove(text, text + 3, strlen(text + 3) + 1);
        const size_t length = strlen(text);
        const int is_whole = (length > 0 && text[length - 1] == '\n') || feof(stream);
        if (!is_whole && *text != '#')
            return device_error(error, DPT_E_SYNTAX, "%.100s: line %d: '%.40s' is too long", path, number, text);
        for (int c = is_whole ? '\n' : 0; c != '\n' && c != EOF && bytes <= FILE_MAX; bytes++)
            c = getc(stream);
        bytes += length;
        if (bytes > FILE_MAX)
            return device_error(error, DPT_E_LIMIT, "%.100s: it has more than 64 KiB", path);
        DPT_TRY(split_line(path, number, text, length, take, user, error));
    }
    if (ferror(stream))
        return device_error(error, DPT_E_OPEN, "%.100s: it cannot be read", path);
    return DPT_OK;
}

dpt_result settings_file_read(const char *path, settings_line_fn *take, void *user, dpt_device_error *error)
{
    FILE *stream = open_file(path, "r");
    if (!stream)
        return device_error(error, DPT_E_OPEN, "%.100s: it cannot be opened", path);
    const dpt_result result = read_lines(path, stream, take, user, error);
    fclose(stream);
    return result;
}
