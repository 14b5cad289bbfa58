/* SPDX-License-Identifier: BSD-3-Clause */
#include "trace.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common.h"
#include "compile/number.h"

/* From here on a double does not tell neighbours apart. */
#define TICKS_END 0x1p53

static const char header[] = "tick,ax,ay,az,bx,by,bz";

static const char *skip_blanks(const char *at, const char *end)
{
    while (at < end && (*at == ' ' || *at == '\t'))
        at++;
    return at;
}

/* One field and the comma behind it; NULL when it is no number. */
static const char *next_field(const char *at, const char *end, int last, double *value)
{
    at = parse_double(skip_blanks(at, end), end, value);
    if (!at)
        return NULL;
    at = skip_blanks(at, end);
    if (last)
        return at == end ? at : NULL;
    return at < end && *at == ',' ? at + 1 : NULL;
}

static int fields_in(const char *at, const char *end)
{
    int fields = 1;
    for (; at < end; at++)
        fields += *at == ',';
    return fields;
}

/* NULL, or what is wrong with the line. */
static const char *parse_row(const char *at, const char *end, struct trace_row *row)
{
    double tick;
    if (fields_in(at, end) != 7)
        return "not 7 fields";
    at = next_field(at, end, 0, &tick);
    if (!at || tick != floor(tick))
        return "the tick is not an integer";
    if (!(fabs(tick) < TICKS_END))
        return "the tick is not within 2^53";
    row->tick = (int64_t)tick;
    for (int i = 0; i < 6; i++) {
        at = next_field(at, end, i == 5, &row->ends[i]);
        if (!at)
            return "a field is not a number";
        if (!(fabs(row->ends[i]) <= DPT_COORDINATE_MAX))
            return "a coordinate is beyond 1e6 m";
    }
    return NULL;
}

static int add_row(struct trace *trace, size_t *room, const struct trace_row *row)
{
    if (trace->count == *room) {
        size_t more = *room ? 2 * *room : 1024;
        struct trace_row *grown = realloc(trace->rows, more * sizeof *grown);
        if (!grown)
            return 0;
        trace->rows = grown;
        *room = more;
    }
    trace->rows[trace->count++] = *row;
    return 1;
}

const char *trace_parse(struct trace *trace, const char *at, const char *end, uint64_t *line)
{
    size_t room = 0;
    int seen_header = 0;
    for (const char *next; at < end; at = next) {
        const char *stop = memchr(at, '\n', (size_t)(end - at));
        next = stop ? stop + 1 : end;
        stop = stop ? stop : end;
        stop -= stop > at && stop[-1] == '\r';
        ++*line;
        const char *word = skip_blanks(at, stop);
        if (word == stop || *word == '#')
            continue;
        if (!seen_header) {
            if ((size_t)(stop - at) != strlen(header) || memcmp(at, header, strlen(header)))
                return "the header is not tick,ax,ay,az,bx,by,bz";
            seen_header = 1;
            continue;
        }
        struct trace_row row;
        const char *wrong = parse_row(at, stop, &row);
        if (wrong)
            return wrong;
        if (trace->count && row.tick <= trace->rows[trace->count - 1].tick)
            return "the tick does not increase";
        if (!add_row(trace, &room, &row))
            return "memory ran out";
    }
    return trace->count ? NULL : "no ticks";
}

int trace_read(struct trace *trace, const char *command, const char *path)
{
    size_t size;
    uint64_t line = 0;
    *trace = (struct trace){ .count = 0 };
    char *text = load_file(command, path, &size);
    if (!text)
        return 2;
    const char *wrong = trace_parse(trace, text, text + size, &line);
    free(text);
    if (!wrong)
        return 0;
    trace_free(trace);
    return complain(command, "%s:%" PRIu64 ": %s", path, line ? line : 1, wrong);
}

void trace_free(struct trace *trace)
{
    free(trace->rows);
    *trace = (struct trace){ .count = 0 };
}

int trace_jumps(const struct trace *trace, size_t row)
{
    return row == 0 || trace->rows[row].tick != trace->rows[row - 1].tick + 1;
}
