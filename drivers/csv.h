/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Read a CSV file of numbers: a header line, then rows with as many numbers as the header has names. Lines end in LF or
 * CRLF. Blank lines, lines that begin with '#' and a byte order mark are skipped.
 */
#ifndef DPT_DRIVERS_CSV_H
#define DPT_DRIVERS_CSV_H

#include "dynpoint/device.h"

struct csv_table {
    double *values; /* rows * columns */
    size_t rows, columns;
    uint32_t header; /* index into csv_format.headers */
};

/* What a file may contain, and the messages if it does not. */
struct csv_format {
    const char *const *headers; /* allowed header lines, ended by NULL */
    const char *header_error;   /* message if the header line is none of them */
    /* Returns NULL, or a message that says what is wrong with the row. Its numbers may be infinite. */
    const char *(*check_row)(const double *row, size_t columns);
};

/*
 * Parse the text from `at` to `end` into an empty table. The first column must increase from row to row, and there must
 * be at least one row. The caller frees the table after an error, too.
 *   line         the number of the last line that was read, from 1
 *   line_error   what is wrong with that line; NULL without an error
 *
 * DPT_E_SYNTAX, DPT_E_MEMORY
 */
dpt_result csv_table_parse(struct csv_table *table, const char *at, const char *end, const struct csv_format *format,
                           uint64_t *line, const char **line_error);

/*
 * The same from an open file, which may be a pipe. Each row is checked as soon as its line is complete; the first bad
 * row ends the reading. A line has at most 1 MiB. If *line_error is NULL after an error, no single line is the cause.
 *
 * DPT_E_LIMIT: the file has more than `max_bytes`. DPT_E_OPEN: it cannot be read; errno says why.
 */
dpt_result csv_table_stream(struct csv_table *table, int file, uint64_t max_bytes, const struct csv_format *format,
                            uint64_t *line, const char **line_error);

/*
 * The same from the file at `path`, of at most 1 GiB. After an error there is nothing to free; `error` names file and
 * line.
 */
dpt_result csv_table_read(struct csv_table *table, const char *path, const struct csv_format *format,
                          dpt_device_error *error);
void csv_table_free(struct csv_table *table);

/* The numbers of a row, counted from 0. */
static inline const double *csv_table_row(const struct csv_table *table, size_t row)
{
    return table->values + row * table->columns;
}

/*
 * The format of a trace, the motion of a segment: one row a tick, "tick,ax,ay,az,bx,by,bz". Ticks are increasing
 * integers within 2^53. Coordinates are in the world frame, in m, within DPT_COORDINATE_MAX.
 */

extern const struct csv_format trace_format;

/* 1 if the motion jumps to this row: it is the first, or its tick is not that of the row before plus 1. */
int trace_is_jump(const struct csv_table *trace, size_t row);

#endif
