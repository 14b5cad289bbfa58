/* SPDX-License-Identifier: BSD-3-Clause */
#include "force/half_spaces.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Each iteration adds or drops one constraint; far fewer are usual. */
enum { ITERATIONS_MAX = 64 };

/* The square of the sine below which a normal depends on the active ones. */
#define DEPENDENCE 1e-10

struct solver {
    const struct half_space *spaces;
    uint32_t count, n;
    uint32_t held_count; /* of the active ones, the first: equations, which never leave */
    struct half_spaces_result *result;
    /* Orthonormal rows q and the upper triangle r with normal[active[k]] = sum over j <= k of r[j][k] q[j]. */
    double q[HALF_SPACE_DIMENSIONS][HALF_SPACE_DIMENSIONS];
    double r[HALF_SPACE_DIMENSIONS][HALF_SPACE_DIMENSIONS];
};

/* Split a normal into its part along the active ones, with coefficients in `along`, and the rest; returns |rest|^2. */
static double split(const struct solver *solver, const double *normal, double *along, double *rest)
{
    const uint32_t n = solver->n, active = solver->result->active_count;
    memcpy(rest, normal, n * sizeof *rest);
    memset(along, 0, active * sizeof *along);
    /* Twice: once more removes what rounding left of nearly dependent normals. */
    for (int pass = 0; pass < 2; pass++)
        for (uint32_t j = 0; j < active; j++) {
            const double part = product_of(solver->q[j], rest, n);
            along[j] += part;
            for (uint32_t k = 0; k < n; k++)
                rest[k] -= part * solver->q[j][k];
        }
    return product_of(rest, rest, n);
}

static void append(struct solver *solver, uint32_t space, const double *along, const double *rest, double square)
{
    const uint32_t at = solver->result->active_count++;
    const double size = sqrt(square);
    solver->result->active[at] = space;
    for (uint32_t j = 0; j < at; j++)
        solver->r[j][at] = along[j];
    solver->r[at][at] = size;
    for (uint32_t k = 0; k < solver->n; k++)
        solver->q[at][k] = rest[k] / size;
}

/* Drop an active constraint, and factor those behind it anew. */
static void drop(struct solver *solver, uint32_t which)
{
    struct half_spaces_result *result = solver->result;
    const uint32_t before = result->active_count;
    result->active_count = which;
    for (uint32_t k = which + 1; k < before; k++) {
        double along[HALF_SPACE_DIMENSIONS], rest[HALF_SPACE_DIMENSIONS];
        const uint32_t space = result->active[k];
        const double square = split(solver, solver->spaces[space].normal, along, rest);
        result->multiplier[result->active_count] = result->multiplier[k];
        append(solver, space, along, rest, square);
    }
}

/* The constraint that is violated most, in proportion to its normal; `count` where all are met. */
static uint32_t most_violated(const struct solver *solver, double tolerance)
{
    uint32_t worst = solver->count;
    double lowest = -tolerance;
    for (uint32_t i = 0; i < solver->count; i++) {
        const struct half_space *space = &solver->spaces[i];
        const double size = norm_of(space->normal, solver->n);
        const double slack = (product_of(space->normal, solver->result->y, solver->n) - space->bound) / size;
        if (slack < lowest) {
            lowest = slack;
            worst = i;
        }
    }
    return worst;
}

/* How the active multipliers change per unit of the new one: R share = along. */
static void shares_of(const struct solver *solver, const double *along, double *share)
{
    for (uint32_t k = solver->result->active_count; k-- > 0;) {
        double left = along[k];
        for (uint32_t j = k + 1; j < solver->result->active_count; j++)
            left -= solver->r[k][j] * share[j];
        share[k] = left / solver->r[k][k];
    }
}

/* Make a violated constraint active, dropping those that it replaces. 0: it cannot be met; *left counts down. */
static int satisfy(struct solver *solver, uint32_t space, int *left)
{
    struct half_spaces_result *result = solver->result;
    const struct half_space *added = &solver->spaces[space];
    const double whole = product_of(added->normal, added->normal, solver->n);
    double multiplier = 0.0;
    for (; *left > 0; --*left) {
        double along[HALF_SPACE_DIMENSIONS], rest[HALF_SPACE_DIMENSIONS];
        double share[HALF_SPACE_DIMENSIONS];
        const double square = split(solver, added->normal, along, rest);
        const int is_dependent = !(square > DEPENDENCE * whole) || result->active_count == solver->n;
        shares_of(solver, along, share);
        double step = DBL_MAX;
        uint32_t leaves = HALF_SPACE_DIMENSIONS;
        for (uint32_t k = solver->held_count; k < result->active_count; k++)
            if (share[k] > 0.0 && result->multiplier[k] / share[k] < step) {
                step = result->multiplier[k] / share[k];
                leaves = k;
            }
        if (is_dependent && leaves == HALF_SPACE_DIMENSIONS)
            return 0;
        const double missing = added->bound - product_of(added->normal, result->y, solver->n);
        const double full = is_dependent ? DBL_MAX : missing / square;
        const int is_full = full <= step;
        step = is_full ? full : step;
        for (uint32_t k = 0; k < solver->n && !is_dependent; k++)
            result->y[k] += step * rest[k];
        for (uint32_t k = 0; k < result->active_count; k++)
            result->multiplier[k] -= step * share[k];
        multiplier += step;
        if (is_full) {
            result->multiplier[result->active_count] = multiplier;
            append(solver, space, along, rest, square);
            return 1;
        }
        drop(solver, leaves);
    }
    return 0;
}

/* An equation holds whatever its multiplier's sign is. One that depends on others is left out. */
static void hold(struct solver *solver, const struct half_space *plane)
{
    struct half_spaces_result *result = solver->result;
    double along[HALF_SPACE_DIMENSIONS], rest[HALF_SPACE_DIMENSIONS], share[HALF_SPACE_DIMENSIONS];
    const uint32_t at = result->active_count;
    const double square = split(solver, plane->normal, along, rest);
    if (at == solver->n || !(square > DEPENDENCE * product_of(plane->normal, plane->normal, solver->n)))
        return;
    const double step = (plane->bound - product_of(plane->normal, result->y, solver->n)) / square;
    shares_of(solver, along, share);
    for (uint32_t k = 0; k < solver->n; k++)
        result->y[k] += step * rest[k];
    for (uint32_t k = 0; k < at; k++)
        result->multiplier[k] -= step * share[k];
    result->multiplier[at] = step;
    append(solver, solver->count, along, rest, square);
    solver->held_count++;
}

/* The equations are no part of the answer but for what they hold. */
static void take_out_held(const struct solver *solver, double *held)
{
    struct half_spaces_result *result = solver->result;
    const uint32_t first = solver->held_count;
    memcpy(held, result->multiplier, first * sizeof *held);
    result->active_count -= first;
    memmove(result->active, result->active + first, result->active_count * sizeof *result->active);
    memmove(result->multiplier, result->multiplier + first, result->active_count * sizeof *result->multiplier);
}

static int satisfy_all(struct solver *solver, double tolerance)
{
    int left = ITERATIONS_MAX;
    for (;;) {
        const uint32_t space = most_violated(solver, tolerance);
        if (space == solver->count)
            return 1;
        if (!satisfy(solver, space, &left))
            return 0;
    }
}

static struct solver solver_of(const struct half_space_problem *problem, struct half_spaces_result *result)
{
    const uint32_t n = problem->dimensions;
    memset(result, 0, sizeof *result);
    memcpy(result->y, problem->goal, n * sizeof *result->y);
    return (struct solver){ .spaces = problem->spaces, .count = problem->count, .n = n, .result = result };
}

int dpti_half_spaces_nearest(const struct half_space_problem *problem, struct half_spaces_result *result)
{
    struct solver solver = solver_of(problem, result);
    return satisfy_all(&solver, problem->tolerance);
}

int dpti_half_spaces_nearest_on(const struct half_space_problem *problem, const struct half_space *planes,
                                uint32_t plane_count, double *held, struct half_spaces_result *result)
{
    struct solver solver = solver_of(problem, result);
    for (uint32_t i = 0; i < plane_count; i++)
        hold(&solver, &planes[i]);
    if (solver.held_count < plane_count || !satisfy_all(&solver, problem->tolerance))
        return 0;
    take_out_held(&solver, held);
    return 1;
}
