/* SPDX-License-Identifier: BSD-3-Clause */
/* What an open mesh tells of itself. */
#include "dynpoint/mesh.h"

#include "base/vec3.h"
#include "mesh/surface_normal.h"

dpt_result dpt_mesh_get_info(const dpt_mesh *mesh, dpt_mesh_info *info)
{
    if (!mesh || !info)
        return DPT_E_ARGUMENT;
    const size_t older = offsetof(dpt_mesh_info, solid_components);
    if (info->size < older)
        return DPT_E_SIZE;
    info->format_version = mesh->version;
    info->triangles = mesh->triangles;
    info->vertices = mesh->vertices;
    info->source_triangles = mesh->source_triangles;
    info->source_vertices = mesh->source_vertices;
    info->dropped_degenerate = mesh->dropped_degenerate;
    info->dropped_duplicate = mesh->dropped_duplicate;
    info->unused_vertices = mesh->unused_vertices;
    info->concave_polygons = mesh->concave_polygons;
    info->open_edges = mesh->open_edges;
    info->nonmanifold_edges = mesh->nonmanifold_edges;
    info->wrong_way_edges = mesh->wrong_way_edges;
    info->components = mesh->parts;
    info->closed_components = mesh->closed_components;
    info->inward_components = mesh->inward_components;
    info->turned_triangles = mesh->turned_triangles;
    info->tree_levels = mesh->levels;
    info->scale = mesh->scale;
    info->rounding = mesh->rounding;
    memcpy(info->box_min, mesh->box_min, sizeof info->box_min);
    memcpy(info->box_max, mesh->box_max, sizeof info->box_max);
    info->source_bytes = mesh->source_bytes;
    info->source_hash = mesh->source_hash;
    info->bytes = mesh->bytes;
    const struct mesh_tail tail = mesh_tail(mesh);
    if (info->size < offsetof(dpt_mesh_info, crease_edges))
        return DPT_OK;
    info->solid_components = tail.solid_components;
    info->cavities = tail.cavities;
    info->winding_components = tail.winding_components;
    info->buried_components = tail.buried_components;
    if (info->size < sizeof *info)
        return DPT_OK;
    info->crease_edges = tail.crease_edges;
    info->normalless_vertices = tail.normalless_vertices;
    info->crease = tail.crease;
    return DPT_OK;
}

dpt_result dpt_mesh_get_section(const dpt_mesh *mesh, uint32_t index, dpt_mesh_section *section)
{
    if (!mesh || !section || index >= mesh->section_count)
        return DPT_E_ARGUMENT;
    if (section->size < sizeof *section)
        return DPT_E_SIZE;
    section->crc32 = mesh->section[index].crc32;
    section->offset = mesh->section[index].offset;
    section->bytes = mesh->section[index].bytes;
    memcpy(section->name, mesh->section[index].name, sizeof section->name);
    return DPT_OK;
}

/* Where a triangle lies by its source number, or DPT_NONE. */
static uint32_t place_of(const dpt_mesh *mesh, uint32_t number)
{
    if (!mesh || number >= mesh->source_triangles)
        return DPT_NONE;
    uint32_t place = mesh_words(mesh, MESH_PLACES)[number];
    return place < mesh->triangles ? place : DPT_NONE;
}

dpt_result dpt_mesh_triangle(const dpt_mesh *mesh, uint32_t number, double corners[9])
{
    uint32_t place = place_of(mesh, number);
    if (place == DPT_NONE || !corners)
        return DPT_E_ARGUMENT;
    const uint32_t *corner = mesh_words(mesh, MESH_TRIANGLES) + 3 * (size_t)place;
    for (int k = 0; k < 3; k++)
        vec3_store(vec3_of_float(mesh_floats(mesh, MESH_VERTICES) + 3 * (size_t)corner[k]),
                   corners + 3 * k);
    return DPT_OK;
}

dpt_result dpt_mesh_vertex_normals(const dpt_mesh *mesh, uint32_t number, double normals[9])
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

dpt_result dpt_mesh_triangle_flags(const dpt_mesh *mesh, uint32_t number, uint32_t *flags)
{
    uint32_t place = place_of(mesh, number);
    if (place == DPT_NONE || !flags)
        return DPT_E_ARGUMENT;
    if (!mesh_flags(mesh))
        return DPT_E_UNSUPPORTED;
    *flags = mesh_flags(mesh)[place];
    return DPT_OK;
}
