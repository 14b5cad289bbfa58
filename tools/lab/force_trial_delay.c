/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * By how many ticks the force is behind the device: the shift at which the changes of the force fit those of the
 * device's depth best. The device shakes at a few frequencies only. If all frequencies were in it, a low-pass would not
 * move the best fit: its answer to a sudden change is largest at once.
 */
#include <math.h>

#include "base/vec3.h"
#include "lab/force_lead.h"

#define TURN 6.283185307179586

enum { FREQUENCIES = 3, LAGS = 60, FITTED = 1000, TICKS = LAGS + 1 + FITTED + 1 };

/* Hz: of a hand's tremor, and whole periods in FITTED ticks. A low-pass of T seconds holds all back by about T. */
static const double frequencies[FREQUENCIES] = { 7.0, 11.0, 17.0 };

/* m: where the device begins, and how far it shakes to either side. */
#define START_GAP 0.004
#define SHAKE     2e-4

/* What changed in a tick: the device's depth, and the force the way out. */
struct shake {
    double depth[TICKS], force[TICKS];
};

/* Sum of depth * force, the force `lag` ticks later, -1 to LAGS + 1, over the same ticks of the force for every lag. */
static double correlate(const struct shake *shake, int lag)
{
    double sum = 0.0;
    for (int t = LAGS + 1; t < LAGS + 1 + FITTED; t++)
        sum += shake->depth[t - lag] * shake->force[t];
    return sum;
}

/* Pushed in to half of the depth, and shaken there. 0: there is no room for it; below 0: no triangle. */
static int shake_at(struct force_lead *lead, double tilt, struct shake *shake)
{
    const struct force_trial_def *def = lead->def;
    const double from = START_GAP + def->radius, to = def->radius - 0.5 * def->depth;
    const double amplitude = fmin(SHAKE, 0.25 * def->depth) / FREQUENCIES;
    const double down = def->speed * LEAD_DT;
    const int ticks_down = (int)((from - to) / down) + 1;
    struct place place;
    double phases[FREQUENCIES], deeper = 0.0;
    if (!force_lead_place(lead, &place))
        return -1;
    for (int f = 0; f < FREQUENCIES; f++)
        phases[f] = uniform(&lead->seed, 0.0, TURN);
    force_lead_hold(lead, &place, tilt, from, 0.0);
    if (!(force_lead_gap(lead, &lead->device) > 0.5 * START_GAP))
        return 0;
    force_lead_start(lead);
    if (lead->force.reason != DPT_FORCE_FREE)
        return 0;
    for (int i = 1; i <= ticks_down + TICKS; i++) {
        const double before = deeper, t = LEAD_DT * (i - ticks_down);
        deeper = 0.0;
        for (int f = 0; f < FREQUENCIES; f++)
            deeper += amplitude * sin(TURN * frequencies[f] * t + phases[f]);
        force_lead_hold(lead, &place, tilt, fmax(to, from - down * i) - deeper, 0.0);
        force_lead_step(lead);
        if (i <= ticks_down)
            continue;
        shake->depth[i - ticks_down - 1] = deeper - before;
        shake->force[i - ticks_down - 1] =
            vec3_dot(lead->force.wrench.force, place.normal) - vec3_dot(lead->last.wrench.force, place.normal);
    }
    return 1;
}

/* Each place counts alike, however stiff it feels. fits[0] is of lag -1. */
static void add_fits(const struct shake *shake, double *fits, struct delay_result *result)
{
    double square = 0.0;
    for (int t = 0; t < TICKS; t++)
        square += shake->force[t] * shake->force[t];
    if (!(square > 0.0))
        return;
    result->places++;
    for (int lag = -1; lag <= LAGS + 1; lag++)
        fits[lag + 1] += correlate(shake, lag) / sqrt(square);
}

/* The best fit, by a parabola through its neighbours. LAGS where nothing fits. */
static double best_of(const double *fits)
{
    int best = 1;
    for (int i = 2; i <= LAGS + 1; i++)
        best = fits[i] > fits[best] ? i : best;
    const double before = fits[best - 1], at = fits[best], behind = fits[best + 1];
    const double bend = before - 2.0 * at + behind;
    if (!(at > 0.0))
        return LAGS;
    return fmax(0.0, best - 1 + (bend < 0.0 ? 0.5 * (before - behind) / bend : 0.0));
}

int force_trial_delay(const struct force_trial_def *def, struct delay_result *result)
{
    static const double tilts[] = { 0.0, 0.3, 0.8, 1.3, 1.5 };
    struct force_lead lead;
    struct shake shake;
    double fits[LAGS + 3] = { 0.0 };
    int is_done = force_lead_open(&lead, def);
    *result = (struct delay_result){ .places = 0 };
    for (uint64_t i = 0; i < def->places && is_done; i++) {
        const int found = shake_at(&lead, tilts[i % 5], &shake);
        if (found > 0)
            add_fits(&shake, fits, result);
        is_done = found >= 0;
    }
    result->ticks = best_of(fits);
    force_lead_close(&lead);
    return is_done;
}
