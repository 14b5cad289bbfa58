/* SPDX-License-Identifier: BSD-3-Clause */
/* Report a replayed trace: the answer of each tick, and how long it took. */
#ifndef DPT_TOOLS_REPLAY_REPORT_H
#define DPT_TOOLS_REPLAY_REPORT_H

#include <stdio.h>

#include "csv.h"
#include "dynpoint.h"

struct replayed_tick {
    dpt_hit hit;
    dpt_wrench wrench;
    double energy;            /* J */
    uint32_t reason;          /* DPT_FORCE_... */
    uint32_t force_flags;     /* DPT_FORCE_FLAG_... */
    dpt_pose proxy;           /* with DPT_LAW_PROXY */
    double ns;                /* shortest time of all passes */
    uint32_t strip_triangles; /* triangles in the strip */
    uint32_t strip_flags;
};

/* Comparison with another method on some of the ticks. */
struct comparison {
    const char *method; /* NULL: no comparison */
    uint64_t ticks;
    uint64_t wrong_count;      /* distances that differ by more than the tolerance */
    uint64_t missed_crossings; /* of them: the axis crosses the mesh, and the replayed method did not find it */
    double error_max;          /* m */
    double tolerance;          /* m */
    double median_ns;          /* median time of a tick */
};

struct replayed {
    const struct csv_table *trace;
    struct replayed_tick *ticks;
    uint32_t until;
    uint32_t law;        /* DPT_LAW_... */
    uint32_t strip_kind; /* DPT_STRIP_KIND_... */
    size_t world_bytes;
    uint64_t mesh_bytes;
    double diagonal;
    double tip_error;                 /* m, of curved tips; 0: there are none */
    const struct curved_tips *curved; /* those that were felt without a proxy */
    uint32_t kernel;
    const char *method;
    struct comparison against;
};

/* Write the ticks as CSV, and the summary as a JSON object or as a table for people. */
void replay_write_csv(FILE *file, const struct replayed *replayed);
void replay_print_json(FILE *file, const struct replayed *replayed);
void replay_print_table(FILE *file, const struct replayed *replayed);

/* Sort numbers, and the nearest-rank percentile of sorted ones; `fraction` is 0..1. 0 if there are none. */
void sort_numbers(double *values, size_t count);
double percentile(const double *sorted, size_t count, double fraction);

#endif
