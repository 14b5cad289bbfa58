/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A surface as searches see it: the positions of its vertices, the boxes and filter blocks that follow from them, and
 * the topology of its triangles. For a rigid body all of it lies in the bytes of its mesh. A body with positions of
 * its own also has its own boxes and blocks; its topology is still the mesh's.
 *
 * Triangles are numbered by their place: the index in the file's order, which is that of the box tree. `sources`
 * leads to the number that users know.
 */
#ifndef DPT_SURFACE_H
#define DPT_SURFACE_H

#include "base/vec3.h"
#include "mesh/mesh_format.h"

struct surface {
    /* Topology and the shape of the tree, from the file. */
    const struct dpt_mesh *mesh;         /* for topology only, never for geometry */
    const uint32_t *corners;             /* 3 vertices a triangle */
    const uint32_t *sources;             /* the source number of each triangle */
    uint32_t count[MESH_LEVELS_MAX + 1]; /* nodes of each level of the box tree; level 0: leaves */
    uint32_t first[MESH_LEVELS_MAX + 1]; /* number of each level's first node; leaves from 0 */
    uint32_t levels;
    /* Geometry, in the body's frame. */
    const float *positions; /* 3 a vertex */
    const float *normals;   /* 3 a vertex, as from mesh_normals; or NULL */
    const float *leaves;    /* of MESH_LEAF_WORDS */
    /* Nodes of MESH_BOX_WORDS for each level; level 1: the parents of the leaves. */
    const float *level[MESH_LEVELS_MAX + 1];
    const float *moments; /* nodes of MESH_MOMENT_WORDS; or NULL */
    vec3 box_min, box_max;
    vec3 filter_centre; /* boxes, leaves and moments hold (x - centre) * scale */
    double filter_scale;
};

/* The surface of a rigid mesh. */
void dpti_surface_of_mesh(const struct dpt_mesh *mesh, struct surface *surface);

/* m: the diagonal of its box. */
double dpti_surface_diagonal(const struct surface *surface);

/* m: its largest |coordinate|. */
double dpti_surface_extent(const struct surface *surface);

/* The position of a vertex, in the body's frame. */
static inline vec3 surface_vertex(const struct surface *surface, uint32_t vertex)
{
    return vec3_of_float(surface->positions + 3 * (size_t)vertex);
}

/* The vertex at corner k of a triangle, 0..2. */
static inline uint32_t surface_corner(const struct surface *surface, uint32_t triangle, uint32_t k)
{
    return surface->corners[3 * (size_t)triangle + k];
}

/* The positions of a triangle's three corners. */
static inline void surface_corners(const struct surface *surface, uint32_t triangle, vec3 v[3])
{
    for (uint32_t k = 0; k < 3; k++)
        v[k] = surface_vertex(surface, surface_corner(surface, triangle, k));
}

static inline uint32_t surface_triangles(const struct surface *surface)
{
    return surface->mesh->triangles;
}

/* Neighbours, 3 a triangle: the one over the edge from corner k to k + 1; or MESH_EDGE_... */
static inline const uint32_t *surface_neighbours(const struct surface *surface)
{
    return mesh_words(surface->mesh, MESH_NEIGHBOURS);
}

/* The triangles at vertex v: fans[first[v]] up to, not including, fans[first[v + 1]]. */
static inline const uint32_t *surface_fans(const struct surface *surface, const uint32_t **first)
{
    *first = mesh_words(surface->mesh, MESH_FAN_FIRST);
    return mesh_words(surface->mesh, MESH_FANS);
}

/* A triangle's part. */
static inline uint32_t surface_part(const struct surface *surface, uint32_t triangle)
{
    return mesh_words(surface->mesh, MESH_PARTS)[triangle];
}

/* The MESH_PART_... bits of a part. */
static inline uint32_t surface_part_flags(const struct surface *surface, uint32_t part)
{
    return mesh_part_flags(surface->mesh, part);
}

/* The moments, or NULL; `lanes` gets a word for each leaf, with a bit for each triangle of a solid part. */
static inline const float *surface_moments(const struct surface *surface, const uint32_t **lanes)
{
    mesh_moments(surface->mesh, lanes);
    return surface->moments;
}

/* The DPT_EDGE_... and DPT_CORNER_... bits of each triangle; or NULL. */
static inline const uint32_t *surface_flags(const struct surface *surface)
{
    return mesh_flags(surface->mesh);
}

#endif
