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
    uint32_t triangle;  /* place */
    uint32_t is_narrow; /* 1: it loads the corners of its triangle, whatever the radius */
    vec3 at;
    vec3 middle; /* where the force acts: its torque is that of this place */
    vec3 force;
    vec3 normal; /* unit: shares keep the moment of a force along it; 0: they need not */
};

/* The most vertices over which one point's force is spread. */
enum { LOAD_PATCH_MAX = 256 };

/* A table of vertices: the patch's, and so many of those that were too far. */
enum { LOAD_TABLE_BITS = 10, LOAD_TABLE = 1 << LOAD_TABLE_BITS, LOAD_FAR = 512 };
typedef char slots_are_left[(int)LOAD_TABLE > (int)LOAD_FAR + (int)LOAD_PATCH_MAX ? 1 : -1];

/* The vertices over which a point's force is spread, with their shares. */
struct load_patch {
    uint32_t count;
    uint32_t vertex[LOAD_PATCH_MAX];
    double share[LOAD_PATCH_MAX]; /* their sum is 1 */
    uint32_t known[LOAD_TABLE];   /* those in the table, each one more than its number; 0: none */
    uint32_t far_count;
};

/*
 * The vertices within `radius` of a point, by area and less with distance; with radius 0, or no vertex so near, the corners
 * of its triangle. With a normal, the mean of the vertices by their shares lies on the line along it through the point.
 */
void dpti_deform_patch(const struct surface *surface, const struct load_point *point, double radius,
                       struct load_patch *patch);

/*
 * Spread the forces of some points over the patch of each. Forces are then made to sum up to `whole`.
 *
 *   loads   at most `capacity` are written; a vertex near two points occurs twice
 * Returns how many there are, which may be more than `capacity`: then the loads do not count.
 */
uint32_t dpti_deform_spread(const struct surface *surface, const struct load_point *points, uint32_t point_count,
                            double radius, const dpt_wrench *whole, dpt_load *loads, uint32_t capacity);

#endif
