/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * By how many ticks the force is behind the device: the shift at which the changes of the force fit those of the
 * device's depth best. The device shakes at a few frequencies only. If all frequencies were in it, a low-pass would not
 * move the best fit: its answer to a sudden change is largest at once.
 */
#include "lab/force_trial.h"

#include <math.h>

#include "base/vec3.h"
#include "lab/force_lead.h"
#include "run/replay_report.h"

#define TURN 6.283185307179586

static void show(const struct force_trial_def *def, const char *part, uint64_t done, uint64_t count)
{
    if (def->show)
        def->show(def->user, part, (double)done / (double)count);
}

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

/* Push the device in to half of the depth, and shake it there. Returns 0 if there is no room, below 0 if no triangle. */
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
        show(def, "shaken", i, def->places);
        const int found = shake_at(&lead, tilts[i % 5], &shake);
        if (found > 0)
            add_fits(&shake, fits, result);
        is_done = found >= 0;
    }
    result->ticks = best_of(fits);
    force_lead_close(&lead);
    return is_done;
}

struct force_trial_def force_trial_through_def(const struct force_trial_def *def)
{
    dpt_mesh_info info = { .size = sizeof info };
    struct force_trial_def through = *def;
    double size[3];
    dpt_mesh_get_info(def->mesh, &info);
    for (int k = 0; k < 3; k++)
        size[k] = info.box_max[k] - info.box_min[k];
    through.length = def->length > 0.0 ? fmax(def->length, 1.2 * vec3_length(size)) : 0.0;
    through.depth = def->through;
    return through;
}

/* Hold the device where it began, with a tremor, until it is outside. */
static int begin_at(struct force_lead *lead, double tilt, struct inside_result *result)
{
    const double height = lead->def->radius - lead->def->depth;
    struct place place;
    if (!force_lead_place(lead, &place))
        return 0;
    lead->tremor[0] = lead->tremor[1] = lead->tremor[2] = 0.0;
    force_lead_hold(lead, &place, tilt, height, 0.0);
    if (force_lead_gap(lead, &lead->device) > -lead->def->radius)
        return 1; /* it does not cross here */
    force_lead_start(lead);
    result->places++;
    for (int t = 0; t < 200; t++) {
        force_lead_tremor(lead);
        force_lead_hold(lead, &place, tilt, height, 0.0);
        force_lead_step(lead);
        if (lead->force.reason == DPT_FORCE_FREE && force_lead_gap(lead, &lead->device) > 0.0)
            break;
        result->felt += vec3_length(lead->force.wrench.force) > 0.0 || lead->force.reason != DPT_FORCE_INSIDE;
    }
    return 1;
}

static int begin_inside(const struct force_trial_def *def, double tilt, struct inside_result *result)
{
    struct force_lead lead;
    int is_done = force_lead_open(&lead, def);
    for (uint64_t i = 0; i < def->places && is_done; i++) {
        show(def, "begun inside", i, def->places);
        is_done = begin_at(&lead, i % 2 ? tilt : 0.0, result);
    }
    force_lead_close(&lead);
    return is_done;
}

int force_trial_inside(const struct force_trial_def *def, struct inside_result *result)
{
    const struct force_trial_def through = force_trial_through_def(def);
    *result = (struct inside_result){ .places = 0 };
    return begin_inside(def, 0.0, result) && begin_inside(&through, 1.4, result);
}

/* Force on the device where it ends, N: less is none. What a low-pass leaves behind never quite ends. */
#define FORCE_OVER 1e-9

/* A closed path at a place. */
struct loop {
    struct place place;
    double depth, tilt, phase;
};

/* Where the device is at the angle t of the loop: out, in by up to the depth, along, tilting, and back. */
static void go_to(struct force_lead *lead, const struct loop *loop, double t)
{
    const struct place *place = &loop->place;
    const double wide = 0.006, out = 0.002;
    const double height = lead->def->radius + out - 0.5 * (loop->depth + out) * (1.0 - cos(t));
    double axis[3];
    for (int k = 0; k < 3; k++)
        axis[k] =
            place->normal[k] + loop->tilt * (sin(t + loop->phase) * place->side[k] + sin(2.0 * t) * place->across[k]);
    vec3_normalise(axis);
    lead->before = lead->device;
    point_along(axis, lead->device.orientation);
    for (int k = 0; k < 3; k++)
        lead->device.position[k] = place->x[k] + height * place->normal[k] + 0.5 * lead->def->length * axis[k] +
                                   wide * (sin(t) * place->side[k] + sin(2.0 * t) * place->across[k]);
}

/* The work of the last tick's motion, by the mean of the two wrenches. */
static double work_of(const struct force_lead *lead)
{
    const dpt_wrench *now = &lead->force.wrench, *was = &lead->last.wrench;
    double shift[3], turn[3], work = 0.0;
    force_lead_motion(lead, shift, turn);
    for (int k = 0; k < 3; k++)
        work += 0.5 * (now->force[k] + was->force[k]) * shift[k] + 0.5 * (now->torque[k] + was->torque[k]) * turn[k];
    return work;
}

static double energy_of(const struct force_lead *lead)
{
    const double force = vec3_length(lead->force.wrench.force);
    return lead->def->law == DPT_LAW_POINT ? 0.5 * force * force / lead->def->stiffness : lead->force.energy;
}

/* Lead the device in steps of at most 0.05 mm. */
static int path_at(struct force_lead *lead, struct path_result *result)
{
    enum { STEPS = 8000 };
    struct loop loop;
    double work = 0.0, high = 0.0;
    int folds = 0;
    if (!force_lead_place(lead, &loop.place))
        return 0;
    loop.depth = uniform(&lead->seed, 0.2, 1.0) * lead->def->depth;
    loop.tilt = uniform(&lead->seed, 0.0, 0.6);
    loop.phase = uniform(&lead->seed, 0.0, TURN);
    go_to(lead, &loop, 0.0);
    if (!(force_lead_gap(lead, &lead->device) > 0.0))
        return 1;
    force_lead_start(lead);
    if (lead->force.reason != DPT_FORCE_FREE)
        return 1;
    for (int i = 1; i <= STEPS; i++) {
        go_to(lead, &loop, TURN * i / STEPS);
        force_lead_step(lead);
        work += work_of(lead);
        high = fmax(high, energy_of(lead));
        folds += (lead->force.flags & DPT_FORCE_FLAG_FOLD) != 0;
    }
    /* What is not worth a force, or has not come back to the open, tells nothing. */
    if (!(high > 1e-6) || vec3_length(lead->force.wrench.force) > FORCE_OVER)
        return 1;
    result->paths++;
    result->emitting += work > 1e-3 * high;
    result->emitted_max = fmax(result->emitted_max, work / high);
    if (!folds)
        result->lost_max = fmax(result->lost_max, -work / high);
    return 1;
}

int force_trial_paths(const struct force_trial_def *def, struct path_result *result)
{
    struct force_lead lead;
    int is_done = force_lead_open(&lead, def);
    *result = (struct path_result){ .paths = 0 };
    for (uint64_t i = 0; i < def->paths && is_done; i++) {
        show(def, "closed paths", i, def->paths);
        is_done = path_at(&lead, result);
    }
    force_lead_close(&lead);
    return is_done;
}

/* Ticks that a needle is led along, or held, once it is in. */
#define TICKS_IN 400

/* rad, 30 degrees. */
#define TURN_MAX 0.5235987755982988

/* N: a fold may push harder by so much, beside what the device's motion explains: its clearance is worth less. */
#define FOLD_PUSH 1e-3

static void judge_proxy(struct force_lead *lead, struct push_result *result)
{
    dpt_pose proxy;
    dpt_tool_get_proxy(lead->stage.world, lead->stage.tool, &proxy);
    const double gap = force_lead_gap(lead, &proxy);
    result->gap_min = fmin(result->gap_min, gap);
    result->penetrations += gap < 0.0;
    result->lagging +=
        !lead->is_folding && vec3_length(lead->force.wrench.force) > SMALL_FORCE && force_lead_lags(lead, &lead->force);
    /* It goes where it is nearer to the device: |p' - d'| <= |p - d'| <= |p - d| + |motion|. */
    const double explained = lead->def->stiffness * force_lead_moved(lead) + FOLD_PUSH;
    result->fold_pushes += lead->is_folding && force_lead_growth(lead) > explained;
}

static void judge_push(struct force_lead *lead, double largest, struct push_result *result)
{
    const struct force_trial_def *def = lead->def;
    /* Friction turns with the motion, by as much as its cone is wide. */
    const double turn_max = TURN_MAX + 2.0 * atan(def->friction);
    double jump[3];
    for (int k = 0; k < 3; k++)
        jump[k] = lead->force.wrench.force[k] - lead->last.wrench.force[k];
    result->ticks += lead->force.reason == DPT_FORCE_ACTS;
    result->folds += (lead->force.flags & DPT_FORCE_FLAG_FOLD) != 0;
    result->unknown += lead->force.reason == DPT_FORCE_UNDECIDED;
    const double angle = force_lead_turned(lead, largest);
    const double allowed = def->stiffness * (3.0 * force_lead_moved(lead) + PROXY_SPEED * LEAD_DT);
    const double share = force_lead_change(lead) / allowed;
    result->turns += angle > turn_max && !lead->is_folding;
    result->reversals += angle > 3.0 * TURN_MAX && !lead->is_folding;
    result->jumps += share > LEAD_SHARE_MAX;
    result->largest_share = fmax(result->largest_share, share);
    result->largest_jump = fmax(result->largest_jump, vec3_length(jump));
    if (def->law == DPT_LAW_PROXY)
        judge_proxy(lead, result);
}

/* Lead the device from outside to the depth, then along the surface or not, with a tremor. */
static int push_at(struct force_lead *lead, double tilt, int is_led_along, struct push_result *result)
{
    const struct force_trial_def *def = lead->def;
    const double start_gap = 0.004, from = start_gap + def->radius, to = def->radius - def->depth;
    const double down = def->speed * LEAD_DT;
    const int ticks_down = (int)((from - to) / down), ticks = ticks_down + TICKS_IN;
    struct place place;
    double largest = 0.0;
    if (!force_lead_place(lead, &place))
        return 0;
    lead->tremor[0] = lead->tremor[1] = lead->tremor[2] = 0.0;
    for (int i = 0; i <= ticks; i++) {
        const double height = fmax(to, from - down * i);
        const double along = i > ticks_down && is_led_along ? down * (i - ticks_down) : 0.0;
        force_lead_tremor(lead);
        force_lead_hold(lead, &place, tilt, height, along);
        if (i == 0) {
            if (!(force_lead_gap(lead, &lead->device) > 0.5 * start_gap))
                return 1; /* something else is there */
            force_lead_start(lead);
            if (lead->force.reason != DPT_FORCE_FREE)
                return 1; /* it is inside of something */
            continue;
        }
        force_lead_step(lead);
        largest = fmax(largest, vec3_length(lead->force.wrench.force));
        judge_push(lead, largest, result);
    }
    return 1;
}

int force_trial_push(const struct force_trial_def *def, struct push_result *result)
{
    static const double tilts[] = { 0.0, 0.3, 0.8, 1.3, 1.5 };
    struct force_lead lead;
    int is_done = force_lead_open(&lead, def);
    *result = (struct push_result){ .gap_min = HUGE_VAL };
    for (uint64_t i = 0; i < def->places && is_done; i++) {
        show(def, "pushed in", i, def->places);
        is_done = push_at(&lead, tilts[i % 5], 1, result);
    }
    sort_numbers(lead.us, lead.us_count);
    result->us_median = percentile(lead.us, lead.us_count, 0.5);
    result->us_p99 = percentile(lead.us, lead.us_count, 0.99);
    force_lead_close(&lead);
    return is_done;
}

int force_trial_through(const struct force_trial_def *def, struct push_result *result)
{
    static const double tilts[] = { 0.0, 0.4, 1.2, 1.5707963267948966 };
    const struct force_trial_def through = force_trial_through_def(def);
    struct force_lead lead;
    int is_done = force_lead_open(&lead, &through);
    *result = (struct push_result){ .gap_min = HUGE_VAL };
    for (uint64_t i = 0; i < def->places && is_done; i++) {
        show(def, "held through", i, def->places);
        is_done = push_at(&lead, tilts[i % 4], 0, result);
    }
    force_lead_close(&lead);
    return is_done;
}
