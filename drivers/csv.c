/* SPDX-License-Identifier: BSD-3-Clause */
#include "csv.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/return_if_error.h"
#include "dynpoint/base.h"
#include "platform/file.h"
#include "settings.h"
#include "text/parse_number.h"

/* Limits of a file and of a line, bytes. A file without line ends is refused before memory runs out. */
static const uint64_t TEXT_MAX = (uint64_t)1 << 30;
static const size_t LINE_MAX = (size_t)1 << 20;

struct parser {
    struct csv_table *table;
    const struct csv_format *format;
    size_t row_capacity; /* rows */
    uint64_t line;
    const char *error;
};

static const char *skip_blanks(const char *at, const char *end)
{
    while (at < end && (*at == ' ' || *at == '\t'))
        at++;
    return at;
}

static int header_index(const char *at, const char *end, const char *const *headers)
{
    for (int i = 0; headers[i]; i++)
        if (strlen(headers[i]) == (size_t)(end - at) && !memcmp(headers[i], at, strlen(headers[i])))
            return i;
    return -1;
}

static size_t commas_in(const char *text)
{
    size_t count = 0;
    for (; *text; text++)
        count += *text == ',';
    return count;
}

/* Returns NULL, or what is wrong with the line. */
static const char *parse_row(const char *at, const char *end, double *row, size_t columns)
{
    for (size_t i = 0; i < columns; i++) {
        at = parse_double(skip_blanks(at, end), end, &row[i]);
        if (!at)
            return "a field is missing, or not a number";
        at = skip_blanks(at, end);
        if (i + 1 < columns && (at == end || *at++ != ','))
            return "there are too few fields";
    }
    return at == end ? NULL : "there are too many fields";
}

/* Make room for one more row. Returns 0 if memory runs out. */
static int reserve_row(struct parser *parser)
{
    struct csv_table *table = parser->table;
    if (table->rows < parser->row_capacity)
        return 1;
    size_t row_capacity = parser->row_capacity ? 2 * parser->row_capacity : 256;
    double *grown = realloc(table->values, row_capacity * table->columns * sizeof *grown);
    if (!grown)
        return 0;
    table->values = grown;
    parser->row_capacity = row_capacity;
    return 1;
}

static dpt_result parse_header(struct parser *parser, const char *at, const char *end)
{
    struct csv_table *table = parser->table;
    int index = header_index(at, end, parser->format->headers);
    if (index < 0) {
        parser->error = parser->format->header_error;
        return DPT_E_SYNTAX;
    }
    table->header = (uint32_t)index;
    table->columns = commas_in(parser->format->headers[index]) + 1;
    return DPT_OK;
}

/* Parse one line; `end` is its line feed. */
static dpt_result parse_line(struct parser *parser, const char *at, const char *end)
{
    struct csv_table *table = parser->table;
    end -= end > at && end[-1] == '\r';
    if (++parser->line == 1 && end - at >= 3 && memcmp(at, "\xef\xbb\xbf", 3) == 0)
        at += 3;
    const char *word = skip_blanks(at, end);
    if (word == end || *word == '#')
        return DPT_OK;
    if (!table->columns)
        return parse_header(parser, at, end);
    if (!reserve_row(parser)) {
        parser->error = "memory ran out";
        return DPT_E_MEMORY;
    }
    double *row = table->values + table->rows * table->columns;
    parser->error = parse_row(at, end, row, table->columns);
    if (!parser->error)
        parser->error = parser->format->check_row(row, table->columns);
    if (!parser->error && table->rows && row[0] <= row[-(ptrdiff_t)table->columns])
        parser->error = "the first column does not increase";
    if (parser->error)
        return DPT_E_SYNTAX;
    table->rows++;
    return DPT_OK;
}

/* Parse all lines that end before `end`. Sets *at to the beginning of the next line. */
static dpt_result parse_lines(struct parser *parser, const char **at, const char *end)
{
    const char *stop;
    while ((stop = memchr(*at, '\n', (size_t)(end - *at)))) {
        const char *line = *at;
        *at = stop + 1;
        DPT_TRY(parse_line(parser, line, stop));
    }
    return DPT_OK;
}

/* Parse the last line, which may lack its line feed. A table without rows is an error. */
static dpt_result parse_last_line(struct parser *parser, const char *at, const char *end)
{
    if (at < end)
        DPT_TRY(parse_line(parser, at, end));
    if (parser->table->rows)
        return DPT_OK;
    parser->error = "there are no rows";
    return DPT_E_SYNTAX;
}

dpt_result csv_table_parse(struct csv_table *table, const char *at, const char *end, const struct csv_format *format,
                           uint64_t *line, const char **line_error)
{
    struct parser parser = { .table = table, .format = format };
    dpt_result result = parse_lines(&parser, &at, end);
    if (result == DPT_OK)
        result = parse_last_line(&parser, at, end);
    *line = parser.line;
    *line_error = parser.error;
    return result;
}

/* Bytes that were read but not parsed yet: the beginning of a line. */
struct unparsed_text {
    char *bytes;
    size_t count, capacity;
};

static dpt_result grow_text(struct parser *parser, struct unparsed_text *text)
{
    if (text->count < text->capacity)
        return DPT_OK;
    if (text->capacity >= LINE_MAX) {
        ++parser->line;
        parser->error = "the line is longer than 1 MiB";
        return DPT_E_SYNTAX;
    }
    size_t capacity = text->capacity ? 2 * text->capacity : (size_t)1 << 16;
    char *grown = realloc(text->bytes, capacity);
    if (!grown)
        return DPT_E_MEMORY;
    text->bytes = grown;
    text->capacity = capacity;
    return DPT_OK;
}

static dpt_result parse_text(struct parser *parser, struct unparsed_text *text)
{
    const char *at = text->bytes, *end = text->bytes + text->count;
    dpt_result result = parse_lines(parser, &at, end);
    text->count = (size_t)(end - at);
    memmove(text->bytes, at, text->count);
    return result;
}

static dpt_result parse_file(struct parser *parser, int file, uint64_t max_bytes, struct unparsed_text *text)
{
    uint64_t total = 0;
    for (long got = 1; got != 0;) {
        DPT_TRY(grow_text(parser, text));
        got = file_read(file, text->bytes + text->count, text->capacity - text->count);
        if (got < 0 && errno != EINTR)
            return DPT_E_OPEN;
        if (got <= 0)
            continue;
        text->count += (size_t)got;
        total += (uint64_t)got;
        if (total > max_bytes)
            return DPT_E_LIMIT;
        DPT_TRY(parse_text(parser, text));
    }
    return parse_last_line(parser, text->bytes, text->bytes + text->count);
}

dpt_result csv_table_stream(struct csv_table *table, int file, uint64_t max_bytes, const struct csv_format *format,
                            uint64_t *line, const char **line_error)
{
    struct parser parser = { .table = table, .format = format };
    struct unparsed_text text = { .count = 0 };
    const dpt_result result = parse_file(&parser, file, max_bytes, &text);
    const int saved_errno = errno;
    free(text.bytes);
    errno = saved_errno;
    *line = parser.line;
    *line_error = parser.error;
    return result;
}

dpt_result csv_table_read(struct csv_table *table, const char *path, const struct csv_format *format,
                          dpt_device_error *error)
{
    uint64_t line;
    const char *line_error;
    *table = (struct csv_table){ .rows = 0 };
    int file = file_open_read(path);
    if (file < 0)
        return device_error(error, DPT_E_OPEN, "%.160s: %s", path, strerror(errno));
    dpt_result result = csv_table_stream(table, file, TEXT_MAX, format, &line, &line_error);
    const int saved_errno = errno;
    close(file);
    if (result == DPT_OK)
        return DPT_OK;
    csv_table_free(table);
    if (line_error)
        return device_error(error, result, "%.160s:%" PRIu64 ": %s", path, line ? line : 1, line_error);
    return device_error(error, result, "%.160s: %s", path,
                        result == DPT_E_OPEN ? strerror(saved_errno) : dpt_result_text(result));
}

void csv_table_free(struct csv_table *table)
{
    free(table->values);
    *table = (struct csv_table){ .rows = 0 };
}

/* ---- traces ---- */

/* From here on neighbouring integers are the same double. */
#define TICKS_END 0x1p53

static const char *check_row(const double *row, size_t columns)
{
    if (row[0] != floor(row[0]))
        return "the tick is not an integer";
    if (!(fabs(row[0]) < TICKS_END))
        return "the tick is not within 2^53";
    for (size_t i = 1; i < columns; i++)
        if (!(fabs(row[i]) <= DPT_COORDINATE_MAX))
            return "a coordinate is beyond 1e6 m";
    return NULL;
}

#define HEADER "tick,ax,ay,az,bx,by,bz"

static const char *const headers[] = { HEADER, NULL };

const struct csv_format trace_format = {
    .headers = headers,
    .header_error = "the header is not " HEADER,
    .check_row = check_row,
};

int trace_is_jump(const struct csv_table *trace, size_t row)
{
    return row == 0 || csv_table_row(trace, row)[0] != csv_table_row(trace, row - 1)[0] + 1.0;
}
