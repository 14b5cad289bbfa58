/* SPDX-License-Identifier: BSD-3-Clause */
/* A hull whose corners go straight from one place to another. In between it is an image of itself, and convex. */
#ifndef DPT_TESTS_STRAIGHT_HULL_H
#define DPT_TESTS_STRAIGHT_HULL_H

#include "hull/hull_triangle.h"

/* Its corners and faces at a time, in the frame of a body; its axis is left as it is. */
static inline void straight_hull_at(const struct dpt_hull *hull, const struct frame *from, const struct frame *to,
                                    const struct frame *body, double time, struct hull_place *at)
{
    at->hull = hull;
    for (uint32_t i = 0; i < hull->corner_count; i++) {
        const vec3 corner = hull_corner_at(hull, i, from, body);
        at->corner[i] = along(corner, time, sub(hull_corner_at(hull, i, to, body), corner));
    }
    for (uint32_t f = 0; f < hull->face_count; f++) {
        const uint8_t *loop = hull->loop + hull->face[f].first;
        at->normal[f] = unit_of(
            cross(sub(at->corner[loop[1]], at->corner[loop[0]]), sub(at->corner[loop[2]], at->corner[loop[0]])));
    }
}

#endif
