/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A tick's motion is a leg: most are over at a look, as nothing was near. With a budget a leg may take several ticks; those
 * that come meanwhile wait in a voyage, each as it was. What that has no room for is given up.
 */
#include "world/motion_backlog.h"

#include "world/persistent_contacts.h"
#include "world/swept_motion.h"

/* A share of dpt_world_bytes. */
enum { BYTES_VOYAGE = 2112 };
typedef char voyage_fits[sizeof(struct voyage) <= BYTES_VOYAGE ? 1 : -1];

uint64_t dpti_backlog_bytes(const dpt_world_def *def)
{
    return def->budget ? BYTES_VOYAGE * (uint64_t)def->max_segments : 0;
}

char *dpti_backlog_place(struct dpt_world *world, char *at)
{
    world->voyages = (void *)at;
    return at + dpti_backlog_bytes(&world->def);
}

void dpti_backlog_forget(struct dpt_world *world, uint32_t segment)
{
    world->segments[segment].was.known = 0;
    if (world->def.budget)
        world->voyages[segment].count = world->voyages[segment].body = 0;
}

void dpti_backlog_restart(struct dpt_world *world)
{
    for (uint32_t s = 0; world->def.budget && s < world->segment_count; s++)
        world->voyages[s].body = 0;
}

void dpti_backlog_remove(struct dpt_world *world, uint32_t first, uint32_t end)
{
    if (world->def.budget)
        memmove(&world->voyages[first], &world->voyages[end],
                (world->segment_count - end) * sizeof *world->voyages);
}

/* What cannot be followed is as a teleport to where the segment is now. */
static void give_up(struct dpt_world *world, uint32_t index, struct voyage *voyage)
{
    voyage->count = voyage->body = 0;
    dpti_motion_no_sweep(&world->segments[index], DPT_SWEEP_NONE);
    dpti_contacts_forget_sides(world, index);
}

/* How far away is what any leg, and `now` if it is not NULL, may have met. */
static double reach_of(const struct segment *segment, const struct voyage *voyage,
                       const struct was *now)
{
    double reach = segment->radius;
    const struct was *last = &segment->was;
    for (uint32_t i = 0; i < voyage->count; last = &voyage->way[i++])
        reach += dpti_motion_between(last, &voyage->way[i]);
    return now ? reach + dpti_motion_between(last, now) : reach;
}

/* Bodies that have moved, or come, since the last tick: a leg past them is of this tick alone. */
static int meets_others(struct dpt_world *world, uint32_t index, double reach)
{
    struct around around = dpti_motion_around(world, index, reach);
    const struct body *body = dpti_motion_next_body(&around);
    while (body && body->moved != world->ticks && body->added != world->ticks)
        body = dpti_motion_next_body(&around);
    return body != NULL;
}

/* Legs that wait, before this tick's joins them: is the way known on which they are, and is there room for one more? */
static int is_followed(struct dpt_world *world, uint32_t index, const struct voyage *voyage,
                       const struct was *now)
{
    double reach = reach_of(&world->segments[index], voyage, now);
    return !voyage->lost && !meets_others(world, index, reach) &&
           (voyage->count < WAY_MOST || dpti_motion_is_same(&voyage->way[voyage->count - 1], now));
}

/* This tick's motion cannot have met anything. */
static int is_free(const struct dpt_world *world, const struct segment *segment, double reach)
{
    double moved = world->travelled_at == world->ticks ? world->travelled : 0.0;
    return segment->result.lower_bound > reach + moved + segment->result.error_bound;
}

/* Leg by leg, up to the first that meets something or the end of the budget. 0 unless that was all. */
static int take_legs(struct dpt_world *world, uint32_t index, struct voyage *voyage)
{
    struct segment *segment = &world->segments[index];
    while (voyage->count) {
        const uint32_t age = (uint32_t)world->ticks - voyage->way[0].tick;
        double reach = reach_of(segment, voyage, NULL);
        if (!dpti_motion_take_leg(world, index, dpti_motion_around(world, index, reach), voyage)) {
            dpti_motion_no_sweep(segment, DPT_SWEEP_UNFINISHED);
            segment->sweep.age = age;
            voyage->lost |= (uint32_t)meets_others(world, index, reach);
            return 0;
        }
        segment->sweep.age = age;
        segment->was = voyage->way[0];
        voyage->count--;
        memmove(voyage->way, voyage->way + 1, voyage->count * sizeof *voyage->way);
        if (segment->sweep.status == DPT_SWEEP_HIT)
            break;
    }
    return !voyage->count;
}

int dpti_travel_find(struct dpt_world *world, uint32_t index)
{
    struct segment *segment = &world->segments[index];
    struct voyage fresh, *voyage = world->def.budget ? &world->voyages[index] : &fresh;
    if (!world->def.budget || !segment->was.known)
        voyage->count = voyage->body = 0;
    if (!segment->was.known)
        return 1;
    struct was now = dpti_motion_place(world, segment);
    if (voyage->count && !is_followed(world, index, voyage, &now)) {
        give_up(world, index, voyage);
        return 1;
    }
    if (!voyage->count) {
        voyage->lost = 0;
        voyage->radius = segment->radius;
        if (segment->was.through)
            return 1;
        double reach = dpti_motion_between(&segment->was, &now) + segment->radius;
        segment->sweep.status = DPT_SWEEP_FREE;
        segment->sweep.time = 1.0;
        if (is_free(world, segment, reach))
            return 1;
    }
    if (!voyage->count || !dpti_motion_is_same(&voyage->way[voyage->count - 1], &now))
        voyage->count++;
    else
        now.tick = voyage->way[voyage->count - 1].tick;
    voyage->way[voyage->count - 1] = now; /* of the same place more may be known now */
    if (voyage->radius != segment->radius)
        voyage->body = 0;
    voyage->radius = segment->radius;
    return take_legs(world, index, voyage);
}

void dpti_travel_end(struct dpt_world *world, uint32_t index)
{
    if (!world->def.budget || !world->voyages[index].count)
        world->segments[index].was = dpti_motion_place(world, &world->segments[index]);
}
