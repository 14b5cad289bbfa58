/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A plane between two convex sets of points, by the algorithm of Gilbert, Johnson and Keerthi (1988). The plane is the
 * proof: it is checked by the points themselves, and an iteration that goes wrong can only fail to find one.
 */
#ifndef DPT_SEPARATE_H
#define DPT_SEPARATE_H

#include "base/vec3.h"

/*
 * Look for a unit vector n with n.y - n.x > apart for all points x of `a` and y of `b`. Returns 1 and sets *n, or 0 where
 * there is none or it was not found.
 *   apart  m, >= 0
 *   n      in: a direction to begin with, of any length
 */
int dpti_separate(const vec3 *a, uint32_t a_count, const vec3 *b, uint32_t b_count, double apart, vec3 *n);

/*
 * An upper bound of the distance of two sets, near it as a rule; 0 where they meet, as far as rounding tells. HUGE_VAL if
 * a plane proves that they are farther apart than `limit`, m: then *n is its normal, as above.
 */
double dpti_distance_upper(const vec3 *a, uint32_t a_count, const vec3 *b, uint32_t b_count, double limit, vec3 *n);

#endif
