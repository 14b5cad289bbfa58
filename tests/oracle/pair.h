/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What the distance of a segment and a triangle is, from the definition alone: slow, obvious, and
 * of another construction than the library's, in two ways that share no code.
 *
 * oracle_pair, long double. The distance of the point A + s(B - A) to the triangle is convex in s,
 * so a golden-section search finds its least. With the 64-bit significand of x86 it is within 0.02
 * * 2^-53 of the largest coordinate for any finite doubles, slivers and coinciding corners included
 * (tests/nearest/test_pair.c measures it against the bracket).
 *
 * oracle_bracket, 113 bits. The distance is that of the origin to the convex hull of the six
 * differences corner - end. By Caratheodory's theorem the nearest point lies on one of the 56
 * subsets of one to four of them. Each subset yields a witness, two points that exist, so the truth
 * is not more; and a direction n, and the truth is not less than min n.(corner - end) / |n|: a
 * separating slab. The bracket needs no trust in any choice of subset, only in sums and products.
 * It closes to below 2^-80 of the largest coordinate unless the distance itself is less than that.
 *
 * Neither can judge which of several nearest points, values of s or equal triangles is the right
 * one: check instead that an answer's points exist and are as far apart as it says. Neither takes
 * numbers that are not finite, nor differences whose squares leave the range of long double. Where
 * long double is no wider than double (ORACLE_PAIR_JUDGES is 0) oracle_pair judges nothing.
 */
#ifndef DPT_TESTS_ORACLE_PAIR_H
#define DPT_TESTS_ORACLE_PAIR_H

#include <float.h>

#define ORACLE_PAIR_JUDGES (LDBL_MANT_DIG >= 64)

/* A 113-bit number. ARM's long double is one already. */
#if defined(__SIZEOF_FLOAT128__)
typedef __float128 oracle_wide;
#define ORACLE_BRACKET_JUDGES 1
#else
typedef long double oracle_wide;
#define ORACLE_BRACKET_JUDGES (LDBL_MANT_DIG >= 113)
#endif

/* The distance of a point to a triangle of three corners, any of which may coincide. */
long double oracle_point(const double point[3], const double triangle[9]);

/* The distance of the segment ax, ay, az, bx, by, bz to the triangle. About 10 us. */
long double oracle_pair(const double segment[6], const double triangle[9]);

/* lower <= distance <= upper, up to a rounding of 2^-108 of the largest difference. About 300 us.
 */
void oracle_bracket(const double segment[6], const double triangle[9], oracle_wide *lower, oracle_wide *upper);

#endif
