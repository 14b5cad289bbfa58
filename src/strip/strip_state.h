/* SPDX-License-Identifier: BSD-3-Clause */
/* A strip, at the beginning of its block. */
#ifndef DPT_STRIP_STATE_H
#define DPT_STRIP_STATE_H

#include "base/frame.h"
#include "dynpoint/strip.h"
#include "nearest/bvh.h"
#include "strip/route.h"
#include "strip/shadow_walk.h"

struct dpt_strip {
    dpt_strip_def def;
    const struct dpt_mesh *mesh; /* of its triangles, or NULL */
    uint32_t *triangles;         /* source numbers */
    uint32_t count;
    uint32_t flags; /* DPT_STRIP_FLAG_... */
    struct route_search search;
    struct shadow_walk walk;
};

/* Empty a strip, to fill it with triangles of a mesh. */
void dpti_strip_clear(struct dpt_strip *strip, const struct dpt_mesh *mesh);

/* Forget the last shadow, so that the next one is walked even if it is the same. */
void dpti_strip_forget(struct dpt_strip *strip);

/* Flag a strip as full: it lacks triangles. */
void dpti_strip_set_full(struct dpt_strip *strip);

/* Add a triangle, by its place. A strip without room for it is flagged as full. */
void dpti_strip_add(struct dpt_strip *strip, uint32_t place);

/*
 * The place of a triangle, by its source number. DPT_E_ARGUMENT: there is no such; DPT_E_DROPPED: the compiler dropped
 * it.
 */
dpt_result dpti_strip_place(const struct dpt_mesh *mesh, uint32_t number, uint32_t *place);

/* As dpt_strip_shadow, with the shadow in the mesh's frame. `place` is that of the first triangle. */
void dpti_strip_shadow(struct dpt_strip *strip, const struct surface *surface, const struct shadow_volume *volume,
                       uint32_t place);

/* As dpt_strip_routes, with places instead of source numbers. */
dpt_result dpti_strip_routes(struct dpt_strip *strip, const struct dpt_mesh *mesh, uint32_t a, uint32_t b, uint32_t p);

/* A tool at a strip: its axis a + s u in the mesh's frame, and the side of the surface that it is on, 1 or -1. */
struct strip_tool {
    vec3 a, u;
    double radius; /* m */
    int32_t side;
};

/* As dpt_strip_overlaps. `frame` is the mesh's in the world; all is valid. */
void dpti_strip_overlaps(const struct dpt_strip *strip, const struct surface *surface, const struct frame *frame,
                         const struct strip_tool *tool, dpt_overlap *overlaps, uint32_t capacity);

/* The overlap of one triangle, by its place. */
void dpti_strip_overlap(const struct surface *surface, const struct frame *frame, const struct strip_tool *tool,
                        uint32_t place, dpt_overlap *overlap);

#endif
