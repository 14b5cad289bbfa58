/* SPDX-License-Identifier: BSD-3-Clause */
#include "chart/chart_json.h"

#include <inttypes.h>
#include <string.h>

#include "cli/json_text.h"
#include "text/parse_number.h"

enum { LINE_ROOM = 8192 };

/* The next cell of a line, and where the one behind it begins; NULL behind the last. */
static const char *next_cell(const char *cell, size_t *length)
{
    *length = strcspn(cell, ",\n");
    return cell[*length] == ',' ? cell + *length + 1 : NULL;
}

static void write_cell(FILE *file, const char *cell, size_t length)
{
    double number;
    if (!length)
        fputs("null", file);
    else if (parse_double(cell, cell + length, &number) == cell + length)
        fprintf(file, "%.*s", (int)length, cell);
    else
        json_write_part(file, cell, length);
}

static void write_row(FILE *file, const char *columns, const char *line)
{
    const char *between = "{";
    while (columns && line) {
        size_t name, length;
        const char *next_column = next_cell(columns, &name), *next = next_cell(line, &length);
        fputs(between, file);
        json_write_part(file, columns, name);
        putc(':', file);
        write_cell(file, line, length);
        between = ",";
        columns = next_column;
        line = next;
    }
    putc('}', file);
}

static void write_head(FILE *file, const struct chart_head *head)
{
    fputs("{\"scene\":", file);
    json_write_text(file, head->scene);
    fputs(",\"trace\":", file);
    if (head->trace)
        json_write_text(file, head->trace);
    else
        fputs("null", file);
    fprintf(file, ",\"seed\":%" PRIu64 ",\"ticks\":%zu,\"passes\":%" PRIu32 ",\"repeats\":%" PRIu32 ",\"processor\":",
            head->seed, head->ticks, head->passes, head->repeats);
    json_write_text(file, head->machine.processor);
    fputs(",\"version\":", file);
    json_write_text(file, head->machine.version);
    fputs(",\"kernel\":", file);
    json_write_text(file, head->machine.kernel);
}

int chart_json_write(FILE *file, const struct chart_head *head, const struct chart_rows *rows)
{
    char columns[LINE_ROOM] = "", line[LINE_ROOM];
    FILE *table = tmpfile();
    if (!table)
        return 1;
    chart_csv_write(table, head, rows);
    rewind(table);
    write_head(file, head);
    fputs(",\"rows\":[", file);
    for (int count = 0; fgets(line, sizeof line, table);) {
        if (line[0] == '#')
            continue;
        if (!columns[0]) {
            memcpy(columns, line, sizeof columns);
            continue;
        }
        fputs(count++ ? "," : "", file);
        write_row(file, columns, line);
    }
    fputs("]}\n", file);
    fclose(table);
    return 0;
}
