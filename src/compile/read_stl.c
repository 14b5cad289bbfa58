/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * STL, binary and ASCII. Every facet has three vertices of its own; normals are skipped. The length of the file tells
 * binary from ASCII, because a binary file may begin with "solid" too.
 */
#include <inttypes.h>
#include <string.h>

#include "base/return_if_error.h"
#include "compile/text.h"

enum { HEADER_BYTES = 84, FACET_BYTES = 50, NORMAL_BYTES = 12, VERTEX_BYTES = 12 };

static uint32_t load_u32(const unsigned char *bytes)
{
    return (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

static double load_float(const unsigned char *bytes)
{
    uint32_t bits = load_u32(bytes);
    float value;
    memcpy(&value, &bits, sizeof value);
    return (double)value;
}

/* Add a triangle of the last three vertices. */
static dpt_result add_triangle(soup *source, source_location location)
{
    uint32_t next = (uint32_t)source->vertex_count;
    const uint32_t corners[3] = { next - 3, next - 2, next - 1 };
    return soup_add_polygon(source, corners, 3, location);
}

static dpt_result check_length(soup *source, const unsigned char *bytes, size_t size)
{
    if (size < HEADER_BYTES)
        return soup_fail(source, DPT_E_TRUNCATED, (source_location){ 0, size },
                         "neither ASCII STL nor the %d bytes that a binary one begins with", HEADER_BYTES);
    uint64_t announced = load_u32(bytes + 80), held = (size - HEADER_BYTES) / FACET_BYTES;
    uint64_t length = HEADER_BYTES + FACET_BYTES * announced;
    if (size < length)
        return soup_fail(source, DPT_E_TRUNCATED, (source_location){ 0, size },
                         "binary STL announces %" PRIu64 " triangles and holds %" PRIu64, announced, held);
    if (size > length)
        return soup_fail(source, DPT_E_TRAILING, (source_location){ 0, length },
                         "%" PRIu64 " bytes follow the %" PRIu64 " triangles that binary STL announces", size - length,
                         announced);
    return DPT_OK;
}

static dpt_result read_binary_facet(soup *source, const unsigned char *bytes, size_t offset)
{
    for (int i = 0; i < 3; i++) {
        size_t byte = offset + NORMAL_BYTES + VERTEX_BYTES * (size_t)i;
        const unsigned char *at = bytes + byte;
        DPT_TRY(soup_add_vertex(source, load_float(at), load_float(at + 4), load_float(at + 8),
                                (source_location){ 0, byte }));
    }
    return add_triangle(source, (source_location){ 0, offset });
}

static dpt_result read_binary(soup *source, const unsigned char *bytes, size_t size)
{
    DPT_TRY(check_length(source, bytes, size));
    size_t facets = (size - HEADER_BYTES) / FACET_BYTES;
    for (size_t i = 0; i < facets; i++) {
        if (i % PROGRESS_STRIDE == 0)
            DPT_TRY(soup_report_progress(source, "read", (double)i / (double)facets));
        DPT_TRY(read_binary_facet(source, bytes, HEADER_BYTES + FACET_BYTES * i));
    }
    return DPT_OK;
}

static dpt_result next_keyword(source_text *text, source_word *word, const char *wanted)
{
    if (text_seek_word(text) && text_next_word(text, word))
        return DPT_OK;
    return soup_fail(text->source, DPT_E_TRUNCATED, text_location(text), "the file ends where '%s' should be", wanted);
}

static dpt_result refuse_keyword(source_text *text, const source_word *word, const char *wanted)
{
    char printable[WORD_SHOWN];
    return soup_fail(text->source, DPT_E_SYNTAX, text_location(text), "'%s' where '%s' should be",
                     word_printable(word, printable), wanted);
}

static dpt_result expect_keyword(source_text *text, const char *keyword)
{
    source_word word;
    DPT_TRY(next_keyword(text, &word, keyword));
    return word_is_any_case(&word, keyword) ? DPT_OK : refuse_keyword(text, &word, keyword);
}

/* Is `first` "end" and `what` in one word, or "end" with the word `what` next? If so, read past that word. */
static int is_end_of(source_text *text, const source_word *first, const char *what)
{
    source_word word = { first->begin, first->begin + 3 };
    if (first->end - first->begin < 3 || !word_is_any_case(&word, "end"))
        return 0;
    word.begin = first->begin + 3;
    word.end = first->end;
    const char *restart = text->at;
    if (word.begin == word.end && !text_next_word(text, &word))
        return 0;
    if (word_is_any_case(&word, what))
        return 1;
    text->at = restart;
    return 0;
}

/* Read "normal", three words of any kind, "outer", "loop". */
static dpt_result read_facet_head(source_text *text)
{
    source_word word;
    DPT_TRY(expect_keyword(text, "normal"));
    for (int i = 0; i < 3; i++)
        DPT_TRY(next_keyword(text, &word, "outer"));
    DPT_TRY(expect_keyword(text, "outer"));
    return expect_keyword(text, "loop");
}

static dpt_result read_loop(source_text *text)
{
    source_word word;
    for (int vertices = 0;; vertices++) {
        DPT_TRY(next_keyword(text, &word, "vertex"));
        int is_end = is_end_of(text, &word, "loop");
        if (!is_end && !word_is_any_case(&word, "vertex"))
            return refuse_keyword(text, &word, "vertex");
        if (is_end != (vertices == 3))
            return soup_fail(text->source, DPT_E_SYNTAX, text_location(text), "a facet of %s vertices",
                             is_end ? "fewer than three" : "more than three");
        if (is_end)
            return DPT_OK;
        DPT_TRY(text_read_vertex(text));
    }
}

static dpt_result read_facet(source_text *text)
{
    source_location location = text_location(text);
    source_word word;
    DPT_TRY(read_facet_head(text));
    DPT_TRY(read_loop(text));
    DPT_TRY(next_keyword(text, &word, "endfacet"));
    if (!is_end_of(text, &word, "facet"))
        return refuse_keyword(text, &word, "endfacet");
    return add_triangle(text->source, location);
}

/* Read a solid up to its end. "solid" was read; the rest of that line is its name. */
static dpt_result read_solid(source_text *text, const char *begin)
{
    text_next_line(text);
    for (;;) {
        source_word word;
        DPT_TRY(next_keyword(text, &word, "endsolid"));
        if (is_end_of(text, &word, "solid"))
            return DPT_OK;
        if (!word_is_any_case(&word, "facet"))
            return refuse_keyword(text, &word, "facet");
        if (text->source->triangle_count % PROGRESS_STRIDE == 0)
            DPT_TRY(
                soup_report_progress(text->source, "read", (double)(text->at - begin) / (double)(text->end - begin)));
        DPT_TRY(read_facet(text));
    }
}

static dpt_result read_ascii(source_text *text)
{
    const char *begin = text->at;
    while (text_seek_word(text)) {
        DPT_TRY(expect_keyword(text, "solid"));
        DPT_TRY(read_solid(text, begin));
        text_next_line(text);
    }
    return DPT_OK;
}

/* Text has no zero byte. A binary file nearly always has some in its padding or count. */
static int is_ascii(const source_text *text, const unsigned char *bytes, size_t size)
{
    source_text ahead = *text;
    source_word word;
    return text_seek_word(&ahead) && text_next_word(&ahead, &word) && word_is_any_case(&word, "solid") &&
           !memchr(bytes, 0, size < HEADER_BYTES ? size : HEADER_BYTES);
}

dpt_result read_stl(soup *source, const unsigned char *bytes, size_t size)
{
    source_text text;
    text_begin(&text, source, bytes, size);
    int length_fits = size >= HEADER_BYTES && size == HEADER_BYTES + FACET_BYTES * (uint64_t)load_u32(bytes + 80);
    if (!length_fits && is_ascii(&text, bytes, size))
        return read_ascii(&text);
    return read_binary(source, bytes, size);
}
