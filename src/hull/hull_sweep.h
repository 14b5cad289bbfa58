/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Whether a hull that moves meets a body within a tick, and until when it certainly does not. Hull and body may both
 * move and turn, each along the shortest arc, and the body's vertices in straight lines. Lengths are in m, times in
 * ticks, 0 to 1. docs/algorithms/tips.md.
 */
#ifndef DPT_HULL_SWEEP_H
#define DPT_HULL_SWEEP_H

#include "hull/hull_triangle.h"
#include "sweep/sweep_rigid.h"

/* The hull and body of a motion. Directions, tick and tick_from are those of struct rigid_sweep. */
struct hull_sweep {
    const struct surface *surface;
    const struct kernel *kernel;
    const struct dpt_hull *hull;
    double clearance; /* m, added to the hull's radius, which stays at least 0 */
    double tolerance; /* m, above 0: how near a motion must come to be a hit, at most */
    /*
     * The resolution in time that suffices besides, as a share of the duration of a piece; 0: the tolerance alone
     * counts.
     */
    double resolution;
    uint32_t tick;
    double tick_from;
    const vec3 *directions;
    uint32_t direction_count;
    struct work *work;
    uint32_t triangle; /* place: in, one that is likely to be hit, or DPT_NONE; out, the one that was */
    double time;       /* out: up to which the motion is free; 1 without a hit */
};

/*
 * Sweep from one placement to another; a and b of the placements are ignored. Returns a sweep_status. SWEEP_HIT: the
 * hull may meet the triangle within the tolerance of motion, or the resolution, after `time`. SWEEP_UNFINISHED: the
 * work is spent; the motion is free up to `time`.
 */
int dpti_hull_sweep(struct hull_sweep *sweep, const struct placement *from, const struct placement *to);

/* m: how far any corner was, at any time of a tool's motion in the world, from where it is at its end, at most. */
double dpti_hull_displacement(const struct dpt_hull *hull, const dpt_pose *from, const dpt_pose *to);

#endif
