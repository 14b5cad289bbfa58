/* SPDX-License-Identifier: BSD-3-Clause */
#include "settings_file.h"

#include <stdio.h>
#include <string.h>

#include "base/return_if_error.h"
#include "settings.h"

enum { FILE_MAX = 65536, LINE_ROOM = 512 };

static dpt_result take_line(const char *path, int number, const char *text, size_t length, settings_line_fn *take,
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
        const size_t length = strlen(text);
        const int is_whole = (length > 0 && text[length - 1] == '\n') || feof(stream);
        if (!is_whole && *text != '#')
            return device_error(error, DPT_E_SYNTAX, "%.100s: line %d: '%.40s' is too long", path, number, text);
        for (int c = is_whole ? '\n' : 0; c != '\n' && c != EOF && bytes <= FILE_MAX; bytes++)
            c = getc(stream);
        bytes += length;
        if (bytes > FILE_MAX)
            return device_error(error, DPT_E_LIMIT, "%.100s: it has more than 64 KiB", path);
        DPT_TRY(take_line(path, number, text, length, take, user, error));
    }
    if (ferror(stream))
        return device_error(error, DPT_E_OPEN, "%.100s: it cannot be read", path);
    return DPT_OK;
}

dpt_result settings_file_read(const char *path, settings_line_fn *take, void *user, dpt_device_error *error)
{
    FILE *stream = fopen(path, "r");
    if (!stream)
        return device_error(error, DPT_E_OPEN, "%.100s: it cannot be opened", path);
    const dpt_result result = read_lines(path, stream, take, user, error);
    fclose(stream);
    return result;
}
