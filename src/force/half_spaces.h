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

/* A problem: the constraints, and the goal. */
struct half_space_problem {
    const struct half_space *spaces;
    uint32_t count, dimensions; /* 1..6 */
    const double *goal;
    double tolerance; /* a constraint that is missed by at most that counts as met */
};

/* Returns 0, and no answer, if no point meets all constraints or the iterations do not suffice. */
int dpti_half_spaces_nearest(const struct half_space_problem *problem, struct half_spaces_result *result);

/*
 * The same on planes: normal . y = bound for each of them, at most `dimensions`, and y = goal + sum of multiplier *
 * normal + sum of held * normal of its plane; `held` may have any sign. Returns 0, too, if one plane depends on others.
 */
int dpti_half_spaces_nearest_on(const struct half_space_problem *problem, const struct half_space *planes,
                                uint32_t plane_count, double *held, struct half_spaces_result *result);

#endif
