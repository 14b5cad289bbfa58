/* SPDX-License-Identifier: BSD-3-Clause */
/* Trying a motion: the sweep of a tick, without the tick. The world stays as it is. */
#include "base/return_if_error.h"
#include "base/sized.h"
#include "hull/hull_sweep.h"
#include "proxy/proxy.h"
#include "track/swept_motion.h"
#include "track/tool_parts.h"
#include "world/world_members.h"

/* A motion that is tried. */
struct trial {
    const struct dpt_world *world;
    double clearance; /* m, added to each radius, which stays at least 0 */
    dpt_sweep first;  /* the first hit so far */
};

/* Sweep one segment past one body; a hit that is earlier than all so far becomes the first. */
static void try_body(struct trial *trial, const struct body *body, double radius, uint32_t segment_in_tool,
                     struct placement *from, struct placement *to)
{
    struct rigid_sweep_progress progress;
    rigid_sweep_restart(&progress);
    struct work work = work_of(WORK_UNLIMITED);
    struct rigid_sweep rigid = { .surface = &body->surface,
                                 .kernel = &trial->world->kernel,
                                 .radius = radius,
                                 .tolerance = 0.5 * RIGID_SWEEP_TOLERANCE * surface_diagonal(&body->surface),
                                 .hint = DPT_NONE,
                                 .work = &work,
                                 .progress = &progress };
    from->body = to->body = body->pose;
    if (dpti_rigid_sweep_find(&rigid, from, to) != SWEEP_HIT ||
        (trial->first.status == DPT_SWEEP_HIT && rigid.result.time >= trial->first.time))
        return;
    trial->first.segment = segment_in_tool;
    dpti_motion_write_sweep(&rigid, body, &trial->first);
    if (rigid.result.time == 0.0 && rigid.result.impact.pair.distance2 == 0.0)
        memset(trial->first.normal, 0, sizeof trial->first.normal);
}

/* Sweep one segment past all bodies that it may reach. `from` and `to`: the ends of the motion; sets their bodies. */
static void try_segment(struct trial *trial, const struct segment *segment, uint32_t segment_in_tool,
                        struct placement *from, struct placement *to)
{
    const struct dpt_world *world = trial->world;
    const double radius = max_of(0.0, segment->radius + trial->clearance);
    const double reach = radius + dpti_rigid_sweep_displacement(from, to);
    struct frame frame;
    frame_of_pose(&to->tool, &frame);
    const struct box box = box_of_axis(frame_to_world(&frame, to->a), frame_to_world(&frame, to->b));
    for (uint32_t i = 0; i < world->body_slot_end; i++)
        if (body_is_there(&world->bodies[i]) && box_distance(&box, &world->boxes[i]) <= reach)
            try_body(trial, &world->bodies[i], radius, segment_in_tool, from, to);
}

/* Where a tip that met a triangle is nearest to it, at the time of the touch. */
static void write_tip_touch(struct trial *trial, const struct hull_sweep *sweep, const struct body *body,
                            uint32_t number, const dpt_pose *pose)
{
    dpt_sweep *first = &trial->first;
    struct frame tool;
    struct hull_place place;
    struct hull_pair found;
    vec3 v[3];
    frame_of_pose(pose, &tool);
    hull_place_set(&place, sweep->hull, &tool, &body->frame);
    surface_corners(&body->surface, sweep->triangle, v);
    dpti_hull_triangle(&place, v, HUGE_VAL, &found);
    const vec3 q = surface_point(&body->surface, sweep->triangle, found.pair.weight);
    first->status = DPT_SWEEP_HIT;
    first->segment = number;
    first->body = body->id;
    first->triangle = body->surface.sources[sweep->triangle];
    first->time = sweep->time;
    first->s = 0.0;
    vec3_store(frame_to_world(&body->frame, q), first->q);
    vec3_store(frame_turn(&body->frame, unit_of(found.pair.gap)), first->normal);
}

/* Sweep one tip past all bodies that it may reach. `number`: after the tool's segments. */
static void try_tip(struct trial *trial, const struct tip *tip, uint32_t number, const dpt_pose *from,
                    const dpt_pose *to)
{
    const struct dpt_world *world = trial->world;
    const double reach =
        max_of(0.0, tip->hull->radius + trial->clearance) + dpti_hull_displacement(tip->hull, from, to);
    struct frame frame;
    frame_of_pose(to, &frame);
    const struct box box = dpti_tip_box(tip->hull, &frame);
    for (uint32_t i = 0; i < world->body_slot_end; i++) {
        const struct body *body = &world->bodies[i];
        if (!body_is_there(body) || box_distance(&box, &world->boxes[i]) > reach)
            continue;
        const struct placement at_from = { .tool = *from, .body = body->pose };
        const struct placement at_to = { .tool = *to, .body = body->pose };
        struct work work = work_of(WORK_UNLIMITED);
        struct hull_sweep sweep = { .surface = &body->surface,
                                    .kernel = &world->kernel,
                                    .hull = tip->hull,
                                    .clearance = trial->clearance,
                                    .tolerance = 0.5 * RIGID_SWEEP_TOLERANCE * surface_diagonal(&body->surface),
                                    .work = &work,
                                    .triangle = DPT_NONE };
        if (dpti_hull_sweep(&sweep, &at_from, &at_to) != SWEEP_HIT ||
            (trial->first.status == DPT_SWEEP_HIT && sweep.time >= trial->first.time))
            continue;
        const dpt_pose pose = dpti_rigid_sweep_pose(from, to, sweep.time);
        write_tip_touch(trial, &sweep, body, number, &pose);
    }
}

/* Check the arguments and set up a trial. Without a valid tool and valid bodies its `first` has DPT_SWEEP_NONE. */
static dpt_result begin_trial(struct trial *trial, const dpt_world *world, dpt_tool id, double clearance,
                              const dpt_sweep *first, const struct tool **tool)
{
    if (!world)
        return DPT_E_ARGUMENT;
    if (first)
        DPT_TRY(sized_check(first, sizeof *first, 0));
    *tool = world_find_tool(world, id);
    if (!*tool)
        return DPT_E_HANDLE;
    if (!within(clearance, DPT_COORDINATE_MAX))
        return DPT_E_FINITE;
    const int is_known = (*tool)->slot.valid && !world->invalid_body_count;
    *trial = (struct trial){
        .world = world,
        .clearance = clearance,
        .first = { .status = is_known ? DPT_SWEEP_FREE : DPT_SWEEP_NONE, .triangle = DPT_NONE, .time = is_known }
    };
    return DPT_OK;
}

/* Where a segment was last set: its ends and radius in a frame, and the pose of that. */
struct origin {
    dpt_pose pose;
    struct segment segment;
};

/* A free tool's are in the world, whatever frame its proxy keeps it in. */
static void find_origin(const struct dpt_world *world, const struct tool *tool, uint32_t segment_in_tool,
                        struct origin *origin)
{
    origin->pose = tool->pose;
    origin->segment = world->segments[tool->first_segment + segment_in_tool];
    if (!tool->is_free || !dpti_proxy_is_used(world, tool))
        return;
    const dpt_pose identity = DPT_POSE_IDENTITY;
    const dpt_segment given = dpti_proxy_given_segment(world, tool);
    origin->pose = identity;
    origin->segment.a = vec3_of(given.a);
    origin->segment.b = vec3_of(given.b);
    origin->segment.radius = given.radius;
}

/* Write the first hit to the caller, if it wants it. */
static void end_trial(const struct trial *trial, dpt_sweep *first)
{
    if (first)
        sized_write(first, first->size, &trial->first, sizeof trial->first);
}

dpt_result dpt_tool_try_pose(const dpt_world *world, dpt_tool tool, const dpt_pose *pose, double clearance,
                             dpt_sweep *first, dpt_pose *reached)
{
    struct trial trial;
    struct frame frame;
    struct origin origin;
    const struct tool *found;
    if (!pose)
        return DPT_E_ARGUMENT;
    DPT_TRY(begin_trial(&trial, world, tool, clearance, first, &found));
    DPT_TRY(frame_of_pose(pose, &frame));
    for (uint32_t i = 0; trial.first.status != DPT_SWEEP_NONE && i < found->segment_count; i++) {
        find_origin(world, found, i, &origin);
        const struct segment *segment = &origin.segment;
        struct placement from = { .tool = origin.pose, .a = segment->a, .b = segment->b };
        struct placement to = { .tool = *pose, .a = segment->a, .b = segment->b };
        try_segment(&trial, segment, i, &from, &to);
    }
    for (uint32_t i = 0; trial.first.status != DPT_SWEEP_NONE && i < found->tip_count; i++)
        try_tip(&trial, tool_tip(world, found, i), found->segment_count + i, &found->pose, pose);
    end_trial(&trial, first);
    find_origin(world, found, 0, &origin);
    if (reached)
        *reached = dpti_rigid_sweep_pose(&origin.pose, pose, trial.first.time);
    return DPT_OK;
}

dpt_result dpt_tool_try_segments(const dpt_world *world, dpt_tool tool, const dpt_segment *segments, uint32_t count,
                                 double clearance, dpt_sweep *first, dpt_segment *reached)
{
    struct trial trial;
    struct frame frame;
    struct origin origin;
    const struct tool *found;
    const dpt_pose identity = DPT_POSE_IDENTITY;
    if (!segments)
        return DPT_E_ARGUMENT;
    DPT_TRY(begin_trial(&trial, world, tool, clearance, first, &found));
    if (count != found->segment_count)
        return DPT_E_ARGUMENT;
    if (found->tip_count)
        return DPT_E_UNSUPPORTED;
    DPT_TRY(dpti_tool_check_segments(segments, count));
    find_origin(world, found, 0, &origin);
    frame_of_pose(&origin.pose, &frame);
    for (uint32_t i = 0; trial.first.status != DPT_SWEEP_NONE && i < count; i++) {
        find_origin(world, found, i, &origin);
        struct segment *segment = &origin.segment;
        struct placement from = { .tool = identity,
                                  .a = frame_to_world(&frame, segment->a),
                                  .b = frame_to_world(&frame, segment->b) };
        struct placement to = { .tool = identity, .a = vec3_of(segments[i].a), .b = vec3_of(segments[i].b) };
        segment->radius = segments[i].radius;
        try_segment(&trial, segment, i, &from, &to);
    }
    end_trial(&trial, first);
    for (uint32_t i = 0; reached && i < count; i++) {
        find_origin(world, found, i, &origin);
        const vec3 a = frame_to_world(&frame, origin.segment.a);
        const vec3 b = frame_to_world(&frame, origin.segment.b);
        const double time = trial.first.time;
        dpt_segment at = segments[i];
        if (time < 1.0) {
            vec3_store(along(a, time, sub(vec3_of(at.a), a)), at.a);
            vec3_store(along(b, time, sub(vec3_of(at.b), b)), at.b);
        }
        reached[i] = at;
    }
    return DPT_OK;
}
