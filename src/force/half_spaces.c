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
    struct half_spaces_result *result;
    /* Orthonormal rows q and the upper triangle r with normal[active[k]] = sum over j <= k of r[j][k] q[j]. */
    double q[HALF_SPACE_DIMENSIONS][HALF_SPACE_DIMENSIONS];
    double r[HALF_SPACE_DIMENSIONS][HALF_SPACE_DIMENSIONS];
};

/* Split a normal into its part along the active ones, with coefficients in `along`, and the rest; returns |rest|^2. */
static double split(const struct solver *solver, const double *normal, double *along, double *rest)
{
    const uint32_t active = solver->result->active_count;
    memcpy(rest, normal, HALF_SPACE_DIMENSIONS * sizeof *rest);
    memset(along, 0, active * sizeof *along);
    /* Twice: once more removes what rounding left of nearly dependent normals. */
    for (int pass = 0; pass < 2; pass++)
        for (uint32_t j = 0; j < active; j++) {
            const double part = whole_product_of(solver->q[j], rest);
            along[j] += part;
            whole_add(rest, -part, solver->q[j]);
        }
    return whole_product_of(rest, rest);
}

static void append(struct solver *solver, uint32_t space, const double *along, const double *rest, double square)
{
    const uint32_t at = solver->result->active_count++;
    const double size = sqrt(square);
    solver->result->active[at] = space;
    for (uint32_t j = 0; j < at; j++)
        solver->r[j][at] = along[j];
    solver->r[at][at] = size;
    for (int k = 0; k < HALF_SPACE_DIMENSIONS; k++)
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
        const double missing = whole_product_of(space->normal, solver->result->y) - space->bound;
        const double slack = missing * space->per_length;
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
    const double whole = whole_product_of(added->normal, added->normal);
    double multiplier = 0.0;
    for (; *left > 0; --*left) {
        double along[HALF_SPACE_DIMENSIONS], rest[HALF_SPACE_DIMENSIONS];
        double share[HALF_SPACE_DIMENSIONS];
        const double square = split(solver, added->normal, along, rest);
        const int is_dependent = !(square > DEPENDENCE * whole) || result->active_count == solver->n;
        shares_of(solver, along, share);
        double step = DBL_MAX;
        uint32_t leaves = HALF_SPACE_DIMENSIONS;
        for (uint32_t k = 0; k < result->active_count; k++)
            if (share[k] > 0.0 && result->multiplier[k] / share[k] < step) {
                step = result->multiplier[k] / share[k];
                leaves = k;
            }
        if (is_dependent && leaves == HALF_SPACE_DIMENSIONS)
            return 0;
        const double missing = added->bound - whole_product_of(added->normal, result->y);
        const double full = is_dependent ? DBL_MAX : missing / square;
        const int is_full = full <= step;
        step = is_full ? full : step;
        if (!is_dependent)
            whole_add(result->y, step, rest);
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

/* Make a constraint hold as an equation, whatever its multiplier is. One that depends on others is left out: 0. */
static int hold(struct solver *solver, uint32_t space)
{
    struct half_spaces_result *result = solver->result;
    const struct half_space *plane = &solver->spaces[space];
    double along[HALF_SPACE_DIMENSIONS], rest[HALF_SPACE_DIMENSIONS], share[HALF_SPACE_DIMENSIONS];
    const uint32_t at = result->active_count;
    const double square = split(solver, plane->normal, along, rest);
    if (at == solver->n || !(square > DEPENDENCE * whole_product_of(plane->normal, plane->normal)))
        return 0;
    const double step = (plane->bound - whole_product_of(plane->normal, result->y)) / square;
    shares_of(solver, along, share);
    whole_add(result->y, step, rest);
    for (uint32_t k = 0; k < at; k++)
        result->multiplier[k] -= step * share[k];
    result->multiplier[at] = step;
    append(solver, space, along, rest, square);
    return 1;
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

/* Which of the active inequalities pulls most; active_count where none does. */
static uint32_t most_pulling(const struct solver *solver)
{
    const struct half_spaces_result *result = solver->result;
    uint32_t worst = result->active_count;
    double lowest = 0.0;
    for (uint32_t k = 0; k < result->active_count; k++)
        if (!(result->multiplier[k] > lowest)) {
            lowest = result->multiplier[k];
            worst = k;
        }
    return worst;
}

/* Of the constraints to try first those that push when they hold together. */
static struct solver begin(const struct half_space_problem *problem, struct half_spaces_result *result)
{
    uint32_t first[HALF_SPACE_DIMENSIONS], count = problem->first_count;
    for (uint32_t i = 0; i < count; i++)
        first[i] = problem->first[i];
    for (;;) {
        struct solver solver = solver_of(problem, result);
        uint32_t kept = 0;
        for (uint32_t i = 0; i < count; i++)
            if (hold(&solver, first[i]))
                first[kept++] = first[i];
        const uint32_t worst = most_pulling(&solver);
        if (worst == result->active_count)
            return solver;
        count = kept - 1;
        for (uint32_t i = worst; i < count; i++)
            first[i] = first[i + 1];
    }
}

int dpti_half_spaces_nearest(const struct half_space_problem *problem, struct half_spaces_result *result)
{
    struct solver solver = begin(problem, result);
    return satisfy_all(&solver, problem->tolerance);
}
