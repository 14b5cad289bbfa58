/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Winding-number moments of a set of triangles: the multipoles up to the octupole, and what bounds the remainder
 * (docs/algorithms/winding.md). The tensors are full and symmetric, so that sets can be joined.
 *
 * In the frame of the triangles given. u is the offset of a surface point from the centroid, n the unit normal there;
 * integrals are over the area.
 */
#ifndef DPT_COMPILE_MOMENTS_H
#define DPT_COMPILE_MOMENTS_H

#include "base/vec3.h"

struct winding_moment {
    vec3 area_vector; /* integral of n */
    vec3 centroid;    /* weighted by area */
    double area;      /* 0: the set is empty, and all other fields are 0 */
    double quad[6];   /* integral of n u: xx, yy, zz, xy, xz, yz */
    double oct[10];   /* integral of n u u: xxx, yyy, zzz, xxy, xxz, yyx, yyz, zzx, zzy, xyz */
    double radius;    /* at least the largest |u| */

    /* Without the normal: for the bound of the remainder. */
    double second[6]; /* integral of u u, in the order of quad */
    double third[3];  /* integral of u (u.u) */
    double fourth;    /* at least the integral of (u.u)^2 */
};

/* The moments of one triangle. Its normal points to the side from which a, b, c run counter-clockwise. */
struct winding_moment moment_of_triangle(vec3 a, vec3 b, vec3 c);

/* The moments of several sets together. */
struct winding_moment moment_of_sets(const struct winding_moment *sets, uint32_t count);

/*
 * What a set adds to the winding number at x, by its moments. *error becomes the bound of the error; it is infinite if
 * x is within `radius` of the centroid.
 */
double moment_winding(const struct winding_moment *moment, vec3 x, double *error);

/* Store the moments in one lane of a block of MESH_MOMENT_ROWS rows of 16. `block` points to that lane of row 0. */
void moment_store(const struct winding_moment *moment, float *block);

#endif
