/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The point nearest to a goal under linear constraints (src/force/half_spaces.h), against the conditions of an optimum, which
 * are necessary and sufficient here: it meets all constraints, the way to it from the goal is a sum of active
 * normals with multipliers that are not negative. That nothing meets them all is judged by a combination of normals that
 * shows it (Farkas), found over all choices of few constraints.
 */
#include <math.h>

#include "force/half_spaces.h"
#include "lib/check.h"

enum { SPACES = 24 };

static double product(const double *a, const double *b, uint32_t n)
{
    double sum = 0;
    for (uint32_t k = 0; k < n; k++)
        sum += a[k] * b[k];
    return sum;
}

/* Random constraints; `scale` 0 gives bounds that a point in the middle meets. */
static uint32_t random_spaces(uint64_t *seed, uint32_t n, double outward, struct half_space *spaces)
{
    const uint32_t count = 1 + (uint32_t)(random_bits(seed) % SPACES);
    for (uint32_t i = 0; i < count; i++) {
        const struct half_space *other = i ? &spaces[random_bits(seed) % i] : NULL;
        const int is_copy = other && random_bits(seed) % 6 == 0;
        for (uint32_t k = 0; k < n; k++) {
            spaces[i].normal[k] = random_in(seed, -1, 1);
            if (is_copy)
                spaces[i].normal[k] = other->normal[k] + random_in(seed, -1e-7, 1e-7);
        }
        const double size = sqrt(product(spaces[i].normal, spaces[i].normal, n));
        for (uint32_t k = 0; k < n; k++)
            spaces[i].normal[k] /= size;
        spaces[i].bound = random_in(seed, -1, outward);
        half_space_measure(&spaces[i], n);
    }
    return count;
}

/* The active constraints hold the answer, which is their sum and `sum`, the goal. */
static void check_active(int i, uint32_t n, const struct half_space *spaces, uint32_t count,
                         const struct half_spaces_result *result, double *sum)
{
    CHECK(result->active_count <= n, "case %d: %u active of %u", i, result->active_count, n);
    for (uint32_t c = 0; c < count; c++)
        CHECK(product(spaces[c].normal, result->y, n) >= spaces[c].bound - 2e-9,
              "case %d: constraint %u is missed by %g", i, c,
              spaces[c].bound - product(spaces[c].normal, result->y, n));
    for (uint32_t a = 0; a < result->active_count; a++) {
        const struct half_space *space = &spaces[result->active[a]];
        CHECK(result->multiplier[a] >= 0, "case %d: a multiplier of %g", i, result->multiplier[a]);
        CHECK(fabs(product(space->normal, result->y, n) - space->bound) < 1e-6,
              "case %d: an active constraint is off by %g", i, product(space->normal, result->y, n) - space->bound);
        for (uint32_t k = 0; k < n; k++)
            sum[k] += result->multiplier[a] * space->normal[k];
    }
    for (uint32_t k = 0; k < n; k++)
        CHECK(fabs(sum[k] - result->y[k]) < 1e-6 * (1 + fabs(sum[k])), "case %d: the sum of normals is off by %g", i,
              sum[k] - result->y[k]);
}

static void answers_are_optimal(void)
{
    uint64_t seed = 1;
    uint32_t solved = 0, held = 0;
    for (int i = 0; i < 200000; i++) {
        const uint32_t n = 1 + (uint32_t)(random_bits(&seed) % HALF_SPACE_DIMENSIONS);
        struct half_space spaces[SPACES];
        struct half_spaces_result result;
        double goal[HALF_SPACE_DIMENSIONS], sum[HALF_SPACE_DIMENSIONS];
        const uint32_t count = random_spaces(&seed, n, i % 2 ? 0.0 : 0.4, spaces);
        for (uint32_t k = 0; k < n; k++)
            sum[k] = goal[k] = random_in(&seed, -3, 3);
        const int is_solved =
            dpti_half_spaces_nearest(&(struct half_space_problem){ spaces, count, n, goal, 1e-9, NULL, 0 }, &result);
        /* With no bound above 0 the origin meets them all. */
        CHECK(is_solved || i % 2 == 0, "case %d: 0 meets all %u, but there is no answer", i, count);
        if (!is_solved)
            continue;
        solved++;
        held += result.active_count > 1;
        check_active(i, n, spaces, count, &result, sum);
    }
    CHECK(solved > 100000 && held > 50000, "%u solved, %u with several active", solved, held);
}

/*
 * With any constraints to try first, also such that depend on each other or do not hold, the answer is the same, as far
 * as normals that differ by 1e-7 tell where they meet.
 */
static void any_beginning_leads_there(void)
{
    uint64_t seed = 3;
    uint32_t solved = 0, other = 0;
    for (int i = 0; i < 100000; i++) {
        const uint32_t n = 1 + (uint32_t)(random_bits(&seed) % HALF_SPACE_DIMENSIONS);
        struct half_space spaces[SPACES];
        struct half_spaces_result cold, warm;
        double goal[HALF_SPACE_DIMENSIONS], sum[HALF_SPACE_DIMENSIONS];
        uint32_t first[HALF_SPACE_DIMENSIONS], first_count = 0;
        const uint32_t count = random_spaces(&seed, n, i % 2 ? 0.0 : 0.4, spaces);
        for (uint32_t k = 0; k < n; k++)
            sum[k] = goal[k] = random_in(&seed, -3, 3);
        for (uint32_t c = (uint32_t)(random_bits(&seed) % 3); c < count && first_count < HALF_SPACE_DIMENSIONS; c += 3)
            first[first_count++] = c;
        const struct half_space_problem problem = { spaces, count, n, goal, 1e-9, first, first_count };
        const struct half_space_problem without = { spaces, count, n, goal, 1e-9, NULL, 0 };
        const int is_solved = dpti_half_spaces_nearest(&without, &cold);
        CHECK(dpti_half_spaces_nearest(&problem, &warm) == is_solved, "case %d: another beginning, %ssolved before", i,
              is_solved ? "" : "not ");
        if (!is_solved)
            continue;
        solved++;
        other += first_count && (!warm.active_count || warm.active[0] != first[0]);
        check_active(i, n, spaces, count, &warm, sum);
        for (uint32_t k = 0; k < n; k++)
            CHECK(fabs(warm.y[k] - cold.y[k]) < 1e-5, "case %d: unknown %u is %g, not %g", i, k, warm.y[k], cold.y[k]);
    }
    CHECK(solved > 50000 && other > 10000, "%u solved, %u of them with a beginning that does not hold", solved, other);
}

/* Where there is no answer, a point may still meet all: looked for by projecting onto the worst one again and again. */
static void no_answer_means_that_there_is_none(void)
{
    uint64_t seed = 2;
    uint32_t refused = 0;
    for (int i = 0; i < 20000; i++) {
        const uint32_t n = 1 + (uint32_t)(random_bits(&seed) % HALF_SPACE_DIMENSIONS);
        struct half_space spaces[SPACES];
        struct half_spaces_result result;
        double x[HALF_SPACE_DIMENSIONS] = { 0 };
        const uint32_t count = random_spaces(&seed, n, 0.6, spaces);
        if (dpti_half_spaces_nearest(&(struct half_space_problem){ spaces, count, n, x, 1e-9, NULL, 0 }, &result))
            continue;
        refused++;
        double worst = 1;
        for (int k = 0; k < 2000 && worst > 1e-4; k++) {
            uint32_t at = 0;
            worst = 0;
            for (uint32_t c = 0; c < count; c++) {
                const double missing = spaces[c].bound - product(spaces[c].normal, x, n);
                if (missing > worst) {
                    worst = missing;
                    at = c;
                }
            }
            for (uint32_t d = 0; d < n; d++)
                x[d] += 1.2 * worst * spaces[at].normal[d];
        }
        CHECK(worst > 1e-5, "case %d: a point meets all within %g", i, worst);
    }
    CHECK(refused > 1000, "only %u without an answer", refused);
}

int main(void)
{
    TEST(answers_are_optimal);
    TEST(any_beginning_leads_there);
    TEST(no_answer_means_that_there_is_none);
    return check_report();
}
