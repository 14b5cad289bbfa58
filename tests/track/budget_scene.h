/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Tools and bodies that move from tick to tick, for the tests of budgets. A budget_input says what all worlds of a run
 * are given, so that one with a budget can be held against one without; a budget_sim is a world that is given so.
 */
#ifndef DPT_TESTS_BUDGET_SCENE_H
#define DPT_TESTS_BUDGET_SCENE_H

#include <math.h>

#include "lib/fixture.h"
#include "lib/rig.h"

/* Of each run; the number of the command line. */
extern uint32_t budget_ticks;

enum { BODIES_MAX = 40, SEGMENTS_MAX = 12, SCENES = 6 };
enum motion { REST, SLIDE, SPIN, FLY, JUMP, MOVED, MOTIONS };
static const char *const motions[MOTIONS] = { "rest", "slide", "spin", "fly", "jump", "moved" };

static const uint32_t budgets[] = { 1, 2, 3, 5, 16, 64, 1000 };
static const uint64_t caches[] = { 0, 272, 1 << 20 };
enum { BUDGETS = sizeof budgets / sizeof *budgets, CACHES = sizeof caches / sizeof *caches };

/* A rigid tool is a star of lines, moved by its pose; a free one a rope, moved by its segments. */
extern const struct scene {
    uint32_t segments, bodies;
    int rigid;
} budget_scenes[SCENES];

/* The two meshes of which bodies are made. */
extern struct fixture budget_mesh, small_mesh;

/* Uniform in -1..1. */
double random_signed(uint64_t *random);

/* What all worlds of a run are given. */
struct budget_input {
    uint64_t random;
    const struct scene *scene;
    double size; /* of the mesh */
    struct place {
        const dpt_mesh *mesh;
        dpt_pose pose;
        int there;
    } places[BODIES_MAX];
    dpt_pose pose;                 /* of the tool */
    dpt_segment own[SEGMENTS_MAX]; /* in its frame */
    dpt_segment now[SEGMENTS_MAX]; /* in the world */
    double way[3], turn[3];
    double moved; /* the most that an end moved in this tick */
};

/* Set the tool's ends in the world from its pose. */
void input_set_tool(struct budget_input *input);

/* Bodies and a tool at random places. */
void input_start(struct budget_input *input, const struct scene *scene, uint64_t seed);

/* The next tick; `near` is a pair that leads to the surface. */
void input_move(struct budget_input *input, int motion, const dpt_hit *near);

/* A world that is given so, and what its last step said. */
struct budget_sim {
    struct rig rig;
    dpt_body body[BODIES_MAX];
    dpt_hit hits[SEGMENTS_MAX];
};

void budget_sim_add_body(struct budget_sim *sim, const struct budget_input *input, uint32_t b);

/* With the bodies and the tool of the input. */
void budget_sim_open(struct budget_sim *sim, const struct budget_input *input, uint32_t method, uint32_t budget,
                     uint64_t bytes);

/* Poses that did not change are given again: hosts do so. */
void budget_sim_step(struct budget_sim *sim, const struct budget_input *input);

#endif
