/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Exact pairs of a hull's polyhedron and one triangle, in double; the hull's radius is ignored here. All points are
 * in the frame of the triangle's mesh, in m. docs/algorithms/tips.md.
 *
 * Two convex bodies that do not meet are nearest at a corner of one and a face of the other, or at an edge of each.
 * These are the features below. Each gives a real pair of points, so no distance is below the true one by more than
 * rounding.
 */
#ifndef DPT_HULL_TRIANGLE_H
#define DPT_HULL_TRIANGLE_H

#include "base/vec3.h"
#include "hull/hull_state.h"
#include "nearest/segment_triangle.h"

/*
 * Numbers of features:
 *     HULL_CORNER + c          corner c of the hull and the triangle
 *     HULL_EDGE + 3 e + k      edge e of the hull and the triangle's edge from corner k to the next
 *     HULL_FACE + 3 f + k      face f of the hull and the triangle's corner k
 */
enum {
    HULL_CORNER = 0,
    HULL_EDGE = HULL_CORNERS_MAX,
    HULL_FACE = HULL_EDGE + 3 * HULL_EDGES_MAX,
    HULL_FEATURES = HULL_FACE + 3 * HULL_FACES_MAX
};

/* A pair: p on the hull, q on the triangle, q = the corners weighted by pair.weight, p = q + pair.gap. pair.s is 0. */
struct hull_pair {
    struct pair pair;
    uint32_t feature; /* or DPT_NONE, where the two meet and no feature's pair is at distance 0 */
};

/*
 * The pair of one feature. Returns 0, and leaves `found` undefined, where another feature has the pair: where an edge's
 * nearest point is at its end, or the triangle's corner is not above the face.
 */
int dpti_hull_feature(const struct hull_place *place, uint32_t feature, const vec3 v[3], struct hull_pair *found);

/* The place of a hull, as hull_place_set, but only of the corners and faces that a feature's pair needs. */
void dpti_hull_place_feature(struct hull_place *place, const struct dpt_hull *hull, uint32_t feature,
                             const struct frame *tool, const struct frame *body);

/*
 * The nearest pair of hull and triangle, where their distance is below `limit`. Returns 1 if it is, 0 if not: then
 * `found` is undefined. If hull and triangle meet, the distance is 0, and the pair is a point of both.
 */
int dpti_hull_triangle(const struct hull_place *place, const vec3 v[3], double limit, struct hull_pair *found);

/* The same of a hull and a triangle that do not meet, where that is known: faster, where the limit is low. */
int dpti_hull_triangle_apart(const struct hull_place *place, const vec3 v[3], double limit, struct hull_pair *found);

/*
 * Call `take` for each feature whose pair is not farther apart than `limit`. Where hull and triangle meet, the pairs
 * say little.
 */
typedef void hull_take_fn(void *user, const struct hull_pair *found);
void dpti_hull_features(const struct hull_place *place, const vec3 v[3], double limit, hull_take_fn *take, void *user);

/*
 * Whether a feature's pair is nearest among its neighbours: no way from its points along the hull and the triangle
 * leads nearer, by more than the sine `lean` of an angle to the pair. Pairs that are not tell nothing of a motion that
 * turns the hull by less.
 */
int dpti_hull_pair_is_local(const struct hull_place *place, const vec3 v[3], const struct hull_pair *found,
                            double lean);

/*
 * A plane between two convex sets of points, by the algorithm of Gilbert, Johnson and Keerthi (1988). The plane is the
 * proof: it is checked by the points themselves, and an iteration that goes wrong can only fail to find one.
 */

/*
 * Look for a unit vector n with n.y - n.x > apart for all points x of `a` and y of `b`. Returns 1 and sets *n, or 0
 * where there is none or it was not found.
 *   apart  m, >= 0
 *   n      in: a direction to begin with, of any length
 */
int dpti_separate(const vec3 *a, uint32_t a_count, const vec3 *b, uint32_t b_count, double apart, vec3 *n);

/*
 * An upper bound of the distance of two sets, near it as a rule; 0 where they meet, as far as rounding tells. HUGE_VAL
 * if a plane proves that they are farther apart than `limit`, m: then *n is its normal, as above.
 */
double dpti_distance_upper(const vec3 *a, uint32_t a_count, const vec3 *b, uint32_t b_count, double limit, vec3 *n);

#endif
