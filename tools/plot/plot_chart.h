/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A chart of lines as an SVG: panels below each other with one horizontal axis, and in each the lines of one or two
 * series. It knows nothing of what the lines mean.
 *
 * Two series are told apart by weight and lightness: the first is wide and light, the second thin and dark, and lies
 * upon it. So both are seen where they are the same, also in grey. Dashes are not used: they would look like gaps.
 * All is on an opaque white ground, so a dark page does not matter.
 */
#ifndef DPT_TOOLS_PLOT_CHART_H
#define DPT_TOOLS_PLOT_CHART_H

#include <stdio.h>

#include "plot/plot_axis.h"

enum { PLOT_SERIES_MAX = 2, PLOT_PANELS_MAX = 8 };

/* A panel; its vertical axis has a zero. */
struct plot_panel {
    const char *name;
    const char *unit;                              /* without prefix */
    double high_min;                               /* length of the axis if all values are 0 */
    const struct plot_line *line[PLOT_SERIES_MAX]; /* of each series, with a point at least */
};

struct plot_series {
    const char *name;   /* cut at its front if it is too long */
    const char *detail; /* behind it, whole */
};

struct plot_chart {
    const char *title;       /* any bytes; cut at its end if it is too long, but whole for a screen reader */
    const char *description; /* for a screen reader: what one would see */
    struct plot_series series[PLOT_SERIES_MAX];
    struct plot_panel panel[PLOT_PANELS_MAX];
    int series_count, panel_count;
    const char *x_name, *x_unit;
    double x_low, x_high; /* no point lies outside */
};

/*
 * Write the chart, 760 pixels wide. A column of pixels shows the lowest and the highest of its points, and a line has at
 * most four points there, so the size does not depend on the number of points. The same chart gives the same bytes.
 * Call ferror for what failed.
 */
void plot_chart_write(FILE *file, const struct plot_chart *chart);

#endif
