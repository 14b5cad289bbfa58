/* SPDX-License-Identifier: BSD-3-Clause */
/* The exact nearest pair of one axis and one mesh: by the box tree, or by brute force. */
#ifndef DPT_BVH_H
#define DPT_BVH_H

#include "base/work.h"
#include "kernel/kernel_ops.h"
#include "nearest/nearest_pair.h"
#include "nearest/plane_cache.h"

/* A node on the path of a traversal. Bounds are distances in the filter's frame, too large by at most its margin. */
struct path_entry {
    float bound[LANES]; /* lower bounds of the children */
    uint32_t lanes;     /* children that are still to be visited, as bits */
    uint32_t node;      /* index in its level */
    uint32_t has_open;  /* 1: something below this node could not be closed by a plane */
    float lower_bound;  /* of the whole node, from the nodes above; 0: none */
};

/* The state of a traversal: the path of nodes from the root, path[surface->levels], down to path[level]. */
struct bvh_traversal {
    struct path_entry path[MESH_LEVELS_MAX + 1]; /* by level; level 1: parents of leaves */
    uint32_t level;                              /* level of the node being visited; 0: not begun */
};

/*
 * Find the triangle nearest to the axis a + s u, in the mesh's frame, in m.
 *
 *   nearest  in: a pair to beat; nearest->triangle is its place, or DPT_NONE if distance2 is only a limit.
 *            out: the nearest pair that is nearer, or as near with a lower source number. If there is none, pair and
 *            triangle are unchanged. The search stops at the first pair of distance 0.
 *   cache    separating planes of earlier searches; those of this search are added. NULL: none
 *   slack    a distance, in m: with slack > 0 a triangle that is nearer by less need not be found
 *   work     grows by one unit a block of 16 lanes
 *
 * A search whose work is spent ends early, with the best pair so far.
 */
void dpti_bvh_search(const struct surface *surface, const struct kernel *kernel, const struct plane_cache_view *cache,
                     vec3 a, vec3 u, double slack, struct work *work, struct pair_search *nearest);

/*
 * The same search in parts. Returns 1 when it is done; then traversal->level is 0. Returns 0 when the work is spent:
 * the next call continues there, for the same axis, or for a moved one after dpti_bvh_weaken_bounds.
 */
int dpti_bvh_traverse(const struct surface *surface, const struct kernel *kernel, const struct plane_cache_view *cache,
                      vec3 a, vec3 u, double slack, struct bvh_traversal *traversal, struct work *work,
                      struct pair_search *nearest);

/* Lower the bounds of a suspended traversal: each end of the axis has moved by at most `motion`, in m, since. */
void dpti_bvh_weaken_bounds(struct bvh_traversal *traversal, const struct surface *surface, double motion);

/*
 * A lower bound, in m, of the distance from the axis a + s u to all triangles that a suspended traversal has not
 * visited yet. The traversal must have begun. HUGE_VAL if none are left.
 */
double dpti_bvh_unvisited_bound(const struct bvh_traversal *traversal, const struct surface *surface, vec3 a, vec3 u);

/* dpti_bvh_search without the tree: every triangle in double, without filter or slack. It never stops early. */
void dpti_brute_search(const struct surface *surface, vec3 a, vec3 u, struct work *work, struct pair_search *nearest);

#endif
