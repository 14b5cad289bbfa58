/* SPDX-License-Identifier: BSD-3-Clause */
/* An axis of a plot: a range of numbers on a range of pixels, round marks, and a unit with its SI prefix. */
#ifndef DPT_TOOLS_PLOT_AXIS_H
#define DPT_TOOLS_PLOT_AXIS_H

/* The largest magnitude that an axis takes, and that a plot draws. */
#define PLOT_VALUE_MAX 1e30

struct plot_axis {
    double low, high;   /* in the unit with its prefix */
    double first, last; /* marks: these two, and whole multiples of `step` between them */
    double step;        /* 1, 2 or 5 times a power of ten */
    double scale;       /* one of the unit with its prefix, in the unit alone */
    const char *prefix; /* "", "m", "u", "n" or "p" */
    double start, end;  /* pixels of low and high */
};

/*
 * Make an axis for the values from `low` to `high`, at most PLOT_VALUE_MAX in magnitude, on the pixels from `start` to
 * `end`. Values that are equal, or nearly so, get an axis of some length around or above them.
 *   marks      about how many marks there shall be: half as many up to one more
 *   is_whole   the axis begins and ends with a mark; else it has exactly these limits
 *
 * The prefix is the largest that leaves 1 or more of the larger magnitude.
 */
struct plot_axis plot_axis_make(double low, double high, double start, double end, int marks, int is_whole);

/* The pixel of a value, which is in the unit without prefix. */
double plot_axis_at(const struct plot_axis *axis, double value);

/* Write the number of the mark at `multiple` steps: no longer than needed to tell it from its neighbours. */
enum { PLOT_LABEL_ROOM = 32 };
void plot_axis_label(const struct plot_axis *axis, double multiple, char text[PLOT_LABEL_ROOM]);

#endif
