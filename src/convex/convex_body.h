/* SPDX-License-Identifier: BSD-3-Clause */
/* A curved shape as its support function; docs/algorithms/convex.md. */
#ifndef DPT_CONVEX_BODY_H
#define DPT_CONVEX_BODY_H

#include "base/frame.h"
#include "dynpoint/convex.h"

/* A shape in its own frame, checked. */
struct convex_body {
    uint32_t kind;
    uint32_t corner_count; /* of a hull */
    double x, y, z;        /* half of its extents: of the round kinds x is the radius, z half the length */
    int is_cut;
    vec3 cut; /* unit: the shape is where cut.p <= cut_at */
    double cut_at;
    vec3 centre;  /* a point inside */
    double size;  /* m: all points are within it of the centre */
    vec3 outside; /* in the tool's frame */
    double round; /* of a hull, m */
    vec3 axis[2]; /* the shape is within `reach` of this segment */
    double reach;
    struct frame frame; /* in the tool's frame */
    vec3 corner[DPT_HULL_CORNERS_MAX];
};

/* Check a caller's shape, and make a body of it. */
dpt_result dpti_convex_body_of(const dpt_convex_shape *given, struct convex_body *body);

/* The point of a list that is farthest along d; the first of equal ones. At least one point. */
static inline vec3 convex_farthest(const vec3 *points, uint32_t count, vec3 d)
{
    uint32_t best = 0;
    double max = dot(points[0], d);
    for (uint32_t i = 1; i < count; i++) {
        const double here = dot(points[i], d);
        if (here > max) {
            max = here;
            best = i;
        }
    }
    return points[best];
}

/* A point of the body that is farthest along d, which need not be of unit length. */
vec3 dpti_convex_support(const struct convex_body *body, vec3 d);

#endif
