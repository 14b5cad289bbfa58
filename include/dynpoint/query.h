/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Nearest pairs without a world: n segments in, n exact answers out.
 *
 * Threads: stateless; every function may be called from several threads at once.
 */
#ifndef DYNPOINT_QUERY_H
#define DYNPOINT_QUERY_H

#include "dynpoint/kernel.h"
#include "dynpoint/mesh.h"
#include "dynpoint/types.h"

DPT_BEGIN

/*
 * How to answer. Zeros are the defaults.
 *
 *   pair  1: the nearest pair alone, many times cheaper; contact is DPT_CONTACT_UNKNOWN, gap and depth are 0.
 *         0: gap and depth too
 */
typedef struct dpt_query_def {
    uint32_t size;   /* sizeof(dpt_query_def) */
    uint32_t method; /* DPT_METHOD_...; default DPT_METHOD_EXACT */
    uint32_t kernel; /* DPT_KERNEL_...; default DPT_KERNEL_AUTO */
    uint32_t pair;
} dpt_query_def;

/*
 * The nearest pair of each segment and the mesh.
 *
 *   pose   of the mesh in the world; NULL is the identity
 *   ends   n times ax, ay, az, bx, by, bz in the world
 *   radii  n radii >= 0, or NULL for lines
 *   n      how many; 0 is not an error
 *   hits   n answers; hits[0].size must be set, is their stride, and is written into all of them
 *   def    NULL for the defaults
 *
 * An answer depends on its own segment alone, never on the others in the batch (`work` apart). Of several triangles at
 * equal distance any may be named.
 *
 * A segment that is not finite or beyond DPT_COORDINATE_MAX gets status stale, and the call returns
 * DPT_E_FINITE after it has answered all others. So it is with DPT_E_LAYOUT for a forged mesh whose boxes do
 * not hold its triangles; what a forged mesh answers else is wrong, but safe.
 */
DPT_API dpt_result dpt_query_segments(const dpt_mesh *mesh, const dpt_pose *pose,
                                      const double *ends, const double *radii, size_t n,
                                      dpt_hit *hits, const dpt_query_def *def);

/*
 * The nearest pair of one segment and one triangle, in double: what every method rests on.
 *
 *   segment   ax, ay, az, bx, by, bz; A = B is a point
 *   triangle  three corners, x, y, z each; any of them may coincide
 *   s, p, q   each may be NULL; as in dpt_hit, in the frame of the arguments
 *
 * Returns the distance; 0 when they meet, and p = q then. For an argument that is NULL, not finite or beyond 1e60 it
 * returns infinity and safe outputs. Lengths below 1e-60 count as 0. docs/algorithms/distance.md has the bound of its
 * error, a few units in the last place of the largest coordinate.
 */
DPT_API double dpt_segment_triangle(const double segment[6], const double triangle[9], double *s,
                                    double p[3], double q[3]);

DPT_END

#endif
