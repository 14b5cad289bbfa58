/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Sine and cosine with the same bits on every machine, unlike those of libm. Angles are in turns, so that the
 * reduction to an eighth of a turn is exact. Error below 2^-52.
 */
#ifndef DPT_SINCOS_H
#define DPT_SINCOS_H

#include <math.h>

/* The sine and cosine of an angle in turns, of a size below 2^40. */
static inline void turn_sincos(double turns, double *sine, double *cosine)
{
    static const double sine_terms[] = {
        1.0 / 355687428096000.0, -1.0 / 1307674368000.0, 1.0 / 6227020800.0, -1.0 / 39916800.0,
        1.0 / 362880.0,          -1.0 / 5040.0,          1.0 / 120.0,        -1.0 / 6.0
    };
    static const double cosine_terms[] = {
        1.0 / 20922789888000.0, -1.0 / 87178291200.0, 1.0 / 479001600.0, -1.0 / 3628800.0,
        1.0 / 40320.0,          -1.0 / 720.0,         1.0 / 24.0,        -1.0 / 2.0
    };
    double quarter = floor(4.0 * turns + 0.5);
    double x = 6.283185307179586 * (turns - 0.25 * quarter), z = x * x, s = 0.0, c = 0.0;
    for (int i = 0; i < 8; i++) {
        s = s * z + sine_terms[i];
        c = c * z + cosine_terms[i];
    }
    s = x + x * z * s;
    c = 1.0 + z * c;

    int quadrant = (int)((long long)quarter & 3);
    *sine = quadrant == 0 ? s : quadrant == 1 ? c : quadrant == 2 ? -s : -c;
    *cosine = quadrant == 0 ? c : quadrant == 1 ? -s : quadrant == 2 ? -c : s;
}

#endif
