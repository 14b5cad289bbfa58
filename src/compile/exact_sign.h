/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Signs that rounding does not change, of expressions in floats' values: first in double with an error bound, then, where
 * that does not decide, by a sum without rounding (Shewchuk 1997).
 */
#ifndef DPT_COMPILE_EXACT_SIGN_H
#define DPT_COMPILE_EXACT_SIGN_H

#include <math.h>

/*
 * Of the sum of the absolute values of all products: Shewchuk's bounds are (7 + 56 e) e for a volume and (3 + 16 e) e for
 * an area, where e = 2^-53. Here both are taken as 8 e. Products of three floats neither underflow nor overflow in double.
 */
#define SIGN_ROUNDING 0x1p-50

enum { SIGN_UNSURE = 2 };

/* The sign of a value that is off by `bound` at most, or SIGN_UNSURE. */
static inline int sign_or_unsure(double value, double bound)
{
    return value > bound ? 1 : value < -bound ? -1 : bound == 0.0 ? 0 : SIGN_UNSURE;
}

/* A sum without rounding error, as terms whose bits do not overlap, from the smallest to the largest. */
struct exact_sum {
    double terms[48];
    int count;
};

static inline void exact_sum_add(struct exact_sum *sum, double value)
{
    int count = 0;
    for (int i = 0; i < sum->count; i++) {
        const double term = sum->terms[i], total = value + term, virtually = total - value;
        const double rest = (value - (total - virtually)) + (term - virtually);
        if (rest != 0.0)
            sum->terms[count++] = rest;
        value = total;
    }
    if (value != 0.0)
        sum->terms[count++] = value;
    sum->count = count;
}

static inline int exact_sum_sign(const struct exact_sum *sum)
{
    return sum->count == 0 ? 0 : sum->terms[sum->count - 1] > 0.0 ? 1 : -1;
}

/* How three points of a plane turn: 1 counterclockwise, -1 clockwise, 0 in line, or SIGN_UNSURE. */
static inline int turn_or_unsure(const double p[2], const double q[2], const double r[2])
{
    const double a = (q[0] - p[0]) * (r[1] - p[1]), b = (q[1] - p[1]) * (r[0] - p[0]);
    return sign_or_unsure(a - b, SIGN_ROUNDING * (fabs(a) + fabs(b)));
}

/* The same, exact. Coordinates are floats' values, so that each product is exact. */
static inline int exact_turn(const double p[2], const double q[2], const double r[2])
{
    const double *const points[3] = { p, q, r };
    struct exact_sum sum = { .count = 0 };
    for (int k = 0; k < 3; k++) {
        exact_sum_add(&sum, points[k][0] * points[(k + 1) % 3][1]);
        exact_sum_add(&sum, -points[k][1] * points[(k + 1) % 3][0]);
    }
    return exact_sum_sign(&sum);
}

static inline int turn_of(const double p[2], const double q[2], const double r[2])
{
    const int sign = turn_or_unsure(p, q, r);
    return sign == SIGN_UNSURE ? exact_turn(p, q, r) : sign;
}

#endif
