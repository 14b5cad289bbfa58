/* SPDX-License-Identifier: BSD-3-Clause */
/* Normals of faces, edges and vertices, as triangles are wound: docs/algorithms/sign.md. */
#ifndef DPT_SURFACE_NORMAL_H
#define DPT_SURFACE_NORMAL_H

#include "mesh/surface.h"

/* The unit normal of a triangle, as it is wound; zero for one without area. */
vec3 dpti_surface_face_normal(const struct surface *surface, uint32_t triangle);

/*
 * The normal of the feature (face, edge or vertex) that holds the point of a triangle with these weights; not of
 * length 1. For every x whose nearest point is that point q, the sign of (x - q).normal tells whether x is in front
 * or behind (Baerentzen and Aanaes 2005).
 */
vec3 dpti_surface_feature_normal(const struct surface *surface, uint32_t triangle, const double weight[3]);

/*
 * The angle-weighted normal of the vertex at corner k, over the triangle's part: the file's unit normal in float, or
 * else the sum over the fan, which has any length.
 */
vec3 dpti_surface_vertex_normal(const struct surface *surface, uint32_t triangle, int k);

/*
 * The unit normal at the point of a triangle with these weights, interpolated between those of the corners; zero
 * where they cancel. At a crease the normal of a corner is that of its own side (docs/algorithms/sign.md).
 */
vec3 dpti_surface_smooth_normal(const struct surface *surface, uint32_t triangle, const double weight[3]);

/*
 * The angle-weighted normal of the vertex at corner k, of any length and in double, computed from the triangles at
 * the vertex (Baerentzen and Aanaes 2005).
 */
vec3 dpti_surface_fan_normal(const struct surface *surface, uint32_t triangle, int k);

/* The corner at which the point with these weights lies, or -1 if it lies at none. */
static inline int surface_lone_corner(const double weight[3])
{
    for (int k = 0; k < 3; k++)
        if (!(weight[(k + 1) % 3] > 0.0) && !(weight[(k + 2) % 3] > 0.0))
            return k;
    return -1;
}

/* The position of corner k, modulo 3, for any k >= 0. */
static inline vec3 surface_corner_point(const struct surface *surface, uint32_t triangle, int k)
{
    return surface_vertex(surface, surface_corner(surface, triangle, (uint32_t)(k % 3)));
}

#endif
