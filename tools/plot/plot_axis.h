/* SPDX-License-Identifier: BSD-3-Clause */
/* An axis of a plot: a range of numbers on a range of pixels, round marks, and a unit with its SI prefix. */
#ifndef DPT_TOOLS_PLOT_AXIS_H
#define DPT_TOOLS_PLOT_AXIS_H

#include <stddef.h>
#include <stdint.h>

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

/* A logarithmic axis of a plot, which ends at 1, 2 or 5 times a power of ten. */

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

/*
 * A number as people read it, to so many significant digits and without an exponent: what is below 5e-10 is 0. With a
 * unit, also its SI prefix, as "7.9 ms"; of % without a prefix.
 */
enum { PLOT_NUMBER_ROOM = 48 };
void plot_number(double value, int digits, char text[PLOT_NUMBER_ROOM]);
void plot_quantity(double value, int digits, const char *unit, char text[PLOT_NUMBER_ROOM]);

/*
 * A line of a plot, taken point by point and kept in bounded memory however long it is. Neighbouring points are put
 * together in groups; each keeps its first, lowest, highest and last point, so no peak is lost. A group is narrower
 * than 1/2000 of the line's length, or it is a single point, or points at one place.
 */

enum { PLOT_GROUPS_MAX = 4096 };

struct plot_point {
    double x, y;
};

struct plot_group {
    struct plot_point first, low, high, last;
    uint64_t points;
    int is_start; /* the line does not come from the group before */
};

struct plot_line {
    struct plot_group *groups;
    size_t count;
    double width;  /* of a group; a power of two */
    int is_broken; /* the next point begins a new stretch */
};

/* Returns 0 if memory ran out. */
int plot_line_init(struct plot_line *line);
void plot_line_free(struct plot_line *line);

/*
 * Add a point, at or behind the last one. A y that is not finite, or beyond PLOT_VALUE_MAX, breaks the line instead. x is
 * finite and at most 1e15 in magnitude.
 */
void plot_line_add(struct plot_line *line, double x, double y);

/* The next point is not joined to the last one. */
void plot_line_break(struct plot_line *line);

/* All of `next`, which comes behind, joins the group. A break between the two is no longer seen. */
void plot_group_join(struct plot_group *group, const struct plot_group *next);

/* The lowest and the highest point, the first of each if there are several. The line is not empty. */
struct plot_group plot_line_extremes(const struct plot_line *line);

#endif
