/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * When a moving axis first touches what stands still (docs/algorithms/sweep.md). Within one tick,
 * time 0 to 1, both ends move linearly in the mesh's frame; the axis carries a radius.
 *
 * No touch is missed: where the true distance is the radius or less at some time, the answer is a
 * time no later. One is invented only near a touch: at the time answered the true distance is at
 * most radius + tolerance. Where that time is not 0 the axis has not gone through: it has been
 * farther than the radius all along. The same arguments give the same bits with every kernel.
 */
#ifndef DPT_SWEEP_TRIANGLE_H
#define DPT_SWEEP_TRIANGLE_H

#include "nearest/segment_triangle.h"

/* The ends at time t are a + t da and b + t db. Equal ends are a point, zero velocities a rest. */
struct motion {
    vec3 a, b;
    vec3 da, db; /* m per tick */
};

enum sweep_status {
    SWEEP_FREE,      /* no touch up to the last time asked for, that included */
    SWEEP_HIT,       /* and the first one is told */
    SWEEP_UNFINISHED /* the work allowed did not suffice: it can be gone on with */
};

/* What is worked out of a motion once. */
struct sweep {
    vec3 a, u, da, du;     /* the axis a + s u, and how that changes */
    vec3 middle_direction; /* unit, along the axis half way; zero for none */
    double radius;
    double hit_limit;    /* as near is a hit: radius + half the tolerance */
    double free_limit;   /* farther is free: radius + what rounding may feign */
    double no_hit_limit; /* farther is no hit: radius + tolerance */
};

/*
 * Coordinates are finite and, like radius and tolerance, at most 1e6 m; `extent` is the largest
 * |coordinate| of what is to be met (dpti_surface_extent). A tolerance below 2^-42 of the radius and the
 * largest coordinate of all, the motion's four end points included, is raised to that: what is left
 * would be rounding. Ends that are known rounded, such as b + db where db was a difference, may be
 * off by an ulp and are not missed either.
 */
void dpti_sweep_begin(struct sweep *sweep, const struct motion *motion, double radius,
                      double tolerance, double extent);

/* The ends' line at a time: the axis *a + s *u. */
void dpti_sweep_axis(const struct sweep *sweep, double time, vec3 *a, vec3 *u);

/*
 * A time, at most 1, up to which nothing can be touched that is at least `distance` from the axis
 * at time 0: it depends on the faster end alone. 1: nothing need be asked.
 */
double dpti_sweep_start(const struct sweep *sweep, double distance);

/*
 * One triangle, of any shape, that is within the extent: the first touch in 0..until, the ends
 * included. On SWEEP_HIT *time is that; it does not depend on `until`. *asked grows by the
 * distances evaluated.
 */
int dpti_sweep_pair(const struct sweep *sweep, const vec3 corner[3], double until, double *time,
                    uint32_t *evaluations);

#endif
