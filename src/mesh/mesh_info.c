/* SPDX-License-Identifier: BSD-3-Clause */
/* The public questions about an open mesh. */
#include "dynpoint/mesh.h"

#include "base/return_if_error.h"
#include "base/sized.h"
#include "base/vec3.h"
#include "mesh/surface.h"

dpt_result dpt_mesh_get_info(const dpt_mesh *mesh, dpt_mesh_info *info)
{
    if (!mesh || !info)
        return DPT_E_ARGUMENT;
    DPT_TRY(sized_check(info, SIZED_FIRST(dpt_mesh_info, solid_components), 0));
    const struct mesh_tail tail = mesh_tail(mesh);
    dpt_mesh_info own = {
        .format_version = mesh->version,
        .triangles = mesh->triangles,
        .vertices = mesh->vertices,
        .source_triangles = mesh->source_triangles,
        .source_vertices = mesh->source_vertices,
        .dropped_degenerate = mesh->dropped_degenerate,
        .dropped_duplicate = mesh->dropped_duplicate,
        .unused_vertices = mesh->unused_vertices,
        .concave_polygons = mesh->concave_polygons,
        .open_edges = mesh->open_edges,
        .nonmanifold_edges = mesh->nonmanifold_edges,
        .wrong_way_edges = mesh->wrong_way_edges,
        .components = mesh->parts,
        .closed_components = mesh->closed_components,
        .inward_components = mesh->inward_components,
        .turned_triangles = mesh->turned_triangles,
        .tree_levels = mesh->levels,
        .scale = mesh->scale,
        .rounding = mesh->rounding,
        .source_bytes = mesh->source_bytes,
        .source_hash = mesh->source_hash,
        .bytes = mesh->bytes,
        .solid_components = tail.solid_components,
        .cavities = tail.cavities,
        .winding_components = tail.winding_components,
        .buried_components = tail.buried_components,
        .crease_edges = tail.crease_edges,
        .normalless_vertices = tail.normalless_vertices,
        .crease = tail.crease,
        .self_intersections = tail.self_intersections,
        .self_intersections_more = tail.self_intersections_more,
        .nodes = tail.nodes,
        .outside_vertices = tail.outside_vertices,
        .outside_distance = tail.outside_distance,
        .spring_nodes = tail.spring_nodes,
        .springs = tail.springs,
        .spring_entries = tail.spring_entries,
        .fixed_nodes = tail.fixed_nodes,
        .viscosity = tail.viscosity,
        .spring_mass = tail.spring_mass,
        .poisson = tail.poisson,
        .stable_step = tail.stable_step,
    };
    memcpy(own.self_intersection, tail.self_intersection, sizeof own.self_intersection);
    memcpy(own.origin, tail.origin, sizeof own.origin);
    memcpy(own.box_min, mesh->box_min, sizeof own.box_min);
    memcpy(own.box_max, mesh->box_max, sizeof own.box_max);
    sized_write(info, info->size, &own, sizeof own);
    return DPT_OK;
}

dpt_result dpt_mesh_get_section(const dpt_mesh *mesh, uint32_t index, dpt_mesh_section *section)
{
    if (!mesh || !section || index >= mesh->section_count)
        return DPT_E_ARGUMENT;
    DPT_TRY(sized_check(section, sizeof *section, 0));
    const struct mesh_section *record = &mesh->section[index];
    dpt_mesh_section own = { .crc32 = record->crc32, .offset = record->offset, .bytes = record->bytes };
    memcpy(own.name, record->name, sizeof own.name);
    sized_write(section, section->size, &own, sizeof own);
    return DPT_OK;
}

/* The place of a triangle by its source number, or DPT_NONE. */
static uint32_t place_of(const dpt_mesh *mesh, uint32_t number)
{
    if (!mesh || number >= mesh->source_triangles)
        return DPT_NONE;
    uint32_t place = mesh_words(mesh, MESH_PLACES)[number];
    return place < mesh->triangles ? place : DPT_NONE;
}

dpt_result dpt_mesh_get_triangle(const dpt_mesh *mesh, uint32_t number, double corners[9])
{
    uint32_t place = place_of(mesh, number);
    if (place == DPT_NONE || !corners)
        return DPT_E_ARGUMENT;
    const uint32_t *corner = mesh_words(mesh, MESH_TRIANGLES) + 3 * (size_t)place;
    for (int k = 0; k < 3; k++)
        vec3_store(vec3_of_float(mesh_floats(mesh, MESH_VERTICES) + 3 * (size_t)corner[k]), corners + 3 * k);
    return DPT_OK;
}

dpt_result dpt_mesh_get_vertices(const dpt_mesh *mesh, const float **xyz, uint32_t *count)
{
    if (!mesh || !xyz || !count)
        return DPT_E_ARGUMENT;
    *xyz = mesh_floats(mesh, MESH_VERTICES);
    *count = mesh->vertices;
    return DPT_OK;
}

dpt_result dpt_mesh_get_triangles(const dpt_mesh *mesh, const uint32_t **corners, const uint32_t **numbers,
                                  uint32_t *count)
{
    if (!mesh || !corners || !count)
        return DPT_E_ARGUMENT;
    *corners = mesh_words(mesh, MESH_TRIANGLES);
    if (numbers)
        *numbers = mesh_words(mesh, MESH_SOURCES);
    *count = mesh->triangles;
    return DPT_OK;
}

dpt_result dpt_mesh_get_vertex_sources(const dpt_mesh *mesh, const uint32_t **sources, uint32_t *count)
{
    if (!mesh || !sources || !count)
        return DPT_E_ARGUMENT;
    if (mesh->version < 5)
        return DPT_E_UNSUPPORTED;
    *sources = mesh_words(mesh, MESH_VERTEX_SOURCES);
    *count = mesh->vertices;
    return DPT_OK;
}

dpt_result dpt_mesh_get_embedding(const dpt_mesh *mesh, const uint32_t **nodes, const float **weights,
                                  uint32_t *node_count)
{
    if (!mesh || !nodes || !weights || !node_count)
        return DPT_E_ARGUMENT;
    *node_count = mesh_tail(mesh).nodes;
    *nodes = *node_count ? mesh_words(mesh, MESH_EMBED_NODES) : NULL;
    *weights = *node_count ? mesh_floats(mesh, MESH_EMBED_WEIGHTS) : NULL;
    return DPT_OK;
}

dpt_result dpt_mesh_get_springs(const dpt_mesh *mesh, dpt_mesh_springs *springs)
{
    if (!mesh || !springs)
        return DPT_E_ARGUMENT;
    DPT_TRY(sized_check(springs, sizeof *springs, 0));
    struct spring_net net = { .nodes = 0 };
    mesh_spring_net(mesh, &net);
    const dpt_mesh_springs own = { .nodes = net.nodes,
                                   .slices = net.slices,
                                   .springs = net.springs,
                                   .viscosity = net.viscosity,
                                   .rest = net.rest,
                                   .mass = net.mass,
                                   .drag = net.drag,
                                   .first = net.first,
                                   .neighbours = net.neighbour,
                                   .stiffness = net.stiffness,
                                   .length = net.length };
    sized_write(springs, springs->size, &own, sizeof own);
    return DPT_OK;
}

dpt_result dpt_mesh_get_vertex_normals(const dpt_mesh *mesh, uint32_t number, double normals[9])
{
    uint32_t place = place_of(mesh, number);
    if (place == DPT_NONE || !normals)
        return DPT_E_ARGUMENT;
    struct surface surface;
    dpti_surface_of_mesh(mesh, &surface);
    for (int k = 0; k < 3; k++)
        vec3_store(unit_of(dpti_surface_vertex_normal(&surface, place, k)), normals + 3 * k);
    return DPT_OK;
}

dpt_result dpt_mesh_get_triangle_flags(const dpt_mesh *mesh, uint32_t number, uint32_t *flags)
{
    uint32_t place = place_of(mesh, number);
    if (place == DPT_NONE || !flags)
        return DPT_E_ARGUMENT;
    if (!mesh_flags(mesh))
        return DPT_E_UNSUPPORTED;
    *flags = mesh_flags(mesh)[place];
    return DPT_OK;
}
