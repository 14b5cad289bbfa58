/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The shadow of a segment as a solid: a zonotope, the sum of four segments. One lies along u (the axis), one along the
 * direction d, two across it along e and w. w is orthogonal to the other three, which lie in one plane. So the solid is
 * bounded by four pairs of parallel planes, called slabs. Their normals are w, e, d and the normal of u in that plane.
 * All vectors are in the mesh's frame.
 */
#ifndef DPT_SHADOW_WALK_H
#define DPT_SHADOW_WALK_H

#include "base/vec3.h"
#include "dynpoint/strip.h"
#include "mesh/surface.h"

enum { SHADOW_SLABS = 4 };

struct shadow_volume {
    vec3 a, u;         /* the axis: a + s u, s in 0..1 */
    vec3 d, e, w;      /* unit */
    double half_width; /* m, along e and w */
    double depth;      /* m, along d, to both sides */
    /* x, y and z of the slabs' unit normals n, then the limits of (x - a).n of each slab, m. */
    double normal[3][SHADOW_SLABS];
    double low[SHADOW_SLABS];
    double high[SHADOW_SLABS];
};

/* Make the shadow of the axis a + s u. `direction` need not be unit, but not 0; half_width and depth in m, >= 0. */
void dpti_shadow_volume_of(vec3 a, vec3 u, vec3 direction, double half_width, double depth,
                           struct shadow_volume *volume);

/* The connected piece of the surface within a shadow: docs/algorithms/strip.md. */

struct shadow_vertex {
    double value[SHADOW_SLABS]; /* (x - a).n for each slab's normal, m */
    uint32_t outside;           /* two bits a slab: x is below, above */
    uint32_t number;            /* of the vertex in the mesh */
};

struct shadow_triangle {
    uint32_t place;
    uint32_t apex;      /* its corner, 0..2, opposite to the edge over which it was entered */
    uint32_t corner[3]; /* indices of the walk's vertices, from the apex on */
};

struct shadow_slot {
    uint32_t place;
    uint32_t stamp; /* of the walk that filled it; with another stamp it is free */
};

/* The memory of a walk. It holds the result of the last one. */
struct shadow_walk {
    const struct dpt_mesh *mesh; /* NULL: there was no walk */
    uint32_t crc32;              /* of the mesh's header, since another mesh may come to lie at its address */
    uint32_t start;              /* place */
    struct shadow_volume volume;
    uint32_t flags; /* DPT_STRIP_FLAG_... */
    struct shadow_triangle *triangles;
    struct shadow_vertex *vertices; /* room for `capacity` and two more */
    struct shadow_slot *slots;      /* open addressing, by place */
    uint32_t capacity;              /* triangles */
    uint32_t slot_count;            /* a power of two */
    uint32_t stamp;                 /* of this walk, from 1 on */
    uint32_t triangle_count, vertex_count;
    uint32_t prefetched_leaf; /* that of the last triangle added */
    const uint32_t *corners, *neighbours, *sources;
    const float *positions;
};

/*
 * Collect the triangles of the connected piece that holds `start`, a place, into walk->triangles. If neither the
 * surface, the shadow nor the start have changed since the last walk, its result stays. If the start does not meet the
 * shadow, there is none.
 */
void dpti_shadow_walk(struct shadow_walk *walk, const struct surface *surface, const struct shadow_volume *volume,
                      uint32_t start);

#endif
