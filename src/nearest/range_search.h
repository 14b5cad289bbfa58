/* SPDX-License-Identifier: BSD-3-Clause */
/* All triangles that may be within reach of an axis, one after another, by the box tree. */
#ifndef DPT_RANGE_SEARCH_H
#define DPT_RANGE_SEARCH_H

#include "nearest/bvh.h"

struct range {
    const struct surface *surface;
    const struct kernel *kernel;
    struct filter_segment segment;
    float directions[4][3]; /* unit, across the axis, a quarter turn about it apart */
    float limits[4];        /* all that is farther than that along a direction is out of reach */
    uint32_t level;         /* of the node being visited, 0: a leaf; above surface->levels: done */
    /* The path to it, by level: the index of a node in its level, and its children that are still to be visited. */
    uint32_t node[MESH_LEVELS_MAX + 1];
    uint32_t lanes[MESH_LEVELS_MAX + 1];
    float bound[LANES]; /* lower bounds of the leaf's triangles, in the filter's frame */
    struct work *work;
};

/*
 * Begin with the axis a + s u, in the mesh's frame, and a reach >= 0, in m. It takes a unit of work, even if none is
 * left.
 */
void dpti_range_begin(struct range *range, const struct surface *surface, const struct kernel *kernel, vec3 a, vec3 u,
                      double reach, struct work *work);

/*
 * Returns the next triangle, by its place, or DPT_NONE if there is none. It also returns DPT_NONE if the work is spent:
 * then there may be more. No triangle within reach is left out; some out of reach may be returned. may_touch: 0 if the
 * triangle is certainly not at distance 0.
 */
uint32_t dpti_range_next(struct range *range, int *may_touch);

#endif
