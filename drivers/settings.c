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

static dpt_result set_value(const struct setting *setting, const char *value, const char *end,
                            dpt_device_error *error)
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
        return device_error(error, DPT_E_SETTING, "%s: '%.*s' is not a number", setting->name,
                            (int)bytes, value);
    if (!(number >= setting->min && number <= setting->max))
        return device_error(error, DPT_E_SETTING, "%s is not within %g and %g", setting->name,
                            setting->min, setting->max);
    *setting->number = number;
    return DPT_OK;
}

static const struct setting *find_setting(const struct setting *settings, size_t count,
                                          const char *name, size_t length)
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

static dpt_result set_one(const char *at, const char *end, const struct setting *settings,
                          size_t count, struct dynamics *dynamics, dpt_device_error *error)
{
    const char *equals = memchr(at, '=', (size_t)(end - at));
    const size_t length = (size_t)((equals ? equals : end) - at);
    const struct setting *setting = equals ? find_setting(settings, count, at, length) : NULL;
    struct setting common[DYNAMICS_SETTINGS];
    if (equals && !setting && dynamics) {
        dynamics_settings(dynamics, common);
        setting = find_setting(common, DYNAMICS_SETTINGS, at, length);
    }
    if (setting)
        return set_value(setting, equals + 1, end, error);
    return device_error(error, DPT_E_SETTING, "no setting '%.*s'", (int)length, at);
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

dpt_result settings_read(const char *where, char *address, size_t address_bytes,
                         const struct setting *settings, size_t count, struct dynamics *dynamics,
                         dpt_device_error *error)
{
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
        dpt_result result = set_one(at, end, settings, count, dynamics, error);
        if (result != DPT_OK)
            return result;
        at = end;
    }
    return DPT_OK;
}
