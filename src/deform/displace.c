/* SPDX-License-Identifier: BSD-3-Clause */
#include "deform/displace.h"

#include "mesh/surface.h"

/* Of the overlap: corners are moved by that much more, so that rounding to float leaves no overlap. */
#define BEYOND (1.0 + 1e-6)

/* More than the rounding of a distance. */
#define CLEAR (1.0 + 1e-9)

/*
 * How a triangle's nearest point has to move, m; 0 if the tool does not touch it. As a rule it moves away from the axis.
 * Where the axis goes through the triangle or is behind it, it moves against the normal on the tool's side. Normals alone
 * would not do: triangles of a crater's wall may fold over.
 */
static vec3 way_out(const struct surface *surface, const struct displacing_tool *tool, uint32_t place, double weight[3])
{
    const dpt_pose identity = DPT_POSE_IDENTITY;
    const vec3 none = { 0.0, 0.0, 0.0 };
    const pair found = dpti_triangle_pair(surface, place, tool->a, tool->u);
    const double distance = sqrt(found.distance2);
    const vec3 normal = scaled(dpti_surface_face_normal(surface, place), (double)tool->side);
    struct frame frame;
    dpt_overlap overlap;
    for (int k = 0; k < 3; k++)
        weight[k] = found.weight[k];
    if (distance > 0.0 && (!tool->is_behind || dot(found.gap, normal) >= 0.0))
        return distance < tool->radius ? scaled(found.gap, -BEYOND * (tool->radius - distance) / distance) : none;
    frame_of_pose(&identity, &frame);
    dpti_strip_overlap(surface, &frame, tool->a, tool->u, tool->radius, (double)tool->side, place, &overlap);
    return scaled(normal, -BEYOND * overlap.overlap);
}

/* By a ball about its middle: most of a strip is beside the tool. */
static int is_clear(const struct surface *surface, const struct displacing_tool *tool, uint32_t place)
{
    vec3 v[3];
    double square = 0.0;
    if (tool->is_behind)
        return 0;
    surface_corners(surface, place, v);
    const vec3 middle = scaled(add(add(v[0], v[1]), v[2]), 1.0 / 3.0);
    for (int k = 0; k < 3; k++) {
        const vec3 r = sub(v[k], middle);
        square = max_of(square, dot(r, r));
    }
    const vec3 from = sub(middle, tool->a);
    const double uu = dot(tool->u, tool->u);
    const double s = uu > 0.0 ? min_of(max_of(dot(from, tool->u) / uu, 0.0), 1.0) : 0.0;
    const vec3 away = along(from, -s, tool->u);
    const double reach = CLEAR * (sqrt(square) + tool->radius);
    return dot(away, away) > reach * reach;
}

/* Returns 1 if it was moved. */
static int displace_triangle(struct surface *surface, const struct displacing_tool *tool, uint32_t place)
{
    double weight[3], square = 0.0;
    if (is_clear(surface, tool, place))
        return 0;
    const vec3 way = way_out(surface, tool, place, weight);
    if (!(dot(way, way) > 0.0))
        return 0;
    for (int k = 0; k < 3; k++)
        square += weight[k] * weight[k];
    for (uint32_t k = 0; k < 3; k++) {
        const uint32_t vertex = surface_corner(surface, place, k);
        if (weight[k] > 0.0)
            dpti_deform_put(surface, vertex, along(surface_vertex(surface, vertex), weight[k] / square, way));
    }
    return 1;
}

void dpti_displace(struct surface *surface, const struct dpt_strip *strip, const struct displacing_tool *tool,
                   uint32_t passes)
{
    const uint32_t *places = mesh_words(surface->mesh, MESH_PLACES);
    int is_moved = 1;
    for (uint32_t pass = 0; pass < passes && is_moved; pass++) {
        is_moved = 0;
        for (uint32_t i = 0; i < strip->count; i++)
            is_moved |= displace_triangle(surface, tool, places[strip->triangles[i]]);
    }
}
