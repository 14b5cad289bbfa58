/* SPDX-License-Identifier: BSD-3-Clause */
/* Bodies that move under a held device: the controller must not take their force away. */
#include <math.h>

#include "base/sincos.h"
#include "lab/hand_sway.h"
#include "lab/lab_cases.h"

enum { PLACES = 6 };

#define TRAVEL  5e-3
#define RATE    1.2
#define SECONDS 8.0
#define YIELD   300.0 /* N/m: of the body that is pushed, and how fast it follows, s */
#define FOLLOW  0.03

/* Move the body along the place's way out by so many m from where it was. */
static void put_body(struct hand_loop *loop, double along)
{
    for (int k = 0; k < 3; k++)
        loop->body_pose.position[k] = along * loop->place->out[k];
    dpt_body_set_pose(loop->world, loop->body, &loop->body_pose);
}

/* From its lowest place on, 5 mm up and down. */
static void beat(struct hand_loop *loop, double time)
{
    double sine, cosine;
    turn_sincos(RATE * time, &sine, &cosine);
    put_body(loop, 0.5 * TRAVEL * (1.0 - cosine));
}

/* It gives way to the force of the last step, slowly. */
static void yield(struct hand_loop *loop, double time)
{
    double along = 0.0, force = 0.0;
    dpt_wrench wrench;
    (void)time;
    dpt_tool_get_wrench(loop->world, loop->held, &wrench);
    for (int k = 0; k < 3; k++) {
        along += loop->body_pose.position[k] * loop->place->out[k];
        force += wrench.force[k] * loop->place->out[k];
    }
    put_body(loop, along + (-force / YIELD - along) * 1e-3 / FOLLOW);
}

static const struct scene {
    const char *kept, *lost;
    void (*move)(struct hand_loop *loop, double time);
    const char *script;
} scenes[] = { { "beating organ: force, of that without the controller",
                 "beating organ: the same, if its work is not credited", beat, "hold" },
               { "pushed organ: force, of that without the controller",
                 "pushed organ: the same, if its work is not credited", yield, "press" } };

/* Mean force out of the surface, N, after the first second; NAN if there was no run. */
static double mean_force(struct hand_loop *loop)
{
    double sum = 0.0;
    size_t from = 1000;
    put_body(loop, 0.0);
    hand_loop_return(loop);
    if (!hand_loop_run(loop, (uint64_t)(SECONDS * loop->device.rate)) || loop->count <= from)
        return NAN;
    for (size_t i = from; i < loop->count; i++)
        sum += loop->track[i].sent[1];
    return sum / (double)(loop->count - from);
}

/* The least shares of the force that are kept, with the bodies' work and without. */
static void try_place(const struct hand_mesh *liver, const struct scene *scene, uint64_t *seed, double share[2])
{
    struct hand_place place = { .mesh = liver };
    struct hand_loop loop = { .device = hand_device_even(0.1, 0.5, 1.0, 0.0),
                              .place = &place,
                              .tool = { 0.06, 0.002, 0.5 },
                              .method = LAB_PROXY,
                              .move = scene->move };
    dpt_passivity_def def;
    dpt_guard_def guard;
    dpt_guard_def_init(&guard);
    dpt_passivity_def_init(&def);
    guard.start = 0.0;
    def.damping = loop.device.damping;
    def.delay = 1e-3;
    loop.guard = &guard;
    loop.device.script = scene->script;
    loop.device.grip = 200.0;
    loop.device.reach = 0.01;
    loop.device.cycle = 1.0;
    loop.device.weight = 1.0;
    loop.stiffness = hand_loop_choose(&loop, 1.5).stiffness;
    if (hand_loop_open(&loop) && hand_loop_seek(&loop, liver, seed, loop.device.weight, &place)) {
        const double without = mean_force(&loop);
        loop.passivity = &def;
        for (loop.is_uncredited = 0; loop.is_uncredited < 2; loop.is_uncredited++) {
            double *least = &share[loop.is_uncredited];
            *least = hand_smaller(*least, mean_force(&loop) / without);
        }
    } else {
        share[0] = NAN;
    }
    hand_loop_close(&loop);
}

static void run(struct lab *lab)
{
    struct hand_mesh liver = { .mesh = NULL };
    const uint64_t places = lab_share(lab, PLACES);
    if (!hand_mesh_open(&liver, "liver", 10000, 1.0)) {
        lab->is_out_of_memory = 1;
        return;
    }
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        double share[2] = { HUGE_VAL, HUGE_VAL };
        uint64_t seed = 3;
        for (uint64_t k = 0; k < places; k++)
            try_place(&liver, &scenes[i], &seed, share);
        lab_at_least(lab, "controller", scenes[i].kept, share[0], "", 0.99);
        lab_note(lab, "controller", scenes[i].lost, share[1], "");
    }
    hand_mesh_close(&liver);
}

const struct lab_case beat_case = {
    "beat", "Bodies that move",
    "A hand presses a tip on to a liver with 1 N, on a device of 0.1 kg and 0.5 Ns/m at 1 kHz "
    "with a delay of one period, at the coupling that is chosen for it. The liver beats by 5 mm "
    "at 1.2 Hz, or gives way to the tool that presses and lets go. The mean force is compared "
    "with and without the controller of passivity, which is told the work of moving bodies, or is not.",
    "Give dpt_passivity_step the body_work of the force report in each step. Without it a beating "
    "organ looks like a wall that makes energy, and its force is taken away.",
    run
};
