/* SPDX-License-Identifier: BSD-3-Clause */
/* The triangle nearest to a point, by the box tree: dpti_bvh_traverse for an axis without length, without a cache. */
#ifndef DPT_POINT_SEARCH_H
#define DPT_POINT_SEARCH_H

#include "nearest/bvh.h"

/*
 * Find the triangle nearest to the point x, in the mesh's frame. `nearest` is as for dpti_bvh_search: a triangle must
 * be nearer than nearest->pair.distance2, or as near with a lower source number; a pair of distance 0 ends the search.
 *
 * traversal->level 0: begin at the root. Returns 1 when done. Returns 0 when the work is spent: the next call may
 * continue the traversal, with a pair that is no farther.
 */
int dpti_point_search(const struct surface *surface, const struct kernel *kernel, vec3 x,
                      struct bvh_traversal *traversal, struct work *work, struct pair_search *nearest);

#endif
