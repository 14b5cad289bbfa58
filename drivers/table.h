/* SPDX-License-Identifier: BSD-3-Clause */
/* Numbers in a CSV file: a header line, then rows of as many. LF or CRLF; blank lines and those with '#' are skipped. */
#ifndef DPT_DRIVERS_TABLE_H
#define DPT_DRIVERS_TABLE_H

#include "dynpoint/driver.h"

struct table {
    double *values; /* rows * columns */
    size_t rows, columns;
    uint32_t header; /* which */
};

/*
 * `headers`, ended by NULL, are those that are known; the first column must increase from row to row. No row is an
 * error. `error` names file and line.
 */
dpt_result table_read(struct table *table, const char *path, const char *const *headers,
                      dpt_device_error *error);
void table_free(struct table *table);

#endif
