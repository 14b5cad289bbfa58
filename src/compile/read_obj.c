/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Wavefront OBJ: the lines that begin with v and f. All other lines are skipped. On a vertex line, everything after x,
 * y and z (a weight, colours) is skipped too.
 */
#include "base/return_if_error.h"
#include "compile/text.h"
#include "text/parse_number.h"

typedef struct obj_reader {
    source_text text;
    soup *source;
    corner_list corners;
} obj_reader;

/* Parse v, v/, v//, v/vt, v//vn or v/vt/vn. Set *number to v. Returns NULL if the word has no such form. */
static const char *parse_corner(const source_word *word, int64_t *number)
{
    int64_t ignored;
    const char *at = parse_int(word->begin, word->end, number);
    for (int i = 0; i < 2 && at && at < word->end && *at == '/'; i++) {
        at++;
        if (at < word->end && *at != '/')
            at = parse_int(at, word->end, &ignored);
    }
    return at == word->end ? at : NULL;
}

static dpt_result read_corner(obj_reader *reader, const source_word *word)
{
    soup *source = reader->source;
    char printable[WORD_SHOWN];
    int64_t number;
    if (!parse_corner(word, &number))
        return soup_fail(source, DPT_E_SYNTAX, text_location(&reader->text), "'%s' is no corner of a face",
                         word_printable(word, printable));
    int64_t index = number > 0 ? number - 1 : (int64_t)source->vertex_count + number;
    if (number == 0)
        return soup_fail(source, DPT_E_INDEX, text_location(&reader->text), "vertex 0: they are counted from 1");
    if (index < 0 || index >= INT32_MAX)
        return soup_fail(source, DPT_E_INDEX, text_location(&reader->text), "vertex %s of a face, after %zu vertices",
                         word_printable(word, printable), source->vertex_count);
    return corner_list_add(&reader->corners, source, (uint32_t)index);
}

static dpt_result read_face(obj_reader *reader)
{
    source_location location = text_location(&reader->text);
    source_word word;
    reader->corners.count = 0;
    while (text_next_word(&reader->text, &word))
        DPT_TRY(read_corner(reader, &word));
    if (reader->corners.count < 3)
        return soup_fail(reader->source, DPT_E_SYNTAX, location, "a face of %zu corners: three are the least",
                         reader->corners.count);
    return soup_add_polygon(reader->source, reader->corners.numbers, reader->corners.count, location);
}

/* Only v and f lines may continue after a backslash. On other lines it may be the end of a name. */
static dpt_result read_line(obj_reader *reader)
{
    source_text *text = &reader->text;
    source_word word;
    dpt_result result = DPT_OK;
    text->joins_lines = 1;
    if (text_next_word(text, &word)) {
        if (word_is(&word, "v"))
            result = text_read_vertex(text);
        else if (word_is(&word, "f"))
            result = read_face(reader);
    }
    text->joins_lines = 0;
    return result;
}

static dpt_result read_lines(obj_reader *reader, size_t size)
{
    source_text *text = &reader->text;
    DPT_TRY(text_refuse_utf16(text));
    for (uint64_t lines = 0; text->at < text->end; lines++) {
        if (lines % PROGRESS_STRIDE == 0)
            DPT_TRY(soup_report_progress(reader->source, "read", 1.0 - (double)(text->end - text->at) / (double)size));
        DPT_TRY(read_line(reader));
        text_next_line(text);
    }
    return DPT_OK;
}

dpt_result read_obj(soup *source, const unsigned char *bytes, size_t size)
{
    obj_reader reader = { .source = source };
    text_begin(&reader.text, source, bytes, size);
    reader.text.has_comments = 1;
    source->base = 1;
    dpt_result result = read_lines(&reader, size);
    corner_list_free(&reader.corners);
    return result;
}
