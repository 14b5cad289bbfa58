/* SPDX-License-Identifier: BSD-3-Clause */
/* A budget of work that ends the searches of a tick. */
#include <math.h>

#include "dynpoint/coupling.h"
#include "lab/hand_sway.h"
#include "lab/lab.h"
#include "lab/lab_lead.h"

/* Units: below these the proxy is known to crawl, so its force may turn while it is small. */
#define BUDGET_ENOUGH 200

/* In the open until the first answer is known, which takes a small budget many ticks. 0 if it is not free there. */
static int begin_free(struct lab_lead *lead)
{
    lab_lead_start(lead);
    for (int i = 0; i < 3000 && lead->lead.force.reason != DPT_FORCE_FREE; i++)
        lab_lead_step(lead);
    lead->tally = (struct lab_tally){ .gap_min = HUGE_VAL };
    return lead->lead.force.reason == DPT_FORCE_FREE;
}

/* Push the device 5 mm in and lead it along the surface, as force_trial_push does. */
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
    lab_at_most(lab, name, "below 200 units: largest |dW|, of K (3 |motion| + 1 mm)", small.share, "", LEAD_SHARE_MAX);
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
    .method =
        "A needle of 100 mm is pushed 5 mm into a liver of 50,332 triangles and led along it, "
        "with budgets of 10 to 800 units, and with none. The laws without a proxy have no force "
        "where the budget leaves contact unknown: the chart shows that share. A proxy stays where "
        "it was proven free and has always a force; what it costs is lag, shown in a chart of its "
        "own as the share of ticks that lag by more than 1 %. Where it crawls it moves by its cap, 1 mm a tick, so that it uses "
        "all that |dW| may be: that limit of 1 is met within rounding, 1e-9 of it. The ball is this library's proxy of "
        "one point at the tip.",
    .advice = "Give every real loop a budget. Measure the work of your scene with dpt_world_info or "
              "dynpoint replay --json, and choose some times its 99 %. Below that the proxy gets "
              "sluggish but stays safe; the bed and the point lose their force for some ticks, which is "
              "felt as a buzz.",
    .run = run_budget
};

/* The stiffest stable coupling against the rate of the loop. */

enum { RATES = 7, TICKS_MIN = 400 };

/* Hz; the first two are always tried. */
static const double rates[RATES] = { 1000, 10000, 250, 5000, 2000, 500, 20000 };

#define MASS      0.1
#define DAMPING   0.5
#define SECONDS   0.4
#define REFERENCE 200.0

static double stiffest_at(const struct hand_mesh *liver, int method, double rate, double limit)
{
    struct hand_place place = { .mesh = liver };
    struct hand_loop loop = { .tool = { 0.06, 0.002, 0.0 }, .method = method, .stiffness = REFERENCE, .place = &place };
    struct hand_law law;
    uint64_t seed = 5;
    double found = NAN;
    loop.device = hand_device_even(MASS, DAMPING, 0.0, hand_loop_rho(&loop));
    loop.device.rate = rate;
    if (hand_loop_open(&loop) && hand_loop_seek(&loop, liver, &seed, 1e-3 * REFERENCE, &place)) {
        hand_law_find(&loop, &law);
        hand_hold(&loop, &law, 2.0 * limit);
        const struct hand_search search = hand_search_for_law(&loop, &law, limit, fmax(SECONDS, TICKS_MIN / rate));
        found = hand_stiffest(&loop, &search);
    }
    hand_loop_close(&loop);
    return found;
}

static void run_rate(struct lab *lab)
{
    struct hand_mesh liver = { .mesh = NULL };
    const uint64_t count = lab_share(lab, RATES);
    if (!hand_mesh_open(&liver, "liver", 10000, 1.0)) {
        lab->is_out_of_memory = 1;
        return;
    }
    for (int method = 0; method < LAB_METHODS; method++) {
        const char *word = lab_method_name(method);
        double found[RATES];
        for (uint64_t i = 0; i < (count > 2 ? count : 2); i++) {
            const double limit = dpt_stable_stiffness(MASS, DAMPING, 1.0 / rates[i], 0.0, 0.0);
            found[i] = stiffest_at(&liver, method, rates[i], limit);
            lab_point_at(lab, "stability-rate", word, rates[i], found[i]);
            if (method == LAB_PROXY)
                lab_point_at(lab, "stability-rate", "limit", rates[i], limit);
        }
        lab_note(lab, word, "stiffest coupling at 1 kHz", found[0], "N/m");
        lab_at_least(lab, word, "stiffest coupling at 10 kHz, of that at 1 kHz", found[1] / found[0], "", 9.0);
    }
    hand_mesh_close(&liver);
}

const struct lab_case rate_case = {
    .name = "rate",
    .title = "Stiffness against the rate of the loop",
    .method = "A tool of 60 mm lies on a liver, held by a hand, on a device of 0.1 kg and 0.5 Ns/m in all "
              "six directions. Loops run at 250 Hz to 20 kHz without delay. Bisection finds the stiffest "
              "coupling at which a tap dies away. The encoders have no steps and there is no friction, so "
              "friction is at least the stiffness times half a step. With the point law, motion stays at "
              "some stiffnesses and dies away at higher ones, so bisection finds one of several borders.",
    .advice = "A device that can be served at 10 kHz is worth it: it holds ten times the stiffness of one "
              "at 1 kHz, as long as its delay is short in seconds, too. The steps of the encoders must get "
              "finer in proportion, or friction larger.",
    .run = run_rate
};

/* With a zoom the hand feels another stiffness than the scene has. */

enum { ZOOMS = 4, MESHES = 2 };

static const double zooms[ZOOMS] = { 4.0, 0.5, 2.0, 1.0 };

#define DELAY        1.0
#define ZOOM_SECONDS 2.5

struct worst {
    double felt;     /* share that the hand's stiffness is off zoom and force scale times the scene's */
    double growth;   /* of b / 2m, with the coupling that was chosen */
    double unscaled; /* with that of zoom 1, where the zoom is above the margin of 1.5; the least */
};

/* The tool is a tip, on a device without torque. */
static void try_zoom(const struct hand_mesh *mesh, int is_plane, double zoom, struct worst *worst)
{
    struct hand_place place;
    struct hand_loop loop = { .device = hand_device_even(MASS, DAMPING, DELAY, 0.0),
                              .place = &place,
                              .tool = { 0.06, 0.002, 0.5 },
                              .method = LAB_PROXY,
                              .zoom = zoom };
    struct hand_loop plain = loop;
    struct hand_law law;
    uint64_t seed = 3;
    plain.zoom = 1.0;
    const double chosen = hand_loop_choose(&loop, 1.5).stiffness;
    const double unscaled = hand_loop_choose(&plain, 1.5).stiffness;
    loop.stiffness = chosen;
    hand_place_middle(mesh, &place);
    if (!hand_loop_open(&loop) ||
        !(is_plane ? hand_loop_lower(&loop, 0.2) : hand_loop_seek(&loop, mesh, &seed, 0.2, &place))) {
        worst->growth = NAN;
        hand_loop_close(&loop);
        return;
    }
    hand_law_find(&loop, &law);
    hand_hold(&loop, &law, zoom * fmax(chosen, unscaled));
    struct hand_search search = hand_search_for_law(&loop, &law, zoom * chosen, ZOOM_SECONDS);
    search.tap.stiffness = law.stiffness[0];
    worst->felt = hand_max(worst->felt, fabs(law.stiffness[0] / (zoom * chosen) - 1.0));
    const double unit = DAMPING / (2.0 * MASS);
    worst->growth = hand_max(worst->growth, hand_sway(&loop, &search.tap).growth / unit);
    if (zoom > 1.5) {
        hand_loop_stiffen(&loop, unscaled, 0.0, 0.0);
        search.tap.stiffness = zoom * unscaled;
        worst->unscaled = hand_min(worst->unscaled, hand_sway(&loop, &search.tap).growth / unit);
    }
    loop.force_scale = 1.0 / zoom;
    hand_loop_return(&loop);
    hand_law_find(&loop, &law);
    worst->felt = hand_max(worst->felt, fabs(law.stiffness[0] / loop.stiffness - 1.0));
    hand_loop_close(&loop);
}

static void run_zoom(struct lab *lab)
{
    static const char *const names[MESHES] = { "box", "liver" };
    struct worst worst = { 0.0, -HUGE_VAL, HUGE_VAL };
    const uint64_t count = lab_share(lab, ZOOMS * MESHES);
    for (int m = 0; m < MESHES; m++) {
        struct hand_mesh mesh;
        if (!hand_mesh_open(&mesh, names[m], m ? 10000 : 12, m ? 1.0 : 3.0)) {
            lab->is_out_of_memory = 1;
            return;
        }
        for (uint64_t i = (uint64_t)m; i < (count > 2 ? count : 2); i += MESHES)
            try_zoom(&mesh, m == 0, zooms[i / MESHES], &worst);
        hand_mesh_close(&mesh);
    }
    lab_at_most(lab, "proxy", "largest share that the hand feels beside zoom times scale times stiffness", worst.felt,
                "", 0.01);
    lab_at_most(lab, "proxy", "fastest growth with the coupling that was chosen for the zoom", worst.growth, "b/2m",
                0.0);
    lab_at_least(lab, "proxy", "least growth at zooms of 2 and 4 with that of zoom 1", worst.unscaled, "b/2m", 0.0);
}

const struct lab_case zoom_case = {
    .name = "zoom",
    .title = "Zoom",
    .method = "One metre of the hand is 0.5 to 4 m of the scene, and forces are not scaled, or by 1 / zoom. "
              "The hand feels the stiffness times zoom and scale. The stiffness at the hand is measured by "
              "differences, on a plane and on a liver. A tap has to die away at the coupling that "
              "dpt_coupling_for_device chooses for the zoom, and grows at zooms of 2 and 4 if the coupling "
              "is the one for a zoom of 1.",
    .advice = "Choose the coupling again whenever zoom or force scale change, and tell both to "
              "dpt_coupling_for_device. A scale of forces of 1 / zoom keeps the stiffness at the hand.",
    .run = run_zoom
};
