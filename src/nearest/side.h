/* SPDX-License-Identifier: BSD-3-Clause */
/* On which side of the mesh a point lies: docs/algorithms/sign.md. */
#ifndef DPT_SIDE_H
#define DPT_SIDE_H

#include "mesh/surface_normal.h"
#include "nearest/bvh.h"

/* 1 when the point of a triangle with these weights lies on an edge without a neighbour. */
int dpti_side_is_border(const struct surface *surface, uint32_t triangle, const double weight[3]);

/* A part without an inside, but with two sides. */
int dpti_side_is_sheet(const struct surface *surface, uint32_t part);

/* +1 in front of the nearest point, -1 behind it, by its feature's normal. */
int dpti_side_of_pair(const struct surface *surface, uint32_t triangle, const pair *found);

/*
 * The side from which a point came that touched there, `back` leading to where it was. At an edge or a vertex the plane
 * of its normal does not tell that: it is the side of a point a little way back.
 */
int dpti_side_of_arrival(const struct surface *surface, uint32_t triangle, const double weight[3],
                         vec3 back);

#endif
