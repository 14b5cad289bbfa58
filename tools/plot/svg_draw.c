/* SPDX-License-Identifier: BSD-3-Clause */
#include "plot/svg_draw.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>

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

enum { REPLACEMENT = 0xfffd };

/* The character at *text, which moves behind it. Of a sequence that is cut or wrong only its first byte is passed. */
static uint32_t next_character(const char **text)
{
    static const uint32_t min[] = { 0, 0x80, 0x800, 0x10000 };
    const unsigned char *at = (const unsigned char *)*text;
    const int more = at[0] < 0x80                     ? 0
                     : at[0] >= 0xc2 && at[0] <= 0xdf ? 1
                     : (at[0] & 0xf0) == 0xe0         ? 2
                     : at[0] >= 0xf0 && at[0] <= 0xf4 ? 3
                                                      : -1;
    ++*text;
    if (more < 0)
        return REPLACEMENT;
    uint32_t c = more ? at[0] & (0x3fu >> more) : at[0];
    for (int i = 1; i <= more; i++) {
        if ((at[i] & 0xc0) != 0x80)
            return REPLACEMENT;
        c = c << 6 | (at[i] & 0x3fu);
    }
    if (c < min[more] || c > 0x10ffff || (c >= 0xd800 && c <= 0xdfff))
        return REPLACEMENT;
    *text += more;
    return c;
}

/* XML has no control characters, and two others that are none. C1 and DEL are no text either. */
static int is_writable(uint32_t c)
{
    return c >= 0x20 && !(c >= 0x7f && c < 0xa0) && c != 0xfffe && c != 0xffff;
}

static void write_utf8(FILE *file, uint32_t c)
{
    if (c < 0x80) {
        fputc((int)c, file);
        return;
    }
    const int more = c < 0x800 ? 1 : c < 0x10000 ? 2 : 3;
    static const unsigned char mark[] = { 0, 0xc0, 0xe0, 0xf0 };
    fputc((int)(mark[more] | c >> (6 * more)), file);
    for (int i = more - 1; i >= 0; i--)
        fputc((int)(0x80 | (c >> (6 * i) & 0x3f)), file);
}

static void write_character(FILE *file, uint32_t c)
{
    switch (c) {
    case '<':
        fputs("&lt;", file);
        break;
    case '>':
        fputs("&gt;", file);
        break;
    case '&':
        fputs("&amp;", file);
        break;
    case '"':
        fputs("&quot;", file);
        break;
    default:
        write_utf8(file, is_writable(c) ? c : REPLACEMENT);
    }
}

static double character_width(uint32_t c, double size)
{
    return (c < 0x80 ? 0.56 : 1.0) * size;
}

void svg_write(FILE *file, const char *text)
{
    while (*text)
        write_character(file, next_character(&text));
}

double svg_width(const char *text, double size)
{
    double width = 0.0;
    while (*text)
        width += character_width(next_character(&text), size);
    return width;
}

void svg_write_cut(FILE *file, const char *text, double room, double size, int keeps_end)
{
    double width = svg_width(text, size);
    if (width <= room) {
        svg_write(file, text);
        return;
    }
    room -= svg_width("...", size);
    if (keeps_end) {
        while (*text && width > room)
            width -= character_width(next_character(&text), size);
        fputs("...", file);
        svg_write(file, text);
        return;
    }
    while (*text) {
        const uint32_t c = next_character(&text);
        room -= character_width(c, size);
        if (room < 0.0)
            break;
        write_character(file, c);
    }
    fputs("...", file);
}
