/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * TRACE.csv: the motion of a segment, a row a tick: tick,ax,ay,az,bx,by,bz in metres. Ticks are integers that increase,
 * within 2^53; blank lines are skipped, and those that begin with '#', blanks before it or not.
 */
#ifndef DPT_TOOLS_TRACE_H
#define DPT_TOOLS_TRACE_H

#include <stddef.h>
#include <stdint.h>

struct trace_row {
    int64_t tick;
    double ends[6];
};

struct trace {
    struct trace_row *rows;
    size_t count;
};

/* 0, or 2 after a complaint that names file and line. */
int trace_read(struct trace *trace, const char *command, const char *path);

/*
 * The text from `at` to `end` into an empty trace. NULL, or what is wrong in line *line, counted on from its value;
 * what was read until then is to be freed in either case.
 */
const char *trace_parse(struct trace *trace, const char *at, const char *end, uint64_t *line);
void trace_free(struct trace *trace);

/* A row that does not follow the one before by one tick jumps; the first row does. */
int trace_jumps(const struct trace *trace, size_t row);

#endif
