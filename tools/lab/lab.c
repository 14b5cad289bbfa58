/* SPDX-License-Identifier: BSD-3-Clause */
#include "lab/lab.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *lab_method_name(int method)
{
    static const char *const names[LAB_METHODS] = { "point", "bed", "proxy", "ball" };
    return names[method];
}

/* Room for one more; 0 where memory ran out. */
static int grow(struct lab *lab, void **items, size_t count, size_t *room, size_t size)
{
    if (count < *room)
        return 1;
    const size_t wanted = *room ? 2 * *room : 64;
    void *grown = realloc(*items, wanted * size);
    if (!grown) {
        lab->is_out_of_memory = 1;
        return 0;
    }
    *items = grown;
    *room = wanted;
    return 1;
}

static void add_figure(struct lab *lab, struct lab_figure figure)
{
    void *figures = lab->figures;
    const int has_room = grow(lab, &figures, lab->figure_count, &lab->figure_room, sizeof *lab->figures);
    lab->figures = figures;
    if (has_room)
        lab->figures[lab->figure_count++] = figure;
}

void lab_at_most(struct lab *lab, const char *method, const char *what, double value, const char *unit, double limit)
{
    add_figure(lab, (struct lab_figure){ method, what, unit, value, limit, 0 });
}

void lab_at_least(struct lab *lab, const char *method, const char *what, double value, const char *unit, double limit)
{
    add_figure(lab, (struct lab_figure){ method, what, unit, value, limit, 1 });
}

void lab_note(struct lab *lab, const char *method, const char *what, double value, const char *unit)
{
    add_figure(lab, (struct lab_figure){ method, what, unit, value, HUGE_VAL, 0 });
}

void lab_point_at(struct lab *lab, const char *chart, const char *series, double x, double y)
{
    void *points = lab->points;
    const int has_room = grow(lab, &points, lab->point_count, &lab->point_room, sizeof *lab->points);
    lab->points = points;
    if (has_room)
        lab->points[lab->point_count++] = (struct lab_point){ chart, series, x, y };
}

int lab_figure_holds(const struct lab_figure *figure)
{
    return figure->is_at_least ? figure->value >= figure->limit : figure->value <= figure->limit;
}

uint64_t lab_share(const struct lab *lab, uint64_t whole)
{
    const double share = floor(lab->effort * (double)whole + 0.5);
    return share >= 1.0 ? (uint64_t)share : 1;
}

void lab_run(struct lab *lab, const struct lab_case *which, double effort)
{
    memset(lab, 0, sizeof *lab);
    lab->effort = effort;
    which->run(lab);
}

void lab_free(struct lab *lab)
{
    free(lab->figures);
    free(lab->points);
}
