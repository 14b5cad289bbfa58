/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The motion of one tick is a motion step. Most steps are done at once, because nothing is near. The sweep of a long
 * one may take several ticks, as its work in one tick is limited. Later steps wait in the backlog meanwhile, each with
 * its own ends; if there is no room for one more, all are given up.
 */
#include "track/swept_motion.h"

#include "track/body_search.h"
#include "track/persistent_contacts.h"

/* Where a segment is now, and what this tick knows of it there. */
static struct motion_state state_now(const struct dpt_world *world, const struct segment *segment)
{
    const struct tool *tool = &world->tools[segment->tool_slot];
    const struct segment_result *result = &segment->result;
    const dpt_pose identity = DPT_POSE_IDENTITY;
    double min_distance = segment->answer.is_exact ? result->lower_bound : result->distance;
    return (struct motion_state){ .pose = tool->is_free ? identity : tool->pose,
                                  .a = segment->a,
                                  .b = segment->b,
                                  .free_distance = result->lower_bound,
                                  .is_known = segment->answer.body ? 1 : 0,
                                  .is_crossing = min_distance == 0.0,
                                  .tick = (uint32_t)world->ticks };
}

/* m: how far the ends differ in the tool's frame; 0 unless the tool is free or its segments were set anew. */
static double change_in_tool_frame(const struct motion_state *from, const struct motion_state *to)
{
    return length(sub(from->a, to->a)) + length(sub(from->b, to->b));
}

/* Whether two states are at exactly the same place. */
static int is_same_place(const struct motion_state *from, const struct motion_state *to)
{
    return change_in_tool_frame(from, to) == 0.0 && pose_is_same(&from->pose, &to->pose);
}

/* The same segment, with its ends in the world and the identity as the tool's pose. */
static struct placement placement_in_world(const struct motion_state *previous)
{
    const dpt_pose identity = DPT_POSE_IDENTITY;
    struct frame frame;
    frame_of_pose(&previous->pose, &frame);
    return (struct placement){ .tool = identity,
                               .a = frame_to_world(&frame, previous->a),
                               .b = frame_to_world(&frame, previous->b) };
}

/* A motion's ends: by the tool's poses or, if the segment changed in the tool's frame, by its ends in the world. */
static void placements_of(const struct motion_state *previous, const struct motion_state *now, struct placement *from,
                          struct placement *to)
{
    *from = (struct placement){ .tool = previous->pose, .a = previous->a, .b = previous->b };
    *to = (struct placement){ .tool = now->pose, .a = now->a, .b = now->b };
    if (change_in_tool_frame(previous, now) == 0.0)
        return;
    *from = placement_in_world(previous);
    *to = placement_in_world(now);
}

/* m: no point of the segment is farther from where it ends up than this, at any time of the motion. */
static double displacement_of(const struct motion_state *previous, const struct motion_state *now)
{
    struct placement from, to;
    placements_of(previous, now, &from, &to);
    return dpti_rigid_sweep_displacement(&from, &to);
}

void dpti_motion_write_sweep(const struct rigid_sweep *rigid, const struct body *body, dpt_sweep *sweep)
{
    const struct impact *impact = &rigid->result.impact;
    const struct surface *surface = rigid->surface;
    int side = dpti_rigid_sweep_side_before(rigid);
    vec3 normal = dpti_surface_feature_normal(surface, impact->triangle, impact->pair.weight);
    double normal_length = length(normal);
    sweep->status = DPT_SWEEP_HIT;
    sweep->time = rigid->result.time;
    sweep->body = body->id;
    sweep->triangle = surface->sources[impact->triangle];
    sweep->s = impact->pair.s;
    vec3_store(frame_to_world(&body->frame, impact->q), sweep->q);
    vec3_store(scaled(frame_turn(&body->frame, normal), normal_length > 0.0 ? side / normal_length : 0.0),
               sweep->normal);
}

/* If the axis came through an open sheet, off its border, store the side from which it came. */
static void put_sheet_side(struct dpt_world *world, uint32_t segment_index, const struct body *body,
                           const struct rigid_sweep *rigid)
{
    const struct impact *impact = &rigid->result.impact;
    uint32_t part = surface_part(rigid->surface, impact->triangle);
    const struct warm_start warm_start = { impact->pair.s, impact->triangle, 1.0f };
    if (dpti_side_is_sheet(rigid->surface, part) &&
        !dpti_side_is_border(rigid->surface, impact->triangle, impact->pair.weight))
        dpti_persistent_contacts_put_side(world, segment_index, body, part, dpti_rigid_sweep_side_before(rigid),
                                          &warm_start);
}

/* Begin or continue a sweep past one body, unless the work is spent. Returns SWEEP_... */
static int continue_sweep(struct rigid_sweep *rigid, const struct placement *from, const struct placement *to)
{
    return work_is_spent(rigid->work) ? SWEEP_UNFINISHED : dpti_rigid_sweep_find(rigid, from, to);
}

/* Begin a body anew: with the tool's surface or, if `on_axis`, with the axis. */
static void begin_sweep(struct motion_backlog *backlog, uint32_t on_axis)
{
    backlog->is_on_axis = on_axis;
    rigid_sweep_restart(&backlog->progress);
}

/* How the sweep of one body, or of a motion step, ended. */
enum { STEP_SUSPENDED, STEP_CONTINUES, STEP_BEGAN_TOUCHING };

/* Store where the budget ended the step. */
static int suspend(struct segment *segment, struct motion_backlog *backlog, const struct body *body)
{
    backlog->body_id = body->id;
    backlog->sweep = segment->sweep;
    backlog->may_have_crossed = segment->may_have_crossed;
    return STEP_SUSPENDED;
}

/*
 * Sweep a motion step past one body. A hit before segment->sweep.time replaces the sweep; segment->may_have_crossed
 * is set if the axis went through. Returns STEP_...
 */
static int sweep_past_body(struct dpt_world *world, uint32_t segment_index, const struct body *body,
                           struct motion_backlog *backlog, struct placement *from, struct placement *to)
{
    struct segment *segment = &world->segments[segment_index];
    double free_distance = body->added_tick == world->ticks ? 0.0 : segment->previous.free_distance;
    struct rigid_sweep rigid = { .surface = &body->surface,
                                 .kernel = &world->kernel,
                                 .radius = free_distance > segment->radius ? segment->radius : 0.0,
                                 .distance_before = free_distance,
                                 .tolerance = 0.5 * RIGID_SWEEP_TOLERANCE * surface_diagonal(&body->surface),
                                 .hint = *world_last_triangle(world, segment_index, handle_index(body->id)),
                                 .tick = body_has_moved(world, body) && surface_has_moved(&body->surface, world->ticks)
                                             ? world->ticks
                                             : 0,
                                 .work = &world->work,
                                 .progress = &backlog->progress };
    from->body = body->moved_tick == world->ticks ? body->previous_pose : body->pose;
    to->body = body->pose;
    if (backlog->body_id != body->id) {
        if (dpti_rigid_sweep_cannot_meet(&rigid, from, to, backlog->motion_ends[0].free_distance))
            return STEP_CONTINUES;
        begin_sweep(backlog, 0);
    }
    int status = SWEEP_HIT;
    if (backlog->is_on_axis)
        rigid.result = backlog->surface_result;
    else
        status = continue_sweep(&rigid, from, to);
    if (status == SWEEP_FREE)
        return STEP_CONTINUES;
    if (status == SWEEP_UNFINISHED)
        return suspend(segment, backlog, body);
    if (dpti_rigid_sweep_began_touching(&rigid))
        return STEP_BEGAN_TOUCHING;
    struct rigid_sweep axis_sweep = rigid;
    axis_sweep.radius = 0.0;
    if (rigid.radius > 0.0) {
        backlog->surface_result = rigid.result;
        if (!backlog->is_on_axis)
            begin_sweep(backlog, 1);
        status = continue_sweep(&axis_sweep, from, to);
    }
    if (status == SWEEP_UNFINISHED)
        return suspend(segment, backlog, body);
    if (rigid.result.time < segment->sweep.time)
        dpti_motion_write_sweep(&rigid, body, &segment->sweep);
    if (status == SWEEP_HIT) {
        segment->may_have_crossed = 1;
        put_sheet_side(world, segment_index, body, &axis_sweep);
    }
    return STEP_CONTINUES;
}

/* Goes through the bodies that a motion may have met, in the order of their slots. */
struct swept_bodies {
    const struct dpt_world *world;
    struct box axis_box; /* of the axis where it is now, in the world */
    double reach;        /* m */
    const struct near_bodies *near_bodies;
    uint32_t next; /* index in near_bodies */
};

/* The next of them, or NULL. */
static const struct body *next_body(struct swept_bodies *bodies)
{
    const struct dpt_world *world = bodies->world;
    while (bodies->next < bodies->near_bodies->count) {
        uint32_t slot = bodies->near_bodies->slots ? bodies->near_bodies->slots[bodies->next] : bodies->next;
        const struct body *body = &world->bodies[slot];
        double body_motion = body->moved_tick == world->ticks ? body->motion_bound : 0.0;
        bodies->next++;
        if (body_is_there(body) && box_distance(&bodies->axis_box, &world->boxes[slot]) <= bodies->reach + body_motion)
            return body;
    }
    return NULL;
}

/* The bodies within `reach` (m) of a segment where it is now, or that may have come within it by their own motion. */
static struct swept_bodies bodies_within(struct dpt_world *world, uint32_t segment_index, double reach)
{
    const struct dynamic_point *track = &world->segments[segment_index].answer.track;
    double body_motion = world_body_motion(world);
    return (struct swept_bodies){ .world = world,
                                  .axis_box = box_of_axis(track->axis.a, track->axis.b),
                                  .reach = reach,
                                  .near_bodies = dpti_broad_phase_within(world, segment_index, reach + body_motion) };
}

/*
 * Reset a segment's sweep to one without a hit; status: DPT_SWEEP_... With DPT_SWEEP_NONE the axis may have crossed.
 */
static void set_no_sweep(struct segment *segment, uint32_t status)
{
    segment->sweep = (dpt_sweep){
        .size = sizeof segment->sweep, .status = status, .segment = segment->sweep.segment, .triangle = DPT_NONE
    };
    segment->may_have_crossed |= status == DPT_SWEEP_NONE;
}

/* Sweep the first step of the backlog past `bodies`, from its beginning or where the budget ended it. Returns 0 if the
 * budget ends it again, else 1. */
static int sweep_step(struct dpt_world *world, uint32_t segment_index, struct swept_bodies bodies,
                      struct motion_backlog *backlog)
{
    struct segment *segment = &world->segments[segment_index];
    struct placement from, to;
    const struct body *body;
    placements_of(&segment->previous, &backlog->motion_ends[0], &from, &to);
    segment->sweep.status = DPT_SWEEP_FREE;
    segment->sweep.time = 1.0;
    if (backlog->body_id) {
        segment->sweep = backlog->sweep;
        segment->may_have_crossed |= backlog->may_have_crossed;
    }
    int status = STEP_CONTINUES;
    while (status == STEP_CONTINUES && (body = next_body(&bodies))) {
        if (backlog->body_id && handle_index(body->id) < handle_index(backlog->body_id))
            continue;
        status = sweep_past_body(world, segment_index, body, backlog, &from, &to);
    }
    if (status != STEP_SUSPENDED)
        backlog->body_id = 0;
    if (status == STEP_BEGAN_TOUCHING)
        set_no_sweep(segment, DPT_SWEEP_NONE);
    return status != STEP_SUSPENDED;
}

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
    set_no_sweep(&world->segments[segment_index], DPT_SWEEP_NONE);
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
        reach += displacement_of(step_begin, &backlog->motion_ends[i]);
    return now ? reach + displacement_of(step_begin, now) : reach;
}

/*
 * Whether a body within `reach` (m) has moved or was added since the last tick. Such a body is known only where it is
 * now, so only this tick can sweep past it.
 */
static int may_meet_changed_body(struct dpt_world *world, uint32_t segment_index, double reach)
{
    struct swept_bodies bodies = bodies_within(world, segment_index, reach);
    const struct body *body = next_body(&bodies);
    while (body && body->moved_tick != world->ticks && body->added_tick != world->ticks)
        body = next_body(&bodies);
    return body ? 1 : 0;
}

/* Before this tick's step joins the waiting ones: whether they can still be swept, and there is room for one more. */
static int can_follow(struct dpt_world *world, uint32_t segment_index, const struct motion_backlog *backlog,
                      const struct motion_state *now)
{
    double reach = reach_of_steps(&world->segments[segment_index], backlog, now);
    return !backlog->is_lost && !may_meet_changed_body(world, segment_index, reach) &&
           (backlog->count < MOTION_STEPS_MAX || is_same_place(&backlog->motion_ends[backlog->count - 1], now));
}

/* Whether no surface can have been met in this tick. `reach`: the segment's motion plus its radius, in m. */
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
        if (!sweep_step(world, segment_index, bodies_within(world, segment_index, reach), backlog)) {
            const int meets_changed = may_meet_changed_body(world, segment_index, reach);
            if (meets_changed && world->work.limit != limit) {
                world->work.limit = limit;
                continue;
            }
            set_no_sweep(segment, DPT_SWEEP_UNFINISHED);
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
    struct motion_state now = state_now(world, segment);
    if (backlog->count && !can_follow(world, segment_index, backlog, &now)) {
        give_up(world, segment_index, backlog);
        return 1;
    }
    if (!backlog->count) {
        backlog->is_lost = 0;
        backlog->radius = segment->radius;
        if (segment->previous.is_crossing)
            return 1;
        double reach = displacement_of(&segment->previous, &now) + segment->radius;
        segment->sweep.status = DPT_SWEEP_FREE;
        segment->sweep.time = 1.0;
        if (is_far_from_all(world, segment, reach))
            return 1;
    }
    if (!backlog->count || !is_same_place(&backlog->motion_ends[backlog->count - 1], &now))
        backlog->count++;
    else
        now.tick = backlog->motion_ends[backlog->count - 1].tick;
    backlog->motion_ends[backlog->count - 1] = now; /* more may be known about the same place now */
    if (backlog->radius != segment->radius)
        backlog->body_id = 0;
    backlog->radius = segment->radius;
    /* A full backlog may take all work of the tick: to be late is better than to give up. */
    const int is_full = backlog->count == MOTION_STEPS_MAX;
    const struct work before = is_full ? world->work : world_begin_sweep(world);
    const int is_done = sweep_steps(world, segment_index, backlog, before.limit);
    world_end_sweep(world, &before);
    return is_done;
}

void dpti_backlog_end_tick(struct dpt_world *world, uint32_t segment_index)
{
    if (!world->motion_backlogs[segment_index].count)
        world->segments[segment_index].previous = state_now(world, &world->segments[segment_index]);
}
