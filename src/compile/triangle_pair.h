/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Do two triangles cut each other? They do when their interiors (without edges and corners) have a point in common: they
 * cross, or lie in one plane and overlap. Triangles that touch along edges or at corners do not, nor does one that ends in
 * the other's face; a triangle without area has no interior. The answer is exact: signs that rounding could change
 * are evaluated again without rounding.
 */
#ifndef DPT_COMPILE_TRIANGLE_PAIR_H
#define DPT_COMPILE_TRIANGLE_PAIR_H

#include <stdint.h>

#include "base/vec3.h"

struct corner {
    vec3 position; /* floats */
    uint32_t vertex;
};

/* A triangle and its plane. */
struct facet {
    struct corner corner[3];
    vec3 normal;           /* not a unit */
    vec3 normal_magnitude; /* cross_magnitude what it is the product of */
};

static inline vec3 magnitude_of(vec3 a)
{
    return (vec3){ fabs(a.x), fabs(a.y), fabs(a.z) };
}

/* Of each coordinate of cross(a, b) the sum of its products' sizes. */
static inline vec3 cross_magnitude(vec3 a, vec3 b)
{
    const vec3 s = magnitude_of(a), t = magnitude_of(b);
    return (vec3){ s.y * t.z + s.z * t.y, s.z * t.x + s.x * t.z, s.x * t.y + s.y * t.x };
}

/* Whose corners are set. */
void facet_finish(struct facet *facet);

/* Vertices are equal if and only if their positions are. `work` gets 1 added, and more for exact signs. */
int facets_cut(const struct facet *a, const struct facet *b, uint64_t *work);

#endif
