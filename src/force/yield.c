/* SPDX-License-Identifier: BSD-3-Clause */
#include "force/yield.h"

#include <math.h>
#include <string.h>

/* Murty's method flips one constraint at a time, and visits no set twice. */
enum { FLIPS_MAX = 1 << HALF_SPACE_DIMENSIONS };

struct system {
    uint32_t count;
    double matrix[HALF_SPACE_DIMENSIONS][HALF_SPACE_DIMENSIONS]; /* N + diag(c) */
    double right[HALF_SPACE_DIMENSIONS];                         /* N m */
};

/* Solve for the constraints in `held`, the others being 0, by Cholesky. 0: rounding leaves no solution. */
static int solve_held(const struct system *system, const int *held, double *m)
{
    double l[HALF_SPACE_DIMENSIONS][HALF_SPACE_DIMENSIONS];
    uint32_t index[HALF_SPACE_DIMENSIONS], n = 0;
    for (uint32_t i = 0; i < system->count; i++) {
        m[i] = 0.0;
        if (held[i])
            index[n++] = i;
    }
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j <= i; j++) {
            double sum = system->matrix[index[i]][index[j]];
            for (uint32_t k = 0; k < j; k++)
                sum -= l[i][k] * l[j][k];
            if (i == j && !(sum > 0.0))
                return 0;
            l[i][j] = i == j ? sqrt(sum) : sum / l[j][j];
        }
    for (uint32_t i = 0; i < n; i++) {
        double sum = system->right[index[i]];
        for (uint32_t k = 0; k < i; k++)
            sum -= l[i][k] * m[index[k]];
        m[index[i]] = sum / l[i][i];
    }
    for (uint32_t i = n; i-- > 0;) {
        double sum = m[index[i]];
        for (uint32_t k = i + 1; k < n; k++)
            sum -= l[k][i] * m[index[k]];
        m[index[i]] = sum / l[i][i];
    }
    return 1;
}

/* The first constraint that does not fit: one that is held and pulls, or one that is not held and is violated. */
static uint32_t first_misfit(const struct system *system, const int *held, const double *m)
{
    for (uint32_t i = 0; i < system->count; i++) {
        double short_of = system->right[i];
        for (uint32_t j = 0; j < system->count; j++)
            short_of -= system->matrix[i][j] * m[j];
        if (held[i] ? m[i] < 0.0 : short_of > 0.0)
            return i;
    }
    return system->count;
}

/* The multipliers m' of the header: a linear complementarity problem (Murty 1974: least index). */
static int solve(const struct system *system, double *m)
{
    int held[HALF_SPACE_DIMENSIONS];
    for (uint32_t i = 0; i < system->count; i++)
        held[i] = 1;
    for (int flip = 0; flip < FLIPS_MAX; flip++) {
        if (!solve_held(system, held, m))
            return 0;
        const uint32_t misfit = first_misfit(system, held, m);
        if (misfit == system->count)
            return 1;
        held[misfit] = !held[misfit];
    }
    return 0;
}

double dpti_yield(const struct half_space *spaces, const struct half_spaces_result *hard, uint32_t dimensions,
                  const double *compliance, double *share, double *yielded)
{
    struct system system = { .count = hard->active_count };
    double m[HALF_SPACE_DIMENSIONS], stored = 0.0;
    for (uint32_t i = 0; i < system.count; i++)
        for (uint32_t j = 0; j < system.count; j++) {
            const double *a = spaces[hard->active[i]].normal, *b = spaces[hard->active[j]].normal;
            system.matrix[i][j] = product_of(a, b, dimensions);
            system.right[i] += system.matrix[i][j] * hard->multiplier[j];
        }
    for (uint32_t i = 0; i < system.count; i++)
        system.matrix[i][i] += compliance[i];
    if (!solve(&system, m))
        memcpy(m, hard->multiplier, system.count * sizeof *m);
    for (uint32_t i = 0; i < system.count; i++) {
        share[i] = hard->multiplier[i] > 0.0 ? m[i] / hard->multiplier[i] : 1.0;
        stored += 0.5 * compliance[i] * m[i] * m[i];
        for (uint32_t k = 0; k < dimensions; k++)
            yielded[k] += (hard->multiplier[i] - m[i]) * spaces[hard->active[i]].normal[k];
    }
    return stored;
}
