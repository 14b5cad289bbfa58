/* SPDX-License-Identifier: BSD-3-Clause */
#include "plot/plot_log_axis.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define SLACK 1e-9

static const double factors[] = { 1.0, 2.0, 5.0 };

/* Three to a decade, counted from 1: 1, 2, 5, 10, ... */
static double step_value(int step)
{
    const int decade = (int)floor(step / 3.0);
    return factors[step - 3 * decade] * pow(10.0, decade);
}

static int step_below(double value)
{
    int step = 3 * (int)floor(log10(value));
    while (step_value(step + 1) <= value * (1.0 + SLACK))
        step++;
    return step;
}

static double decades_of(const struct plot_log_axis *axis)
{
    return log10(axis->high / axis->low);
}

struct plot_log_axis plot_log_axis_make(double low, double high, double start, double end, double room)
{
    int first = step_below(low), last = step_below(high);
    if (step_value(last) < high * (1.0 - SLACK))
        last++;
    if (last < first + 3)
        last = first + 3;
    return (struct plot_log_axis){
        .low = step_value(first), .high = step_value(last), .start = start, .end = end, .room = room
    };
}

double plot_log_axis_at(const struct plot_log_axis *axis, double value)
{
    return axis->start + (axis->end - axis->start) * log10(value / axis->low) / decades_of(axis);
}

double plot_log_axis_next(const struct plot_log_axis *axis, double mark)
{
    const double decade = fabs(axis->end - axis->start) / decades_of(axis);
    const int stride = decade >= 3.0 * axis->room ? 1 : 3 * (int)ceil(axis->room / decade);
    int step = mark > 0.0 ? step_below(mark) + stride : step_below(axis->low);
    while (step % stride)
        step++;
    const double next = step_value(step);
    return next <= axis->high * (1.0 + SLACK) ? next : 0.0;
}

void plot_log_axis_label(double mark, const char *unit, char text[PLOT_MARK_ROOM])
{
    static const char *const prefixes[] = { "", "m", "u", "n", "p", "f", "a" };
    int prefix = 0;
    const int has_prefix = strcmp(unit, "%") != 0;
    while (has_prefix && prefix < 6 && mark < 1.0 - SLACK) {
        mark *= 1e3;
        prefix++;
    }
    snprintf(text, PLOT_MARK_ROOM, "%.6g %s%s", mark, prefixes[prefix], unit);
}
