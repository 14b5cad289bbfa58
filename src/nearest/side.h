/* SPDX-License-Identifier: BSD-3-Clause */
/* On which side of the mesh a point lies: docs/algorithms/sign.md. */
#ifndef DPT_SIDE_H
#define DPT_SIDE_H

#include "mesh/surface_normal.h"
#include "nearest/bvh.h"

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
