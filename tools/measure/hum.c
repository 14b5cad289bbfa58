/* SPDX-License-Identifier: BSD-3-Clause */
#include "measure/hum.h"

#include <math.h>
#include <stdlib.h>

#include "base/sincos.h"

/* Of the mean: what is not more than that is rounding, and has no frequency. */
#define ROUNDING 1e-12

/* rest = sizes without the mean of all lines in each tick. `lines` has room for as many. */
static void take_lines_out(const double *sizes, size_t count, double *lines, double *rest)
{
    const double middle = 0.5 * (HUM_WINDOW - 1), spread = HUM_WINDOW * (HUM_WINDOW * HUM_WINDOW - 1.0) / 12.0;
    for (size_t i = 0; i < count; i++)
        lines[i] = 0.0;
    for (size_t first = 0; first + HUM_WINDOW <= count; first++) {
        double mean = 0.0, slope = 0.0;
        for (size_t i = 0; i < HUM_WINDOW; i++) {
            mean += sizes[first + i] / HUM_WINDOW;
            slope += sizes[first + i] * ((double)i - middle) / spread;
        }
        for (size_t i = 0; i < HUM_WINDOW; i++)
            lines[first + i] += mean + slope * ((double)i - middle);
    }
    const size_t windows = count - HUM_WINDOW + 1;
    for (size_t i = 0; i < count; i++) {
        const size_t before = i + 1 < HUM_WINDOW ? i + 1 : HUM_WINDOW;
        const size_t behind = count - i < HUM_WINDOW ? count - i : HUM_WINDOW;
        size_t holding = before < behind ? before : behind;
        if (holding > windows)
            holding = windows;
        rest[i] = sizes[i] - lines[i] / (double)holding;
    }
}

/* The mean square of what is above the cut, and the strongest frequency there. `waves` has room for two numbers a tick. */
static double power_above(const double *rest, size_t count, double *waves, double *strongest)
{
    const size_t first = (size_t)floor(HUM_CUT * HUM_TICK * (double)count) + 1;
    double power = 0.0, most = 0.0;
    for (size_t i = 0; i < count; i++)
        turn_sincos((double)i / (double)count, &waves[2 * i], &waves[2 * i + 1]);
    for (size_t bin = first; 2 * bin <= count; bin++) {
        double sine = 0.0, cosine = 0.0;
        for (size_t i = 0, turn = 0; i < count; i++) {
            sine += rest[i] * waves[2 * turn];
            cosine += rest[i] * waves[2 * turn + 1];
            turn = turn + bin < count ? turn + bin : turn + bin - count;
        }
        const double share =
            (2 * bin < count ? 2.0 : 1.0) * (sine * sine + cosine * cosine) / ((double)count * (double)count);
        power += share;
        if (share > most) {
            most = share;
            *strongest = (double)bin / (HUM_TICK * (double)count);
        }
    }
    return power;
}

int hum_measure(struct hum *hum, const double *sizes, size_t count)
{
    *hum = (struct hum){ NAN, NAN, 0.0 };
    if (count < HUM_WINDOW)
        return 1;
    double *rest = malloc(4 * count * sizeof *rest);
    if (!rest)
        return 0;
    hum->mean = 0.0;
    for (size_t i = 0; i < count; i++)
        hum->mean += sizes[i] / (double)count;
    take_lines_out(sizes, count, rest + count, rest);
    hum->rms = sqrt(power_above(rest, count, rest + 2 * count, &hum->strongest));
    if (hum->rms <= ROUNDING * fabs(hum->mean))
        hum->strongest = 0.0;
    free(rest);
    return 1;
}
