/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/surface.h"

void dpti_surface_of_mesh(const struct dpt_mesh *mesh, struct surface *surface)
{
    uint64_t nodes;
    const uint32_t *lanes;
    surface->mesh = mesh;
    surface->corners = mesh_words(mesh, MESH_TRIANGLES);
    surface->sources = mesh_words(mesh, MESH_SOURCES);
    surface->levels = mesh_levels(mesh->leaves, surface->count, &nodes);
    surface->positions = mesh_floats(mesh, MESH_VERTICES);
    surface->normals = mesh_normals(mesh);
    surface->leaves = mesh_floats(mesh, MESH_LEAVES);
    surface->moments = mesh_moments(mesh, &lanes);
    surface->level[0] = NULL;
    surface->first[0] = 0;
    const float *level = mesh_floats(mesh, MESH_BOXES);
    for (uint32_t l = 1; l <= surface->levels; l++) {
        surface->level[l] = level;
        surface->first[l] = surface->first[l - 1] + surface->count[l - 1];
        level += (size_t)surface->count[l] * MESH_BOX_WORDS;
    }
    surface->box_min = vec3_of(mesh->box_min);
    surface->box_max = vec3_of(mesh->box_max);
    surface->filter_centre = vec3_of(mesh->filter_centre);
    surface->filter_scale = mesh->filter_scale;
    surface->diagonal = length(sub(surface->box_max, surface->box_min));
    surface->holes = NULL;
    surface->motion = NULL;
    surface->view_tick = 0;
    surface->view_time = 1.0;
}

vec3 dpti_surface_between(const struct surface *view, uint32_t vertex)
{
    const vec3 now = vec3_of_float(view->positions + 3 * (size_t)vertex);
    const vec3 before = vec3_of_float(surface_motion_previous(view->motion, vertex, view->view_tick));
    return along(before, view->view_time, sub(now, before));
}

double dpti_surface_extent(const struct surface *surface)
{
    return max_of(extent_of(surface->box_min), extent_of(surface->box_max));
}

double dpti_surface_leaf_length(const struct surface *surface, uint32_t leaf)
{
    if (!surface->levels)
        return 2.0 * dpti_surface_extent(surface);
    const float *half = surface->level[1] + (size_t)(leaf / LANES) * MESH_BOX_WORDS + 3u * LANES;
    float longest = 0.0f;
    for (uint32_t k = 0; k < 3; k++)
        if (half[k * LANES + leaf % LANES] > longest)
            longest = half[k * LANES + leaf % LANES];
    return 2.0 * (double)longest / surface->filter_scale;
}
