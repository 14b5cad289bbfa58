/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The search of bvh_search.c, with squared distances. The distance from a point to a box takes three differences, so no
 * direction is guessed. A search that starts from a triangle visits boxes in their order: it starts near the answer and
 * gains little from visiting the nearest first.
 */
#include "nearest/point_search.h"

#include "nearest/filter_segment.h"

struct point_search_state {
    const struct surface *surface;
    const struct kernel *kernel;
    struct pair_search *nearest;
    struct work *work;
    vec3 x;            /* in the mesh's frame */
    float filter_x[3]; /* x in the filter's frame, as limit and margin */
    float limit;       /* a lane whose squared bound exceeds it is farther than the best */
    float margin;
    struct bvh_traversal *traversal;
};

/* The factor covers the rounding of squares. */
static void set_limit(struct point_search_state *search)
{
    double distance = sqrt(search->nearest->pair.distance2);
    double limit = distance * search->surface->filter_scale + (double)search->margin;
    search->limit = (float)(limit * limit * (1.0 + 4.0 * KERNEL_STRETCH));
}

static void visit_node(struct point_search_state *search, uint32_t level, uint32_t node)
{
    const struct surface *surface = search->surface;
    struct path_entry *entry = &search->traversal->path[level];
    work_spend(search->work, 1);
    search->traversal->level = level;
    entry->node = node;
    entry->lanes = lanes_of(surface->count[level - 1] - node * LANES) &
                   search->kernel->point_boxes(surface_node(surface, level, node, search->work), search->filter_x,
                                               search->limit, entry->bound);
}

static void visit_leaf(struct point_search_state *search, uint32_t leaf)
{
    const struct surface *surface = search->surface;
    struct pair_search *nearest = search->nearest;
    uint32_t first = leaf * LANES, lanes = lanes_of(surface_triangles(surface) - first);
    float bound[LANES];
    if (nearest->triangle - first < LANES)
        lanes &= ~(1u << (nearest->triangle - first));
    work_spend(search->work, 1);
    lanes &= search->kernel->point_triangles(surface_leaf(surface, leaf, search->work), search->filter_x, search->limit,
                                             bound);
    while (lanes) {
        uint32_t lane = lowest_lane(bound, lanes);
        lanes &= ~(1u << lane);
        if (bound[lane] > search->limit)
            return;
        if (dpti_pair_search_try_point(surface, first + lane, search->x, nearest))
            set_limit(search);
    }
}

int dpti_point_search(const struct surface *surface, const struct kernel *kernel, vec3 x,
                      struct bvh_traversal *traversal, struct work *work, struct pair_search *nearest)
{
    struct point_search_state search;
    int has_start = nearest->triangle != DPT_NONE;
    vec3 filter_x = scaled(sub(x, surface->filter_centre), surface->filter_scale);
    search.surface = surface;
    search.kernel = kernel;
    search.nearest = nearest;
    search.traversal = traversal;
    search.work = work;
    search.x = x;
    put_float(filter_x, search.filter_x);
    search.margin = (float)(kernel_margin(length(filter_x), length(filter_x)) + surface_margin(surface));
    set_limit(&search);
    if (!traversal->level)
        visit_node(&search, surface->levels, 0);
    while (traversal->level <= surface->levels && (nearest->pair.distance2 > 0.0 || nearest->triangle == DPT_NONE)) {
        struct path_entry *entry = &traversal->path[traversal->level];
        if (!entry->lanes) {
            traversal->level++;
            continue;
        }
        uint32_t lane = has_start ? first_lane(entry->lanes) : lowest_lane(entry->bound, entry->lanes);
        uint32_t rest = entry->lanes & ~(1u << lane);
        if (entry->bound[lane] > search.limit) {
            entry->lanes = has_start ? rest : 0;
            continue;
        }
        if (work_is_spent(work))
            return 0;
        entry->lanes = rest;
        uint32_t child = entry->node * LANES + lane;
        if (traversal->level == 1)
            visit_leaf(&search, child);
        else
            visit_node(&search, traversal->level - 1, child);
    }
    return 1;
}
