/* SPDX-License-Identifier: BSD-3-Clause */
/* The stiffest stable wall, against the spectral radius of the exact sampled system. */
#include <math.h>

#include "dynpoint/coupling.h"
#include "lab/hand_sway.h"
#include "lab/lab_cases.h"

enum { DELAYS = 5, DAMPINGS = 3, LOOPS = DELAYS * DAMPINGS, WALLS = 4 };

static const double delays[DELAYS] = { 0.0, 1.0, 0.5, 2.0, 3.0 };
static const double dampings[DAMPINGS] = { 0.0, 0.5, 2.0 };

#define MASS    0.1
#define DAMPING 0.5
#define PERIOD  1e-3
#define SECONDS 2.5
#define LENGTH  0.06

/* A law, and whether its stiffness against turns is searched for. */
static const struct wall {
    const char *word, *off, *growth;
    int has_place, is_turn;
} walls[WALLS] = {
    { "spring", "limit of a spring: largest share that it is off", "spring: growth at 1.5 limits", 0, 0 },
    { "spring", "limit of a spring against turns: share that it is off", "spring against turns: growth at 1.5 limits",
      0, 1 },
    { "proxy", "limit of a wall: largest share that it is off", "wall: growth at 1.5 limits", 1, 0 },
    { "proxy", "limit of a wall against turns: share that it is off", "wall against turns: growth at 1.5 limits", 1,
      1 },
};

/* Over the loops of a wall. */
struct worst {
    double off;    /* share of the limit */
    double growth; /* at 1.5 limits, as a share of b / 2m: the least */
};

/*
 * A ball, or a tool that lies. Mass and damping of turns are those of translation, so turns have the same limit, times
 * rho^2. While that is searched for, translation is well within its own.
 */
static void make_loop(struct hand_loop *loop, const struct wall *wall, const struct hand_place *place, double delay,
                      double limit)
{
    const double length = wall->is_turn ? LENGTH : 0.0;
    *loop = (struct hand_loop){ .device = hand_device_even(MASS, DAMPING, delay, length / sqrt(12.0)),
                                .place = wall->has_place ? place : NULL,
                                .tool = { .length = length, .radius = 0.005 },
                                .method = LAB_PROXY,
                                .stiffness = 0.3 * limit };
}

static double try_wall(struct hand_loop *loop, const struct wall *wall, double damping, double limit,
                       struct worst *worst)
{
    struct hand_search search = hand_search_about(limit, SECONDS);
    double share = 1.0;
    if (wall->is_turn) {
        share = hand_loop_rho(loop) * hand_loop_rho(loop);
        search = hand_search_about(limit * share, SECONDS);
        search.felt = 1.0 / share;
        search.is_turn = 1;
        search.turn_damping = damping * share;
        search.tap.way[1] = 0.0;
        search.tap.way[5] = 1.0;
        search.tap.reach = 1e-5;
    } else {
        loop->damping = damping;
    }
    const double found = hand_stiffest(loop, &search) / share;
    worst->off = hand_greater(worst->off, fabs(found / limit - 1.0));
    search.tap.stiffness = 1.5 * limit;
    if (wall->is_turn)
        hand_loop_stiffen(loop, loop->stiffness, 1.5 * limit * share, damping * loop->stiffness / (1.5 * limit));
    else
        hand_loop_stiffen(loop, 1.5 * limit, 0.0, damping);
    const double growth = hand_sway(loop, &search.tap).growth * 2.0 * MASS / DAMPING;
    worst->growth = hand_smaller(worst->growth, growth);
    return found;
}

static void run(struct lab *lab)
{
    struct hand_mesh box = { .mesh = NULL };
    struct hand_place plane;
    const uint64_t loops = lab_share(lab, LOOPS);
    if (!hand_mesh_open(&box, "box", 12, 3.0)) {
        lab->is_out_of_memory = 1;
        return;
    }
    hand_place_middle(&box, &plane);
    for (int w = 0; w < WALLS; w++) {
        struct worst worst = { 0.0, HUGE_VAL };
        for (uint64_t i = 0; i < loops; i++) {
            const double delay = delays[i % DELAYS], damping = DAMPING * dampings[i / DELAYS];
            const double limit = dpt_stable_stiffness(MASS, DAMPING, PERIOD, delay * PERIOD, damping);
            struct hand_loop loop;
            make_loop(&loop, &walls[w], &plane, delay, limit);
            if (hand_loop_open(&loop) && (!loop.place || hand_loop_lower(&loop, 0.3))) {
                const double found = try_wall(&loop, &walls[w], damping, limit, &worst);
                if (damping == 0.0 && walls[w].has_place && !walls[w].is_turn) {
                    lab_point_at(lab, "stability-wall", "proxy", delay, found);
                    lab_point_at(lab, "stability-wall", "limit", delay, limit);
                }
            } else {
                worst.off = NAN;
            }
            hand_loop_close(&loop);
        }
        lab_at_most(lab, walls[w].word, walls[w].off, worst.off, "", 0.01);
        lab_at_least(lab, walls[w].word, walls[w].growth, worst.growth, "b/2m", 0.1);
    }
    hand_mesh_close(&box);
}

const struct lab_case wall_case = {
    "wall", "The stiffest stable wall",
    "A device of 0.1 kg and 0.5 Ns/m at 1 kHz is pushed against a wall and tapped, and the rate "
    "is fitted at which its motion grows. Bisection finds the stiffest wall at which the motion "
    "dies away: of a bare spring and of the proxy on a plane, in translation and in rotation, "
    "with delays of 0 to 3 periods and virtual damping of 0 to 2 times the device's own. It is "
    "compared with dpt_stable_stiffness, the limit of the exact sampled system. There are no "
    "limits of force, no controller and no steps of encoders.",
    "Trust dpt_stable_stiffness, and so the coupling that dpt_coupling_for_device chooses: the "
    "limit is that of the sampled loop, and the proxy adds nothing to it and takes nothing from "
    "it. Virtual damping raises the limit about as much as damping of the device does, until it "
    "is itself too large for the loop.",
    run
};
