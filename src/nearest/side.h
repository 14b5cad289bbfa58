/* SPDX-License-Identifier: BSD-3-Clause */
/* On which side of the mesh a point lies: docs/algorithms/sign.md. */
#ifndef DPT_SIDE_H
#define DPT_SIDE_H

#include "nearest/bvh.h"

/* The normal of a triangle's plane, unit, as it is wound; zero for one without area. */
vec3 side_face_normal(const struct tree *tree, uint32_t triangle);

/*
 * The normal of what holds the point of a triangle with these weights: its face, edge or vertex. Its length is not 1.
 * The sign of (x - q).normal tells in front from behind for every x whose nearest point q is (Baerentzen and
 * Aanaes 2005).
 */
vec3 side_feature_normal(const struct tree *tree, uint32_t triangle, const double weight[3]);

/*
 * The angle-weighted normal of corner k's vertex, over the triangle's part: unit and in float where the file holds it,
 * else of any length.
 */
vec3 side_vertex_normal(const struct tree *tree, uint32_t triangle, int k);

/*
 * The normal there, unit, interpolated between those of the corners; zero where they cancel. On a crease a corner's is
 * that of its own side (docs/algorithms/sign.md).
 */
vec3 side_smooth_normal(const struct tree *tree, uint32_t triangle, const double weight[3]);

/* 1 when that point lies on an edge without a neighbour. */
int side_is_border(const struct tree *tree, uint32_t triangle, const double weight[3]);

/* A triangle's part. */
uint32_t side_part(const struct tree *tree, uint32_t triangle);

/* A part without an inside, but with two sides. */
int side_is_sheet(const struct tree *tree, uint32_t part);

/* +1 in front of the nearest point, -1 behind it, by its feature's normal. */
int side_of_pair(const struct tree *tree, uint32_t triangle, const pair *found);

/*
 * The side from which a point came that touched there, `back` leading to where it was. At an edge or a vertex the plane
 * of its normal does not tell that: it is the side of a point a little way back.
 */
int side_of_way(const struct tree *tree, uint32_t triangle, const double weight[3], vec3 back);

#endif
