/* SPDX-License-Identifier: BSD-3-Clause */
/* A logarithmic axis of a plot, which ends at 1, 2 or 5 times a power of ten. */
#ifndef DPT_TOOLS_PLOT_LOG_AXIS_H
#define DPT_TOOLS_PLOT_LOG_AXIS_H

struct plot_log_axis {
    double low, high;  /* above 0, in the unit */
    double start, end; /* pixels of these */
    double room;       /* pixels that a mark's label needs */
};

/*
 * An axis that holds the values from `low` to `high`, above 0, on the pixels from `start` to `end`. Its ends are the
 * nearest 1, 2 or 5 times a power of ten beyond them; it is at least a decade long.
 */
struct plot_log_axis plot_log_axis_make(double low, double high, double start, double end, double room);

/* The pixel of a value above 0. */
double plot_log_axis_at(const struct plot_log_axis *axis, double value);

/*
 * The marks, from the lowest on: 1, 2 and 5 times powers of ten, or where labels would meet, the powers alone, or each second
 * or third of these. Pass 0 first; 0 ends them.
 */
double plot_log_axis_next(const struct plot_log_axis *axis, double mark);

/* The number of a mark with its unit and the unit's SI prefix, as "20 um"; of % without a prefix. */
enum { PLOT_MARK_ROOM = 32 };
void plot_log_axis_label(double mark, const char *unit, char text[PLOT_MARK_ROOM]);

#endif
