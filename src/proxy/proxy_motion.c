/* SPDX-License-Identifier: BSD-3-Clause */
#include "proxy/proxy_motion.h"

#include "hull/hull_sweep.h"
#include "insertion/world_channels.h"
#include "proxy/proxy.h"
#include "proxy/proxy_constraints.h"
#include "proxy/proxy_friction.h"
#include "track/body_search.h"
#include "track/tool_parts.h"

/* The most times that a move that comes too near is shortened: first a little, then more. */
enum { SHORTEN_LITTLE = 4, SHORTEN_MAX = 12 };
#define SHORTER_LITTLE 0.9
#define SHORTER        0.7

void dpti_proxy_find_nearest(struct proxy_tick *tick)
{
    struct dpt_world *world = tick->world;
    tick->tool->felt_frame = tick->at.frame;
    tick->is_lost = 0;
    tick->gap = HUGE_VAL;
    if (far_is_used(world, tick->tool))
        dpti_track_near(world, tick->tool, tick->proxy->state == PROXY_OUTSIDE);
    else
        for (uint32_t i = 0; i < tick->tool->segment_count; i++)
            dpti_track_segment(world, tick->tool->first_segment + i);
    dpti_tips_track(world, tick->tool);
    for (uint32_t i = 0; i < tool_part_count(tick->tool); i++) {
        const struct part part = tool_part(world, tick->tool, i);
        const struct part_nearest nearest = part_nearest(part);
        const double distance = nearest.is_exact ? nearest.distance : nearest.lower_bound;
        if (nearest.body)
            tick->gap = min_of(tick->gap, distance - part_radius(part));
    }
}

/*
 * The directions from the tool to a body at the contacts that hold it there. While tick->is_before there are none, as
 * the body was elsewhere.
 */
static uint32_t list_directions(const struct proxy_tick *tick, const struct body *body,
                                vec3 directions[SWEEP_DIRECTIONS_MAX])
{
    uint32_t count = 0;
    for (uint32_t k = 0; k < tick->solved.active_count && !tick->is_before; k++) {
        const uint32_t space = tick->solved.active[k];
        if (tick->triangles[tick->sources[space].triangle].body_id == body->id && count < SWEEP_DIRECTIONS_MAX)
            directions[count++] = scaled(frame_turn_back(&body->frame, vec3_of(tick->spaces[space].normal)), -1.0);
    }
    return count;
}

/* Whether a body is there that may be within reach of a box, m, at any time of its motion. */
static int is_in_reach(const struct proxy_tick *tick, uint32_t slot, const struct box *box, double reach)
{
    const struct dpt_world *world = tick->world;
    const struct body *body = &world->bodies[slot];
    const double moved = tick->is_before && body_has_moved(world, body) ? body->motion_bound : 0.0;
    return body_is_there(body) && box_distance(box, &world->boxes[slot]) <= reach + moved;
}

/* Note the sweep of one segment or tip past one body, and remember what was hit. */
static void note_sweep(struct proxy_tick *tick, uint32_t number, const struct body *body, int status, double time,
                       uint32_t triangle, struct tool_sweep *sweep)
{
    if (status == SWEEP_HIT) {
        dpti_proxy_remember(tick->proxy, number, body->id, triangle);
        if (!sweep->body_id || time < sweep->time) {
            sweep->body_id = body->id;
            sweep->triangle = triangle;
        }
    }
    if (status != SWEEP_FREE)
        sweep->time = min_of(sweep->time, time);
    if (status != SWEEP_FREE && sweep->status != SWEEP_UNFINISHED)
        sweep->status = status;
}

/* Sweep one segment past one body. */
static void sweep_body(struct proxy_tick *tick, uint32_t number, const struct body *body, const dpt_pose *to,
                       struct tool_sweep *sweep)
{
    struct dpt_world *world = tick->world;
    const uint32_t index = tick->tool->first_segment + number;
    const struct segment *segment = &world->segments[index];
    const int has_moved = tick->is_before && body_has_moved(world, body);
    const double scale = min_of(body->diagonal, PROXY_SCALE_MAX);
    struct placement from_place = { tick->at.pose, dpti_proxy_body_pose(tick, body), segment->a, segment->b };
    struct placement to_place = { *to, body->pose, segment->a, segment->b };
    struct rigid_sweep_progress progress;
    vec3 directions[SWEEP_DIRECTIONS_MAX];
    rigid_sweep_restart(&progress);
    struct rigid_sweep rigid = {
        .surface = &body->surface,
        .kernel = &world->kernel,
        .radius = (1.0 - tick->dented) * segment->radius,
        .distance_before = tick->is_lost || body->added_tick == world->ticks ? 0.0 : segment->result.lower_bound,
        .tolerance = 0.5 * RIGID_SWEEP_TOLERANCE * scale,
        .hint = *world_last_triangle(world, index, handle_index(body->id)),
        .tick = has_moved && surface_has_moved(&body->surface, world->ticks) ? world->ticks : 0,
        .tick_from = tick->time,
        .directions = directions,
        .work = &world->work,
        .progress = &progress
    };
    if (dpti_rigid_sweep_cannot_meet(&rigid, &from_place, &to_place, 0.0))
        return;
    rigid.direction_count = list_directions(tick, body, directions);
    const int status =
        work_is_spent(&world->work) ? SWEEP_UNFINISHED : dpti_rigid_sweep_find(&rigid, &from_place, &to_place);
    const double free_until = status == SWEEP_HIT ? rigid.result.time : max_of(rigid.result.time, progress.free_until);
    note_sweep(tick, number, body, status, free_until, rigid.result.impact.triangle, sweep);
}

/* As a share of the motion: one that meets something is shortened by more than that anyway. */
#define TIP_RESOLUTION 0.03

/* Sweep one tip past one body. */
static void sweep_tip(struct proxy_tick *tick, uint32_t number, const struct body *body, const dpt_pose *to,
                      struct tool_sweep *sweep)
{
    struct dpt_world *world = tick->world;
    const struct tip *tip = tool_tip(world, tick->tool, number - tick->tool->segment_count);
    const int has_moved = tick->is_before && body_has_moved(world, body);
    const struct placement from_place = { .tool = tick->at.pose, .body = dpti_proxy_body_pose(tick, body) };
    const struct placement to_place = { .tool = *to, .body = body->pose };
    vec3 directions[SWEEP_DIRECTIONS_MAX];
    struct hull_sweep hull = { .surface = &body->surface,
                               .kernel = &world->kernel,
                               .hull = tip->hull,
                               .tolerance = 0.5 * RIGID_SWEEP_TOLERANCE * min_of(body->diagonal, PROXY_SCALE_MAX),
                               .resolution = TIP_RESOLUTION,
                               .tick = has_moved && surface_has_moved(&body->surface, world->ticks) ? world->ticks : 0,
                               .tick_from = tick->time,
                               .directions = directions,
                               .direction_count = list_directions(tick, body, directions),
                               .work = &world->work,
                               .triangle = body->id == tip->last_body_id ? tip->last_triangle : DPT_NONE };
    const int status = dpti_hull_sweep(&hull, &from_place, &to_place);
    note_sweep(tick, number, body, status, hull.time, hull.triangle, sweep);
}

/* m: no point of a part moves farther on the way to a pose. */
static double part_motion(const struct proxy_tick *tick, struct part part, const struct proxy_pose *to)
{
    const struct segment *segment = part.segment;
    if (part.tip)
        return dpti_hull_displacement(part.tip->hull, &to->pose, &tick->at.pose);
    const vec3 a = frame_to_world(&tick->at.frame, segment->a), b = frame_to_world(&tick->at.frame, segment->b);
    const vec3 to_a = frame_to_world(&to->frame, segment->a), to_b = frame_to_world(&to->frame, segment->b);
    /* An arc is longer than its chord, for the turns that are made by at most a tenth. */
    return 1.1 * max_of(length(sub(to_a, a)), length(sub(to_b, b)));
}

/* Sweep one part past all bodies that it may meet, except the one in the slot `carrier`. */
static void sweep_part(struct proxy_tick *tick, uint32_t number, const struct proxy_pose *to, uint32_t carrier,
                       struct tool_sweep *sweep)
{
    struct dpt_world *world = tick->world;
    const struct part part = tool_part(world, tick->tool, number);
    const double radius = part_radius(part), moved = part_motion(tick, part, to);
    const double known = tick->is_lost ? 0.0 : part_nearest(part).lower_bound - radius;
    const double reach = radius + moved + tick->clearance;
    if (max_of(tick->gap, known) > moved + tick->clearance && !tick->is_before)
        return;
    const struct box box = dpti_part_box(part, &tick->at.frame);
    /* For tips, and for a search that was last elsewhere, as its list does not hold here. */
    const struct near_bodies all = { .count = world->body_slot_end }, *nearby = &all;
    near_bodies_forget(&world->near_bodies);
    if (part.segment && !tick->is_lost)
        nearby = dpti_broad_phase_within(world, tick->tool->first_segment + number,
                                         reach + (tick->is_before ? world_body_motion(world) : 0.0));
    for (uint32_t k = 0; k < nearby->count; k++) {
        const uint32_t slot = nearby->slots ? nearby->slots[k] : k;
        if (slot == carrier || !is_in_reach(tick, slot, &box, reach) ||
            (world->channels && dpti_is_inserted_in(world, tick->tool, world->bodies[slot].id)))
            continue;
        sweep->is_alone = 0;
        if (part.tip)
            sweep_tip(tick, number, &world->bodies[slot], &to->pose, sweep);
        else
            sweep_body(tick, number, &world->bodies[slot], &to->pose, sweep);
    }
}

/* Sweep the whole tool, likewise. */
static struct tool_sweep sweep_tool(struct proxy_tick *tick, const struct proxy_pose *to, uint32_t carrier)
{
    struct dpt_world *world = tick->world;
    struct tool_sweep sweep = { .status = SWEEP_FREE, .time = 1.0, .is_alone = 1 };
    /* The shortest motion has all work of the tick: no shorter one would be tried instead. */
    const int is_limited = !tick->is_before && tick->proxy->trust > tick->clearance;
    const struct work before = is_limited ? world_begin_sweep(world) : world->work;
    for (uint32_t i = 0; i < tool_part_count(tick->tool); i++)
        sweep_part(tick, i, to, carrier, &sweep);
    world_end_sweep(world, &before);
    return sweep;
}

struct tool_sweep dpti_proxy_sweep(struct proxy_tick *tick, const struct proxy_pose *to)
{
    return sweep_tool(tick, to, DPT_NONE);
}

/*
 * Whether the gap is large enough, or no smaller than before: with a new body the required gap may be larger than the
 * one there is. If it is not, the triangles that are too near are remembered.
 */
static int has_room(struct proxy_tick *tick, double gap_before)
{
    if (tick->gap >= min_of(tick->min_gap, gap_before) - tick->spare)
        return 1;
    for (uint32_t i = 0; i < tool_part_count(tick->tool); i++) {
        const struct part part = tool_part(tick->world, tick->tool, i);
        const struct part_nearest nearest = part_nearest(part);
        if (nearest.body && nearest.triangle != DPT_NONE && nearest.distance - part_radius(part) < tick->clearance)
            dpti_proxy_remember(tick->proxy, i, nearest.body->id, nearest.triangle);
    }
    return 0;
}

/* The minimum gap of the remembered triangles while bodies move: at a share of what is left of the bodies' motion. */
static double gap_with_bodies(struct proxy_tick *tick, const struct proxy_pose *pose, double share)
{
    const double time = tick->time;
    tick->time += share * (1.0 - time);
    const double gap = dpti_proxy_gap_of_remembered(tick, pose, tick->min_gap);
    tick->time = time;
    return gap;
}

/* As shares of the time of the first touch: so far a motion goes while bodies move, if enough gap is left there. */
static const double before_touch[] = { 0.9, 0.5 };

/* Make a motion up to shortly before the first touch, together with the bodies' motion. Returns the share. */
static double move_with_bodies(struct proxy_tick *tick, const struct proxy_pose *to, double met)
{
    for (size_t k = 0; k < sizeof before_touch / sizeof *before_touch; k++) {
        const double share = before_touch[k] * met;
        const dpt_pose pose = dpti_rigid_sweep_pose(&tick->at.pose, &to->pose, share);
        const struct proxy_pose shorter = dpti_proxy_pose_of(tick->proxy, &pose);
        if (!(gap_with_bodies(tick, &shorter, share) >= tick->min_gap))
            continue;
        tick->at = shorter;
        tick->time += share * (1.0 - tick->time);
        tick->is_lost = 1;
        return share;
    }
    return 0.0;
}

double dpti_proxy_move(struct proxy_tick *tick, const struct proxy_pose *to, double *met)
{
    const struct proxy_pose from = tick->at;
    const double gap = tick->gap;
    const struct tool_sweep sweep = sweep_tool(tick, to, DPT_NONE);
    int has_searched = 0;
    double share = sweep.time;
    *met = share;
    if (sweep.status == SWEEP_UNFINISHED && share == 0.0)
        return 0.0;
    if (sweep.status == SWEEP_FREE) {
        tick->at = *to;
        dpti_proxy_find_nearest(tick);
        if (has_room(tick, gap))
            return 1.0;
        has_searched = 1;
    }
    if (sweep.status == SWEEP_HIT && tick->is_before)
        return move_with_bodies(tick, to, share);
    const double wanted = min_of(PROXY_GAP_KEPT * tick->clearance, max_of(tick->min_gap, 0.98 * gap));
    for (int k = 0; k < SHORTEN_MAX && !tick->is_before && !work_is_spent(&tick->world->work); k++) {
        /* Where a budget ended the sweep, nothing was touched. */
        if (k > 0 || sweep.status != SWEEP_UNFINISHED)
            share *= k < SHORTEN_LITTLE ? SHORTER_LITTLE : SHORTER;
        const dpt_pose pose = dpti_rigid_sweep_pose(&from.pose, &to->pose, share);
        const struct proxy_pose shorter = dpti_proxy_pose_of(tick->proxy, &pose);
        if (!(dpti_proxy_gap_of_remembered(tick, &shorter, wanted) >= wanted))
            continue;
        tick->at = shorter;
        dpti_proxy_find_nearest(tick);
        has_searched = 1;
        if (has_room(tick, gap))
            return share;
    }
    tick->at = from;
    if (has_searched && tick->is_before)
        tick->is_lost = 1;
    else if (has_searched)
        dpti_proxy_find_nearest(tick);
    tick->gap = gap;
    return 0.0;
}

/* Where a body's motion before this tick brings a pose that moves with it. */
static dpt_pose carried_pose(const struct proxy_tick *tick, const struct body *body)
{
    const struct proxy_pose *at = &tick->at;
    const dpt_pose from = dpti_proxy_body_pose(tick, body);
    const struct quaternion before = quaternion_unit(quaternion_of(from.orientation));
    const struct quaternion now = quaternion_unit(quaternion_of(body->pose.orientation));
    const struct quaternion turn = quaternion_product(now, quaternion_inverse(before));
    const vec3 from_body = sub(at->frame.origin, vec3_of(from.position));
    dpt_pose pose;
    vec3_store(add(vec3_of(body->pose.position), quaternion_turn(turn, from_body)), pose.position);
    quaternion_store(quaternion_unit(quaternion_product(turn, quaternion_unit(at->turn))), pose.orientation);
    return pose;
}

/* It has gone there past bodies that it met nowhere: what was nearest before is not known to be so now. */
static void arrive(struct proxy_tick *tick, const struct proxy_pose *to)
{
    tick->at = *to;
    tick->gap = min_of(tick->gap, tick->clearance);
    tick->is_before = 0;
    tick->is_lost = 1;
}

int dpti_proxy_carry_alone(struct proxy_tick *tick, const struct body *body)
{
    const struct dpt_world *world = tick->world;
    struct proxy_pose to = tick->at;
    if (body_has_moved(world, body) && body->motion_bound > 0.0) {
        const dpt_pose pose = carried_pose(tick, body);
        to = dpti_proxy_pose_of(tick->proxy, &pose);
    }
    for (uint32_t i = 0; i < tool_part_count(tick->tool); i++) {
        const struct part part = tool_part(world, tick->tool, i);
        const struct box box = dpti_part_box(part, &tick->at.frame);
        const double reach = part_radius(part) + part_motion(tick, part, &to) + tick->clearance;
        for (uint32_t slot = 0; slot < world->body_slot_end; slot++)
            if (&world->bodies[slot] != body && is_in_reach(tick, slot, &box, reach))
                return 0;
    }
    arrive(tick, &to);
    return 1;
}

int dpti_proxy_carry_past(struct proxy_tick *tick, const struct body *body)
{
    const struct dpt_world *world = tick->world;
    struct proxy_pose to = tick->at;
    if (body_has_moved(world, body)) {
        const dpt_pose pose = carried_pose(tick, body);
        to = dpti_proxy_pose_of(tick->proxy, &pose);
    }
    if (sweep_tool(tick, &to, handle_index(body->id)).status != SWEEP_FREE)
        return 0;
    dpti_proxy_note_carried(tick, &to, body);
    arrive(tick, &to);
    return 1;
}

/*
 * Move with a body, as if fixed to it: it need not be swept itself. With no other body near, its gap stays as it was.
 */
static int carry_with(struct proxy_tick *tick, const struct body *body)
{
    const struct proxy_pose from = tick->at;
    const double gap = tick->gap;
    const dpt_pose pose = carried_pose(tick, body);
    const struct proxy_pose to = dpti_proxy_pose_of(tick->proxy, &pose);
    const struct tool_sweep sweep = sweep_tool(tick, &to, handle_index(body->id));
    if (sweep.status != SWEEP_FREE)
        return 0;
    tick->at = to;
    dpti_proxy_find_nearest(tick);
    if (sweep.is_alone)
        tick->gap = max_of(tick->gap, min_of(gap, tick->clearance));
    if (sweep.is_alone || has_room(tick, gap))
        return 1;
    tick->at = from;
    tick->is_lost = 1;
    tick->gap = gap;
    return 0;
}

int dpti_proxy_carry(struct proxy_tick *tick)
{
    const struct dpt_world *world = tick->world;
    const struct tool *tool = tick->tool;
    const struct body *tried = NULL;
    for (uint32_t i = 0; i < tool_part_count(tool); i++) {
        const struct body *body = part_nearest(tool_part(world, tool, i)).body;
        if (!body || body == tried || !body_has_moved(world, body) || surface_has_moved(&body->surface, world->ticks))
            continue;
        tried = body;
        if (carry_with(tick, body)) {
            tick->is_before = 0;
            return 1;
        }
    }
    return 0;
}
