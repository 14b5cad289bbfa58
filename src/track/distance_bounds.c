/* SPDX-License-Identifier: BSD-3-Clause */
#include "track/distance_bounds.h"

/* Shares of dpt_world_bytes. */
enum { BYTES_SUSPENDED_SEARCHES = 1536, BYTES_DISTANCE_BOUND = 64 };
typedef char suspended_searches_fit[2 * sizeof(struct suspended_search) <= BYTES_SUSPENDED_SEARCHES ? 1 : -1];
typedef char distance_bound_fits[sizeof(struct distance_bound) <= BYTES_DISTANCE_BOUND ? 1 : -1];

uint64_t dpti_bounds_bytes(const dpt_world_def *def)
{
    const uint64_t segments = def->max_segments;
    return def->budget ? (BYTES_SUSPENDED_SEARCHES + BYTES_DISTANCE_BOUND * (uint64_t)def->max_bodies) * segments : 0;
}

char *dpti_bounds_place(struct dpt_world *world, char *at)
{
    world->suspended_searches = (void *)at;
    world->distance_bounds = (void *)(at + BYTES_SUSPENDED_SEARCHES * (size_t)world->def.max_segments);
    return at + dpti_bounds_bytes(&world->def);
}

void dpti_bounds_forget(struct dpt_world *world, uint32_t segment_index, uint32_t slot)
{
    if (!world->def.budget)
        return;
    struct distance_bound *bound = world_distance_bound(world, segment_index, slot == DPT_NONE ? 0 : slot);
    memset(bound, 0, (slot == DPT_NONE ? world->def.max_bodies : 1) * sizeof *bound);
    for (int is_resting = 0; is_resting < 2; is_resting++) {
        struct suspended_search *suspended = world_suspended_search(world, segment_index, is_resting);
        if (slot == DPT_NONE || suspended->body_slot == slot)
            suspended->traversal.level = 0;
        if (slot == DPT_NONE)
            suspended->next_slot = DPT_NONE;
    }
}

void dpti_bounds_remove(struct dpt_world *world, uint32_t first, uint32_t end)
{
    if (!world->def.budget)
        return;
    size_t segments_moved = world->segment_count - end;
    memmove(world_suspended_search(world, first, 0), world_suspended_search(world, end, 0),
            segments_moved * 2 * sizeof *world->suspended_searches);
    memmove(world_distance_bound(world, first, 0), world_distance_bound(world, end, 0),
            segments_moved * world->def.max_bodies * sizeof *world->distance_bounds);
}

/* m: motion of the axis' ends in the body's frame since the last update; exactly 0 at rest. */
static double motion_since(const struct distance_bound *bound, const struct axis *axis)
{
    vec3 b = add(axis->local_a, axis->u);
    double motion =
        max_of(length(sub(axis->local_a, bound->a)), length(sub(b, bound->b))) + (double)bound->surface_motion;
    return motion > 0.0 ? motion + axis->error : 0.0;
}

/* m: what a suspended search has proven about the axis at the last update of its body; 0 if none is suspended. */
static double bound_so_far(const struct suspended_search *suspended, const struct surface *surface,
                           const struct distance_bound *bound)
{
    if (!suspended->traversal.level)
        return 0.0;
    return min_of(suspended->lower_bound,
                  dpti_bvh_unvisited_bound(&suspended->traversal, surface, bound->a, sub(bound->b, bound->a)));
}

void dpti_bounds_note_motion(struct dpt_world *world, uint32_t segment_index, uint32_t slot, double moved)
{
    if (!world->def.budget)
        return;
    struct distance_bound *bound = world_distance_bound(world, segment_index, slot);
    bound->surface_motion = (1.0f + 0x1p-22f) * (bound->surface_motion + (float)moved);
}

void dpti_bounds_give_up(struct dpt_world *world, uint32_t segment_index, struct suspended_search *suspended)
{
    struct distance_bound *bound = world_distance_bound(world, segment_index, suspended->body_slot);
    const struct surface *surface = &world->bodies[suspended->body_slot].surface;
    bound->lower_bound = max_of(bound->lower_bound, bound_so_far(suspended, surface, bound));
    suspended->traversal.level = 0;
}

double dpti_bounds_update(struct dpt_world *world, uint32_t segment_index, uint32_t slot, const struct axis *axis)
{
    struct distance_bound *bound = world_distance_bound(world, segment_index, slot);
    struct suspended_search *moving = world_suspended_search(world, segment_index, 0),
                            *resting = world_suspended_search(world, segment_index, 1);
    double motion = motion_since(bound, axis);
    if (motion > 0.0 && resting->body_slot == slot && resting->traversal.level)
        dpti_bounds_give_up(world, segment_index, resting);
    if (motion == 0.0)
        bound->rest_tick = world->ticks;
    bound->lower_bound = max_of(0.0, bound->lower_bound - motion);
    bound->surface_motion = 0.0f;
    bound->a = axis->local_a;
    bound->b = add(axis->local_a, axis->u);
    if (motion > 0.0 && moving->body_slot == slot && moving->traversal.level) {
        dpti_bvh_weaken_bounds(&moving->traversal, &world->bodies[slot].surface, motion);
        moving->lower_bound -= motion;
    }
    return motion;
}

double dpti_bounds_proven(const struct dpt_world *world, uint32_t segment_index, uint32_t slot)
{
    const struct distance_bound *bound = world_distance_bound(world, segment_index, slot);
    double lower_bound = bound->lower_bound;
    for (int is_resting = 0; is_resting < 2; is_resting++) {
        const struct suspended_search *suspended = world_suspended_search(world, segment_index, is_resting);
        if (suspended->body_slot == slot)
            lower_bound = max_of(lower_bound, bound_so_far(suspended, &world->bodies[slot].surface, bound));
    }
    return lower_bound;
}
