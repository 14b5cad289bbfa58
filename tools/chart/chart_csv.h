/* SPDX-License-Identifier: BSD-3-Clause */
/* A chart as text: the file's rows, one a setting, below lines that begin with #; and the table for people. */
#ifndef DPT_TOOLS_CHART_CSV_H
#define DPT_TOOLS_CHART_CSV_H

#include <stdio.h>

#include "chart/chart_bodies.h"
#include "chart/chart_rows.h"
#include "measure/measure_machine.h"

/* What was measured where. */
struct chart_head {
    const char *scene, *trace; /* as they were named; NULL: the trace was made */
    uint64_t seed;             /* of that */
    size_t ticks;
    uint32_t passes, repeats;
    struct measure_machine machine;
    struct chart_body body[DPT_ARM_BODIES_MAX];
    uint32_t body_count;
};

/* docs/chart.md says what the columns mean. A cell that does not apply is empty. */
void chart_csv_write(FILE *file, const struct chart_head *head, const struct chart_rows *rows);

/* How often a tick of a row took how long and how much work; bins without a tick are left out. */
void chart_histograms_write(FILE *file, const struct chart_rows *rows);

void chart_table_print(FILE *file, const struct chart_head *head, const struct chart_rows *rows);

#endif
