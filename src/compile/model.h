/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The mesh on its way through the compiler: joined, cleaned, put in order, told who its neighbours are.
 * Each step fills in its own fields, in the order of this struct.
 */
#ifndef DPT_COMPILE_MODEL_H
#define DPT_COMPILE_MODEL_H

#include "compile/soup.h"

struct part {
    uint32_t flags; /* MESH_PART_... */
    uint32_t triangles;
    uint32_t open_edges;
    uint32_t nonmanifold_edges;
};

struct model {
    /* model_clean */
    uint32_t *corners; /* 3 per triangle: of the soup's vertices, the least at a place */
    uint32_t *sources; /* a triangle's number in the source */
    uint32_t *places;  /* a source triangle's number here, or MESH_DROPPED_... */
    uint32_t triangle_count;
    uint32_t source_triangle_count;
    uint32_t source_vertex_count;
    uint32_t unused_vertices;
    uint32_t dropped_degenerate;
    uint32_t dropped_duplicate;

    /* model_order: from here on, corners are of these vertices */
    float *positions; /* 3 per vertex, distinct */
    uint32_t vertex_count;

    /* model_adjacency */
    uint32_t *neighbours; /* 3 per triangle, over the edge from corner k to k + 1 */
    uint32_t *fan_first;
    uint32_t *fans;
    uint32_t *part_of;
    struct part *parts;
    uint32_t part_count;
    uint32_t open_edges;
    uint32_t nonmanifold_edges;
    uint32_t wrong_way_edges;
    uint32_t closed_parts;
    uint8_t *is_turned; /* a triangle's corners are to be swapped: 1 */

    /* model_intersections */
    uint32_t *part_list; /* triangles by part, each part's in their order */
    uint32_t *part_first;
    uint8_t *part_cuts_itself; /* a part's: its triangles cut each other, or may do so: 1 */
    uint32_t self_intersections;
    uint32_t self_intersections_more; /* there may be more: 1 */
    uint32_t self_intersection[2];    /* by numbers of the source */

    /* model_solid */
    uint32_t inward_parts;
    uint32_t turned_triangles;
    uint32_t solid_parts;
    uint32_t cavities;
    uint32_t winding_parts;
    uint32_t buried_parts;

    /* model_normals */
    float *normals;  /* 3 per vertex */
    uint32_t *flags; /* DPT_EDGE_..., DPT_CORNER_... of a triangle */
    double crease;   /* rad */
    uint32_t crease_edges;
    uint32_t normalless_vertices;
};

void model_free(struct model *model);

/* Join equal vertices, drop degenerate and duplicate triangles. */
dpt_result model_clean(struct model *model, soup *source);

/* Put triangles in the order of the box tree, and take over the vertices that they use. */
dpt_result model_order(struct model *model, soup *source);

/* Edge neighbours, fans and parts; find what to turn so that parts are wound one way. */
dpt_result model_adjacency(struct model *model, soup *source);

/* Which triangles cut each other (triangle_pair.h). */
dpt_result model_intersections(struct model *model, soup *source);

/* Which parts have an inside, and on which side of them it is; turn triangles. */
dpt_result model_solid(struct model *model, soup *source);

/* The vertices' normals, and which edges are borders, non-manifold, or creases: of more than `crease` rad. */
dpt_result model_normals(struct model *model, soup *source, double crease);

/* Lay out the bytes of the file. source_size and source_hash as dpt_mesh_info has them. */
dpt_result model_write(const struct model *model, soup *source, uint64_t source_size,
                       uint64_t source_hash, dpt_compiled *out);

/* Zeros, aligned to MESH_ALIGN, for dpt_compiled_free; NULL when memory ran out. */
char *compiled_block(size_t size);

/* Half-edge 3 t + k and its neighbour run through their edge in the same direction: one is wound the wrong way. */
int model_is_wound_against(const struct model *model, uint32_t half, uint32_t neighbour);

/* An array, or NULL and a diag, that in a thread of its own is left to the caller: source NULL. Never 0 bytes. */
void *model_alloc(soup *source, size_t count, size_t item_size);

#endif
