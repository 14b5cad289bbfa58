/* SPDX-License-Identifier: BSD-3-Clause */
/* Regions of a body's surface that take of a needle what they say (insertion.h), by their places in the mesh's frame. */
#ifndef DPT_SCENE_SURFACE_REGIONS_H
#define DPT_SCENE_SURFACE_REGIONS_H

#include "dynpoint/compile.h"
#include "dynpoint/insertion.h"

struct surface_regions {
    uint32_t count;
    dpt_spring_region place[DPT_BODY_REGIONS_MAX]; /* a box or a sphere */
    dpt_body_region law[DPT_BODY_REGIONS_MAX];
};

/*
 * Give them to a body of a mesh: a triangle is of the last one that has its centroid. *of_triangle: NULL, or memory that the
 * caller frees when the body is gone.
 */
dpt_result surface_regions_set(const struct surface_regions *regions, dpt_world *world, dpt_body body,
                               const dpt_mesh *mesh, uint8_t **of_triangle);

#endif
