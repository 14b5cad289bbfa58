/* SPDX-License-Identifier: BSD-3-Clause */
#include "identify_push.h"

#include <math.h>

/* The device's speed, and what a command does, are known so much later, s. */
static const double LATENCY = 0.01;

/* Above this part of the speed it is braked with all the force. */
static const double TOO_FAST = 1.2;

/* ---- a trial ---- */

static const double TRIAL_REST = 0.03; /* s */

double identify_trial_force(struct identify_trial *trial, double time, double y, double v, int *is_over)
{
    const double sign = trial->level < 0.0 ? -1.0 : 1.0, t = time;
    const double moved = sign * (y - trial->y0), speed = sign * v;
    *is_over = 0;
    trial->last = moved;
    trial->peak = fmax(trial->peak, moved);
    if (speed > trial->peak_speed) {
        trial->peak_speed = speed;
        trial->peak_time = t;
    }
    if (trial->brake < 0.0) {
        if (t < trial->push_time && !(speed > trial->speed && moved > trial->least) && !(moved > trial->range))
            return trial->level;
        trial->brake = t;
    }
    if (trial->rest < 0.0) {
        if (speed > 0.0 && t < 2.5 * trial->brake)
            return -trial->level;
        trial->rest = t;
    }
    *is_over = t > trial->rest + TRIAL_REST;
    return 0.0;
}

/* ---- random pushes ---- */

/* A number from 0 to 1 (splitmix64). */
static double draw(uint64_t *random)
{
    uint64_t z = *random += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return (double)((z ^ z >> 31) >> 11) * 0x1p-53;
}

/*
 * The next push. A whole one more often than a half or none; towards the middle where the device is far from it. One
 * that rests is pushed with all the force, for friction may hold it against less.
 */
static void choose(struct identify_pushes *pushes, double time, double y, double v)
{
    const struct identify_strength *strength = &pushes->strength;
    const double way = draw(&pushes->random), part = draw(&pushes->random);
    const double duration = draw(&pushes->random);
    const double inward = y > 0.0 ? -1.0 : 1.0;
    const int is_out = fabs(y) > 0.4 * strength->range, rests = fabs(v) < 0.1 * strength->speed;
    const double sign = is_out ? (way < 0.85 ? inward : -inward) : way < 0.5 ? 1.0 : -1.0;
    const double scale = rests || part < 0.55 ? 1.0 : part < 0.8 ? 0.5 : 0.0;
    pushes->force = sign * scale * strength->level;
    pushes->until = time + fmax(pushes->dwell_min, fmin(0.15, strength->rise * (0.3 + duration)));
}

/* How hard to brake: friction and damping alone tell more of themselves, the whole force more of the mass. */
static double brake_part(uint64_t *random)
{
    const double part = draw(random);
    return part < 0.4 ? 0.0 : part < 0.6 ? 0.5 : 1.0;
}

/* Whether braking has done what it was for. */
static int has_braked(const struct identify_pushes *pushes, double time, double v)
{
    const struct identify_strength *strength = &pushes->strength;
    const double left = pushes->brake * v; /* negative: it still goes that way */
    return left > (pushes->is_far ? 0.3 : -0.5) * strength->speed ||
           time - pushes->brake_began > 2.0 * strength->rise + 0.05;
}

double identify_pushes_force(struct identify_pushes *pushes, double time, double y, double v)
{
    const struct identify_strength *strength = &pushes->strength;
    const double stop = 0.5 * v * fabs(v) * strength->rise / strength->speed + LATENCY * v;
    const int is_fast = fabs(v) > strength->speed;
    const int is_far = fabs(y + stop) > strength->range && (y + stop) * v > 0.0;
    if (pushes->brake && has_braked(pushes, time, v)) {
        pushes->brake = 0;
        pushes->until = time;
    }
    if (is_far ? !pushes->is_far || !pushes->brake : is_fast && !pushes->brake) {
        pushes->brake = v > 0.0 ? -1 : 1;
        pushes->is_far = is_far;
        pushes->brake_began = time;
        pushes->brake_force = strength->level * (is_far ? 1.0 : brake_part(&pushes->random));
    }
    if (fabs(v) > TOO_FAST * strength->speed)
        pushes->brake_force = strength->level;
    if (pushes->brake)
        return pushes->force = pushes->brake * pushes->brake_force;
    if (time >= pushes->until)
        choose(pushes, time, y, v);
    return pushes->force;
}
