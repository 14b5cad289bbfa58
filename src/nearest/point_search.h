/* SPDX-License-Identifier: BSD-3-Clause */
/* The nearest triangle of a point: the search of bvh.h for an axis without length, without planes to keep. */
#ifndef DPT_POINT_SEARCH_H
#define DPT_POINT_SEARCH_H

#include "nearest/bvh.h"

/*
 * What is nearer to x, in the mesh's frame, than nearest->pair.distance2, or as near with a lower source number, into
 * `nearest`; stops at the first pair that meets. From where the walk stands. 0: the work was spent; the walk may go
 * on from there, with a pair that is no farther.
 */
int dpti_point_search(const struct surface *surface, const struct kernel *kernel, vec3 x,
                      struct bvh_traversal *traversal, struct work *work,
                      struct pair_search *nearest);

#endif
