/* SPDX-License-Identifier: BSD-3-Clause */
#include "proxy/tip_pose.h"

#include "hull/hull_sweep.h"

/* The most motions of a tip in a tick, and the ratio of their lengths. */
enum { MOTIONS_MAX = 10 };
#define LONGER 16.0

/* How often a motion that ends too near is shortened: at first a little, then more. */
enum { SHORTEN_LITTLE = 3, SHORTEN_MAX = 6 };
#define SHORTER_LITTLE 0.9
#define SHORTER        0.5

/* As a share of the clearance: a shorter motion is not made. */
#define MOTION_MIN 1e-3

void dpti_tip_put(struct dpt_world *world, struct tip *tip, const dpt_pose *pose)
{
    static const dpt_pose identity = DPT_POSE_IDENTITY;
    const struct dpt_hull *given = tip->given;
    struct dpt_hull *moved = &world->tip_hulls[tip - world->tips];
    struct frame frame;
    tip->pose = *pose;
    if (pose_is_same(pose, &identity)) {
        tip->hull = given;
        return;
    }
    if (tip->hull != moved)
        *moved = *given;
    frame_of_pose(pose, &frame);
    for (uint32_t i = 0; i < given->corner_count; i++)
        moved->corner[i] = frame_to_world(&frame, given->corner[i]);
    for (uint32_t i = 0; i < given->face_count; i++)
        moved->face[i].normal = frame_turn(&frame, given->face[i].normal);
    moved->axis_a = frame_to_world(&frame, given->axis_a);
    moved->axis_b = frame_to_world(&frame, given->axis_b);
    tip->hull = moved;
}

void dpti_tips_put_all(struct dpt_world *world, const struct tool *tool)
{
    for (uint32_t i = 0; i < tool->tip_count; i++) {
        struct tip *tip = tool_tip(world, tool, i);
        if (pose_is_same(&tip->pose, &tip->wanted))
            continue;
        dpti_tip_put(world, tip, &tip->wanted);
        memset(&tip->answer, 0, sizeof tip->answer);
    }
}

/* m: a tip's surface is at least so far from all bodies. */
static double least_gap(const struct tip *tip, const struct tip_answer *answer)
{
    return answer->body ? answer->lower_bound - tip->hull->radius : HUGE_VAL;
}

/* A body's pose in the frame of a tool. */
static dpt_pose pose_in_tool(const struct proxy_pose *tool, const dpt_pose *body)
{
    dpt_pose pose;
    const struct quaternion turn = quaternion_unit(quaternion_of(body->orientation));
    const struct quaternion back = quaternion_inverse(quaternion_unit(tool->turn));
    vec3_store(frame_to_local(&tool->frame, vec3_of(body->position)), pose.position);
    quaternion_store(quaternion_unit(quaternion_product(back, turn)), pose.orientation);
    return pose;
}

/* A motion that is tried, in the tool's frame. */
struct tip_motion {
    dpt_pose to;
    double size; /* m: no corner goes farther */
};

/* What is met on it. */
struct tip_obstacle {
    int status;  /* SWEEP_... */
    double time; /* up to which the motion is free */
    const struct body *body;
    uint32_t triangle; /* place: the first that is met */
};

/* The sweep is in the tool's frame, so that a share of the motion gives the pose that was swept, bit for bit. */
static void sweep_body(struct proxy_tick *tick, const struct tip *tip, const struct body *body,
                       const struct tip_motion *motion, struct tip_obstacle *met)
{
    struct dpt_world *world = tick->world;
    const dpt_pose at = pose_in_tool(&tick->at, &body->pose);
    const struct placement from = { .tool = tip->pose, .body = at };
    const struct placement to = { .tool = motion->to, .body = at };
    const int is_nearest = tip->answer.body == body;
    vec3 direction = { 0.0, 0.0, 0.0 };
    struct hull_sweep sweep = { .surface = &body->surface,
                                .kernel = &world->kernel,
                                .hull = tip->given,
                                .tolerance = 0.5 * RIGID_SWEEP_TOLERANCE * min_of(body->diagonal, PROXY_SCALE_MAX),
                                .directions = &direction,
                                .work = &world->work,
                                .triangle = is_nearest ? tip->answer.nearest.triangle : DPT_NONE };
    if (is_nearest && tip->answer.nearest.distance > 0.0) {
        direction = scaled(unit_of(tip->answer.nearest.found.pair.gap), -1.0);
        sweep.direction_count = 1;
    }
    const int status = work_is_spent(&world->work) ? SWEEP_UNFINISHED : dpti_hull_sweep(&sweep, &from, &to);
    if (status == SWEEP_FREE)
        return;
    if (met->status != SWEEP_UNFINISHED)
        met->status = status;
    if (sweep.time > met->time)
        return;
    met->time = sweep.time;
    met->body = status == SWEEP_HIT ? body : NULL;
    met->triangle = sweep.triangle;
}

static struct tip_obstacle sweep_motion(struct proxy_tick *tick, const struct tip *tip, const struct tip_motion *motion)
{
    struct dpt_world *world = tick->world;
    struct tip_obstacle met = { .status = SWEEP_FREE, .time = 1.0 };
    const double reach = tip->hull->radius + motion->size + tick->clearance;
    const struct box box = dpti_tip_box(tip->hull, &tick->at.frame);
    if (least_gap(tip, &tip->answer) > motion->size + tick->clearance)
        return met;
    const struct work before = world_begin_sweep(world);
    for (uint32_t slot = 0; slot < world->body_slot_end; slot++) {
        const struct body *body = &world->bodies[slot];
        if (body_is_there(body) && box_distance(&box, &world->boxes[slot]) <= reach)
            sweep_body(tick, tip, body, motion, &met);
    }
    world_end_sweep(world, &before);
    return met;
}

/* Whether what was met alone already shows that a tip is too near where it is now. */
static int is_too_near(const struct proxy_tick *tick, const struct tip *tip, const struct tip_obstacle *met,
                       double wanted)
{
    struct hull_place place;
    struct hull_pair found;
    vec3 v[3];
    if (!met->body)
        return 0;
    surface_corners(&met->body->surface, met->triangle, v);
    hull_place_set(&place, tip->hull, &tick->at.frame, &met->body->frame);
    return dpti_hull_triangle(&place, v, wanted + tip->hull->radius, &found);
}

/* Make a motion as far as it is free and leaves the tip's gap. Returns the share that was made. */
static double make_motion(struct proxy_tick *tick, struct tip *tip, const struct tip_motion *motion)
{
    struct dpt_world *world = tick->world;
    const struct tip_obstacle met = sweep_motion(tick, tip, motion);
    const dpt_pose from = tip->pose;
    const double gap = least_gap(tip, &tip->answer);
    double share = met.time, wanted = min_of(tick->min_gap, gap);
    for (int k = 0; k < SHORTEN_MAX && !work_is_spent(&world->work); k++) {
        if (k || met.status == SWEEP_HIT) {
            share *= k < SHORTEN_LITTLE ? SHORTER_LITTLE : SHORTER;
            wanted = min_of(PROXY_GAP_KEPT * tick->clearance, max_of(tick->min_gap, 0.98 * gap));
        }
        if (share < 1.0 && share * motion->size < MOTION_MIN * tick->clearance)
            break;
        const dpt_pose pose = dpti_rigid_sweep_pose(&from, &motion->to, share);
        struct tip_answer answer;
        dpti_tip_put(world, tip, &pose);
        if (is_too_near(tick, tip, &met, wanted))
            continue;
        dpti_tip_find(world, tip, &tick->at.frame, &world->work, &answer);
        if (!(least_gap(tip, &answer) >= wanted))
            continue;
        dpti_tip_know(world, tip, &tick->at.frame, &answer);
        return share;
    }
    dpti_tip_put(world, tip, &from);
    return 0.0;
}

/*
 * The whole way to where the tip is wanted, or so much of it as is tried at once; where nothing is near, that is all.
 */
static struct tip_motion next_motion(const struct proxy_tick *tick, struct tip *tip)
{
    const double size = dpti_hull_displacement(tip->given, &tip->wanted, &tip->pose);
    struct tip_motion motion = { tip->wanted, size };
    if (least_gap(tip, &tip->answer) > size + tick->clearance)
        tip->trust = HUGE_VAL;
    if (size <= tip->trust)
        return motion;
    motion.to = dpti_rigid_sweep_pose(&tip->pose, &tip->wanted, tip->trust / size);
    motion.size = dpti_hull_displacement(tip->given, &motion.to, &tip->pose);
    return motion;
}

/* Returns how far the tip moved, m; *is_done: 0 if only the budget ended it. */
static double follow_tip(struct proxy_tick *tick, struct tip *tip, int *is_done)
{
    double moved = 0.0;
    for (int i = 0; i < MOTIONS_MAX && !pose_is_same(&tip->pose, &tip->wanted); i++) {
        const struct tip_motion motion = next_motion(tick, tip);
        const double made = make_motion(tick, tip, &motion);
        moved += made * motion.size;
        if (work_is_spent(&tick->world->work) || !tick->world->sweep_work_left) {
            *is_done = 0;
            return moved;
        }
        if (made < 1.0) {
            tip->trust = max_of(tick->clearance, 2.0 * made * motion.size);
            return moved;
        }
        tip->trust *= LONGER;
    }
    return moved;
}

int dpti_tips_follow(struct proxy_tick *tick)
{
    struct dpt_world *world = tick->world;
    int is_done = 1;
    tick->proxy->tip_motion = 0.0;
    for (uint32_t i = 0; i < tick->tool->tip_count; i++) {
        struct tip *tip = tool_tip(world, tick->tool, i);
        if (pose_is_same(&tip->pose, &tip->wanted))
            continue;
        if (tick->is_lost || work_is_spent(&world->work)) {
            is_done = 0;
            continue;
        }
        const double moved = follow_tip(tick, tip, &is_done);
        tick->gap = min_of(tick->gap, least_gap(tip, &tip->answer));
        tick->proxy->tip_motion = max_of(tick->proxy->tip_motion, moved);
    }
    return is_done;
}
