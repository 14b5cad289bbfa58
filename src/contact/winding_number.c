/* SPDX-License-Identifier: BSD-3-Clause */
#include "contact/winding_number.h"

#include "base/angle.h"

/* Of WINDING_ERROR the part of the series; the rest is for rounding. */
#define SERIES_ERROR (0.9 * WINDING_ERROR)

/*
 * What one set of triangles may be wrong by at first, over the levels: of a smooth surface each level adds about as
 * much. Where the sum is too much, all is looked at again, for less; of the surface that is left the sum falls as a
 * root of it, or a little faster.
 */
#define FIRST_DOUBT 5e-4f
#define LESS        0.25f
#define PASSES      8

/* Beyond that, in half widths of the mesh, what is left of the winding number is below 1e-9. */
#define FAR 0x1p20

struct winding_traversal {
    const struct surface *surface;
    const struct kernel *kernel;
    const float *moments;
    const uint32_t *solid_lanes; /* a word a leaf: lanes that count */
    vec3 x;
    float x_filter[3]; /* x in the filter's frame */
    float winding[LANES], error[LANES];
    double exact; /* sum over the triangles that were evaluated in double */
    struct work *work;
};

static double sum_of(const float *lanes)
{
    double sum = 0.0;
    for (int i = 0; i < LANES; i++)
        sum += (double)lanes[i];
    return sum;
}

static vec3 corner_from_x(const struct winding_traversal *view, uint32_t triangle, uint32_t k)
{
    uint32_t v = view->surface->corners[3 * (size_t)triangle + k];
    return sub(vec3_of_float(view->surface->positions + 3 * (size_t)v), view->x);
}

static void sum_leaf(struct winding_traversal *view, uint32_t leaf)
{
    uint32_t lanes = view->solid_lanes[leaf];
    if (!lanes)
        return;
    const float *rows = view->surface->leaves + (size_t)leaf * MESH_LEAF_WORDS;
    uint32_t open = view->kernel->angles(rows, view->x_filter, lanes, view->winding);
    work_spend(view->work, 1);
    for (; open; open &= open - 1) {
        uint32_t t = leaf * LANES + first_lane(open);
        view->exact += solid_turns(corner_from_x(view, t, 0), corner_from_x(view, t, 1),
                                   corner_from_x(view, t, 2));
    }
}

/* The children that must be looked into; the others are added. */
static uint32_t sum_node(struct winding_traversal *view, uint32_t level, uint32_t node, float most)
{
    const struct surface *surface = view->surface;
    size_t row = surface->first[level] - surface->first[1] + node;
    uint32_t children = lanes_of(surface->count[level - 1] - node * LANES);
    work_spend(view->work, 1);
    return children & view->kernel->moments(view->moments + row * MESH_MOMENT_WORDS, view->x_filter,
                                            most, view->winding, view->error);
}

static double sum_tree(struct winding_traversal *view, float most)
{
    uint32_t node[MESH_LEVELS_MAX + 1], open[MESH_LEVELS_MAX + 1];
    uint32_t top = view->surface->levels, level = top;
    memset(view->winding, 0, sizeof view->winding);
    memset(view->error, 0, sizeof view->error);
    view->exact = 0.0;
    node[level] = 0;
    open[level] = sum_node(view, level, 0, most);
    while (level <= top) {
        if (work_is_spent(view->work))
            return HUGE_VAL;
        if (!open[level]) {
            level++;
            continue;
        }
        uint32_t child = node[level] * LANES + first_lane(open[level]);
        open[level] &= open[level] - 1;
        if (level == 1) {
            sum_leaf(view, child);
        } else {
            node[--level] = child;
            open[level] = sum_node(view, level, child, most);
        }
    }
    return sum_of(view->error);
}

/* Comparisons are such that NaN, which a forged file can yield, ends as 0. */
double dpti_winding_number(const struct surface *surface, const struct kernel *kernel, vec3 x,
                           struct work *work)
{
    struct winding_traversal view = { .surface = surface, .kernel = kernel, .x = x, .work = work };
    view.moments = surface_moments(surface, &view.solid_lanes);
    vec3 at = scaled(sub(x, surface->filter_centre), surface->filter_scale);
    if (!view.moments || !within(at.x, FAR) || !within(at.y, FAR) || !within(at.z, FAR))
        return 0.0;
    view.x_filter[0] = (float)at.x;
    view.x_filter[1] = (float)at.y;
    view.x_filter[2] = (float)at.z;
    float most_doubt = FIRST_DOUBT / (float)surface->levels;
    double doubt = sum_tree(&view, most_doubt);
    for (int pass = 1; !(doubt <= SERIES_ERROR) && pass < PASSES && !work_is_spent(work); pass++) {
        float share = (float)(SERIES_ERROR / doubt);
        most_doubt *= share * share < LESS ? share * share : LESS;
        doubt = sum_tree(&view, most_doubt);
    }
    if (work_is_spent(work))
        return HUGE_VAL;
    double winding = sum_of(view.winding) + view.exact;
    return fabs(winding) <= (double)surface_triangles(surface) ? winding : 0.0;
}
