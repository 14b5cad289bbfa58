/* SPDX-License-Identifier: BSD-3-Clause */
#include "scene/host_error.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

dpt_result host_refuse(dpt_host_error *error, dpt_result code, const char *format, ...)
{
    va_list arguments;
    error->code = code;
    va_start(arguments, format);
    vsnprintf(error->text, sizeof error->text, format, arguments);
    va_end(arguments);
    return code;
}

void host_note(dpt_host_error *error, const char *format, ...)
{
    va_list arguments;
    const size_t used = strlen(error->text);
    const int more = used ? snprintf(error->text + used, sizeof error->text - used, "; ") : 0;
    const size_t at = used + (size_t)(more > 0 ? more : 0);
    if (at >= sizeof error->text)
        return;
    va_start(arguments, format);
    vsnprintf(error->text + at, sizeof error->text - at, format, arguments);
    va_end(arguments);
}
