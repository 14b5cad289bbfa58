/* SPDX-License-Identifier: BSD-3-Clause */
#include "nearest/nearest_pair.h"

pair dpti_triangle_pair(const struct surface *surface, uint32_t triangle, vec3 a, vec3 u)
{
    vec3 v[3];
    surface_corners(surface, triangle, v);
    if (extent_of(u) > 0.0)
        return segment_triangle(a, u, v[0], v[1], v[2]);
    pair found;
    point_triangle(a, v, &found);
    return found;
}

void dpti_triangle_point_pair(const struct surface *surface, uint32_t triangle, vec3 x, pair *found)
{
    vec3 v[3];
    surface_corners(surface, triangle, v);
    point_triangle(x, v, found);
}

void dpti_pair_search_update_plane(struct pair_search *nearest, vec3 a, vec3 u, double slack)
{
    const pair *found = &nearest->pair;
    if (nearest->plane_owner == nearest->triangle + 1)
        return;
    vec3 normal = scaled(found->gap, -1.0 / sqrt(found->distance2));
    double rise = dot(normal, u), uu = dot(u, u);
    if (found->s <= 0.0)
        rise = max_of(rise, 0.0);
    else if (found->s >= 1.0)
        rise = min_of(rise, 0.0);
    nearest->plane =
        (struct best_plane){ normal, sub(along(a, found->s, u), found->gap), uu > 0.0 ? rise * rise / uu : 0.0, slack };
    nearest->plane_owner = nearest->triangle + 1;
}

/* height + slack - lean |c - q| is concave along a triangle: if it is >= 0 at the corners c, it is >= 0 everywhere. */
int dpti_triangle_is_beyond(const struct surface *surface, const struct best_plane *plane, uint32_t triangle)
{
    const uint32_t *corner = surface->corners + 3 * (size_t)triangle;
    int is_beyond = 1;
    for (int k = 0; k < 3; k++) {
        vec3 from_q = sub(vec3_of_float(surface->positions + 3 * (size_t)corner[k]), plane->q);
        double height = dot(plane->normal, from_q) + plane->slack;
        is_beyond &= (height >= 0.0) & (height * height >= plane->lean2 * dot(from_q, from_q));
    }
    return is_beyond;
}

int dpti_pair_search_try_point(const struct surface *surface, uint32_t triangle, vec3 x, struct pair_search *nearest)
{
    pair found;
    dpti_triangle_point_pair(surface, triangle, x, &found);
    return pair_search_improve(surface, triangle, &found, nearest);
}

int dpti_side_is_sheet(const struct surface *surface, uint32_t part)
{
    uint32_t flags = surface_part_flags(surface, part);
    return !(flags & (MESH_PART_SOLID | MESH_PART_BURIED)) && (flags & MESH_PART_MANIFOLD) && (flags & MESH_PART_WOUND);
}

int dpti_side_is_border(const struct surface *surface, uint32_t triangle, const double weight[3])
{
    const uint32_t *neighbour = surface_neighbours(surface);
    const uint32_t *first, *fans = surface_fans(surface, &first);
    const uint32_t *flags = surface_flags(surface);
    for (size_t k = 0; k < 3; k++)
        if (weight[(k + 2) % 3] <= 0.0 && neighbour[3 * (size_t)triangle + k] == MESH_EDGE_OPEN)
            return 1;
    int corner = surface_lone_corner(weight);
    if (corner < 0)
        return 0;
    if (flags)
        return (flags[triangle] & (uint32_t)DPT_CORNER_BORDER << corner) != 0;
    uint32_t v = surface->corners[3 * (size_t)triangle + (size_t)corner];
    for (uint32_t i = first[v]; i < first[v + 1]; i++) {
        size_t base = 3 * (size_t)fans[i];
        for (size_t e = 0; e < 3; e++)
            if (neighbour[base + e] == MESH_EDGE_OPEN &&
                (surface->corners[base + e] == v || surface->corners[base + (e + 1) % 3] == v))
                return 1;
    }
    return 0;
}

/*
 * The error of a stored normal: half a unit in the last place of each float, and what the adjacency compiler leaves out
 * of a fan whose normals cancel.
 */
#define STORED_NORMAL_ERROR 0x1p-23

int dpti_side_of_pair(const struct surface *surface, uint32_t triangle, const pair *found)
{
    double rise = dot(dpti_surface_feature_normal(surface, triangle, found->weight), found->gap);
    int corner = surface_lone_corner(found->weight);
    if (corner >= 0 && fabs(rise) <= STORED_NORMAL_ERROR * length(found->gap))
        rise = dot(dpti_surface_fan_normal(surface, triangle, corner), found->gap);
    return rise < 0.0 ? -1 : 1;
}

/* How far back the side is tested, as a part of an edge's length. */
#define ARRIVAL_STEP 1e-3

int dpti_side_of_arrival(const struct surface *surface, uint32_t triangle, const double weight[3], vec3 back)
{
    const uint32_t *first, *fans = surface_fans(surface, &first);
    int max_corner = weight[1] > weight[0] ? 1 : 0;
    max_corner = weight[2] > weight[max_corner] ? 2 : max_corner;
    double size = length(back);
    if ((weight[0] > 0.0 && weight[1] > 0.0 && weight[2] > 0.0) || !(size > 0.0))
        return dot(dpti_surface_face_normal(surface, triangle), back) < 0.0 ? -1 : 1;
    vec3 q = { 0.0, 0.0, 0.0 };
    for (int k = 0; k < 3; k++)
        q = along(q, weight[k], surface_corner_point(surface, triangle, k));
    double edge = length(sub(surface_corner_point(surface, triangle, max_corner + 1),
                             surface_corner_point(surface, triangle, max_corner)));
    vec3 x = along(q, min_of(ARRIVAL_STEP * edge, size) / size, back);
    uint32_t v = surface->corners[3 * (size_t)triangle + (size_t)max_corner], nearest = triangle;
    pair best, found;
    dpti_triangle_point_pair(surface, triangle, x, &best);
    for (uint32_t i = first[v]; i < first[v + 1]; i++) {
        dpti_triangle_point_pair(surface, fans[i], x, &found);
        if (found.distance2 < best.distance2) {
            best = found;
            nearest = fans[i];
        }
    }
    return dpti_side_of_pair(surface, nearest, &best);
}
