/* SPDX-License-Identifier: BSD-3-Clause */
/* Maps of the stiffest stable coupling against delay and virtual damping, of each law. */
#include <math.h>

#include "dynpoint/coupling.h"
#include "lab/hand_sway.h"
#include "lab/lab.h"

enum { DELAYS = 9, DAMPINGS = 8 };

/* Periods, and shares of the device's own damping; the first ones are due first. */
static const double delays[DELAYS] = { 1.0, 0.0, 2.0, 3.0, 4.0, 0.5, 1.5, 2.5, 3.5 };
static const double dampings[DAMPINGS] = { 1.0, 0.5, 2.0, 0.25, 4.0, 0.75, 1.5, 3.0 };

#define MASS      0.1
#define DAMPING   0.5
#define PERIOD    1e-3
#define SECONDS   1.0
#define REFERENCE 200.0

/* The figures of a law's map. */
struct map {
    const char *chart;
    double share; /* of the limit, that is stable: the least */
};

static void try_at(struct lab *lab, const struct hand_mesh *liver, int method, double delay, double damping, double x,
                   struct map *map)
{
    const double limit = dpt_stable_stiffness(MASS, DAMPING, PERIOD, delay * PERIOD, damping * DAMPING);
    struct hand_place place = { .mesh = liver };
    struct hand_loop loop = { .tool = { 0.06, 0.002, 0.0 }, .method = method, .stiffness = REFERENCE, .place = &place };
    struct hand_law law;
    uint64_t seed = 5;
    loop.device = hand_device_even(MASS, DAMPING, delay, hand_loop_rho(&loop));
    if (hand_loop_open(&loop) && hand_loop_seek(&loop, liver, &seed, 1e-3 * REFERENCE, &place)) {
        hand_law_find(&loop, &law);
        hand_hold(&loop, &law, 2.0 * limit);
        const struct hand_search search = hand_search_for_law(&loop, &law, limit, SECONDS);
        loop.damping = damping * DAMPING;
        const double found = hand_stiffest(&loop, &search);
        map->share = hand_min(map->share, found / limit);
        lab_point_at(lab, map->chart, lab_method_name(method), x, found);
        if (method == LAB_PROXY)
            lab_point_at(lab, map->chart, "limit", x, limit);
    } else {
        map->share = NAN;
    }
    hand_loop_close(&loop);
}

static void run_delay(struct lab *lab)
{
    struct hand_mesh liver = { .mesh = NULL };
    const uint64_t delay_count = lab_share(lab, DELAYS), damping_count = lab_share(lab, DAMPINGS);
    if (!hand_mesh_open(&liver, "liver", 10000, 1.0)) {
        lab->is_out_of_memory = 1;
        return;
    }
    for (int method = 0; method < LAB_METHODS; method++) {
        struct map by_delay = { "stability-delay", HUGE_VAL };
        struct map by_damping = { "stability-damping", HUGE_VAL };
        for (uint64_t i = 0; i < delay_count; i++)
            try_at(lab, &liver, method, delays[i], 0.0, delays[i], &by_delay);
        lab_at_least(lab, lab_method_name(method), "least share of the limit at delays that is stable", by_delay.share,
                     "", 0.97);
        if (method != LAB_PROXY && method != LAB_BALL)
            continue;
        for (uint64_t i = 0; i < damping_count; i++)
            try_at(lab, &liver, method, 1.0, dampings[i], dampings[i] * DAMPING, &by_damping);
        lab_at_least(lab, lab_method_name(method), "least share of the limit with virtual damping that is stable",
                     by_damping.share, "", 0.97);
    }
    hand_mesh_close(&liver);
}

const struct lab_case delay_case = {
    .name = "delay",
    .title = "Stiffness against delay and virtual damping",
    .method = "A tool of 60 mm lies on a liver, held by a hand, on a device of 0.1 kg and 0.5 Ns/m in all "
              "six directions, at 1 kHz. For each delay, and for each virtual damping at a delay of one "
              "period, bisection finds the stiffest coupling at which a tap dies away. It is compared with "
              "the limit of the sampled system for a spring of the coupling. Bed and point have no virtual damping.",
    .advice = "Shorten the way from sample to command first: one period of delay leaves a third of the "
              "stiffness, two leave a fifth. Then add virtual damping, within the limit that "
              "dpt_stable_stiffness tells. A law that pushes at one place of a tool, or at its tip, turns "
              "the device by a lever, and so holds less.",
    .run = run_delay
};

/* Walls that are too stiff, late and lost samples, and the controller of passivity. */

enum { STIFFNESSES = 4, HANDS = 5, LATE_DELAYS = 4, FAULTS = 5 };
enum { LOOPS = STIFFNESSES * HANDS * LATE_DELAYS * FAULTS };

/* Has no divisor in common with that: any part of the loops is a mixture of all. */
enum { STRIDE = 167 };

#define TICKS 2500
#define PRESS 1.0
#define LIFT  1e-3

/* N: of a weight, at most. */
#define WEIGHT_MAX 9.0

/* Shares of the stiffness at the limit. The first one has the margin of 1.5. */
static const double shares[STIFFNESSES] = { 1.0 / 1.5, 1.5, 3.0, 10.0 };

/* The hands, in N/m and Ns/m; the last entry stands for no hand. */
static const double hands[HANDS][2] = { { 2000.0, 2.0 }, { 200.0, 0.0 }, { 20.0, 0.0 }, { 2.0, 0.0 }, { 0.0, 0.0 } };

static const struct fault {
    double jitter, loss, doubled; /* share of a period; shares of samples */
} faults[FAULTS] = { { 0.0, 0.0, 0.0 }, { 0.2, 0.2, 0.2 }, { 0.2, 0.0, 0.0 }, { 0.0, 0.2, 0.0 }, { 0.0, 0.0, 0.2 } };

/* Figures over all loops. */
struct tally {
    double account;                               /* least, in eps */
    double without;                               /* the same without the controller, where the wall is too stiff */
    uint64_t acted;                               /* where the wall has its margin and the line is sound */
    double force[2];                              /* N, mean, over those loops: without and with the controller */
    double with[STIFFNESSES], alone[STIFFNESSES]; /* sums of what is felt, of the wall's stiffness */
    uint64_t count[STIFFNESSES];
};

/* What holds the device up in the second half, over how deep it is in the wall, of the wall's stiffness. */
static double felt_share(const struct hand_loop *loop, double surface, double *force)
{
    double sum = 0.0, depth = 0.0;
    const size_t from = loop->count / 2;
    for (size_t i = from; i < loop->count; i++) {
        sum += loop->track[i].sent[1];
        depth += fmax(0.0, surface - loop->track[i].at[1]);
    }
    *force = sum / (double)(loop->count - from);
    return depth > 0.0 ? sum / depth / loop->stiffness : 1.0;
}

/* The device falls 1 mm on to the wall, and presses it with 1 N, or what a firm hand leaves of the heaviest weight. */
static void try_loop(const struct hand_place *plane, uint64_t which, struct tally *tally)
{
    const int s = (int)(which % STIFFNESSES), h = (int)(which / STIFFNESSES % HANDS);
    const double delay = (double)(which / STIFFNESSES / HANDS % LATE_DELAYS);
    const struct fault *fault = &faults[which / STIFFNESSES / HANDS / LATE_DELAYS];
    const double limit = dpt_stable_stiffness(MASS, DAMPING, PERIOD, delay * PERIOD, 0.0);
    struct hand_loop loop = { .device = hand_device_even(MASS, DAMPING, delay, 0.0),
                              .place = plane,
                              .tool = { .radius = 0.005 },
                              .method = LAB_PROXY,
                              .stiffness = shares[s] * limit };
    dpt_passivity_def def;
    dpt_guard_def guard;
    dpt_guard_def_init(&guard);
    dpt_passivity_def_init(&def);
    guard.start = 0.0;
    guard.force_max = def.force_max = loop.device.force = 8.0;
    guard.force_slew = def.force_slew = which % 3 ? 2000.0 : 0.0;
    def.damping = DAMPING;
    def.delay = (delay + 0.5 * fault->jitter) * PERIOD;
    loop.guard = &guard;
    loop.passivity = &def;
    loop.device.jitter = fault->jitter * PERIOD;
    loop.device.loss = fault->loss;
    loop.device.doubled = fault->doubled;
    loop.device.seed = (double)which;
    loop.device.script = hands[h][0] > 0.0 ? "hold" : NULL;
    loop.device.grip = hands[h][0];
    loop.device.hand_damping = hands[h][1];
    loop.device.weight = fmin(WEIGHT_MAX, PRESS + loop.device.grip * (LIFT + PRESS / loop.stiffness));
    if (hand_loop_open(&loop) && hand_loop_lower(&loop, 1e-6)) {
        const int is_sound = fault->jitter + fault->loss + fault->doubled == 0.0;
        hand_loop_lift(&loop, LIFT);
        for (int is_on = 0; is_on < 2; is_on++) {
            double force;
            def.observe_only = !is_on;
            if (!hand_loop_run(&loop, TICKS)) {
                tally->account = NAN;
                break;
            }
            const dpt_passivity_info info = hand_loop_account(&loop);
            const double share = felt_share(&loop, -LIFT, &force);
            double *min = is_on ? &tally->account : &tally->without;
            *min = hand_min(*min, info.account_min / info.eps);
            if (s == 0 && is_sound) {
                tally->force[is_on] += force;
                tally->acted += info.acted;
            }
            (is_on ? tally->with : tally->alone)[s] += share;
        }
        tally->count[s]++;
    } else {
        tally->account = NAN;
    }
    hand_loop_close(&loop);
}

static void run_late(struct lab *lab)
{
    static const char *const costs[STIFFNESSES] = {
        "mean force over mean depth, of the stiffness, at 1/1.5 of the limit",
        "mean force over mean depth, of the stiffness, at 1.5 limits",
        "mean force over mean depth, of the stiffness, at 3 limits",
        "mean force over mean depth, of the stiffness, at 10 limits"
    };
    struct hand_mesh box = { .mesh = NULL };
    struct hand_place plane;
    struct tally tally = { .account = 0.0 };
    const uint64_t loops = lab_share(lab, LOOPS);
    if (!hand_mesh_open(&box, "box", 12, 3.0)) {
        lab->is_out_of_memory = 1;
        return;
    }
    hand_place_middle(&box, &plane);
    for (uint64_t i = 0; i < loops; i++)
        try_loop(&plane, i * STRIDE % LOOPS, &tally);
    lab_at_least(lab, "controller", "least account", tally.account, "eps", -2.0);
    lab_note(lab, "observer", "least account without the controller", tally.without, "eps");
    lab_at_most(lab, "controller", "steps in which it acts where the wall has a margin of 1.5", (double)tally.acted, "",
                0.0);
    lab_at_least(lab, "controller", "force there, of that without it", tally.force[1] / tally.force[0], "", 0.99);
    for (int s = 0; s < STIFFNESSES; s++) {
        lab_note(lab, "controller", costs[s], tally.with[s] / (double)tally.count[s], "");
        lab_note(lab, "observer", costs[s], tally.alone[s] / (double)tally.count[s], "");
    }
    hand_mesh_close(&box);
}

const struct lab_case late_case = {
    .name = "late",
    .title = "Too stiff, late and lost",
    .method = "A device of 0.1 kg and 0.5 Ns/m at 1 kHz falls on to a plane and is held there, by hands of "
              "2000 N/m down to none. The wall has 1/1.5 to 10 times the stiffness at the limit, delays are "
              "0 to 3 periods, and jitter of 0.2 periods, 20 per cent of lost and of doubled samples come "
              "one by one and together, with and without the guard's slew. The controller of passivity is "
              "on, or only observes. What it costs is told by the mean force over the mean depth in the "
              "wall, which is the stiffness that is felt.",
    .advice = "Leave the controller on, and tell it the device's damping and delay. It costs nothing where "
              "the coupling has its margin, and makes a wall that is too stiff rough instead of dangerous. "
              "It is no substitute for a coupling that fits.",
    .run = run_late
};

/* A device that is served some time after its samples. */

enum { PHASES = 6 };

/* Shares of a period; the first ones are due first. */
static const double phases[PHASES] = { 0.1, 0.5, 0.0, 0.2, 0.3, 0.4 };

#define PHASE_SECONDS 1.2

static double stiffest_at(const struct hand_place *plane, double phase, double limit)
{
    struct hand_loop loop = { .device = hand_device_even(MASS, DAMPING, phase, 0.0),
                              .place = plane,
                              .tool = { .radius = 0.005 },
                              .method = LAB_PROXY,
                              .stiffness = 0.3 * limit };
    const struct hand_search search = hand_search_about(limit, PHASE_SECONDS);
    double found = NAN;
    if (hand_loop_open(&loop) && hand_loop_lower(&loop, 0.3))
        found = hand_stiffest(&loop, &search);
    hand_loop_close(&loop);
    return found;
}

static void run_phase(struct lab *lab)
{
    struct hand_mesh box = { .mesh = NULL };
    struct hand_place plane;
    uint64_t count = lab_share(lab, PHASES);
    double off = 0.0, found[PHASES];
    if (!hand_mesh_open(&box, "box", 12, 3.0)) {
        lab->is_out_of_memory = 1;
        return;
    }
    hand_place_middle(&box, &plane);
    if (count < 2)
        count = 2;
    for (uint64_t i = 0; i < count; i++) {
        const double limit = dpt_stable_stiffness(MASS, DAMPING, PERIOD, phases[i] * PERIOD, 0.0);
        found[i] = stiffest_at(&plane, phases[i], limit);
        off = hand_max(off, fabs(found[i] / limit - 1.0));
        lab_point_at(lab, "stability-phase", "proxy", phases[i], found[i]);
        lab_point_at(lab, "stability-phase", "limit", phases[i], limit);
    }
    lab_at_most(lab, "proxy", "largest share that the stiffest wall is off the limit", off, "", 0.01);
    lab_note(lab, "proxy", "stiffest wall, served 0.1 periods after a sample", found[0], "N/m");
    lab_note(lab, "proxy", "stiffest wall, served 0.5 periods after a sample", found[1], "N/m");
    hand_mesh_close(&box);
}

const struct lab_case phase_case = {
    .name = "phase",
    .title = "Serving a device after its sample",
    .method = "A device of 0.1 kg and 0.5 Ns/m at 1 kHz gets the force for a sample 0 to 0.5 periods after "
              "it took that sample, as it does if the host runs on a clock of its own. The stiffest stable "
              "wall is found by bisection, and compared with the limit of the sampled system.",
    .advice = "Serve a device right after its sample arrives: leave the rate of dpt_loop_def at 0. A host "
              "that comes half a period late has half the stiffness.",
    .run = run_phase
};
