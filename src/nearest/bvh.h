/* SPDX-License-Identifier: BSD-3-Clause */
/* Nearest pair of one axis and one mesh, exact: by the box tree, or by brute force. */
#ifndef DPT_BVH_H
#define DPT_BVH_H

#include "base/work.h"
#include "kernel/kernel_ops.h"
#include "nearest/nearest_pair.h"
#include "nearest/plane_cache.h"

/* A node that is being looked into: its children's bounds, and those still to be visited. */
struct path_entry {
    float bound[LANES];
    uint32_t lanes;
    uint32_t node;
    uint32_t has_open; /* something below it was open to the end */
    float lower_bound; /* a bound of all of it, from the nodes above */
};

/* Where a search stands: a path of nodes from the root down to `at`. */
struct bvh_traversal {
    struct path_entry path[MESH_LEVELS_MAX + 1];
    uint32_t depth; /* level; 0: not begun */
};

/*
 * Look for what is nearer than nearest->pair.distance2, or as near with a lower source number; put it
 * into `nearest`. Stops at the first pair that meets. nearest->triangle stays when there is none.
 * `keeper` holds planes of earlier searches and keeps those of this one; NULL keeps nothing.
 *
 * With `slack` > 0, a triangle that is nearer by less than that, a distance, need not be found.
 */
void dpti_bvh_search(const struct surface *surface, const struct kernel *kernel,
                     const struct plane_cache_view *cache, vec3 a, vec3 u, double slack,
                     struct work *work, struct pair_search *nearest);

/*
 * The same in pieces: 1 when it is done, and the walk is not begun again; 0 when the work was spent.
 * The next call goes on there, at the same place of the axis, or after dpti_bvh_weaken_bounds.
 */
int dpti_bvh_traverse(const struct surface *surface, const struct kernel *kernel,
                      const struct plane_cache_view *cache, vec3 a, vec3 u, double slack,
                      struct bvh_traversal *traversal, struct work *work,
                      struct pair_search *nearest);

/* The ends of the axis, that now is a + s u, moved by at most `motion` since the walk stopped. */
void dpti_bvh_weaken_bounds(struct bvh_traversal *traversal, const struct surface *surface,
                            double motion);

/* A lower bound of the axis' distance to all that a walk that has begun has not yet visited. */
double dpti_bvh_unvisited_bound(const struct bvh_traversal *traversal,
                                const struct surface *surface, vec3 a, vec3 u);

/* The same over every triangle, in double, without a filter; never stops early. */
void dpti_brute_search(const struct surface *surface, vec3 a, vec3 u, struct work *work,
                       struct pair_search *nearest);

#endif
