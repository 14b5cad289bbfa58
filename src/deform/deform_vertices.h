/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * New positions for the vertices of a deformable body's surface: docs/algorithms/deform.md. Positions are in the body's
 * frame, m, 3 floats a vertex, in the mesh's order.
 */
#ifndef DPT_DEFORM_VERTICES_H
#define DPT_DEFORM_VERTICES_H

#include "kernel/kernel_ops.h"
#include "mesh/surface.h"
#include "strip/strip_state.h"

/* 1 if all positions are numbers and lie in the surface's box. */
int dpti_deform_is_inside(const struct surface *surface, const struct kernel *kernel, const float *positions,
                          uint32_t count);

/* An update: `count` vertices, from `first` on or, if it is not NULL, those of a list. */
struct vertex_update {
    const float *positions;
    const uint32_t *list;
    uint32_t first, count;
    double bound;  /* m: none of them moves farther; below 0: measure it */
    uint32_t tick; /* the world's, before which they move */
};

/* 1 if all positions are numbers and lie in the surface's limit, up to which its box can be moved. */
int dpti_deform_is_in_limit(const struct surface *surface, const float *positions, uint32_t count);

/*
 * The box, from `low` to `high`, of an update, of all vertices, now and before its tick, and of where they are bound for
 * (NULL: nowhere else).
 */
void dpti_deform_extent(const struct surface *surface, const struct vertex_update *update, const float *target,
                        double low[3], double high[3]);

/*
 * Move vertices; they are inside the surface's box. Sets *has_begun_anew if travels start again from 0: then cached
 * planes of the surface are invalid. Returns how far any vertex of the body moved in this update at most, m.
 */
double dpti_deform_move(struct surface *surface, const struct kernel *kernel, const struct vertex_update *update,
                        int *has_begun_anew);

/*
 * Move vertices one by one: begin, put each where it is to be, end. A vertex that would leave the surface's box stays
 * where it is. dpti_deform_end returns what dpti_deform_move returns.
 */
void dpti_deform_begin(struct surface *surface, uint32_t tick);
void dpti_deform_put(struct surface *surface, uint32_t vertex, vec3 to);
double dpti_deform_end(struct surface *surface, int *has_begun_anew);

/* ---- the paper's response: triangles under a tool that it penetrates are moved out of it ---- */

/* A tool's axis a + s u, in the body's frame, and on which side of the surface it is: +1 in front, -1 behind. */
struct displacing_tool {
    vec3 a, u;
    double radius;
    int32_t side;
    int is_behind; /* 1: the axis goes through the surface, or is wholly behind it */
};

/*
 * Move the triangles of a strip out of a tool, `passes` times in the strip's order; between dpti_deform_begin and
 * dpti_deform_end. In each pass a triangle's nearest point is moved out of the tool, and the corners with it as they
 * are weighted there.
 */
void dpti_displace(struct surface *surface, const struct dpt_strip *strip, const struct displacing_tool *tool,
                   uint32_t passes);

#endif
