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

static dpt_result set_one(const char *at, const char *end, const struct setting *settings,
                          size_t count, dpt_device_error *error)
{
    const char *equals = memchr(at, '=', (size_t)(end - at));
    size_t length = (size_t)((equals ? equals : end) - at);
    for (size_t i = 0; i < count; i++) {
        const struct setting *setting = &settings[i];
        if (!equals || strlen(setting->name) != length || memcmp(setting->name, at, length))
            continue;
        const char *value = equals + 1;
        size_t bytes = (size_t)(end - value);
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
    return device_error(error, DPT_E_SETTING, "no setting '%.*s'", (int)length, at);
}

dpt_result settings_read(const char *where, char *place, size_t room,
                         const struct setting *settings, size_t count, dpt_device_error *error)
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
        dpt_result result = set_one(at, end, settings, count, error);
        if (result != DPT_OK)
            return result;
        at = end;
    }
    return DPT_OK;
}
