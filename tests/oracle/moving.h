/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * When a moving segment and a moving triangle first come as near as a radius, decided in exact arithmetic. It shares
 * nothing with the library.
 *
 * The distance is that of a pair of features: an end and a corner, an end or a corner and the line through an edge or
 * the segment, both lines, or an end and the triangle's plane. The square of each is a quotient of polynomials in time,
 * of at most the sixth degree. Before the first touch, if it is not at time 0, one such pair is the nearest one, and
 * its distance falls to the radius. So that time is a root of "distance^2 - radius^2" of a pair for which this is not
 * always 0. For each root between 0 and 1 it is asked, by signs of polynomials there, whether the two are within the
 * radius.
 *
 * Any finite numbers, any radius from 0: the answer is exact, none is left open. A pair may be degenerate at all times
 * or at some: corners and ends may coincide, the area may go through 0, all may lie in one plane. Numbers that are far
 * apart in size (1e-200 and 1) cost time alone. It cannot judge rounded ends: a + da is the exact sum. It does not say
 * which features touch, nor how long.
 */
#ifndef DPT_TESTS_ORACLE_MOVING_H
#define DPT_TESTS_ORACLE_MOVING_H

#ifdef __cplusplus
extern "C" {
#endif

/* Places at time 0, and their change until time 1. Lengths in any unit. */
struct moving_pair {
    double a[3], b[3], da[3], db[3];
    double corner[9], shift[9];
    double radius;
};

/*
 * 1 where there is a time from 0 to 1, both included, at which the distance is the radius or less. The first of them is
 * at *low if that is *high. Otherwise it lies between them, and there is no double between them: a double is later
 * than the first touch if, and only if, it is more than *low. Neither is written where there is none.
 */
int moving_first(const struct moving_pair *pair, double *low, double *high);

/* 1 where the distance at a time is `limit` or less; pair->radius is not read. */
int moving_within(const struct moving_pair *pair, double time, double limit);

#ifdef __cplusplus
}
#endif

#endif
