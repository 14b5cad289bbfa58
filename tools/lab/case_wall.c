/* SPDX-License-Identifier: BSD-3-Clause */
/* The stiffest stable wall, against the spectral radius of the exact sampled system. */
#include <math.h>

#include "base/vec3.h"
#include "dynpoint/coupling.h"
#include "lab/hand_sway.h"
#include "lab/lab.h"

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

/* Figures over the loops of a wall. */
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
        search.tap.direction[1] = 0.0;
        search.tap.direction[5] = 1.0;
        search.tap.reach = 1e-5;
    } else {
        loop->damping = damping;
    }
    const double found = hand_stiffest(loop, &search) / share;
    worst->off = hand_max(worst->off, fabs(found / limit - 1.0));
    search.tap.stiffness = 1.5 * limit;
    if (wall->is_turn)
        hand_loop_stiffen(loop, loop->stiffness, 1.5 * limit * share, damping * loop->stiffness / (1.5 * limit));
    else
        hand_loop_stiffen(loop, 1.5 * limit, 0.0, damping);
    const double growth = hand_sway(loop, &search.tap).growth * 2.0 * MASS / DAMPING;
    worst->growth = hand_min(worst->growth, growth);
    return found;
}

static void run_wall(struct lab *lab)
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
    .name = "wall",
    .title = "The stiffest stable wall",
    .method = "A device of 0.1 kg and 0.5 Ns/m at 1 kHz is pushed against a wall and tapped, and the rate "
              "is fitted at which its motion grows. Bisection finds the stiffest wall at which the motion "
              "dies away: of a bare spring and of the proxy on a plane, in translation and in rotation, "
              "with delays of 0 to 3 periods and virtual damping of 0 to 2 times the device's own. It is "
              "compared with dpt_stable_stiffness, the limit of the exact sampled system. There are no "
              "limits of force, no controller and no steps of encoders.",
    .advice = "Trust dpt_stable_stiffness, and so the coupling that dpt_coupling_for_device chooses: the "
              "limit is that of the sampled loop, and the proxy adds nothing to it and takes nothing from "
              "it. Virtual damping raises the limit about as much as damping of the device does, until it "
              "is itself too large for the loop.",
    .run = run_wall
};

/* A device that is pressed with 1 N has to come to rest. */

enum { DEVICES = 3, SCENES = 4, PLACES = 4 };

#define PRESS        1.0
#define REST_SECONDS 6.0
#define GRIP         200.0

/* One like an Omni, one of light friction and fine steps, and one that turns. */
static const struct example {
    const char *speed, *spin;
    struct hand_device device;
} examples[DEVICES] = {
    { "0.045 kg, 0.5 Ns/m, 0.26 N, 0.055 mm: fastest at the end",
      NULL,
      { .dofs = 3, .mass = 0.045, .damping = 0.5, .friction = 0.26, .step = 5.5e-5, .force = 3.3 } },
    { "0.1 kg, 0.5 Ns/m, 0.05 N, 0.01 mm: fastest at the end",
      NULL,
      { .dofs = 3, .mass = 0.1, .damping = 0.5, .friction = 0.05, .step = 1e-5, .force = 8.0 } },
    { "0.2 kg, 2 Ns/m, 0.1 N, 0.02 mm, 6 DoF: fastest at the end",
      "0.2 kg, 2 Ns/m, 0.1 N, 0.02 mm, 6 DoF: fastest turn at the end",
      { .dofs = 6,
        .mass = 0.2,
        .damping = 2.0,
        .friction = 0.1,
        .step = 2e-5,
        .inertia = 2e-4,
        .turn_damping = 2e-3,
        .turn_friction = 1e-3,
        .turn_step = 1e-4,
        .force = 8.0,
        .torque = 0.4 } }
};

static const struct scene {
    const char *shape;
    uint64_t triangles;
    double scale;
    int is_drawn; /* where on it */
    struct hand_tool tool;
} scenes[SCENES] = { { "box", 12, 3.0, 0, { 0.06, 0.002, 0.0 } },
                     { "liver", 10000, 1.0, 1, { 0.12, 0.001, 0.0 } },
                     { "membrane", 512, 1.0, 0, { 0.06, 0.002, 0.5 } },
                     { "liver", 10000, 1.0, 1, { 0.06, 0.002, 0.5 } } };

struct fastest {
    double speed, spin; /* in the last quarter, m/s and rad/s */
    double force;       /* N: least that presses out, in the last quarter */
};

static void look(const struct hand_loop *loop, struct fastest *fastest)
{
    for (size_t i = loop->count - loop->count / 4; i < loop->count; i++) {
        const double *v = loop->track[i].speed, *w = v + 3;
        fastest->speed = fmax(fastest->speed, vec3_length(v));
        fastest->spin = fmax(fastest->spin, vec3_length(w));
        fastest->force = fmin(fastest->force, loop->track[i].sent[1]);
    }
}

/* Its weight is 1 N and presses; a hand holds it sideways, and it is tapped aslant. */
static void hold(const struct hand_mesh *mesh, const struct scene *scene, const struct hand_device *device, int method,
                 uint64_t *seed, struct fastest *fastest)
{
    struct hand_place place = { .mesh = mesh };
    struct hand_loop loop = {
        .device = *device, .place = &place, .tool = scene->tool, .method = method, .tap = { 1e-3, -2e-3, 5e-4 }
    };
    loop.device.rate = 1000.0;
    loop.device.delay = 1.0;
    loop.device.script = "hold";
    loop.device.grip = GRIP;
    loop.device.turn_grip = 0.2;
    loop.device.weight = PRESS;
    const dpt_coupling coupling = hand_loop_choose(&loop, 1.5);
    loop.stiffness = coupling.stiffness;
    loop.rotational_stiffness = coupling.rotational_stiffness;
    hand_place_middle(mesh, &place);
    if (!hand_loop_open(&loop))
        fastest->speed = HUGE_VAL;
    else if (scene->is_drawn ? hand_loop_seek(&loop, mesh, seed, PRESS, &place) : hand_loop_lower(&loop, PRESS)) {
        if (!hand_loop_run(&loop, (uint64_t)(REST_SECONDS * loop.device.rate)) ||
            loop.count < REST_SECONDS * loop.device.rate)
            fastest->speed = HUGE_VAL;
        else
            look(&loop, fastest);
    } else {
        /* It is pressed through, or aside: there is no place where it rests. */
        fastest->speed = HUGE_VAL;
    }
    hand_loop_close(&loop);
}

static void run_rest(struct lab *lab)
{
    struct hand_mesh meshes[SCENES];
    const uint64_t scene_count = lab_share(lab, SCENES);
    for (uint64_t i = 0; i < scene_count; i++)
        if (!hand_mesh_open(&meshes[i], scenes[i].shape, scenes[i].triangles, scenes[i].scale))
            lab->is_out_of_memory = 1;
    for (int method = 0; method < LAB_METHODS && !lab->is_out_of_memory; method++) {
        double force = HUGE_VAL;
        for (int d = 0; d < DEVICES; d++) {
            struct fastest fastest = { 0.0, 0.0, HUGE_VAL };
            for (uint64_t i = 0; i < scene_count; i++) {
                uint64_t seed = 3;
                const uint64_t places = scenes[i].is_drawn ? lab_share(lab, PLACES) : 1;
                for (uint64_t k = 0; k < places; k++)
                    hold(&meshes[i], &scenes[i], &examples[d].device, method, &seed, &fastest);
            }
            const char *word = lab_method_name(method);
            lab_at_most(lab, word, examples[d].speed, 1e3 * fastest.speed, "mm/s", 1.0);
            if (examples[d].spin)
                lab_at_most(lab, word, examples[d].spin, fastest.spin, "rad/s", 0.02);
            force = fmin(force, fastest.force);
        }
        lab_note(lab, lab_method_name(method), "least force at the end", force, "N");
    }
    for (uint64_t i = 0; i < scene_count; i++)
        hand_mesh_close(&meshes[i]);
}

const struct lab_case rest_case = {
    .name = "rest",
    .title = "Holding still",
    .method = "Three examples of devices, one of them like an Omni, press a tool with 1 N for 6 s, at 1 kHz "
              "with a delay of one period, at the coupling that dpt_coupling_for_device chooses. The tool "
              "lies on a plane, stands on a liver and on a membrane, or is a needle of 120 mm whose device "
              "goes through a lobe of the liver. A hand of 200 N/m holds it sideways. It is tapped, and has "
              "to be at rest in the last quarter: below 1 mm/s, and 0.02 rad/s.",
    .advice = "At the coupling that is chosen for it, a device with some friction comes to rest on the "
              "proxy. If yours hums, its friction is less than the stiffness times half a step of its "
              "encoders: ask for a lower stiffness.",
    .run = run_rest
};
