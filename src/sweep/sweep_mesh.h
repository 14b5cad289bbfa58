/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The first touch of a moving axis and a whole mesh, by the box tree: docs/algorithms/sweep.md. Lengths are in m, in
 * the mesh's frame; times are in ticks, 0 to 1. Triangles go by their place in the file's order.
 */
#ifndef DPT_SWEEP_MESH_H
#define DPT_SWEEP_MESH_H

#include "nearest/bvh.h"
#include "sweep/sweep_triangle.h"

/*
 * When a sweep of a mesh takes place: its times 0 and 1 are `from` and `to` of the motion of the surface's vertices
 * before `tick`. tick 0: the vertices are at rest.
 */
struct surface_times {
    uint32_t tick;
    double from, to;
};

/* The first touch of a sweep. */
struct impact {
    double time;
    struct pair pair;  /* of the axis at that time and the triangle, in the mesh's frame */
    vec3 q;            /* the pair's point on the mesh */
    uint32_t triangle; /* by its place, or DPT_NONE */
};

/* A node on the path of a sweep, or a leaf. Its bounds are of distances to the swept hull, in the filter's frame. */
struct sweep_node {
    float bound[LANES]; /* of the children */
    uint32_t lanes;     /* children that are still to be visited, as bits */
    uint32_t node;      /* index in its level */
};

/* How far a sweep of a mesh has come: all that a later call needs to continue. */
struct sweep_progress {
    double until;                                /* time of the first hit so far; 1 if there is none */
    uint32_t triangle;                           /* hit at that time, or DPT_NONE */
    uint32_t hint;                               /* the triangle that was evaluated first, or DPT_NONE */
    uint32_t has_begun;                          /* 0: no call was left unfinished */
    uint32_t level;                              /* of the node being visited; 0: a leaf; levels + 1: above the root */
    uint32_t ruled_out;                          /* triangles of a test that planes of their own ruled out */
    struct sweep_node path[MESH_LEVELS_MAX + 2]; /* by level */
};

/* A plane beyond which nothing is touched: a triangle lies there if normal.v of its corners is more than the limit. */
struct first_plane {
    float normal[3], limit;
};

/* A sweep of a mesh. A unit of its work is one block of 16 lanes, or one triangle evaluated in double. */
struct mesh_sweep {
    /* To be set before. */
    const struct surface *surface;
    const struct kernel *kernel;
    const struct sweep *sweep;         /* its surface_speed bounds the speed of the vertices */
    const struct surface_times *times; /* when the vertices move */
    double from; /* time from which to search: that of dpti_sweep_start for a distance to this mesh; 0: none is known */
    struct work *work;
    struct sweep_progress *progress; /* has_begun 0: begin */
    /* The sweep's own. */
    struct swept_hull hull; /* of the motion from `from` to progress->until */
    struct first_plane first_planes[SWEEP_DIRECTIONS_MAX];
    uint32_t first_plane_count;
};

/*
 * The first touch with a whole surface at times 0..1. Of equal times the lowest source number wins. The answer is that of
 * dpti_sweep_triangle over all triangles. Returns a sweep_status. After SWEEP_UNFINISHED, another call with the same
 * surface, sweep, progress and `from` continues.
 *
 *   hint   a triangle that is likely to be hit, such as the one last nearest; it saves work and changes nothing else.
 *          DPT_NONE: none
 *   first  SWEEP_HIT: the touch. SWEEP_FREE: time 1 and no triangle. SWEEP_UNFINISHED: no triangle, and the time is
 *          `from`, up to which the motion is free
 */
int dpti_sweep_mesh(struct mesh_sweep *search, uint32_t hint, struct impact *first);

/*
 * The bounds alone, for a caller with blocks of its own. Aim: the hull and the planes of the motion from `from` to
 * progress->until. Then, of a block of boxes or a leaf's triangles, the lanes that may be touched.
 */
void dpti_sweep_aim(struct mesh_sweep *search);
uint32_t dpti_sweep_open_boxes(const struct mesh_sweep *search, const float *rows);
uint32_t dpti_sweep_open_triangles(const struct mesh_sweep *search, const float *rows);

/*
 * Whether a motion may touch the surface at all: by bounds, and of a few triangles that these leave in doubt by
 * dpti_sweep_may_touch_triangle. Much cheaper than the first touch where something is near. The progress is for this
 * motion alone.
 *
 *   leaf  in: a leaf to look at first, or DPT_NONE. out: the one that may be touched, if there is one
 *
 * SWEEP_FREE: nothing is touched at times from..1. SWEEP_HIT: something may be. SWEEP_UNFINISHED: call again.
 */
int dpti_sweep_may_touch(struct mesh_sweep *search, uint32_t *leaf);

#endif
