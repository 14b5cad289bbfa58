/* SPDX-License-Identifier: BSD-3-Clause */
/* Vectors of three numbers, and segments as their two ends. */
#ifndef DPT_TESTS_VECTOR_H
#define DPT_TESTS_VECTOR_H

#include <math.h>

#include "lib/random.h"

static inline double dot3(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline double length3(const double v[3])
{
    return sqrt(dot3(v, v));
}

static inline double apart(const double a[3], const double b[3])
{
    const double d[3] = { a[0] - b[0], a[1] - b[1], a[2] - b[2] };
    return length3(d);
}

static inline void cross3(const double a[3], const double b[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

/* Its length before; a zero vector stays. */
static inline double unit3(double v[3])
{
    const double length = length3(v);
    for (int k = 0; k < 3 && length > 0; k++)
        v[k] /= length;
    return length;
}

/* A direction; all are as likely. */
static inline void random_unit(uint64_t *seed, double v[3])
{
    do {
        for (int k = 0; k < 3; k++)
            v[k] = random_in(seed, -1, 1);
    } while (!(dot3(v, v) > 0.01 && dot3(v, v) < 1));
    unit3(v);
}

/* The point at s of a segment. */
static inline void point_at(const double ends[6], double s, double x[3])
{
    for (int k = 0; k < 3; k++)
        x[k] = ends[k] + s * (ends[3 + k] - ends[k]);
}

/* The farther of the two ways that a segment's ends went: no point of it went farther. */
static inline double ends_moved(const double from[6], const double to[6])
{
    return fmax(apart(from, to), apart(from + 3, to + 3));
}

#endif
