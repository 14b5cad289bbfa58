/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Read a CSV file row by row, whatever its length: cells of any text, some of them empty. Lines end in LF or CRLF. Blank
 * lines, lines that begin with '#' and a byte order mark are skipped. There are no quotes. (csv.h reads a table of
 * numbers as a whole.)
 */
#ifndef DPT_TOOLS_CSV_ROWS_H
#define DPT_TOOLS_CSV_ROWS_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

enum { CSV_CELLS_MAX = 256 };

/* The text of a cell, without the blanks around it. */
struct csv_cell {
    const char *begin, *end;
};

struct csv_rows {
    FILE *file;
    const char *command, *path; /* for messages */
    char *buffer;
    size_t size, at; /* of the buffer: bytes in it, and the next line */
    uint64_t bytes;  /* of the file, up to the end of the buffer */
    int is_end;
    uint64_t line; /* number of the last one, from 1 */
    struct csv_cell cell[CSV_CELLS_MAX];
    size_t cells;
};

/* Open the file; "-" is standard input. Returns 0, or 2 after a message. Call csv_rows_close also after a failure. */
int csv_rows_open(struct csv_rows *rows, const char *command, const char *path);
void csv_rows_close(struct csv_rows *rows);

/* Read the next row into `cell`, which stays until the next call. Returns 1, 0 at the end, or -1 after a message. */
int csv_rows_next(struct csv_rows *rows);

/* Say what is wrong in the last line; returns -1. */
int csv_rows_fail(const struct csv_rows *rows, const char *format, ...)
#ifdef __GNUC__
    __attribute__((format(printf, 2, 3)))
#endif
    ;

int csv_cell_is(const struct csv_cell *cell, const char *text);

#endif
