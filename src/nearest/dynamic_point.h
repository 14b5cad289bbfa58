/* SPDX-License-Identifier: BSD-3-Clause */
/* The nearest pair of one tool axis and one body, in world coordinates, with its error bound. */
#ifndef DPT_DYNAMIC_POINT_H
#define DPT_DYNAMIC_POINT_H

#include "base/frame.h"
#include "nearest/bvh.h"

/* An axis in the world and in the body's frame. */
struct axis {
    vec3 a, b;       /* world */
    vec3 local_a, u; /* body: local_a + s u */
    double error;    /* the error bound of a distance from here */
};

static inline void axis_of(const struct surface *surface, const struct frame *body, vec3 a, vec3 b,
                           struct axis *axis)
{
    axis->a = a;
    axis->b = b;
    axis->local_a = frame_to_local(body, a);
    vec3 local_b = frame_to_local(body, b);
    axis->u = sub(local_b, axis->local_a);
    double reach = max_of(max_of(extent_of(a), extent_of(b)), extent_of(body->origin));
    reach = max_of(reach, max_of(extent_of(axis->local_a), extent_of(local_b)));
    axis->error = DISTANCE_ERROR * max_of(reach, dpti_surface_extent(surface));
}

/*
 * Stateless: `hint` (a place, or DPT_NONE) only makes it faster. `nearest` is written anew; its
 * triangle is DPT_NONE only where a forged file's boxes hide every triangle.
 */
void dpti_track_once(const struct surface *surface, const struct kernel *kernel, uint32_t method,
                     const struct axis *axis, uint32_t hint, struct work *work,
                     struct pair_search *nearest);

/* With history: one axis and one body, this tick. */
struct track {
    struct axis axis;
    struct pair_search nearest;
    uint32_t last;  /* last tick's triangle, a place, while it may be the answer; or DPT_NONE */
    pair last_pair; /* the axis and that triangle */
};

/* What the dynamic point does. */
enum descent_mode {
    TRACK_STAYS,
    TRACK_DESCENDS, /* it moves to what is nearer around it */
    TRACK_CROSSED   /* the same; and as its triangle was crossed, first to one that still is */
};

/*
 * The dynamic point of last tick, where it is now, or has moved to. Nothing
 * at or beyond `limit2`, a squared distance, need be found: nearest.triangle is DPT_NONE then. Where there was
 * no last tick and is no limit, any triangle is a beginning. `axis` is there already.
 */
void dpti_track_begin(struct track *track, const struct surface *surface, uint32_t last,
                      double limit2, enum descent_mode mode, struct work *work);

/*
 * The dynamic point moves: over the edge, or around the vertex, on which the nearest point of its triangle
 * lies, to a triangle that is nearer; until there is none. Of the axis its local_a, u and error count.
 */
void dpti_track_descend(const struct surface *surface, const struct axis *axis, struct work *work,
                        struct pair_search *nearest);

/* Prove or correct it; 0 if the work was spent, as dpti_bvh_traverse, whose walk and keeper these are. */
int dpti_track_prove(struct track *track, const struct surface *surface,
                     const struct kernel *kernel, const struct plane_cache_view *cache,
                     struct bvh_traversal *traversal, struct work *work);

/* Last tick's triangle stays the answer while it is within DISTANCE_ERROR_HISTORY of the error bound of the best. */
void dpti_track_settle(struct track *track);

#endif
