/* SPDX-License-Identifier: BSD-3-Clause */
/* Nearest pair of one axis and one mesh, exact: by the box tree, or by brute force. */
#ifndef DPT_TREE_H
#define DPT_TREE_H

#include "kernel.h"
#include "mesh_format.h"
#include "segment_triangle.h"

/* A mesh as the search reads it: pointers into the file's bytes, found once. */
struct tree {
    const struct dpt_mesh *mesh;
    const float *positions;
    const uint32_t *corners;
    const uint32_t *sources;
    const float *leaves;
    const float *level[MESH_LEVELS_MAX + 1]; /* level 1: the parents of the leaves */
    uint32_t count[MESH_LEVELS_MAX + 1];     /* nodes of a level; level 0: leaves */
    uint32_t levels;
};

/* The best pair so far, and what it cost. */
struct nearest {
    pair pair;         /* in the mesh's frame */
    uint32_t triangle; /* place in the mesh, or DPT_NONE */
    uint32_t work;     /* 16-lane blocks */
};

void tree_of_mesh(const struct dpt_mesh *mesh, struct tree *tree);

/* The pair of the axis a + s u and one triangle, by its place. */
pair tree_pair(const struct tree *tree, uint32_t triangle, vec3 a, vec3 u);

/*
 * Look for what is nearer than nearest->pair.distance2, or as near with a lower source number; put it
 * into `nearest`. Stops at the first pair that meets. nearest->triangle stays when there is none.
 */
void tree_search(const struct tree *tree, const struct kernel *kernel, vec3 a, vec3 u,
                 struct nearest *nearest);

/* The same over every triangle, in double, without a filter; never stops early. */
void tree_brute(const struct tree *tree, vec3 a, vec3 u, struct nearest *nearest);

/*
 * The most by which a reported distance is wrong, per unit of the largest coordinate that entered, in
 * the world and in the mesh's frame: half for the rounding of the pair (32 * 2^-53, docs/algorithms/
 * distance.md) and of the transformation into the mesh's frame, half for history (track_next).
 */
#define TREE_ERROR (128.0 * 0x1p-53)

/* The largest coordinate of the mesh, in its own frame. */
double tree_extent(const struct tree *tree);

#endif
