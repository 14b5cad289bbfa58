/* SPDX-License-Identifier: BSD-3-Clause */
#include "identify_fit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vec3.h"
#include "identify_slides.h"

/* ---- small matrices ---- */

/* A pivot below this fraction of its column is rounding. */
static const double PIVOT_MIN = 1e-12;

/* Jacobi's method converges in fewer. */
enum { N = IDENTIFY_UNKNOWNS_MAX, SWEEPS = 20 };

/* By Cholesky's factors, each column scaled to unit length. A column without a pivot is left out. */
int identify_solve(int n, const double a[N][N], const double *b, double *x)
{
    double scale[N], factor[N][N], y[N];
    int is_used[N], used = 0;
    for (int i = 0; i < n; i++)
        scale[i] = a[i][i] > 0.0 ? 1.0 / sqrt(a[i][i]) : 0.0;
    for (int i = 0; i < n; i++) {
        double pivot = scale[i] > 0.0 ? 1.0 : 0.0, rest = scale[i] * b[i];
        for (int j = 0; j < i; j++) {
            double sum = scale[i] * scale[j] * a[i][j];
            for (int k = 0; k < j; k++)
                sum -= factor[i][k] * factor[j][k];
            factor[i][j] = is_used[j] ? sum / factor[j][j] : 0.0;
            pivot -= factor[i][j] * factor[i][j];
            rest -= factor[i][j] * y[j];
        }
        is_used[i] = pivot > PIVOT_MIN;
        used += is_used[i];
        factor[i][i] = is_used[i] ? sqrt(pivot) : 0.0;
        y[i] = is_used[i] ? rest / factor[i][i] : 0.0;
        for (int j = 0; j < i && !is_used[i]; j++)
            factor[i][j] = 0.0;
    }
    for (int i = n - 1; i >= 0; i--) {
        double rest = y[i];
        for (int k = i + 1; k < n; k++)
            rest -= factor[k][i] * x[k];
        x[i] = is_used[i] ? rest / factor[i][i] : 0.0;
    }
    for (int i = 0; i < n; i++)
        x[i] *= scale[i];
    return used;
}

int identify_inverse(const double *a, double *inverse)
{
    const vec3 row[3] = { vec3_of(a), vec3_of(a + 3), vec3_of(a + 6) };
    const vec3 column[3] = { cross(row[1], row[2]), cross(row[2], row[0]), cross(row[0], row[1]) };
    const double determinant = dot(row[0], column[0]);
    memset(inverse, 0, 9 * sizeof *inverse);
    if (!(fabs(determinant) > 1e-9 * length(row[0]) * length(row[1]) * length(row[2])))
        return 0;
    for (int k = 0; k < 3; k++) {
        inverse[k] = column[k].x / determinant;
        inverse[3 + k] = column[k].y / determinant;
        inverse[6 + k] = column[k].z / determinant;
    }
    return 1;
}

void identify_product(const double *a, const double *b, double *out)
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            out[3 * i + j] = a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
}

void identify_symmetric(double *a)
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < i; j++)
            a[3 * i + j] = a[3 * j + i] = 0.5 * (a[3 * i + j] + a[3 * j + i]);
}

/* Turn rows and columns p and q of `a`, and the vectors, so that a[p][q] becomes 0 (Jacobi). */
static void turn(int n, double *a, double *vectors, int p, int q)
{
    const double off = a[n * p + q];
    if (off == 0.0)
        return;
    const double ratio = (a[n * q + q] - a[n * p + p]) / (2.0 * off);
    const double tangent = (ratio < 0.0 ? -1.0 : 1.0) / (fabs(ratio) + sqrt(ratio * ratio + 1.0));
    const double cosine = 1.0 / sqrt(tangent * tangent + 1.0), sine = tangent * cosine;
    for (int k = 0; k < n; k++) {
        const double x = a[n * k + p], y = a[n * k + q];
        a[n * k + p] = cosine * x - sine * y;
        a[n * k + q] = sine * x + cosine * y;
    }
    for (int k = 0; k < n; k++) {
        const double x = a[n * p + k], y = a[n * q + k];
        a[n * p + k] = cosine * x - sine * y;
        a[n * q + k] = sine * x + cosine * y;
        const double u = vectors[n * p + k], v = vectors[n * q + k];
        vectors[n * p + k] = cosine * u - sine * v;
        vectors[n * q + k] = sine * u + cosine * v;
    }
}

void identify_eigen(int n, const double *matrix, double *values, double *vectors)
{
    double a[N * N], found[N * N] = { 0.0 };
    int order[N];
    memcpy(a, matrix, (size_t)(n * n) * sizeof *a);
    for (int i = 0; i < n; i++)
        found[n * i + i] = 1.0;
    for (int sweep = 0; sweep < SWEEPS; sweep++)
        for (int p = 0; p < n; p++)
            for (int q = p + 1; q < n; q++)
                turn(n, a, found, p, q);
    for (int i = 0; i < n; i++) {
        int k = i;
        for (; k > 0 && a[(n + 1) * order[k - 1]] > a[(n + 1) * i]; k--)
            order[k] = order[k - 1];
        order[k] = i;
    }
    for (int i = 0; i < n; i++) {
        values[i] = a[(n + 1) * order[i]];
        memcpy(vectors + n * i, found + n * order[i], (size_t)n * sizeof *vectors);
    }
}

/* ---- the fit ---- */

/*
 * Chance is not all: no result is better known than this fraction of the force. Coarse steps add to it by the square of
 * the step in parts of the way that a push of usual duration, s, leads. A delay is not better known than the same
 * fraction of a time, s. The factors were measured on simulated devices (docs/algorithms/identify.md).
 */
static const double MODEL_ERROR = 0.002, STEP_ERROR = 8.0, PUSH_TIME = 0.02, DELAY_TIME = 0.01;

/* A spring holds the device if it gives this fraction of the force at the end of the range. */
static const double HELD_FORCE = 0.25;

/* ---- the linear fit ---- */

struct solution {
    double x[3][UNKNOWNS]; /* of each coordinate */
    double residual;       /* sum of squares, m2 */
    int is_whole;          /* W is determined */
};

static double symmetric(const double a[TERMS][TERMS], int i, int j)
{
    return i >= j ? a[i][j] : a[j][i];
}

/* Fit one coordinate to the sums of the three axes. Terms have the sign with which they stand in the equation. */
static void solve_coordinate(const double sums[3][TERMS][TERMS], int coordinate, int with_spring,
                             struct solution *solution)
{
    double a[UNKNOWNS][UNKNOWNS] = { { 0.0 } }, b[UNKNOWNS] = { 0.0 }, square = 0.0;
    double *x = solution->x[coordinate];
    const int unknowns = with_spring ? UNKNOWNS : UNKNOWNS - 1, y = TERM_Y + coordinate;
    for (int axis = 0; axis < 3; axis++) {
        const struct {
            int unknown, term;
            double sign;
        } map[] = { { UNKNOWN_W + axis, TERM_U, 1.0 },
                    { UNKNOWN_P + axis, TERM_FRICTION, -1.0 },
                    { UNKNOWN_C, TERM_I, -1.0 },
                    { UNKNOWN_C + 1, TERM_I + 1, -1.0 },
                    { UNKNOWN_C + 2, TERM_I + 2, -1.0 },
                    { UNKNOWN_H + axis, TERM_CONSTANT, 1.0 },
                    { UNKNOWN_K, TERM_S + coordinate, -1.0 } };
        const int terms = (int)(sizeof map / sizeof *map) - !with_spring;
        for (int i = 0; i < terms; i++) {
            for (int j = 0; j < terms; j++)
                a[map[i].unknown][map[j].unknown] +=
                    map[i].sign * map[j].sign * symmetric(sums[axis], map[i].term, map[j].term);
            b[map[i].unknown] += map[i].sign * symmetric(sums[axis], y, map[i].term);
        }
        square += sums[axis][y][y];
    }
    x[UNKNOWN_K] = 0.0;
    identify_solve(unknowns, (const double(*)[UNKNOWNS])a, b, x);
    for (int i = 0; i < unknowns; i++)
        square -= x[i] * b[i];
    solution->residual += fmax(square, 0.0);
    solution->is_whole &= x[UNKNOWN_W + coordinate] > 0.0;
}

/* Fit the blocks of all numbers but `without` (-1: all). */
static struct solution solve(const struct identify_sums *sums, uint32_t numbers, int without, int with_spring)
{
    static const double none[TERMS][TERMS];
    struct solution solution = { .is_whole = 1 };
    double total[3][TERMS][TERMS];
    for (int axis = 0; axis < 3; axis++) {
        memcpy(total[axis], none, sizeof none);
        for (int number = 0; number < (int)numbers; number++)
            for (int i = 0; i < TERMS && number != without; i++)
                for (int j = 0; j <= i; j++)
                    total[axis][i][j] += sums->of[axis][number][i][j];
    }
    for (int coordinate = 0; coordinate < 3; coordinate++)
        solve_coordinate((const double(*)[TERMS][TERMS])total, coordinate, with_spring, &solution);
    return solution;
}

/* ---- the delay ---- */

/* How far the least of a parabola through three residuals at -1, 0, 1 lies from the middle, within -1 and 1. */
static double parabola_minimum(double before, double middle, double after)
{
    const double curve = before - 2.0 * middle + after;
    const double shift = curve > 0.0 ? 0.5 * (before - after) / curve : before < after ? -1.0 : 1.0;
    return fmax(-1.0, fmin(1.0, shift));
}

struct search {
    struct identify_view view;
    struct identify_sums *sums; /* of [0] a shorter delay, [1] the delay, [2] a longer one */
    int with_spring;
    double known[3][UNKNOWNS];
    double width; /* distance of the three delays */
};

static struct solution solve_at(struct search *search, double delay, int slot)
{
    search->view.delay = delay;
    identify_slides_sum(&search->view, &search->sums[slot]);
    return solve(&search->sums[slot], search->view.record->numbers, -1, search->with_spring);
}

static double coarse_delay(struct search *search)
{
    const struct identify_fit_def *def = search->view.def;
    double delay = 0.0, min_residual = HUGE_VAL;
    for (double tried = -def->period; tried <= def->delay_max; tried += fmax(def->period, 1e-3)) {
        const double residual = solve_at(search, tried, 1).residual;
        if (residual < min_residual) {
            min_residual = residual;
            delay = tried;
        }
    }
    return delay;
}

/* The delay of the least residual near one. The sums of three delays around it remain. */
static double fine_delay(struct search *search, double delay)
{
    const double period = search->view.def->period;
    for (int i = 0;; i++) {
        double residual[3];
        for (int k = 0; k < 3; k++)
            residual[k] = solve_at(search, delay + (k - 1) * search->width, k).residual;
        const double shift = parabola_minimum(residual[0], residual[1], residual[2]);
        if (search->width < 0.11 * period && (fabs(shift) < 0.05 || i >= 12))
            return delay;
        delay += shift * search->width;
        search->width = fmax(0.5 * search->width, 0.1 * period);
    }
}

/* The lag that leaves the least residual with this sum of delay and lag: by thirds, as the residual has one least. */
static double find_lag(struct search *search, double sum)
{
    double low = 0.0, high = fmax(sum, 0.0);
    for (int i = 0; i < 9 && high > 0.0; i++) {
        double residual[2];
        for (int k = 0; k < 2; k++) {
            search->view.lag = low + (high - low) * (k + 1) / 3.0;
            residual[k] = solve_at(search, sum - search->view.lag, 1).residual;
        }
        if (residual[0] <= residual[1])
            high -= (high - low) / 3.0;
        else
            low += (high - low) / 3.0;
    }
    return low < 0.1 * search->view.def->period ? 0.0 : 0.5 * (low + high);
}

/* Assume what the sums of the present delay tell. */
static void know(struct search *search)
{
    const struct solution solution = solve(&search->sums[1], search->view.record->numbers, -1, search->with_spring);
    memcpy(search->known, solution.x, sizeof search->known);
    search->view.known = search->known;
}

/* The delay without a lag, to begin with. */
static double rough_delay(struct search *search)
{
    search->view.known = NULL;
    search->view.lag = 0.0;
    search->width = fmax(search->view.def->period, 1e-3);
    return fine_delay(search, coarse_delay(search));
}

/* The delay without the lag, near a rough one; view.lag is the lag. */
static double find_delay(struct search *search, double rough)
{
    double delay = fine_delay(search, rough);
    know(search);
    search->view.lag = find_lag(search, delay);
    delay = fine_delay(search, delay - search->view.lag);
    know(search);
    return fine_delay(search, delay);
}

/* ---- from the solution to the device ---- */

/* What is said of a solution: [MEAN] over the directions, [LEAST] of them, and their [SPREAD]. */
enum { MEAN, LEAST, SPREAD, KINDS };
enum { MASS, DAMPING, COULOMB, DELAY, STIFFNESS, VALUES };

struct outcome {
    double value[VALUES][KINDS];
    double mass[9], damping[9], mass_vectors[9], damping_vectors[9];
    int is_sound;
};

static void set_kinds(double *value, double a, double b, double c)
{
    value[MEAN] = (a + b + c) / 3.0;
    value[LEAST] = fmin(a, fmin(b, c));
    value[SPREAD] = fmax(a, fmax(b, c)) - value[LEAST];
}

static struct outcome outcome_of(const struct solution *solution, double delay)
{
    struct outcome outcome = { .is_sound = solution->is_whole };
    double inverse[9], rate[9], values[3], friction[3], stiffness[3];
    for (int i = 0; i < 3; i++) {
        const double *x = solution->x[i], own = x[UNKNOWN_W + i];
        memcpy(inverse + 3 * i, x + UNKNOWN_W, 3 * sizeof *x);
        memcpy(rate + 3 * i, x + UNKNOWN_C, 3 * sizeof *x);
        friction[i] = own > 0.0 ? x[UNKNOWN_P + i] / own : 0.0;
        stiffness[i] = own > 0.0 ? x[UNKNOWN_K] / own : 0.0;
    }
    identify_symmetric(inverse);
    outcome.is_sound &= identify_inverse(inverse, outcome.mass);
    identify_product(outcome.mass, rate, outcome.damping);
    identify_symmetric(outcome.damping);
    identify_eigen(3, outcome.mass, values, outcome.mass_vectors);
    outcome.is_sound &= values[0] > 0.0;
    set_kinds(outcome.value[MASS], values[0], values[1], values[2]);
    identify_eigen(3, outcome.damping, values, outcome.damping_vectors);
    set_kinds(outcome.value[DAMPING], values[0], values[1], values[2]);
    set_kinds(outcome.value[COULOMB], friction[0], friction[1], friction[2]);
    outcome.value[STIFFNESS][MEAN] = fmax(stiffness[0], fmax(stiffness[1], stiffness[2]));
    outcome.value[DELAY][MEAN] = delay;
    return outcome;
}

/* Student's t for a two-sided interval of 95 %, by degrees of freedom from 3. */
static double students_t(uint32_t freedom)
{
    static const double t[] = { 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228 };
    return freedom < 3 ? 12.71 : freedom <= 10 ? t[freedom - 3] : 2.228;
}

/* The standard error of a value, by how it changes where each block is left out (jackknife). */
static double error_of(const struct outcome *without, uint32_t count, int value, int kind)
{
    double mean = 0.0, square = 0.0;
    for (uint32_t b = 0; b < count; b++)
        mean += without[b].value[value][kind] / (double)count;
    for (uint32_t b = 0; b < count; b++) {
        const double difference = without[b].value[value][kind] - mean;
        square += difference * difference;
    }
    return sqrt(square * (double)(count - 1) / (double)count);
}

/* `margin`: what the model leaves out. Returns whether the directions are alike. */
static int set_value(const struct outcome *all, const struct outcome *without, uint32_t count, int value, double margin,
                     dpt_identified *out)
{
    const double *kinds = all->value[value];
    const double chance = 3.0 * error_of(without, count, value, SPREAD);
    const int are_alike = kinds[SPREAD] <= fmax(0.05 * fabs(kinds[MEAN]), chance) + margin;
    const int kind = are_alike ? MEAN : LEAST;
    const double error = students_t(count - 1) * error_of(without, count, value, kind) + margin;
    *out = (dpt_identified){ kinds[kind], kinds[kind] - error, kinds[kind] + error };
    return are_alike;
}

static double model_error(const struct identify_fit_def *def)
{
    const double part = def->step / (PUSH_TIME * def->speed);
    return MODEL_ERROR + STEP_ERROR * part * part;
}

static void clamp_to_zero(dpt_identified *value)
{
    value->value = fmax(value->value, 0.0);
    value->low = fmax(value->low, 0.0);
    value->high = fmax(value->high, 0.0);
}

static void set_fit(const struct outcome *all, const struct outcome *without, uint32_t count,
                    const struct identify_fit_def *def, struct identify_fit *fit)
{
    const double error = model_error(def), force = error * def->force;
    memcpy(fit->mass_matrix, all->mass, sizeof fit->mass_matrix);
    memcpy(fit->damping_matrix, all->damping, sizeof fit->damping_matrix);
    if (!set_value(all, without, count, MASS, error * all->value[MASS][MEAN], &fit->mass))
        memcpy(fit->mass_direction, all->mass_vectors, sizeof fit->mass_direction);
    if (!set_value(all, without, count, DAMPING, force / def->speed, &fit->damping))
        memcpy(fit->damping_direction, all->damping_vectors, sizeof fit->damping_direction);
    set_value(all, without, count, COULOMB, force, &fit->friction);
    set_value(all, without, count, DELAY, 0.02 * def->period + error * DELAY_TIME, &fit->delay);
    clamp_to_zero(&fit->damping);
    clamp_to_zero(&fit->friction);
    clamp_to_zero(&fit->delay);
}

/*
 * The outcome of all blocks, and of all but each of them, from the sums around this delay. Returns 0 if the record does
 * not tell.
 */
static int find_outcomes(const struct search *search, double delay, struct outcome *all, struct outcome *without)
{
    const uint32_t numbers = search->view.record->numbers;
    const double lag = search->view.lag;
    const struct solution solution = solve(&search->sums[1], numbers, -1, search->with_spring);
    *all = outcome_of(&solution, delay + lag);
    int is_sound = all->is_sound;
    for (uint32_t number = 0; number < numbers; number++) {
        struct solution left[3];
        for (int k = 0; k < 3; k++)
            left[k] = solve(&search->sums[k], numbers, (int)number, search->with_spring);
        const double shift = parabola_minimum(left[0].residual, left[1].residual, left[2].residual);
        without[number] = outcome_of(&left[1], delay + lag + shift * search->width);
        is_sound &= without[number].is_sound;
    }
    return is_sound;
}

/* First with a spring, to see whether there is one; then with all that the model knows. */
static dpt_result fit_with(struct search *search, struct identify_fit *fit)
{
    struct outcome all, without[IDENTIFY_BLOCKS_MAX];
    const uint32_t numbers = search->view.record->numbers;
    const struct identify_fit_def *def = search->view.def;
    search->with_spring = 1;
    const double rough = rough_delay(search);
    if (find_outcomes(search, rough, &all, without)) {
        const double at_end = model_error(def) * def->force / def->range;
        set_value(&all, without, numbers, STIFFNESS, at_end, &fit->stiffness);
        fit->is_held = fit->stiffness.low > 0.0 && fit->stiffness.value * def->range > HELD_FORCE * def->force;
    }
    search->with_spring = fit->is_held;
    const double delay = find_delay(search, rough);
    if (!find_outcomes(search, delay, &all, without))
        return DPT_E_EMPTY;
    set_fit(&all, without, numbers, def, fit);
    return DPT_OK;
}

dpt_result identify_fit(const struct identify_record *record, const struct identify_fit_def *def,
                        struct identify_fit *fit)
{
    struct search search = { .view = { .record = record, .def = def } };
    uint32_t samples = 1;
    memset(fit, 0, sizeof *fit);
    if (record->numbers < 4)
        return DPT_E_EMPTY;
    for (uint32_t b = 0; b < record->count; b++)
        if (record->blocks[b].sample_count > samples)
            samples = record->blocks[b].sample_count;
    search.sums = malloc(3 * sizeof *search.sums);
    search.view.predicted = malloc(samples * sizeof *search.view.predicted);
    const dpt_result result = search.sums && search.view.predicted ? fit_with(&search, fit) : DPT_E_MEMORY;
    free(search.view.predicted);
    free(search.sums);
    return result;
}
