/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Springs of bodies, stepped with the tools that touch them: docs/algorithms/tissue.md. What a tool does to a body that
 * cannot be solved for together with it is a load of the tick before.
 */
#include <float.h>
#include <math.h>
#include <string.h>

#include "base/return_if_error.h"
#include "deform/spring_contact.h"
#include "deform/spring_vertices.h"
#include "proxy/proxy.h"
#include "proxy/tool_loads.h"
#include "strip/strip_state.h"
#include "tissue/tissue_solve.h"
#include "world/deform_body.h"

/* By which the point of the nearest axis has moved since the step before, in the body's frame. */
static vec3 tool_motion_at(const struct dpt_world *world, const struct body *body, vec3 at)
{
    vec3 motion = { 0.0, 0.0, 0.0 };
    double nearest = HUGE_VAL;
    for (uint32_t i = 0; i < world->segment_count; i++) {
        const struct segment_strip *strip = dpti_deform_displacing_strip(world, i, handle_index(body->id));
        if (!strip)
            continue;
        const double square = dot(strip->u, strip->u);
        const double s = square > 0.0 ? min_of(max_of(dot(sub(at, strip->a), strip->u) / square, 0.0), 1.0) : 0.0;
        const vec3 away = sub(at, along(strip->a, s, strip->u));
        const double distance = dot(away, away) / (strip->radius * strip->radius + DBL_MIN);
        if (distance < nearest) {
            nearest = distance;
            motion = sub(along(strip->a, s, strip->u), along(strip->a_last, s, strip->u_last));
        }
    }
    return motion;
}

/* Whether tools touch that did not in the step before, or moved, or let go. Counts those that touch. */
static int have_tools_moved(const struct dpt_world *world, const struct body *body, uint32_t *count)
{
    int has_moved = 0;
    *count = 0;
    for (uint32_t i = 0; i < world->segment_count; i++) {
        const struct segment_strip *strip = dpti_deform_displacing_strip(world, i, handle_index(body->id));
        if (!strip)
            continue;
        has_moved |= strip->is_new || memcmp(&strip->a, &strip->a_last, sizeof strip->a) != 0 ||
                     memcmp(&strip->u, &strip->u_last, sizeof strip->u) != 0;
        ++*count;
    }
    return has_moved;
}

static void take_displaced(const struct dpt_world *world, const struct body *body, struct dpt_springs *springs,
                           double dt)
{
    const struct spring_slice *state = springs->state[springs->now];
    uint32_t tools;
    const int have_moved = have_tools_moved(world, body, &tools) || tools != springs->contact.tools;
    const struct tool_touch touch = { body->static_friction, body->kinetic_friction, dt, have_moved };
    springs->contact.tools = tools;
    if (!have_moved && !tools)
        return;
    dpti_spring_contact_begin(springs, &touch);
    for (uint32_t v = 0; tools && v < springs->net.nodes; v++) {
        const float *now = body->surface.positions + 3 * (size_t)v;
        const float *x = state[v / LANES].x + v % LANES;
        const vec3 at = { (double)now[0], (double)now[1], (double)now[2] };
        if (now[0] != x[0] || now[1] != x[LANES] || now[2] != x[2 * LANES])
            dpti_spring_contact_hold(springs, v, at, tool_motion_at(world, body, at), &touch);
    }
    dpti_spring_contact_end(springs);
}

/* ---- solved together ---- */

/* m: pairs within this reach of the proxy may come to carry force in a step, and those that what moves can reach. */
#define REACH 1e-4

static int body_is_solved(const struct body *body)
{
    const dpt_deformable_def *def = &deform_of(body)->def;
    return def->response == DPT_RESPONSE_LOAD && !(def->load_radius > 0.0) && !(def->period > 0.0);
}

/* Whether a tool has a proxy that was outside in the last step, and nothing of which its wrench still has a memory. */
static int tool_can_be_solved(const struct dpt_world *world, const struct tool *tool)
{
    if (!tool->slot.used || !tool_is_active(world, tool) || !dpti_proxy_is_used(world, tool))
        return 0;
    const struct proxy *proxy = proxy_of(world, tool);
    return proxy->tick == world->ticks && proxy->state == PROXY_OUTSIDE && !(proxy->fade.time_left > 0.0) &&
           tool->stiffness > 0.0 && !(tool->damping > 0.0);
}

static struct tissue_body *solved_body(struct tissue_solve *solve, const struct body *body)
{
    for (uint32_t i = 0; i < solve->body_count; i++)
        if (solve->bodies[i].body == body)
            return &solve->bodies[i];
    return NULL;
}

/* m: how far from the proxy pairs may come to carry force. What is fast now was so in the last step. */
static double reach_of(const struct tissue_solve *solve, double dt)
{
    float square = 0.0f;
    for (uint32_t b = 0; b < solve->body_count; b++) {
        const struct active_region *region = &solve->bodies[b].step.springs->region;
        for (uint32_t i = 0; i < region->count; i++)
            square = region->square[region->slices[i]] > square ? region->square[region->slices[i]] : square;
    }
    return REACH + sqrt((double)square) * dt;
}

/* The touches of a tool and the bodies of the solve, or the other bodies. */
static void gather_from(struct tissue_solve *solve, struct touch_search *search, int is_solved)
{
    struct dpt_world *world = search->world;
    for (uint32_t i = 0; i < world->body_slot_end; i++) {
        search->body = &world->bodies[i];
        if (body_is_there(search->body) && !is_solved == !solved_body(solve, search->body))
            dpti_touches_gather(search, &solve->touches);
    }
}

/* Whether the surfaces that a tool may touch are smooth and hard. */
static int touches_are_plain(const struct dpt_world *world, const struct touches *touches, uint32_t first)
{
    for (uint32_t i = first; i < touches->count; i++) {
        const struct body *body = world_find_body(world, touches->touch[i].body_id);
        if (body->static_friction > 0.0 || body->stiffness > 0.0)
            return 0;
    }
    return 1;
}

static void gather_tool(struct tissue_solve *solve, struct dpt_world *world, const struct tool *tool, double reach)
{
    const uint32_t first = solve->touches.count;
    const struct proxy *proxy = proxy_of(world, tool);
    const struct proxy_pose at = dpti_proxy_pose_of(proxy, &proxy->pose);
    const struct proxy_pose device = dpti_proxy_pose_of(proxy, &tool->pose);
    const struct displacement way = dpti_proxy_displacement(proxy, &at, &device);
    double away[TOUCH_DIMENSIONS] = { 0.0 };
    vec3 axes[3];
    struct touch_search search = { world, tool, proxy, &at, NULL, away, reach + proxy->last_motion };
    dpti_proxy_turn_axes(proxy, &at, axes);
    dpti_proxy_to_unknowns(proxy, axes, &way, away);
    gather_from(solve, &search, 1);
    if (solve->touches.count > first)
        gather_from(solve, &search, 0);
    if (!touches_are_plain(world, &solve->touches, first))
        solve->touches.count = first;
}

/* The touches of all tools that touch a body of the solve. */
static void gather(struct tissue_solve *solve, struct dpt_world *world, double reach)
{
    solve->touches.count = solve->touches.is_full = 0;
    for (uint32_t t = 0; t < world->tool_slot_end; t++)
        if (tool_can_be_solved(world, &world->tools[t]))
            gather_tool(solve, world, &world->tools[t], reach);
}

static int tool_is_solved(const struct tissue_solve *solve, uint32_t tool_slot)
{
    for (uint32_t i = 0; i < solve->touches.count; i++)
        if (solve->touches.touch[i].tool_slot == tool_slot)
            return 1;
    return 0;
}

/* What is felt may differ by that share of it, and by that much, N, from what the proxy says. */
#define APART_SHARE 0.05
#define APART_FORCE 5e-3

/*
 * J: what the bodies did on the tool in this tick. The spring's energy grew by that and by what the device did; the force
 * is the mean of this tick's and the last one's.
 */
static double work_of_bodies(const struct tool *tool, const struct proxy *proxy, const struct displacement *felt)
{
    const struct coupling *coupling = &proxy->coupling;
    const struct proxy_pose from = dpti_proxy_pose_of(proxy, &proxy->last_device_pose);
    const struct proxy_pose to = dpti_proxy_pose_of(proxy, &tool->pose);
    const struct displacement moved = dpti_proxy_displacement(proxy, &from, &to);
    const struct displacement both = displacement_sum(felt, 1.0, &proxy->last_felt);
    return coupling_energy(coupling, felt) - coupling_energy(coupling, &proxy->last_felt) +
           0.5 * coupling->stiffness * displacement_dot(coupling, &both, &moved);
}

/* The displacement from the device that is felt. The proxy's own is that of the world's step. */
static void note_felt(const struct tissue_solve *solve, struct tool *tool, struct proxy *proxy,
                      struct displacement felt)
{
    const struct displacement between = displacement_sum(&felt, -1.0, &proxy->felt);
    const double apart = displacement_norm(&proxy->coupling, &between);
    const double allowed =
        APART_SHARE * displacement_norm(&proxy->coupling, &felt) + APART_FORCE / proxy->coupling.stiffness;
    tool->force_flags &= ~(uint32_t)(DPT_FORCE_FLAG_APART | DPT_FORCE_FLAG_CROWDED);
    tool->force_flags |= apart > allowed ? DPT_FORCE_FLAG_APART : 0u;
    tool->force_flags |= solve->is_full || solve->touches.is_full ? DPT_FORCE_FLAG_CROWDED : 0u;
    tool->energy = coupling_energy(&proxy->coupling, &felt);
    tool->body_work = proxy->body_work = work_of_bodies(tool, proxy, &felt);
    proxy->felt = felt;
}

/* What a tool feels: the pushes of its touches, about its device's origin. What a program's own function added stays. */
static void set_wrench(const struct tissue_solve *solve, struct dpt_world *world, struct tool *tool, uint32_t slot)
{
    struct proxy *proxy = proxy_of(world, tool);
    const struct proxy_pose at = dpti_proxy_pose_of(proxy, &proxy->pose);
    vec3 force = { 0.0, 0.0, 0.0 }, torque = force, axes[3];
    double unknowns[TOUCH_DIMENSIONS] = { 0.0 };
    const dpt_wrench law = tool->law_wrench, shaped = tool->wrench;
    dpti_loads_forget(world, tool);
    for (uint32_t i = 0; i < solve->touches.count; i++) {
        const struct touch *touch = &solve->touches.touch[i];
        const vec3 push = scaled(touch->normal, solve->push[i]);
        if (touch->tool_slot != slot || !(solve->push[i] > 0.0))
            continue;
        force = add(force, push);
        torque = add(torque, cross(sub(touch->at, vec3_of(tool->pose.position)), push));
        for (uint32_t k = 0; k < TOUCH_DIMENSIONS; k++)
            unknowns[k] += solve->push[i] * touch->row[k] / proxy->coupling.stiffness;
        dpti_loads_note_push(world, tool, touch->part, touch->body_id, touch->triangle, touch->at, scaled(push, -1.0));
    }
    vec3_store(force, tool->wrench.force);
    vec3_store(torque, tool->wrench.torque);
    tool->force_reason = dot(force, force) > 0.0 ? (uint32_t)DPT_FORCE_ACTS : (uint32_t)DPT_FORCE_FREE;
    proxy->reason = tool->force_reason;
    dpti_loads_settle(world, tool);
    for (int k = 0; k < 3; k++) {
        tool->wrench.force[k] += shaped.force[k] - law.force[k];
        tool->wrench.torque[k] += shaped.torque[k] - law.torque[k];
    }
    dpti_proxy_turn_axes(proxy, &at, axes);
    note_felt(solve, tool, proxy, dpti_proxy_of_unknowns(proxy, axes, unknowns));
}

/* Loads of tools that are not solved for are those of the world's step. */
static dpt_result begin_bodies(struct tissue_solve *solve, struct dpt_world *world, double dt)
{
    uint32_t substeps = 1, count[TISSUE_BODIES_MAX];
    for (uint32_t b = 0; b < solve->body_count; b++) {
        struct dpt_springs *springs = solve->bodies[b].step.springs;
        const uint32_t own = dpti_springs_substeps_of(springs, dt);
        substeps = own > substeps ? own : substeps;
        DPT_TRY(dpt_body_get_loads(world, solve->bodies[b].body->id, springs->vertices.loads, springs->def.max_loads,
                                   &count[b]));
    }
    for (uint32_t b = 0; b < solve->body_count; b++)
        dpti_loaded_step_begin(&solve->bodies[b].step, solve->bodies[b].step.springs, dt, substeps, count[b]);
    return DPT_OK;
}

static dpt_result move_vertices(struct dpt_world *world, dpt_body id, struct dpt_springs *springs)
{
    const struct spring_vertices *vertices = &springs->vertices;
    const uint32_t moved = dpti_spring_vertices_gather(springs);
    return moved == springs->def.mesh->vertices
               ? dpt_body_set_vertices(world, id, 0, moved, vertices->positions, -1.0)
               : dpt_body_set_vertex_list(world, id, vertices->list, moved, vertices->positions, -1.0);
}

/* How often touches are gathered again because the answer goes farther than they reach. */
enum { GATHERED_AGAIN = 2 };

static int make_substeps(struct tissue_solve *solve, struct dpt_world *world, double reach)
{
    const uint32_t substeps = solve->bodies[0].step.info.substeps;
    int is_done = 1;
    dpti_tissue_link(solve, world);
    for (uint32_t i = 0; i < substeps && is_done; i++) {
        double farthest = dpti_tissue_solve(solve);
        for (int again = 0; i == 0 && farthest > reach && again < GATHERED_AGAIN; again++) {
            reach = 2.0 * farthest;
            gather(solve, world, reach);
            dpti_tissue_link(solve, world);
            farthest = dpti_tissue_solve(solve);
        }
        is_done = dpti_tissue_substep(solve);
    }
    return is_done;
}

/* All bodies of the solve, and the tools that touch them. */
static dpt_result step_together(struct tissue_solve *solve, struct dpt_world *world, double dt, dpt_springs_info *infos)
{
    dpt_result result = DPT_OK;
    for (uint32_t t = 0; t < world->tool_slot_end; t++)
        if (tool_is_solved(solve, t))
            dpti_loads_forget(world, &world->tools[t]);
    DPT_TRY(begin_bodies(solve, world, dt));
    const int is_done = make_substeps(solve, world, reach_of(solve, dt));
    for (uint32_t b = 0; b < solve->body_count; b++) {
        const dpt_result one =
            dpti_loaded_step_end(&solve->bodies[b].step, is_done, infos ? &infos[solve->bodies[b].number] : NULL);
        result = result ? result : one;
    }
    DPT_TRY(result);
    for (uint32_t t = 0; t < world->tool_slot_end; t++)
        if (tool_is_solved(solve, t))
            set_wrench(solve, world, &world->tools[t], t);
    for (uint32_t b = 0; b < solve->body_count; b++) {
        const dpt_result one = move_vertices(world, solve->bodies[b].body->id, solve->bodies[b].step.springs);
        result = result ? result : one;
    }
    return result;
}

/* A body by itself, with the loads of the last step of the world. */
static dpt_result step_alone(struct dpt_world *world, const struct body *body, struct dpt_springs *springs, double dt,
                             dpt_springs_info *info)
{
    const struct spring_vertices *vertices = &springs->vertices;
    uint32_t count = 0;
    if (deform_of(body)->def.response == DPT_RESPONSE_LOAD)
        DPT_TRY(dpt_body_get_loads(world, body->id, vertices->loads, springs->def.max_loads, &count));
    else if (vertices->nodes || deform_of(body)->def.period > 0.0)
        return DPT_E_UNSUPPORTED;
    else
        take_displaced(world, body, springs, dt);
    DPT_TRY(dpti_springs_step_loaded(springs, dt, count, info));
    return move_vertices(world, body->id, springs);
}

static dpt_result check(const struct dpt_world *world, dpt_body id, const struct dpt_springs *springs, double dt,
                        const dpt_springs_info *info)
{
    if (!springs)
        return DPT_E_ARGUMENT;
    const struct body *body = world_find_body(world, id);
    if (!body || !body->surface.motion)
        return DPT_E_HANDLE;
    if (springs->def.mesh != body->surface.mesh)
        return DPT_E_ARGUMENT;
    return dpti_springs_check_step(springs, dt, info);
}

/* Bodies that are to be stepped. */
struct step_list {
    const dpt_body *bodies;
    dpt_springs *const *springs;
    uint32_t count;
};

static void take_body(struct tissue_solve *solve, const struct dpt_world *world, const struct step_list *list,
                      uint32_t number)
{
    solve->bodies[solve->body_count++] = (struct tissue_body){ .number = number,
                                                               .body = world_find_body(world, list->bodies[number]),
                                                               .step = { .springs = list->springs[number] } };
}

/* The bodies that tools touch, and their touches; NULL if there are none. The first of them lends its memory. */
static struct tissue_solve *begin_solve(struct dpt_world *world, const struct step_list *list, double dt)
{
    struct tissue_solve *solve = NULL;
    uint32_t touched[TISSUE_BODIES_MAX], count = 0;
    for (uint32_t i = 0; i < list->count; i++) {
        const struct body *body = world_find_body(world, list->bodies[i]);
        struct tissue_solve *own = deform_of(body)->solve;
        if (!own || !body_is_solved(body))
            continue;
        own->body_count = own->is_full = 0;
        take_body(own, world, list, i);
        gather(own, world, reach_of(own, dt));
        if (!own->touches.count)
            continue;
        solve = solve ? solve : own;
        if (count == TISSUE_BODIES_MAX)
            solve->is_full = 1;
        else
            touched[count++] = i;
    }
    if (count < 2)
        return solve;
    solve->body_count = 0;
    for (uint32_t i = 0; i < count; i++)
        take_body(solve, world, list, touched[i]);
    gather(solve, world, reach_of(solve, dt));
    return solve;
}

static int is_in_solve(const struct tissue_solve *solve, uint32_t number)
{
    for (uint32_t b = 0; solve && b < solve->body_count; b++)
        if (solve->bodies[b].number == number)
            return 1;
    return 0;
}

dpt_result dpt_bodies_step_springs(dpt_world *world, const dpt_body *bodies, dpt_springs *const *springs,
                                   uint32_t count, double dt, dpt_springs_info *infos)
{
    const struct step_list list = { bodies, springs, count };
    if (!world || (count && (!bodies || !springs)))
        return DPT_E_ARGUMENT;
    for (uint32_t i = 0; i < count; i++) {
        DPT_TRY(check(world, bodies[i], springs[i], dt, infos ? &infos[i] : NULL));
        for (uint32_t k = 0; k < i; k++)
            if (bodies[k] == bodies[i] || springs[k] == springs[i])
                return DPT_E_ARGUMENT;
    }
    struct tissue_solve *solve = begin_solve(world, &list, dt);
    if (solve)
        DPT_TRY(step_together(solve, world, dt, infos));
    for (uint32_t i = 0; i < count; i++)
        if (!is_in_solve(solve, i))
            DPT_TRY(step_alone(world, world_find_body(world, bodies[i]), springs[i], dt, infos ? &infos[i] : NULL));
    return DPT_OK;
}

dpt_result dpt_body_step_springs(dpt_world *world, dpt_body body, dpt_springs *springs, double dt,
                                 dpt_springs_info *info)
{
    return dpt_bodies_step_springs(world, &body, &springs, 1, dt, info);
}
