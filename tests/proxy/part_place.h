/* SPDX-License-Identifier: BSD-3-Clause */
/* For tests of patches: a segment or tip of a tool on its way, and how far a triangle is from it. */
#ifndef DPT_TESTS_PART_PLACE_H
#define DPT_TESTS_PART_PLACE_H

#include "hull/straight_hull.h"
#include "proxy/proxy_patch.h"

/* As a share of a hull's reach: so much farther its corners may be from its axis on the way. */
#define BENT 1.01

/* The axis of a segment or tip where a pose has it, in a body's frame. */
static inline void axis_at(const struct patch_axis *axis, const struct body *body, const struct proxy_pose *at, vec3 *a,
                           vec3 *b)
{
    const struct part part = axis->part;
    *a = frame_to_local(&body->frame, frame_to_world(&at->frame, part.tip ? part.tip->hull->axis_a : part.segment->a));
    *b = frame_to_local(&body->frame, frame_to_world(&at->frame, part.tip ? part.tip->hull->axis_b : part.segment->b));
}

/* A part of the tool at a time of a motion on which its ends and corners go straight, in a body's frame. */
struct part_place {
    double radius, reach;
    struct hull_place hull; /* its axis, and of a tip all of it */
};

static inline struct part_place part_at(const struct patch_axis *axis, const struct body *body,
                                        const struct proxy_pose *from, const struct proxy_pose *to, double time)
{
    struct part_place place = { .radius = part_radius(axis->part), .hull = { .hull = NULL } };
    struct hull_place *at = &place.hull;
    vec3 a, b, to_a, to_b;
    axis_at(axis, body, from, &a, &b);
    axis_at(axis, body, to, &to_a, &to_b);
    at->a = along(a, time, sub(to_a, a));
    at->u = sub(along(b, time, sub(to_b, b)), at->a);
    if (!axis->part.tip)
        return place;
    const struct dpt_hull *hull = at->hull = axis->part.tip->hull;
    place.reach = BENT * hull->reach;
    straight_hull_at(hull, &from->frame, &to->frame, &body->frame, time, at);
    return place;
}

/* m: how far a triangle is from it; of a tip, where that is more than `within`, some bound of it. */
static inline double gap_at(const struct part_place *place, const struct surface *surface, uint32_t t, double within)
{
    const double gap =
        sqrt(dpti_triangle_pair(surface, t, place->hull.a, place->hull.u).distance2) - place->reach - place->radius;
    struct hull_pair found;
    vec3 v[3];
    if (!place->hull.hull || gap > within)
        return gap;
    surface_corners(surface, t, v);
    dpti_hull_triangle(&place->hull, v, HUGE_VAL, &found);
    return sqrt(found.pair.distance2) - place->radius;
}

#endif
