/* SPDX-License-Identifier: BSD-3-Clause */
/* Random curved shapes, and how far they reach, by formulas other than the library's. */
#ifndef DPT_TESTS_CONVEX_SHAPES_H
#define DPT_TESTS_CONVEX_SHAPES_H

#include "dynpoint/convex.h"
#include "lib/check.h"
#include "lib/pose.h"

/* A shape, and the memory of its hull. */
struct curved {
    dpt_convex_shape shape;
    double size; /* m: about its greatest extent */
    double corners[3 * DPT_HULL_CORNERS_MAX];
    uint32_t corner_count;
    double hull_radius;
    _Alignas(8) unsigned char block[32768];
};

/* Of a kind, with a bevel if `is_cut`; of a size in m. Its pose is random, its lengths differ by up to ten times. */
void curved_random(struct curved *curved, uint32_t kind, int is_cut, double size, uint64_t *seed);

void random_pose(uint64_t *seed, double reach, dpt_pose *pose);

/* The greatest d.x of the shape in the tool's frame; |d| is 1. */
double curved_reach(const struct curved *curved, const double d[3]);

/* Whether a point of the shape's own frame is in it, or outside by no more than `slack`. */
int curved_holds(const struct curved *curved, const double x[3], double slack);

/* A point inside, in the tool's frame. */
void curved_centre(const struct curved *curved, double centre[3]);

/* n . (triangle - shape), at most: the motion along n after which a plane across n parts them. */
double curved_width(const struct curved *curved, const dpt_pose *tool, const double triangle[9], const double n[3]);

/* The least width over directions with front.n >= 0, or all if front is NULL; sampled, then refined. *n is where. */
double curved_least(const struct curved *curved, const dpt_pose *tool, const double triangle[9], const double *front,
                    int samples, uint64_t *seed, double n[3]);

/*
 * Whether a plane parts the shape, moved by `by`, from a triangle, in as many steps: 1 yes, 0 if none was found. *distance
 * is how far they are apart at most.
 */
int curved_parted(const struct curved *curved, const dpt_pose *tool, const double triangle[9], const double by[3],
                  int steps, double *distance);

#endif
