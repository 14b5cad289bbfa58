/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * How far the convex hull of some points is from a triangle: an interval that holds the truth, in long double, sharing
 * no code with the library. It knows no faces and no edges.
 *
 * The distance is that of the origin to the convex hull of all differences corner - point of the triangle. Steps in the
 * manner of Gilbert (1966) lead there: the difference that lies farthest against the way from the origin joins those
 * that are kept, and of all simplices of these the nearest one is kept. Each step has a witness, two points that exist,
 * so the truth is not more; and a direction in which all differences lie at least so far, so the truth is not less. The
 * interval needs no trust in the steps, only in sums and products: `lower` and `upper` are right but for 2^-58 of the
 * largest coordinate.
 *
 * It cannot judge which of several nearest pairs is the right one, nor how deep a hull lies in a triangle: where they
 * meet, it says 0 or a rounding. An interval may stay open where edges and faces are parallel but for rounding and more
 * than 16 corners are about as near: about one of 10^5 pairs that were made to be so, and none of others
 * (tests/hull/test_hull_pair.c counts them). Where long double is no wider than double (ORACLE_HULL_JUDGES is 0) it
 * judges nothing that is finer than double's own rounding.
 */
#ifndef DPT_TESTS_ORACLE_HULL_DISTANCE_H
#define DPT_TESTS_ORACLE_HULL_DISTANCE_H

#include <float.h>
#include <stdint.h>

#define ORACLE_HULL_JUDGES (LDBL_MANT_DIG >= 64)

struct oracle_interval {
    double lower, upper;
};

/*
 * The distance of the convex hull of `count` points to a triangle. direction, which may be NULL, gets the unit vector
 * that `lower` is proven by, from the triangle to the hull; 0 if lower is 0.
 */
struct oracle_interval oracle_hull_triangle(const double *corners, uint32_t count, const double triangle[9],
                                            double direction[3]);

#endif
