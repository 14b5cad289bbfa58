/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Creating, resetting and measuring worlds, and what lies where in their blocks. Bodies and tools are in body.c and
 * tool.c, the tick in step.c.
 */
#include "base/return_if_error.h"
#include "base/sized.h"
#include "insertion/world_channels.h"
#include "proxy/proxy.h"
#include "proxy/tool_loads.h"
#include "track/body_search.h"
#include "track/persistent_contacts.h"
#include "track/swept_motion.h"
#include "world/baseline_method.h"
#include "world/deform_body.h"
#include "world/tool_strips.h"
#include "world/world_def.h"
#include "world/world_members.h"

/*
 * Shares of dpt_world_bytes. A struct that outgrows its share fails to compile. The rest of the block belongs to the
 * parts of the world, which state their own shares.
 */
enum {
    BYTES_WORLD = 24576, /* the world itself, with one distance profile */
    BYTES_BODY = 2048,   /* with its box */
    BYTES_TOOL = 512,
    BYTES_SEGMENT = 1984,
    BYTES_TIP = 1088,
    BYTES_HULL = 6784,
    BYTES_POINT_CACHE = 21504, /* and for each segment BYTES_POINT_CACHE_SEGMENT */
    BYTES_POINT_CACHE_SEGMENT = 3072
};
typedef char world_fits[sizeof(struct dpt_world) <= BYTES_WORLD ? 1 : -1];
typedef char body_fits[sizeof(struct body) + sizeof(struct box) <= BYTES_BODY ? 1 : -1];
typedef char tool_fits[sizeof(struct tool) <= BYTES_TOOL ? 1 : -1];
typedef char tip_fits[sizeof(struct tip) <= BYTES_TIP ? 1 : -1];
typedef char hull_fits[sizeof(struct dpt_hull) <= BYTES_HULL ? 1 : -1];
typedef char segment_fits[sizeof(struct segment) <= BYTES_SEGMENT ? 1 : -1];

static uint64_t point_cache_bytes(const dpt_world_def *def)
{
    return def->budget ? BYTES_POINT_CACHE + BYTES_POINT_CACHE_SEGMENT * (uint64_t)def->max_segments : 0;
}

/* dpt_world_bytes of a valid def. */
static size_t layout_bytes(const dpt_world_def *def)
{
    uint64_t bytes = BYTES_WORLD + BYTES_BODY * (uint64_t)def->max_bodies + BYTES_TOOL * (uint64_t)def->max_tools +
                     BYTES_SEGMENT * (uint64_t)def->max_segments + (BYTES_TIP + BYTES_HULL) * (uint64_t)def->max_tips +
                     point_cache_bytes(def) + dpti_backlog_bytes(def) + dpti_persistent_contacts_bytes(def) +
                     dpti_strips_bytes(def) + dpti_proxy_bytes(def) + dpti_loads_bytes(def) +
                     dpti_broad_phase_bytes(def) + dpti_body_search_bytes(def) + dpti_baseline_bytes(def) +
                     dpti_channels_bytes(def);
    return bytes <= SIZE_MAX ? (size_t)bytes : 0;
}

/* The arrays of a world whose def is set, in its block, which is all zeros. */
static void place_arrays(struct dpt_world *world)
{
    const dpt_world_def *def = &world->def;
    char *at = (char *)world + BYTES_WORLD;
    world->bodies = (void *)at;
    world->boxes = (void *)(world->bodies + def->max_bodies);
    at += BYTES_BODY * (size_t)def->max_bodies;
    world->tools = (void *)at;
    at += BYTES_TOOL * (size_t)def->max_tools;
    world->segments = (void *)at;
    at += BYTES_SEGMENT * (size_t)def->max_segments;
    world->tips = (void *)at;
    at += BYTES_TIP * (size_t)def->max_tips;
    world->tip_hulls = (void *)at;
    at += BYTES_HULL * (size_t)def->max_tips;
    world->point_cache.entries = (void *)at;
    world->point_cache.sets =
        (uint32_t)(point_cache_bytes(def) / (POINT_CACHE_WAYS * sizeof *world->point_cache.entries));
    at += point_cache_bytes(def);
    at = dpti_backlog_place(world, at);
    at = dpti_persistent_contacts_place(world, at);
    at = dpti_strips_place(world, at);
    at = dpti_proxy_place(world, at);
    at = dpti_loads_place(world, at);
    at = dpti_channels_place(world, at);
    at = dpti_broad_phase_place(world, at);
    at = dpti_body_search_place(world, at);
    dpti_baseline_place(world, at);
}

size_t dpt_world_bytes(const dpt_world_def *given)
{
    dpt_world_def def;
    dpt_baseline_def baseline;
    if (dpti_world_def_read(given, &def, &baseline) != DPT_OK || !dpti_world_def_is_valid(&def))
        return 0;
    return layout_bytes(&def);
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
    size_t needed = layout_bytes(&def);
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
    place_arrays(made);
    *world = made;
    return DPT_OK;
}

dpt_result dpt_world_reset(dpt_world *world)
{
    if (!world)
        return DPT_E_ARGUMENT;
    for (uint32_t t = 0; t < world->tool_slot_end; t++)
        if (world->tools[t].slot.used) {
            dpti_tool_forget(world, &world->tools[t]);
            dpti_channels_forget_tool(world, &world->tools[t]);
        }
    dpti_body_search_forget_planes(world, 0, world->segment_count, DPT_NONE);
    dpti_point_cache_forget(&world->point_cache, DPT_NONE);
    dpti_persistent_contacts_reset(world);
    for (uint32_t i = 0; i < world->body_slot_end; i++) {
        world->bodies[i].moved_tick = world->bodies[i].added_tick = 0;
        world->bodies[i].motion_bound = 0.0;
        dpti_deform_reset(&world->bodies[i]);
    }
    world->bodies_moved_tick = world->bodies_put_tick = 0;
    world->body_motion_max = world->body_motion_before = 0.0;
    world->undone_segment = 0;
    world->last_channel_id = 0;
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
