/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Nearest pairs without a world: n segments in, n exact answers out.
 *
 * Threads: the functions are stateless, and may be called from several threads at once.
 */
#ifndef DYNPOINT_QUERY_H
#define DYNPOINT_QUERY_H

#include "dynpoint/hull.h"
#include "dynpoint/kernel.h"
#include "dynpoint/mesh.h"
#include "dynpoint/types.h"

DPT_BEGIN

/*
 * Settings. Apart from the size, 0 is the default.
 *
 *   pair  0: find the nearest pair, gap and depth.
 *         1: find the nearest pair only, which is many times cheaper; contact is DPT_CONTACT_UNKNOWN, gap and depth
 *         are 0
 */
typedef struct dpt_query_def {
    uint32_t size;   /* sizeof(dpt_query_def) */
    uint32_t method; /* DPT_METHOD_...; default DPT_METHOD_EXACT */
    uint32_t kernel; /* DPT_KERNEL_...; default DPT_KERNEL_AUTO */
    uint32_t pair;
} dpt_query_def;

/*
 * Find the nearest pair of each segment and the mesh.
 *
 *   pose   of the mesh in the world; NULL: the identity
 *   ends   n times ax, ay, az, bx, by, bz, in the world, m
 *   radii  n radii >= 0, m; NULL: all are 0
 *   n      number of segments; 0 is not an error. More than 2^31 - 1: DPT_E_LIMIT, before anything is read
 *   hits   n answers. Set hits[0].size: it is the stride of the array, and is written into every hit
 *   def    NULL: the defaults
 *
 * Apart from `work`, an answer depends on its own segment alone, not on the others. If several triangles are at the
 * same distance, the answer may name any of them.
 *
 * A segment that is not finite or beyond DPT_COORDINATE_MAX gets DPT_STATUS_STALE. All others are answered; then the
 * call returns DPT_E_FINITE. In the same way it returns DPT_E_LAYOUT if the boxes of a forged mesh do not hold its
 * triangles. Any other forged mesh gives wrong answers, but no unsafe reads.
 */
DPT_API dpt_result dpt_query_segments(const dpt_mesh *mesh, const dpt_pose *pose, const double *ends,
                                      const double *radii, size_t n, dpt_hit *hits, const dpt_query_def *def);

/*
 * Find the nearest pair of one segment and one triangle, in double. Every method computes its answers by this function.
 *
 *   segment   ax, ay, az, bx, by, bz; A = B is a point
 *   triangle  three corners, x, y, z each; any of them may coincide
 *   s, p, q   as in dpt_hit, in the frame of the arguments; each may be NULL
 *
 * Returns the distance. If the two meet, it is 0, and p = q. For an argument that is NULL, not finite or beyond 1e60
 * the call returns infinity and writes safe outputs. Lengths below 1e-60 count as 0. The error is a few units in the
 * last place of the largest coordinate; docs/algorithms/distance.md has its bound.
 */
DPT_API double dpt_segment_triangle(const double segment[6], const double triangle[9], double *s, double p[3],
                                    double q[3]);

/* A point p of a segment, at s in 0..1 of it, a point q of a triangle, and how far they are apart. */
typedef struct dpt_segment_pair {
    double s;
    double distance;
    double p[3];
    double q[3];
} dpt_segment_pair;

enum { DPT_SEGMENT_PAIRS_MAX = 5 };

/*
 * All pairs by which a triangle can limit the motion of a segment, for a response of your own: end a and the triangle;
 * end b and the triangle; and the segment and each edge, where the nearest point is inside the segment. A segment
 * without length has the first alone.
 *
 *   segment, triangle   as above
 *   pairs               room for DPT_SEGMENT_PAIRS_MAX; in the order above
 *
 * Returns how many there are; 0, and nothing is written, for arguments that dpt_segment_triangle refuses. The least of
 * their distances is that of the segment and the triangle, unless the segment goes through the triangle. So a capsule
 * whose axis does not is free of the triangle if all of them are farther apart than its radius.
 */
DPT_API uint32_t dpt_segment_triangle_pairs(const double segment[6], const double triangle[9], dpt_segment_pair *pairs);

/*
 * Find the nearest pair of a hull and the mesh.
 *
 *   pose       of the mesh in the world; NULL: the identity
 *   hull_pose  of the hull's frame in the world; NULL: the identity
 *   hit        set hit->size. p is on the hull's polyhedron, distance that of the polyhedron, and gap that less the
 *              hull's radius; segment and s are 0. Where hull and mesh meet, distance is 0 and the contact is
 *              DPT_CONTACT_PENETRATING; how deep is not known. A hull inside the mesh, without meeting it, counts as
 *              outside
 */
DPT_API dpt_result dpt_query_hull(const dpt_mesh *mesh, const dpt_pose *pose, const dpt_hull *hull,
                                  const dpt_pose *hull_pose, dpt_hit *hit);

/*
 * List the triangles that may be within reach of a segment, for a response of your own: none within reach is left out;
 * some that are a little farther may be listed.
 *
 *   pose       of the mesh in the world; NULL: the identity
 *   ends       ax, ay, az, bx, by, bz, in the world, m
 *   reach      m, >= 0
 *   triangles  their source numbers, at most `capacity`; may be NULL if capacity is 0
 *   count      how many there are, which may be more than `capacity`
 */
DPT_API dpt_result dpt_query_triangles(const dpt_mesh *mesh, const dpt_pose *pose, const double ends[6], double reach,
                                       uint32_t *triangles, uint32_t capacity, uint32_t *count);

DPT_END

#endif
