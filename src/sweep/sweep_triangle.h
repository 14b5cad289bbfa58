/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The time at which a moving axis first touches a triangle, which may move too (docs/algorithms/sweep.md). Within one
 * tick, time 0 to 1, the ends of the axis and the triangle's corners move linearly in the mesh's frame. The axis carries
 * a radius. Lengths are in m, times in ticks.
 *
 * No touch is missed: if the true distance is the radius or less at some time, the answer is that time or an earlier
 * one. A touch is reported only near the triangle: at the time of the answer the true distance is at most radius +
 * tolerance. If that time is not 0, the axis has been farther away than the radius at all times before, so it has not
 * gone through. The same arguments give the same bits with every kernel.
 */
#ifndef DPT_SWEEP_TRIANGLE_H
#define DPT_SWEEP_TRIANGLE_H

#include "nearest/segment_triangle.h"

/* A motion, in the mesh's frame: the ends at time t are a + t da and b + t db. Ends may be equal, velocities zero. */
struct motion {
    vec3 a, b;
    vec3 da, db; /* m per tick */
};

enum sweep_status {
    SWEEP_FREE,      /* no touch up to the last time asked for, inclusive */
    SWEEP_HIT,       /* a touch; the answer is the first one */
    SWEEP_UNFINISHED /* the work was spent; a later call can continue */
};

/* A triangle: its corner k is at corner[k] + t shift[k]. is_moving 0: all shifts are 0. */
struct moving_triangle {
    vec3 corner[3];
    vec3 shift[3]; /* m per tick */
    int is_moving;
};

/* As many contacts hold a rigid tool at most. */
enum { SWEEP_DIRECTIONS_MAX = 6 };

/* A motion prepared for sweeping. */
struct sweep {
    vec3 a, u, da, du;     /* the axis a + s u at time 0, and its change per tick */
    vec3 middle_direction; /* unit, along the axis at time 1/2; zero if it has no length then */
    double radius;
    double hit_limit;     /* a pair at this distance or less is a hit: radius + half the tolerance */
    double free_limit;    /* a plane must keep the axis farther away than this: radius + rounding */
    double no_hit_limit;  /* nothing farther than this can be a hit: radius + tolerance */
    double reach[2];      /* m: what bounds of distances allow each end to be beside its line; 0 at first */
    double surface_speed; /* m per tick: no point of a triangle moves faster; 0 at first */
    /* Set with the first directions of a search (struct rigid_sweep); none at first. */
    const vec3 *directions;
    uint32_t direction_count;
};

/*
 * Prepare a motion. Coordinates must be finite and, like radius and tolerance, at most 1e6 m. extent: the largest
 * |coordinate| of the triangles (dpti_surface_extent).
 *
 * A tolerance below 2^-42 of the sum of the radius and the largest coordinate, the motion's four end points included,
 * is raised to that: anything smaller is rounding. Ends that the caller knows rounded may be off by an ulp, such as b +
 * db if db was a difference; touches are not missed for that.
 */
void dpti_sweep_begin(struct sweep *sweep, const struct motion *motion, double radius, double tolerance, double extent);

/* The axis *a + s *u at a time. */
void dpti_sweep_axis(const struct sweep *sweep, double time, vec3 *a, vec3 *u);

/*
 * The time, at most 1, up to which nothing can be touched that is at least `distance` away from the axis at time 0. It
 * follows from the speeds of the faster end and of the surface. 1: no sweep is needed.
 */
double dpti_sweep_start(const struct sweep *sweep, double distance);

/* The triangle at a time, at rest. */
void dpti_moving_triangle_at(const struct moving_triangle *triangle, double time, vec3 corner[3]);

/*
 * The first touch with one triangle, of any shape within the extent, at times 0..until, inclusive. Returns SWEEP_HIT
 * and the time of the touch, which does not depend on `until`, or SWEEP_FREE. *evaluations grows by the number of
 * distances that were evaluated.
 */
int dpti_sweep_triangle(const struct sweep *sweep, const struct moving_triangle *triangle, double until, double *time,
                        uint32_t *evaluations);

/*
 * Whether a motion may touch a triangle at any time 0..1, each point of the axis beside its line by as much as
 * sweep->reach allows. 0 is proven, by planes that stand still; 1 may be wrong.
 */
int dpti_sweep_may_touch_triangle(const struct sweep *sweep, const struct moving_triangle *triangle);

#endif
