/* SPDX-License-Identifier: BSD-3-Clause */
/* Springs that move a deformable body: docs/algorithms/springs.md. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "base/return_if_error.h"
#include "deform/spring_contact.h"
#include "deform/spring_vertices.h"
#include "strip/strip_state.h"
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

dpt_result dpt_body_step_springs(dpt_world *world, dpt_body id, dpt_springs *springs, double dt, dpt_springs_info *info)
{
    uint32_t count = 0;
    if (!world || !springs)
        return DPT_E_ARGUMENT;
    const struct body *body = world_find_body(world, id);
    if (!body || !body->surface.motion)
        return DPT_E_HANDLE;
    if (springs->def.mesh != body->surface.mesh)
        return DPT_E_ARGUMENT;
    DPT_TRY(dpti_springs_check_step(springs, dt, info));
    const struct spring_vertices *vertices = &springs->vertices;
    if (deform_of(body)->def.response == DPT_RESPONSE_LOAD)
        DPT_TRY(dpt_body_get_loads(world, id, vertices->loads, springs->def.max_loads, &count));
    else if (vertices->nodes || deform_of(body)->def.period > 0.0)
        return DPT_E_UNSUPPORTED;
    else
        take_displaced(world, body, springs, dt);
    DPT_TRY(dpti_springs_step_loaded(springs, dt, count, info));
    const uint32_t moved = dpti_spring_vertices_gather(springs);
    return moved == body->surface.mesh->vertices
               ? dpt_body_set_vertices(world, id, 0, moved, vertices->positions, -1.0)
               : dpt_body_set_vertex_list(world, id, vertices->list, moved, vertices->positions, -1.0);
}
