/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A hand slides a tool over a mesh. A point wanders over the surface. The tool is roughly tangent and follows the point with
 * some part of its length, a little above or below the surface. Or it stands on its tip, end a, and comes down from above
 * first. The tool moves in every tick. Only arithmetic is used, so a seed gives the same bits on every machine.
 */
#ifndef DPT_TOOLS_TRACE_HAND_H
#define DPT_TOOLS_TRACE_HAND_H

#include "base/vec3.h"
#include "dynpoint/mesh.h"

struct trace_hand {
    const dpt_mesh *mesh;
    uint64_t random;
    double length, band, speed;
    vec3 at, normal; /* the point on the surface, in the mesh's frame, and the smoothed normal */
    vec3 heading;    /* direction in which the point wanders */
    vec3 axis;       /* direction of the tool */
    vec3 up;         /* and of one that stands */
    double phase[4]; /* of the slow changes, in turns */
    uint64_t ticks;  /* so far */
    int stands;      /* on its tip; set it after trace_hand_begin */
};

/*
 * Begin.
 *   length   of the tool, m; 0: 0.3 m for a mesh with a diagonal of 0.35 m, scaled with it
 *   band     how far above and below the surface it is held, m; 0: 0.005, scaled
 *   speed    mean speed over the surface, m/s; 0: 0.3, scaled
 */
void trace_hand_begin(struct trace_hand *hand, const dpt_mesh *mesh, uint64_t seed, double length, double band,
                      double speed);

/* The tool's ends in the next tick of 1 ms, in the mesh's frame: ax, ay, az, bx, by, bz. */
void trace_hand_move(struct trace_hand *hand, double ends[6]);

#endif
