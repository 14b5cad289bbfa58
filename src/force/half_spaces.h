/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The point nearest to a goal under linear constraints: min |y - goal|^2 with normal . y >= bound for each of them, in
 * up to six dimensions. The dual active set method of Goldfarb and Idnani (1983) for the identity matrix; at most
 * as many constraints are active as there are dimensions.
 */
#ifndef DPT_HALF_SPACES_H
#define DPT_HALF_SPACES_H

#include <math.h>
#include <stdint.h>

enum { HALF_SPACE_DIMENSIONS = 6, HALF_SPACES_MAX = 96 };

struct half_space {
    double normal[HALF_SPACE_DIMENSIONS]; /* not zero */
    double bound;
    double per_length; /* 1 / |normal|, from half_space_measure() */
};

/* The answer: `y`, and which constraints hold it, with their multipliers, all above 0. */
struct half_spaces_result {
    double y[HALF_SPACE_DIMENSIONS];
    uint32_t active_count;
    uint32_t active[HALF_SPACE_DIMENSIONS];
    double multiplier[HALF_SPACE_DIMENSIONS]; /* y = goal + sum of multiplier * normal */
};

static inline double product_of(const double *a, const double *b, uint32_t dimensions)
{
    double sum = 0.0;
    for (uint32_t k = 0; k < dimensions; k++)
        sum += a[k] * b[k];
    return sum;
}

static inline double norm_of(const double *a, uint32_t dimensions)
{
    return sqrt(product_of(a, a, dimensions));
}

/* To be called when the normal is set: what lies beyond the dimensions becomes 0. */
static inline void half_space_measure(struct half_space *space, uint32_t dimensions)
{
    for (uint32_t k = dimensions; k < HALF_SPACE_DIMENSIONS; k++)
        space->normal[k] = 0.0;
    space->per_length = 1.0 / norm_of(space->normal, dimensions);
}

/* The same of vectors that are 0 beyond the dimensions in use. */
static inline double whole_product_of(const double a[HALF_SPACE_DIMENSIONS], const double b[HALF_SPACE_DIMENSIONS])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3] + a[4] * b[4] + a[5] * b[5];
}

/* sum += share * more, of vectors that are 0 beyond the dimensions in use. */
static inline void whole_add(double sum[HALF_SPACE_DIMENSIONS], double share, const double more[HALF_SPACE_DIMENSIONS])
{
    for (int k = 0; k < HALF_SPACE_DIMENSIONS; k++)
        sum[k] += share * more[k];
}

/* A problem: the constraints, and the goal. */
struct half_space_problem {
    const struct half_space *spaces;
    uint32_t count, dimensions; /* 1..6 */
    const double *goal;
    double tolerance; /* a constraint that is missed by at most that counts as met */
    /* Which constraints to try first, as they held the last answer; may lie in the result. The answer is the same. */
    const uint32_t *first;
    uint32_t first_count; /* at most HALF_SPACE_DIMENSIONS */
};

/* Returns 0, and no answer, if no point meets all constraints or the iterations do not suffice. */
int dpti_half_spaces_nearest(const struct half_space_problem *problem, struct half_spaces_result *result);

#endif
