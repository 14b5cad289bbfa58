/* SPDX-License-Identifier: BSD-3-Clause */
#include "scene/scene_stage.h"

#include <stdlib.h>

#include "base/return_if_error.h"

dpt_result scene_stage_open(struct scene_stage *stage, const dpt_world_def *def)
{
    *stage = (struct scene_stage){ .bytes = dpt_world_bytes(def) };
    stage->block = malloc(stage->bytes ? stage->bytes : 1);
    return stage->block ? dpt_world_create(stage->block, stage->bytes, def, &stage->world) : DPT_E_MEMORY;
}

void scene_stage_close(struct scene_stage *stage)
{
    scene_physics_close(stage->physics);
    free(stage->block);
    *stage = (struct scene_stage){ .world = NULL };
}

dpt_result scene_stage_add_bodies(struct scene_stage *stage, struct scene_bodies *bodies,
                                  const struct force_options *force, double physics_rate)
{
    stage->bodies = bodies;
    DPT_TRY(scene_bodies_add(bodies, stage->world, force));
    return physics_rate > 0.0 ? scene_physics_open(&stage->physics, bodies, physics_rate) : DPT_OK;
}

dpt_result scene_stage_add_tool(struct scene_stage *stage, const dpt_segment *segments, uint32_t count,
                                const struct force_options *force, uint32_t lock_rotation)
{
    DPT_TRY(dpt_tool_add(stage->world, segments, count, &stage->tool));
    return force ? force_options_set_tool(force, stage->world, stage->tool, lock_rotation) : DPT_OK;
}

dpt_result scene_stage_step_world(struct scene_stage *stage, double dt, dpt_step *told)
{
    if (stage->physics)
        scene_physics_begin_tick(stage->physics, stage->world);
    return dpt_world_step(stage->world, dt, told);
}

dpt_result scene_stage_step_soft(struct scene_stage *stage, double dt)
{
    const dpt_result result = stage->physics ? scene_physics_end_tick(stage->physics, stage->world, dt)
                                             : scene_bodies_step(stage->bodies, stage->world, dt);
    scene_bodies_count_moves(stage->bodies, dt);
    return result;
}
