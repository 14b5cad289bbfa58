/* SPDX-License-Identifier: BSD-3-Clause */
/* A device that is served some time after its samples. */
#include <math.h>

#include "dynpoint/coupling.h"
#include "lab/hand_sway.h"
#include "lab/lab_cases.h"

enum { PHASES = 6 };

/* Of a period; the first ones are due first. */
static const double phases[PHASES] = { 0.1, 0.5, 0.0, 0.2, 0.3, 0.4 };

#define MASS    0.1
#define DAMPING 0.5
#define PERIOD  1e-3
#define SECONDS 1.2

static double stiffest_at(const struct hand_place *plane, double phase, double limit)
{
    struct hand_loop loop = { .device = hand_device_even(MASS, DAMPING, phase, 0.0),
                              .place = plane,
                              .tool = { .radius = 0.005 },
                              .method = LAB_PROXY,
                              .stiffness = 0.3 * limit };
    const struct hand_search search = hand_search_about(limit, SECONDS);
    double found = NAN;
    if (hand_loop_open(&loop) && hand_loop_lower(&loop, 0.3))
        found = hand_stiffest(&loop, &search);
    hand_loop_close(&loop);
    return found;
}

static void run(struct lab *lab)
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
        off = hand_greater(off, fabs(found[i] / limit - 1.0));
        lab_point_at(lab, "stability-phase", "proxy", phases[i], found[i]);
        lab_point_at(lab, "stability-phase", "limit", phases[i], limit);
    }
    lab_at_most(lab, "proxy", "largest share that the stiffest wall is off the limit", off, "", 0.01);
    lab_note(lab, "proxy", "stiffest wall, served 0.1 periods after a sample", found[0], "N/m");
    lab_note(lab, "proxy", "stiffest wall, served 0.5 periods after a sample", found[1], "N/m");
    hand_mesh_close(&box);
}

const struct lab_case phase_case = {
    "phase", "Serving a device after its sample",
    "A device of 0.1 kg and 0.5 Ns/m at 1 kHz gets the force for a sample 0 to 0.5 periods after "
    "it took that sample, as it does if the host runs on a clock of its own. The stiffest stable "
    "wall is found by bisection, and compared with the limit of the sampled system.",
    "Serve a device right after its sample arrives: leave the rate of dpt_loop_def at 0. A host "
    "that comes half a period late has half the stiffness.",
    run
};
