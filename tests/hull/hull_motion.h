/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A hull and a body that both move, swept by the library and judged by the oracle. What is asked:
 *
 *   - Before the time that the sweep tells, nothing is as near as the hull's radius. The oracle looks at times all over
 *     that stretch, and from where the two first come near, at steps that grow from next to nothing.
 *   - Where it says HIT, the triangle is no farther away at that time than the radius and twice the tolerance: one for
 *     the motion that follows, and one for what holds the paths. With a resolution, it may be farther by what hull and
 *     vertices go in that share of the time.
 *
 * `noise`: m, rounding of poses and of distances, that either may be off by.
 */
#ifndef DPT_TESTS_HULL_MOTION_H
#define DPT_TESTS_HULL_MOTION_H

#include "hull/hull_body.h"
#include "hull/hull_sweep.h"

struct hull_throw {
    const struct surface *surface;
    const struct kernel *kernel;
    const struct oracle_triangles *triangles;
    const struct made_hull *made;
    struct oracle_motion motion;
    double clearance, tolerance, resolution, noise;
    uint32_t tick; /* of a body whose vertices move; `triangles` are those from tick_from on */
    double tick_from;
    /* The answer. */
    int status;
    double time;
    uint32_t triangle;
    uint32_t work;
};

struct throw_tally {
    unsigned long throws, hits, at_once, near_misses, unfinished;
    double worst; /* of a hit: how far its triangle was beyond the radius, in tolerances */
    double work;
};

/* m: the hull's radius and the clearance. */
double throw_radius(const struct hull_throw *thrown);

/* The distance at a time: of one triangle, or with DPT_NONE of all. */
struct oracle_interval throw_distance(const struct hull_throw *thrown, double time, uint32_t triangle, double limit);

/* Sweep, with a random hint and random directions, and as much work as that. */
void throw_sweep(uint64_t *random, struct hull_throw *thrown, uint32_t work);

/* Sweep with any work, and with little, and judge what it says. */
void check_throw(uint64_t *random, struct hull_throw *thrown, struct throw_tally *tally);

void print_throws(const char *name, const struct throw_tally *tally);

/* So that the tool is at `at` in the body's frame when that is at `body`. */
dpt_pose pose_in(const dpt_pose *body, const dpt_pose *at);

#endif
