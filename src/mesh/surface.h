/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A surface as searches see it: where its vertices are, with the boxes and blocks of the filter that follow from that,
 * and how its triangles hang together. A rigid body's is all in the bytes of its mesh, found once; where a body has
 * positions of its own, they and what follows from them are its own, and `mesh` still tells the topology.
 *
 * Triangles go by their place: their index in the file's order, which is the box tree's. `sources` leads to the number
 * that users know.
 */
#ifndef DPT_SURFACE_H
#define DPT_SURFACE_H

#include "base/vec3.h"
#include "mesh/mesh_format.h"

struct surface {
    /* Topology, and the tree's shape: the file's. */
    const struct dpt_mesh *mesh; /* asked for no geometry */
    const uint32_t *corners;     /* 3 vertices a triangle */
    const uint32_t *sources;
    uint32_t count[MESH_LEVELS_MAX + 1]; /* nodes of a level of the box tree; level 0: leaves */
    uint32_t first[MESH_LEVELS_MAX + 1]; /* number of a level's first node; leaves from 0 */
    uint32_t levels;
    /* Geometry. */
    const float *positions; /* 3 a vertex */
    const float *normals;   /* 3 a vertex, as mesh_normals; or NULL */
    const float *leaves;    /* of MESH_LEAF_WORDS */
    const float *level[MESH_LEVELS_MAX +
                       1]; /* nodes of MESH_BOX_WORDS; level 1: the parents of the leaves */
    const float *moments;  /* nodes of MESH_MOMENT_WORDS; or NULL */
    vec3 box_min, box_max;
    vec3 filter_centre; /* boxes, leaves and moments hold (x - centre) * scale */
    double filter_scale;
};

/* That of a mesh that nothing has deformed. */
void dpti_surface_of_mesh(const struct dpt_mesh *mesh, struct surface *surface);

/* From corner to corner of its box. */
double dpti_surface_diagonal(const struct surface *surface);

/* Its largest coordinate. */
double dpti_surface_extent(const struct surface *surface);

static inline vec3 surface_vertex(const struct surface *surface, uint32_t vertex)
{
    return vec3_of_float(surface->positions + 3 * (size_t)vertex);
}

/* The vertex at corner k of a triangle, 0..2. */
static inline uint32_t surface_corner(const struct surface *surface, uint32_t triangle, uint32_t k)
{
    return surface->corners[3 * (size_t)triangle + k];
}

static inline void surface_corners(const struct surface *surface, uint32_t triangle, vec3 v[3])
{
    for (uint32_t k = 0; k < 3; k++)
        v[k] = surface_vertex(surface, surface_corner(surface, triangle, k));
}

static inline uint32_t surface_triangles(const struct surface *surface)
{
    return surface->mesh->triangles;
}

/* 3 a triangle: over the edge from corner k to k + 1; or MESH_EDGE_... */
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

/* A part's MESH_PART_... */
static inline uint32_t surface_part_flags(const struct surface *surface, uint32_t part)
{
    return mesh_part_flags(surface->mesh, part);
}

/* The moments, or NULL; `lanes` gets a word a leaf: its triangles of solid parts, as bits. */
static inline const float *surface_moments(const struct surface *surface, const uint32_t **lanes)
{
    mesh_moments(surface->mesh, lanes);
    return surface->moments;
}

/* DPT_EDGE_..., DPT_CORNER_... of each triangle; or NULL. */
static inline const uint32_t *surface_flags(const struct surface *surface)
{
    return mesh_flags(surface->mesh);
}

#endif
