/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A convex polyhedron, by its corners, and many triangles: their distance by looking at all of them, and by when a
 * motion brings them together, in the body's frame. Slow and obvious; shares no code with the library.
 *
 * A triangle is passed over only where a plane across the way to the ball around it keeps the two apart, by a margin
 * that is far above rounding. Distances are oracle_hull_triangle's, with its limits.
 *
 * A motion is a tool's and a body's pose, each from one to another: the position on a line, the orientation on the
 * shorter arc by its sine. The triangles may move too, each corner on a line. Of a turn by exactly half a circle the
 * arc is the one that the quaternions' signs say; of one that is near to that by rounding it judges nothing.
 */
#ifndef DPT_TESTS_ORACLE_HULL_SURFACE_H
#define DPT_TESTS_ORACLE_HULL_SURFACE_H

#include "dynpoint/types.h"
#include "oracle/hull.h"
#include "oracle/hull_distance.h"

/* Triangles, 9 numbers each; `shift`: how far their corners go from time 0 to 1, or NULL. */
struct oracle_triangles {
    const double *corners, *shift;
    uint32_t count;
};

/* The distance to the nearest; `nearest`, which may be NULL: its number. Infinity if there is none below `limit`. */
struct oracle_interval oracle_hull_surface(const double *corners, uint32_t count,
                                           const struct oracle_triangles *triangles, double time, double limit,
                                           uint32_t *nearest);

/* Triangle `which` at a time. */
void oracle_triangle_at(const struct oracle_triangles *triangles, uint32_t which, double time, double out[9]);

struct oracle_motion {
    dpt_pose tool_from, tool_to, body_from, body_to;
};

/* Points of the tool's frame, in the body's frame at a time of the motion. */
void oracle_motion_at(const struct oracle_motion *motion, double time, const double *points, uint32_t count,
                      double *out);

/* m per motion: none of these points moves faster in the body's frame, at any time. */
double oracle_motion_speed(const struct oracle_motion *motion, const double *points, uint32_t count);

/*
 * When the hull of the points first comes as near as `within`. Time goes on by no more than the distance that is left
 * over the greatest speed allows, so nothing is passed over.
 *
 *   free_until  nothing is as near as `within` before; 1 if nothing ever is
 *   met_at      a time at which the distance is below within + slack; 2: none was found in `steps` steps
 */
struct oracle_meeting {
    double free_until, met_at;
};

struct oracle_meeting oracle_first_meeting(const struct oracle_motion *motion, const double *points, uint32_t count,
                                           const struct oracle_triangles *triangles, double within, double slack,
                                           uint32_t steps);

#endif
