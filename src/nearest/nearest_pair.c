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
