/* SPDX-License-Identifier: BSD-3-Clause */
/* The first touch of a moving axis and a whole mesh, by the box tree: docs/algorithms/sweep.md. */
#ifndef DPT_SWEEP_MESH_H
#define DPT_SWEEP_MESH_H

#include "nearest/bvh.h"
#include "sweep/sweep_triangle.h"

/* The first touch. */
struct impact {
    double time;
    pair pair;         /* of the axis at that time and the triangle, in the mesh's frame */
    vec3 q;            /* the pair's point on the mesh */
    uint32_t triangle; /* place in the mesh, or DPT_NONE */
};

/* A node whose children are being looked into: nodes, or a leaf's triangles. */
struct sweep_node {
    float bound[LANES];
    uint32_t lanes; /* still to come */
    uint32_t node;
};

/* How far a sweep of a mesh has come: all that a later call needs to go on where this one ended. */
struct sweep_progress {
    double until;      /* the first hit so far, if there is one */
    uint32_t triangle; /* that is hit then, or DPT_NONE */
    uint32_t hint;     /* was asked first */
    uint32_t has_begun;
    uint32_t level; /* of the node that is looked into; 0: leaves */
    struct sweep_node path[MESH_LEVELS_MAX + 2];
};

/*
 * The whole mesh: the first touch in 0..1, of equal times the least source number. It is what
 * dpti_sweep_pair over all triangles gives.
 *
 *   from   as dpti_sweep_start told of a distance to this mesh; 0: nothing is known
 *   hint   a triangle, by its place, that is likely to be hit, such as the one last nearest: saves
 *          work and changes nothing else. DPT_NONE: none
 *   work   a unit is one block of 16 lanes, or one triangle that is asked in double
 *   progress  begun 0: begin. After SWEEP_UNFINISHED: another call with the same mesh, sweep and
 *          `from` goes on
 *   first  SWEEP_HIT: all of it. SWEEP_FREE: time 1 and no triangle. SWEEP_UNFINISHED: no triangle,
 *          and time is `from`, up to which the motion is free
 */
int dpti_sweep_mesh(const struct surface *surface, const struct kernel *kernel,
                    const struct sweep *sweep, double from, uint32_t hint, struct work *work,
                    struct sweep_progress *progress, struct impact *first);

#endif
