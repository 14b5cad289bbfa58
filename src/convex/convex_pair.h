/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A shape and a piece of a surface: the shortest motion that takes the one out of the other. The unit of length is the
 * size of the shape; its centre is the origin, and axes are those of the world. So the tolerances of libccd are
 * relative to the shape, and coordinates stay small.
 */
#ifndef DPT_CONVEX_PAIR_H
#define DPT_CONVEX_PAIR_H

#include "convex/convex_body.h"

/* A shape and its pose. */
struct convex_place {
    const struct convex_body *body;
    struct frame frame; /* of the shape, in the world */
    vec3 centre;        /* in the world, m */
};

/* How far libccd's answers may be off, as a share of the shape's size; docs/algorithms/convex.md has the measurements. */
#define CONVEX_TOLERANCE 1e-4

/*
 * A piece of a surface: the convex hull of some points. A piece with a front is extended behind it by CONVEX_BEHIND, so
 * that no exit leads there.
 */
struct convex_piece {
    const vec3 *points;
    uint32_t count;
    int has_front;
    vec3 front; /* unit */
};

#define CONVEX_BEHIND 8.0

/* Algorithms of libccd. */
enum { CONVEX_EPA = 0, CONVEX_MPR = 1 };

/* libccd's answer for a shape and a piece, with the check of it. */
struct convex_said {
    int meets;
    int is_refused;
    vec3 direction;   /* unit: the shape's exit direction */
    double depth;     /* of the motion along it, proven by supporting planes of both */
    double min_depth; /* by libccd, no exit is shorter; 0: not known */
};

/* Counts of libccd's answers. */
struct convex_tally {
    uint32_t asked, refused;
};

/* A motion that takes the shape out of a piece. */
struct convex_exit {
    vec3 direction;
    double depth;
    double error;
    int is_own;
};

vec3 dpti_convex_place_support(const struct convex_place *place, vec3 d);

/*
 * The length of the motion along the unit vector n after which a plane across n separates the two; below 0: they are
 * apart.
 */
double dpti_convex_width(const struct convex_place *place, const struct convex_piece *piece, vec3 n);

/* Run one algorithm of libccd, starting along `first`, and check its answer. */
void dpti_convex_ask(const struct convex_place *place, const struct convex_piece *piece, int algorithm, vec3 first,
                     struct convex_said *said);

/*
 * Whether a triangle, a piece without a front, meets the shape; `towards` is a first guess at the exit direction. A
 * plane between the two, or differences around the origin, prove it; where rounding leaves it open, libccd is asked.
 */
int dpti_convex_meets(const struct convex_place *place, const struct convex_piece *piece, vec3 towards,
                      struct convex_tally *tally);

/* The shortest exit out of a piece with a front that is met; `towards` as above. */
void dpti_convex_exit(const struct convex_place *place, const struct convex_piece *piece, vec3 towards,
                      struct convex_tally *tally, struct convex_exit *found);

#endif
