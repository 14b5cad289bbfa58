/* SPDX-License-Identifier: BSD-3-Clause */
#include "force/complementarity.h"

#include <math.h>
#include <string.h>

#include "base/lanes.h"
#include "dynpoint/types.h"

/* A constraint of which no more than this share is independent of the active ones depends on them. */
#define DEPENDENT 1e-12

/* How often constraints may be added or dropped, by count of constraints: rounding could make the method go round. */
enum { PASSES = 8 };

/* A constraint that is about to be added. */
struct candidate {
    uint32_t index;
    const double *column;
    double row[COMPLEMENTARITY_ACTIVE_MAX];   /* its row of the factor */
    double share[COMPLEMENTARITY_ACTIVE_MAX]; /* how the active multipliers fall as its own grows */
    double independent;                       /* of its own product, what the active ones leave */
};

static uint32_t kind_of(const struct complementarity *problem, uint32_t index)
{
    return problem->kind ? problem->kind[index] : (uint32_t)COMPLEMENTARITY_CONSTRAINT;
}

/* Whether the multiplier of an active row may not be negative. */
static int only_pushes(const struct complementarity *problem, uint32_t k)
{
    return kind_of(problem, problem->active[k]) == COMPLEMENTARITY_CONSTRAINT;
}

static const double *column_of(const struct complementarity *problem, uint32_t k)
{
    return problem->columns[problem->place[k]];
}

/* Make the row of a constraint that comes after the first `count` active ones. Returns what is left for its diagonal. */
static double make_row(const struct complementarity *problem, uint32_t count, uint32_t index, double own,
                       double *restrict row)
{
    for (uint32_t j = 0; j < count; j++)
        row[j] = column_of(problem, j)[index];
    for (uint32_t j = 0; j < count; j++) {
        const double *restrict factor = problem->factor[j];
        const double value = row[j] / factor[j];
        row[j] = value;
        own -= value * value;
        for (uint32_t m = j + 1; m < count; m++)
            row[m] -= value * factor[m];
    }
    return own;
}

/* A row comes after the first `count` ones of the factor. */
static void put_row(struct complementarity *problem, uint32_t count, uint32_t index, const double *row, double left)
{
    for (uint32_t m = 0; m < count; m++)
        problem->factor[m][count] = row[m];
    problem->factor[count][count] = sqrt(left);
    problem->factored[count] = index;
    problem->factored_count = count + 1;
}

/* x in factor^T x = b, in place. */
static void solve_upper(const struct complementarity *problem, double *x)
{
    for (uint32_t j = problem->active_count; j-- > 0;) {
        const double *factor = problem->factor[j];
        double sum[4] = { x[j], 0.0, 0.0, 0.0 };
        for (uint32_t m = j + 1; m < problem->active_count; m++)
            sum[(m - j) % 4] -= factor[m] * x[m];
        x[j] = ((sum[0] + sum[1]) + (sum[2] + sum[3])) / factor[j];
    }
}

static void swap_places(struct complementarity *problem, uint32_t k, uint32_t other)
{
    const uint32_t place = problem->place[k];
    problem->place[k] = problem->place[other];
    problem->place[other] = place;
}

/* The column of a row, in the place of position k or a later one, which comes to k. */
static const double *column_at(struct complementarity *problem, uint32_t k, uint32_t index)
{
    for (uint32_t other = k; other < problem->places; other++)
        if (problem->owner[problem->place[other]] == index) {
            swap_places(problem, k, other);
            break;
        }
    const uint32_t place = problem->place[k];
    if (problem->owner[place] != index) {
        problem->owner[place] = index;
        problem->filled[place] = 0;
        problem->places = k < problem->places ? problem->places : k + 1;
    }
    if (problem->filled[place] < problem->count)
        problem->column(problem->user, index, problem->filled[place], problem->columns[place]);
    problem->filled[place] = problem->count;
    return problem->columns[place];
}

/* Make the factor again where it is not that of the active rows. Returns 0 if one depends on those before it: which. */
static int factor_active(struct complementarity *problem, uint32_t *which)
{
    double row[COMPLEMENTARITY_ACTIVE_MAX];
    uint32_t k = 0;
    while (k < problem->active_count && k < problem->factored_count && problem->factored[k] == problem->active[k])
        k++;
    for (; k < problem->active_count; k++) {
        const double own = column_of(problem, k)[problem->active[k]];
        problem->factored_count = *which = k;
        const double left = make_row(problem, k, problem->active[k], own, row);
        if (!(left > DEPENDENT * own))
            return 0;
        put_row(problem, k, problem->active[k], row, left);
    }
    return 1;
}

static void remove_active(struct complementarity *problem, uint32_t k)
{
    const uint32_t place = problem->place[k], last = --problem->active_count;
    for (; k < last; k++) {
        problem->active[k] = problem->active[k + 1];
        problem->multiplier[k] = problem->multiplier[k + 1];
        problem->place[k] = problem->place[k + 1];
    }
    problem->place[last] = place;
}

static void drop(struct complementarity *problem, uint32_t k)
{
    uint32_t which;
    remove_active(problem, k);
    problem->passes++;
    /* What was independent of more is independent of fewer, but for rounding. */
    while (!factor_active(problem, &which))
        remove_active(problem, which);
}

/* The multipliers for which the active constraints have no gap. */
static void solve_active(struct complementarity *problem)
{
    double *restrict x = problem->multiplier;
    for (uint32_t k = 0; k < problem->active_count; k++)
        x[k] = -problem->free_gap[problem->active[k]];
    for (uint32_t m = 0; m < problem->active_count; m++) {
        const double *restrict factor = problem->factor[m];
        x[m] /= factor[m];
        for (uint32_t k = m + 1; k < problem->active_count; k++)
            x[k] -= factor[k] * x[m];
    }
    solve_upper(problem, x);
}

static void find_gaps(struct complementarity *problem)
{
    memcpy(problem->gap, problem->free_gap, problem->count * sizeof *problem->gap);
    for (uint32_t k = 0; k < problem->active_count; k++) {
        const double *column = column_of(problem, k), multiplier = problem->multiplier[k];
        for (uint32_t i = 0; i < problem->count; i++)
            problem->gap[i] += multiplier * column[i];
    }
}

/* A row that no active one makes superfluous becomes active. Returns 0 if there is no room. */
static int begin_with(struct complementarity *problem, uint32_t index)
{
    uint32_t which;
    const uint32_t last = problem->active_count;
    if (last == COMPLEMENTARITY_ACTIVE_MAX)
        return 0;
    column_at(problem, last, index);
    problem->active[problem->active_count++] = index;
    if (!factor_active(problem, &which))
        problem->active_count = last;
    return 1;
}

static void begin_matrix(struct complementarity *problem)
{
    if (problem->matrix && problem->matrix == problem->known_matrix)
        return;
    problem->known_matrix = problem->matrix;
    problem->factored_count = problem->places = 0;
    for (uint32_t k = 0; k < COMPLEMENTARITY_ACTIVE_MAX; k++) {
        problem->place[k] = k;
        problem->owner[k] = DPT_NONE;
    }
}

/* The active constraint of the least multiplier, DPT_NONE if none would pull. */
static uint32_t first_pulling(const struct complementarity *problem)
{
    uint32_t least = DPT_NONE;
    for (uint32_t k = 0; k < problem->active_count; k++)
        if (only_pushes(problem, k) && problem->multiplier[k] < 0.0 &&
            (least == DPT_NONE || problem->multiplier[k] < problem->multiplier[least]))
            least = k;
    return least;
}

/* From the active constraints that are given, and the equalities: without those that depend on others, or would pull. */
static int begin(struct complementarity *problem)
{
    uint32_t given[COMPLEMENTARITY_ACTIVE_MAX], pulling;
    const uint32_t given_count = problem->active_count;
    int has_room = 1;
    memcpy(given, problem->active, given_count * sizeof *given);
    problem->active_count = problem->passes = 0;
    begin_matrix(problem);
    for (uint32_t k = 0; k < given_count; k++)
        if (given[k] < problem->count && kind_of(problem, given[k]) == COMPLEMENTARITY_CONSTRAINT)
            begin_with(problem, given[k]);
    for (uint32_t i = 0; problem->kind && i < problem->count; i++)
        if (problem->kind[i] == COMPLEMENTARITY_EQUAL)
            has_room &= begin_with(problem, i);
    solve_active(problem);
    while ((pulling = first_pulling(problem)) != DPT_NONE) {
        drop(problem, pulling);
        solve_active(problem);
    }
    find_gaps(problem);
    return has_room ? COMPLEMENTARITY_SOLVED : COMPLEMENTARITY_FULL;
}

static void measure(const struct complementarity *problem, struct candidate *candidate)
{
    const double own = candidate->column[candidate->index];
    candidate->independent = make_row(problem, problem->active_count, candidate->index, own, candidate->row);
    if (!(candidate->independent > DEPENDENT * own))
        candidate->independent = 0.0;
    memcpy(candidate->share, candidate->row, problem->active_count * sizeof *candidate->share);
    solve_upper(problem, candidate->share);
}

/* The first active multiplier that would become 0, and at which multiplier of the candidate. */
static double first_released(const struct complementarity *problem, const struct candidate *candidate, uint32_t *which)
{
    double least = HUGE_VAL;
    for (uint32_t k = 0; k < problem->active_count; k++)
        if (only_pushes(problem, k) && candidate->share[k] > 0.0 &&
            problem->multiplier[k] < least * candidate->share[k]) {
            least = problem->multiplier[k] / candidate->share[k];
            *which = k;
        }
    return least;
}

static void grow(struct complementarity *problem, const struct candidate *candidate, double by)
{
    for (uint32_t i = 0; i < problem->count; i++)
        problem->gap[i] += by * candidate->column[i];
    /* Of all rows with each active column, and of the factor's half, twice. */
    if (problem->work)
        work_spend(problem->work, (problem->active_count + 1) * (problem->count + problem->active_count) / LANES + 1);
    for (uint32_t k = 0; k < problem->active_count; k++) {
        const double *column = column_of(problem, k), less = by * candidate->share[k];
        problem->multiplier[k] -= less;
        for (uint32_t i = 0; i < problem->count; i++)
            problem->gap[i] -= less * column[i];
    }
}

static void append(struct complementarity *problem, const struct candidate *candidate, double multiplier)
{
    const uint32_t last = problem->active_count++;
    column_at(problem, last, candidate->index);
    problem->active[last] = candidate->index;
    problem->multiplier[last] = multiplier;
    put_row(problem, last, candidate->index, candidate->row, candidate->independent);
    problem->passes++;
}

/* Make a constraint active, and drop those that it releases. */
static int add(struct complementarity *problem, uint32_t index)
{
    struct candidate candidate = { .index = index };
    double multiplier = 0.0;
    if (problem->active_count == COMPLEMENTARITY_ACTIVE_MAX)
        return COMPLEMENTARITY_FULL;
    candidate.column = column_at(problem, problem->active_count, index);
    for (;;) {
        uint32_t released = 0;
        measure(problem, &candidate);
        const double until_released = first_released(problem, &candidate, &released);
        const double until_met = candidate.independent > 0.0 ? -problem->gap[index] / candidate.independent : HUGE_VAL;
        const double by = until_released < until_met ? until_released : until_met;
        if (by == HUGE_VAL)
            return COMPLEMENTARITY_IMPOSSIBLE;
        grow(problem, &candidate, by);
        multiplier += by;
        if (until_met <= until_released) {
            append(problem, &candidate, multiplier);
            return COMPLEMENTARITY_SOLVED;
        }
        drop(problem, released);
    }
}

/* The constraint that is missed by the most; DPT_NONE if all are met. */
static uint32_t most_missed(const struct complementarity *problem)
{
    uint32_t least = DPT_NONE;
    for (uint32_t i = 0; i < problem->count; i++)
        if (problem->gap[i] < -problem->tolerance && kind_of(problem, i) == COMPLEMENTARITY_CONSTRAINT &&
            (least == DPT_NONE || problem->gap[i] < problem->gap[least]))
            least = i;
    return least;
}

/* In ascending order, so that the answer's bits depend on the active constraints alone. */
static void finish(struct complementarity *problem)
{
    uint32_t which;
    for (uint32_t k = 1; k < problem->active_count; k++)
        for (uint32_t j = k; j > 0 && problem->active[j] < problem->active[j - 1]; j--) {
            const uint32_t index = problem->active[j], place = problem->place[j];
            problem->active[j] = problem->active[j - 1];
            problem->place[j] = problem->place[j - 1];
            problem->active[j - 1] = index;
            problem->place[j - 1] = place;
        }
    while (!factor_active(problem, &which))
        remove_active(problem, which);
    solve_active(problem);
    for (uint32_t k = 0; k < problem->active_count; k++)
        if (only_pushes(problem, k) && !(problem->multiplier[k] > 0.0))
            problem->multiplier[k] = 0.0;
    find_gaps(problem);
}

int dpti_complementarity_solve(struct complementarity *problem)
{
    if (!problem->count) {
        problem->active_count = problem->passes = 0;
        return COMPLEMENTARITY_SOLVED;
    }
    int result = begin(problem);
    while (result == COMPLEMENTARITY_SOLVED && problem->passes < PASSES * problem->count) {
        const uint32_t missed = most_missed(problem);
        if (missed == DPT_NONE)
            break;
        const int is_spent = problem->passes && problem->work && work_is_spent(problem->work);
        result = is_spent ? (int)COMPLEMENTARITY_FULL : add(problem, missed);
    }
    finish(problem);
    return result;
}
