/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The same rows, measured several times: what a machine does beside a chart shows in how far the repeats lie apart.
 *
 *     struct chart_rows *repeats = calloc(count, sizeof *repeats);
 *     ... chart_rows_list and chart_rows_measure of each ...
 *     chart_repeats_join(repeats, count);              repeats[0] is the chart
 */
#ifndef DPT_TOOLS_CHART_REPEATS_H
#define DPT_TOOLS_CHART_REPEATS_H

#include "chart/chart_rows.h"

enum { CHART_REPEATS_MAX = 99 };

/*
 * Join `count` repeats, 1 to CHART_REPEATS_MAX, into the first: each of its times becomes the middle one of the repeats (of
 * an even number the lower), its row's `least` and `most` are set, and its histograms are those of a repeat with the middle
 * median. Answers are the same in all. A peer that is not in each of them, as it failed, is left out.
 */
void chart_repeats_join(struct chart_rows *repeats, uint32_t count);

/* How far repeats lie apart: of all rows, the largest time as a multiple of the least; at least 1. */
struct chart_apart {
    double median_middle, median_most; /* of medians: in the middle row, and in the worst */
    double p99_middle, p99_most;       /* of the 99 % */
};
struct chart_apart chart_repeats_apart(const struct chart_rows *rows);

#endif
