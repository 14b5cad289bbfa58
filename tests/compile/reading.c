/* SPDX-License-Identifier: BSD-3-Clause */
#include "compile/reading.h"

void begin_reading(reading *r, const dpt_compile_def *def)
{
    memset(&r->diag, 0, sizeof r->diag);
    compile_context_init(&r->context, def, &r->diag);
    soup_init(&r->soup, &r->context);
}

void read_bytes(reading *r, uint32_t format, const void *bytes, size_t size, const dpt_compile_def *def)
{
    unsigned char *copy = malloc(size + (size == 0));
    begin_reading(r, def);
    memcpy(copy, bytes, size);
    r->result = read_source(&r->soup, format, copy, size);
    if (r->result == DPT_OK)
        r->result = soup_check_corners(&r->soup);
    free(copy);
}

void read_string(reading *r, uint32_t format, const char *text)
{
    read_bytes(r, format, text, strlen(text), NULL);
}

void fill_text(char *text, char c, size_t count)
{
    memset(text, c, count);
    text[count] = 0;
}
