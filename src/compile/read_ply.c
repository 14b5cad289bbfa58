/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * PLY 1.0, ASCII and binary of both byte orders. The header says what the rows of each element hold. All rows are read.
 * Of "vertex", x, y and z are used; of "face", the list "vertex_indices" or "vertex_index". In ASCII a row is a line.
 */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "base/return_if_error.h"
#include "compile/soup.h"
#include "compile/text.h"

enum { NO_TYPE, OF_INT8, OF_UINT8, OF_INT16, OF_UINT16, OF_INT32, OF_UINT32, OF_FLOAT32, OF_FLOAT64 };

static const struct {
    const char *name;
    uint8_t type;
} type_names[] = {
    { "char", OF_INT8 },   { "uchar", OF_UINT8 },   { "short", OF_INT16 },     { "ushort", OF_UINT16 },
    { "int", OF_INT32 },   { "uint", OF_UINT32 },   { "float", OF_FLOAT32 },   { "double", OF_FLOAT64 },
    { "int8", OF_INT8 },   { "uint8", OF_UINT8 },   { "int16", OF_INT16 },     { "uint16", OF_UINT16 },
    { "int32", OF_INT32 }, { "uint32", OF_UINT32 }, { "float32", OF_FLOAT32 }, { "float64", OF_FLOAT64 }
};

static const uint8_t type_bytes[] = { 0, 1, 1, 2, 2, 4, 4, 4, 8 };

enum { SKIPPED, X, Y, Z, CORNERS }; /* what the reader uses a property for */

typedef struct ply_property {
    uint8_t type;
    uint8_t count_type; /* of a list's length; NO_TYPE if it is no list */
    uint8_t role;
} ply_property;

enum { OTHER, VERTEX, FACE, TRIANGLE_STRIPS };

typedef struct ply_element {
    int kind;
    source_word name;
    uint64_t line; /* in the header, from 1 */
    uint64_t rows; /* as the header announces */
    size_t first_property, property_count;
    size_t row_bytes; /* of a binary row with empty lists */
} ply_element;

enum { NO_ENCODING, ASCII, LITTLE_ENDIAN_BINARY, BIG_ENDIAN_BINARY };

typedef struct ply_reader {
    source_text text;
    soup *source;
    const char *begin; /* of the file */
    int encoding;
    ply_element *elements;
    size_t element_count, element_capacity;
    ply_property *properties;
    size_t property_count, property_capacity;
    uint64_t vertices; /* as the header announces */
    uint64_t rows_read;
    corner_list corners;
} ply_reader;

/* Where the reader is: the line, or the byte in the rows of a binary file. */
static source_location location_of(const ply_reader *reader)
{
    if (reader->encoding == ASCII)
        return text_location(&reader->text);
    return (source_location){ 0, (uint64_t)(reader->text.at - reader->begin) };
}

static source_location end_of_file(const ply_reader *reader)
{
    return (source_location){ 0, (uint64_t)(reader->text.end - reader->begin) };
}

static size_t bytes_left(const ply_reader *reader)
{
    return (size_t)(reader->text.end - reader->text.at);
}

static dpt_result fail_header(ply_reader *reader, const source_word *word, const char *reason)
{
    char printable[WORD_SHOWN];
    return compile_fail(reader->source->context, DPT_E_SYNTAX, text_location(&reader->text), "'%s': %s",
                        word_printable(word, printable), reason);
}

static dpt_result header_word(ply_reader *reader, source_word *word)
{
    if (text_next_word(&reader->text, word))
        return DPT_OK;
    return compile_fail(reader->source->context, DPT_E_SYNTAX, text_location(&reader->text),
                        "a line of the header lacks a word");
}

static dpt_result header_type(ply_reader *reader, uint8_t *type)
{
    source_word word;
    DPT_TRY(header_word(reader, &word));
    for (size_t i = 0; i < sizeof type_names / sizeof type_names[0]; i++) {
        if (word_is(&word, type_names[i].name)) {
            *type = type_names[i].type;
            return DPT_OK;
        }
    }
    return fail_header(reader, &word, "no type of PLY");
}

static dpt_result header_format(ply_reader *reader)
{
    source_word encoding, version;
    DPT_TRY(header_word(reader, &encoding));
    DPT_TRY(header_word(reader, &version));
    if (word_is(&encoding, "ascii"))
        reader->encoding = ASCII;
    else if (word_is(&encoding, "binary_little_endian"))
        reader->encoding = LITTLE_ENDIAN_BINARY;
    else if (word_is(&encoding, "binary_big_endian"))
        reader->encoding = BIG_ENDIAN_BINARY;
    else
        return fail_header(reader, &encoding, "no encoding of PLY");
    return word_is(&version, "1.0") ? DPT_OK : fail_header(reader, &version, "no version of PLY");
}

static const ply_element *find_element(const ply_reader *reader, int kind)
{
    for (size_t i = 0; i < reader->element_count; i++) {
        if (reader->elements[i].kind == kind)
            return &reader->elements[i];
    }
    return NULL;
}

static dpt_result add_element(ply_reader *reader, const ply_element *element)
{
    if (reader->element_count == reader->element_capacity) {
        ply_element *bigger =
            grow_array(reader->elements, &reader->element_capacity, reader->element_count + 1, sizeof *bigger);
        if (!bigger)
            return compile_fail(reader->source->context, DPT_E_MEMORY, text_location(&reader->text),
                                "no memory for %zu elements", reader->element_count + 1);
        reader->elements = bigger;
    }
    reader->elements[reader->element_count++] = *element;
    return DPT_OK;
}

static dpt_result header_element(ply_reader *reader)
{
    ply_element element = { .line = reader->text.line, .first_property = reader->property_count };
    int64_t rows = 0;
    DPT_TRY(header_word(reader, &element.name));
    DPT_TRY(text_read_int(&reader->text, "the element's count", &rows));
    if (rows < 0)
        return fail_header(reader, &element.name, "a negative count");
    element.rows = (uint64_t)rows;
    if (word_is(&element.name, "vertex"))
        element.kind = VERTEX;
    else if (word_is(&element.name, "face"))
        element.kind = FACE;
    else if (word_is(&element.name, "tristrips"))
        element.kind = TRIANGLE_STRIPS;
    if (element.kind != OTHER && find_element(reader, element.kind))
        return fail_header(reader, &element.name, "an element that is there twice");
    if (element.kind == VERTEX)
        reader->vertices = element.rows;
    return add_element(reader, &element);
}

static uint8_t role_of(const ply_element *element, const source_word *name, int is_list)
{
    if (element->kind == VERTEX && name->end - name->begin == 1 && *name->begin >= 'x' && *name->begin <= 'z')
        return (uint8_t)(X + (*name->begin - 'x'));
    if (element->kind == FACE && is_list && (word_is(name, "vertex_indices") || word_is(name, "vertex_index")))
        return CORNERS;
    return SKIPPED;
}

static int has_role(const ply_reader *reader, const ply_element *element, uint8_t role)
{
    for (size_t i = 0; i < element->property_count; i++) {
        if (reader->properties[element->first_property + i].role == role)
            return 1;
    }
    return 0;
}

static dpt_result add_property(ply_reader *reader, ply_element *element, ply_property property)
{
    if (reader->property_count == reader->property_capacity) {
        ply_property *bigger =
            grow_array(reader->properties, &reader->property_capacity, reader->property_count + 1, sizeof *bigger);
        if (!bigger)
            return compile_fail(reader->source->context, DPT_E_MEMORY, text_location(&reader->text),
                                "no memory for %zu properties", reader->property_count + 1);
        reader->properties = bigger;
    }
    reader->properties[reader->property_count++] = property;
    element->property_count++;
    element->row_bytes += type_bytes[property.count_type != NO_TYPE ? property.count_type : property.type];
    return DPT_OK;
}

static dpt_result header_property(ply_reader *reader, const source_word *keyword)
{
    if (reader->element_count == 0)
        return fail_header(reader, keyword, "before the first element");
    ply_element *element = &reader->elements[reader->element_count - 1];
    ply_property property = { NO_TYPE, NO_TYPE, SKIPPED };
    source_word name;
    const char *restart = reader->text.at;
    int is_list = text_next_word(&reader->text, &name) && word_is(&name, "list");
    if (is_list)
        DPT_TRY(header_type(reader, &property.count_type));
    else
        reader->text.at = restart;
    DPT_TRY(header_type(reader, &property.type));
    DPT_TRY(header_word(reader, &name));
    property.role = role_of(element, &name, is_list);
    if (is_list && property.role != SKIPPED && property.role != CORNERS)
        return fail_header(reader, &name, "a coordinate that is a list");
    if (property.role != SKIPPED && has_role(reader, element, property.role))
        return fail_header(reader, &name, "a property that is there twice");
    return add_property(reader, element, property);
}

static dpt_result header_line(ply_reader *reader, const source_word *keyword)
{
    if (word_is(keyword, "comment") || word_is(keyword, "obj_info"))
        return DPT_OK;
    if (word_is(keyword, "format"))
        return header_format(reader);
    if (word_is(keyword, "element"))
        return header_element(reader);
    if (word_is(keyword, "property"))
        return header_property(reader, keyword);
    return fail_header(reader, keyword, "no word that begins a line of the header");
}

static int is_at_bare_cr(const ply_reader *reader)
{
    const source_text *text = &reader->text;
    return text->at < text->end && *text->at == '\r' && !(text->end - text->at > 1 && text->at[1] == '\n');
}

/* One end of line separates the header from the data. If the header's lines end in CR, a LF is already data. */
static dpt_result end_header(ply_reader *reader, int has_bare_cr)
{
    source_word word;
    if (text_next_word(&reader->text, &word))
        return fail_header(reader, &word, "a word after end_header");
    if (has_bare_cr && bytes_left(reader) > 0 && *reader->text.at == '\r') {
        reader->text.at++;
        reader->text.line++;
        return DPT_OK;
    }
    text_next_line(&reader->text);
    return DPT_OK;
}

static dpt_result read_header(ply_reader *reader)
{
    source_word word;
    if (bytes_left(reader) == 0)
        return compile_fail(reader->source->context, DPT_E_TRUNCATED, end_of_file(reader), "the file is empty");
    if (!text_next_word(&reader->text, &word) || !word_is(&word, "ply"))
        return compile_fail(reader->source->context, DPT_E_FORMAT, text_location(&reader->text),
                            "the first line is not 'ply'");
    if (text_next_word(&reader->text, &word))
        return fail_header(reader, &word, "a word after 'ply'");
    int has_bare_cr = is_at_bare_cr(reader);
    while (text_next_line(&reader->text)) {
        if (!text_next_word(&reader->text, &word))
            continue;
        if (word_is(&word, "end_header"))
            return end_header(reader, has_bare_cr);
        DPT_TRY(header_line(reader, &word));
    }
    return compile_fail(reader->source->context, DPT_E_TRUNCATED, text_location(&reader->text),
                        "the file ends within its header");
}

static dpt_result check_element(ply_reader *reader, const ply_element *element)
{
    source_location location = { element->line, 0 };
    if (element->kind == VERTEX &&
        !(has_role(reader, element, X) && has_role(reader, element, Y) && has_role(reader, element, Z)))
        return compile_fail(reader->source->context, DPT_E_SYNTAX, location, "the vertices lack x, y or z");
    if (element->kind == FACE && element->rows > 0 && !has_role(reader, element, CORNERS))
        return compile_fail(reader->source->context, DPT_E_SYNTAX, location,
                            "the faces lack a list vertex_indices or vertex_index");
    if (element->kind != TRIANGLE_STRIPS || element->rows == 0)
        return DPT_OK;
    const ply_element *faces = find_element(reader, FACE);
    if (!faces || faces->rows == 0)
        return compile_fail(reader->source->context, DPT_E_FORMAT, location,
                            "triangle strips are not read: save the mesh as faces");
    return DPT_OK;
}

/* Before anything is allocated, check that the rows that the header announces fit in the bytes after it. */
static dpt_result check_header(ply_reader *reader)
{
    int is_ascii = reader->encoding == ASCII;
    uint64_t bytes_after = (uint64_t)bytes_left(reader) + (uint64_t)is_ascii; /* the last line may lack its end */
    char printable[WORD_SHOWN];
    if (reader->encoding == NO_ENCODING)
        return compile_fail(reader->source->context, DPT_E_SYNTAX, text_location(&reader->text),
                            "the header lacks its format line");
    for (size_t i = 0; i < reader->element_count; i++) {
        const ply_element *element = &reader->elements[i];
        DPT_TRY(check_element(reader, element));
        uint64_t min_row_bytes = is_ascii ? 2 * element->property_count : element->row_bytes;
        if (min_row_bytes > 0 && element->rows > bytes_after / min_row_bytes)
            return compile_fail(reader->source->context, DPT_E_TRUNCATED,
                                is_ascii ? (source_location){ element->line, 0 } : end_of_file(reader),
                                "%" PRIu64 " rows of %s announced, there are bytes for %" PRIu64, element->rows,
                                word_printable(&element->name, printable), bytes_after / min_row_bytes);
        bytes_after -= min_row_bytes * element->rows;
    }
    return DPT_OK;
}

static uint64_t load_bits(const char *bytes, size_t size, int is_big_endian)
{
    uint64_t bits = 0;
    for (size_t i = 0; i < size; i++) {
        uint64_t byte = (unsigned char)bytes[i];
        bits |= byte << 8 * (is_big_endian ? size - 1 - i : i);
    }
    return bits;
}

static double load_float(uint64_t bits)
{
    uint32_t low = (uint32_t)bits;
    float value;
    memcpy(&value, &low, sizeof value);
    return (double)value;
}

static double load_double(uint64_t bits)
{
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* Decode a two's complement number of `size` bytes, on any host. */
static double load_signed(uint64_t bits, size_t size)
{
    uint64_t sign = UINT64_C(1) << (8 * size - 1);
    return (double)(bits & (sign - 1)) - (double)(bits & sign);
}

static double decode(const char *bytes, uint8_t type, int is_big_endian)
{
    uint64_t bits = load_bits(bytes, type_bytes[type], is_big_endian);
    switch (type) {
    case OF_INT8:
    case OF_INT16:
    case OF_INT32:
        return load_signed(bits, type_bytes[type]);
    case OF_FLOAT32:
        return load_float(bits);
    case OF_FLOAT64:
        return load_double(bits);
    default:
        return (double)bits;
    }
}

static dpt_result fail_truncated(ply_reader *reader, const char *what)
{
    return compile_fail(reader->source->context, DPT_E_TRUNCATED, end_of_file(reader),
                        "the file ends within %s, after %" PRIu64 " rows", what, reader->rows_read);
}

static dpt_result read_value(ply_reader *reader, uint8_t type, const char *what, double *value)
{
    if (reader->encoding == ASCII)
        return text_read_double(&reader->text, what, value);
    if (bytes_left(reader) < type_bytes[type])
        return fail_truncated(reader, what);
    *value = decode(reader->text.at, type, reader->encoding == BIG_ENDIAN_BINARY);
    reader->text.at += type_bytes[type];
    return DPT_OK;
}

static dpt_result skip_values(ply_reader *reader, uint8_t type, size_t count)
{
    source_word word;
    if (reader->encoding != ASCII) {
        if (count > bytes_left(reader) / type_bytes[type])
            return fail_truncated(reader, "a property");
        reader->text.at += count * type_bytes[type];
        return DPT_OK;
    }
    for (size_t i = 0; i < count; i++) {
        if (!text_next_word(&reader->text, &word))
            return compile_fail(reader->source->context, DPT_E_SYNTAX, location_of(reader),
                                "the line ends before its values do");
    }
    return DPT_OK;
}

/* Read the length of a list. It is refused if the bytes that are left cannot hold the list. */
static dpt_result read_length(ply_reader *reader, const ply_property *property, size_t *length)
{
    source_location location = location_of(reader);
    double value = 0.0;
    DPT_TRY(read_value(reader, property->count_type, "a list's length", &value));
    size_t min_value_bytes = reader->encoding == ASCII ? 1 : type_bytes[property->type];
    if (value > (double)(bytes_left(reader) / min_value_bytes))
        return compile_fail(reader->source->context, DPT_E_TRUNCATED, location,
                            "a list of %.0f values runs beyond the end of the file", value);
    if (!(value >= 0.0) || value != (double)(size_t)value)
        return compile_fail(reader->source->context, DPT_E_SYNTAX, location, "a list of %.9g values", value);
    *length = (size_t)value;
    return DPT_OK;
}

static dpt_result read_corners(ply_reader *reader, const ply_property *property, size_t length)
{
    reader->corners.count = 0;
    for (size_t i = 0; i < length; i++) {
        source_location location = location_of(reader);
        double value = 0.0;
        DPT_TRY(read_value(reader, property->type, "a corner", &value));
        if (!(value >= 0.0 && value < (double)reader->vertices && value < INT32_MAX) ||
            value != (double)(uint32_t)value)
            return compile_fail(reader->source->context, DPT_E_INDEX, location,
                                "vertex %.9g of a face: there are %" PRIu64 ", counted from 0", value,
                                reader->vertices);
        DPT_TRY(corner_list_add(&reader->corners, reader->source->context, (uint32_t)value));
    }
    return DPT_OK;
}

static dpt_result read_property(ply_reader *reader, const ply_property *property, double xyz[3])
{
    static const char *const names[3] = { "x", "y", "z" };
    size_t length = 1;
    if (property->count_type != NO_TYPE)
        DPT_TRY(read_length(reader, property, &length));
    if (property->role == SKIPPED)
        return skip_values(reader, property->type, length);
    if (property->role == CORNERS)
        return read_corners(reader, property, length);
    int axis = property->role - X;
    return read_value(reader, property->type, names[axis], &xyz[axis]);
}

static dpt_result end_row(ply_reader *reader, const ply_element *element, const double xyz[3], source_location location)
{
    source_word word;
    char printable[WORD_SHOWN];
    const corner_list *corners = &reader->corners;
    reader->rows_read++;
    if (reader->encoding == ASCII && text_next_word(&reader->text, &word))
        return compile_fail(reader->source->context, DPT_E_SYNTAX, location,
                            "'%s' is one value more than the header announces", word_printable(&word, printable));
    if (element->kind == VERTEX)
        return soup_add_vertex(reader->source, xyz[0], xyz[1], xyz[2], location);
    if (element->kind != FACE)
        return DPT_OK;
    if (corners->count < 3)
        return compile_fail(reader->source->context, DPT_E_SYNTAX, location,
                            "a face of %zu corners: three are the least", corners->count);
    return soup_add_polygon(reader->source, corners->numbers, corners->count, location);
}

static dpt_result read_row(ply_reader *reader, const ply_element *element, uint64_t row)
{
    double xyz[3] = { 0.0, 0.0, 0.0 };
    char printable[WORD_SHOWN];
    if (reader->encoding == ASCII && !text_seek_word(&reader->text))
        return compile_fail(reader->source->context, DPT_E_TRUNCATED, location_of(reader),
                            "the file ends after %" PRIu64 " of %" PRIu64 " rows of %s", row, element->rows,
                            word_printable(&element->name, printable));
    source_location location = location_of(reader);
    for (size_t i = 0; i < element->property_count; i++)
        DPT_TRY(read_property(reader, &reader->properties[element->first_property + i], xyz));
    return end_row(reader, element, xyz, location);
}

static dpt_result read_rows(ply_reader *reader, const ply_element *element)
{
    if (element->property_count == 0)
        return DPT_OK; /* rows without properties take no bytes */
    for (uint64_t row = 0; row < element->rows; row++) {
        if (row % PROGRESS_STRIDE == 0)
            DPT_TRY(compile_report_progress(reader->source->context, "read",
                                            (double)(reader->text.at - reader->begin) /
                                                (double)(reader->text.end - reader->begin)));
        DPT_TRY(read_row(reader, element, row));
    }
    return DPT_OK;
}

/* Only blanks and line ends may follow: some writers end a binary file with a line end. */
static dpt_result check_end(ply_reader *reader)
{
    if (!text_seek_word(&reader->text))
        return DPT_OK;
    return compile_fail(reader->source->context, DPT_E_TRAILING, location_of(reader),
                        "data follow the %" PRIu64 " rows that the header announces", reader->rows_read);
}

static dpt_result read_all(ply_reader *reader)
{
    DPT_TRY(text_refuse_utf16(&reader->text));
    DPT_TRY(read_header(reader));
    DPT_TRY(check_header(reader));
    for (size_t i = 0; i < reader->element_count; i++)
        DPT_TRY(read_rows(reader, &reader->elements[i]));
    return check_end(reader);
}

dpt_result read_ply(soup *source, const unsigned char *bytes, size_t size)
{
    ply_reader reader = { .source = source, .begin = (const char *)bytes };
    text_begin(&reader.text, source->context, bytes, size);
    dpt_result result = read_all(&reader);
    free(reader.elements);
    free(reader.properties);
    corner_list_free(&reader.corners);
    return result;
}
