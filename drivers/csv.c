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

struct text {
    char *bytes;
    size_t count, room;
};

static const size_t TEXT_MOST = (size_t)1 << 30;

static int make_room(struct text *text)
{
    if (text->count < text->room)
        return 1;
    size_t room = text->room ? 2 * text->room : (size_t)1 << 16;
    char *grown = realloc(text->bytes, room);
    if (!grown)
        return 0;
    text->bytes = grown;
    text->room = room;
    return 1;
}

static dpt_result read_all(struct text *text, int file)
{
    for (;;) {
        if (text->count > TEXT_MOST)
            return DPT_E_LIMIT;
        if (!make_room(text))
            return DPT_E_MEMORY;
        ssize_t got = read(file, text->bytes + text->count, text->room - text->count);
        if (got == 0)
            return DPT_OK;
        if (got > 0)
            text->count += (size_t)got;
        else if (errno != EINTR)
            return DPT_E_OPEN;
    }
}

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

static int add_row(struct table *table, size_t *room)
{
    if (table->rows < *room)
        return 1;
    size_t more = *room ? 2 * *room : 256;
    double *grown = realloc(table->values, more * table->columns * sizeof *grown);
    if (!grown)
        return 0;
    table->values = grown;
    *room = more;
    return 1;
}

dpt_result table_parse(struct table *table, const char *at, const char *end,
                       const struct table_form *form, uint64_t *line, const char **wrong)
{
    size_t room = 0;
    for (const char *next; at < end; at = next) {
        const char *stop = memchr(at, '\n', (size_t)(end - at));
        next = stop ? stop + 1 : end;
        stop = stop ? stop : end;
        stop -= stop > at && stop[-1] == '\r';
        ++*line;
        const char *word = skip_blanks(at, stop);
        if (word == stop || *word == '#')
            continue;
        if (!table->columns) {
            int index = header_index(at, stop, form->headers);
            if (index < 0) {
                *wrong = form->wrong_header;
                return DPT_E_SYNTAX;
            }
            table->header = (uint32_t)index;
            table->columns = commas_in(form->headers[index]) + 1;
            continue;
        }
        if (!add_row(table, &room)) {
            *wrong = "memory ran out";
            return DPT_E_MEMORY;
        }
        double *row = table->values + table->rows * table->columns;
        *wrong = parse_row(at, stop, row, table->columns);
        if (!*wrong)
            *wrong = form->wrong_row(row, table->columns);
        if (!*wrong && table->rows && row[0] <= row[-(ptrdiff_t)table->columns])
            *wrong = "the first column does not increase";
        if (*wrong)
            return DPT_E_SYNTAX;
        table->rows++;
    }
    *wrong = table->rows ? NULL : "there are no rows";
    return *wrong ? DPT_E_SYNTAX : DPT_OK;
}

dpt_result table_read(struct table *table, const char *path, const struct table_form *form,
                      dpt_device_error *error)
{
    struct text text = { .count = 0 };
    *table = (struct table){ .rows = 0 };
    int file = open(path, O_RDONLY | O_CLOEXEC);
    if (file < 0)
        return device_error(error, DPT_E_OPEN, "%.160s: %s", path, strerror(errno));
    dpt_result result = read_all(&text, file);
    int reason = errno;
    close(file);
    if (result == DPT_E_OPEN)
        device_error(error, result, "%.160s: %s", path, strerror(reason));
    else if (result != DPT_OK)
        device_error(error, result, "%.160s: %s", path, dpt_result_text(result));
    if (result == DPT_OK) {
        uint64_t line = 0;
        const char *wrong;
        result = table_parse(table, text.bytes, text.bytes + text.count, form, &line, &wrong);
        if (result != DPT_OK)
            device_error(error, result, "%.160s:%" PRIu64 ": %s", path, line ? line : 1, wrong);
    }
    free(text.bytes);
    if (result != DPT_OK)
        table_free(table);
    return result;
}

void table_free(struct table *table)
{
    free(table->values);
    *table = (struct table){ .rows = 0 };
}
