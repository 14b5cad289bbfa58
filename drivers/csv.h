/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Numbers in a CSV file: a header line, then rows of as many. LF or CRLF; blank lines and those with '#' are skipped, a
 * byte order mark too.
 */
#ifndef DPT_DRIVERS_CSV_H
#define DPT_DRIVERS_CSV_H

#include "dynpoint/device.h"

struct csv_table {
    double *values; /* rows * columns */
    size_t rows, columns;
    uint32_t header; /* which */
};

/* What a file may hold, and the reasons that are given where it does not. */
struct csv_format {
    const char *const *headers; /* those that are known, ended by NULL */
    const char *header_error;
    /* NULL, or what is wrong with a row; its numbers may be infinite. */
    const char *(*check_row)(const double *row, size_t columns);
};

/*
 * The text from `at` to `end` into an empty table. The first column must increase from row to row, and no row is an
 * error: DPT_E_SYNTAX, or DPT_E_MEMORY, with the reason in *wrong and the line in *line. What was read until then is to
 * be freed in either case.
 */
dpt_result csv_table_parse(struct csv_table *table, const char *at, const char *end,
                           const struct csv_format *format, uint64_t *line,
                           const char **line_error);

/*
 * The same of an open file, which may be a pipe: each row is checked when its line is there, and what is wrong in it
 * ends the reading, whatever may follow. A line is at most 1 MiB, all at most `most` bytes (DPT_E_LIMIT). Where *wrong is
 * NULL the error is of no line; DPT_E_OPEN: errno says why it cannot be read.
 */
dpt_result csv_table_stream(struct csv_table *table, int file, uint64_t max_bytes,
                            const struct csv_format *format, uint64_t *line,
                            const char **line_error);

/* The same of a file of 1 GiB at most; nothing is to be freed on error. `error` names file and line. */
dpt_result csv_table_read(struct csv_table *table, const char *path,
                          const struct csv_format *format, dpt_device_error *error);
void csv_table_free(struct csv_table *table);

static inline const double *csv_table_row(const struct csv_table *table, size_t row)
{
    return table->values + row * table->columns;
}

#endif
