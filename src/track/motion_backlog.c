/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The motion of one tick is a motion step. Most steps are done at once, because nothing is near. The sweep of a long
 * one may take several ticks, as its work in one tick is limited. Later steps wait in the backlog meanwhile, each with
 * its own ends; if there is no room for one more, all are given up.
 */
#include "track/motion_backlog.h"

#include "track/persistent_contacts.h"
#include "track/swept_motion.h"

/* A share of dpt_world_bytes. */
enum { BYTES_MOTION_BACKLOG = 2176 };
typedef char motion_backlog_fits[sizeof(struct motion_backlog) <= BYTES_MOTION_BACKLOG ? 1 : -1];

uint64_t dpti_backlog_bytes(const dpt_world_def *def)
{
    return BYTES_MOTION_BACKLOG * (uint64_t)def->max_segments;
}

char *dpti_backlog_place(struct dpt_world *world, char *at)
{
    world->motion_backlogs = (void *)at;
    return at + dpti_backlog_bytes(&world->def);
}

void dpti_backlog_forget(struct dpt_world *world, uint32_t segment_index)
{
    world->segments[segment_index].previous.is_known = 0;
    world->motion_backlogs[segment_index].count = world->motion_backlogs[segment_index].body_id = 0;
}

void dpti_backlog_restart(struct dpt_world *world)
{
    for (uint32_t s = 0; s < world->segment_count; s++)
        world->motion_backlogs[s].body_id = 0;
}

void dpti_backlog_remove(struct dpt_world *world, uint32_t first, uint32_t end)
{
    memmove(&world->motion_backlogs[first], &world->motion_backlogs[end],
            (world->segment_count - end) * sizeof *world->motion_backlogs);
}

/* Give up all steps, as if the tool had been teleported to where the segment is now. */
static void give_up(struct dpt_world *world, uint32_t segment_index, struct motion_backlog *backlog)
{
    backlog->count = backlog->body_id = 0;
    dpti_motion_set_no_sweep(&world->segments[segment_index], DPT_SWEEP_NONE);
    dpti_persistent_contacts_forget_sides(world, segment_index);
}

/*
 * m: how far from the segment, where it is now, the surface may be that any waiting step met. `now`, if not NULL,
 * adds the step from the last one to there.
 */
static double reach_of_steps(const struct segment *segment, const struct motion_backlog *backlog,
                             const struct motion_state *now)
{
    double reach = segment->radius;
    const struct motion_state *step_begin = &segment->previous;
    for (uint32_t i = 0; i < backlog->count; step_begin = &backlog->motion_ends[i++])
        reach += dpti_motion_displacement(step_begin, &backlog->motion_ends[i]);
    return now ? reach + dpti_motion_displacement(step_begin, now) : reach;
}

/*
 * Whether a body within `reach` (m) has moved or was added since the last tick. Such a body is known only where it is
 * now, so only this tick can sweep past it.
 */
static int may_meet_changed_body(struct dpt_world *world, uint32_t segment_index, double reach)
{
    struct swept_bodies bodies = dpti_motion_bodies(world, segment_index, reach);
    const struct body *body = dpti_motion_next_body(&bodies);
    while (body && body->moved_tick != world->ticks && body->added_tick != world->ticks)
        body = dpti_motion_next_body(&bodies);
    return body ? 1 : 0;
}

/* Before this tick's step joins the waiting ones: whether they can still be swept, and there is room for one more. */
static int can_follow(struct dpt_world *world, uint32_t segment_index, const struct motion_backlog *backlog,
                      const struct motion_state *now)
{
    double reach = reach_of_steps(&world->segments[segment_index], backlog, now);
    return !backlog->is_lost && !may_meet_changed_body(world, segment_index, reach) &&
           (backlog->count < MOTION_STEPS_MAX || dpti_motion_is_same(&backlog->motion_ends[backlog->count - 1], now));
}

/*
 * Whether every surface is too far away for this tick's motions to have met it. `reach`: the segment's motion plus
 * its radius, in m.
 */
static int is_far_from_all(const struct dpt_world *world, const struct segment *segment, double reach)
{
    double body_motion = world_body_motion(world);
    return segment->result.lower_bound > reach + body_motion + segment->result.error_bound;
}

/*
 * Sweep the steps in turn, until one hits or a budget ends. The sweep's own does not end it where only this tick can
 * sweep; the world's does, `limit`. Returns 1 if no step is left, else 0.
 */
static int sweep_steps(struct dpt_world *world, uint32_t segment_index, struct motion_backlog *backlog, uint32_t limit)
{
    struct segment *segment = &world->segments[segment_index];
    while (backlog->count) {
        const uint32_t age = (uint32_t)world->ticks - backlog->motion_ends[0].tick;
        double reach = reach_of_steps(segment, backlog, NULL);
        if (!dpti_motion_sweep_step(world, segment_index, dpti_motion_bodies(world, segment_index, reach), backlog)) {
            const int meets_changed = may_meet_changed_body(world, segment_index, reach);
            if (meets_changed && world->work.limit != limit) {
                world->work.limit = limit;
                continue;
            }
            dpti_motion_set_no_sweep(segment, DPT_SWEEP_UNFINISHED);
            segment->sweep.age = age;
            backlog->is_lost |= (uint32_t)meets_changed;
            return 0;
        }
        segment->sweep.age = age;
        segment->previous = backlog->motion_ends[0];
        backlog->count--;
        memmove(backlog->motion_ends, backlog->motion_ends + 1, backlog->count * sizeof *backlog->motion_ends);
        if (segment->sweep.status == DPT_SWEEP_HIT)
            break;
    }
    return !backlog->count;
}

int dpti_backlog_sweep(struct dpt_world *world, uint32_t segment_index)
{
    struct segment *segment = &world->segments[segment_index];
    struct motion_backlog *backlog = &world->motion_backlogs[segment_index];
    if (!segment->previous.is_known) {
        backlog->count = backlog->body_id = 0;
        return 1;
    }
    struct motion_state now = dpti_motion_state_now(world, segment);
    if (backlog->count && !can_follow(world, segment_index, backlog, &now)) {
        give_up(world, segment_index, backlog);
        return 1;
    }
    if (!backlog->count) {
        backlog->is_lost = 0;
        backlog->radius = segment->radius;
        if (segment->previous.is_crossing)
            return 1;
        double reach = dpti_motion_displacement(&segment->previous, &now) + segment->radius;
        segment->sweep.status = DPT_SWEEP_FREE;
        segment->sweep.time = 1.0;
        if (is_far_from_all(world, segment, reach))
            return 1;
    }
    if (!backlog->count || !dpti_motion_is_same(&backlog->motion_ends[backlog->count - 1], &now))
        backlog->count++;
    else
        now.tick = backlog->motion_ends[backlog->count - 1].tick;
    backlog->motion_ends[backlog->count - 1] = now; /* more may be known about the same place now */
    if (backlog->radius != segment->radius)
        backlog->body_id = 0;
    backlog->radius = segment->radius;
    /* Late is better than given up. */
    const int is_full = backlog->count == MOTION_STEPS_MAX;
    const struct work before = is_full ? world->work : world_begin_sweep(world);
    const int is_done = sweep_steps(world, segment_index, backlog, before.limit);
    world_end_sweep(world, &before);
    return is_done;
}

void dpti_backlog_end_tick(struct dpt_world *world, uint32_t segment_index)
{
    if (!world->motion_backlogs[segment_index].count)
        world->segments[segment_index].previous = dpti_motion_state_now(world, &world->segments[segment_index]);
}
