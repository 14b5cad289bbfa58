/* SPDX-License-Identifier: BSD-3-Clause */
/* A chart as text: the file's rows, one a setting, below lines that begin with #; and the table for people. */
#ifndef DPT_TOOLS_CHART_CSV_H
#define DPT_TOOLS_CHART_CSV_H

#include <stdio.h>

#include "chart/chart_rows.h"
#include "measure/measure_setting.h"

/* What a chart was measured over, and on which machine. */
struct chart_head {
    const char *scene, *trace; /* as they were named; NULL: the trace was made */
    uint64_t seed;             /* of a made trace */
    size_t ticks;
    uint32_t passes, repeats;
    struct measure_machine machine;
    struct chart_body body[DPT_ARM_BODIES_MAX];
    uint32_t body_count;
};

/* docs/chart.md says what the columns mean. A cell that does not apply is empty. */
void chart_csv_write(FILE *file, const struct chart_head *head, const struct chart_rows *rows);

/* Each row's histograms of time and of work a tick. Empty bins are left out. */
void chart_histograms_write(FILE *file, const struct chart_rows *rows);

void chart_table_print(FILE *file, const struct chart_head *head, const struct chart_rows *rows);

/*
 * Repeats of the same rows. Their spread shows how much other load on the machine disturbs the times.
 *
 *     struct chart_rows *repeats = calloc(count, sizeof *repeats);
 *     ... chart_rows_list and chart_rows_measure of each ...
 *     chart_repeats_join(repeats, count);              repeats[0] is the chart
 */

enum { CHART_REPEATS_MAX = 99 };

/*
 * Join `count` repeats, 1 to CHART_REPEATS_MAX, into the first: each of its times becomes the middle one of the repeats (of
 * an even number the lower), its row's `min` and `max` are set, and its histograms are those of a repeat with the middle
 * median. Answers are the same in all. A peer that is not in each of them, as it failed, is left out.
 */
void chart_repeats_join(struct chart_rows *repeats, uint32_t count);

/* How far repeats lie apart: of all rows, the largest time as a multiple of the least; at least 1. */
struct chart_apart {
    double median_middle, median_max; /* of medians: in the middle row, and in the worst */
    double p99_middle, p99_max;       /* of the 99 % */
};
struct chart_apart chart_repeats_apart(const struct chart_rows *rows);

#endif
