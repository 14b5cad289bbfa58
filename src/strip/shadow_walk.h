/* SPDX-License-Identifier: BSD-3-Clause */
/* The piece of the surface under a shadow: docs/algorithms/strip.md. */
#ifndef DPT_SHADOW_WALK_H
#define DPT_SHADOW_WALK_H

#include "dynpoint/strip.h"
#include "mesh/surface.h"
#include "strip/shadow_volume.h"

struct shadow_vertex {
    double value[SHADOW_SLABS]; /* of (x - a) . normal */
    uint32_t outside;           /* two bits a slab: below, above */
    uint32_t number;            /* in the mesh */
};

struct shadow_triangle {
    uint32_t place;
    uint32_t apex;      /* its corner across the edge over which it was entered */
    uint32_t corner[3]; /* vertices of the walk, from the apex on */
};

struct shadow_slot {
    uint32_t place;
    uint32_t stamp; /* of the walk that put it there; of another: free */
};

/* The memory of a walk, which is what the last one found. */
struct shadow_walk {
    const struct dpt_mesh *mesh; /* NULL: there was none */
    uint32_t crc32; /* of its header, and so of all of it: another may come to lie there */
    uint32_t start;
    struct shadow_volume volume;
    uint32_t flags; /* DPT_STRIP_... */
    struct shadow_triangle *triangles;
    struct shadow_vertex *vertices; /* room for two more */
    struct shadow_slot *slots;      /* open addressing, by place */
    uint32_t capacity;              /* for triangles */
    uint32_t slot_count;            /* a power of two */
    uint32_t stamp;                 /* of this walk, from 1 on */
    uint32_t triangle_count, vertex_count;
    uint32_t prefetched_leaf; /* of the last triangle that came in */
    const uint32_t *corners, *neighbours, *sources;
    const float *positions;
};

/* The triangles of the piece that holds `start`, a place, into walk->triangles. */
void dpti_shadow_walk(struct shadow_walk *walk, const struct surface *surface,
                      const struct shadow_volume *volume, uint32_t start);

#endif
