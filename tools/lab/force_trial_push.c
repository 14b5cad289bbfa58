/* SPDX-License-Identifier: BSD-3-Clause */
#include <math.h>

#include "base/vec3.h"
#include "lab/force_lead.h"
#include "run/replay_report.h"

/* Ticks that a needle is led along, or held, once it is in. */
#define TICKS_IN 400

/* rad, 30 degrees. */
#define TURN_MAX 0.5235987755982988

static void judge_proxy(struct force_lead *lead, int is_fold, struct push_result *result)
{
    const double force = vec3_length(lead->force.wrench.force);
    dpt_pose proxy;
    dpt_tool_get_proxy(lead->world, lead->tool, &proxy);
    const double gap = force_lead_gap(lead, &proxy);
    result->least_gap = fmin(result->least_gap, gap);
    result->penetrations += gap < 0.0;
    result->lagging += !is_fold && force > SMALL_FORCE && lead->force.lag > 0.01 * force / lead->def->stiffness;
}

static void judge_push(struct force_lead *lead, double largest, struct push_result *result)
{
    const struct force_trial_def *def = lead->def;
    const int is_fold = (lead->force.flags & DPT_FORCE_FLAG_FOLD) != 0;
    /* Friction turns with the motion, by as much as its cone is wide. */
    const double turn_max = TURN_MAX + 2.0 * atan(def->friction);
    double jump[3];
    for (int k = 0; k < 3; k++)
        jump[k] = lead->force.wrench.force[k] - lead->last.wrench.force[k];
    result->ticks += lead->force.reason == DPT_FORCE_ACTS;
    result->folds += (uint64_t)is_fold;
    result->unknown += lead->force.reason == DPT_FORCE_UNDECIDED;
    const double angle = force_lead_turned(lead, largest);
    const double allowed = def->stiffness * (3.0 * force_lead_moved(lead) + PROXY_SPEED * LEAD_DT);
    const double share = force_lead_change(lead) / allowed;
    result->turns += angle > turn_max && !is_fold;
    result->reversals += angle > 3.0 * TURN_MAX && !is_fold;
    result->jumps += share > 1.0;
    result->largest_share = fmax(result->largest_share, share);
    result->largest_jump = fmax(result->largest_jump, vec3_length(jump));
    if (def->law == DPT_LAW_PROXY)
        judge_proxy(lead, is_fold, result);
}

/* From outside to the depth, then along the surface or not, with a tremor. */
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
    *result = (struct push_result){ .least_gap = HUGE_VAL };
    for (uint64_t i = 0; i < def->places && is_done; i++)
        is_done = push_at(&lead, tilts[i % 5], 1, result);
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
    *result = (struct push_result){ .least_gap = HUGE_VAL };
    for (uint64_t i = 0; i < def->places && is_done; i++)
        is_done = push_at(&lead, tilts[i % 4], 0, result);
    force_lead_close(&lead);
    return is_done;
}
