/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A set of triangles as it is seen from afar: the multipoles of the winding number up to the octupole, and
 * what bounds the rest (docs/algorithms/winding.md). Full symmetric tensors, so that sets can be joined.
 */
#ifndef DPT_COMPILE_MOMENTS_H
#define DPT_COMPILE_MOMENTS_H

#include "base/vec3.h"

struct winding_moment {
    vec3 area_vector; /* sum of the area vectors */
    vec3 centroid;    /* area-weighted centroid; what follows is about it */
    double area;      /* 0: an empty set, and all else is 0 */
    double quad[6];   /* integral of n u: xx, yy, zz, xy, xz, yz */
    double oct[10];   /* of n u u: xxx, yyy, zzz, xxy, xxz, yyx, yyz, zzx, zzy, xyz */
    double radius;    /* the largest |u|, or more */

    /* Of the area alone, whatever its direction. */
    double second[6]; /* of u u, as quad */
    double third[3];  /* of u (u.u) */
    double fourth;    /* of (u.u)^2 */
};

/* One triangle, its area vector to the side that it is seen from counter-clockwise. */
struct winding_moment moment_of_triangle(vec3 a, vec3 b, vec3 c);

/* Several sets as one. */
struct winding_moment moment_of_sets(const struct winding_moment *sets, uint32_t count);

/*
 * What a set adds to the winding number at x, and by how much that may be wrong: `error` is infinite where x is
 * within the radius.
 */
double moment_winding(const struct winding_moment *moment, vec3 x, double *error);

/* Into a lane of a block of MESH_MOMENT_ROWS rows of 16, `block` at the lane. */
void moment_store(const struct winding_moment *moment, float *block);

#endif
