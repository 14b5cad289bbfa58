/* SPDX-License-Identifier: BSD-3-Clause */
#define _POSIX_C_SOURCE 200809L
#include "csv.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "settings.h"
#include "text/parse_number.h"

/* What is read. A line may be a comment, but has an end: a file without any is refused before memory ends. */
static const uint64_t TEXT_MAX = (uint64_t)1 << 30;
static const size_t LINE_MAX = (size_t)1 << 20;

struct parser {
    struct csv_table *table;
    const struct csv_format *form;
    size_t room; /* rows */
    uint64_t line;
    const char *wrong;
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

/* NULL, or what is wrong with the line. */
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

static int add_row(struct parser *parser)
{
    struct csv_table *table = parser->table;
    if (table->rows < parser->room)
        return 1;
    size_t more = parser->room ? 2 * parser->room : 256;
    double *grown = realloc(table->values, more * table->columns * sizeof *grown);
    if (!grown)
        return 0;
    table->values = grown;
    parser->room = more;
    return 1;
}

static dpt_result take_header(struct parser *parser, const char *at, const char *end)
{
    struct csv_table *table = parser->table;
    int index = header_index(at, end, parser->form->headers);
    if (index < 0) {
        parser->wrong = parser->form->wrong_header;
        return DPT_E_SYNTAX;
    }
    table->header = (uint32_t)index;
    table->columns = commas_in(parser->form->headers[index]) + 1;
    return DPT_OK;
}

/* From `at` to before its line feed. */
static dpt_result take_line(struct parser *parser, const char *at, const char *end)
{
    struct csv_table *table = parser->table;
    end -= end > at && end[-1] == '\r';
    if (++parser->line == 1 && end - at >= 3 && memcmp(at, "\xef\xbb\xbf", 3) == 0)
        at += 3;
    const char *word = skip_blanks(at, end);
    if (word == end || *word == '#')
        return DPT_OK;
    if (!table->columns)
        return take_header(parser, at, end);
    if (!add_row(parser)) {
        parser->wrong = "memory ran out";
        return DPT_E_MEMORY;
    }
    double *row = table->values + table->rows * table->columns;
    parser->wrong = parse_row(at, end, row, table->columns);
    if (!parser->wrong)
        parser->wrong = parser->form->wrong_row(row, table->columns);
    if (!parser->wrong && table->rows && row[0] <= row[-(ptrdiff_t)table->columns])
        parser->wrong = "the first column does not increase";
    if (parser->wrong)
        return DPT_E_SYNTAX;
    table->rows++;
    return DPT_OK;
}

/* All lines that end before `end`; *at is then where the next one begins. */
static dpt_result take_lines(struct parser *parser, const char **at, const char *end)
{
    dpt_result result = DPT_OK;
    const char *stop;
    while (result == DPT_OK && (stop = memchr(*at, '\n', (size_t)(end - *at)))) {
        result = take_line(parser, *at, stop);
        *at = stop + 1;
    }
    return result;
}

/* The last line needs no line feed. */
static dpt_result take_rest(struct parser *parser, const char *at, const char *end)
{
    dpt_result result = at < end ? take_line(parser, at, end) : DPT_OK;
    if (result == DPT_OK && !parser->table->rows) {
        parser->wrong = "there are no rows";
        result = DPT_E_SYNTAX;
    }
    return result;
}

dpt_result csv_table_parse(struct csv_table *table, const char *at, const char *end,
                           const struct csv_format *form, uint64_t *line, const char **wrong)
{
    struct parser parser = { .table = table, .form = form };
    dpt_result result = take_lines(&parser, &at, end);
    if (result == DPT_OK)
        result = take_rest(&parser, at, end);
    *line = parser.line;
    *wrong = parser.wrong;
    return result;
}

/* What is read and not yet parsed: the beginning of a line. */
struct text {
    char *bytes;
    size_t count, room;
};

static dpt_result make_room(struct parser *parser, struct text *text)
{
    if (text->count < text->room)
        return DPT_OK;
    if (text->room >= LINE_MAX) {
        ++parser->line;
        parser->wrong = "the line is longer than 1 MiB";
        return DPT_E_SYNTAX;
    }
    size_t room = text->room ? 2 * text->room : (size_t)1 << 16;
    char *grown = realloc(text->bytes, room);
    if (!grown)
        return DPT_E_MEMORY;
    text->bytes = grown;
    text->room = room;
    return DPT_OK;
}

static dpt_result take_text(struct parser *parser, struct text *text)
{
    const char *at = text->bytes, *end = text->bytes + text->count;
    dpt_result result = take_lines(parser, &at, end);
    text->count = (size_t)(end - at);
    memmove(text->bytes, at, text->count);
    return result;
}

dpt_result csv_table_stream(struct csv_table *table, int file, uint64_t most,
                            const struct csv_format *form, uint64_t *line, const char **wrong)
{
    struct parser parser = { .table = table, .form = form };
    struct text text = { .count = 0 };
    uint64_t total = 0;
    ssize_t got = 1;
    dpt_result result = DPT_OK;
    while (result == DPT_OK && got != 0) {
        result = make_room(&parser, &text);
        if (result != DPT_OK)
            break;
        got = read(file, text.bytes + text.count, text.room - text.count);
        if (got < 0 && errno != EINTR)
            result = DPT_E_OPEN;
        if (got <= 0)
            continue;
        text.count += (size_t)got;
        total += (uint64_t)got;
        result = total > most ? DPT_E_LIMIT : take_text(&parser, &text);
    }
    if (result == DPT_OK)
        result = take_rest(&parser, text.bytes, text.bytes + text.count);
    const int reason = errno;
    free(text.bytes);
    errno = reason;
    *line = parser.line;
    *wrong = parser.wrong;
    return result;
}

dpt_result csv_table_read(struct csv_table *table, const char *path, const struct csv_format *form,
                          dpt_device_error *error)
{
    uint64_t line;
    const char *wrong;
    *table = (struct csv_table){ .rows = 0 };
    int file = open(path, O_RDONLY | O_CLOEXEC);
    if (file < 0)
        return device_error(error, DPT_E_OPEN, "%.160s: %s", path, strerror(errno));
    dpt_result result = csv_table_stream(table, file, TEXT_MAX, form, &line, &wrong);
    const int reason = errno;
    close(file);
    if (result == DPT_OK)
        return DPT_OK;
    csv_table_free(table);
    if (wrong)
        return device_error(error, result, "%.160s:%" PRIu64 ": %s", path, line ? line : 1, wrong);
    return device_error(error, result, "%.160s: %s", path,
                        result == DPT_E_OPEN ? strerror(reason) : dpt_result_text(result));
}

void csv_table_free(struct csv_table *table)
{
    free(table->values);
    *table = (struct csv_table){ .rows = 0 };
}
