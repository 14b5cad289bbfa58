/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The surface about a shadow, taken out of the mesh into a few short arrays, with some margin, so that the next shadows
 * near it need not go to the mesh: docs/algorithms/strip.md.
 */
#ifndef DPT_PATCH_H
#define DPT_PATCH_H

#include "dynpoint/strip.h"
#include "mesh_format.h"
#include "shade.h"

struct patch_vertex {
    double value[SHADE_SLABS]; /* of (x - a) . normal, of the shadow that was asked for last */
    float x[3];
    uint32_t outside; /* two bits a slab: below, above */
};

struct patch_triangle {
    uint32_t place;
    uint32_t corner[3]; /* vertices of the patch */
    uint16_t entry;     /* the edge over which it was entered, from that corner on; 3: none */
    uint16_t reached;
};

/* An edge of the patch and the two triangles that it connects. The first one that leads to a triangle is its `entry`. */
struct gate {
    uint32_t vertex[2];
    uint32_t from;
    uint32_t to;   /* or PATCH_BORDER */
    uint16_t many; /* more triangles than these have that edge */
    uint16_t open; /* the shadow that was asked for last meets it */
};

#define PATCH_BORDER UINT32_MAX

struct patch_slot {
    uint32_t place;
    uint32_t triangle; /* of the patch, and one; 0: free */
};

struct patch {
    const struct dpt_mesh *mesh; /* NULL: nothing is known */
    const uint32_t *corners;     /* sections of it */
    const uint32_t *neighbours;
    const uint32_t *sources;
    const float *positions;
    struct patch_triangle *triangles;
    struct patch_vertex *vertices;
    struct gate *gates;
    struct patch_slot *slots; /* open addressing */
    uint32_t room; /* for triangles; for two vertices more and for three times as many gates */
    uint32_t slot_count;
    uint32_t triangle_count, vertex_count, gate_count;
    uint32_t leaf; /* of the last triangle that came in */
    uint32_t full;
    uint32_t flags;     /* of the shadow that was asked for last: DPT_STRIP_... */
    uint32_t asked;     /* shadows since it was made */
    struct shade shade; /* for which it was made */
    double margin;      /* by how much it reaches beyond */
};

/*
 * Mark as `reached` the triangles of the piece of the surface within the shadow that holds `start`, a place. Returns
 * bits of DPT_STRIP_...
 */
uint32_t patch_walk(struct patch *patch, const struct dpt_mesh *mesh, const struct shade *shade,
                    uint32_t start);

#endif
