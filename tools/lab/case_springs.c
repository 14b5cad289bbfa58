/* SPDX-License-Identifier: BSD-3-Clause */
/* A needle that is held in a liver of masses and springs, and a tool that presses it, for a minute. */
#include <math.h>

#include "lab/hand_loop.h"
#include "lab/lab_cases.h"

enum { TOOLS = 2, INTEGRATORS = 2, TRIANGLES = 50332, FEWER = 10000, TICKS = 60000, TICKS_MIN = 3000 };

#define PRESS 1.0   /* N */
#define GRIP  200.0 /* N/m */
#define DRIFT 0.1   /* mm */
#define SPEED 1.0   /* mm/s */
#define SHAKE 0.05  /* N */

static const dpt_spring_region bed = { .kind = DPT_REGION_BOX,
                                       .fixed = 1,
                                       .box = { -0.2, -0.2, -0.1, 0.2, 0.2, -0.035 } };

static const dpt_spring_net_def liver = { .size = sizeof(dpt_spring_net_def),
                                          .kind = DPT_NET_VOLUME,
                                          .young = 5000.0,
                                          .density = 1000.0,
                                          .drag = 5.0,
                                          .viscosity = 1e-3,
                                          .regions = &bed,
                                          .region_count = 1 };

/* A needle on a device that turns, and a lying tool on one of light friction and fine steps. */
static const struct trial {
    const char *speed, *jump, *shake, *drift, *account, *awake, *depth;
    struct hand_tool tool;
    struct hand_device device;
} trials[TOOLS][INTEGRATORS] = {
#define NEEDLE                                                                                                         \
    { 0.12, 0.001, 1.2 },                                                                                              \
    {                                                                                                                  \
        .dofs = 6, .mass = 0.2, .damping = 2.0, .friction = 0.1, .step = 2e-5, .inertia = 2e-4, .turn_damping = 2e-3,  \
        .turn_friction = 1e-3, .turn_step = 1e-4, .force = 8.0, .torque = 0.4                                          \
    }
#define LYING                                                                                                          \
    { 0.06, 0.003, 0.0 },                                                                                              \
    {                                                                                                                  \
        .dofs = 3, .mass = 0.1, .damping = 0.5, .friction = 0.05, .step = 1e-5, .force = 8.0                           \
    }
#define FIGURES(what)                                                                                                  \
    what ": fastest in the last quarter", what ": largest change of force in a tick there",                            \
        what ": rms of the force about its mean there", what ": drift from the second quarter to the last",            \
        what ": least account", what ": nodes that were awake", what ": how deep the liver was pressed"
    { { FIGURES("needle, SYMPLECTIC"), NEEDLE }, { FIGURES("needle, IMPLICIT"), NEEDLE } },
    { { FIGURES("lying tool, SYMPLECTIC"), LYING }, { FIGURES("lying tool, IMPLICIT"), LYING } }
};
static const uint32_t integrators[INTEGRATORS] = { DPT_INTEGRATOR_SYMPLECTIC, DPT_INTEGRATOR_IMPLICIT };

/* The mean place in a quarter of the track. */
static void mean_of(const struct hand_loop *loop, size_t quarter, double mean[3])
{
    const size_t part = loop->count / 4;
    for (int k = 0; k < 3; k++)
        mean[k] = 0.0;
    for (size_t i = quarter * part; i < (quarter + 1) * part; i++)
        for (int k = 0; k < 3; k++)
            mean[k] += loop->track[i].at[k] / (double)part;
}

/* N: how far the force is from its mean, in the last quarter. */
static double shake_of(const struct hand_loop *loop)
{
    const size_t part = loop->count / 4;
    const struct hand_moment *last = loop->track + 3 * part;
    double mean[3] = { 0.0 }, sum = 0.0;
    for (size_t i = 0; i < 3 * part; i++)
        mean[i % 3] += last[i / 3].sent[i % 3] / (double)part;
    for (size_t i = 0; i < 3 * part; i++)
        sum += pow(last[i / 3].sent[i % 3] - mean[i % 3], 2.0);
    return sqrt(sum / (double)part);
}

static void look(struct lab *lab, const struct hand_loop *loop, const struct trial *trial)
{
    const dpt_passivity_info info = hand_loop_account(loop);
    double speed = 0.0, jump = 0.0, drift = 0.0, early[3], late[3];
    for (size_t i = 3 * (loop->count / 4); i < loop->count; i++) {
        const struct hand_moment *moment = &loop->track[i];
        double fast = 0.0, change = 0.0;
        for (int k = 0; k < 3; k++) {
            fast += moment->speed[k] * moment->speed[k];
            change += pow(moment->sent[k] - moment[-1].sent[k], 2.0);
        }
        speed = fmax(speed, sqrt(fast));
        jump = fmax(jump, sqrt(change));
    }
    mean_of(loop, 1, early);
    mean_of(loop, 3, late);
    for (int k = 0; k < 3; k++)
        drift += (late[k] - early[k]) * (late[k] - early[k]);
    lab_at_most(lab, "proxy", trial->speed, 1e3 * speed, "mm/s", SPEED);
    lab_note(lab, "proxy", trial->jump, jump, "N");
    lab_at_most(lab, "proxy", trial->shake, shake_of(loop), "N", SHAKE);
    lab_at_most(lab, "proxy", trial->drift, 1e3 * sqrt(drift), "mm", DRIFT);
    lab_at_least(lab, "observer", trial->account, info.account_min / info.eps, "eps", -1.0);
    lab_note(lab, "proxy", trial->awake, 100.0 * (double)loop->springs->active / (double)loop->springs->nodes, "%");
    lab_note(lab, "proxy", trial->depth, -1e3 * late[1], "mm");
}

/* Its weight presses, a hand holds it sideways, and it is tapped aslant. */
static void hold(struct lab *lab, const struct hand_mesh *mesh, const struct trial *trial, uint32_t integrator)
{
    struct hand_place place = { .mesh = mesh };
    struct spring_body springs = { .mesh = mesh->mesh, .integrator = integrator, .load_radius = 0.02 };
    dpt_passivity_def observer;
    struct hand_loop loop = { .device = trial->device,
                              .place = &place,
                              .springs = &springs,
                              .tool = trial->tool,
                              .method = LAB_PROXY,
                              .passivity = &observer,
                              .tap = { 1e-3, -2e-3, 5e-4 } };
    const uint64_t due = lab_share(lab, TICKS), ticks = due > TICKS_MIN ? due : TICKS_MIN;
    dpt_passivity_def_init(&observer);
    observer.observe_only = 1;
    observer.damping = trial->device.damping;
    observer.spin_damping = trial->device.turn_damping;
    observer.force_max = trial->device.force;
    observer.torque_max = trial->device.torque > 0.0 ? trial->device.torque : 0.2;
    observer.delay = 1e-3;
    loop.device.rate = 1000.0;
    loop.device.delay = 1.0;
    loop.device.script = "hold";
    loop.device.grip = GRIP;
    loop.device.turn_grip = 0.2;
    loop.device.weight = PRESS;
    const dpt_coupling coupling = hand_loop_choose(&loop, 1.5);
    loop.stiffness = coupling.stiffness;
    loop.rotational_stiffness = coupling.rotational_stiffness;
    hand_place_top(mesh, &place);
    if (hand_loop_open(&loop) && hand_loop_lower(&loop, PRESS) && hand_loop_run(&loop, ticks) && loop.count == ticks &&
        !springs.has_failed)
        look(lab, &loop, trial);
    else
        lab_at_most(lab, "proxy", trial->speed, NAN, "mm/s", SPEED);
    hand_loop_close(&loop);
}

static void run(struct lab *lab)
{
    struct hand_mesh mesh;
    if (hand_mesh_open_springs(&mesh, "liver", lab->effort < 0.5 ? FEWER : TRIANGLES, &liver))
        for (int tool = 0; tool < TOOLS; tool++)
            for (uint64_t i = 0; i < lab_share(lab, INTEGRATORS); i++)
                hold(lab, &mesh, &trials[tool][i], integrators[i]);
    else
        lab->is_out_of_memory = 1;
    hand_mesh_close(&mesh);
}

const struct lab_case springs_case = {
    "springs", "Held for a minute in a liver of masses and springs",
    "A liver of 50,332 triangles hangs on its back: a lattice of 11,401 nodes, 5 kPa, 5 /s of "
    "drag, 1 ms of viscosity, stepped in every tick of 1 kHz, with loads spread over 20 mm. A "
    "needle of 120 mm that stands aslant, on a device that turns, and a lying tool of 60 mm, on "
    "one of 0.05 N of friction, press it with 1 N at the coupling that is chosen for them. A hand "
    "of 200 N/m holds them, and they are tapped. For 60 s nothing may buzz (1 mm/s, and 0.05 N "
    "rms, in the last quarter) or drift (0.1 mm), and an observer of passivity that does not act "
    "sees what the hand gets: never more than one sample can be off by.",
    "Soft bodies need no softer coupling than rigid ones. The force of a tool that lies hums by 2 "
    "%: few points hold it in a tick, and not the same ones in the next, as in the case tissue. "
    "That keeps half of the body awake. A load_radius of 40 mm makes it five times less.",
    run
};
