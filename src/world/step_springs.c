/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Springs of bodies, stepped with the tools that touch them: docs/algorithms/tissue.md. What a tool does to a body that
 * cannot be solved for together with it is a load of the tick before. A body whose physics is somebody else's has no springs,
 * but a compliance.
 */
#include <float.h>
#include <math.h>
#include <string.h>

#include "base/return_if_error.h"
#include "base/sized.h"
#include "deform/spring_contact.h"
#include "deform/spring_vertices.h"
#include "proxy/tool_loads.h"
#include "strip/strip_state.h"
#include "tissue/tissue_end.h"
#include "tissue/tissue_link.h"
#include "tissue/tissue_solve.h"
#include "tissue/tissue_tools.h"
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
    return def->response == DPT_RESPONSE_LOAD && (!(def->period > 0.0) || def->compliance > 0.0);
}

/* Of the last step of a body. */
static dpt_result *result_of(const struct body *body, struct dpt_springs *springs)
{
    return springs ? &springs->result : &deform_of(body)->yield->result;
}

static struct spring_vertices *vertices_of(struct loaded_step *step)
{
    return step->yield ? &step->yield->moved : &step->springs->vertices;
}

static uint32_t gather_vertices(struct loaded_step *step)
{
    return step->yield ? dpti_yield_gather(step->yield) : dpti_spring_vertices_gather(step->springs);
}

/* m: how far from the proxy pairs may come to carry force. What is fast now was so in the last step. */
static double reach_of(const struct tissue_solve *solve, double dt)
{
    float square = 0.0f;
    for (uint32_t b = 0; b < solve->body_count; b++) {
        const struct dpt_springs *springs = solve->bodies[b].step.springs;
        for (uint32_t i = 0; springs && i < springs->region.count; i++) {
            const float of = springs->region.square[springs->region.slices[i]];
            square = of > square ? of : square;
        }
    }
    return REACH + sqrt((double)square) * dt;
}

static void gather(struct tissue_solve *solve, struct dpt_world *world, double dt)
{
    const double reach = reach_of(solve, dt);
    dpti_tissue_gather(solve, world, reach, reach);
}

static int is_solved_for(const void *user, uint32_t tool_slot)
{
    const struct tissue_solve *solve = user;
    for (uint32_t t = 0; t < solve->tool_count; t++)
        if (solve->tools[t].slot == tool_slot)
            return 1;
    return 0;
}

/* Begin the steps of all bodies. Loads of tools that are not solved for are those of the world's step. */
static void begin_bodies(struct tissue_solve *solve, const struct dpt_world *world, double dt)
{
    const uint32_t substeps = dpti_tissue_substeps(solve, dt);
    uint32_t count[TISSUE_BODIES_MAX];
    for (uint32_t b = 0; b < solve->body_count; b++) {
        struct dpt_springs *springs = solve->bodies[b].step.springs;
        if (!springs)
            continue;
        springs->result = dpti_deform_get_loads(world, solve->bodies[b].body, is_solved_for, solve,
                                                springs->vertices.loads, springs->def.max_loads, &count[b]);
        if (springs->result != DPT_OK)
            count[b] = 0;
    }
    for (uint32_t b = 0; b < solve->body_count; b++) {
        struct loaded_step *step = &solve->bodies[b].step;
        if (step->yield)
            dpti_loaded_step_begin_yield(step, step->yield, solve->dt, dt / solve->dt, substeps);
        else
            dpti_loaded_step_begin(step, step->springs, dt, substeps, count[b], solve->is_touched != 0);
    }
}

static struct body *body_of(struct dpt_world *world, const struct tissue_body *of)
{
    return world_find_body(world, of->body->id);
}

/* Take the state that a step of springs has reached, if the body's vertices may be there. */
static dpt_result take_springs(struct dpt_world *world, struct body *body, struct loaded_step *step, uint32_t *moved)
{
    dpti_loaded_step_take(step);
    *moved = dpti_spring_vertices_gather(step->springs);
    return dpti_deform_has_room(world, body, &step->springs->vertices, *moved) ? DPT_OK : DPT_E_FINITE;
}

/* The same for a body whose physics is somebody else's. */
static dpt_result take_yield(struct dpt_world *world, struct body *body, struct loaded_step *step, uint32_t *moved)
{
    *moved = dpti_yield_gather(step->yield);
    return dpti_deform_has_room(world, body, &step->yield->moved, *moved) ? DPT_OK : DPT_E_FINITE;
}

static void write_info(const struct loaded_step *step, dpt_springs_info *info)
{
    if (info)
        sized_write(info, info->size, &step->info, sizeof step->info);
}

/* How often touches are gathered again because the answer goes farther than they reach. */
enum { GATHERED_AGAIN = 2 };

static int make_substeps(struct tissue_solve *solve, struct dpt_world *world, double reach)
{
    const uint32_t substeps = solve->bodies[0].step.info.substeps;
    int is_done = 1;
    dpti_tissue_link(solve);
    for (uint32_t i = 0; i < substeps && is_done; i++) {
        solve->substep = i;
        double farthest = dpti_tissue_solve(solve);
        for (int again = 0; i == 0 && farthest > reach && !solve->is_cut && again < GATHERED_AGAIN; again++) {
            if (work_is_spent(&solve->work)) {
                solve->is_full = 1;
                break;
            }
            const double least = reach;
            reach = 2.0 * farthest;
            dpti_tissue_gather(solve, world, reach, least);
            dpti_tissue_link(solve);
            farthest = dpti_tissue_solve(solve);
        }
        is_done = dpti_tissue_substep(solve);
    }
    return is_done;
}

/* What contact took, in the first body's info. */
static void tell_work(struct tissue_solve *solve, uint32_t units, dpt_springs_info *infos)
{
    dpt_springs_info *of = &solve->bodies[0].step.info;
    of->work = units;
    if (infos)
        sized_write(&infos[solve->bodies[0].number], infos[solve->bodies[0].number].size, of, sizeof *of);
}

/* Whether all bodies of the solve can go where their steps have led. If not, those that cannot are known by their result. */
static int take_steps(struct tissue_solve *solve, struct dpt_world *world, int is_done, uint32_t *moved)
{
    int is_whole = 1;
    for (uint32_t b = 0; b < solve->body_count; b++) {
        struct loaded_step *step = &solve->bodies[b].step;
        dpt_result *result = result_of(solve->bodies[b].body, step->springs);
        if (step->has_failed)
            *result = DPT_E_FINITE;
        else if (is_done && *result == DPT_OK)
            *result =
                (step->yield ? take_yield : take_springs)(world, body_of(world, &solve->bodies[b]), step, &moved[b]);
        is_whole &= *result == DPT_OK;
    }
    return is_whole;
}

static void undo_steps(struct tissue_solve *solve)
{
    for (uint32_t b = 0; b < solve->body_count; b++)
        dpti_loaded_step_undo(&solve->bodies[b].step);
}

static void follow_steps(struct tissue_solve *solve, struct dpt_world *world, const uint32_t *moved)
{
    for (uint32_t b = 0; b < solve->body_count; b++)
        dpti_deform_follow(world, body_of(world, &solve->bodies[b]), vertices_of(&solve->bodies[b].step), moved[b]);
}

/* How often a step is halved that takes a surface through a tool: tissue that moves so fast is slowed. */
enum { CUTS_MAX = 5 };

/* Everything is where it was again, and less of the tick is to be stepped. */
static void cut_step(struct tissue_solve *solve, struct dpt_world *world, const uint32_t *had_moved)
{
    dpti_tissue_unend(solve, world);
    undo_steps(solve);
    for (uint32_t b = 0; b < solve->body_count; b++) {
        struct loaded_step *step = &solve->bodies[b].step;
        dpti_deform_return(world, body_of(world, &solve->bodies[b]), vertices_of(step), gather_vertices(step),
                           !had_moved[b]);
    }
    solve->step *= 0.5;
    gather(solve, world, solve->step);
}

/* What tools do to a body whose physics is somebody else's joins the mean of its loads. */
static void note_loads(struct dpt_world *world, const struct body *body, double dt)
{
    struct local_yield *yield = deform_of(body)->yield;
    uint32_t count;
    yield->result = dpti_deform_get_loads(world, body, NULL, NULL, yield->loads, yield->load_room, &count);
    if (yield->result == DPT_OK && !dpti_yield_note(yield, body->surface.positions, count, dt))
        yield->result = DPT_E_FULL;
}

/*
 * All bodies of the solve, and the tools that touch them. Returns 0 if a body cannot be stepped: then all are where they
 * were, and its result says why.
 */
static int step_together(struct tissue_solve *solve, struct dpt_world *world, double dt, dpt_springs_info *infos)
{
    uint32_t moved[TISSUE_BODIES_MAX] = { 0 }, had_moved[TISSUE_BODIES_MAX];
    for (uint32_t b = 0; b < solve->body_count; b++)
        had_moved[b] = (uint32_t)surface_has_moved(&solve->bodies[b].body->surface, world_coming_tick(world));
    for (int cut = 0;; cut++) {
        begin_bodies(solve, world, solve->step);
        const int is_done = make_substeps(solve, world, reach_of(solve, solve->step));
        if (!take_steps(solve, world, is_done, moved)) {
            undo_steps(solve);
            return 0;
        }
        dpti_tissue_end(solve, world);
        follow_steps(solve, world, moved);
        dpti_tissue_settle(solve, world);
        if (cut == CUTS_MAX || work_is_spent(&solve->work) || dpti_tissue_ways_are_free(solve, world))
            break;
        cut_step(solve, world, had_moved);
    }
    for (uint32_t b = 0; b < solve->body_count; b++) {
        struct loaded_step *step = &solve->bodies[b].step;
        if (step->yield)
            dpti_yield_keep(step->yield, step->dt);
        else
            dpti_loaded_step_keep(step);
        step->info.flags |= solve->step < dt ? (uint32_t)DPT_SPRINGS_FLAG_CUT : 0u;
        write_info(step, infos ? &infos[solve->bodies[b].number] : NULL);
    }
    dpti_tissue_tell(solve, world);
    tell_work(solve, solve->work.done, infos);
    for (uint32_t b = 0; b < solve->body_count; b++)
        if (solve->bodies[b].step.yield)
            note_loads(world, solve->bodies[b].body, dt);
    return 1;
}

/*
 * A body whose physics is somebody else's, where no tool is solved for with it: what has given way goes back, at once where
 * no load is left to it.
 */
static dpt_result yield_alone(struct dpt_world *world, struct body *body, double dt, dpt_springs_info *info)
{
    struct local_yield *yield = deform_of(body)->yield;
    struct loaded_step step;
    uint32_t moved, loads;
    dpti_loaded_step_begin_yield(&step, yield, dt, 1.0, 1);
    DPT_TRY(dpti_deform_get_loads(world, body, NULL, NULL, yield->loads, yield->load_room, &loads));
    dpti_loaded_step_set(&step);
    if (loads)
        dpti_yield_return(yield, dt);
    else
        dpti_loaded_step_go(&step);
    const dpt_result result = take_yield(world, body, &step, &moved);
    if (result != DPT_OK) {
        dpti_loaded_step_undo(&step);
        return result;
    }
    dpti_deform_follow(world, body, &yield->moved, moved);
    dpti_yield_keep(yield, dt);
    write_info(&step, info);
    return dpti_yield_note(yield, body->surface.positions, loads, dt) ? DPT_OK : DPT_E_FULL;
}

/* A body by itself, with the loads of the last step of the world. */
static dpt_result step_alone(struct dpt_world *world, struct body *body, struct dpt_springs *springs, double dt,
                             dpt_springs_info *info)
{
    struct loaded_step step;
    uint32_t count = 0, moved = 0;
    if (!springs)
        return yield_alone(world, body, dt, info);
    const struct spring_vertices *vertices = &springs->vertices;
    if (deform_of(body)->def.response == DPT_RESPONSE_LOAD)
        DPT_TRY(dpt_body_get_loads(world, body->id, vertices->loads, springs->def.max_loads, &count));
    else if (vertices->nodes || deform_of(body)->def.period > 0.0)
        return DPT_E_UNSUPPORTED;
    else
        take_displaced(world, body, springs, dt);
    const dpt_result result =
        dpti_loaded_step_make(&step, springs, dt, springs->vertices.loads, count, &springs->vertices)
            ? take_springs(world, body, &step, &moved)
            : DPT_E_FINITE;
    if (result != DPT_OK) {
        dpti_loaded_step_undo(&step);
        return result;
    }
    dpti_loaded_step_keep(&step);
    write_info(&step, info);
    dpti_deform_follow(world, body, vertices, moved);
    return DPT_OK;
}

static dpt_result check(const struct dpt_world *world, dpt_body id, const struct dpt_springs *springs, double dt,
                        const dpt_springs_info *info)
{
    const struct body *body = world_find_body(world, id);
    if (!body || !body->surface.motion)
        return springs ? DPT_E_HANDLE : DPT_E_ARGUMENT;
    if (!springs != (deform_of(body)->yield != NULL) || (springs && springs->def.mesh != body->surface.mesh))
        return DPT_E_ARGUMENT;
    return dpti_springs_check_step(dt, info);
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
    const struct body *body = world_find_body(world, list->bodies[number]);
    solve->bodies[solve->body_count++] = (struct tissue_body){
        .number = number, .body = body, .step = { .springs = list->springs[number], .yield = deform_of(body)->yield }
    };
}

/* The bodies that tools touch and that can be stepped, and their touches; NULL: none. The first of them lends its memory. */
static struct tissue_solve *begin_solve(struct dpt_world *world, const struct step_list *list, double dt)
{
    struct tissue_solve *solve = NULL;
    uint32_t touched[TISSUE_BODIES_MAX], count = 0;
    for (uint32_t i = 0; i < list->count; i++) {
        const struct body *body = world_find_body(world, list->bodies[i]);
        struct tissue_solve *own = (struct tissue_solve *)deform_of(body)->solve;
        if (!own || !body_is_solved(body) || *result_of(body, list->springs[i]) != DPT_OK)
            continue;
        own->body_count = own->is_full = 0;
        own->dt = own->step = dt;
        own->work = work_of(world->def.budget ? world->def.budget : WORK_UNLIMITED);
        take_body(own, world, list, i);
        gather(own, world, dt);
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
    for (uint32_t i = 0; i < count; i++) {
        const struct tissue_solve *own =
            (struct tissue_solve *)deform_of(world_find_body(world, list->bodies[touched[i]]))->solve;
        work_spend(&solve->work, own == solve ? 0 : own->work.done);
        take_body(solve, world, list, touched[i]);
    }
    gather(solve, world, dt);
    return solve;
}

/* The solve of the last tick, if its answer holds and all its bodies are to be stepped alike; else NULL. */
static struct tissue_solve *resting_solve(const struct dpt_world *world, const struct step_list *list, double dt)
{
    for (uint32_t i = 0; i < list->count; i++) {
        struct tissue_solve *solve = (struct tissue_solve *)deform_of(world_find_body(world, list->bodies[i]))->solve;
        uint32_t found = 0;
        for (uint32_t b = 0; solve && b < solve->body_count; b++) {
            const uint32_t number = solve->bodies[b].number;
            found += number < list->count && solve->bodies[b].body == world_find_body(world, list->bodies[number]) &&
                     solve->bodies[b].step.springs == list->springs[number];
        }
        if (found && found == solve->body_count && solve->dt == dt && dpti_tissue_rests(solve, world))
            return solve;
    }
    return NULL;
}

/* Tell the answer of the last tick again. */
static void rest_together(struct tissue_solve *solve, struct dpt_world *world, dpt_springs_info *infos)
{
    dpti_tissue_tell_again(solve, world);
    tell_work(solve, 0, infos);
    for (uint32_t b = 0; infos && b < solve->body_count; b++) {
        dpt_springs_info *info = &infos[solve->bodies[b].number];
        sized_write(info, info->size, &solve->bodies[b].step.info, sizeof *info);
    }
}

static int is_in_solve(const struct tissue_solve *solve, uint32_t number)
{
    for (uint32_t b = 0; solve && b < solve->body_count; b++)
        if (solve->bodies[b].number == number)
            return 1;
    return 0;
}

/* A body is where it was: what is told of it. */
static void hold(struct dpt_world *world, struct body *body, struct dpt_springs *springs, dpt_springs_info *info)
{
    const dpt_springs_info told = { .size = sizeof told,
                                    .nodes = springs ? springs->net.nodes : body->surface.mesh->vertices,
                                    .stable_step = springs ? springs->stable_step : 0.0,
                                    .result = *result_of(body, springs) };
    body->held_tick = world_coming_tick(world);
    if (info)
        sized_write(info, info->size, &told, sizeof told);
}

/* Step the bodies that are not in the solve, one by one. Returns the result of the first that is held. */
static dpt_result step_others(struct dpt_world *world, const struct tissue_solve *solve, const struct step_list *list,
                              double dt, dpt_springs_info *infos)
{
    dpt_result result = DPT_OK;
    for (uint32_t i = 0; i < list->count; i++) {
        struct body *body = world_find_body(world, list->bodies[i]);
        dpt_result *own = result_of(body, list->springs[i]);
        dpt_springs_info *info = infos ? &infos[i] : NULL;
        if (*own == DPT_OK && !is_in_solve(solve, i))
            *own = step_alone(world, body, list->springs[i], dt, info);
        if (*own == DPT_OK)
            continue;
        hold(world, body, list->springs[i], info);
        result = result == DPT_OK ? *own : result;
    }
    return result;
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
            if (bodies[k] == bodies[i] || (springs[i] && springs[k] == springs[i]))
                return DPT_E_ARGUMENT;
    }
    for (uint32_t i = 0; i < count; i++)
        *result_of(world_find_body(world, bodies[i]), springs[i]) =
            !springs[i] || dpti_springs_substeps_of(springs[i], dt) ? DPT_OK : DPT_E_UNSTABLE;
    struct tissue_solve *solve = resting_solve(world, &list, dt);
    if (solve)
        rest_together(solve, world, infos);
    else
        while ((solve = begin_solve(world, &list, dt)) != NULL && !step_together(solve, world, dt, infos))
            ;
    return step_others(world, solve, &list, dt, infos);
}

dpt_result dpt_body_step_springs(dpt_world *world, dpt_body body, dpt_springs *springs, double dt,
                                 dpt_springs_info *info)
{
    return dpt_bodies_step_springs(world, &body, &springs, 1, dt, info);
}
