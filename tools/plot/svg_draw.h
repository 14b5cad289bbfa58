/* SPDX-License-Identifier: BSD-3-Clause */
/* What every chart writes into its SVG: the document's head, numbers of pixels, and text at a place. */
#ifndef DPT_TOOLS_SVG_DRAW_H
#define DPT_TOOLS_SVG_DRAW_H

#include <stdio.h>

/* Pixels: the margins of a chart, and the line of its title. */
enum { SVG_WIDTH = 760, SVG_LEFT = 76, SVG_RIGHT = 24, SVG_TITLE_AT = 28 };
enum { SVG_TITLE_SIZE = 16, SVG_TEXT_SIZE = 13, SVG_LABEL_SIZE = 12 };

/*
 * Begin a document on opaque white, with its title at the top. The title may be any bytes; it is cut at its end if it is
 * too long, but whole for a screen reader, as the description is.
 */
void svg_begin(FILE *file, int height, const char *title, const char *description);
void svg_end(FILE *file);

/* A number with one decimal at most, whatever the locale. And a command of a path with its place. */
void svg_pixel(FILE *file, double value);
void svg_place(FILE *file, char command, double x, double y);

/* Text at a place; `anchor` is start, middle or end. Begun, it needs its content and "</text>". */
void svg_begin_text(FILE *file, double x, double y, int size, const char *anchor);
void svg_text_at(FILE *file, double x, double y, int size, const char *anchor, const char *text);

/*
 * Text in an SVG. Whatever the bytes are, what is written is well-formed XML 1.0: markup is escaped, and what is no UTF-8
 * or no character of XML becomes U+FFFD.
 */

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
