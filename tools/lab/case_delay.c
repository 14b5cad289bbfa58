/* SPDX-License-Identifier: BSD-3-Clause */
/* Maps of the stiffest stable coupling against delay and virtual damping, of each law. */
#include <math.h>

#include "dynpoint/coupling.h"
#include "lab/hand_sway.h"
#include "lab/lab_cases.h"

enum { DELAYS = 9, DAMPINGS = 8 };

/* Periods, and shares of the device's own damping; the first ones are due first. */
static const double delays[DELAYS] = { 1.0, 0.0, 2.0, 3.0, 4.0, 0.5, 1.5, 2.5, 3.5 };
static const double dampings[DAMPINGS] = { 1.0, 0.5, 2.0, 0.25, 4.0, 0.75, 1.5, 3.0 };

#define MASS      0.1
#define DAMPING   0.5
#define PERIOD    1e-3
#define SECONDS   1.0
#define REFERENCE 200.0

/* What a map tells of a law. */
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
        map->share = hand_smaller(map->share, found / limit);
        lab_point_at(lab, map->chart, lab_method_name(method), x, found);
        if (method == LAB_PROXY)
            lab_point_at(lab, map->chart, "limit", x, limit);
    } else {
        map->share = NAN;
    }
    hand_loop_close(&loop);
}

static void run(struct lab *lab)
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
    "delay", "Stiffness against delay and virtual damping",
    "A tool of 60 mm lies on a liver, held by a hand, on a device of 0.1 kg and 0.5 Ns/m in all "
    "six directions, at 1 kHz. For each delay, and for each virtual damping at a delay of one "
    "period, bisection finds the stiffest coupling at which a tap dies away. It is compared with "
    "the limit of the sampled system for a spring of the coupling. Bed and point have no virtual damping.",
    "Shorten the way from sample to command first: one period of delay leaves a third of the "
    "stiffness, two leave a fifth. Then add virtual damping, within the limit that "
    "dpt_stable_stiffness tells. A law that pushes at one place of a tool, or at its tip, turns "
    "the device by a lever, and so holds less.",
    run
};
