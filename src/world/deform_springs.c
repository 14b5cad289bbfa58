/* SPDX-License-Identifier: BSD-3-Clause */
/* Springs that move a deformable body: docs/algorithms/springs.md. */
#include "base/return_if_error.h"
#include "deform/spring_vertices.h"
#include "world/deform_body.h"

/* Vertices that a tool has moved are nodes at rest where they are. */
static dpt_result take_displaced(struct dpt_springs *springs, const struct surface *surface)
{
    const struct spring_slice *state = springs->state[springs->now];
    for (uint32_t v = 0; v < springs->net.nodes; v++) {
        const float *now = surface->positions + 3 * (size_t)v;
        const float *x = state[v / LANES].x + v % LANES;
        if (now[0] != x[0] || now[1] != x[LANES] || now[2] != x[2 * LANES])
            DPT_TRY(dpt_springs_set_nodes(springs, v, 1, now, NULL));
    }
    return DPT_OK;
}

dpt_result dpt_deform_step_springs(dpt_world *world, dpt_body id, dpt_springs *springs, double dt,
                                   dpt_springs_report *report)
{
    uint32_t count = 0;
    if (!world || !springs)
        return DPT_E_ARGUMENT;
    const struct body *body = world_find_body(world, id);
    if (!body || !body->surface.motion)
        return DPT_E_HANDLE;
    if (springs->def.mesh != body->surface.mesh)
        return DPT_E_ARGUMENT;
    const struct spring_vertices *vertices = &springs->vertices;
    if (deform_of(body)->def.response == DPT_RESPONSE_LOAD)
        DPT_TRY(dpt_deform_get_loads(world, id, vertices->loads, springs->def.max_loads, &count));
    else if (vertices->nodes)
        return DPT_E_UNSUPPORTED;
    else
        DPT_TRY(take_displaced(springs, &body->surface));
    DPT_TRY(dpti_springs_step_loaded(springs, dt, count, report));
    const uint32_t moved = dpti_spring_vertices_gather(springs);
    return moved == body->surface.mesh->vertices
               ? dpt_deform_set_vertices(world, id, 0, moved, vertices->positions, -1.0)
               : dpt_deform_set_vertex_list(world, id, vertices->list, moved, vertices->positions,
                                            -1.0);
}
