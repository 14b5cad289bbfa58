/* SPDX-License-Identifier: BSD-3-Clause */
/* Angles in double, without the C library: the same bits on every machine. */
#ifndef DPT_ANGLE_H
#define DPT_ANGLE_H

#include "base/vec3.h"

#define ANGLE_TURN 6.28318530717958647692

/* atan(z) in rad, for z in 0..1: two half-angle steps, then the series up to z^17; error below 1e-14. */
static inline double arctangent(double z)
{
    for (int i = 0; i < 2; i++)
        z = z / (1.0 + sqrt(1.0 + z * z));
    double w = z * z, sum = 0.0;
    for (int k = 17; k >= 1; k -= 2)
        sum = 1.0 / k - w * sum;
    return 4.0 * z * sum;
}

/* The angle between two unit vectors, in rad, 0..pi (Kahan): accurate for small and for straight angles too. */
static inline double angle_between(vec3 a, vec3 b)
{
    double chord = length(sub(a, b)), sum = length(add(a, b));
    if (chord <= sum)
        return chord > 0.0 ? 2.0 * arctangent(chord / sum) : 0.0;
    return 0.5 * ANGLE_TURN - 2.0 * arctangent(sum / chord);
}

/*
 * The solid angle of the triangle a, b, c seen from a point x, over 4 pi: -1/2..1/2 (Van Oosterom and Strackee 1983).
 * a, b and c are given from x. Positive where x is behind the triangle, 0 where x lies in its plane.
 */
static inline double solid_turns(vec3 a, vec3 b, vec3 c)
{
    double la = length(a), lb = length(b), lc = length(c);
    double volume = dot(a, cross(b, c));
    double sides = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
    double height = fabs(volume), width = fabs(sides);
    if (!(height > 0.0))
        return 0.0;
    double angle = height > width ? 0.25 * ANGLE_TURN - arctangent(width / height) : arctangent(height / width);
    if (sides < 0.0)
        angle = 0.5 * ANGLE_TURN - angle;
    return (volume < 0.0 ? -angle : angle) / ANGLE_TURN;
}

#endif
