/* SPDX-License-Identifier: BSD-3-Clause */
/* The nearest pair of an axis and a surface that a search has found so far, and how one triangle compares with it. */
#ifndef DPT_NEAREST_PAIR_H
#define DPT_NEAREST_PAIR_H

#include "mesh/surface.h"
#include "nearest/segment_triangle.h"

/*
 * The most by which a reported distance is wrong, per unit of the largest coordinate that entered, in
 * the world and in the mesh's frame: half for the rounding of the pair (32 * 2^-53, docs/algorithms/
 * distance.md) and of the transformation into the mesh's frame, three eighths for history (dpti_track_settle), one
 * eighth for triangles that touch the plane through the best pair and are not evaluated (dpti_bvh_search).
 */
#define DISTANCE_ERROR         (128.0 * 0x1p-53)
#define DISTANCE_ERROR_HISTORY 0.375
#define DISTANCE_ERROR_SLACK   0.125

#define EXCLUDED_MAX 16

/*
 * The plane through a pair's point on the mesh, across the connection. What is wholly beyond it is no nearer.
 * The axis may lean towards it: by no more than rounding where the pair is not at its end, but over its
 * whole length that is more than the rounding of a distance. The point of the axis nearest to an x of the mesh is
 * no farther from the pair's than x is from the mesh's, so it is the lean over that way which counts.
 */
struct best_plane {
    vec3 normal;  /* unit, away from the axis */
    vec3 q;       /* the pair's point on the mesh */
    double lean2; /* square of the axis' rise along the normal, per length */
    double slack;
};

/* The best pair so far. */
struct pair_search {
    pair pair;         /* in the mesh's frame */
    uint32_t triangle; /* place in the mesh, or DPT_NONE */
    uint32_t
        plane_owner; /* the triangle, from 1, to whose pair the front belongs; 0: there is none */
    struct best_plane plane;
    uint32_t excluded_count;
    uint32_t
        excluded[EXCLUDED_MAX]; /* triangles that are no nearer, as is known without a search */
};

/* Before a search: all but the pair. The triangle is the pair's, or DPT_NONE. */
static inline void pair_search_begin(struct pair_search *nearest, uint32_t triangle)
{
    nearest->triangle = triangle;
    nearest->plane_owner = nearest->excluded_count = 0;
}

/*
 * Make its front, if it is another pair's: of the axis a + s u, at a positive distance. What is nearer by less than
 * `slack` counts as no nearer.
 */
void dpti_pair_search_update_plane(struct pair_search *nearest, vec3 a, vec3 u, double slack);

/* All of a triangle lies beyond. */
int dpti_triangle_is_beyond(const struct surface *surface, const struct best_plane *plane,
                            uint32_t triangle);

/* The pair of the axis a + s u and one triangle, by its place. */
pair dpti_triangle_pair(const struct surface *surface, uint32_t triangle, vec3 a, vec3 u);

/* The same of a point x. */
void dpti_triangle_point_pair(const struct surface *surface, uint32_t triangle, vec3 x,
                              pair *found);

/* How the axis goes through the plane of one. */
static inline struct pierce triangle_pierce(const struct surface *surface, uint32_t triangle,
                                            vec3 a, vec3 u)
{
    vec3 v[3];
    surface_corners(surface, triangle, v);
    const vec3 edge[3] = { sub(v[1], v[0]), sub(v[2], v[1]), sub(v[0], v[2]) };
    const vec3 from[3] = { sub(a, v[0]), sub(a, v[1]), sub(a, v[2]) };
    return pierce_of(u, from, edge);
}

/* As near, the lower source number wins: the same answer in whatever order triangles are tried. 1: the pair is taken. */
static inline int pair_search_improve(const struct surface *surface, uint32_t triangle,
                                      const pair *found, struct pair_search *nearest)
{
    if (found->distance2 > nearest->pair.distance2 ||
        (found->distance2 == nearest->pair.distance2 && nearest->triangle != DPT_NONE &&
         surface->sources[triangle] >= surface->sources[nearest->triangle]))
        return 0;
    nearest->pair = *found;
    nearest->triangle = triangle;
    return 1;
}

/* Take that pair if it is nearer, or as near with a lower source number: 1. */
int dpti_pair_search_try_point(const struct surface *surface, uint32_t triangle, vec3 x,
                               struct pair_search *nearest);

#endif
