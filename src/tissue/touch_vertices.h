/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The vertices of springs' surfaces that are near a round tool, where triangles are fine for its radius. Where they are many,
 * those that lie together at rest, in a cube of a grid, make one touch.
 *
 *     patch = dpti_touch_patch_of(vertices, tool_slot, part, body_id);
 *     dpti_touch_patch_begin(vertices, patch);
 *     for each corner near the tool: if (dpti_touch_vertex_is_new(...)) dpti_touch_vertex_add(...)
 *     dpti_touch_patch_group(vertices, patch, &shape);
 */
#ifndef DPT_TOUCH_VERTICES_H
#define DPT_TOUCH_VERTICES_H

#include "base/vec3.h"

/* So many in a step, and of one part of a tool on a body. */
enum { TOUCH_VERTICES_MAX = 2048, TOUCH_PATCH_MAX = 1024, TOUCH_TABLE_BITS = 11, TOUCH_PATCHES_MAX = 32 };

struct touch_vertex {
    uint32_t vertex, triangle;
    uint32_t next;   /* of the same touch, plus 1; 0: it is the last */
    int is_first;    /* of its touch */
    uint64_t cube;   /* that its touch is of: 63 bits */
    vec3 at, normal; /* as a touch's */
    double distance; /* m: from the tool's axis, where it is foreseen */
    double gap;      /* as a touch's */
    double share;    /* of its touch's force, and of how that feels the surface */
};

/* A part of a tool on a body. How it was taken in the last step is where the next one begins, so that it seldom changes. */
struct touch_patch {
    uint32_t tool_slot, part, body_id;
    uint32_t first;  /* of its vertices in the list, which end with it */
    uint32_t coarse; /* 0: each is a touch; the more, the wider the grid's cubes */
    uint32_t thin;   /* of 2 to this power of them one counts, by chance */
    double near;     /* m: how much farther from the tool than the nearest one others count in a touch */
};

/* What is round, and what it is near to. */
struct touch_shape {
    const float *rest;    /* of all vertices, 3 each */
    double radius, reach; /* m: of the tool; of the search */
};

struct touch_vertices {
    uint32_t count;
    struct touch_vertex vertex[TOUCH_VERTICES_MAX];
    uint16_t table[1 << TOUCH_TABLE_BITS]; /* of a patch: one more than a vertex's place in the list; 0: none */
    uint32_t patch_count;
    struct touch_patch patches[TOUCH_PATCHES_MAX];
};

/* A feature of a touch of vertices (struct touch): this, and the upper half of its cube. */
#define TOUCH_OF_VERTICES 0x80000000u

/* It lasts until another one is asked for. */
struct touch_patch *dpti_touch_patch_of(struct touch_vertices *all, uint32_t tool_slot, uint32_t part,
                                        uint32_t body_id);

/* Its vertices are those that are added from now on. */
void dpti_touch_patch_begin(struct touch_vertices *all, struct touch_patch *patch);

/* Whether a vertex counts, and is not there yet. */
int dpti_touch_vertex_is_new(const struct touch_vertices *all, const struct touch_patch *patch, uint32_t vertex);

/* Add one that is new. Returns 0 if there is no room. */
int dpti_touch_vertex_add(struct touch_vertices *all, const struct touch_patch *patch,
                          const struct touch_vertex *vertex);

/* Take fewer of them: those that are there are dropped. Returns 0 if it cannot be fewer. */
int dpti_touch_patch_thin(struct touch_vertices *all, struct touch_patch *patch);

/* Put them together to touches: lists, with shares. */
void dpti_touch_patch_group(struct touch_vertices *all, struct touch_patch *patch, const struct touch_shape *shape);

#endif
