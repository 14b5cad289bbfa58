/* SPDX-License-Identifier: BSD-3-Clause */
#include "settings.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "text/parse_number.h"

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

static dpt_result set(const struct setting *setting, const char *value, const char *end,
                      dpt_device_error *error)
{
    const size_t bytes = (size_t)(end - value);
    if (setting->text) {
        if (bytes >= setting->room)
            return device_error(error, DPT_E_SETTING, "%s is too long", setting->name);
        memcpy(setting->text, value, bytes);
        setting->text[bytes] = '\0';
        return DPT_OK;
    }
    double number;
    if (parse_double(value, end, &number) != end)
        return device_error(error, DPT_E_SETTING, "%s: '%.*s' is not a number", setting->name,
                            (int)bytes, value);
    if (!(number >= setting->least && number <= setting->most))
        return device_error(error, DPT_E_SETTING, "%s is not within %g and %g", setting->name,
                            setting->least, setting->most);
    *setting->number = number;
    return DPT_OK;
}

static const struct setting *find(const struct setting *settings, size_t count, const char *name,
                                  size_t length)
{
    for (size_t i = 0; i < count; i++)
        if (strlen(settings[i].name) == length && !memcmp(settings[i].name, name, length))
            return &settings[i];
    return NULL;
}

static dpt_result set_one(const char *at, const char *end, const struct setting *settings,
                          size_t count, struct dynamics *dynamics, dpt_device_error *error)
{
    const char *equals = memchr(at, '=', (size_t)(end - at));
    const size_t length = (size_t)((equals ? equals : end) - at);
    const struct setting *setting = equals ? find(settings, count, at, length) : NULL;
    if (equals && !setting && dynamics) {
        const struct setting common[] = {
            { .name = "mass", .number = &dynamics->mass, .most = 100.0 },
            { .name = "inertia", .number = &dynamics->inertia, .most = 10.0 },
            { .name = "damping", .number = &dynamics->damping, .most = 1e3 },
            { .name = "spin_damping", .number = &dynamics->spin_damping, .most = 10.0 },
            { .name = "friction", .number = &dynamics->friction, .most = 100.0 },
            { .name = "spin_friction", .number = &dynamics->spin_friction, .most = 10.0 },
            { .name = "delay", .number = &dynamics->delay, .most = 1.0 },
            { .name = "position_step", .number = &dynamics->position_step, .most = 0.01 },
            { .name = "angle_step", .number = &dynamics->angle_step, .most = 0.1 },
        };
        setting = find(common, sizeof common / sizeof *common, at, length);
        if (setting)
            return set(setting, equals + 1, end, error);
    }
    if (setting)
        return set(setting, equals + 1, end, error);
    return device_error(error, DPT_E_SETTING, "no setting '%.*s'", (int)length, at);
}

static void tell(double named, double *told)
{
    if (named > 0.0)
        *told = named;
}

void dynamics_tell(const struct dynamics *dynamics, dpt_device_info *info)
{
    tell(dynamics->mass, &info->mass);
    tell(dynamics->inertia, &info->inertia);
    tell(dynamics->damping, &info->damping);
    tell(dynamics->spin_damping, &info->spin_damping);
    tell(dynamics->friction, &info->friction);
    tell(dynamics->spin_friction, &info->spin_friction);
    tell(dynamics->delay, &info->delay);
    tell(dynamics->position_step, &info->position_step);
    tell(dynamics->angle_step, &info->angle_step);
}

dpt_result settings_read(const char *where, char *place, size_t room,
                         const struct setting *settings, size_t count, struct dynamics *dynamics,
                         dpt_device_error *error)
{
    where = where ? where : "";
    size_t length = strcspn(where, "?");
    if (length >= room)
        return device_error(error, DPT_E_SETTING, "'%.60s...' is too long", where);
    memcpy(place, where, length);
    place[length] = '\0';
    const char *at = where + length;
    while (*at) {
        at++;
        const char *end = at + strcspn(at, "&");
        dpt_result result = set_one(at, end, settings, count, dynamics, error);
        if (result != DPT_OK)
            return result;
        at = end;
    }
    return DPT_OK;
}
