/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The dynamic point: the nearest pair of one tool axis and one body, carried from tick to tick, with its error bound.
 * Triangles go by their place in the file's order. docs/algorithms/certificate.md.
 */
#ifndef DPT_DYNAMIC_POINT_H
#define DPT_DYNAMIC_POINT_H

#include "base/frame.h"
#include "nearest/bvh.h"

/* An axis in the world and in the body's frame, in m. */
struct axis {
    vec3 a, b;       /* the ends in the world */
    vec3 local_a, u; /* the axis local_a + s u, both in the body's frame */
    double error;    /* error bound of a distance from this axis, m */
};

/* Set an axis from its ends a and b in the world; body: the pose of the body's frame. */
static inline void axis_of(const struct surface *surface, const struct frame *body, vec3 a, vec3 b, struct axis *axis)
{
    axis->a = a;
    axis->b = b;
    axis->local_a = frame_to_local(body, a);
    vec3 local_b = frame_to_local(body, b);
    axis->u = sub(local_b, axis->local_a);
    double extent = max_of(max_of(extent_of(a), extent_of(b)), extent_of(body->origin));
    extent = max_of(extent, max_of(extent_of(axis->local_a), extent_of(local_b)));
    axis->error = DISTANCE_ERROR * max_of(extent, dpti_surface_extent(surface));
}

/*
 * The nearest pair without history. hint: a triangle that is likely to be near, or DPT_NONE; it changes the time, not
 * the answer. method: DPT_METHOD_BRUTE, else the tree. `nearest` is overwritten; its triangle is DPT_NONE only if a
 * forged file's boxes hide every triangle.
 */
void dpti_dynamic_point_once(const struct surface *surface, const struct kernel *kernel, uint32_t method,
                             const struct axis *axis, uint32_t hint, struct work *work, struct pair_search *nearest);

/* The nearest pair with history: of one axis and one body, in one tick. */
struct dynamic_point {
    struct axis axis;
    struct pair_search nearest;
    uint32_t last;  /* place of last tick's triangle, while it may be the answer; or DPT_NONE */
    pair last_pair; /* the nearest pair of this tick's axis and that triangle */
};

/*
 * How the dynamic point moves before the search: it stays on last tick's triangle, it descends to nearer neighbours,
 * or, if the axis crossed its triangle last tick, it looks for a triangle that the axis crosses now and else descends.
 */
enum descent_mode { DESCENT_NONE, DESCENT_NEIGHBOURS, DESCENT_CROSSED };

/*
 * Begin a tick: evaluate last tick's triangle, and move the dynamic point as `mode` says. track->axis must be set.
 *
 *   last    last tick's triangle, by its place, or DPT_NONE. Without it and without a limit any triangle is the start
 *   limit2  m^2; HUGE_VAL: no limit. A pair whose squared distance is limit2 or more need not be found. If there is no
 *           nearer one, track->nearest.triangle is DPT_NONE
 */
void dpti_dynamic_point_begin(struct dynamic_point *track, const struct surface *surface, uint32_t last, double limit2,
                              enum descent_mode mode, struct work *work);

/*
 * Move the dynamic point to a nearer triangle, over the edge or around the vertex on which its nearest point lies,
 * until none is nearer. Of the axis, local_a, u and error must be set.
 */
void dpti_dynamic_point_descend(const struct surface *surface, const struct axis *axis, struct work *work,
                                struct pair_search *nearest);

/*
 * Prove the dynamic point or correct it, by dpti_bvh_traverse, which takes `cache` and `traversal`. Returns 0 if the
 * work is spent: the next call continues.
 */
int dpti_dynamic_point_prove(struct dynamic_point *track, const struct surface *surface, const struct kernel *kernel,
                             const struct plane_cache_view *cache, struct bvh_traversal *traversal, struct work *work);

/*
 * Keep last tick's triangle as the answer while its distance is within DISTANCE_ERROR_HISTORY times the error bound of
 * the best one.
 */
void dpti_dynamic_point_settle(struct dynamic_point *track);

/*
 * The dynamic point of Maciel and De (2008), as docs/algorithms/paper.md reads it: it moves from last tick's triangle
 * to a nearer neighbour until none is nearer. It can end in a local minimum; that is the method.
 *
 * Steepest descent over triangles that share a vertex. Each move goes to a strictly nearer triangle. Of equally near
 * neighbours the one that shares two vertices wins, then the one with the lower source number.
 *
 *   a, u      the axis a + s u, in the mesh's frame
 *   one_step  1: move at most once
 *   nearest   in: nearest->triangle, by its place, is where to start. out: triangle and pair where the descent ended
 */
void dpti_paper_descend(const struct surface *surface, const struct kernel *kernel, vec3 a, vec3 u, int one_step,
                        struct work *work, struct pair_search *nearest);

#endif
