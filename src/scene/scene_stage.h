/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A world in memory of its own, what is felt in it, and the tool that feels it. Scenes, runs that are measured and the
 * laboratory's rigs make all of their worlds here.
 *
 *     scene_stage_open(&stage, &def);
 *     scene_stage_add_bodies(&stage, &bodies, &force, physics_rate);        or bodies of the caller's own
 *     scene_stage_add_tool(&stage, segments, count, &force, lock_rotation);
 *     in each tick:   scene_stage_step_world(&stage, dt, NULL);
 *                     scene_stage_step_soft(&stage, dt);
 *     scene_stage_close(&stage);
 */
#ifndef DPT_SCENE_STAGE_H
#define DPT_SCENE_STAGE_H

#include "dynpoint/world.h"
#include "scene/force_options.h"
#include "scene/scene_bodies.h"
#include "scene/scene_physics.h"

/* Begin with zeros. */
struct scene_stage {
    dpt_world *world;
    dpt_tool tool;
    struct scene_bodies *bodies;   /* NULL: the caller has others, or none */
    struct scene_physics *physics; /* of what is soft; NULL: it is stepped in each tick */
    void *block;
    size_t bytes; /* of the world */
};

/* Make the world. Close the stage also after a failure. */
dpt_result scene_stage_open(struct scene_stage *stage, const dpt_world_def *def);

/* Bodies stay where they are; their memory in the world ends with scene_bodies_leave. They outlive the stage. */
void scene_stage_close(struct scene_stage *stage);

/*
 * Bodies, and what the options say of them.
 *   physics_rate   Hz of what is soft, after scene_physics_choose; 0: in each tick
 */
dpt_result scene_stage_add_bodies(struct scene_stage *stage, struct scene_bodies *bodies,
                                  const struct force_options *force, double physics_rate);

/* The tool. `force` NULL: as the world's def says, and far segments are searched for, too. */
dpt_result scene_stage_add_tool(struct scene_stage *stage, const dpt_segment *segments, uint32_t count,
                                const struct force_options *force, uint32_t lock_rotation);

/* A step of the world, then one of what is soft, by dt, s. `told` may be NULL. A body that cannot go on is held. */
dpt_result scene_stage_step_world(struct scene_stage *stage, double dt, dpt_step *told);
dpt_result scene_stage_step_soft(struct scene_stage *stage, double dt);

#endif
