/* SPDX-License-Identifier: BSD-3-Clause */
/* A chart as a picture: time against error, in a panel for each question that a row answers. */
#ifndef DPT_TOOLS_CHART_PICTURE_H
#define DPT_TOOLS_CHART_PICTURE_H

#include <stdio.h>

#include "chart/chart_rows.h"

/* Write the joined rows of `repeats`. Returns 0, or -1 if memory ran out, and nothing is written. */
int chart_picture_write(FILE *file, const struct chart_rows *rows, uint32_t repeats, const char *title,
                        const char *subtitle);

#endif
