/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The load of a tool on the vertices of a surface: docs/algorithms/deform.md. Everything is in the body's frame; wrenches
 * are about its origin.
 */
#ifndef DPT_DEFORM_LOADS_H
#define DPT_DEFORM_LOADS_H

#include "dynpoint/body.h"
#include "mesh/surface.h"

/* Where a tool pushes a surface: a point of a triangle, and the force on the surface, N. */
struct load_point {
    uint32_t triangle; /* place */
    uint32_t reserved;
    vec3 at;
    vec3 force;
};

/* The most vertices over which one point's force is spread. */
enum { LOAD_PATCH_MAX = 256 };

/*
 * Spread the forces of some points over the vertices within `radius` of each, by area and less with distance; with
 * radius 0, or no vertex so near, over the corners of its triangle. Forces are then made to sum up to `whole`.
 *
 *   loads   at most `capacity` are written; a vertex near two points occurs twice
 * Returns how many there are, which may be more than `capacity`: then the loads do not count.
 */
uint32_t dpti_deform_spread(const struct surface *surface, const struct load_point *points, uint32_t point_count,
                            double radius, const dpt_wrench *whole, dpt_load *loads, uint32_t capacity);

#endif
