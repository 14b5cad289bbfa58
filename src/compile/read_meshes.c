/* SPDX-License-Identifier: BSD-3-Clause */
#include <inttypes.h>
#include <string.h>

#include "base/return_if_error.h"
#include "compile/text.h"
#include "text/parse_number.h"

/* ---- OBJ ---- */

/*
 * Wavefront OBJ: the lines that begin with v and f. All other lines are skipped. On a vertex line, everything after x,
 * y and z (a weight, colours) is skipped too.
 */

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
        return compile_fail(source->context, DPT_E_SYNTAX, text_location(&reader->text), "'%s' is no corner of a face",
                            word_printable(word, printable));
    int64_t index = number > 0 ? number - 1 : (int64_t)source->vertex_count + number;
    if (number == 0)
        return compile_fail(source->context, DPT_E_INDEX, text_location(&reader->text),
                            "vertex 0: they are counted from 1");
    if (index < 0 || index >= INT32_MAX)
        return compile_fail(source->context, DPT_E_INDEX, text_location(&reader->text),
                            "vertex %s of a face, after %zu vertices", word_printable(word, printable),
                            source->vertex_count);
    return corner_list_add(&reader->corners, source->context, (uint32_t)index);
}

static dpt_result read_face(obj_reader *reader)
{
    source_location location = text_location(&reader->text);
    source_word word;
    reader->corners.count = 0;
    while (text_next_word(&reader->text, &word))
        DPT_TRY(read_corner(reader, &word));
    if (reader->corners.count < 3)
        return compile_fail(reader->source->context, DPT_E_SYNTAX, location,
                            "a face of %zu corners: three are the least", reader->corners.count);
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
            result = text_read_vertex(text, reader->source);
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
            DPT_TRY(compile_report_progress(reader->source->context, "read",
                                            1.0 - (double)(text->end - text->at) / (double)size));
        DPT_TRY(read_line(reader));
        text_next_line(text);
    }
    return DPT_OK;
}

dpt_result read_obj(soup *source, const unsigned char *bytes, size_t size)
{
    obj_reader reader = { .source = source };
    text_begin(&reader.text, source->context, bytes, size);
    reader.text.has_comments = 1;
    source->base = 1;
    dpt_result result = read_lines(&reader, size);
    corner_list_free(&reader.corners);
    return result;
}

/* ---- OFF ---- */

/*
 * OFF as text: a header word, the counts, then a line for each vertex and each face. Everything after the coordinates
 * of a vertex or the corners of a face (normals, colours, texture) is skipped.
 */

typedef struct off_reader {
    source_text text;
    soup *source;
    corner_list corners;
    const char *begin; /* of the file */
    int64_t vertices, faces;
} off_reader;

static dpt_result refuse_header(off_reader *reader, const char *reason)
{
    return compile_fail(reader->source->context, DPT_E_FORMAT, text_location(&reader->text), "%s", reason);
}

/* A prefix of OFF says what each vertex has besides x, y and z. Those with more than three dimensions are refused. */
static dpt_result read_keyword(off_reader *reader)
{
    source_text *text = &reader->text;
    source_word word;
    if (!text_seek_word(text) || !text_next_word(text, &word))
        return compile_fail(reader->source->context, DPT_E_TRUNCATED, (source_location){ 0, 0 },
                            "the file holds no word");
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
        return compile_fail(reader->source->context, DPT_E_TRUNCATED, text_location(text),
                            "the file ends before its counts");
    for (int i = 0; i < 3; i++) {
        DPT_TRY(text_read_int(text, names[i], &counts[i]));
        if (counts[i] < 0)
            return compile_fail(reader->source->context, DPT_E_SYNTAX, text_location(text), "%s is negative", names[i]);
    }
    /* The shortest lines are "0 0 0" and "0", each after the end of another. */
    int64_t bytes_after = (int64_t)(text->end - text->at);
    if (counts[0] > bytes_after / 6 || counts[1] > (bytes_after - 6 * counts[0]) / 2)
        return compile_fail(reader->source->context, DPT_E_TRUNCATED, text_location(text),
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
        return compile_fail(reader->source->context, DPT_E_TRUNCATED, text_location(text),
                            "the file ends after %" PRId64 " of %" PRId64 " %s", number, count, items);
    if (number % PROGRESS_STRIDE != 0)
        return DPT_OK;
    return compile_report_progress(reader->source->context, "read",
                                   (double)(text->at - reader->begin) / (double)(text->end - reader->begin));
}

static dpt_result read_corners(off_reader *reader, int64_t n)
{
    reader->corners.count = 0;
    for (int64_t i = 0; i < n; i++) {
        int64_t number;
        DPT_TRY(text_read_int(&reader->text, "a corner", &number));
        if (number < 0 || number >= reader->vertices)
            return compile_fail(reader->source->context, DPT_E_INDEX, text_location(&reader->text),
                                "vertex %" PRId64 " of a face: there are %" PRId64 ", counted from 0", number,
                                reader->vertices);
        DPT_TRY(corner_list_add(&reader->corners, reader->source->context, (uint32_t)number));
    }
    return DPT_OK;
}

static dpt_result read_polygon(off_reader *reader)
{
    source_location location = text_location(&reader->text);
    int64_t n;
    DPT_TRY(text_read_int(&reader->text, "the number of corners", &n));
    if (n < 3)
        return compile_fail(reader->source->context, DPT_E_SYNTAX, location,
                            "a face of %" PRId64 " corners: three are the least", n);
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
        DPT_TRY(text_read_vertex(text, reader->source));
    }
    for (int64_t i = 0; i < reader->faces; i++) {
        DPT_TRY(begin_item(reader, "faces", i, reader->faces));
        DPT_TRY(read_polygon(reader));
    }
    if (text_next_line(text) && text_seek_word(text))
        return compile_fail(reader->source->context, DPT_E_TRAILING, text_location(text),
                            "text follows the last of %" PRId64 " faces", reader->faces);
    return DPT_OK;
}

dpt_result read_off(soup *source, const unsigned char *bytes, size_t size)
{
    off_reader reader = { .source = source };
    text_begin(&reader.text, source->context, bytes, size);
    reader.text.has_comments = 1;
    reader.begin = reader.text.at;
    dpt_result result = read_all(&reader);
    corner_list_free(&reader.corners);
    return result;
}

/* ---- STL ---- */

/*
 * STL, binary and ASCII. Every facet has three vertices of its own; normals are skipped. The length of the file tells
 * binary from ASCII, because a binary file may begin with "solid" too.
 */

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
        return compile_fail(source->context, DPT_E_TRUNCATED, (source_location){ 0, size },
                            "neither ASCII STL nor the %d bytes that a binary one begins with", HEADER_BYTES);
    uint64_t announced = load_u32(bytes + 80), held = (size - HEADER_BYTES) / FACET_BYTES;
    uint64_t length = HEADER_BYTES + FACET_BYTES * announced;
    if (size < length)
        return compile_fail(source->context, DPT_E_TRUNCATED, (source_location){ 0, size },
                            "binary STL announces %" PRIu64 " triangles and holds %" PRIu64, announced, held);
    if (size > length && announced == 0)
        return compile_fail(source->context, DPT_E_TRAILING, (source_location){ 0, length },
                            "binary STL announces no triangle, and %" PRIu64 " bytes follow", size - length);
    if (size > length)
        compile_note(source->context, (source_location){ 0, length },
                     "%" PRIu64 " bytes follow the %" PRIu64 " triangles that binary STL announces: left out",
                     size - length, announced);
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
    const size_t facets = load_u32(bytes + 80);
    for (size_t i = 0; i < facets; i++) {
        if (i % PROGRESS_STRIDE == 0)
            DPT_TRY(compile_report_progress(source->context, "read", (double)i / (double)facets));
        DPT_TRY(read_binary_facet(source, bytes, HEADER_BYTES + FACET_BYTES * i));
    }
    return DPT_OK;
}

static dpt_result next_keyword(source_text *text, source_word *word, const char *wanted)
{
    if (text_seek_word(text) && text_next_word(text, word))
        return DPT_OK;
    return compile_fail(text->context, DPT_E_TRUNCATED, text_location(text), "the file ends where '%s' should be",
                        wanted);
}

static dpt_result refuse_keyword(source_text *text, const source_word *word, const char *wanted)
{
    char printable[WORD_SHOWN];
    return compile_fail(text->context, DPT_E_SYNTAX, text_location(text), "'%s' where '%s' should be",
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

static dpt_result read_loop(source_text *text, soup *source)
{
    source_word word;
    for (int vertices = 0;; vertices++) {
        DPT_TRY(next_keyword(text, &word, "vertex"));
        int is_end = is_end_of(text, &word, "loop");
        if (!is_end && !word_is_any_case(&word, "vertex"))
            return refuse_keyword(text, &word, "vertex");
        if (is_end != (vertices == 3))
            return compile_fail(text->context, DPT_E_SYNTAX, text_location(text), "a facet of %s vertices",
                                is_end ? "fewer than three" : "more than three");
        if (is_end)
            return DPT_OK;
        DPT_TRY(text_read_vertex(text, source));
    }
}

static dpt_result read_facet(source_text *text, soup *source)
{
    source_location location = text_location(text);
    source_word word;
    DPT_TRY(read_facet_head(text));
    DPT_TRY(read_loop(text, source));
    DPT_TRY(next_keyword(text, &word, "endfacet"));
    if (!is_end_of(text, &word, "facet"))
        return refuse_keyword(text, &word, "endfacet");
    return add_triangle(source, location);
}

/* Read a solid up to its end. "solid" was read; the rest of that line is its name. */
static dpt_result read_solid(source_text *text, soup *source, const char *begin)
{
    text_next_line(text);
    for (;;) {
        source_word word;
        DPT_TRY(next_keyword(text, &word, "endsolid"));
        if (is_end_of(text, &word, "solid"))
            return DPT_OK;
        if (!word_is_any_case(&word, "facet"))
            return refuse_keyword(text, &word, "facet");
        if (source->triangle_count % PROGRESS_STRIDE == 0)
            DPT_TRY(compile_report_progress(text->context, "read",
                                            (double)(text->at - begin) / (double)(text->end - begin)));
        DPT_TRY(read_facet(text, source));
    }
}

static int is_at_solid(source_text text)
{
    source_word word;
    return text_next_word(&text, &word) && word_is_any_case(&word, "solid");
}

static dpt_result read_ascii(source_text *text, soup *source)
{
    const char *begin = text->at;
    while (text_seek_word(text)) {
        if (text->at > begin && !is_at_solid(*text)) {
            compile_note(text->context, text_location(text), "text follows the last solid: left out");
            return DPT_OK;
        }
        DPT_TRY(expect_keyword(text, "solid"));
        DPT_TRY(read_solid(text, source, begin));
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
    text_begin(&text, source->context, bytes, size);
    int length_fits = size >= HEADER_BYTES && size == HEADER_BYTES + FACET_BYTES * (uint64_t)load_u32(bytes + 80);
    if (!length_fits && is_ascii(&text, bytes, size))
        return read_ascii(&text, source);
    return read_binary(source, bytes, size);
}
