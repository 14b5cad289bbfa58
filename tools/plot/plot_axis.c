/* SPDX-License-Identifier: BSD-3-Clause */
#include "plot/plot_axis.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static double max_magnitude(double a, double b)
{
    return fmax(fabs(a), fabs(b));
}

static void choose_prefix(struct plot_axis *axis)
{
    static const struct {
        const char *name;
        double scale;
    } prefixes[] = { { "", 1.0 }, { "m", 1e-3 }, { "u", 1e-6 }, { "n", 1e-9 }, { "p", 1e-12 } };
    const double max = max_magnitude(axis->low, axis->high);
    size_t i = 0;
    while (i + 1 < sizeof prefixes / sizeof *prefixes && max < prefixes[i].scale)
        i++;
    axis->prefix = prefixes[i].name;
    axis->scale = prefixes[i].scale;
    axis->low /= axis->scale;
    axis->high /= axis->scale;
}

/* libm's pow may differ from machine to machine; products are the same on all. */
static double power_of_ten(int exponent)
{
    double power = 1.0;
    for (int i = 0; i < exponent; i++)
        power *= 10.0;
    return power;
}

/* The least step of 1, 2 or 5 times a power of ten that makes at most so many of the length. */
static double choose_step(double length, int marks)
{
    static const double factors[] = { 1.0, 2.0, 5.0 };
    const double least = length / marks;
    for (int exponent = -60;; exponent++) {
        const double power = power_of_ten(abs(exponent));
        for (int i = 0; i < 3; i++) {
            const double step = exponent < 0 ? factors[i] / power : factors[i] * power;
            if (step >= least * (1.0 - 1e-9))
                return step;
        }
    }
}

struct plot_axis plot_axis_make(double low, double high, double start, double end, int marks, int is_whole)
{
    struct plot_axis axis = { .low = low, .high = high, .start = start, .end = end };
    const double max = max_magnitude(low, high);
    const double least = max > 0.0 ? fmax(1e-9 * max, 1e-40) : 1e-3;
    if (axis.high - axis.low < least)
        axis.high = axis.low + least;
    choose_prefix(&axis);
    axis.step = choose_step(axis.high - axis.low, marks);
    const double slack = 1e-9; /* a limit that is a mark but for rounding is that mark */
    if (is_whole) {
        axis.first = floor(axis.low / axis.step + slack);
        axis.last = ceil(axis.high / axis.step - slack);
        axis.low = fmin(axis.low, axis.first * axis.step);
        axis.high = fmax(axis.high, axis.last * axis.step);
    } else {
        axis.first = ceil(axis.low / axis.step - slack);
        axis.last = floor(axis.high / axis.step + slack);
    }
    axis.first += 0.0; /* no mark is -0 */
    axis.last += 0.0;
    return axis;
}

double plot_axis_at(const struct plot_axis *axis, double value)
{
    const double share = (value / axis->scale - axis->low) / (axis->high - axis->low);
    return axis->start + share * (axis->end - axis->start);
}

void plot_axis_label(const struct plot_axis *axis, double multiple, char text[PLOT_LABEL_ROOM])
{
    const double max = max_magnitude(axis->low, axis->high);
    int decimals = 0;
    for (double step = axis->step; step < 1.0 - 1e-9 && decimals < 12; step *= 10.0)
        decimals++;
    if (max >= 1e7 || max < 1e-3 || decimals > 9)
        snprintf(text, PLOT_LABEL_ROOM, "%.12g", multiple * axis->step);
    else
        snprintf(text, PLOT_LABEL_ROOM, "%.*f", decimals, multiple * axis->step);
}
