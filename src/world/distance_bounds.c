/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/distance_bounds.h"

/* Shares of dpt_world_bytes. */
enum { BYTES_PAUSE = 1536, BYTES_PROOF = 64 };
typedef char pause_fits[2 * sizeof(struct suspended_search) <= BYTES_PAUSE ? 1 : -1];
typedef char proof_fits[sizeof(struct distance_bound) <= BYTES_PROOF ? 1 : -1];

uint64_t dpti_bounds_bytes(const dpt_world_def *def)
{
    const uint64_t segments = def->max_segments;
    return def->budget ? (BYTES_PAUSE + BYTES_PROOF * (uint64_t)def->max_bodies) * segments : 0;
}

char *dpti_bounds_place(struct dpt_world *world, char *at)
{
    world->suspended_searches = (void *)at;
    world->distance_bounds = (void *)(at + BYTES_PAUSE * (size_t)world->def.max_segments);
    return at + dpti_bounds_bytes(&world->def);
}

void dpti_bounds_forget(struct dpt_world *world, uint32_t segment, uint32_t body)
{
    if (!world->def.budget)
        return;
    struct distance_bound *bound =
        world_distance_bound(world, segment, body == DPT_NONE ? 0 : body);
    memset(bound, 0, (body == DPT_NONE ? world->def.max_bodies : 1) * sizeof *bound);
    for (int rests = 0; rests < 2; rests++) {
        struct suspended_search *suspended = world_suspended_search(world, segment, rests);
        if (body == DPT_NONE || suspended->body == body)
            suspended->traversal.depth = 0;
        if (body == DPT_NONE)
            suspended->next = DPT_NONE;
    }
}

void dpti_bounds_remove(struct dpt_world *world, uint32_t first, uint32_t end)
{
    if (!world->def.budget)
        return;
    size_t moved = world->segment_count - end;
    memmove(world_suspended_search(world, first, 0), world_suspended_search(world, end, 0),
            moved * 2 * sizeof *world->suspended_searches);
    memmove(world_distance_bound(world, first, 0), world_distance_bound(world, end, 0),
            moved * world->def.max_bodies * sizeof *world->distance_bounds);
}

/* How far the ends moved, in the body's frame; exactly 0 for nothing. */
static double moved_since(const struct distance_bound *bound, const struct axis *axis)
{
    vec3 b = add(axis->local_a, axis->u);
    double moved = max_of(length(sub(axis->local_a, bound->a)), length(sub(b, bound->b)));
    return moved > 0.0 ? moved + axis->error : 0.0;
}

/* What a search that was stopped has proven, at the place where its body's proof was brought up to date. */
static double bounds_so_far(const struct suspended_search *suspended, const struct surface *surface,
                            const struct distance_bound *bound)
{
    if (!suspended->traversal.depth)
        return 0.0;
    return min_of(suspended->lower_bound,
                  dpti_bvh_unvisited_bound(&suspended->traversal, surface, bound->a,
                                           sub(bound->b, bound->a)));
}

void dpti_bounds_give_up(struct dpt_world *world, uint32_t segment,
                         struct suspended_search *suspended)
{
    struct distance_bound *bound = world_distance_bound(world, segment, suspended->body);
    const struct surface *surface = &world->bodies[suspended->body].surface;
    bound->lower_bound = max_of(bound->lower_bound, bounds_so_far(suspended, surface, bound));
    suspended->traversal.depth = 0;
}

double dpti_bounds_update(struct dpt_world *world, uint32_t segment, uint32_t index,
                          const struct axis *axis)
{
    struct distance_bound *bound = world_distance_bound(world, segment, index);
    struct suspended_search *moving = world_suspended_search(world, segment, 0),
                            *resting = world_suspended_search(world, segment, 1);
    double moved = moved_since(bound, axis);
    if (moved > 0.0 && resting->body == index && resting->traversal.depth)
        dpti_bounds_give_up(world, segment, resting);
    if (moved == 0.0)
        bound->rested = world->ticks;
    bound->lower_bound = max_of(0.0, bound->lower_bound - moved);
    bound->a = axis->local_a;
    bound->b = add(axis->local_a, axis->u);
    if (moved > 0.0 && moving->body == index && moving->traversal.depth) {
        dpti_bvh_weaken_bounds(&moving->traversal, &world->bodies[index].surface, moved);
        moving->lower_bound -= moved;
    }
    return moved;
}

double dpti_bounds_proven(const struct dpt_world *world, uint32_t segment, uint32_t index)
{
    const struct distance_bound *bound = world_distance_bound(world, segment, index);
    double floor = bound->lower_bound;
    for (int rests = 0; rests < 2; rests++) {
        const struct suspended_search *suspended = world_suspended_search(world, segment, rests);
        if (suspended->body == index)
            floor = max_of(floor, bounds_so_far(suspended, &world->bodies[index].surface, bound));
    }
    return floor;
}
