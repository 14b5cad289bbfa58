/* SPDX-License-Identifier: BSD-3-Clause */
/* Normals of faces, edges and vertices, as triangles are wound: docs/algorithms/sign.md. */
#ifndef DPT_SURFACE_NORMAL_H
#define DPT_SURFACE_NORMAL_H

#include "mesh/surface.h"

/* The normal of a triangle's plane, unit, as it is wound; zero for one without area. */
vec3 dpti_surface_face_normal(const struct surface *surface, uint32_t triangle);

/*
 * The normal of what holds the point of a triangle with these weights: its face, edge or vertex. Its length is not 1.
 * The sign of (x - q).normal tells in front from behind for every x whose nearest point q is (Baerentzen and
 * Aanaes 2005).
 */
vec3 dpti_surface_feature_normal(const struct surface *surface, uint32_t triangle,
                                 const double weight[3]);

/*
 * The angle-weighted normal of corner k's vertex, over the triangle's part: unit and in float where the file holds it,
 * else of any length.
 */
vec3 dpti_surface_vertex_normal(const struct surface *surface, uint32_t triangle, int k);

/*
 * The normal there, unit, interpolated between those of the corners; zero where they cancel. On a crease a corner's is
 * that of its own side (docs/algorithms/sign.md).
 */
vec3 dpti_surface_smooth_normal(const struct surface *surface, uint32_t triangle,
                                const double weight[3]);

/*
 * The same of any length and in double, worked out from the triangles at the vertex: angle-weighted (Baerentzen and
 * Aanaes 2005).
 */
vec3 dpti_surface_fan_normal(const struct surface *surface, uint32_t triangle, int k);

/* The corner that these weights are all of, or -1. */
static inline int surface_lone_corner(const double weight[3])
{
    for (int k = 0; k < 3; k++)
        if (!(weight[(k + 1) % 3] > 0.0) && !(weight[(k + 2) % 3] > 0.0))
            return k;
    return -1;
}

/* The point of corner k, of any k >= 0. */
static inline vec3 surface_corner_point(const struct surface *surface, uint32_t triangle, int k)
{
    return surface_vertex(surface, surface_corner(surface, triangle, (uint32_t)(k % 3)));
}

#endif
