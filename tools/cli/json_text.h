/* SPDX-License-Identifier: BSD-3-Clause */
/* A text as JSON has it. */
#ifndef DPT_TOOLS_JSON_TEXT_H
#define DPT_TOOLS_JSON_TEXT_H

#include <stdio.h>

/* Write it in quotes. */
static inline void json_write_text(FILE *file, const char *text)
{
    putc('"', file);
    for (; *text; text++) {
        if (*text == '"' || *text == '\\')
            fprintf(file, "\\%c", *text);
        else if ((unsigned char)*text < 0x20)
            fprintf(file, "\\u%04x", (unsigned)*text);
        else
            putc(*text, file);
    }
    putc('"', file);
}

#endif
