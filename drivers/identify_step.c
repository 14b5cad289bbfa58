/* SPDX-License-Identifier: BSD-3-Clause */
#include "identify_step.h"

#include <math.h>

#include "base/vec3.h"

/* Fewer changes than this tell nothing. */
enum { CHANGES_MIN = 4 };

/* Of a grid, changes up to so many steps are looked at, and lie within this fraction of a step from it. */
static const double STEPS_MAX = 20.0, GRID_ERROR = 0.02;

static double change(const struct identify_sample *samples, uint32_t n, int k)
{
    return fabs(samples[n].y[k] - samples[n - 1].y[k]);
}

/* The step of a coordinate that lies on a grid: all small changes are multiples of the least. 0: it does not. */
static double grid_step(const struct identify_sample *samples, uint32_t count, int k)
{
    double step = HUGE_VAL, sum = 0.0, steps = 0.0;
    uint32_t small = 0, fitting = 0, still = 0;
    for (uint32_t n = 1; n < count; n++) {
        const double size = change(samples, n, k);
        still += size < 1e-12;
        if (size >= 1e-12)
            step = fmin(step, size);
    }
    for (uint32_t n = 1; n < count; n++) {
        const double size = change(samples, n, k), whole = floor(size / step + 0.5);
        if (size < 1e-12 || size > STEPS_MAX * step)
            continue;
        small++;
        fitting += fabs(size - whole * step) < GRID_ERROR * step;
        sum += size;
        steps += whole;
    }
    return small >= CHANGES_MIN && still >= CHANGES_MIN && (double)fitting > 0.95 * (double)small ? sum / steps : 0.0;
}

enum { NEAR = 5, BINS = 400 };

static double length_of_change(const struct identify_sample *samples, uint32_t n)
{
    return length(sub(vec3_of(samples[n].y), vec3_of(samples[n - 1].y)));
}

/* The bin of a length, 20 to a decade from 1e-12 on. */
static int bin_of(double size)
{
    const int bin = (int)floor(20.0 * (log10(size) + 12.0));
    return bin < 0 ? 0 : bin >= BINS ? BINS - 1 : bin;
}

/*
 * Encoders of joints give no grid of positions. Where the device moves so slowly that half of the samples repeat the
 * one before, each change is mostly one step: their median.
 */
static double slow_step(const struct identify_sample *samples, uint32_t count)
{
    uint32_t bins[BINS] = { 0 }, changes = 0, seen = 0, still = 0;
    for (uint32_t n = 1; n < count; n++) {
        still += length_of_change(samples, n) < 1e-12;
        if (n > 2 * NEAR + 1)
            still -= length_of_change(samples, n - 2 * NEAR - 1) < 1e-12;
        if (n < 2 * NEAR + 1 || still <= NEAR)
            continue;
        const double size = length_of_change(samples, n - NEAR);
        if (size >= 1e-12) {
            bins[bin_of(size)]++;
            changes++;
        }
    }
    if (changes < 2 * CHANGES_MIN)
        return 0.0;
    for (int bin = 0; bin < BINS; bin++) {
        seen += bins[bin];
        if (2 * seen >= changes)
            return pow(10.0, ((double)bin + 0.5) / 20.0 - 12.0);
    }
    return 0.0;
}

double identify_step(const struct identify_sample *samples, uint32_t count)
{
    double step = 0.0;
    for (int k = 0; k < 3; k++)
        step = fmax(step, grid_step(samples, count, k));
    return step > 0.0 ? step : slow_step(samples, count);
}
