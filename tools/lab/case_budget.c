/* SPDX-License-Identifier: BSD-3-Clause */
/* A budget of work that ends the searches of a tick. */
#include <math.h>

#include "lab/lab_lead.h"
#include "lab/lab_mesh.h"

/* Units: below these the proxy is known to crawl, so its force may turn while it is small. */
#define BUDGET_ENOUGH 200

/* In the open until the first answer is known, which takes a small budget many ticks. 0 if it is not free there. */
static int begin_free(struct lab_lead *lead)
{
    lab_lead_start(lead);
    for (int i = 0; i < 3000 && lead->lead.force.reason != DPT_FORCE_FREE; i++)
        lab_lead_step(lead);
    lead->tally = (struct lab_tally){ .least_gap = HUGE_VAL };
    return lead->lead.force.reason == DPT_FORCE_FREE;
}

/* 5 mm in and along, as force_trial_push does it. */
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
        if (i)
            lab_lead_step(lead);
        else if (!(force_lead_gap(&lead->lead, &lead->lead.device) > 0.002 && begin_free(lead)))
            return;
    }
    lab_tally_add(sum, &lead->tally);
}

static void add_points(struct lab *lab, int method, uint32_t budget, const struct lab_tally *sum)
{
    const char *name = lab_method_name(method);
    lab_point_at(lab, "stability-budget", name, budget, lab_per_cent(sum->unknown, sum->ticks));
    if (lab_has_proxy(method))
        lab_point_at(lab, "stability-budget-lag", name, budget, lab_per_cent(sum->lagging, sum->acting));
    if (budget == 25)
        lab_note(lab, name, "ticks that lack a force, contact unknown, at 25 units",
                 lab_per_cent(sum->unknown, sum->ticks), "%");
    if (budget == 100 && lab_has_proxy(method))
        lab_note(lab, name, "ticks that lag by more than 1 %, at 100 units", lab_per_cent(sum->lagging, sum->acting),
                 "%");
}

static void run_budget_of(struct lab *lab, int method, const dpt_mesh *mesh)
{
    static const uint32_t budgets[] = { 10, 25, 50, 75, 100, 150, 200, 400, 800, 0 };
    static const double tilts[] = { 0.0, 0.3, 0.8, 1.3, 1.5 };
    const char *name = lab_method_name(method);
    struct lab_tally small = { .ticks = 0 }, enough = { .ticks = 0 };
    for (size_t b = 0; b < sizeof budgets / sizeof *budgets; b++) {
        const struct lab_lead_def def = { .method = method, .meshes = { mesh }, .budget = budgets[b] };
        const int is_enough = !budgets[b] || budgets[b] >= BUDGET_ENOUGH;
        const int places = (int)lab_share(lab, 40);
        struct lab_tally sum = { .ticks = 0 };
        struct lab_lead lead;
        if (lab_lead_open(lab, &lead, &def)) {
            lead.def.mesh = mesh;
            for (int i = 0; i < places; i++)
                push_at(&lead, tilts[i % 5], &sum);
            lab_tally_add(is_enough ? &enough : &small, &sum);
            if (budgets[b])
                add_points(lab, method, budgets[b], &sum);
        }
        lab_lead_close(&lead);
    }
    lab_at_most(lab, name, "ticks that lack a force, contact unknown, at all budgets",
                lab_per_cent(small.unknown + enough.unknown, small.ticks + enough.ticks), "%", 0.0);
    lab_at_most(lab, name, "below 200 units: largest |dW|, of K (3 |motion| + 1 mm)", small.share, "", 1.0);
    lab_note(lab, name, "below 200 units: ticks that turn the force by over 30 degrees",
             lab_per_cent(small.turns, small.acting), "%");
    if (lab_has_proxy(method))
        lab_at_most(lab, name, "below 200 units: ticks whose proxy is in a body", (double)small.in_mesh, "", 0.0);
    lab_tally_note(lab, method, &enough);
}

static void run_budget(struct lab *lab)
{
    struct lab_mesh liver;
    if (!lab_mesh_shape(lab, &liver, "liver", 50332))
        return;
    for (int method = 0; method < LAB_METHODS; method++)
        run_budget_of(lab, method, liver.mesh);
    lab_mesh_close(&liver);
}

const struct lab_case budget_case = {
    .name = "budget",
    .title = "When the budget ends a tick",
    .method = "A needle of 100 mm is pushed 5 mm into a liver of 50,332 triangles and led along it, "
              "with budgets of 10 to 800 units, and with none. The laws without a proxy have no force "
              "where the budget leaves contact unknown: the chart shows that share. A proxy stays where "
              "it was proven free and has always a force; what it costs is lag, shown in a chart of its "
              "own as the share of ticks that lag by more than 1 %. The ball is this library's proxy of "
              "one point at the tip.",
    .advice = "Give every real loop a budget. Measure the work of your scene with dpt_world_info or "
              "dynpoint replay --json, and choose some times its 99 %. Below that the proxy gets "
              "sluggish but stays safe; the bed and the point lose their force for some ticks, which is "
              "felt as a buzz.",
    .run = run_budget
};
