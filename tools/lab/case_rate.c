/* SPDX-License-Identifier: BSD-3-Clause */
/* The stiffest stable coupling against the rate of the loop. */
#include <math.h>

#include "dynpoint/coupling.h"
#include "lab/hand_sway.h"
#include "lab/lab_cases.h"

enum { RATES = 7, LEAST_TICKS = 400 };

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
        const struct hand_search search = hand_search_for_law(&loop, &law, limit, fmax(SECONDS, LEAST_TICKS / rate));
        found = hand_stiffest(&loop, &search);
    }
    hand_loop_close(&loop);
    return found;
}

static void run(struct lab *lab)
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
    "rate", "Stiffness against the rate of the loop",
    "A tool of 60 mm lies on a liver, held by a hand, on a device of 0.1 kg and 0.5 Ns/m in all "
    "six directions. Loops run at 250 Hz to 20 kHz without delay. Bisection finds the stiffest "
    "coupling at which a tap dies away. The encoders have no steps and there is no friction, so "
    "friction is at least the stiffness times half a step. With the point law, motion stays at "
    "some stiffnesses and dies away at higher ones, so bisection finds one of several borders.",
    "A device that can be served at 10 kHz is worth it: it holds ten times the stiffness of one "
    "at 1 kHz, as long as its delay is short in seconds, too. The steps of the encoders must get "
    "finer in proportion, or friction larger.",
    run
};
