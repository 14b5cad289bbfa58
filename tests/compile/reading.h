/* SPDX-License-Identifier: BSD-3-Clause */
/* One reading of a mesh file from memory: the soup of triangles that came of it, and what the reader said. */
#ifndef DPT_TESTS_READING_H
#define DPT_TESTS_READING_H

#include "compile/soup.h"
#include "lib/check.h"

/* soup_free(&reading.soup) when done. */
typedef struct reading {
    struct compile_context context;
    soup soup;
    dpt_diag diag;
    dpt_result result;
} reading;

/* An empty soup, and no diag. */
void begin_reading(reading *r, const dpt_compile_def *def);

/* Read a copy that ends where its block of memory ends, so that a sanitizer sees a byte too far. */
void read_bytes(reading *r, uint32_t format, const void *bytes, size_t size, const dpt_compile_def *def);

/* The same of a string. */
void read_string(reading *r, uint32_t format, const char *text);

/* A string of `count` times c. */
void fill_text(char *text, char c, size_t count);

#endif
