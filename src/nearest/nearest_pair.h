/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The nearest pair of an axis and a surface that a search has found so far, and how one triangle compares with it.
 * Triangles go by their place in the file's order. Points and axes are in the mesh's frame, in m.
 */
#ifndef DPT_NEAREST_PAIR_H
#define DPT_NEAREST_PAIR_H

#include "mesh/surface.h"
#include "nearest/segment_triangle.h"

/*
 * The error bound of a reported distance, per unit of the largest coordinate that entered, in the world and in the
 * mesh's frame. Its parts:
 *   - one half for the rounding of the pair (32 * 2^-53, docs/algorithms/distance.md) and of the transformation into
 *     the mesh's frame;
 *   - DISTANCE_ERROR_HISTORY, three eighths, for history (dpti_dynamic_point_settle);
 *   - DISTANCE_ERROR_SLACK, one eighth, for triangles that touch the plane through the best pair and are not evaluated
 *     (the slack of struct bvh_search).
 */
#define DISTANCE_ERROR         (128.0 * 0x1p-53)
#define DISTANCE_ERROR_HISTORY 0.375
#define DISTANCE_ERROR_SLACK   0.125

/* The most triangles that one search excludes. */
#define EXCLUDED_MAX 16

/*
 * The plane through the best pair's point q on the mesh, orthogonal to the pair. A triangle wholly beyond it is no
 * nearer than the pair.
 *
 * The axis may lean towards the plane. If the pair is not at an end of the axis, the lean is only rounding; but over
 * the whole axis that is more than the rounding of a distance. So only a part of the axis counts: let p be the pair's
 * point on the axis. The point of the axis nearest to a point x of the mesh is no farther from p than x is from q. So
 * x must be beyond the plane by the lean over that length.
 */
struct best_plane {
    vec3 normal;  /* unit, away from the axis */
    vec3 q;       /* the pair's point on the mesh */
    double lean2; /* square of the axis' rise along the normal, per length of the axis */
    double slack; /* m; a triangle that is nearer by less counts as no nearer */
};

/* The best pair so far. */
struct pair_search {
    struct pair pair;     /* in the mesh's frame */
    uint32_t triangle;    /* the pair's triangle, by its place, or DPT_NONE */
    uint32_t plane_owner; /* place + 1 of the triangle whose pair `plane` belongs to; 0: no plane */
    struct best_plane plane;
    uint32_t excluded_count;
    uint32_t excluded[EXCLUDED_MAX]; /* places of triangles that were tested and are no nearer */
};

/* Begin a search: set all but the pair. triangle: the pair's, by its place, or DPT_NONE. */
static inline void pair_search_begin(struct pair_search *nearest, uint32_t triangle)
{
    nearest->triangle = triangle;
    nearest->plane_owner = nearest->excluded_count = 0;
}

/*
 * Set nearest->plane for the axis a + s u, unless it belongs to the pair already. The pair's distance must be positive.
 * A triangle that is nearer by less than `slack`, in m, counts as no nearer.
 */
void dpti_pair_search_update_plane(struct pair_search *nearest, vec3 a, vec3 u, double slack);

/* 1 if all of a triangle lies beyond the plane, so that it is no nearer than the best pair. */
int dpti_triangle_is_beyond(const struct surface *surface, const struct best_plane *plane, uint32_t triangle);

/* The nearest pair of the axis a + s u and one triangle. u may be 0. */
pair dpti_triangle_pair(const struct surface *surface, uint32_t triangle, vec3 a, vec3 u);

/* The nearest pair of the point x and one triangle. */
void dpti_triangle_point_pair(const struct surface *surface, uint32_t triangle, vec3 x, pair *found);

/* How the line of the axis a + s u passes one triangle. */
static inline struct pierce triangle_pierce(const struct surface *surface, uint32_t triangle, vec3 a, vec3 u)
{
    vec3 v[3];
    surface_corners(surface, triangle, v);
    const vec3 edge[3] = { sub(v[1], v[0]), sub(v[2], v[1]), sub(v[0], v[2]) };
    const vec3 from[3] = { sub(a, v[0]), sub(a, v[1]), sub(a, v[2]) };
    return pierce_of(u, from, edge);
}

/*
 * Replace the best pair by `found` if that is nearer, or as near with a lower source number: so the answer does not
 * depend on the order in which triangles are tried. Returns 1 if it was replaced.
 */
static inline int pair_search_improve(const struct surface *surface, uint32_t triangle, const pair *found,
                                      struct pair_search *nearest)
{
    if (found->distance2 > nearest->pair.distance2 ||
        (found->distance2 == nearest->pair.distance2 && nearest->triangle != DPT_NONE &&
         surface->sources[triangle] >= surface->sources[nearest->triangle]))
        return 0;
    nearest->pair = *found;
    nearest->triangle = triangle;
    return 1;
}

/* Evaluate the pair of the point x and one triangle; then as pair_search_improve. */
int dpti_pair_search_try_point(const struct surface *surface, uint32_t triangle, vec3 x, struct pair_search *nearest);

/* ---- on which side of the mesh a point lies: docs/algorithms/sign.md ---- */

/* 1 if the point of a triangle with these weights lies on a border: on an edge with one triangle, or at its vertex. */
int dpti_side_is_border(const struct surface *surface, uint32_t triangle, const double weight[3]);

/* 1 if a part is an open sheet: it has no inside, but two sides. */
int dpti_side_is_sheet(const struct surface *surface, uint32_t part);

/*
 * The side of the pair's point on the axis: +1 in front of the surface, -1 behind it, by the normal of the face, edge
 * or vertex that holds the nearest point. found: the pair with this triangle, in the mesh's frame.
 */
int dpti_side_of_pair(const struct surface *surface, uint32_t triangle, const pair *found);

/*
 * The side, +1 or -1, from which a point came that now touches a triangle at these weights. back: from there to where
 * the point was, in the mesh's frame. At an edge or a vertex the plane of the normal does not give the side. There the
 * answer is the side of a point a little way back.
 */
int dpti_side_of_arrival(const struct surface *surface, uint32_t triangle, const double weight[3], vec3 back);

#endif
