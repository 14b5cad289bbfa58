/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/world_layout.h"

#include "proxy/proxy_state.h"
#include "proxy/tool_loads.h"
#include "track/body_search.h"
#include "track/distance_bounds.h"
#include "track/motion_backlog.h"
#include "track/persistent_contacts.h"
#include "world/tool_strips.h"

/*
 * Shares of dpt_world_bytes. A struct that outgrows its share fails to compile. The rest of the block belongs to the
 * parts of the world, which state their own shares.
 */
enum {
    BYTES_WORLD = 24576, /* the world itself, with one distance profile */
    BYTES_BODY = 2048,   /* with its box */
    BYTES_TOOL = 512,
    BYTES_SEGMENT = 1920,
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

size_t dpti_world_layout_bytes(const dpt_world_def *def)
{
    uint64_t bytes = BYTES_WORLD + BYTES_BODY * (uint64_t)def->max_bodies + BYTES_TOOL * (uint64_t)def->max_tools +
                     BYTES_SEGMENT * (uint64_t)def->max_segments + (BYTES_TIP + BYTES_HULL) * (uint64_t)def->max_tips +
                     point_cache_bytes(def) + dpti_bounds_bytes(def) + dpti_backlog_bytes(def) +
                     dpti_persistent_contacts_bytes(def) + dpti_strips_bytes(def) + dpti_proxy_bytes(def) +
                     dpti_loads_bytes(def) + dpti_broad_phase_bytes(def) + dpti_body_search_bytes(def);
    return bytes <= SIZE_MAX ? (size_t)bytes : 0;
}

void dpti_world_layout_place(struct dpt_world *world)
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
    at = dpti_bounds_place(world, at);
    at = dpti_backlog_place(world, at);
    at = dpti_persistent_contacts_place(world, at);
    at = dpti_strips_place(world, at);
    at = dpti_proxy_place(world, at);
    at = dpti_loads_place(world, at);
    at = dpti_broad_phase_place(world, at);
    dpti_body_search_place(world, at);
}
