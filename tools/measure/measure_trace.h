/* SPDX-License-Identifier: BSD-3-Clause */
/* Traces to measure a scene by: of a file, or a hand's that slides over a body of the scene (trace_hand.h). */
#ifndef DPT_TOOLS_MEASURE_TRACE_H
#define DPT_TOOLS_MEASURE_TRACE_H

#include "csv.h"
#include "scene/scene.h"

/* What a trace is made of. */
struct measure_hand {
    uint32_t body; /* its number in the scene */
    uint64_t seed;
    size_t ticks;               /* at least 1; 1 ms each */
    double length, band, speed; /* as for trace_hand_begin; 0: its defaults, for the body's size */
    int stands;                 /* the tool stands on its tip */
};

/*
 * Make a trace in the scene's frame: over the body where it stands, before it gives way. Returns 0, or 2 after a
 * message. csv_table_free frees it.
 */
int measure_trace_make(struct csv_table *trace, const struct scene *scene, const struct measure_hand *hand);

/* Read a trace of at least so many ticks. Returns 0, or 2 after a message, with nothing to free. */
int measure_trace_read(struct csv_table *trace, const char *command, const char *path, size_t least);

#endif
