/* SPDX-License-Identifier: BSD-3-Clause */
/* Creating, resetting and measuring worlds. Bodies and tools are in body.c and tool.c, the tick in step.c. */
#include "base/return_if_error.h"
#include "base/sized.h"
#include "track/body_search.h"
#include "track/persistent_contacts.h"
#include "world/deform_body.h"
#include "world/world_def.h"
#include "world/world_layout.h"
#include "world/world_members.h"

size_t dpt_world_bytes(const dpt_world_def *given)
{
    dpt_world_def def;
    dpt_baseline_def baseline;
    if (dpti_world_def_read(given, &def, &baseline) != DPT_OK || !dpti_world_def_is_valid(&def))
        return 0;
    return dpti_world_layout_bytes(&def);
}

dpt_result dpt_world_create(void *block, size_t bytes, const dpt_world_def *given, dpt_world **world)
{
    dpt_world_def def;
    dpt_baseline_def baseline;
    if (!block || !world)
        return DPT_E_ARGUMENT;
    DPT_TRY(dpti_world_def_read(given, &def, &baseline));
    if (!dpti_world_def_is_valid(&def))
        return DPT_E_ARGUMENT;
    if ((uintptr_t)block % 8)
        return DPT_E_ALIGN;
    size_t needed = dpti_world_layout_bytes(&def);
    if (!needed || bytes < needed)
        return DPT_E_MEMORY;
    struct kernel kernel;
    uint32_t kernel_id;
    if (!dpti_kernel_get(def.kernel, &kernel, &kernel_id))
        return DPT_E_UNSUPPORTED;

    memset(block, 0, needed);
    struct dpt_world *made = block;
    made->def = def;
    made->baseline = baseline;
    made->def.baseline = &made->baseline;
    made->kernel = kernel;
    made->usage.kernel = kernel_id;
    dpti_world_layout_place(made);
    *world = made;
    return DPT_OK;
}

dpt_result dpt_world_reset(dpt_world *world)
{
    if (!world)
        return DPT_E_ARGUMENT;
    for (uint32_t t = 0; t < world->tool_slot_end; t++)
        if (world->tools[t].slot.used)
            dpti_tool_forget(world, &world->tools[t]);
    dpti_body_search_forget_planes(world, 0, world->segment_count, DPT_NONE);
    dpti_point_cache_forget(&world->point_cache, DPT_NONE);
    dpti_persistent_contacts_reset(world);
    for (uint32_t i = 0; i < world->body_slot_end; i++) {
        world->bodies[i].moved_tick = world->bodies[i].added_tick = 0;
        world->bodies[i].motion_bound = 0.0;
        dpti_deform_reset(&world->bodies[i]);
    }
    world->bodies_moved_tick = 0;
    world->body_motion_max = 0.0;
    world->undone_segment = 0;
    world->ticks = 0;
    return DPT_OK;
}

dpt_result dpt_world_get_info(const dpt_world *world, dpt_world_info *info)
{
    if (!world || !info)
        return DPT_E_ARGUMENT;
    DPT_TRY(sized_check(info, sizeof *info, 0));
    sized_write(info, info->size, &world->usage, sizeof world->usage);
    return DPT_OK;
}
