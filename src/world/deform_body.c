/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/deform_body.h"

#include "base/return_if_error.h"
#include "base/sized.h"
#include "deform/deform_vertices.h"
#include "world/body.h"

void dpt_deform_def_defaults(dpt_deform_def *def, size_t size)
{
    const dpt_deform_def defaults = { .size = sizeof defaults };
    sized_defaults(def, size, &defaults, sizeof defaults);
}

/* The default box: the mesh's, wider by that share of its diagonal. */
#define BOX_SHARE 0.5

static void set_default_box(const struct dpt_mesh *mesh, dpt_deform_def *def)
{
    double wider = BOX_SHARE * length(sub(vec3_of(mesh->box_max), vec3_of(mesh->box_min)));
    for (int k = 0; k < 3; k++) {
        if (def->box_min[k] != 0.0 || def->box_max[k] != 0.0)
            return;
    }
    if (!(wider > 0.0))
        wider = 1.0;
    for (int k = 0; k < 3; k++) {
        def->box_min[k] = max_of(mesh->box_min[k] - wider, -DPT_COORDINATE_MAX);
        def->box_max[k] = min_of(mesh->box_max[k] + wider, DPT_COORDINATE_MAX);
    }
}

/* Read and check a caller's def; the box is set, and rounded to float. */
static dpt_result read_def(const dpt_deform_def *given, dpt_deform_def *def)
{
    dpt_deform_def_init(def);
    if (!given)
        return DPT_E_ARGUMENT;
    DPT_TRY(sized_read(given, sizeof *given, def, sizeof *def));
    if (!def->mesh || def->reserved)
        return DPT_E_ARGUMENT;
    set_default_box(def->mesh, def);
    if (!vec3_within(def->box_min, DPT_COORDINATE_MAX) ||
        !vec3_within(def->box_max, DPT_COORDINATE_MAX))
        return DPT_E_FINITE;
    for (int k = 0; k < 3; k++) {
        def->box_min[k] = (float)def->box_min[k];
        def->box_max[k] = (float)def->box_max[k];
        if (!(def->box_min[k] <= def->mesh->box_min[k] && def->box_max[k] >= def->mesh->box_max[k]))
            return DPT_E_ARGUMENT;
    }
    return mesh_tail(def->mesh).winding_components ? DPT_E_UNSUPPORTED : DPT_OK;
}

/* The arrays begin at a multiple of 64 in memory, wherever the block does. */
static uint64_t bytes_of(const dpt_deform_def *def)
{
    return mesh_aligned(sizeof(struct deform)) + MESH_ALIGN + dpti_surface_motion_bytes(def->mesh);
}

size_t dpt_deform_bytes(const dpt_deform_def *given)
{
    dpt_deform_def def;
    if (read_def(given, &def) != DPT_OK)
        return 0;
    const uint64_t bytes = bytes_of(&def);
    return bytes <= SIZE_MAX ? (size_t)bytes : 0;
}

dpt_result dpt_deform_add(dpt_world *world, void *block, size_t bytes, const dpt_deform_def *given,
                          dpt_body *body)
{
    dpt_deform_def def;
    struct frame frame;
    if (!world || !block || !body)
        return DPT_E_ARGUMENT;
    DPT_TRY(read_def(given, &def));
    DPT_TRY(frame_of_pose(def.pose, &frame));
    if ((uintptr_t)block % 8)
        return DPT_E_ALIGN;
    if (bytes < bytes_of(&def))
        return DPT_E_MEMORY;
    struct deform *made = block;
    struct surface surface;
    uintptr_t at = (uintptr_t)mesh_aligned((uintptr_t)block + sizeof *made);
    DPT_TRY(dpti_body_can_add(world));
    made->def = def;
    made->def.pose = NULL;
    dpti_surface_of_motion(def.mesh, def.box_min, def.box_max,
                           (char *)block + (at - (uintptr_t)block), &made->motion, &surface);
    *body = dpti_body_add(world, &surface, def.pose);
    return DPT_OK;
}

static struct body *find_deformable(const struct dpt_world *world, dpt_body body)
{
    struct body *found = world_find_body(world, body);
    return found && found->surface.motion ? found : NULL;
}

/* Check an update of a body, and make it. */
static dpt_result move_vertices(struct dpt_world *world, struct body *body,
                                const struct vertex_update *update)
{
    int has_begun_anew;
    if (!dpti_deform_is_inside(&body->surface, &world->kernel, update->positions, update->count))
        return DPT_E_FINITE;
    if (!update->count)
        return DPT_OK;
    const double moved = dpti_deform_move(&body->surface, &world->kernel, update, &has_begun_anew);
    dpti_body_note_vertices(world, body, moved, has_begun_anew);
    return DPT_OK;
}

/* The bound that a caller states, or a negative one. */
static int bound_is_valid(double bound)
{
    return within(bound, DPT_COORDINATE_MAX);
}

dpt_result dpt_deform_set_vertices(dpt_world *world, dpt_body id, uint32_t first, uint32_t count,
                                   const float *positions, double bound)
{
    if (!world || (!positions && count) || !bound_is_valid(bound))
        return DPT_E_ARGUMENT;
    struct body *body = find_deformable(world, id);
    if (!body)
        return DPT_E_HANDLE;
    const uint32_t vertices = body->surface.mesh->vertices;
    if (first > vertices || count > vertices - first)
        return DPT_E_ARGUMENT;
    const struct vertex_update update = { .positions = positions,
                                          .first = first,
                                          .count = count,
                                          .bound = bound,
                                          .tick = world->ticks + 1 };
    return move_vertices(world, body, &update);
}

dpt_result dpt_deform_set_vertex_list(dpt_world *world, dpt_body id, const uint32_t *vertices,
                                      uint32_t count, const float *positions, double bound)
{
    if (!world || ((!positions || !vertices) && count) || !bound_is_valid(bound))
        return DPT_E_ARGUMENT;
    struct body *body = find_deformable(world, id);
    if (!body)
        return DPT_E_HANDLE;
    for (uint32_t i = 0; i < count; i++)
        if (vertices[i] >= body->surface.mesh->vertices)
            return DPT_E_ARGUMENT;
    const struct vertex_update update = { .positions = positions,
                                          .list = vertices,
                                          .count = count,
                                          .bound = bound,
                                          .tick = world->ticks + 1 };
    return move_vertices(world, body, &update);
}

dpt_result dpt_deform_get_vertices(const dpt_world *world, dpt_body id, const float **positions,
                                   uint32_t *count)
{
    if (!world || !positions || !count)
        return DPT_E_ARGUMENT;
    const struct body *body = find_deformable(world, id);
    *positions = body ? body->surface.positions : NULL;
    *count = body ? body->surface.mesh->vertices : 0;
    return body ? DPT_OK : DPT_E_HANDLE;
}
