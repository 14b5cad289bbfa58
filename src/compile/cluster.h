/* SPDX-License-Identifier: BSD-3-Clause */
/* Winding numbers of sets of triangles: their moments, and trees of them. */
#ifndef DPT_COMPILE_CLUSTER_H
#define DPT_COMPILE_CLUSTER_H

#include "base/vec3.h"
#include "compile/model.h"

/*
 * Winding-number moments of a set of triangles: the multipoles up to the octupole, and what bounds the remainder
 * (docs/algorithms/winding.md). The tensors are full and symmetric, so that sets can be joined.
 *
 * In the frame of the triangles given. u is the offset of a surface point from the centroid, n the unit normal there;
 * integrals are over the area.
 */
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

/*
 * A bounding volume hierarchy over the triangles of one part. The compiler asks it for the part's winding number at a
 * point, and whether a triangle touches the part. A leaf has 16 triangles, a node 4 children. Triangles are taken in
 * the order of the box tree, which keeps near ones together.
 */

#define CLUSTER_LEVELS 16u /* enough: 16 * 4^15 is more than 2^32 triangles */

/* An axis-aligned box, in the mesh's frame, m. */
struct bounds {
    vec3 low, high;
};

struct cluster {
    const struct model *model;
    const uint32_t *triangles; /* by index in the model; borrowed */
    uint32_t triangle_count;
    uint32_t level_count[CLUSTER_LEVELS]; /* nodes of a level, from the leaves to the root */
    uint32_t level_first[CLUSTER_LEVELS]; /* index of a level's first node in the arrays below */
    uint32_t levels;
    struct winding_moment *node_moments;
    struct bounds *node_boxes;
};

/*
 * Build a cluster of `count` triangles of the model; a triangle counts as turned where model->is_turned says so.
 * Returns DPT_OK or DPT_E_MEMORY, and fills no diag. Call cluster_free in either case.
 */
dpt_result cluster_build(struct cluster *cluster, const struct model *model, const uint32_t *triangles, uint32_t count);
void cluster_free(struct cluster *cluster);

/*
 * The winding number at x of the cluster's triangles without the triangle `excluded` (DPT_NONE: of all). It is off by
 * about 0.01 at most. The number of triangles that were evaluated one by one is added to *work.
 */
double cluster_winding(const struct cluster *cluster, vec3 x, uint32_t excluded, uint64_t *work);

/* Does a triangle of the model come within `distance` (m) of a triangle of the cluster? 0 or 1. */
int cluster_touches(const struct cluster *cluster, uint32_t triangle, double distance);

/* The corners of a triangle, in its own order; model->is_turned is not applied. */
void model_corners(const struct model *model, uint32_t triangle, vec3 corners[3]);

struct bounds bounds_of_corners(const vec3 corners[3]);
struct bounds bounds_join(struct bounds a, struct bounds b);

/* Do two boxes meet, or come within `distance` of each other along every axis? 0 or 1. */
int bounds_meet(const struct bounds *a, const struct bounds *b, double distance);

#endif
