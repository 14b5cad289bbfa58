/* SPDX-License-Identifier: BSD-3-Clause */
#include "track/swept_motion.h"

#include "track/body_search.h"
#include "track/persistent_contacts.h"

struct motion_state dpti_motion_state_now(const struct dpt_world *world, const struct segment *segment)
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

int dpti_motion_is_same(const struct motion_state *from, const struct motion_state *to)
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

/*
 * The two ends of a motion: by the tool's poses or, if the segment changed in the tool's frame, by its ends in the
 * world.
 */
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

double dpti_motion_displacement(const struct motion_state *previous, const struct motion_state *now)
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
                                 .hint = *world_last_triangles(world, segment_index, handle_index(body->id)),
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

const struct body *dpti_motion_next_body(struct swept_bodies *bodies)
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

struct swept_bodies dpti_motion_bodies(struct dpt_world *world, uint32_t segment_index, double reach)
{
    const struct dynamic_point *track = &world->segments[segment_index].answer.track;
    double body_motion = world_body_motion(world);
    return (struct swept_bodies){ .world = world,
                                  .axis_box = box_of_axis(track->axis.a, track->axis.b),
                                  .reach = reach,
                                  .near_bodies = dpti_broad_phase_within(world, segment_index, reach + body_motion) };
}

void dpti_motion_set_no_sweep(struct segment *segment, uint32_t status)
{
    segment->sweep = (dpt_sweep){
        .size = sizeof segment->sweep, .status = status, .segment = segment->sweep.segment, .triangle = DPT_NONE
    };
    segment->may_have_crossed |= status == DPT_SWEEP_NONE;
}

int dpti_motion_sweep_step(struct dpt_world *world, uint32_t segment_index, struct swept_bodies bodies,
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
    while (status == STEP_CONTINUES && (body = dpti_motion_next_body(&bodies))) {
        if (backlog->body_id && handle_index(body->id) < handle_index(backlog->body_id))
            continue;
        status = sweep_past_body(world, segment_index, body, backlog, &from, &to);
    }
    if (status != STEP_SUSPENDED)
        backlog->body_id = 0;
    if (status == STEP_BEGAN_TOUCHING)
        dpti_motion_set_no_sweep(segment, DPT_SWEEP_NONE);
    return status != STEP_SUSPENDED;
}
