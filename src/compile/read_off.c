/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * OFF as text: a header word, the counts, then a line for each vertex and each face. Everything after the coordinates
 * of a vertex or the corners of a face (normals, colours, texture) is skipped.
 */
#include <inttypes.h>
#include <string.h>

#include "base/return_if_error.h"
#include "compile/text.h"

typedef struct off_reader {
    source_text text;
    soup *source;
    corner_list corners;
    const char *begin; /* of the file */
    int64_t vertices, faces;
} off_reader;

static dpt_result refuse_header(off_reader *reader, const char *reason)
{
    return soup_fail(reader->source, DPT_E_FORMAT, text_location(&reader->text), "%s", reason);
}

/* A prefix of OFF says what each vertex has besides x, y and z. Those with more than three dimensions are refused. */
static dpt_result read_keyword(off_reader *reader)
{
    source_text *text = &reader->text;
    source_word word;
    if (!text_seek_word(text) || !text_next_word(text, &word))
        return soup_fail(reader->source, DPT_E_TRUNCATED, (source_location){ 0, 0 }, "the file holds no word");
    const char *at = word.begin;
    while (at < word.end && memchr("STCN4n", *at, 6))
        at++;
    if (word.end - at < 3 || memcmp(at, "OFF", 3) != 0)
        return refuse_header(reader, "the file does not begin with OFF");
    for (const char *prefix = word.begin; prefix < at; prefix++) {
        if (*prefix == '4' || *prefix == 'n')
            return refuse_header(reader, "OFF of more than three dimensions is not read");
    }
    text->at = at + 3; /* the counts may follow without a blank */
    const char *counts = text->at;
    if (text_next_word(text, &word) && word_is(&word, "BINARY"))
        return refuse_header(reader, "binary OFF is not read: save it as text");
    text->at = counts;
    return DPT_OK;
}

static dpt_result read_counts(off_reader *reader)
{
    static const char *const names[3] = { "the number of vertices", "the number of faces", "the number of edges" };
    source_text *text = &reader->text;
    int64_t counts[3];
    if (!text_seek_word(text))
        return soup_fail(reader->source, DPT_E_TRUNCATED, text_location(text), "the file ends before its counts");
    for (int i = 0; i < 3; i++) {
        DPT_TRY(text_read_int(text, names[i], &counts[i]));
        if (counts[i] < 0)
            return soup_fail(reader->source, DPT_E_SYNTAX, text_location(text), "%s is negative", names[i]);
    }
    /* The shortest lines are "0 0 0" and "0", each after the end of another. */
    int64_t bytes_after = (int64_t)(text->end - text->at);
    if (counts[0] > bytes_after / 6 || counts[1] > (bytes_after - 6 * counts[0]) / 2)
        return soup_fail(reader->source, DPT_E_TRUNCATED, text_location(text),
                         "%" PRId64 " vertices and %" PRId64 " faces do not fit in %" PRId64 " bytes", counts[0],
                         counts[1], bytes_after);
    reader->vertices = counts[0];
    reader->faces = counts[1];
    return DPT_OK;
}

/* Go to the line of item `number`, from 0, of `count`. `items` names them in messages. */
static dpt_result begin_item(off_reader *reader, const char *items, int64_t number, int64_t count)
{
    source_text *text = &reader->text;
    if (!text_next_line(text) || !text_seek_word(text))
        return soup_fail(reader->source, DPT_E_TRUNCATED, text_location(text),
                         "the file ends after %" PRId64 " of %" PRId64 " %s", number, count, items);
    if (number % PROGRESS_STRIDE != 0)
        return DPT_OK;
    return soup_report_progress(reader->source, "read",
                                (double)(text->at - reader->begin) / (double)(text->end - reader->begin));
}

static dpt_result read_corners(off_reader *reader, int64_t n)
{
    reader->corners.count = 0;
    for (int64_t i = 0; i < n; i++) {
        int64_t number;
        DPT_TRY(text_read_int(&reader->text, "a corner", &number));
        if (number < 0 || number >= reader->vertices)
            return soup_fail(reader->source, DPT_E_INDEX, text_location(&reader->text),
                             "vertex %" PRId64 " of a face: there are %" PRId64 ", counted from 0", number,
                             reader->vertices);
        DPT_TRY(corner_list_add(&reader->corners, reader->source, (uint32_t)number));
    }
    return DPT_OK;
}

static dpt_result read_face(off_reader *reader)
{
    source_location location = text_location(&reader->text);
    int64_t n;
    DPT_TRY(text_read_int(&reader->text, "the number of corners", &n));
    if (n < 3)
        return soup_fail(reader->source, DPT_E_SYNTAX, location, "a face of %" PRId64 " corners: three are the least",
                         n);
    DPT_TRY(read_corners(reader, n));
    return soup_add_polygon(reader->source, reader->corners.numbers, reader->corners.count, location);
}

static dpt_result read_all(off_reader *reader)
{
    source_text *text = &reader->text;
    DPT_TRY(text_refuse_utf16(text));
    DPT_TRY(read_keyword(reader));
    DPT_TRY(read_counts(reader));
    for (int64_t i = 0; i < reader->vertices; i++) {
        DPT_TRY(begin_item(reader, "vertices", i, reader->vertices));
        DPT_TRY(text_read_vertex(text));
    }
    for (int64_t i = 0; i < reader->faces; i++) {
        DPT_TRY(begin_item(reader, "faces", i, reader->faces));
        DPT_TRY(read_face(reader));
    }
    if (text_next_line(text) && text_seek_word(text))
        return soup_fail(reader->source, DPT_E_TRAILING, text_location(text),
                         "text follows the last of %" PRId64 " faces", reader->faces);
    return DPT_OK;
}

dpt_result read_off(soup *source, const unsigned char *bytes, size_t size)
{
    off_reader reader = { .source = source };
    text_begin(&reader.text, source, bytes, size);
    reader.text.has_comments = 1;
    reader.begin = reader.text.at;
    dpt_result result = read_all(&reader);
    corner_list_free(&reader.corners);
    return result;
}
