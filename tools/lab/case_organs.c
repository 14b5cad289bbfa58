/* SPDX-License-Identifier: BSD-3-Clause */
/* Laws on an organ, up to the limit of the law linearised at the pose. */
#include <math.h>

#include "dynpoint/coupling.h"
#include "lab/hand_sway.h"
#include "lab/lab_cases.h"

enum { PLACES = 3, TOOLS = 2, DEVICES = 4, LOOPS = PLACES * TOOLS * DEVICES };

#define PERIOD    1e-3
#define SECONDS   1.5
#define REFERENCE 200.0 /* N/m: at which the tool is lowered, 1 mm deep */

static const struct hand_tool tools[TOOLS] = { { 0.06, 0.002, 0.0 }, { 0.06, 0.002, 0.5 } };

static const struct device {
    double mass, damping, delay;
} devices[DEVICES] = { { 0.1, 0.5, 0 }, { 0.2, 2, 1 }, { 0.1, 0.5, 1 }, { 0.2, 2, 0 } };

struct tally {
    uint64_t loops, growing, growing_beyond, uneven;
};

/* At 0.97 of its limit along each direction, and beyond it along the stiffest. */
static void try_loop(struct hand_loop *loop, double limit, struct tally *tally)
{
    struct hand_law law;
    hand_law_find(loop, &law);
    const double felt = law.stiffness[0] / loop->stiffness;
    tally->loops++;
    tally->uneven += law.asymmetry > 1e-3 * law.stiffness[0];
    hand_hold(loop, &law, 1.1 * limit);
    hand_loop_stiffen(loop, 0.97 * limit / felt, 0.0, 0.0);
    int grows = 0;
    for (int n = 0; n < law.axes && !grows; n++) {
        struct hand_search search = hand_search_for_law(loop, &law, limit, SECONDS);
        for (int k = 0; k < HAND_AXES; k++)
            search.tap.way[k] = law.way[n][k];
        search.tap.stiffness = law.stiffness[n] / law.stiffness[0] * 0.97 * limit;
        grows = !hand_sway(loop, &search.tap).is_stable;
    }
    tally->growing += (uint64_t)grows;
    struct hand_search search = hand_search_for_law(loop, &law, limit, SECONDS);
    search.tap.stiffness = 1.1 * limit;
    hand_loop_stiffen(loop, 1.1 * limit / felt, 0.0, 0.0);
    tally->growing_beyond += !hand_sway(loop, &search.tap).is_stable;
}

static void run_method(struct lab *lab, const struct hand_mesh *liver, int method)
{
    struct tally tally = { 0 };
    const uint64_t loops = lab_share(lab, LOOPS);
    uint64_t seed = 5;
    for (uint64_t i = 0; i < loops; i++) {
        const struct device *device = &devices[i / TOOLS % DEVICES];
        struct hand_place place;
        struct hand_loop loop = { .tool = tools[i % TOOLS], .method = method, .stiffness = REFERENCE, .place = &place };
        const double rho = hand_loop_rho(&loop);
        loop.device = hand_device_even(device->mass, device->damping, device->delay, rho);
        place.mesh = liver;
        if (hand_loop_open(&loop) && hand_loop_seek(&loop, liver, &seed, 1e-3 * REFERENCE, &place))
            try_loop(&loop, dpt_stable_stiffness(device->mass, device->damping, PERIOD, device->delay * PERIOD, 0.0),
                     &tally);
        hand_loop_close(&loop);
    }
    const char *word = lab_method_name(method);
    const double all = (double)tally.loops;
    lab_note(lab, word, "loops that were tried", all, "");
    lab_at_most(lab, word, "share of loops at 0.97 of the limit whose motion grows", (double)tally.growing / all, "",
                0.0);
    lab_at_least(lab, word, "share of loops at 1.1 limits whose motion grows", (double)tally.growing_beyond / all, "",
                 0.9);
    lab_note(lab, word, "share of loops whose force is no gradient at the pose", (double)tally.uneven / all, "");
}

static void run(struct lab *lab)
{
    struct hand_mesh liver = { .mesh = NULL };
    if (!hand_mesh_open(&liver, "liver", 10000, 1.0)) {
        lab->is_out_of_memory = 1;
        return;
    }
    for (int method = 0; method < LAB_METHODS; method++)
        run_method(lab, &liver, method);
    hand_mesh_close(&liver);
}

const struct lab_case organs_case = {
    "organs", "Tools that a hand holds on an organ",
    "A tool of 60 mm lies on a liver of 10,000 triangles, or stands on its tip. The hand holds it "
    "by a spring and presses it 1 mm deep. The law is linearised there by differences. The "
    "coupling is set to 0.97 of the stiffness at which the sampled loop is at its limit along the "
    "stiffest of six directions. The tool is tapped along each of them, and its motion has to die "
    "away. At 1.1 limits it has to grow.",
    "What limits a coupling is the stiffest direction that a contact makes, with turns counted. "
    "Leave the margin of 1.5 that dpt_coupling_for_device has for the directions that it cannot know.",
    run
};
