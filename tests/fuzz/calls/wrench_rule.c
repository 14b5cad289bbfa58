/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The wrench, in one place (docs/algorithms/penalty.md): nothing without a depth; with one at most stiffness times
 * depth of each segment, about the tool's origin.
 */
#include "fuzz/calls/rules.h"

static double size_of(const double v[3])
{
    const double zero[3] = { 0.0, 0.0, 0.0 };
    return apart(v, zero);
}

static int is_zero(const dpt_wrench *wrench)
{
    int zero = 1;
    for (int k = 0; k < 3; k++)
        zero &= wrench->force[k] == 0.0 && wrench->torque[k] == 0.0;
    return zero;
}

void report_must_hold(const struct scene *scene, const struct model_tool *tool, const dpt_force_info *report)
{
    const int is_off = scene->def.until != DPT_UNTIL_RESPOND || tool->stiffness_then == 0.0;
    const int fades = (report->flags & DPT_FORCE_FLAG_FADING) != 0;
    const int is_felt = has_proxy(scene, tool->law_then);
    const uint32_t waits = scene->def.budget || scene->def.sweep_budget ? DPT_FORCE_FLAG_BEHIND : 0u;
    const uint32_t flags = is_felt ? DPT_FORCE_FLAG_FADING | DPT_FORCE_FLAG_FOLD | DPT_FORCE_FLAG_SQUEEZED |
                                         DPT_FORCE_FLAG_REPLACED | waits
                                   : DPT_FORCE_FLAG_FADING | DPT_FORCE_FLAG_PARTIAL;
    const int shapes = tool->was_shaped && tool->answers == ANSWERS_THERE && scene->def.until == DPT_UNTIL_RESPOND;
    const int is_shaped = (report->flags & DPT_FORCE_FLAG_SHAPED) != 0;
    HOLDS(report->reason <= DPT_FORCE_INSIDE && !(report->flags & ~(flags | DPT_FORCE_FLAG_SHAPED)) &&
              (tool->answers != ANSWERS_THERE || is_shaped == shapes) && (!is_shaped || tool->was_shaped),
          "reason %u, flags %x, shaped %d", report->reason, report->flags, shapes);
    HOLDS(is_felt || report->reason != DPT_FORCE_INSIDE, "reason %u, proxy %d", report->reason, is_felt);
    HOLDS(report->law == tool->law, "law %u, and not %u", report->law, tool->law);
    HOLDS(
        report->lag >= 0.0 && report->energy >= 0.0 &&
            (report->energy == 0.0 || ((is_felt || tool->law_then == DPT_LAW_BED) && report->reason == DPT_FORCE_ACTS)),
        "reason %u, %g J, lag %g", report->reason, report->energy, report->lag);
    HOLDS(has_proxy(scene, tool->law) ||
              (report->lag == 0.0 && !report->folds && !report->sticking && !report->slipping),
          "lag %g, %llu folds without a proxy", report->lag, (unsigned long long)report->folds);
    HOLDS(report->reason == DPT_FORCE_ACTS || fades || is_zero(&report->wrench), "a force of %g N, reason %u",
          size_of(report->wrench.force), report->reason);
    HOLDS(!fades || scene->def.fade > 0.0, "it fades, in a world that does not");
    /* Without bodies there is no hit, but the tool is free. */
    if (tool->answers == ANSWERS_NONE && !scene->then_count)
        HOLDS(report->reason != DPT_FORCE_ACTS && report->reason != DPT_FORCE_UNDECIDED, "reason %u without bodies",
              report->reason);
    else if (tool->answers == ANSWERS_NONE)
        HOLDS(report->reason == DPT_FORCE_STALE && !report->flags && is_zero(&report->wrench),
              "reason %u of a tool without answers", report->reason);
    if (tool->answers == ANSWERS_THERE)
        HOLDS((report->reason == DPT_FORCE_OFF) == is_off && report->reason != DPT_FORCE_STALE && !(is_off && fades),
              "reason %u of one with answers", report->reason);
}

/* A wrench that fades is that of an earlier step in part, which is not known here. */
void wrench_must_hold(const struct scene *scene, const struct model_tool *tool, const dpt_hit *hits,
                      const dpt_wrench *wrench, const dpt_force_info *report)
{
    report_must_hold(scene, tool, report);
    HOLDS(!memcmp(wrench, &report->wrench, sizeof *wrench), "the report has another wrench");
    if (report->flags & DPT_FORCE_FLAG_FADING) {
        met[MET_FADE]++;
        return;
    }
    if (has_proxy(scene, tool->law_then))
        return; /* proxy_must_hold */
    /* A bed has its line and both ends, and all bodies: each no deeper than the deepest. */
    const double most = tool->law_then == DPT_LAW_BED ? 2.0 * (double)scene->then_count : 1.0;
    double force = 0.0, torque = 0.0;
    uint32_t pushes = 0;
    const double slack = 1e-12 * (1.0 + size_of(tool->origin));
    for (uint32_t i = 0; i < tool->count; i++) {
        const double push = most * tool->stiffness_then * hits[i].depth;
        force += push;
        pushes += push > 1e-9;
        torque += push * fmax(apart(tool->at[i].a, tool->origin), apart(tool->at[i].b, tool->origin));
    }
    if (tool->answers == ANSWERS_EITHER)
        return;
    if (tool->answers == ANSWERS_NONE || scene->def.until != DPT_UNTIL_RESPOND || force == 0.0)
        HOLDS(is_zero(wrench), "a force of %g N, a torque of %g Nm without a cause", size_of(wrench->force),
              size_of(wrench->torque));
    met[MET_PUSH] += !is_zero(wrench);
    HOLDS(size_of(wrench->force) <= force * (1.0 + 1e-9), "%g N, and not %g at most", size_of(wrench->force), force);
    HOLDS(size_of(wrench->torque) <= torque * (1.0 + 1e-6) + slack * force, "%g Nm, and not %g at most",
          size_of(wrench->torque), torque);
    /* A single push out of what is closed has a way out, and is all there is; what is below 1e-9 N may underflow. */
    if (pushes == 1 && tool->law_then == DPT_LAW_POINT && scene->def.until == DPT_UNTIL_RESPOND &&
        scene->def.method != DPT_METHOD_PAPER && all_are_solid(scene))
        HOLDS(size_of(wrench->force) >= force * (1.0 - 1e-6), "%g N, and not %g", size_of(wrench->force), force);
}
