/* SPDX-License-Identifier: BSD-3-Clause */
/* A budget of work that ends the searches of a tick. */
#include <math.h>

#include "stability/lab_lead.h"
#include "stability/lab_mesh.h"

/* 5 mm in and along, as force_trial_push does it; in the open at first. */
static void push_at(struct lab_lead *lead, double tilt, struct lab_tally *sum)
{
    const double from = 0.004 + LAB_RADIUS, to = LAB_RADIUS - 0.005, down = 1e-4;
    const int ticks_down = (int)((from - to) / down);
    struct place place;
    if (!force_lead_place(&lead->lead, &place))
        return;
    lab_lead_calm(lead);
    for (int i = 0; i <= ticks_down + 300; i++) {
        lab_lead_shake(lead);
        force_lead_hold(&lead->lead, &place, tilt, fmax(to, from - down * i),
                        i > ticks_down ? down * (i - ticks_down) : 0.0);
        if (i == 0) {
            if (!(force_lead_gap(&lead->lead, &lead->lead.device) > 0.002))
                return;
            lab_lead_start(lead);
        } else
            lab_lead_step(lead);
    }
    lab_tally_add(sum, &lead->tally);
}

static void run_budget(struct lab *lab)
{
    static const uint32_t budgets[] = { 25, 50, 100, 200, 400, 800, 1600, 3200, 0 };
    static const double tilts[] = { 0.0, 0.3, 0.8, 1.3, 1.5 };
    enum { BUDGETS = sizeof budgets / sizeof *budgets };
    struct lab_mesh liver;
    if (!lab_mesh_shape(lab, &liver, "liver", 50332))
        return;
    for (int method = 0; method < LAB_METHODS; method++) {
        const char *name = lab_method_name(method);
        struct lab_tally all = { .ticks = 0 };
        for (int b = 0; b < BUDGETS; b++) {
            const struct lab_lead_def def = { .method = method,
                                              .meshes = { liver.mesh },
                                              .budget = budgets[b] };
            struct lab_tally sum = { .ticks = 0 };
            struct lab_lead lead;
            if (lab_lead_open(lab, &lead, &def)) {
                const int places = (int)lab_share(lab, 30);
                lead.def.mesh = liver.mesh;
                for (int i = 0; i < places; i++)
                    push_at(&lead, tilts[i % 5], &sum);
                lab_tally_add(&all, &sum);
                if (budgets[b]) {
                    lab_point_at(lab, "stability-budget", name, budgets[b],
                                 lab_per_cent(sum.unknown, sum.ticks));
                    if (lab_has_proxy(method))
                        lab_point_at(lab, "stability-budget-lag", name, budgets[b],
                                     lab_per_cent(sum.lagging, sum.acting));
                }
                if (budgets[b] == 400)
                    lab_note(lab, name, "ticks without a force as contact is unknown, 400 units",
                             lab_per_cent(sum.unknown, sum.ticks), "%");
            }
            lab_lead_close(&lead);
        }
        if (lab_has_proxy(method))
            lab_at_most(lab, name, "ticks without a force as contact is unknown, any budget",
                        lab_per_cent(all.unknown, all.ticks), "%", 0.0);
        lab_tally_note(lab, method, &all);
    }
    lab_mesh_close(&liver);
}

const struct lab_case budget_case = {
    .name = "budget",
    .title = "When the budget ends a tick",
    .method =
        "A needle of 100 mm is pushed 5 mm into a liver of 50,332 triangles and led along it, with "
        "budgets of 25 to 3,200 units of work a tick. The laws without a proxy have no force where "
        "the budget leaves contact unknown: the chart shows that share. A proxy stays where it was "
        "proven free and has always a force; what it costs is lag, shown in a chart of its own as "
        "the share of ticks that lag by more than 1 %. The ball is this library's proxy of one "
        "point at the tip.",
    .advice =
        "Give every real loop a budget. Measure the work of your scene with dpt_world_usage or "
        "dynpoint replay --json, and choose three times its 99 %. Below that the proxy gets "
        "sluggish but stays safe; the bed and the point lose their force for some ticks, which is "
        "felt as a buzz.",
    .run = run_budget
};
