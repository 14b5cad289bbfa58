/* SPDX-License-Identifier: BSD-3-Clause */
#include "sim/sim_axis.h"

#include <math.h>
#include <string.h>

enum { POSITION, VELOCITY, CONSTANT, DECAYING, COLUMNS };

/* Of a located moment, in parts of the time it lies in. */
static const double RESOLUTION = 0x1p-50;

/*
 * A Taylor series over a fraction of the time, squared as often as it was halved. Time is counted in units of `time`
 * and force in m per unit^2.
 */
struct sim_transition sim_axis_transition(const struct sim_axis *axis, double time)
{
    const double k = axis->spring * time * time / axis->mass, c = axis->damping * time / axis->mass;
    const double decay = axis->lag > 0.0 ? time / axis->lag : 0.0;
    double sum[2][COLUMNS] = { { 1.0, 0.0, 0.0, 0.0 }, { 0.0, 1.0, 0.0, 0.0 } };
    double term[2][COLUMNS] = { { 1.0, 0.0, 0.0, 0.0 }, { 0.0, 1.0, 0.0, 0.0 } };
    double force[COLUMNS] = { 0.0, 0.0, 1.0, 1.0 }, part = 1.0, left = 1.0;
    int halvings = 0;
    for (double norm = 1.0 + k + c + decay; norm * part > 0.25; part *= 0.5)
        halvings++;
    for (int i = 1; i <= 14; i++) {
        const double scale = part / i;
        for (int column = 0; column < COLUMNS; column++) {
            double x = term[0][column], v = term[1][column];
            term[0][column] = v * scale;
            term[1][column] = (force[column] - k * x - c * v) * scale;
            sum[0][column] += term[0][column];
            sum[1][column] += term[1][column];
        }
        force[CONSTANT] = 0.0;
        force[DECAYING] *= -decay * scale;
        left += force[DECAYING];
    }
    for (; halvings > 0; halvings--) {
        double unsquared[2][COLUMNS];
        memcpy(unsquared, sum, sizeof unsquared);
        for (int row = 0; row < 2; row++) {
            for (int column = 0; column < COLUMNS; column++)
                sum[row][column] =
                    unsquared[row][POSITION] * unsquared[0][column] + unsquared[row][VELOCITY] * unsquared[1][column];
            sum[row][CONSTANT] += unsquared[row][CONSTANT];
            sum[row][DECAYING] += unsquared[row][DECAYING] * left;
        }
        left *= left;
    }
    const double push = time * time / axis->mass;
    return (struct sim_transition){ .time = time,
                                    .xx = sum[0][POSITION],
                                    .xv = sum[0][VELOCITY] * time,
                                    .xf = sum[0][CONSTANT] * push,
                                    .xd = sum[0][DECAYING] * push,
                                    .vx = sum[1][POSITION] / time,
                                    .vv = sum[1][VELOCITY],
                                    .vf = sum[1][CONSTANT] * push / time,
                                    .vd = sum[1][DECAYING] * push / time,
                                    .dd = left };
}

/* An axis in one direction, or at rest, with its position counted from where it is at time 0. */
struct stretch {
    const struct sim_axis *axis;
    const struct sim_transition *whole; /* one that is known */
    double direction;                   /* 1 or -1: of the velocity, or at rest of the force */
    double v;                           /* m/s */
    double force;                       /* the constant one at time 0, with friction if it moves, N */
    double decaying;                    /* the decaying one at time 0, N */
};

static struct sim_transition over_time(const struct stretch *stretch, double time)
{
    return time == stretch->whole->time ? *stretch->whole : sim_axis_transition(stretch->axis, time);
}

static double x_after(const struct stretch *stretch, const struct sim_transition *over)
{
    const double x = over->xv * stretch->v + over->xf * stretch->force;
    return stretch->axis->lag > 0.0 ? x + over->xd * stretch->decaying : x;
}

static double v_after(const struct stretch *stretch, const struct sim_transition *over)
{
    const double v = over->vv * stretch->v + over->vf * stretch->force;
    return stretch->axis->lag > 0.0 ? v + over->vd * stretch->decaying : v;
}

static double speed_at(const struct stretch *stretch, double time)
{
    const struct sim_transition over = over_time(stretch, time);
    return stretch->direction * v_after(stretch, &over);
}

/*
 * y = v' + v / lag, times the mass. v exp(t / lag) rises where y is positive and falls where it is negative. y itself
 * follows m y'' + damping y' + spring y = 0.
 */
static double rise_at(const struct stretch *stretch, double time)
{
    const struct sim_axis *axis = stretch->axis;
    double x = 0.0, v = stretch->v, decaying = stretch->decaying;
    if (time > 0.0) {
        const struct sim_transition over = over_time(stretch, time);
        x = x_after(stretch, &over);
        v = v_after(stretch, &over);
        decaying *= over.dd;
    }
    return stretch->direction *
           (stretch->force + decaying - axis->spring * x - axis->damping * v + axis->mass / axis->lag * v);
}

/* By how much the force on an axis at rest is above stiction. */
static double excess_at(const struct stretch *stretch, double time)
{
    const struct sim_transition over = over_time(stretch, time);
    return stretch->direction * (stretch->force + stretch->decaying * over.dd) - stretch->axis->stiction;
}

/*
 * Where a value changes its sign between `low` and `high`, both above 0: the end of the interval that is left, which has
 * the sign of `high`. If `low` has that sign too, about `low`. Of three steps two are false position, with the weight of
 * the end that stays halved, and one is a bisection.
 */
static double locate(const struct stretch *stretch, double (*value)(const struct stretch *stretch, double time),
                     double low, double high)
{
    const double resolution = RESOLUTION * high;
    double at_low = value(stretch, low), at_high = value(stretch, high);
    const int is_above = at_high > 0.0;
    for (int i = 0; high - low > resolution; i++) {
        double time = (low * at_high - high * at_low) / (at_high - at_low);
        if (i % 3 == 2 || !(time > low && time < high))
            time = 0.5 * (low + high);
        const double at_time = value(stretch, time);
        if ((at_time > 0.0) == is_above) {
            high = time;
            at_high = at_time;
            at_low *= 0.5;
        } else {
            low = time;
            at_low = at_time;
            at_high *= 0.5;
        }
    }
    return high;
}

/* How long an axis at rest stays there: all of `left`, or until the motor's force is above stiction. */
static double time_at_rest(struct stretch *stretch, double left)
{
    const double limit = stretch->axis->stiction;
    if (fabs(stretch->force + stretch->decaying) > limit)
        return 0.0;
    if (stretch->axis->lag == 0.0)
        return left;
    const double end = stretch->force + stretch->decaying * over_time(stretch, left).dd;
    if (fabs(end) <= limit)
        return left;
    stretch->direction = end > 0.0 ? 1.0 : -1.0;
    return locate(stretch, excess_at, RESOLUTION * left, left);
}

/*
 * When a moving axis stops within `step`; *stops is 0 if it does not. A step is shorter than half a period of the
 * axis's own oscillation, so without a lag v has at most one zero in it. With a lag y has at most one, so v exp(t / lag)
 * has at most one extremum, and v at most two zeros, one on each side of it. For an axis that leaves rest, time 0 is
 * one of these.
 */
static double time_to_stop(const struct stretch *stretch, double step, int *stops)
{
    const double low = RESOLUTION * step;
    double high = step;
    *stops = speed_at(stretch, step) <= 0.0;
    if (stretch->axis->lag > 0.0 && !*stops && stretch->v != 0.0 && rise_at(stretch, 0.0) <= 0.0 &&
        rise_at(stretch, step) > 0.0) {
        high = locate(stretch, rise_at, low, step);
        *stops = speed_at(stretch, high) <= 0.0;
    }
    return *stops ? locate(stretch, speed_at, low, high) : step;
}

static void advance_with_friction(const struct sim_axis *axis, const struct sim_transition *whole,
                                  const struct sim_load *load, struct sim_motion *motion)
{
    const double frequency = sqrt(axis->spring / axis->mass);
    double left = whole->time, decaying = axis->lag > 0.0 ? motion->f - load->command : 0.0;
    while (left > 0.0) {
        const double force = load->command + load->push - axis->spring * (motion->x - load->centre);
        struct stretch stretch = { axis, whole, force + decaying > 0.0 ? 1.0 : -1.0, motion->v, force, decaying };
        double time = 0.0;
        if (motion->v == 0.0)
            time = time_at_rest(&stretch, left);
        if (time > 0.0) {
            decaying *= over_time(&stretch, time).dd;
            left -= time;
            continue;
        }
        if (motion->v != 0.0)
            stretch.direction = motion->v > 0.0 ? 1.0 : -1.0;
        stretch.force -= stretch.direction * axis->friction;
        /* 3 is below pi, half a period. */
        const double step = left / (floor(left * frequency / 3.0) + 1.0);
        int stops;
        time = time_to_stop(&stretch, step, &stops);
        const struct sim_transition over = over_time(&stretch, time);
        motion->x += x_after(&stretch, &over);
        motion->v = stops ? 0.0 : v_after(&stretch, &over);
        decaying *= over.dd;
        left -= time;
    }
    motion->f = load->command + decaying;
}

void sim_axis_advance(const struct sim_axis *axis, const struct sim_transition *over, const struct sim_load *load,
                      struct sim_motion *motion)
{
    if (axis->stiction > 0.0) {
        advance_with_friction(axis, over, load, motion);
        return;
    }
    const double x = motion->x - load->centre, v = motion->v, force = load->command + load->push;
    double to_x = over->xx * x + over->xv * v + over->xf * force;
    double to_v = over->vx * x + over->vv * v + over->vf * force, decaying = 0.0;
    if (axis->lag > 0.0) {
        decaying = motion->f - load->command;
        to_x += over->xd * decaying;
        to_v += over->vd * decaying;
        decaying *= over->dd;
    }
    motion->x = load->centre + to_x;
    motion->v = to_v;
    motion->f = load->command + decaying;
}
