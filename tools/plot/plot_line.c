/* SPDX-License-Identifier: BSD-3-Clause */
#include "plot/plot_line.h"

#include <math.h>
#include <stdlib.h>

#include "plot/plot_axis.h"

/* Below the distance of two samples of any device. */
static const double FIRST_WIDTH = 1.0 / (1 << 30);

int plot_line_init(struct plot_line *line)
{
    *line = (struct plot_line){ .width = FIRST_WIDTH, .is_broken = 1 };
    line->groups = malloc(PLOT_GROUPS_MAX * sizeof *line->groups);
    return line->groups != NULL;
}

void plot_line_free(struct plot_line *line)
{
    free(line->groups);
    *line = (struct plot_line){ .count = 0 };
}

void plot_group_join(struct plot_group *group, const struct plot_group *next)
{
    if (next->low.y < group->low.y)
        group->low = next->low;
    if (next->high.y > group->high.y)
        group->high = next->high;
    group->last = next->last;
    group->points += next->points;
}

/* A group is all that begins in one interval of the width. */
static int is_one_group(const struct plot_line *line, double a, double b)
{
    return floor(a / line->width) == floor(b / line->width);
}

/*
 * Double the width until a quarter of the groups is free. They lie in as many different intervals, so at least half of
 * them remain, and the width is below 1/2000 of the line's length.
 */
static void make_room(struct plot_line *line)
{
    while (line->count > PLOT_GROUPS_MAX * 3 / 4) {
        size_t kept = 0;
        line->width *= 2.0;
        for (size_t i = 1; i < line->count; i++) {
            if (is_one_group(line, line->groups[kept].first.x, line->groups[i].first.x))
                plot_group_join(&line->groups[kept], &line->groups[i]);
            else
                line->groups[++kept] = line->groups[i];
        }
        line->count = kept + 1;
    }
}

void plot_line_add(struct plot_line *line, double x, double y)
{
    if (!(fabs(y) <= PLOT_VALUE_MAX)) {
        plot_line_break(line);
        return;
    }
    if (line->count == PLOT_GROUPS_MAX)
        make_room(line);
    const struct plot_point point = { x, y };
    const struct plot_group group = { point, point, point, point, 1, line->is_broken };
    struct plot_group *last = line->count ? &line->groups[line->count - 1] : NULL;
    line->is_broken = 0;
    if (last && is_one_group(line, last->first.x, x)) {
        plot_group_join(last, &group);
        return;
    }
    line->groups[line->count++] = group;
}

void plot_line_break(struct plot_line *line)
{
    line->is_broken = 1;
}

struct plot_group plot_line_extremes(const struct plot_line *line)
{
    struct plot_group all = line->groups[0];
    for (size_t i = 1; i < line->count; i++)
        plot_group_join(&all, &line->groups[i]);
    return all;
}
