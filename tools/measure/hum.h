/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * How a force hums: what of its size, sampled at 1 kHz, a fingertip feels as a vibration.
 *
 * Lines are fitted by least squares over all windows of 51 ticks, each one tick behind the one before. What is taken out
 * of a tick is the mean of all lines there: 51 of them, fewer in the first and the last 50 ticks. Of the rest, the
 * discrete Fourier transform over the whole stretch keeps what is above 20 Hz; every tick counts alike. So
 *
 *   a line                is gone, within rounding
 *   a sine of f Hz        has 1 - D^2 - E^2 of its amplitude left: with u = 51 pi f / 1000 about
 *                         D = sin u / u, E = sqrt 3 (sin u - u cos u) / u^2. That is 0.945 at 30 Hz, 0.981 at 50, 0.998 at
 *                         250, and 0.0002 at 2 Hz; at the ends of the stretch some per cent at 2 Hz
 *   a step                leaves what lines cannot follow in the 50 ticks before and behind it
 */
#ifndef DPT_TOOLS_HUM_H
#define DPT_TOOLS_HUM_H

#include <stddef.h>

#define HUM_TICK 1e-3 /* s */
#define HUM_CUT  20.0 /* Hz */

enum { HUM_WINDOW = 51 };

struct hum {
    double mean;      /* N, of the size */
    double rms;       /* N: the hum */
    double strongest; /* Hz: the line of the spectrum, above the cut, that has most of it; 0: there is no hum */
};

/*
 * Measure `count` sizes, N. A stretch shorter than a window has no hum that could be told: NAN. Returns 0, with NANs, if
 * memory ran out.
 */
int hum_measure(struct hum *hum, const double *sizes, size_t count);

#endif
