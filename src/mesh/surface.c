/* SPDX-License-Identifier: BSD-3-Clause */
#include "mesh/surface.h"

#include "base/angle.h"

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

vec3 dpti_surface_face_normal(const struct surface *surface, uint32_t triangle)
{
    vec3 a = surface_corner_point(surface, triangle, 0);
    return unit_of(
        cross(sub(surface_corner_point(surface, triangle, 1), a), sub(surface_corner_point(surface, triangle, 2), a)));
}

/* What a triangle adds to the normal of the vertex at its corner k: its face normal times its angle there. */
static vec3 weighted_normal(const struct surface *surface, uint32_t triangle, int k)
{
    vec3 here = surface_corner_point(surface, triangle, k);
    double angle = angle_between(unit_of(sub(surface_corner_point(surface, triangle, k + 1), here)),
                                 unit_of(sub(surface_corner_point(surface, triangle, k + 2), here)));
    return scaled(dpti_surface_face_normal(surface, triangle), angle);
}

/* The corner of a triangle at which a vertex is. */
static int corner_at(const struct surface *surface, uint32_t triangle, uint32_t vertex)
{
    int k = 0;
    while (k < 2 && surface_corner(surface, triangle, (uint32_t)k) != vertex)
        k++;
    return k;
}

vec3 dpti_surface_fan_normal(const struct surface *surface, uint32_t triangle, int k)
{
    const uint32_t *first, *fans = surface_fans(surface, &first);
    uint32_t v = surface_corner(surface, triangle, (uint32_t)k);
    const uint32_t part = surface_part(surface, triangle);
    vec3 normal = { 0.0, 0.0, 0.0 };
    for (uint32_t i = first[v]; i < first[v + 1]; i++)
        if (surface_part(surface, fans[i]) == part)
            normal = add(normal, weighted_normal(surface, fans[i], corner_at(surface, fans[i], v)));
    return normal;
}

vec3 dpti_surface_vertex_normal(const struct surface *surface, uint32_t triangle, int k)
{
    const float *normals = surface->normals;
    if (normals) {
        uint32_t v = surface_corner(surface, triangle, (uint32_t)k);
        vec3 n = vec3_of_float(normals + 3 * (size_t)v);
        if (n.x != 0.0 || n.y != 0.0 || n.z != 0.0)
            return n;
    }
    return dpti_surface_fan_normal(surface, triangle, k);
}

/* The sum of the normals at the edge from corner k to k + 1. */
static vec3 edge_normal(const struct surface *surface, uint32_t triangle, int k)
{
    uint32_t other = surface_neighbours(surface)[3 * (size_t)triangle + (size_t)k];
    vec3 normal = dpti_surface_face_normal(surface, triangle);
    return other < surface_triangles(surface) ? add(normal, dpti_surface_face_normal(surface, other)) : normal;
}

vec3 dpti_surface_feature_normal(const struct surface *surface, uint32_t triangle, const double weight[3])
{
    int corner = surface_lone_corner(weight);
    if (corner >= 0)
        return dpti_surface_vertex_normal(surface, triangle, corner);
    for (int k = 0; k < 3; k++)
        if (!(weight[(k + 2) % 3] > 0.0))
            return edge_normal(surface, triangle, k);
    return dpti_surface_face_normal(surface, triangle);
}

/* At most this many triangles on one side of a crease count, in each direction: a hub may have any number. */
#define SECTOR_MAX 64

/* The normal of corner k, over the triangles round its vertex up to the next crease or border in either direction. */
static vec3 sector_normal(const struct surface *surface, uint32_t triangle, int k)
{
    const uint32_t *flags = surface_flags(surface);
    const uint32_t *neighbours = surface_neighbours(surface);
    uint32_t v = surface_corner(surface, triangle, (uint32_t)k);
    vec3 normal = weighted_normal(surface, triangle, k);
    for (int reverse = 0; reverse < 2; reverse++) {
        uint32_t t = triangle;
        int edge = reverse ? (k + 2) % 3 : k;
        for (int i = 0; i < SECTOR_MAX; i++) {
            uint32_t next = neighbours[3 * (size_t)t + (size_t)edge];
            if (flags[t] & (uint32_t)DPT_EDGE_CREASE << edge || next >= surface_triangles(surface))
                break;
            if (next == triangle)
                return normal;
            int at = corner_at(surface, next, v), before = (at + 2) % 3;
            edge = neighbours[3 * (size_t)next + (size_t)before] == t ? at : before;
            t = next;
            normal = add(normal, weighted_normal(surface, t, at));
        }
    }
    return normal;
}

vec3 dpti_surface_smooth_normal(const struct surface *surface, uint32_t triangle, const double weight[3])
{
    const uint32_t *flags = surface_flags(surface);
    const uint32_t ends = DPT_CORNER_CREASE | DPT_CORNER_NONMANIFOLD;
    vec3 normal = { 0.0, 0.0, 0.0 };
    for (int k = 0; k < 3; k++) {
        int has_crease = flags && (flags[triangle] & ends << k);
        vec3 corner =
            has_crease ? sector_normal(surface, triangle, k) : dpti_surface_vertex_normal(surface, triangle, k);
        normal = along(normal, weight[k], unit_of(corner));
    }
    return unit_of(normal);
}
