/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A segment on its way past one body, within a tick: ends that move along straight lines, a rigid tool and a body that turn
 * along the shortest arc. docs/algorithms/swept_motion.md.
 */
#ifndef DPT_SWEEP_RIGID_H
#define DPT_SWEEP_RIGID_H

#include "base/frame.h"
#include "sweep/sweep_mesh.h"

/* Of the mesh's diagonal: half for the sweep, a quarter for the arcs, which grows the radius, and as much by which they
 * are truly off. */
#define RIGID_SWEEP_TOLERANCE 1e-6

/* A tool and a body at one time. */
struct placement {
    dpt_pose tool, body;
    vec3 a, b; /* in the tool's frame */
};

/* How far a tour has come: up to a time it is free, then comes what `sweep` is of. Zeros: it begins. */
struct rigid_sweep_progress {
    double free_until;
    struct sweep_progress sweep;
};

/* What a tour came to. */
struct rigid_sweep_result {
    struct impact impact;
    struct motion motion; /* in which it was */
    double time;          /* of it, or up to which it is free */
};

struct rigid_sweep {
    const struct surface *surface; /* of the body */
    const struct kernel *kernel;
    double radius;
    double
        distance_before; /* nothing of the body is nearer than that to the axis where the tour begins */
    double tolerance; /* half of what a hit may be off */
    uint32_t hint;
    struct work *work;
    struct rigid_sweep_progress *progress;
    struct rigid_sweep_result result;
};

/* SWEEP_...; after SWEEP_UNFINISHED the same tour between the same moments goes on where it ended. */
int dpti_rigid_sweep_find(struct rigid_sweep *sweep, const struct placement *from,
                          const struct placement *to);

/* Nothing was met: what is nowhere nearer, before and `after`, than half of the way. */
int dpti_rigid_sweep_cannot_meet(const struct rigid_sweep *sweep, const struct placement *from,
                                 const struct placement *to, double distance_after);

/* After a hit: the side of the struck feature on which the point that struck it was when its motion began. */
int dpti_rigid_sweep_side_before(const struct rigid_sweep *sweep);

/*
 * After a hit: the axis touched already when the tour began, and nobody knew. Whether it went through the struck triangle does
 * not tell: one beside that is as near.
 */
int dpti_rigid_sweep_began_touching(const struct rigid_sweep *sweep);

/* Where a tool of such a motion is at a time, 0..1. */
dpt_pose dpti_rigid_sweep_pose(const dpt_pose *from, const dpt_pose *to, double time);

/* No point of the tool was farther away from where it is at last than that, the arc of a turn included. */
double dpti_rigid_sweep_displacement(const struct placement *from, const struct placement *to);

#endif
