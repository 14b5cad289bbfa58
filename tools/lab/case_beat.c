/* SPDX-License-Identifier: BSD-3-Clause */
/* Bodies that move under a held device: the controller must not take their force away. */
#include <math.h>

#include "base/sincos.h"
#include "lab/hand_sway.h"
#include "lab/lab.h"

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
    dpt_body_set_pose(loop->stage.world, loop->body, &loop->body_pose);
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
    dpt_tool_get_wrench(loop->stage.world, loop->stage.tool, &wrench);
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
            double *min = &share[loop.is_uncredited];
            *min = hand_min(*min, mean_force(&loop) / without);
        }
    } else {
        share[0] = NAN;
    }
    hand_loop_close(&loop);
}

static void run_beat(struct lab *lab)
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
    .name = "beat",
    .title = "Bodies that move",
    .method = "A hand presses a tip on to a liver with 1 N, on a device of 0.1 kg and 0.5 Ns/m at 1 kHz "
              "with a delay of one period, at the coupling that is chosen for it. The liver beats by 5 mm "
              "at 1.2 Hz, or gives way to the tool that presses and lets go. The mean force is compared "
              "with and without the controller of passivity, which is told the work of moving bodies, or is not.",
    .advice = "Give dpt_passivity_step the body_work of the force report in each step. Without it a beating "
              "organ looks like a wall that makes energy, and its force is taken away.",
    .run = run_beat
};

/* Vertices that move under a held device: their work is credited, and tissue gives no energy of its own. */

enum { SPEEDS = 4, MODES = 2, HANDS = 3, TICKS = 3000 };

#define PULSE_SECONDS 6.0
#define WEIGHT        1.0 /* N: what the hand presses with */
#define MARGIN        1.5
#define MASS          0.1
#define DAMPING       0.5
#define PERIOD        1e-3
#define RADIUS        0.048 /* m: of loads, three edges */
#define REACH         0.06  /* m: of the bump that beats */

/* Of 30, 100, 250 Hz and 1 kHz. */
static const uint32_t speeds[SPEEDS] = { 33, 10, 4, 1 };

static const struct hand_tool tip = { 0.06, 0.002, 0.5 };

static struct tissue tissue_on(const struct hand_mesh *mesh, uint64_t which)
{
    return (struct tissue){ .mesh = mesh->mesh,
                            .ticks = speeds[which / MODES % SPEEDS],
                            .is_interpolated = which % MODES == 0,
                            .load_radius = RADIUS };
}

/* A device of 0.1 kg and 0.5 Ns/m with a delay of one period, and the coupling that is chosen for it. */
static void set_device(struct hand_loop *loop)
{
    loop->device = hand_device_even(MASS, DAMPING, 1.0, hand_loop_rho(loop));
    loop->device.script = "hold";
    loop->device.grip = 200.0;
    loop->device.turn_grip = loop->device.grip * hand_loop_rho(loop) * hand_loop_rho(loop);
    loop->device.reach = 0.01;
    loop->device.cycle = 1.0;
    loop->device.weight = WEIGHT;
    loop->stiffness = hand_loop_choose(loop, MARGIN).stiffness;
}

static dpt_passivity_def watch(const struct hand_loop *loop)
{
    dpt_passivity_def def;
    dpt_passivity_def_init(&def);
    def.damping = loop->device.damping;
    def.spin_damping = loop->device.turn_damping;
    def.delay = PERIOD;
    return def;
}

/* Mean force out of the surface, N, after the first second; NAN if there was no run. */
static double mean_force_of_pulse(struct hand_loop *loop)
{
    const size_t from = 1000;
    double sum = 0.0;
    hand_loop_return(loop);
    if (!hand_loop_run(loop, (uint64_t)(PULSE_SECONDS * loop->device.rate)) || loop->count <= from ||
        loop->tissue->has_failed)
        return NAN;
    for (size_t i = from; i < loop->count; i++)
        sum += loop->track[i].sent[1];
    return sum / (double)(loop->count - from);
}

/* The largest change of force in a tick, of what the coupling makes of the motion of surface and device in it. */
static double jerk_of(const struct hand_loop *loop)
{
    const double beat = 3.141592653589793 * RATE * TRAVEL * PERIOD;
    double max = 0.0;
    for (size_t i = 1000; i < loop->count; i++) {
        const struct hand_moment *now = &loop->track[i], *before = now - 1;
        double change = 0.0, motion = 0.0;
        for (int k = 0; k < 3; k++) {
            change += (now->sent[k] - before->sent[k]) * (now->sent[k] - before->sent[k]);
            motion += (now->at[k] - before->at[k]) * (now->at[k] - before->at[k]);
        }
        max = fmax(max, sqrt(change) / (loop->stiffness * (beat + sqrt(motion))));
    }
    return max;
}

/* The least shares of the force that are kept, with the work of the vertices and without; the jerk by mode. */
static void try_beat(const struct hand_mesh *liver, uint64_t which, uint64_t *seed, double share[2], double jerk[MODES])
{
    struct hand_place place = { .mesh = liver };
    struct tissue tissue = tissue_on(liver, which);
    struct hand_loop loop = { .place = &place, .tissue = &tissue, .tool = tip, .method = LAB_PROXY, .is_uncounted = 1 };
    dpt_passivity_def def;
    dpt_guard_def guard;
    dpt_guard_def_init(&guard);
    guard.start = 0.0;
    loop.guard = &guard;
    set_device(&loop);
    def = watch(&loop);
    if (hand_loop_open(&loop) && hand_loop_seek(&loop, liver, seed, WEIGHT, &place)) {
        tissue.beat = (struct tissue_beat){ .travel = TRAVEL, .rate = RATE, .reach = REACH };
        for (int k = 0; k < 3; k++) {
            tissue.beat.at[k] = place.at[k];
            tissue.beat.out[k] = place.out[k];
        }
        const double without = mean_force_of_pulse(&loop);
        jerk[which % MODES] = fmax(jerk[which % MODES], jerk_of(&loop));
        loop.passivity = &def;
        for (loop.is_uncredited = 0; loop.is_uncredited < 2; loop.is_uncredited++) {
            double *min = &share[loop.is_uncredited];
            *min = hand_min(*min, mean_force_of_pulse(&loop) / without);
        }
    } else {
        share[0] = NAN;
    }
    hand_loop_close(&loop);
}

/*
 * What hand and tissue have put into the tool and its device and not got back, J: at most what the law stores. The
 * tissue's part is as the force report tells it, or as its own loads and vertices do.
 */
struct account {
    double now, min;
};

static void book(struct account *account, const struct hand_device *device, const struct hand_moment *now, double given)
{
    const struct hand_moment *before = now - 1;
    account->now += given;
    for (int k = 0; k < HAND_AXES; k++) {
        const double by = now->at[k] - before->at[k];
        const double damping = k < 3 ? device->damping : device->turn_damping;
        account->now += damping * by * by * device->rate - now->sent[k] * by;
    }
    account->now = fmin(account->now, now->energy);
    account->min = fmin(account->min, account->now);
}

/* J: the largest force times the largest motion between two samples, what one of them can be off by. */
static double eps_of(const struct hand_loop *loop)
{
    const double unit = loop->tool.length / sqrt(12.0);
    double motion = 0.0, force = 0.0;
    for (size_t i = 1; i < loop->count; i++) {
        double moved = 0.0, sent = 0.0;
        for (int k = 0; k < HAND_AXES; k++) {
            const double by = loop->track[i].at[k] - loop->track[i - 1].at[k];
            const double scale = k < 3 ? 1.0 : unit;
            moved += scale * scale * by * by;
            sent += loop->track[i].sent[k] * loop->track[i].sent[k] / (scale * scale);
        }
        motion = fmax(motion, sqrt(moved));
        force = fmax(force, sqrt(sent));
    }
    return force * motion;
}

/* A soft and a firm hand that press and let go, and one that holds. */
static void set_hand(struct hand_device *device, uint64_t hand)
{
    device->script = hand < 2 ? "press" : "hold";
    device->grip = hand == 1 ? 2000.0 : 200.0;
    device->turn_grip = device->inertia / device->mass * device->grip;
    device->cycle = 0.5;
    device->weight = hand < 2 ? 0.0 : WEIGHT;
}

/* The least accounts, in eps: by the force report, by the tissue's own loads, and the library's observer. */
static void try_yielding(const struct hand_mesh *liver, uint64_t which, uint64_t hand, double min[4])
{
    struct hand_place place = { .mesh = liver };
    struct tissue tissue = tissue_on(liver, which);
    struct hand_loop loop = { .place = &place, .tissue = &tissue, .tool = tip, .method = LAB_PROXY };
    struct account told = { 0.0, 0.0 }, own = told, without = told;
    dpt_passivity_def def;
    tissue.matter = tissue_soft;
    set_device(&loop);
    set_hand(&loop.device, hand);
    loop.device.delay = 0.0;
    loop.stiffness = 2.0 * DAMPING / PERIOD;
    def = watch(&loop);
    def.delay = 0.0;
    def.damping /= 0.8;
    def.spin_damping /= 0.8;
    def.observe_only = 1;
    def.reserve = 0.0;
    loop.passivity = &def;
    hand_place_top(liver, &place);
    if (hand_loop_open(&loop) && hand_loop_lower(&loop, 1e-4 * loop.stiffness)) {
        hand_loop_lift(&loop, 0.002);
        if (hand_loop_run(&loop, TICKS) && !tissue.has_failed) {
            const double eps = eps_of(&loop);
            for (size_t i = 1; i < loop.count; i++) {
                book(&told, &loop.device, &loop.track[i], loop.track[i].body_work);
                book(&own, &loop.device, &loop.track[i], loop.track[i].tissue_work);
                book(&without, &loop.device, &loop.track[i], 0.0);
            }
            min[0] = hand_min(min[0], told.min / eps);
            min[1] = hand_min(min[1], own.min / eps);
            min[3] = hand_min(min[3], without.min / eps);
            min[2] = hand_min(min[2], hand_loop_account(&loop).account_min / eps);
        } else {
            min[0] = NAN;
        }
    } else {
        min[0] = NAN;
    }
    hand_loop_close(&loop);
}

static void run_pulse(struct lab *lab)
{
    struct hand_mesh liver = { .mesh = NULL };
    const uint64_t beats = lab_share(lab, SPEEDS * MODES);
    const uint64_t loops = lab_share(lab, HANDS * SPEEDS * MODES);
    double share[2] = { HUGE_VAL, HUGE_VAL }, min[4] = { 0.0, 0.0, 0.0, 0.0 };
    double jerk[MODES] = { 0.0, 0.0 };
    uint64_t seed = 3;
    if (!hand_mesh_open(&liver, "liver", 1200, 1.0)) {
        lab->is_out_of_memory = 1;
        return;
    }
    for (uint64_t i = 0; i < beats; i++)
        try_beat(&liver, i, &seed, share, jerk);
    for (uint64_t i = 0; i < loops; i++)
        try_yielding(&liver, i / HANDS, i % HANDS, min);
    hand_mesh_close(&liver);
    lab_at_least(lab, "controller", "beating vertices: force, of that without the controller", share[0], "", 0.99);
    lab_note(lab, "controller", "beating vertices: the same, if their work is not credited", share[1], "");
    lab_at_most(lab, "proxy", "interpolated: largest |dF| in a tick, of K |motion|", jerk[0], "", 2.0);
    lab_note(lab, "proxy", "stepped: the same", jerk[1], "");
    lab_at_least(lab, "proxy", "tissue that gives way: least account, with body_work", min[0], "eps", -2.0);
    lab_at_least(lab, "proxy", "the same, by its loads and the motion of its vertices", min[1], "eps", -2.0);
    lab_note(lab, "proxy", "the same, if its work is not counted", min[3], "eps");
    lab_at_least(lab, "observer", "the same, as dpt_passivity keeps it", min[2], "eps", -2.0);
}

const struct lab_case pulse_case = {
    .name = "pulse",
    .title = "Vertices that move under a held device",
    .method = "A hand presses a tilted tip on to a liver with 1 N, at the coupling that is chosen for its "
              "device, and the liver beats by its vertices: a bump goes out by 5 mm at 1.2 Hz, with positions "
              "from 30, 100, 250 and 1000 Hz, in steps and interpolated. The mean force is compared with and "
              "without the controller of passivity, which is told the work of moving vertices, or is not. "
              "Where positions are interpolated, the force may change in a tick by twice what the coupling "
              "makes of the surface's motion and the device's. "
              "Then soft and firm hands press and let go, and one holds, on tissue that gives way (the case "
              "tissue), at the border of Colgate (K T/2 = b) without delay. An account has what hand and "
              "tissue have put in and not got back, with the device's damping credited, at most the energy "
              "that the law stores. The tissue's part is the body_work of the force report, or what its own "
              "loads do on its own vertices. eps is the largest force times the largest motion of a sample.",
    .advice = "Give dpt_passivity_step the body_work of the force report in each step, for vertices as for "
              "rigid bodies. Where slow physics moves vertices in steps, a step has the work of a whole "
              "period: raise body_power, or interpolate. A beat is no loop: count the period of "
              "interpolation as delay only where the tissue gives way.",
    .run = run_pulse
};
