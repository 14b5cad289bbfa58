/* SPDX-License-Identifier: BSD-3-Clause */
#include "tissue/tissue_tools.h"

#include <string.h>

#include "proxy/proxy.h"
#include "proxy/tool_loads.h"
#include "tissue/tissue_shaft.h"
#include "tissue/tissue_solve.h"
#include "tissue/tissue_spread.h"
#include "track/tool_parts.h"

/* Whether a tool has a proxy that was outside in the last step, and nothing of which its wrench still has a memory. */
static int tool_can_be_solved(const struct dpt_world *world, const struct tool *tool)
{
    if (!tool->slot.used || !tool_is_active(world, tool) || !dpti_proxy_is_used(world, tool))
        return 0;
    const struct proxy *proxy = proxy_of(world, tool);
    return proxy->tick == world->ticks && proxy->state == PROXY_OUTSIDE && !(proxy->fade.time_left > 0.0) &&
           tool->stiffness > 0.0;
}

static const struct tissue_body *solved_body(const struct tissue_solve *solve, const struct body *body)
{
    for (uint32_t i = 0; i < solve->body_count; i++)
        if (solve->bodies[i].body == body)
            return &solve->bodies[i];
    return NULL;
}

uint32_t dpti_tissue_substeps(const struct tissue_solve *solve, double dt)
{
    uint32_t substeps = 1;
    for (uint32_t b = 0; b < solve->body_count; b++) {
        const struct dpt_springs *springs = solve->bodies[b].step.springs;
        if (!springs)
            continue;
        const uint32_t own =
            solve->is_touched ? dpti_springs_touched_substeps(springs, dt) : dpti_springs_substeps_of(springs, dt);
        substeps = own > substeps ? own : substeps;
    }
    return substeps;
}

/*
 * s: after which a body's surface is where rows should hold: at the end of a substep, in the mean of all substeps; with
 * EULER at the end of the one after it.
 */
static double ahead_of(const struct tissue_solve *solve, const struct tissue_body *body)
{
    const int is_euler = body->step.springs->def.integrator == DPT_INTEGRATOR_EULER;
    const uint32_t substeps = dpti_tissue_substeps(solve, solve->step);
    return solve->step * (double)(substeps + (is_euler ? 3 : 1)) / (double)(2 * substeps);
}

/* As a multiple of the radius: so near to the entry the shaft is held by the rim of the hole alone. */
#define RIM 4.0

/*
 * m: of a tool that is in a body, from its point on: beyond that a part of the body which leans on the shaft touches it.
 * HUGE_VAL: none does, as the shaft goes through one. 0: it is not in the body.
 */
static double left_out_of(const struct dpt_world *world, const struct tool *tool, const struct body *body)
{
    for (uint32_t i = 0; tool_is_inserted(world, tool) && i < insertion_of(world, tool)->count; i++) {
        const struct inserted *in = &insertion_of(world, tool)->in[i];
        const struct channel *channel = &world->channels[in->channel];
        if (channel->body_id != body->id)
            continue;
        if (!body->surface.motion || !channel->point_count)
            return HUGE_VAL;
        const vec3 first = dpti_channel_point_at(&body->surface, &channel->points[0]);
        const double entry = dot(sub(first, channel->mouth), channel->axis), rim = RIM * channel->radius;
        const int is_through = channel->layer_count && channel->layers[0].from < entry - rim;
        return !is_through ? max_of(in->place - entry, 0.0) + rim : HUGE_VAL;
    }
    return 0.0;
}

/* The touches of a tool and the bodies of the solve, or the other bodies. Returns 0 if they are not all. */
static int gather_from(struct tissue_solve *solve, struct touch_search *search, int is_solved)
{
    struct dpt_world *world = search->world;
    const double reach = search->reach, radius = world->segments[search->tool->first_segment].radius;
    int is_whole = 1;
    for (uint32_t i = 0; i < world->body_slot_end; i++) {
        search->body = &world->bodies[i];
        const struct tissue_body *solved = solved_body(solve, search->body);
        search->springs = solved ? solved->step.springs : NULL;
        search->ahead = search->springs ? ahead_of(solve, solved) : 0.0;
        if (!body_is_there(search->body) || !is_solved != !solved)
            continue;
        search->left_out = left_out_of(world, search->tool, search->body);
        /* Not the rim. */
        search->reach = search->left_out > 0.0 ? min_of(reach, 0.5 * RIM * radius) : reach;
        if (search->left_out == 0.0 || (solved && search->left_out < HUGE_VAL))
            is_whole &= dpti_touches_gather(search, &solve->touches);
    }
    search->reach = reach;
    return is_whole;
}

/* The same, and of a leap as far as there is time for. */
static void gather_in_time(struct tissue_solve *solve, struct touch_search *search, int is_solved)
{
    const uint32_t touches = solve->touches.count, is_full = solve->touches.is_full, vertices = solve->vertices.count;
    while (!gather_from(solve, search, is_solved)) {
        solve->touches.count = touches;
        solve->touches.is_full = is_full;
        solve->vertices.count = vertices;
        solve->is_cut = 1;
        search->reach = search->least + 0.25 * (search->reach - search->least);
    }
}

/* The unknowns of the way from a tool's proxy to a pose, as the spring pulls. */
static void unknowns_of(const struct tissue_tool *tool, const dpt_pose *pose, double *unknowns)
{
    const struct proxy_pose to = dpti_proxy_pose_of(tool->proxy, pose);
    const struct displacement way = dpti_proxy_displacement(tool->proxy, &tool->at, &to);
    const struct displacement pulled = dpti_proxy_pulled(&way);
    dpti_proxy_to_unknowns(tool->proxy, tool->axes, &pulled, unknowns);
}

/*
 * The damper adds (damping / dt) times what the displacement grew by since the last tick: with the spring it is one spring
 * of more stiffness, whose end is not the device.
 */
static void set_damper(struct tissue_tool *made, const struct tool *tool, double dt)
{
    double last[TOUCH_DIMENSIONS] = { 0.0 };
    made->stiffness = made->proxy->coupling.stiffness + tool->damping / dt;
    dpti_proxy_to_unknowns(made->proxy, made->axes, &made->proxy->last_felt, last);
    for (uint32_t k = 0; k < TOUCH_DIMENSIONS; k++)
        made->away[k] = made->device[k] + tool->damping / dt / made->stiffness * last[k];
}

/* m: how far a motion takes a tool's points at most. */
static double way_of(const struct proxy *proxy, const struct displacement *moved)
{
    return length(moved->shift) + proxy->extent * length(moved->turn);
}

/* The device's motion, and that in which the last step ended. */
static double motion_of(const struct tool *tool, const struct proxy *proxy)
{
    const struct proxy_pose from = dpti_proxy_pose_of(proxy, &proxy->last_device_pose);
    const struct proxy_pose to = dpti_proxy_pose_of(proxy, &tool->pose);
    const struct displacement moved = dpti_proxy_displacement(proxy, &from, &to);
    return way_of(proxy, &moved) + way_of(proxy, &proxy->end_motion);
}

/* Whether a tool touches what is stepped. Touches without room took the places of others, of tools before it, too. */
static int touches_stepped(const struct tissue_solve *solve, uint32_t slot, uint32_t first, uint32_t stepped)
{
    for (uint32_t i = 0; i < solve->touches.count; i++)
        if (solve->touches.touch[i].tool_slot == slot && (i < first || i >= stepped))
            return 1;
    return 0;
}

static void gather_tool(struct tissue_solve *solve, struct dpt_world *world, const struct tool *tool, double reach,
                        double least)
{
    const uint32_t first = solve->touches.count, shafts = solve->shaft_count;
    const struct proxy *proxy = proxy_of(world, tool);
    struct tissue_tool *made = &solve->tools[solve->tool_count];
    struct touch_search search = { .world = world,
                                   .tool = tool,
                                   .proxy = proxy,
                                   .at = &made->at,
                                   .vertices = &solve->vertices,
                                   .reach = reach + motion_of(tool, proxy),
                                   .least = least,
                                   .work = &solve->work };
    *made = (struct tissue_tool){ .slot = (uint32_t)(tool - world->tools),
                                  .is_sliding = proxy->is_sliding,
                                  .proxy = proxy,
                                  .at = dpti_proxy_pose_of(proxy, &proxy->pose) };
    dpti_proxy_turn_axes(proxy, &made->at, made->axes);
    /* In what is not stepped here they count where something is: they come first, as all must have room. */
    dpti_shafts_gather(solve, &search, 0);
    const uint32_t stepped = solve->touches.count;
    dpti_shafts_gather(solve, &search, 1);
    gather_in_time(solve, &search, 1);
    if (!touches_stepped(solve, made->slot, first, stepped)) {
        solve->touches.count = first;
        solve->shaft_count = shafts;
        return;
    }
    gather_in_time(solve, &search, 0);
    unknowns_of(made, &tool->pose, made->device);
    unknowns_of(made, &proxy->end, made->begin);
    memcpy(made->end, made->begin, sizeof made->end);
    set_damper(made, tool, solve->dt);
    solve->tool_count++;
}

void dpti_tissue_gather(struct tissue_solve *solve, struct dpt_world *world, double reach, double least)
{
    solve->is_cut = solve->touches.count = solve->touches.is_full = solve->tool_count = solve->vertices.count =
        solve->shaft_count = 0;
    solve->world = world;
    solve->is_touched = 0;
    for (uint32_t t = 0; t < world->tool_slot_end; t++)
        solve->is_touched |= (uint32_t)(world->tools[t].force_reason == (uint32_t)DPT_FORCE_ACTS &&
                                        tool_can_be_solved(world, &world->tools[t]));
    for (uint32_t t = 0; t < world->tool_slot_end; t++)
        if (tool_can_be_solved(world, &world->tools[t])) {
            if (solve->tool_count == TISSUE_TOOLS_MAX)
                solve->is_full = 1;
            else
                gather_tool(solve, world, &world->tools[t], reach, least);
        }
}

/* What is felt may differ by that share of it, and by that much, N, from what the proxy says. */
#define APART_SHARE 0.05
#define APART_FORCE 5e-3

/* J: what the bodies did on the tool in this tick: the mean push of this tick and the last one, over the tool's way. */
static double work_of_bodies(const struct tool *tool, const struct proxy *proxy, const struct displacement *felt)
{
    const struct proxy_pose from = dpti_proxy_pose_of(proxy, &proxy->last_device_pose);
    const struct proxy_pose to = dpti_proxy_pose_of(proxy, &tool->pose);
    const struct displacement led = dpti_proxy_displacement(proxy, &from, &to);
    const struct displacement grown = displacement_sum(felt, -1.0, &proxy->last_felt);
    const struct displacement moved = displacement_sum(&grown, 1.0, &led);
    const struct displacement both = displacement_sum(&proxy->pushed, 1.0, &proxy->last_pushed);
    return 0.5 * proxy->coupling.stiffness * displacement_dot(&proxy->coupling, &both, &moved);
}

/* The mean push of the substeps, over the stiffness. */
static struct displacement pushed_by(const struct tissue_tool *from)
{
    double unknowns[TOUCH_DIMENSIONS];
    for (uint32_t k = 0; k < TOUCH_DIMENSIONS; k++)
        unknowns[k] =
            from->stiffness / from->proxy->coupling.stiffness * (from->felt[k] - (from->away[k] - from->device[k]));
    return dpti_proxy_of_unknowns(from->proxy, from->axes, unknowns);
}

/* J: what the bodies' own surfaces store, as they yield to the mean push. */
static double stored_by(const struct tissue_solve *solve, const struct tissue_tool *from)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < solve->touches.count; i++) {
        const double push = dot(solve->push[i], solve->touches.touch[i].normal);
        if (!(push > 0.0) || &solve->tools[solve->links[i].tool] != from)
            continue;
        for (uint32_t k = 0; k < solve->touches.count && solve->links[i].yields > 0.0; k++)
            sum += 0.5 * push * dot(solve->push[k], solve->touches.touch[k].normal) * dpti_tissue_yield(solve, i, k);
    }
    return sum;
}

/* The displacement from the device that is felt. The proxy's own is that of the world's step. */
static void note_felt(const struct tissue_solve *solve, const struct tissue_tool *from, struct tool *tool,
                      struct proxy *proxy)
{
    const struct displacement felt = dpti_proxy_of_unknowns(proxy, from->axes, from->felt);
    const struct displacement between = displacement_sum(&felt, -1.0, &proxy->felt);
    const double apart = displacement_norm(&proxy->coupling, &between);
    const double allowed =
        APART_SHARE * displacement_norm(&proxy->coupling, &felt) + APART_FORCE / proxy->coupling.stiffness;
    tool->force_flags &= ~(uint32_t)(DPT_FORCE_FLAG_APART | DPT_FORCE_FLAG_CROWDED);
    tool->force_flags |= apart > allowed ? DPT_FORCE_FLAG_APART : 0u;
    tool->force_flags |= solve->is_full || solve->touches.is_full ? DPT_FORCE_FLAG_CROWDED : 0u;
    proxy->stored = stored_by(solve, from) + dpti_shafts_stored(solve, from);
    tool->energy = coupling_energy(&proxy->coupling, &felt) + proxy->stored;
    tool->body_work = proxy->body_work = work_of_bodies(tool, proxy, &felt) + proxy->stored - proxy->last_stored;
    proxy->felt = felt;
}

static void note_rubs(const struct tissue_tool *from, struct proxy *proxy, int is_held)
{
    proxy->is_ended = 1;
    proxy->sticking = (uint16_t)from->sticking;
    proxy->slipping = (uint16_t)from->slipping;
    proxy->is_led = is_held && from->sticking + from->slipping > 0;
    proxy->is_sliding = from->is_sliding != 0;
}

/* The couple of a tool's twist, N. Returns its torque about the device's origin. */
static vec3 note_twist(const struct tissue_solve *solve, struct dpt_world *world, struct tool *tool,
                       const struct tissue_twist *twist)
{
    const struct touch *touch = &solve->touches.touch[twist->touch];
    vec3 torque = { 0.0, 0.0, 0.0 };
    for (uint32_t k = 0; k < 3; k++) {
        const vec3 push = scaled(twist->push[k], twist->mean);
        const struct tool_push noted = { .part = touch->part,
                                         .body_id = touch->body_id,
                                         .triangle = touch->triangle,
                                         .at = twist->corner[k],
                                         .normal = touch->normal,
                                         .force = scaled(push, -1.0),
                                         .is_narrow = 1,
                                         .is_part = 1 };
        torque = add(torque, cross(sub(twist->corner[k], vec3_of(tool->pose.position)), push));
        dpti_loads_note_push(world, tool, &noted);
    }
    return torque;
}

/* What a tool feels: the pushes of its touches, about its device's origin. What a program's own function added stays. */
static void set_wrench(const struct tissue_solve *solve, struct dpt_world *world, const struct tissue_tool *from)
{
    struct tool *tool = &world->tools[from->slot];
    struct proxy *proxy = proxy_of(world, tool);
    vec3 force = { 0.0, 0.0, 0.0 }, torque = force;
    const dpt_wrench law = tool->law_wrench, shaped = tool->wrench;
    dpti_loads_forget(world, tool);
    for (uint32_t i = 0; i < solve->touches.count; i++) {
        const struct touch *touch = &solve->touches.touch[i];
        const vec3 push = solve->push[i];
        if (touch->tool_slot != from->slot || !(dot(push, push) > 0.0))
            continue;
        if (!touch->shaft)
            dpti_proxy_remember(proxy, touch->part, touch->body_id, touch->triangle);
        force = add(force, push);
        const struct tool_push noted = { .part = touch->part,
                                         .body_id = touch->body_id,
                                         .triangle = touch->triangle,
                                         .at = touch->at,
                                         .normal = touch->normal,
                                         .depth = solve->links[i].depth,
                                         .force = scaled(push, -1.0),
                                         .is_narrow = solve->links[i].is_narrow };
        torque = add(torque, cross(sub(tissue_middle(solve, i), vec3_of(tool->pose.position)), push));
        dpti_loads_note_push(world, tool, &noted);
    }
    if (from->twist.mean != 0.0)
        torque = add(torque, note_twist(solve, world, tool, &from->twist));
    vec3_store(force, tool->wrench.force);
    vec3_store(torque, tool->wrench.torque);
    tool->force_reason = dot(force, force) > 0.0 ? (uint32_t)DPT_FORCE_ACTS : (uint32_t)DPT_FORCE_FREE;
    proxy->reason = tool->force_reason;
    dpti_loads_settle(world, tool);
    for (int k = 0; k < 3; k++) {
        tool->wrench.force[k] += shaped.force[k] - law.force[k];
        tool->wrench.torque[k] += shaped.torque[k] - law.torque[k];
    }
    proxy->pushed = pushed_by(from);
    note_felt(solve, from, tool, proxy);
}

/* How often an answer must be the same before it is taken for the next one, too. */
enum { REPEATS = 2 };

static void note_repeats(struct tissue_solve *solve, const struct dpt_world *world)
{
    int is_same = world_was_last_tick(world, solve->tick);
    for (uint32_t t = 0; t < solve->tool_count; t++) {
        is_same &= !memcmp(solve->told[t], solve->tools[t].felt, sizeof solve->told[t]);
        memcpy(solve->told[t], solve->tools[t].felt, sizeof solve->told[t]);
    }
    solve->repeats = is_same ? solve->repeats + 1 : 0;
    solve->tick = world->ticks;
}

void dpti_tissue_tell(struct tissue_solve *solve, struct dpt_world *world)
{
    for (uint32_t t = 0; t < solve->tool_count; t++) {
        struct tool *tool = &world->tools[solve->tools[t].slot];
        set_wrench(solve, world, &solve->tools[t]);
        note_rubs(&solve->tools[t], proxy_of(world, tool), (int)solve->tools[t].is_held);
    }
    dpti_spread_note(solve);
    dpti_shafts_tell(solve, world);
    note_repeats(solve, world);
}

int dpti_tissue_rests(const struct tissue_solve *solve, const struct dpt_world *world)
{
    if (solve->repeats < REPEATS || !dpti_shafts_are_there(solve, world) || !world_was_last_tick(world, solve->tick) ||
        world->bodies_moved_tick == world->ticks)
        return 0;
    for (uint32_t b = 0; b < solve->body_count; b++)
        if (!solve->bodies[b].step.springs || solve->bodies[b].step.springs->region.count)
            return 0;
    for (uint32_t t = 0; t < world->tool_slot_end; t++) {
        const struct tool *tool = &world->tools[t];
        if (tool->slot.used && dpti_proxy_is_used(world, tool) && !proxy_of(world, tool)->is_still)
            return 0;
    }
    return 1;
}

void dpti_tissue_tell_again(struct tissue_solve *solve, struct dpt_world *world)
{
    for (uint32_t t = 0; t < solve->tool_count; t++) {
        struct tool *tool = &world->tools[solve->tools[t].slot];
        set_wrench(solve, world, &solve->tools[t]);
        note_rubs(&solve->tools[t], proxy_of(world, tool), tool->force_reason == DPT_FORCE_ACTS);
    }
    solve->tick = world->ticks;
}
