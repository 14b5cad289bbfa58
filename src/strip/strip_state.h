/* SPDX-License-Identifier: BSD-3-Clause */
/* What lies in the block of a strip. */
#ifndef DPT_STRIP_STATE_H
#define DPT_STRIP_STATE_H

#include "base/frame.h"
#include "dynpoint/strip.h"
#include "nearest/bvh.h"
#include "strip/route.h"
#include "strip/shadow_walk.h"

struct dpt_strip {
    dpt_strip_def def;
    const struct dpt_mesh *mesh; /* of its triangles; NULL while it is empty */
    uint32_t *triangles;         /* by number in the source */
    uint32_t count;
    uint32_t flags;
    struct route_search search;
    struct shadow_walk walk;
};

/* Empty it, to be filled with triangles of a mesh. */
void dpti_strip_clear(struct dpt_strip *strip, const struct dpt_mesh *mesh);

/* Forget the last shadow. */
void dpti_strip_forget(struct dpt_strip *strip);

/* There is more than it can tell. */
void dpti_strip_set_full(struct dpt_strip *strip);

/* Put a triangle at its end, by its place; a full one is flagged. */
void dpti_strip_add(struct dpt_strip *strip, uint32_t place);

/* The place of a triangle by its number. */
dpt_result dpti_strip_place(const struct dpt_mesh *mesh, uint32_t number, uint32_t *place);

/* As dpt_strip_shadow, with the segment, the direction and the first triangle's place in the mesh's frame. */
void dpti_strip_shadow(struct dpt_strip *strip, const struct surface *surface,
                       const struct shadow_volume *volume, uint32_t place);

/* As dpt_strip_routes, of places. */
dpt_result dpti_strip_routes(struct dpt_strip *strip, const struct dpt_mesh *mesh, uint32_t a,
                             uint32_t b, uint32_t p);

/* dpt_strip_overlaps of the axis a + s u in the mesh's frame, of what is valid. */
void dpti_strip_overlaps(const struct dpt_strip *strip, const struct surface *surface,
                         const struct frame *frame, vec3 a, vec3 u, double radius, int32_t side,
                         dpt_overlap *overlaps, uint32_t capacity);

#endif
