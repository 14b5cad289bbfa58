/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A shape and a piece of a surface: the shortest motion that takes the one out of the other. Lengths here are in sizes of
 * the shape, with its centre at the origin and axes as in the world: so the tolerances of libccd are shares of the shape,
 * and coordinates stay small wherever in the world the two are.
 */
#ifndef DPT_CONVEX_PAIR_H
#define DPT_CONVEX_PAIR_H

#include "convex/convex_body.h"

/* A shape where it is. */
struct convex_place {
    const struct convex_body *body;
    struct frame frame; /* of the shape, in the world */
    vec3 centre;        /* in the world, m */
};

/* How far libccd's answers may be off, as a share of the shape's size; docs/algorithms/convex.md has the measurements. */
#define CONVEX_TOLERANCE 1e-4

/*
 * A piece of a surface: the convex hull of some points. Where it has a front, it goes on behind it by CONVEX_BEHIND, so
 * that there is no exit there.
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

/* What libccd said of a shape and a piece, and its check. */
struct convex_said {
    int meets;
    int is_refused;
    vec3 direction;   /* unit: the shape's exit direction */
    double depth;     /* of the motion along it that the planes of both prove */
    double min_depth; /* no exit is shorter than that, by what libccd said; 0 where it says nothing of it */
};

/* What is counted of libccd's answers. */
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

/* How far a motion along the unit vector n must be for a plane across n to part the two; below 0: they are apart. */
double dpti_convex_width(const struct convex_place *place, const struct convex_piece *piece, vec3 n);

/* Ask libccd, by one algorithm that begins along `first`, and check the answer. */
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
