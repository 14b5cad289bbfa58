/* SPDX-License-Identifier: BSD-3-Clause */
/* How the stylus moved in a run, as a trace (F.csv): kept in memory, because a tick must not write. */
#ifndef DPT_TOOLS_RUN_TRACE_H
#define DPT_TOOLS_RUN_TRACE_H

#include "cli/command_options.h"
#include "dynpoint/types.h"

/* 1 if the path ends in .csv: a trace is wanted, and no recording. */
int is_trace_name(const char *path);

#define RUN_TRACE_MAX 100000000

/* Begin with zeros. */
struct run_trace {
    double *rows; /* six numbers a tick, or NULL */
    uint64_t count, capacity;
    struct output output; /* opened before anything moves, so that an error shows at once */
};

int run_trace_open(struct run_trace *trace, const char *path);

/* Make room. Returns 0, or 2 after a message. */
int run_trace_allocate(struct run_trace *trace, uint64_t capacity);

/* Without a trace, or without room, it does nothing. */
void run_trace_tick(struct run_trace *trace, const dpt_segment *stylus);

/* Returns 0, or 2 after a message. */
int run_trace_write(struct run_trace *trace);

/* Drop what was not written. */
void run_trace_close(struct run_trace *trace);

#endif
