/* SPDX-License-Identifier: BSD-3-Clause */
#include "plot/plot_axis.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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
    const double min = length / marks;
    for (int exponent = -60;; exponent++) {
        const double power = power_of_ten(abs(exponent));
        for (int i = 0; i < 3; i++) {
            const double step = exponent < 0 ? factors[i] / power : factors[i] * power;
            if (step >= min * (1.0 - 1e-9))
                return step;
        }
    }
}

struct plot_axis plot_axis_make(double low, double high, double start, double end, int marks, int is_whole)
{
    struct plot_axis axis = { .low = low, .high = high, .start = start, .end = end };
    const double max = max_magnitude(low, high);
    const double min = max > 0.0 ? fmax(1e-9 * max, 1e-40) : 1e-3;
    if (axis.high - axis.low < min)
        axis.high = axis.low + min;
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

void plot_number(double value, int digits, char text[PLOT_NUMBER_ROOM])
{
    const double size = fabs(value);
    int decimals = digits - 1;
    if (size < 5e-10) {
        snprintf(text, PLOT_NUMBER_ROOM, "0");
        return;
    }
    for (double bound = 1.0; size < bound && decimals < 9; bound *= 0.1)
        decimals++;
    for (double bound = 10.0; size >= bound && decimals > 0; bound *= 10.0)
        decimals--;
    snprintf(text, PLOT_NUMBER_ROOM, "%.*f", decimals, value);
    if (decimals > 0) { /* 0.5, not 0.500 */
        char *end = text + strlen(text);
        while (end[-1] == '0')
            *--end = '\0';
        if (end[-1] == '.')
            end[-1] = '\0';
    }
}

void plot_quantity(double value, int digits, const char *unit, char text[PLOT_NUMBER_ROOM])
{
    static const char *const prefixes[] = { "", "m", "u", "n", "p", "f", "a" };
    char number[PLOT_NUMBER_ROOM];
    double scaled = value;
    int prefix = 0;
    while (strcmp(unit, "%") && prefix < 6 && fabs(scaled) < 1.0) {
        scaled *= 1e3;
        prefix++;
    }
    if (prefix == 6 && fabs(scaled) < 1.0) { /* less than an atto is rounding, and zero */
        scaled = 0.0;
        prefix = 0;
    }
    plot_number(scaled, digits, number);
    snprintf(text, PLOT_NUMBER_ROOM, "%.36s %s%.4s", number, prefixes[prefix], unit);
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

/* Below the distance of two samples of any device. */
static const double FIRST_WIDTH = 1.0 / (1 << 30);

int plot_line_init(struct plot_line *line)
{
    *line = (struct plot_line){ .width = FIRST_WIDTH, .is_broken = 1 };
    line->groups = malloc(PLOT_GROUPS_MAX * sizeof *line->groups);
    return line->groups != NULL;
}

void plot_line_free(struct plot_line *line)
{
    free(line->groups);
    *line = (struct plot_line){ .count = 0 };
}

void plot_group_join(struct plot_group *group, const struct plot_group *next)
{
    if (next->low.y < group->low.y)
        group->low = next->low;
    if (next->high.y > group->high.y)
        group->high = next->high;
    group->last = next->last;
    group->points += next->points;
}

/* A group is all that begins in one interval of the width. */
static int is_one_group(const struct plot_line *line, double a, double b)
{
    return floor(a / line->width) == floor(b / line->width);
}

/*
 * Double the width until a quarter of the groups is free. They lie in as many different intervals, so at least half of
 * them remain, and the width is below 1/2000 of the line's length.
 */
static void make_room(struct plot_line *line)
{
    while (line->count > PLOT_GROUPS_MAX * 3 / 4) {
        size_t kept = 0;
        line->width *= 2.0;
        for (size_t i = 1; i < line->count; i++) {
            if (is_one_group(line, line->groups[kept].first.x, line->groups[i].first.x))
                plot_group_join(&line->groups[kept], &line->groups[i]);
            else
                line->groups[++kept] = line->groups[i];
        }
        line->count = kept + 1;
    }
}

void plot_line_add(struct plot_line *line, double x, double y)
{
    if (!(fabs(y) <= PLOT_VALUE_MAX)) {
        plot_line_break(line);
        return;
    }
    if (line->count == PLOT_GROUPS_MAX)
        make_room(line);
    const struct plot_point point = { x, y };
    const struct plot_group group = { point, point, point, point, 1, line->is_broken };
    struct plot_group *last = line->count ? &line->groups[line->count - 1] : NULL;
    line->is_broken = 0;
    if (last && is_one_group(line, last->first.x, x)) {
        plot_group_join(last, &group);
        return;
    }
    line->groups[line->count++] = group;
}

void plot_line_break(struct plot_line *line)
{
    line->is_broken = 1;
}

struct plot_group plot_line_extremes(const struct plot_line *line)
{
    struct plot_group all = line->groups[0];
    for (size_t i = 1; i < line->count; i++)
        plot_group_join(&all, &line->groups[i]);
    return all;
}
