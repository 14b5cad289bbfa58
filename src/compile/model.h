/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The mesh on its way through the compiler. Each step fills in its own fields, in the order of this struct.
 *
 * A triangle's source number is its index in the soup. Its place is its index in the compiled file. From model_order
 * on, every triangle index here is a place, unless the field says otherwise.
 */
#ifndef DPT_COMPILE_MODEL_H
#define DPT_COMPILE_MODEL_H

#include "compile/soup.h"

/* A set of triangles connected by edges. The compiled file holds this struct as it is. */
struct part {
    uint32_t flags; /* MESH_PART_... */
    uint32_t triangles;
    uint32_t open_edges;
    uint32_t nonmanifold_edges; /* triangle sides on non-manifold edges */
};

struct model {
    /* model_clean */
    /* 3 per triangle: the lowest-numbered of the soup's vertices at that position */
    uint32_t *corners;
    uint32_t *sources; /* by place: the source number */
    uint32_t *places;  /* by source number: the place, or MESH_DROPPED_... */
    uint32_t triangle_count;
    uint32_t source_triangle_count;
    uint32_t source_vertex_count;
    uint32_t unused_vertices;
    uint32_t dropped_degenerate;
    uint32_t dropped_duplicate;

    /* model_order: from here on, `corners` are indices of these vertices */
    float *positions;         /* 3 per vertex, m; distinct */
    uint32_t *vertex_sources; /* of each vertex: its number in the soup */
    uint32_t vertex_count;

    /* model_adjacency */
    /* 3 per triangle: over the edge from corner k to k + 1, or MESH_EDGE_... */
    uint32_t *neighbours;
    uint32_t *fan_first; /* vertex_count + 1: where a vertex's triangles begin in `fans` */
    uint32_t *fans;      /* triangles by vertex, ascending at each */
    uint32_t *part_of;   /* of each triangle: its part */
    struct part *parts;
    uint32_t part_count;
    uint32_t open_edges;
    uint32_t nonmanifold_edges;
    uint32_t wrong_way_edges;
    uint32_t closed_parts;
    uint8_t *is_turned; /* 1: reverse this triangle's winding, so that its part is wound one way */

    /* model_intersections */
    uint32_t *part_list;       /* triangles by part, ascending in each */
    uint32_t *part_first;      /* part_count + 1: where a part's triangles begin in `part_list` */
    uint8_t *part_cuts_itself; /* 1: triangles of the part cut each other, or the search stopped early */
    uint32_t self_intersections;
    uint32_t self_intersections_more; /* 1: there may be more */
    uint32_t self_intersection[2];    /* one pair, by source numbers; DPT_NONE: none */

    /* model_solid */
    uint32_t inward_parts;
    uint32_t turned_triangles;
    uint32_t solid_parts;
    uint32_t cavities;
    uint32_t winding_parts;
    uint32_t buried_parts;

    /* model_normals */
    float *normals;  /* 3 per vertex: unit, or 0 */
    uint32_t *flags; /* of each triangle: DPT_EDGE_..., DPT_CORNER_... */
    double crease;   /* rad */
    uint32_t crease_edges;
    uint32_t normalless_vertices;

    /* model_embed, or model_springs of a volume; NULL and 0 where there are no cells */
    uint32_t *embedding_nodes; /* 4 per vertex */
    float *embedding_weights;  /* 4 per vertex */
    uint32_t node_count;
    uint32_t outside_vertices;
    double outside_distance; /* m */

    /* model_springs: what the file holds (spring_net.h); NULL and 0 where there are none */
    float *spring_rest; /* NULL: the nodes are the vertices */
    float *spring_mass;
    float *spring_drag;
    uint32_t *spring_first;
    uint32_t *spring_ends;
    float *spring_stiffness;
    float *spring_length;
    uint32_t *cell_nodes; /* of a lattice whose cells have a term for their volume; else NULL, and no cells */
    float *cell_stiffness;
    uint32_t spring_nodes;
    uint32_t spring_count;
    uint32_t spring_entries;
    uint32_t fixed_nodes;
    uint32_t cell_count;
    double cell_size; /* m */
    double viscosity;
    double mass; /* kg */
    double poisson;
    double stable_step; /* s */
};

void model_free(struct model *model);

/* Join vertices at equal positions. Drop degenerate and duplicate triangles. */
dpt_result model_clean(struct model *model, soup *source);

/* Put the triangles into the order of the box tree, and number the vertices that they use. */
dpt_result model_order(struct model *model, soup *source);

/* Find edge neighbours, fans and parts, and which triangles to turn so that each part is wound one way. */
dpt_result model_adjacency(struct model *model, const struct compile_context *context);

/* Count the pairs of triangles that cut each other (triangle_pair.h). */
dpt_result model_intersections(struct model *model, const struct compile_context *context);

/* Find which parts have an inside, and on which side of the surface it is. Turn triangles. */
dpt_result model_solid(struct model *model, const struct compile_context *context);

/*
 * Compute vertex normals. Flag edges that are borders, non-manifold or creases; a crease's two normals differ by more
 * than `crease` rad.
 */
dpt_result model_normals(struct model *model, const struct compile_context *context, double crease);

/* Embed the vertices in the cells of the def, if it has any. Needs only the vertices. */
dpt_result model_embed(struct model *model, soup *source);

/* Make the masses and springs of the def, if it has any. Needs vertices, neighbours and parts. */
dpt_result model_springs(struct model *model, soup *source);

/* Write the bytes of the file. source_size and source_hash are those of dpt_mesh_info. */
dpt_result model_write(const struct model *model, soup *source, uint64_t source_size, uint64_t source_hash,
                       dpt_compiled *out);

/* Allocate zeroed bytes, aligned to MESH_ALIGN; dpt_compiled_free frees them. NULL when memory runs out. */
char *compiled_block(size_t size);

/*
 * Is triangle `neighbour` wound against the one of half-edge `half` (3 t + k)? 1 if both run through their common edge
 * in the same direction.
 */
int model_is_wound_against(const struct model *model, uint32_t half, uint32_t neighbour);

#endif
