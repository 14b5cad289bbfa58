/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Do two triangles cut each other? They do if their interiors (without edges and corners) have a point in common: they
 * cross, or they lie in one plane and overlap. Triangles that touch along edges or at corners do not cut each other.
 * Neither do two of which one ends in the face of the other. A triangle without area has no interior. The answer is
 * exact: a sign that rounding could change is evaluated again without rounding.
 */
#ifndef DPT_COMPILE_TRIANGLE_PAIR_H
#define DPT_COMPILE_TRIANGLE_PAIR_H

#include <stdint.h>

#include "base/vec3.h"

struct corner {
    vec3 position; /* each coordinate is a float's value */
    uint32_t vertex;
};

/* A triangle and its plane, in the mesh's frame. */
struct facet {
    struct corner corner[3];
    vec3 normal;           /* cross product of two edges: not unit */
    vec3 normal_magnitude; /* cross_magnitude of the same two edges */
};

/* The absolute value of each coordinate. */
static inline vec3 magnitude_of(vec3 a)
{
    return (vec3){ fabs(a.x), fabs(a.y), fabs(a.z) };
}

/* For each coordinate of cross(a, b): the sum of the absolute values of its two products. */
static inline vec3 cross_magnitude(vec3 a, vec3 b)
{
    const vec3 s = magnitude_of(a), t = magnitude_of(b);
    return (vec3){ s.y * t.z + s.z * t.y, s.z * t.x + s.x * t.z, s.x * t.y + s.y * t.x };
}

/* Compute the plane of a facet from its corners. */
void facet_finish(struct facet *facet);

/*
 * Do two facets cut each other? 0 or 1. Corners with equal positions must have the same vertex, others different ones.
 * Adds 1 to *work, and more where a sign needs exact arithmetic or both lie in one plane.
 */
int facets_cut(const struct facet *a, const struct facet *b, uint64_t *work);

#endif
