/* SPDX-License-Identifier: BSD-3-Clause */
/* A chart as one JSON object, for programs. */
#ifndef DPT_TOOLS_CHART_JSON_H
#define DPT_TOOLS_CHART_JSON_H

#include "chart/chart_csv.h"

/*
 * Write what the chart is of, and an object a setting whose keys are the columns of the CSV; an empty cell is null. Returns 0,
 * or 1 if there is no temporary file.
 */
int chart_json_write(FILE *file, const struct chart_head *head, const struct chart_rows *rows);

#endif
