/* SPDX-License-Identifier: BSD-3-Clause */
#include "cli/csv_rows.h"

#include <errno.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "cli/command_options.h"
#include "text/open_file.h"

enum { BUFFER_BYTES = 1 << 20 };

int csv_rows_open(struct csv_rows *rows, const char *command, const char *path)
{
    *rows = (struct csv_rows){ .command = command, .path = path };
    rows->buffer = malloc(BUFFER_BYTES);
    if (!rows->buffer)
        return complain(command, "memory ran out");
    rows->file = strcmp(path, "-") ? open_file(path, "rb") : stdin;
    if (!rows->file)
        return complain(command, "%s: cannot be opened: %s", path, strerror(errno));
    return 0;
}

void csv_rows_close(struct csv_rows *rows)
{
    if (rows->file && rows->file != stdin)
        fclose(rows->file);
    free(rows->buffer);
}

int csv_rows_fail(const struct csv_rows *rows, const char *format, ...)
{
    char why[256];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(why, sizeof why, format, arguments);
    va_end(arguments);
    complain(rows->command, "%s:%" PRIu64 ": %s", rows->path, rows->line ? rows->line : 1, why);
    return -1;
}

int csv_cell_is(const struct csv_cell *cell, const char *text)
{
    const size_t length = strlen(text);
    return (size_t)(cell->end - cell->begin) == length && !memcmp(cell->begin, text, length);
}

/* Read on behind what is left of the buffer. Returns 1, or -1 after a message. */
static int fill(struct csv_rows *rows)
{
    rows->size -= rows->at;
    memmove(rows->buffer, rows->buffer + rows->at, rows->size);
    rows->at = 0;
    if (rows->size == BUFFER_BYTES) {
        rows->line++;
        return csv_rows_fail(rows, "the line is longer than 1 MiB");
    }
    const size_t got = fread(rows->buffer + rows->size, 1, BUFFER_BYTES - rows->size, rows->file);
    if (ferror(rows->file)) {
        complain(rows->command, "%s: cannot be read: %s", rows->path, strerror(errno));
        return -1;
    }
    rows->size += got;
    rows->bytes += got;
    rows->is_end = rows->size < BUFFER_BYTES;
    return 1;
}

/* The next line, without its end; the last one may lack it. Returns as csv_rows_next. */
static int next_line(struct csv_rows *rows, const char **begin, const char **end)
{
    const char *stop;
    while (!(stop = memchr(rows->buffer + rows->at, '\n', rows->size - rows->at)) && !rows->is_end)
        if (fill(rows) < 0)
            return -1;
    *begin = rows->buffer + rows->at;
    *end = stop ? stop : rows->buffer + rows->size;
    rows->at = (size_t)(*end - rows->buffer) + (stop != NULL);
    if (!stop && *begin == *end)
        return 0;
    if (++rows->line == 1 && *end - *begin >= 3 && !memcmp(*begin, "\xef\xbb\xbf", 3))
        *begin += 3;
    *end -= *end > *begin && (*end)[-1] == '\r';
    return 1;
}

static int is_blank(char c)
{
    return c == ' ' || c == '\t';
}

/* Cut the line at its commas. */
static int split(struct csv_rows *rows, const char *at, const char *end)
{
    rows->cells = 0;
    for (;;) {
        const char *comma = memchr(at, ',', (size_t)(end - at));
        struct csv_cell cell = { at, comma ? comma : end };
        if (rows->cells == CSV_CELLS_MAX)
            return csv_rows_fail(rows, "there are more than %d cells", CSV_CELLS_MAX);
        while (cell.begin < cell.end && is_blank(*cell.begin))
            cell.begin++;
        while (cell.begin < cell.end && is_blank(cell.end[-1]))
            cell.end--;
        rows->cell[rows->cells++] = cell;
        if (!comma)
            return 1;
        at = comma + 1;
    }
}

int csv_rows_next(struct csv_rows *rows)
{
    const char *begin, *end, *word;
    int found;
    while ((found = next_line(rows, &begin, &end)) > 0) {
        for (word = begin; word < end && is_blank(*word);)
            word++;
        if (word < end && *word != '#')
            return split(rows, begin, end);
    }
    return found;
}
