/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Complementarity against its own definition: the matrix is kept whole here, and gaps are summed up from it. Of a convex
 * problem that is proof enough: whatever meets the conditions is an answer, and all answers have the same gaps.
 * Problems have as many dimensions as they are given: fewer than constraints, so that most of these depend on others.
 */
#include "force/complementarity.h"

#include <math.h>

#include "lib/check.h"

enum { DIMENSIONS_MAX = 96 };
#define TOLERANCE 1e-10

struct problem {
    struct complementarity solver;
    uint32_t dimensions;
    double normal[COMPLEMENTARITY_MAX][DIMENSIONS_MAX];
    double free_gap[COMPLEMENTARITY_MAX];
    double matrix[COMPLEMENTARITY_MAX][COMPLEMENTARITY_MAX];
    uint8_t kind[COMPLEMENTARITY_MAX];
    uint32_t asked;                          /* columns */
    double from_inside[COMPLEMENTARITY_MAX]; /* the free gap with which `inside` has no gap */
};

static void give_column(void *user, uint32_t index, uint32_t first, double *column)
{
    struct problem *problem = user;
    problem->asked++;
    for (uint32_t i = first; i < problem->solver.count; i++)
        column[i] = problem->matrix[i][index];
}

/* Draw constraints that the point `inside` meets, and a free point beyond some of them. */
static void draw(struct problem *problem, uint32_t count, uint32_t dimensions, double spread, uint64_t *seed)
{
    double scale[DIMENSIONS_MAX], inside[DIMENSIONS_MAX];
    memset(problem, 0, sizeof *problem);
    problem->solver.count = count;
    problem->dimensions = dimensions;
    problem->solver.tolerance = TOLERANCE;
    problem->solver.free_gap = problem->free_gap;
    problem->solver.column = give_column;
    problem->solver.user = problem;
    for (uint32_t k = 0; k < dimensions; k++) {
        scale[k] = pow(10.0, random_in(seed, -0.5 * spread, 0.5 * spread));
        inside[k] = random_in(seed, -1.0, 1.0) / scale[k];
    }
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t twin = i && random_bits(seed) % 5 == 0 ? (uint32_t)(random_bits(seed) % i) : i;
        double at = 0.0;
        for (uint32_t k = 0; k < dimensions; k++) {
            const int is_sparse = random_bits(seed) % 3 == 0;
            problem->normal[i][k] = twin < i    ? problem->normal[twin][k]
                                    : is_sparse ? 0.0
                                                : scale[k] * random_in(seed, -1.0, 1.0);
            at += problem->normal[i][k] * inside[k];
        }
        problem->from_inside[i] = -at;
        problem->free_gap[i] = random_in(seed, 0.0, 0.5) - at;
        if (twin < i && random_bits(seed) % 2)
            problem->free_gap[i] = problem->free_gap[twin];
    }
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t j = 0; j < count; j++)
            for (uint32_t k = 0; k < dimensions; k++)
                problem->matrix[i][j] += problem->normal[i][k] * problem->normal[j][k];
}

/* Whether the answer meets the conditions, as far as the largest numbers in it are exact. */
static void check_answer(int i, const struct problem *problem)
{
    const struct complementarity *solver = &problem->solver;
    double whole[COMPLEMENTARITY_MAX] = { 0.0 };
    for (uint32_t k = 0; k < solver->active_count; k++) {
        const uint8_t kind = problem->kind[solver->active[k]];
        CHECK(solver->multiplier[k] >= 0.0 || kind == COMPLEMENTARITY_EQUAL, "case %d: a multiplier of %g", i,
              solver->multiplier[k]);
        CHECK(kind != COMPLEMENTARITY_WATCHED, "case %d: a row that is watched pushes", i);
        CHECK(k == 0 || solver->active[k] > solver->active[k - 1], "case %d: not ascending", i);
        whole[solver->active[k]] = solver->multiplier[k];
    }
    for (uint32_t j = 0; j < solver->count; j++) {
        double gap = problem->free_gap[j], size = fabs(gap);
        for (uint32_t m = 0; m < solver->count; m++) {
            gap += problem->matrix[j][m] * whole[m];
            size = fmax(size, fabs(problem->matrix[j][m] * whole[m]));
        }
        CHECK(fabs(gap - solver->gap[j]) <= 1e-9 * size, "case %d: told %g for %g", i, solver->gap[j], gap);
        if (problem->kind[j] == COMPLEMENTARITY_WATCHED)
            continue;
        CHECK(gap >= -TOLERANCE - 1e-9 * size, "case %d: a gap of %g", i, gap);
        CHECK(problem->kind[j] == COMPLEMENTARITY_CONSTRAINT || fabs(gap) <= TOLERANCE + 1e-9 * size,
              "case %d: an equality has a gap of %g", i, gap);
        CHECK(whole[j] == 0.0 || fabs(gap) <= TOLERANCE + 1e-9 * size, "case %d: pushed over %g", i, gap);
    }
}

static void meets_the_conditions(void)
{
    struct problem *problem = malloc(sizeof *problem);
    uint64_t seed = 1;
    uint32_t active = 0, passes = 0;
    for (int i = 0; i < 1500; i++) {
        const uint32_t count = 1 + (uint32_t)(random_bits(&seed) % (i % 10 ? 40 : COMPLEMENTARITY_MAX));
        const uint32_t dimensions = 1 + (uint32_t)(random_bits(&seed) % 40);
        draw(problem, count, dimensions, i % 2 ? 0.0 : 2.0, &seed);
        CHECK(dpti_complementarity_solve(&problem->solver) == COMPLEMENTARITY_SOLVED, "case %d", i);
        CHECK(problem->solver.active_count <= dimensions, "case %d: %u active of %u", i, problem->solver.active_count,
              dimensions);
        check_answer(i, problem);
        active = problem->solver.active_count > active ? problem->solver.active_count : active;
        passes = problem->solver.passes > passes ? problem->solver.passes : passes;
    }
    CHECK(active > 15, "at most %u were active", active);
    CHECK(passes < 8 * active, "%u passes for %u", passes, active);
    free(problem);
}

/* With a unit of work a call, some calls from where the last one ended find the answer; none pulls, and none goes back. */
static void calls_with_little_work_get_there(void)
{
    struct problem *problem = malloc(sizeof *problem);
    uint64_t seed = 8;
    uint32_t most = 0;
    for (int i = 0; i < 300; i++) {
        struct complementarity *solver = &problem->solver;
        uint32_t calls = 0;
        int result = COMPLEMENTARITY_FULL;
        draw(problem, 20 + (uint32_t)(random_bits(&seed) % 60), 4 + (uint32_t)(random_bits(&seed) % 20), 0.0, &seed);
        while (result == COMPLEMENTARITY_FULL && calls++ < 200) {
            struct work work = work_of(1);
            solver->work = &work;
            result = dpti_complementarity_solve(solver);
            CHECK(!work_left(&work) || !solver->passes, "case %d: %u passes for %u units", i, solver->passes,
                  work.done);
            for (uint32_t a = 0; a < solver->active_count; a++)
                CHECK(solver->multiplier[a] >= 0.0 && solver->gap[solver->active[a]] < 1e-9, "case %d: it pulls", i);
        }
        CHECK(result == COMPLEMENTARITY_SOLVED, "case %d: not after %u calls", i, calls);
        check_answer(i, problem);
        most = calls > most ? calls : most;
    }
    CHECK(most > 5, "at most %u calls", most);
    free(problem);
}

/* Some rows are equalities, that the point inside meets, and one is only watched. */
static void equalities_hold(void)
{
    struct problem *problem = malloc(sizeof *problem);
    uint64_t seed = 4;
    uint32_t pulling = 0;
    for (int i = 0; i < 1000; i++) {
        struct complementarity *solver = &problem->solver;
        const uint32_t equal = (uint32_t)(random_bits(&seed) % 5), count = 12 + (uint32_t)(random_bits(&seed) % 40);
        draw(problem, count, 8 + (uint32_t)(random_bits(&seed) % 30), i % 2 ? 0.0 : 2.0, &seed);
        solver->kind = problem->kind;
        for (uint32_t k = count - 1; k > count - 1 - 2 * equal; k -= 2) {
            problem->kind[k] = COMPLEMENTARITY_EQUAL;
            problem->free_gap[k] = problem->from_inside[k];
        }
        problem->kind[count - 2] = COMPLEMENTARITY_WATCHED;
        CHECK(dpti_complementarity_solve(solver) == COMPLEMENTARITY_SOLVED, "case %d", i);
        check_answer(i, problem);
        for (uint32_t k = 0; k < solver->active_count; k++)
            pulling += solver->multiplier[k] < 0.0;
    }
    CHECK(pulling > 300, "%u pulled", pulling);
    free(problem);
}

/* Wherever it begins; from its own answer it adds and drops nothing, and gives the same bits. */
static void begins_anywhere(void)
{
    struct problem *problem = malloc(sizeof *problem);
    struct complementarity *from_nothing = malloc(sizeof *from_nothing);
    uint64_t seed = 2;
    for (int i = 0; i < 500; i++) {
        struct complementarity *solver = &problem->solver;
        draw(problem, 2 + (uint32_t)(random_bits(&seed) % 60), 1 + (uint32_t)(random_bits(&seed) % 30), 1.0, &seed);
        CHECK(dpti_complementarity_solve(solver) == COMPLEMENTARITY_SOLVED, "case %d", i);
        *from_nothing = *solver;
        CHECK(dpti_complementarity_solve(solver) == COMPLEMENTARITY_SOLVED, "case %d", i);
        CHECK(solver->passes == 0 && solver->active_count == from_nothing->active_count, "case %d: %u passes", i,
              solver->passes);
        CHECK(!memcmp(solver->multiplier, from_nothing->multiplier, solver->active_count * sizeof(double)),
              "case %d: other bits", i);
        solver->active_count = (uint32_t)(random_bits(&seed) % COMPLEMENTARITY_ACTIVE_MAX);
        for (uint32_t k = 0; k < solver->active_count; k++)
            solver->active[k] = (uint32_t)(random_bits(&seed) % (solver->count + 3));
        CHECK(dpti_complementarity_solve(solver) == COMPLEMENTARITY_SOLVED, "case %d", i);
        check_answer(i, problem);
        for (uint32_t k = 0; k < solver->count; k++)
            CHECK(fabs(solver->gap[k] - from_nothing->gap[k]) <= 1e-7, "case %d: another gap", i);
    }
    free(from_nothing);
    free(problem);
}

/* Two constraints that exclude each other, among others; and more than there is room for. */
static void says_what_cannot_be(void)
{
    struct problem *problem = malloc(sizeof *problem);
    uint64_t seed = 3;
    for (int i = 0; i < 100; i++) {
        draw(problem, 10, 4, 0.0, &seed);
        const uint32_t a = (uint32_t)(random_bits(&seed) % 5), b = 5 + (uint32_t)(random_bits(&seed) % 5);
        for (uint32_t j = 0; j < 10; j++)
            problem->matrix[b][j] = -problem->matrix[a][j];
        for (uint32_t j = 0; j < 10; j++)
            problem->matrix[j][b] = problem->matrix[b][j];
        problem->matrix[b][b] = problem->matrix[a][a];
        problem->matrix[a][b] = problem->matrix[b][a] = -problem->matrix[a][a];
        problem->free_gap[b] = -problem->free_gap[a] - 0.1;
        CHECK(dpti_complementarity_solve(&problem->solver) == COMPLEMENTARITY_IMPOSSIBLE, "case %d", i);
    }
    memset(problem, 0, sizeof *problem);
    problem->solver = (struct complementarity){ .count = COMPLEMENTARITY_ACTIVE_MAX + 12,
                                                .tolerance = TOLERANCE,
                                                .free_gap = problem->free_gap,
                                                .column = give_column,
                                                .user = problem };
    for (uint32_t k = 0; k < problem->solver.count; k++) {
        problem->matrix[k][k] = 1.0;
        problem->free_gap[k] = -1.0;
    }
    CHECK(dpti_complementarity_solve(&problem->solver) == COMPLEMENTARITY_FULL, "it has room");
    CHECK(problem->solver.active_count == COMPLEMENTARITY_ACTIVE_MAX, "%u", problem->solver.active_count);
    free(problem);
}

static void nothing_gives_nothing(void)
{
    struct complementarity solver = { .count = 0, .active_count = 3 };
    CHECK(dpti_complementarity_solve(&solver) == COMPLEMENTARITY_SOLVED, "not solved");
    CHECK(solver.active_count == 0, "%u", solver.active_count);
}

int main(void)
{
    TEST(meets_the_conditions);
    TEST(calls_with_little_work_get_there);
    TEST(equalities_hold);
    TEST(begins_anywhere);
    TEST(says_what_cannot_be);
    TEST(nothing_gives_nothing);
    return check_report();
}
