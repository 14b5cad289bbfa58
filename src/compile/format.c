/* SPDX-License-Identifier: BSD-3-Clause */
/* Find out which format a file is in, and read it (soup.h). */
#include <string.h>

#include "arm/arm_format.h"
#include "compile/text.h"

/* Do the bytes begin with the whole magic of a compiled mesh or arm? */
static int is_compiled(const unsigned char *bytes, size_t size)
{
    return size >= 8 && (memcmp(bytes, MESH_MAGIC, 8) == 0 || memcmp(bytes, ARM_MAGIC, 8) == 0);
}

static int is_ply(source_text text)
{
    source_word word;
    return text_next_word(&text, &word) && word_is(&word, "ply") && !text_next_word(&text, &word);
}

/* OFF with any prefix of the format, including those that the reader then refuses by name. */
static int is_off(source_text text)
{
    source_word word;
    text.has_comments = 1;
    if (!text_seek_word(&text) || !text_next_word(&text, &word))
        return 0;
    while (word.begin < word.end && memchr("STCN4n", *word.begin, 6))
        word.begin++;
    if (word.end - word.begin < 3 || memcmp(word.begin, "OFF", 3) != 0)
        return 0;
    const char *after = word.begin + 3;
    return after == word.end || (*after >= '0' && *after <= '9');
}

static int is_binary_stl(const unsigned char *bytes, size_t size)
{
    if (size < 84)
        return 0;
    uint64_t count =
        (uint64_t)bytes[80] | (uint64_t)bytes[81] << 8 | (uint64_t)bytes[82] << 16 | (uint64_t)bytes[83] << 24;
    return size == 84 + 50 * count;
}

static int is_ascii_stl(source_text text)
{
    source_word word;
    return text_seek_word(&text) && text_next_word(&text, &word) && word_is_any_case(&word, "solid") &&
           text_next_line(&text) && text_seek_word(&text) && text_next_word(&text, &word) &&
           word_is_any_case(&word, "facet");
}

static int has_vertex_line(source_text text)
{
    source_word word;
    do {
        if (text_next_word(&text, &word) && word_is(&word, "v") && text_next_word(&text, &word))
            return 1;
    } while (text_next_line(&text));
    return 0;
}

static uint32_t format_of_extension(const char *path)
{
    static const struct {
        const char *ending;
        uint32_t format;
    } extensions[] = {
        { "obj", DPT_FORMAT_OBJ }, { "stl", DPT_FORMAT_STL }, { "ply", DPT_FORMAT_PLY }, { "off", DPT_FORMAT_OFF }
    };
    const char *dot = path ? strrchr(path, '.') : NULL;
    if (!dot)
        return DPT_FORMAT_AUTO;
    source_word word = { dot + 1, dot + strlen(dot) };
    for (size_t i = 0; i < sizeof extensions / sizeof extensions[0]; i++) {
        if (word_is_any_case(&word, extensions[i].ending))
            return extensions[i].format;
    }
    return DPT_FORMAT_AUTO;
}

uint32_t source_format(const char *path, const unsigned char *bytes, size_t size)
{
    source_text text;
    text_begin(&text, NULL, bytes, size);
    if (is_ply(text))
        return DPT_FORMAT_PLY;
    if (is_off(text))
        return DPT_FORMAT_OFF;
    if (is_binary_stl(bytes, size) || is_ascii_stl(text))
        return DPT_FORMAT_STL;
    if (is_compiled(bytes, size))
        return DPT_FORMAT_AUTO;
    uint32_t format = format_of_extension(path);
    if (format == DPT_FORMAT_AUTO && has_vertex_line(text))
        return DPT_FORMAT_OBJ;
    return format;
}

dpt_result read_source(soup *source, uint32_t format, const unsigned char *bytes, size_t size)
{
    if (format != DPT_FORMAT_STL && is_compiled(bytes, size))
        return soup_fail(source, DPT_E_FORMAT, (source_location){ 0, 0 }, "this is compiled already: a .dpa file");
    switch (format) {
    case DPT_FORMAT_OBJ:
        return read_obj(source, bytes, size);
    case DPT_FORMAT_STL:
        return read_stl(source, bytes, size);
    case DPT_FORMAT_PLY:
        return read_ply(source, bytes, size);
    case DPT_FORMAT_OFF:
        return read_off(source, bytes, size);
    default:
        if (!size)
            return soup_fail(source, DPT_E_EMPTY, (source_location){ 0, 0 }, "the file is empty");
        return soup_fail(source, DPT_E_FORMAT, (source_location){ 0, 0 }, "neither OBJ, STL, PLY nor OFF");
    }
}
