/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Surfaces that yield (src/force/friction.h), against a slow descent on the energy itself:
 *     |y - goal|^2 / 2 + sum of max(0, bound - normal . y)^2 / (2 compliance)
 * with the bounds at which the hard answer is held. It cannot judge compliances of 0; there the hard answer is compared.
 */
#include <math.h>

#include "force/yield.h"
#include "lib/check.h"

enum { SPACES = 8, DESCENTS = 40000 };

static double product(const double *a, const double *b, uint32_t n)
{
    double sum = 0;
    for (uint32_t k = 0; k < n; k++)
        sum += a[k] * b[k];
    return sum;
}

/* By the gradient, with a step that is short enough for the stiffest. Returns the energy of the surfaces. */
static double descend(const struct half_space *spaces, const struct half_spaces_result *hard, uint32_t n,
                      const double *goal, const double *compliance, double *y)
{
    double stiffest = 1, stored = 0;
    for (uint32_t i = 0; i < hard->active_count; i++)
        stiffest += 1 / compliance[i];
    for (uint32_t k = 0; k < n; k++)
        y[k] = goal[k];
    for (int t = 0; t < DESCENTS; t++) {
        double slope[HALF_SPACE_DIMENSIONS];
        stored = 0;
        for (uint32_t k = 0; k < n; k++)
            slope[k] = y[k] - goal[k];
        for (uint32_t i = 0; i < hard->active_count; i++) {
            const struct half_space *space = &spaces[hard->active[i]];
            const double deep = fmax(0, product(space->normal, hard->y, n) - product(space->normal, y, n));
            stored += 0.5 * deep * deep / compliance[i];
            for (uint32_t k = 0; k < n; k++)
                slope[k] -= deep / compliance[i] * space->normal[k];
        }
        for (uint32_t k = 0; k < n; k++)
            y[k] -= slope[k] / stiffest;
    }
    return stored;
}

static void random_case(uint64_t *seed, uint32_t n, struct half_space *spaces, double *goal)
{
    for (uint32_t i = 0; i < SPACES; i++) {
        for (uint32_t k = 0; k < n; k++)
            spaces[i].normal[k] = random_in(seed, -1, 1);
        const double size = sqrt(product(spaces[i].normal, spaces[i].normal, n));
        for (uint32_t k = 0; k < n; k++)
            spaces[i].normal[k] /= size;
        spaces[i].bound = random_in(seed, -0.5, 0);
        half_space_measure(&spaces[i], n);
    }
    for (uint32_t k = 0; k < n; k++)
        goal[k] = random_in(seed, -3, 3);
}

static void the_energy_is_least(void)
{
    uint64_t seed = 5;
    uint32_t released = 0, several = 0;
    for (int i = 0; i < 400; i++) {
        const uint32_t n = 3 + (uint32_t)(random_bits(&seed) % 4);
        struct half_space spaces[SPACES];
        struct half_spaces_result hard;
        double goal[HALF_SPACE_DIMENSIONS], y[HALF_SPACE_DIMENSIONS];
        double compliance[HALF_SPACE_DIMENSIONS], share[HALF_SPACE_DIMENSIONS];
        double yielded[HALF_SPACE_DIMENSIONS] = { 0 };
        random_case(&seed, n, spaces, goal);
        if (!dpti_half_spaces_nearest(&(struct half_space_problem){ spaces, SPACES, n, goal, 1e-9, NULL, 0 }, &hard) ||
            !hard.active_count)
            continue;
        for (uint32_t k = 0; k < hard.active_count; k++)
            compliance[k] = random_in(&seed, 0.05, 4);
        const double least = descend(spaces, &hard, n, goal, compliance, y);
        const double stored = dpti_yield(spaces, &hard, n, compliance, share, yielded);
        several += hard.active_count > 2;
        for (uint32_t k = 0; k < hard.active_count; k++)
            released += share[k] == 0.0;
        CHECK(fabs(stored - least) < 1e-6 * (1 + least), "case %d: %g stored, %g by descent", i, stored, least);
        for (uint32_t k = 0; k < n; k++)
            CHECK(fabs(hard.y[k] - yielded[k] - y[k]) < 1e-5, "case %d: unknown %u is %g, not %g", i, k,
                  hard.y[k] - yielded[k], y[k]);
    }
    CHECK(several > 50 && released > 5, "%u cases of several, %u released", several, released);
}

static void what_is_hard_does_not_yield(void)
{
    uint64_t seed = 6;
    for (int i = 0; i < 1000; i++) {
        struct half_space spaces[SPACES];
        struct half_spaces_result hard;
        const double none[HALF_SPACE_DIMENSIONS] = { 0 };
        double goal[HALF_SPACE_DIMENSIONS], share[HALF_SPACE_DIMENSIONS];
        double yielded[HALF_SPACE_DIMENSIONS] = { 0 };
        random_case(&seed, 6, spaces, goal);
        if (!dpti_half_spaces_nearest(&(struct half_space_problem){ spaces, SPACES, 6, goal, 1e-9, NULL, 0 }, &hard))
            continue;
        const double stored = dpti_yield(spaces, &hard, 6, none, share, yielded);
        CHECK(stored == 0.0 && product(yielded, yielded, 6) < 1e-12, "case %d: %g stored", i, stored);
        for (uint32_t k = 0; k < hard.active_count; k++)
            CHECK(fabs(share[k] - 1) * hard.multiplier[k] < 1e-6, "case %d: %g of a multiplier", i, share[k]);
    }
}

int main(void)
{
    TEST(the_energy_is_least);
    TEST(what_is_hard_does_not_yield);
    return check_report();
}
