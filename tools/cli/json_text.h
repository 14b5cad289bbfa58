/* SPDX-License-Identifier: BSD-3-Clause */
/* A text as JSON has it. */
#ifndef DPT_TOOLS_JSON_TEXT_H
#define DPT_TOOLS_JSON_TEXT_H

#include <stdio.h>
#include <string.h>

/* Write the first `length` bytes of it in quotes. */
static inline void json_write_part(FILE *file, const char *text, size_t length)
{
    putc('"', file);
    for (; length > 0; length--, text++) {
        if (*text == '"' || *text == '\\')
            fprintf(file, "\\%c", *text);
        else if ((unsigned char)*text < 0x20)
            fprintf(file, "\\u%04x", (unsigned)*text);
        else
            putc(*text, file);
    }
    putc('"', file);
}

/* Write it in quotes. */
static inline void json_write_text(FILE *file, const char *text)
{
    json_write_part(file, text, strlen(text));
}

#endif
