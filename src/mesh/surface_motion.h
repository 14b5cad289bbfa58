/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The moving vertices of a deformable body, and how its boxes and leaves follow them: docs/algorithms/deform.md.
 *
 * Nothing is refitted when vertices move. Each node of the box tree has a travel: a bound of the path of any vertex
 * below it. A leaf whose travel has grown since it was filled is filled again when a search looks at it. A box that a
 * search looks at is widened by the travel of its node since the box was made. Filling a leaf makes its box anew. So
 * does a search that looks at the parent of leaves which have travelled farther than they are wide, since a travel only
 * grows. Boxes that came out tighter are handed to the parents. So parts far from all tools cost nothing.
 *
 * Nodes are numbered level by level as in struct surface, but each level begins at a multiple of LANES.
 */
#ifndef DPT_SURFACE_MOTION_H
#define DPT_SURFACE_MOTION_H

#include "mesh/mesh_format.h"

/* Vertices whose motion is bounded together: they are neighbours in the file's order. */
enum { MOTION_GROUP = 16, MOTION_GROUP_FLOATS = 3 * MOTION_GROUP };

enum { MOTION_LEAF_GROUPS = 4 };

/*
 * Travels stay below this, in the filter's frame. Beyond it they begin anew, and cached planes are dropped: float would
 * not be accurate enough.
 */
#define MOTION_TRAVEL_MAX 4.0f

/*
 * What kernel_margin does not cover on such a surface: boxes that were widened, and planes whose support has a travel
 * of at most MOTION_TRAVEL_MAX added to it.
 */
#define MOTION_MARGIN (96.0 * 0x1p-24)

struct surface_motion {
    const struct dpt_mesh *mesh;
    uint32_t count[MESH_LEVELS_MAX + 1]; /* nodes of each level */
    uint32_t first[MESH_LEVELS_MAX + 2]; /* of each level in the arrays by node; the last one is their length */
    uint32_t levels;
    uint32_t groups;
    uint32_t tick; /* the world's, before which vertices last moved; 0: never */
    /* Float, whole groups; group_tick tells of which groups `previous` holds where they were in the last tick. */
    float *positions;
    float *previous;
    uint32_t *group_tick;
    float *leaves; /* as in struct surface */
    float *level[MESH_LEVELS_MAX + 1];
    float *travel;   /* by node, in the filter's frame */
    uint32_t begun;  /* how often travels began anew */
    float *followed; /* by node: its travel when its children's boxes, or its triangles, were brought up to date */
    float *boxed;    /* by node: its travel when its own box, in its parent, was */
    uint32_t *has_tighter; /* by node: a child's box was made anew since its own box was handed to its parent */
    /* By parent of leaves: its travel when all of their boxes were made anew, and their mean width then. */
    float *remade;
    float *leaf_width;
    float *moved;       /* by node: how far any vertex moved in the last update; scratch of updates */
    float *step;        /* by node: in the last tick in which vertices moved, all updates together */
    float *group_moved; /* by group, in the last update */
    /*
     * The groups of leaf i: MOTION_LEAF_GROUPS from leaf_groups[MOTION_LEAF_GROUPS * i] on, of which some may be the
     * same; where there are more, each is a pair of leaf and group in more_groups. So few leaves have more that loops
     * over these arrays are faster than lists of different lengths.
     */
    uint32_t *leaf_groups;
    uint32_t *more_groups;
    uint64_t more_count;
    /* The vertices of leaf i: leaf_vertices[vertex_first[i]] to, not including, [i + 1]. */
    uint32_t *vertex_first;
    uint32_t *leaf_vertices;
    float centre[3]; /* of the filter's frame */
    float scale;
    double limit_min[3], limit_max[3]; /* no vertex ever leaves this box; the surface's own is within it */
};

struct surface;

/* The bytes that the arrays need. Takes time in proportion to the mesh's triangles. */
uint64_t dpti_surface_motion_bytes(const struct dpt_mesh *mesh);

/*
 * Make a surface whose vertices move, at first where the mesh has them, and never out of a limit whose ends are floats.
 * at: the arrays' memory, aligned to 64.
 */
void dpti_surface_of_motion(const struct dpt_mesh *mesh, const double limit_min[3], const double limit_max[3], char *at,
                            struct surface_motion *motion, struct surface *surface);

/*
 * Give the surface another box, and its filter another frame: the box of the points low and high, which hold all vertices
 * of now and of the last tick and lie within the limit, with room about it. Cached planes are invalid then. It takes time
 * in proportion to the mesh, a tenth of what making the surface takes.
 */
void dpti_surface_move_box(struct surface *surface, const double low[3], const double high[3]);

/* Forget in which tick vertices moved: ticks are counted anew. */
void dpti_surface_motion_forget(struct surface_motion *motion);

/* Bring a leaf's triangles, or the boxes of a node's children, up to date. Returns units of work. */
uint32_t dpti_surface_follow_leaf(struct surface_motion *motion, uint32_t leaf);
uint32_t dpti_surface_follow_node(struct surface_motion *motion, uint32_t level, uint32_t node);

/* Where a vertex was at the end of the last tick, if vertices move before this one, `tick`. */
static inline const float *surface_motion_previous(const struct surface_motion *motion, uint32_t vertex, uint32_t tick)
{
    return (motion->group_tick[vertex / MOTION_GROUP] == tick ? motion->previous : motion->positions) +
           3 * (size_t)vertex;
}

#endif
