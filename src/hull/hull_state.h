/* SPDX-License-Identifier: BSD-3-Clause */
/* What a hull holds, and where it is: docs/algorithms/tips.md. */
#ifndef DPT_HULL_STATE_H
#define DPT_HULL_STATE_H

#include "base/frame.h"
#include "dynpoint/hull.h"

/* The most edges and faces of a polyhedron with that many corners, by Euler's formula. */
enum {
    HULL_CORNERS_MAX = DPT_HULL_CORNERS_MAX,
    HULL_EDGES_MAX = 3 * HULL_CORNERS_MAX - 6,
    HULL_FACES_MAX = 2 * HULL_CORNERS_MAX - 4,
    HULL_LOOPS_MAX = 2 * HULL_EDGES_MAX
};

/* A face: a convex polygon. Its corners are loop[first] up to, not including, loop[first + count]. */
struct hull_face {
    vec3 normal; /* unit, out of the hull, in its own frame */
    uint32_t first, count;
};

struct dpt_hull {
    uint32_t corner_count, edge_count, face_count;
    uint32_t is_flat;
    double radius;       /* m */
    vec3 axis_a, axis_b; /* all corners lie within `reach` of this segment */
    double reach;
    vec3 corner[HULL_CORNERS_MAX];
    struct hull_face face[HULL_FACES_MAX];
    uint8_t edge[HULL_EDGES_MAX][2];
    /* The face whose loop leads from the edge's first corner to the second one, and that with the way back. */
    uint8_t edge_face[HULL_EDGES_MAX][2];
    uint8_t loop[HULL_LOOPS_MAX]; /* counter-clockwise as seen from outside */
};

/* A hull in the frame of a body. */
struct hull_place {
    const struct dpt_hull *hull;
    vec3 corner[HULL_CORNERS_MAX];
    vec3 normal[HULL_FACES_MAX]; /* of the faces */
    vec3 a, u;                   /* the hull's axis: a + s u */
};

/* The greatest n.x over some points. */
static inline double support_of(const vec3 *points, uint32_t count, vec3 n)
{
    double max = -HUGE_VAL;
    for (uint32_t i = 0; i < count; i++)
        max = max_of(max, dot(n, points[i]));
    return max;
}

/* A corner of a hull whose frame is at `tool`, in the frame of a body that is at `body`. */
static inline vec3 hull_corner_at(const struct dpt_hull *hull, uint32_t corner, const struct frame *tool,
                                  const struct frame *body)
{
    return frame_to_local(body, frame_to_world(tool, hull->corner[corner]));
}

/* The place of a hull whose frame is at `tool`, in the frame of a body that is at `body`; both in the world. */
static inline void hull_place_set(struct hull_place *place, const struct dpt_hull *hull, const struct frame *tool,
                                  const struct frame *body)
{
    place->hull = hull;
    for (uint32_t i = 0; i < hull->corner_count; i++)
        place->corner[i] = hull_corner_at(hull, i, tool, body);
    for (uint32_t i = 0; i < hull->face_count; i++)
        place->normal[i] = frame_turn_back(body, frame_turn(tool, hull->face[i].normal));
    place->a = frame_to_local(body, frame_to_world(tool, hull->axis_a));
    place->u = sub(frame_to_local(body, frame_to_world(tool, hull->axis_b)), place->a);
}

#endif
