/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Text in an SVG. Whatever the bytes are, what is written is well-formed XML 1.0: markup is escaped, and what is no UTF-8
 * or no character of XML becomes U+FFFD.
 */
#ifndef DPT_TOOLS_SVG_TEXT_H
#define DPT_TOOLS_SVG_TEXT_H

#include <stdio.h>

/* Write the text, ended by a zero, as the content of an element or of an attribute. */
void svg_write(FILE *file, const char *text);

/*
 * The same, cut to some `room` pixels in a sans-serif font of `size` pixels. The front is kept, or with `keeps_end` the
 * end, as of a path; three points stand for the rest. Widths are estimates: 0.56 of the size, 1 beyond ASCII.
 */
void svg_write_cut(FILE *file, const char *text, double room, double size, int keeps_end);

/* The estimated width of the text, px. */
double svg_width(const char *text, double size);

#endif
