/* SPDX-License-Identifier: BSD-3-Clause */
#include "contact/winding_number.h"

#include "base/angle.h"

/* The series' part of WINDING_ERROR; the rest is for rounding. */
#define SERIES_ERROR (0.9 * WINDING_ERROR)

/*
 * The error that one set of triangles may have in the first pass, divided by the number of levels, since each level of
 * a smooth surface adds about as much. If the sum of the errors is too large, another pass uses a smaller limit. The
 * sum falls like the square root of that limit, or a little faster.
 */
#define FIRST_NODE_ERROR  5e-4f
#define NODE_ERROR_SHRINK 0.25f
#define PASSES_MAX        8

/* Farther away than this, in half widths of the mesh, the winding number is below 1e-9. */
#define DISTANCE_MAX 0x1p20

struct winding_traversal {
    const struct surface *surface;
    const struct kernel *kernel;
    const float *moments;
    const uint32_t *solid_lanes;        /* a word a leaf: lanes of triangles of solid parts */
    vec3 x;                             /* in the mesh's frame */
    float x_filter[3];                  /* in the filter's frame */
    float winding[LANES], error[LANES]; /* sums by lane, in turns */
    double exact;                       /* sum over the triangles that are evaluated in double, in turns */
    struct work *work;
};

static double sum_of(const float *lanes)
{
    double sum = 0.0;
    for (int i = 0; i < LANES; i++)
        sum += (double)lanes[i];
    return sum;
}

/* Corner k of a triangle, a place, as seen from x. */
static vec3 corner_from_x(const struct winding_traversal *traversal, uint32_t triangle, uint32_t k)
{
    uint32_t vertex = traversal->surface->corners[3 * (size_t)triangle + k];
    return sub(vec3_of_float(traversal->surface->positions + 3 * (size_t)vertex), traversal->x);
}

/* Add the triangles of a leaf. */
static void sum_leaf(struct winding_traversal *traversal, uint32_t leaf)
{
    uint32_t lanes = traversal->solid_lanes[leaf];
    if (!lanes)
        return;
    const float *rows = surface_leaf(traversal->surface, leaf, traversal->work);
    uint32_t open = traversal->kernel->angles(rows, traversal->x_filter, lanes, traversal->winding);
    work_spend(traversal->work, 1);
    for (; open; open &= open - 1) {
        uint32_t triangle = leaf * LANES + first_lane(open);
        traversal->exact += solid_turns(corner_from_x(traversal, triangle, 0), corner_from_x(traversal, triangle, 1),
                                        corner_from_x(traversal, triangle, 2));
    }
}

/* Add the series of a node's children whose error is at most max_error. Returns the lanes of the others. */
static uint32_t sum_node(struct winding_traversal *traversal, uint32_t level, uint32_t node, float max_error)
{
    const struct surface *surface = traversal->surface;
    size_t row = surface->first[level] - surface->first[1] + node;
    uint32_t children = lanes_of(surface->count[level - 1] - node * LANES);
    work_spend(traversal->work, 1);
    return children & traversal->kernel->moments(traversal->moments + row * MESH_MOMENT_WORDS, traversal->x_filter,
                                                 max_error, traversal->winding, traversal->error);
}

/* Sum over the whole tree. Returns a bound of the error, or HUGE_VAL if the work was spent before. */
static double sum_tree(struct winding_traversal *traversal, float max_error)
{
    uint32_t node[MESH_LEVELS_MAX + 1], open[MESH_LEVELS_MAX + 1];
    uint32_t top = traversal->surface->levels, level = top;
    memset(traversal->winding, 0, sizeof traversal->winding);
    memset(traversal->error, 0, sizeof traversal->error);
    traversal->exact = 0.0;
    node[level] = 0;
    open[level] = sum_node(traversal, level, 0, max_error);
    while (level <= top) {
        if (work_is_spent(traversal->work))
            return HUGE_VAL;
        if (!open[level]) {
            level++;
            continue;
        }
        uint32_t child = node[level] * LANES + first_lane(open[level]);
        open[level] &= open[level] - 1;
        if (level == 1) {
            sum_leaf(traversal, child);
        } else {
            node[--level] = child;
            open[level] = sum_node(traversal, level, child, max_error);
        }
    }
    return sum_of(traversal->error);
}

/* Leaves after which the sums in float are put aside. */
enum { LEAVES_SUMMED = 16 };

/*
 * A deformable body has no moments: they would have to be made anew for whatever moved, which takes longer than to look
 * at all of its triangles. Returns HUGE_VAL if the work was spent before.
 */
static double sum_leaves(struct winding_traversal *traversal)
{
    const uint32_t leaves = traversal->surface->count[0];
    double sum = 0.0;
    traversal->exact = 0.0;
    for (uint32_t leaf = 0; leaf < leaves; leaf++) {
        if (leaf % LEAVES_SUMMED == 0) {
            sum += leaf ? sum_of(traversal->winding) : 0.0;
            memset(traversal->winding, 0, sizeof traversal->winding);
        }
        if (work_is_spent(traversal->work))
            return HUGE_VAL;
        sum_leaf(traversal, leaf);
    }
    return sum + sum_of(traversal->winding) + traversal->exact;
}

/* The comparisons turn NaN, which a forged file can yield, into 0. */
double dpti_winding_number(const struct surface *surface, const struct kernel *kernel, vec3 x, struct work *work)
{
    struct winding_traversal traversal = { .surface = surface, .kernel = kernel, .x = x, .work = work };
    traversal.moments = surface_moments(surface, &traversal.solid_lanes);
    vec3 x_filter = scaled(sub(x, surface->filter_centre), surface->filter_scale);
    if (!traversal.moments || !within(x_filter.x, DISTANCE_MAX) || !within(x_filter.y, DISTANCE_MAX) ||
        !within(x_filter.z, DISTANCE_MAX))
        return 0.0;
    traversal.x_filter[0] = (float)x_filter.x;
    traversal.x_filter[1] = (float)x_filter.y;
    traversal.x_filter[2] = (float)x_filter.z;
    if (surface->motion)
        return sum_leaves(&traversal);
    float max_node_error = FIRST_NODE_ERROR / (float)surface->levels;
    double error = sum_tree(&traversal, max_node_error);
    for (int pass = 1; !(error <= SERIES_ERROR) && pass < PASSES_MAX && !work_is_spent(work); pass++) {
        float share = (float)(SERIES_ERROR / error);
        max_node_error *= share * share < NODE_ERROR_SHRINK ? share * share : NODE_ERROR_SHRINK;
        error = sum_tree(&traversal, max_node_error);
    }
    if (work_is_spent(work))
        return HUGE_VAL;
    double winding = sum_of(traversal.winding) + traversal.exact;
    return fabs(winding) <= (double)surface_triangles(surface) ? winding : 0.0;
}
