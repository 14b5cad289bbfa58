/* SPDX-License-Identifier: BSD-3-Clause */
/* All triangles that may be within reach of an axis, one after another, through the box tree. */
#ifndef DPT_RANGE_SEARCH_H
#define DPT_RANGE_SEARCH_H

#include "nearest/bvh.h"

struct range {
    const struct surface *surface;
    const struct kernel *kernel;
    struct filter_segment segment;
    float directions[4][3]; /* four ways, each a quarter turn about the axis from the last */
    float limits[4];        /* what is that far along one of them is beyond reach */
    uint32_t level;         /* where it stands; above surface->levels: at the end */
    uint32_t node[MESH_LEVELS_MAX + 1];
    uint32_t lanes[MESH_LEVELS_MAX + 1]; /* still to come; level 0: triangles of a leaf */
    float bound[LANES];                  /* of those triangles */
    struct work *work;
};

/* The axis a + s u, in the mesh's frame; `reach` >= 0, a distance; at least one block is looked at. */
void dpti_range_begin(struct range *range, const struct surface *surface,
                      const struct kernel *kernel, vec3 a, vec3 u, double reach, struct work *work);

/*
 * The next triangle, by its place, or DPT_NONE. None within reach is left out; some beyond it may come.
 * `meets`: it may be at distance 0. When the work is spent, there may be more.
 */
uint32_t dpti_range_next(struct range *range, int *may_touch);

#endif
