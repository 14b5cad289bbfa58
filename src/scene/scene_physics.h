/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Physics of a scene's soft bodies at a rate of its own, apart from the haptic loop: in a thread, or, so that every run
 * gives the same bits, within the loop by the loop's time. Both go through the same exchange. In the haptic loop nothing
 * is allocated, locked, or asked of the system.
 *
 *     scene_physics_open(&physics, bodies, rate);
 *     scene_physics_start(physics, loop_rate);               without it, physics goes by the loop's time
 *     haptic loop, before a step:   scene_physics_begin_tick(physics, world);
 *                  after it:        scene_physics_end_tick(physics, world, dt);
 *     scene_physics_stop(physics);
 *     scene_physics_close(physics);                           before the world is freed
 */
#ifndef DPT_SCENE_PHYSICS_H
#define DPT_SCENE_PHYSICS_H

#include "dynpoint/exchange.h"
#include "dynpoint/springs.h"
#include "scene/scene_bodies.h"

/*
 * Between the haptic loop and the physics of a soft body: vertices one way, loads on them the other way. Neither
 * side waits for the other, and the newest value counts (exchange.h).
 *
 *     haptic loop, before a step of the world:   soft_exchange_take_answer(exchange, world, body, &is_new);
 *                  after it:                     soft_exchange_give_loads(exchange, world, body);
 *     physics:                                   soft_exchange_step(exchange, springs, dt, &report);
 */

/* Of a body with a compliance the means of loads on vertices since the last answer; else those of the last tick. */
struct soft_loads {
    dpt_load *load;
    uint32_t count;
};

/* Where vertices are after a step of physics, and the loads of that step. */
struct soft_answer {
    float *vertices; /* 3 numbers each, in the body's frame; if has_moved */
    float *foreseen; /* where these will be a step later, with the same loads; NULL: nothing is foreseen */
    struct soft_loads loads;
    int has_moved; /* 0: all of it sleeps */
};

/* Begin with zeros. */
struct soft_exchange {
    dpt_latest latest_answer, latest_loads;
    struct soft_answer answers[DPT_LATEST_PLACES];
    struct soft_loads loads[DPT_LATEST_PLACES];
    uint32_t vertex_count, node_count, loads_room;
    int has_compliance; /* 1: the body has */
    /* The vertices are embedded in nodes: four for each vertex. NULL: they are the nodes. */
    const uint32_t *embedding;
    const float *weights;
    /* Of physics, if there is an embedding. */
    float *nodes;
    dpt_load *node_loads;
};

/*
 * Of a mesh with springs, which stays open. DPT_E_MEMORY: memory ran out. Close it also after a failure.
 *   max_points       of the body's dpt_deformable_def
 *   has_compliance   1: its compliance is above 0
 *   period           s: of a step of physics. Sheets look ahead; so do volumes in long steps, or with a ratio other than 1/4
 */
dpt_result soft_exchange_open(struct soft_exchange *exchange, const dpt_mesh *mesh, uint32_t max_points,
                              int has_compliance, double period);
void soft_exchange_close(struct soft_exchange *exchange);

/* If physics has an answer, the body is told. *is_new says whether its vertices are bound for somewhere else then. */
dpt_result soft_exchange_take_answer(struct soft_exchange *exchange, dpt_world *world, dpt_body body, int *is_new);

/* What tools do to the body. */
dpt_result soft_exchange_give_loads(struct soft_exchange *exchange, const dpt_world *world, dpt_body body);

/*
 * Physics goes on by dt, s, under the newest loads. Vertices are handed over if any node is awake; a body with a
 * compliance is told that its loads are answered in any case. The report's size is set by the caller.
 */
dpt_result soft_exchange_step(struct soft_exchange *exchange, dpt_springs *springs, double dt,
                              dpt_springs_info *report);

struct scene_physics;

/* Hz; a period is at most a second, as a step of springs is. */
#define SCENE_PHYSICS_RATE_MIN 1.0
#define SCENE_PHYSICS_RATE_MAX 5000.0

/*
 * Before bodies are added to a world: refuse what cannot be stepped apart, and let the vertices move smoothly from one
 * step of physics to the next. `path` is the scene's, `name` that of the rate in texts (setting_words.h).
 */
dpt_result scene_physics_choose(struct scene_bodies *bodies, const char *path, const char *name, double rate,
                                dpt_host_error *error);

/* By the time of a loop at this rate, Hz: refuse physics whose period is no whole number of the loop's. */
dpt_result scene_physics_check_loop(const char *name, double rate, double loop_rate, dpt_host_error *error);

/* Of bodies that were added to a world. DPT_E_MEMORY: memory ran out. */
dpt_result scene_physics_open(struct scene_physics **physics, struct scene_bodies *bodies, double rate);
void scene_physics_close(struct scene_physics *physics);

/*
 * Step in a thread of its own until scene_physics_stop. While the loop does not tick, because the clutch is down or the
 * device is lost, physics stands still after 20 ms or three periods of the loop. DPT_E_SYSTEM: there is no thread. Stop
 * waits for the step that is under way; NULL, and physics without a thread, are fine.
 */
dpt_result scene_physics_start(struct scene_physics *physics, double loop_rate);
void scene_physics_stop(struct scene_physics *physics);

/*
 * In the haptic loop, before and after a step of the world by dt, s. A body whose last step or whose new vertices were
 * refused is held where it was (scene_bodies_hold), and the others go on. DPT_E_ARGUMENT: physics goes by the loop's time,
 * and dt is no step of it.
 */
void scene_physics_begin_tick(struct scene_physics *physics, dpt_world *world);
dpt_result scene_physics_end_tick(struct scene_physics *physics, dpt_world *world, double dt);

struct scene_physics_report {
    double asked, rate; /* Hz; the second is what it was, on average */
    uint64_t steps;
    uint64_t late; /* periods that passed without a step, because the one before took too long */
    int has_thread;
};

/* The steps so far, from any thread; all of it after scene_physics_stop. */
uint64_t scene_physics_steps(const struct scene_physics *physics);
struct scene_physics_report scene_physics_get_report(const struct scene_physics *physics);

#endif
