/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The first touch of a segment of a tool and one body within a tick. Tool and body may both move and turn, each along
 * the shortest arc; the segment's ends may also move in the tool's frame, and the body's vertices in the body's, along
 * straight lines. Lengths are in m, times
 * in ticks, 0 to 1. docs/algorithms/swept_motion.md.
 */
#ifndef DPT_SWEEP_RIGID_H
#define DPT_SWEEP_RIGID_H

#include "base/frame.h"
#include "sweep/sweep_mesh.h"

/*
 * The tolerance of a hit, as a part of the mesh's diagonal. Half of it is for the sweep. A quarter is for the deviation
 * of arcs from straight lines, which is added to the radius; the last quarter is the deviation itself.
 */
#define RIGID_SWEEP_TOLERANCE 1e-6

/* Where a segment of a tool and a body are at one time. */
struct placement {
    dpt_pose tool, body; /* in the world */
    vec3 a, b;           /* the segment's ends in the tool's frame */
};

/* How far a rigid sweep has come; rigid_sweep_restart begins. */
struct rigid_sweep_progress {
    double free_until;           /* no touch up to this time */
    struct sweep_progress sweep; /* of the piece that begins there, or of its test */
    uint32_t tested;             /* pieces that begin there and may touch: how many, each half of the last */
    uint32_t leaves;             /* 1 and the leaf that may be touched; 0: none is known */
};

static inline void rigid_sweep_restart(struct rigid_sweep_progress *progress)
{
    progress->free_until = 0.0;
    progress->sweep.has_begun = 0;
    progress->tested = progress->leaves = 0;
}

/* The result of a rigid sweep. */
struct rigid_sweep_result {
    struct impact impact; /* the hit; its time is that within `motion` */
    struct motion motion; /* the straight motion of the impact, in the body's frame */
    double time;          /* of the hit; without a hit, the time up to which the motion is free */
    double from;          /* when the straight motion begins */
};

struct rigid_sweep {
    const struct surface *surface; /* the body's */
    const struct kernel *kernel;
    double radius; /* the segment's */
    /* A lower bound of the distance from the axis to the body when the motion begins; 0: unknown, or touching. */
    double distance_before;
    double tolerance; /* half of the error that a hit may have */
    uint32_t hint;    /* a triangle that is likely to be hit, by its place, or DPT_NONE */
    uint32_t tick;    /* of the world: the vertices move before it; 0: they are at rest */
    double tick_from; /* the sweep begins at that time of the vertices' motion, and ends with it */
    /*
     * Unit vectors in the body's frame, from the tool towards the surface: planes across them are tried before others,
     * where vertices are at rest. Those of its contacts rule out most of what a tool slides along. They save work and
     * change nothing else. At most SWEEP_DIRECTIONS_MAX; NULL and 0: none.
     */
    const vec3 *directions;
    uint32_t direction_count;
    struct work *work;
    struct rigid_sweep_progress *progress;
    struct rigid_sweep_result result;
};

/*
 * Find the first touch of a motion between two placements, into sweep->result. Returns a sweep_status. After
 * SWEEP_UNFINISHED, another call with the same arguments continues.
 */
int dpti_rigid_sweep_find(struct rigid_sweep *sweep, const struct placement *from, const struct placement *to);

/*
 * 1 if the motion cannot have touched the body: nothing moves, or distance_before and distance_after, lower bounds of
 * the distance at the two placements, add up to more than the ends move and twice the radius.
 */
int dpti_rigid_sweep_cannot_meet(const struct rigid_sweep *sweep, const struct placement *from,
                                 const struct placement *to, double distance_after);

/*
 * After a hit: the side, +1 or -1, of the surface on which the touching point of the axis was when the straight motion
 * of the impact began.
 */
int dpti_rigid_sweep_side_before(const struct rigid_sweep *sweep);

/*
 * After a hit: 1 if the axis may have touched the body already when the motion began, as far as distance_before tells.
 * Whether the axis crosses the triangle that was hit does not decide it: a triangle beside that one is as near.
 */
int dpti_rigid_sweep_began_touching(const struct rigid_sweep *sweep);

/* The pose of a tool or body at a time of such a motion. */
dpt_pose dpti_rigid_sweep_pose(const dpt_pose *from, const dpt_pose *to, double time);

/*
 * An upper bound, in m, of how far any point of the segment was, at any time of the motion, from where it is at its
 * end. The arc of a turn is included.
 */
double dpti_rigid_sweep_displacement(const struct placement *from, const struct placement *to);

#endif
