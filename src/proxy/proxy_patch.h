/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The patch of surface round a proxy: docs/algorithms/patch.md. All triangles of one body within reach of the tool's
 * axis, found once in many ticks; and what a tick makes of them.
 */
#ifndef DPT_PROXY_PATCH_H
#define DPT_PROXY_PATCH_H

#include "proxy/proxy_tick.h"

enum { PATCH_BLOCKS = 8, PATCH_LEAVES = PATCH_BLOCKS * LANES, PATCH_TRIANGLES_MAX = 192 };

/* The leaves, with their boxes as children of nodes of their own. Kept from tick to tick; one a segment. */
struct proxy_patch {
    vec3 a, b;        /* the axis about which it lies, in the body's frame */
    double reach;     /* m: each triangle that near to that axis is in one of the leaves; 0: there is no patch */
    uint32_t body_id; /* the body, which does not deform */
    uint32_t count;   /* of leaves */
    uint32_t crowded; /* there was no room: it is tried again in that tick of the world */
    uint32_t is_off;  /* 1: it is not used, as a test wants */
    double spare;     /* what was found beside what was asked for, as a multiple of the reach */
    uint32_t leaf[PATCH_LEAVES]; /* ascending */
    float box[PATCH_BLOCKS][MESH_BOX_WORDS];
};

/* A triangle of the patch. */
struct patch_triangle {
    pair found;        /* its nearest pair with the axis, if is_found */
    double gap;        /* m: of that pair; else no more than it */
    vec3 normal;       /* unit, across the last pair that was found: it lies behind the plane normal . x = height */
    double height;     /* m; HUGE_VAL: none was found */
    uint32_t triangle; /* place */
    uint16_t is_found;
    uint16_t is_held;  /* it has a constraint */
    uint16_t has_face; /* which may be its own plane */
    uint16_t space;    /* the number of the constraint; HALF_SPACES_MAX: a neighbour has the same */
};

/* A tick's view of the patch. */
struct patch_view {
    struct proxy_patch *patch;
    struct segment *segment;
    const struct body *body;
    int is_ball;
    vec3 world_a, world_b; /* the axis at tick->at */
    vec3 a, u;             /* in the body's frame */
    double reach;          /* m: no triangle outside of the list has a gap below that */
    uint32_t count;
    uint32_t nearest; /* in the list; PATCH_TRIANGLES_MAX: none within PATCH_NEAR */
    struct patch_triangle list[PATCH_TRIANGLES_MAX];
};

/* As a multiple of the clearance: the nearest pair is looked for that far. */
#define PATCH_NEAR 20.0

/* Its share of dpt_world_bytes. */
uint64_t dpti_patch_bytes(const dpt_world_def *def);

/* Begin anew, as if it had never been used. */
void dpti_patch_forget(struct proxy_patch *patch);

/* Whether the tick may work with the patch: of one segment, held by one body at rest. Begins the view. */
int dpti_patch_begin(struct proxy_tick *tick, struct patch_view *view);

/*
 * The triangles round tick->at, those with a gap up to `reach` m, or to less where there are too many; none has a constraint. tick->gap becomes the
 * nearest one's, or what is proven of it. Returns 0 if they have no room, or the work does not suffice.
 */
int dpti_patch_look(struct proxy_tick *tick, struct patch_view *view, double reach);

/* Find a triangle's nearest pair with the view's axis, and the plane across it. */
void dpti_patch_find(struct dpt_world *world, const struct patch_view *view, struct patch_triangle *triangle);

/* m: an axis from a to b is so far in front of the plane of the last pair that was found, less its radius. */
static inline double patch_gap_of_plane(const struct patch_view *view, const struct patch_triangle *triangle, vec3 a,
                                        vec3 b)
{
    return min_of(dot(triangle->normal, a), dot(triangle->normal, b)) - triangle->height - view->segment->radius;
}

/* The nearest pair at tick->at becomes the segment's answer. Returns 0 if there is none in the view. */
int dpti_patch_answer(struct proxy_tick *tick, const struct patch_view *view);

#endif
