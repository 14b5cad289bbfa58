/* SPDX-License-Identifier: BSD-3-Clause */
#include "tissue/tissue_end.h"

#include <string.h>

#include "hull/hull_sweep.h"
#include "proxy/proxy.h"
#include "proxy/proxy_tick.h"
#include "sweep/sweep_rigid.h"
#include "tissue/tissue_solve.h"
#include "track/tool_parts.h"

/* rad: a tool that friction has turned farther from its device lets go there. */
#define TURN_MAX 1.0

/*
 * m: how far the tool's surface moves at a touch from one pose to another. The axis goes where it goes, along an arc; about
 * it the tool rolls on the surface, by as much as it turns.
 */
static vec3 rolled(const struct tissue_solve *solve, uint32_t index, const struct tissue_tool *tool,
                   const struct proxy_pose *from, const struct proxy_pose *to)
{
    const struct touch *touch = &solve->touches.touch[index];
    const struct part part = tool_part(solve->world, &solve->world->tools[tool->slot], touch->part);
    const double radius = part_radius(part) + dpti_proxy_clearance(solve->world);
    const vec3 axis = frame_to_local(&tool->at.frame, along(touch->at, radius + touch->gap, touch->normal));
    const vec3 turn = quaternion_rotation_vector(quaternion_product(to->turn, quaternion_inverse(from->turn)));
    const vec3 moved = sub(frame_to_world(&to->frame, axis), frame_to_world(&from->frame, axis));
    return sub(moved, cross(turn, scaled(touch->normal, radius + solve->links[index].depth)));
}

/* What turns add to the way of touches along the surface beyond what their rows tell: a tool that sticks would creep. */
static vec3 creep_of(const struct tissue_solve *solve, const struct tissue_tool *from, const struct proxy_pose *last,
                     const struct proxy_pose *end)
{
    vec3 sum = { 0.0, 0.0, 0.0 };
    double pushes = 0.0;
    for (uint32_t r = 0; r < solve->rub_count; r++) {
        const uint32_t touch = solve->rubs[r].touch, row = solve->rubs[r].row;
        const double push = solve->multiplier[touch];
        if (!(push > 0.0) || &solve->tools[solve->links[touch].tool] != from)
            continue;
        const vec3 moved = rolled(solve, touch, from, last, end);
        for (uint32_t d = 0; d < 2; d++) {
            double told = 0.0;
            for (uint32_t k = 0; k < TOUCH_DIMENSIONS; k++)
                told += solve->rows[row + d].lever[k] * (from->end[k] - from->begin[k]);
            sum = along(sum, push * (dot(moved, solve->rows[row + d].along) - told), solve->rows[row + d].along);
        }
        pushes += push;
    }
    return pushes > 0.0 ? scaled(sum, 1.0 / pushes) : sum;
}

/*
 * As far as its row does not tell, turns of a tool that follow each other do not add up about the normal of its twist: it
 * would turn there by and by. What is missing is added, about the touch.
 */
static void hold_twist(const struct tissue_solve *solve, const struct tissue_tool *from, const struct proxy_pose *last,
                       const struct proxy_pose *end, struct displacement *way)
{
    const struct tissue_twist *twist = &from->twist;
    if (!twist->row)
        return;
    const struct touch *touch = &solve->touches.touch[twist->touch];
    const vec3 turn = quaternion_rotation_vector(quaternion_product(end->turn, quaternion_inverse(last->turn)));
    const double *lever = solve->rows[twist->row].lever;
    double unknowns[TOUCH_DIMENSIONS] = { 0.0 }, missed = dot(turn, twist->torque), size = 0.0;
    for (uint32_t k = 3; k < TOUCH_DIMENSIONS; k++)
        missed -= lever[k] * (from->end[k] - from->begin[k]);
    for (uint32_t k = 3; k < TOUCH_DIMENSIONS; k++)
        size += lever[k] * lever[k];
    for (uint32_t k = 3; k < TOUCH_DIMENSIONS; k++)
        unknowns[k] = -missed / size * lever[k];
    struct displacement more = dpti_proxy_of_unknowns(from->proxy, from->axes, unknowns);
    const vec3 arm = sub(touch->at, end->centre);
    more.shift = sub(more.shift, cross(more.turn, arm));
    *way = displacement_sum(way, 1.0, &more);
}

/* N: all pushes of the touches of a tool. */
static vec3 push_on(const struct tissue_solve *solve, const struct tissue_tool *from)
{
    vec3 sum = { 0.0, 0.0, 0.0 };
    for (uint32_t i = 0; i < solve->touches.count; i++)
        if (&solve->tools[solve->links[i].tool] == from)
            sum = add(sum, solve->push[i]);
    return sum;
}

/* Where the tool is at the end of the step, for the next one. */
static void note_end(const struct tissue_solve *solve, struct tissue_tool *from, const struct tool *tool,
                     struct proxy *proxy)
{
    struct displacement way = dpti_proxy_of_unknowns(proxy, from->axes, from->end);
    const struct displacement felt = dpti_proxy_of_unknowns(proxy, from->axes, from->felt);
    const vec3 push = push_on(solve, from);
    from->last_end = proxy->end;
    from->last_end_motion = proxy->end_motion;
    from->is_pushed = dot(push, push) > 0.0;
    from->is_held =
        from->is_pushed && (length(felt.turn) + fabs(felt.spin) < TURN_MAX || tool_is_inserted(solve->world, tool));
    const struct proxy_pose last = dpti_proxy_pose_of(proxy, &proxy->end);
    struct proxy_pose end = dpti_proxy_moved(proxy, &from->at, &way);
    hold_twist(solve, from, &last, &end, &way);
    end = dpti_proxy_moved(proxy, &from->at, &way);
    way.shift = sub(way.shift, creep_of(solve, from, &last, &end));
    end = dpti_proxy_moved(proxy, &from->at, &way);
    proxy->end_motion = dpti_proxy_displacement(proxy, &last, &end);
    proxy->end = from->is_held ? end.pose : tool->pose;
}

void dpti_tissue_end(struct tissue_solve *solve, struct dpt_world *world)
{
    for (uint32_t t = 0; t < solve->tool_count; t++) {
        const struct tool *tool = &world->tools[solve->tools[t].slot];
        note_end(solve, &solve->tools[t], tool, proxy_of(world, tool));
    }
}

void dpti_tissue_unend(struct tissue_solve *solve, struct dpt_world *world)
{
    for (uint32_t t = 0; t < solve->tool_count; t++) {
        struct proxy *proxy = proxy_of(world, &world->tools[solve->tools[t].slot]);
        proxy->end = solve->tools[t].last_end;
        proxy->end_motion = solve->tools[t].last_end_motion;
    }
}

/*
 * How often a tool gives way there, and m: how near surfaces are looked at, beyond the last turn's way. Then how many times
 * longer than what is missing a turn may be: between walls that are almost parallel it would go far.
 */
enum { ROOM_TURNS = 4 };
#define ROOM_REACH   2e-5
#define ROOM_LONGEST 50.0

/* A newton along one touch moves the tool alone. */
static void give_lever(void *user, uint32_t index, uint32_t first, double *column)
{
    const struct touches *touches = user;
    for (uint32_t i = first; i < touches->count; i++) {
        column[i] = 0.0;
        for (uint32_t k = 0; k < TOUCH_DIMENSIONS; k++)
            column[i] += touches->touch[index].row[k] * touches->touch[i].row[k];
    }
}

/* The least motion, as unknowns, that leaves no gap below 0. Returns its length, m. */
static double least_motion(struct tissue_solve *solve, double unknowns[TOUCH_DIMENSIONS])
{
    const struct touches *touches = &solve->room;
    struct complementarity *problem = &solve->problem;
    for (uint32_t i = 0; i < touches->count; i++)
        solve->free_gap[i] = touches->touch[i].gap;
    problem->count = touches->count;
    problem->active_count = problem->matrix = 0;
    problem->kind = NULL;
    problem->column = give_lever;
    problem->user = &solve->room;
    problem->work = NULL;
    dpti_complementarity_solve(problem);
    memset(unknowns, 0, TOUCH_DIMENSIONS * sizeof *unknowns);
    for (uint32_t a = 0; a < problem->active_count; a++)
        for (uint32_t k = 0; k < TOUCH_DIMENSIONS; k++)
            unknowns[k] += problem->multiplier[a] * touches->touch[problem->active[a]].row[k];
    return norm_of(unknowns, TOUCH_DIMENSIONS);
}

/* All touches of a tool at a pose. Returns the least gap, m. */
static double gather_at(struct tissue_solve *solve, struct dpt_world *world, const struct tool *tool,
                        const struct proxy_pose *at, double reach)
{
    struct touch_search search = { .world = world,
                                   .tool = tool,
                                   .proxy = proxy_of(world, tool),
                                   .at = at,
                                   .reach = reach,
                                   .least = reach,
                                   .work = &solve->work };
    double least = HUGE_VAL;
    solve->room.count = 0;
    for (uint32_t i = 0; i < world->body_slot_end; i++) {
        search.body = &world->bodies[i];
        if (body_is_there(search.body) && !(world->channels && dpti_is_inserted_in(world, tool, search.body->id)))
            dpti_touches_gather(&search, &solve->room);
    }
    for (uint32_t i = 0; i < solve->room.count; i++)
        least = min_of(least, solve->room.touch[i].gap);
    return least;
}

/* A tool's end gives way to what is nearer than a half of the clearance, as long as that makes it better. */
static void make_room(struct tissue_solve *solve, struct dpt_world *world, const struct tool *tool)
{
    struct proxy *proxy = proxy_of(world, tool);
    const double enough = -0.5 * dpti_proxy_clearance(world);
    struct proxy_pose at = dpti_proxy_pose_of(proxy, &proxy->end);
    double unknowns[TOUCH_DIMENSIONS], best = -HUGE_VAL, moved = 0.0;
    vec3 axes[3];
    for (int turn = 0; turn < ROOM_TURNS; turn++) {
        const double gap = gather_at(solve, world, tool, &at, ROOM_REACH + moved);
        if (gap > best)
            proxy->end = at.pose;
        best = max_of(best, gap);
        if (best >= enough)
            return;
        moved = least_motion(solve, unknowns);
        if (moved > ROOM_LONGEST * (dpti_proxy_clearance(world) - gap))
            return;
        dpti_proxy_turn_axes(proxy, &at, axes);
        const struct displacement way = dpti_proxy_of_unknowns(proxy, axes, unknowns);
        at = dpti_proxy_moved(proxy, &at, &way);
    }
}

void dpti_tissue_settle(struct tissue_solve *solve, struct dpt_world *world)
{
    for (uint32_t t = 0; t < solve->tool_count; t++) {
        const struct tool *tool = &world->tools[solve->tools[t].slot];
        if (solve->tools[t].is_pushed)
            make_room(solve, world, tool);
    }
}

/* ---- the way there ---- */

/* The share of its radius by which surfaces may dent a tool on its way to its end: src/proxy/proxy_step.c. */
#define DENTED 0.1

/* A motion of a tool past a body whose vertices move meanwhile. */
struct way {
    struct tissue_solve *solve;
    struct dpt_world *world;
    const struct body *body;
    struct placement from, to;
};

/* 1 where a budget ends the search, too. */
static int segment_is_free(const struct way *way, const struct segment *segment)
{
    struct placement from = way->from, to = way->to;
    struct rigid_sweep_progress progress;
    rigid_sweep_restart(&progress);
    from.a = to.a = segment->a;
    from.b = to.b = segment->b;
    struct rigid_sweep sweep = { .surface = &way->body->surface,
                                 .kernel = &way->world->kernel,
                                 .radius = (1.0 - DENTED) * segment->radius,
                                 .tolerance =
                                     0.5 * RIGID_SWEEP_TOLERANCE * min_of(way->body->diagonal, PROXY_SCALE_MAX),
                                 .hint = DPT_NONE,
                                 .tick = world_coming_tick(way->world),
                                 .work = &way->solve->work,
                                 .progress = &progress };
    return dpti_rigid_sweep_find(&sweep, &from, &to) != SWEEP_HIT;
}

static int tip_is_free(const struct way *way, const struct tip *tip)
{
    struct hull_sweep sweep = { .surface = &way->body->surface,
                                .kernel = &way->world->kernel,
                                .hull = tip->hull,
                                .clearance = -DENTED * tip->hull->radius,
                                .tolerance = 0.5 * RIGID_SWEEP_TOLERANCE * min_of(way->body->diagonal, PROXY_SCALE_MAX),
                                .tick = world_coming_tick(way->world),
                                .work = &way->solve->work,
                                .triangle = DPT_NONE };
    return dpti_hull_sweep(&sweep, &way->from, &way->to) != SWEEP_HIT;
}

/* Past a body that has moved farther than a part of the tool is thick, and than the tool goes itself. */
static int tool_is_free(struct tissue_solve *solve, struct dpt_world *world, const struct tool *tool,
                        const struct body *body)
{
    const struct proxy *proxy = proxy_of(world, tool);
    const struct way way = { .solve = solve,
                             .world = world,
                             .body = body,
                             .from = { .tool = proxy->pose, .body = body->pose },
                             .to = { .tool = proxy->end, .body = body->pose } };
    const struct proxy_pose from = dpti_proxy_pose_of(proxy, &proxy->pose);
    const struct proxy_pose to = dpti_proxy_pose_of(proxy, &proxy->end);
    const struct displacement moved = dpti_proxy_displacement(proxy, &from, &to);
    const double size = displacement_norm(&proxy->coupling, &moved);
    for (uint32_t i = 0; i < tool_part_count(tool); i++) {
        const struct part part = tool_part(world, tool, i);
        if (body->motion_bound > max_of(part_radius(part), size) &&
            !(part.tip ? tip_is_free(&way, part.tip) : segment_is_free(&way, part.segment)))
            return 0;
    }
    return 1;
}

int dpti_tissue_ways_are_free(struct tissue_solve *solve, struct dpt_world *world)
{
    const uint32_t coming = world_coming_tick(world);
    for (uint32_t t = 0; t < solve->tool_count; t++)
        for (uint32_t b = 0; b < solve->body_count; b++) {
            const struct body *body = solve->bodies[b].body;
            const struct tool *tool = &world->tools[solve->tools[t].slot];
            if (world->channels && dpti_is_inserted_in(world, tool, body->id))
                continue;
            if (solve->tools[t].is_pushed && surface_has_moved(&body->surface, coming) &&
                !tool_is_free(solve, world, tool, body))
                return 0;
        }
    return 1;
}
