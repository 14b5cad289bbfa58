/* SPDX-License-Identifier: BSD-3-Clause */
/* A replayed trace: what each tick answered and how long it took. */
#ifndef DPT_TOOLS_REPLAY_REPORT_H
#define DPT_TOOLS_REPLAY_REPORT_H

#include <stdio.h>

#include "csv.h"
#include "dynpoint.h"

struct replayed_tick {
    dpt_hit hit;
    dpt_wrench wrench;
    double ns;                /* the least of all passes */
    uint32_t strip_triangles; /* triangles in it */
    uint32_t strip_flags;
};

/* The other method's answers on some of the ticks. */
struct comparison {
    const char *method; /* NULL: none was asked for */
    uint64_t ticks;
    uint64_t wrong_count;      /* distances that differ by more than the tolerance */
    uint64_t missed_crossings; /* of them: it crosses, and was not noticed */
    double error_max;          /* m */
    double tolerance;          /* m */
    double median_ns;          /* median per tick */
};

struct replayed {
    const struct csv_table *trace;
    struct replayed_tick *ticks;
    uint32_t until;
    uint32_t strip_kind; /* DPT_STRIP_... */
    size_t world_bytes;
    uint64_t mesh_bytes;
    double diagonal;
    uint32_t kernel;
    const char *method;
    struct comparison against;
};

/* OUT.csv, a JSON object, or a table for a person. */
void replay_write_csv(FILE *file, const struct replayed *replayed);
void replay_print_json(FILE *file, const struct replayed *replayed);
void replay_print_table(FILE *file, const struct replayed *replayed);

/* Sort and take the nearest-rank percentile, 0..1; 0 of none. */
void sort_numbers(double *values, size_t count);
double percentile(const double *sorted, size_t count, double fraction);

#endif
