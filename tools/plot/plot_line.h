/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A line of a plot, taken point by point and kept in bounded memory however long it is. Neighbouring points are put
 * together in groups; each keeps its first, lowest, highest and last point, so no peak is lost. A group is narrower
 * than 1/2000 of the line's length, or it is a single point, or points at one place.
 */
#ifndef DPT_TOOLS_PLOT_LINE_H
#define DPT_TOOLS_PLOT_LINE_H

#include <stddef.h>
#include <stdint.h>

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
