/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Whether a moving axis meets a triangle, decided in exact arithmetic. It shares nothing with the
 * library.
 *
 * Where the first touch is not at time 0, it is one of an end with the face or of the axis with an
 * edge. So its time is a root of a polynomial of at most the second degree: of an end's height
 * above the plane, of the volume that axis and edge span, or, where one of these is always 0, of
 * others that change where an end or a corner comes to lie on something. Such roots are numbers x +
 * y sqrt(d) with rational x, y, d, and so is all that is asked of the axis at that time; the sign
 * of such a number is exact. No case is left to rounding: coplanar, parallel and touching in one
 * point at one instant are cases like others.
 */
#ifndef DPT_TESTS_ORACLE_EXACT_H
#define DPT_TESTS_ORACLE_EXACT_H

#ifdef __cplusplus
extern "C" {
#endif

/*
 * 1 where the axis from a + t da to b + t db meets the triangle at some t in 0..until, `until` not
 * included unless `closed`; all numbers are taken as they are. Corners may coincide, the axis may
 * be a point.
 */
int exact_touch(const double a[3], const double b[3], const double da[3], const double db[3], const double triangle[9],
                double until, int closed);

#ifdef __cplusplus
}
#endif

#endif
