/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/distance_bounds.h"

/* Shares of dpt_world_bytes. */
enum { BYTES_PAUSE = 1536, BYTES_PROOF = 64 };
typedef char pause_fits[2 * sizeof(struct pause) <= BYTES_PAUSE ? 1 : -1];
typedef char proof_fits[sizeof(struct proof) <= BYTES_PROOF ? 1 : -1];

uint64_t dpti_bounds_bytes(const dpt_world_def *def)
{
    const uint64_t segments = def->max_segments;
    return def->budget ? (BYTES_PAUSE + BYTES_PROOF * (uint64_t)def->max_bodies) * segments : 0;
}

char *dpti_bounds_place(struct dpt_world *world, char *at)
{
    world->pauses = (void *)at;
    world->proofs = (void *)(at + BYTES_PAUSE * (size_t)world->def.max_segments);
    return at + dpti_bounds_bytes(&world->def);
}

void dpti_bounds_forget(struct dpt_world *world, uint32_t segment, uint32_t body)
{
    if (!world->def.budget)
        return;
    struct proof *proof = world_proof(world, segment, body == DPT_NONE ? 0 : body);
    memset(proof, 0, (body == DPT_NONE ? world->def.max_bodies : 1) * sizeof *proof);
    for (int rests = 0; rests < 2; rests++) {
        struct pause *pause = world_pause(world, segment, rests);
        if (body == DPT_NONE || pause->body == body)
            pause->walk.at = 0;
        if (body == DPT_NONE)
            pause->next = DPT_NONE;
    }
}

void dpti_bounds_remove(struct dpt_world *world, uint32_t first, uint32_t end)
{
    if (!world->def.budget)
        return;
    size_t moved = world->segment_count - end;
    memmove(world_pause(world, first, 0), world_pause(world, end, 0),
            moved * 2 * sizeof *world->pauses);
    memmove(world_proof(world, first, 0), world_proof(world, end, 0),
            moved * world->def.max_bodies * sizeof *world->proofs);
}

/* How far the ends moved, in the body's frame; exactly 0 for nothing. */
static double moved_since(const struct proof *proof, const struct axis *axis)
{
    vec3 b = add(axis->local_a, axis->u);
    double moved = larger(length(sub(axis->local_a, proof->a)), length(sub(b, proof->b)));
    return moved > 0.0 ? moved + axis->error : 0.0;
}

/* What a search that was stopped has proven, at the place where its body's proof was brought up to date. */
static double bounds_so_far(const struct pause *pause, const struct surface *surface,
                            const struct proof *proof)
{
    if (!pause->walk.at)
        return 0.0;
    return smaller(pause->floor,
                   dpti_walk_ahead(&pause->walk, surface, proof->a, sub(proof->b, proof->a)));
}

void dpti_bounds_give_up(struct dpt_world *world, uint32_t segment, struct pause *pause)
{
    struct proof *proof = world_proof(world, segment, pause->body);
    const struct surface *surface = &world->bodies[pause->body].surface;
    proof->floor = larger(proof->floor, bounds_so_far(pause, surface, proof));
    pause->walk.at = 0;
}

double dpti_bounds_update(struct dpt_world *world, uint32_t segment, uint32_t index,
                          const struct axis *axis)
{
    struct proof *proof = world_proof(world, segment, index);
    struct pause *moving = world_pause(world, segment, 0),
                 *resting = world_pause(world, segment, 1);
    double moved = moved_since(proof, axis);
    if (moved > 0.0 && resting->body == index && resting->walk.at)
        dpti_bounds_give_up(world, segment, resting);
    if (moved == 0.0)
        proof->rested = world->ticks;
    proof->floor = larger(0.0, proof->floor - moved);
    proof->a = axis->local_a;
    proof->b = add(axis->local_a, axis->u);
    if (moved > 0.0 && moving->body == index && moving->walk.at) {
        dpti_walk_drift(&moving->walk, &world->bodies[index].surface, moved);
        moving->floor -= moved;
    }
    return moved;
}

double dpti_bounds_proven(const struct dpt_world *world, uint32_t segment, uint32_t index)
{
    const struct proof *proof = world_proof(world, segment, index);
    double floor = proof->floor;
    for (int rests = 0; rests < 2; rests++) {
        const struct pause *pause = world_pause(world, segment, rests);
        if (pause->body == index)
            floor = larger(floor, bounds_so_far(pause, &world->bodies[index].surface, proof));
    }
    return floor;
}
