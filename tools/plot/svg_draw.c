/* SPDX-License-Identifier: BSD-3-Clause */
#include "plot/svg_draw.h"

#include <math.h>
#include <stdlib.h>

#include "plot/svg_text.h"

void svg_pixel(FILE *file, double value)
{
    const long tenths = (long)floor(value * 10.0 + 0.5);
    fprintf(file, "%s%ld", tenths < 0 ? "-" : "", labs(tenths) / 10);
    if (tenths % 10)
        fprintf(file, ".%ld", labs(tenths) % 10);
}

void svg_place(FILE *file, char command, double x, double y)
{
    fputc(command, file);
    svg_pixel(file, x);
    fputc(' ', file);
    svg_pixel(file, y);
}

void svg_begin_text(FILE *file, double x, double y, int size, const char *anchor)
{
    fputs("<text x=\"", file);
    svg_pixel(file, x);
    fputs("\" y=\"", file);
    svg_pixel(file, y);
    fprintf(file, "\" font-size=\"%d\" text-anchor=\"%s\">", size, anchor);
}

void svg_text_at(FILE *file, double x, double y, int size, const char *anchor, const char *text)
{
    svg_begin_text(file, x, y, size, anchor);
    svg_write(file, text);
    fputs("</text>\n", file);
}

void svg_begin(FILE *file, int height, const char *title, const char *description)
{
    fprintf(file,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" "
            "viewBox=\"0 0 %d %d\" role=\"img\" font-family=\"sans-serif\" fill=\"#222\">\n<title>",
            SVG_WIDTH, height, SVG_WIDTH, height);
    svg_write(file, title);
    fputs("</title>\n<desc>", file);
    svg_write(file, description);
    fprintf(file, "</desc>\n<rect width=\"%d\" height=\"%d\" fill=\"#fff\"/>\n", SVG_WIDTH, height);
    fprintf(file, "<text x=\"%d\" y=\"%d\" font-size=\"%d\" font-weight=\"bold\">", SVG_LEFT, SVG_TITLE_AT,
            SVG_TITLE_SIZE);
    svg_write_cut(file, title, SVG_WIDTH - SVG_RIGHT - SVG_LEFT, SVG_TITLE_SIZE * 1.05, 0);
    fputs("</text>\n", file);
}

void svg_end(FILE *file)
{
    fputs("</svg>\n", file);
}
