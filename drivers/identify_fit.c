/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * While the device slides one way, its motion y obeys M y'' = F - B y' - f sign + g - K y. Integrated twice this is
 * linear in the unknowns and needs no derivative of a measured position:
 *     y = y0 + v0 t + W U - C I - p sign t^2/2 + h t^2/2 - k S
 * with W = M^-1, C = W B, p = W f, h = W g, k = W K, U the double integral of the delayed command, I the integral of y
 * and S its double integral. The error of y is that of the sensor; U is known exactly.
 */
#include "identify_fit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "identify_matrix.h"

/* Terms of a slide: the first two are its own unknowns y0 and v0. */
enum { ONE, TIME, U, I, FRICTION = I + 3, CONSTANT, S, Y = S + 3, TERMS = Y + 3 };
enum { OWN = 2, SHARED = TERMS - OWN };

/*
 * Unknowns of one coordinate: W, p and h of each pushed axis, C, k. A constant force is one of a pushed axis, for friction
 * may hold the other coordinates against it.
 */
enum { W_OF, P_OF = 3, H_OF = 6, C_OF = 9, K_OF = 12, UNKNOWNS = IDENTIFY_UNKNOWNS_MAX };

enum { SLIDE_SAMPLES_MIN = 8 };

/* Longest piece of a slide, s. */
static const double SLIDE_TIME_MAX = 0.25;

/*
 * Half of the window over which the speed is taken that tells whether the device slides, s, at most. The device slides
 * if it is faster than a part of the speed that the pushes aim at.
 */
static const double SPEED_WINDOW = 0.004, SLIDE_SPEED = 0.1;

/* What the model leaves out is not better known than this fraction of the force. */
static const double MODEL_ERROR = 0.002;

/* A spring holds the device if it gives this fraction of the force at the end of the range. */
static const double HELD_FORCE = 0.25;

/* Sums of products of the terms, with each slide's own unknowns eliminated, of each axis and block. */
struct sums {
    double of[3][IDENTIFY_BLOCKS_MAX][SHARED][SHARED];
};

/* ---- slides and their sums ---- */

/* The double integral of the commands from the beginning of a slide. */
struct push_integral {
    const struct identify_block *block;
    uint32_t next; /* command */
    double delay, time, force, once, twice;
};

static void integral_move(struct push_integral *integral, double time)
{
    const double dt = time - integral->time;
    integral->twice += dt * (integral->once + 0.5 * dt * integral->force);
    integral->once += dt * integral->force;
    integral->time = time;
}

static void integral_to(struct push_integral *integral, double time)
{
    const struct identify_block *block = integral->block;
    for (; integral->next < block->command_count &&
           block->commands[integral->next].time + integral->delay <= time;
         integral->next++) {
        const struct identify_command *command = &block->commands[integral->next];
        if (command->time + integral->delay > integral->time)
            integral_move(integral, command->time + integral->delay);
        integral->force = command->force;
    }
    integral_move(integral, time);
}

static void add_products(double products[TERMS][TERMS], const double *term)
{
    for (int i = 0; i < TERMS; i++)
        for (int j = 0; j <= i; j++)
            products[i][j] += term[i] * term[j];
}

/* Eliminate the first two terms, and add the rest. */
static void add_slide(double products[TERMS][TERMS], double sums[SHARED][SHARED])
{
    for (int own = 0; own < OWN; own++) {
        const double pivot = products[own][own];
        for (int i = own + 1; i < TERMS; i++) {
            const double ratio = products[i][own] / pivot;
            for (int j = own + 1; j <= i; j++)
                products[i][j] -= ratio * products[j][own];
        }
    }
    for (int i = 0; i < SHARED; i++)
        for (int j = 0; j <= i; j++)
            sums[i][j] += products[OWN + i][OWN + j];
}

static void sum_slide(const struct identify_block *block, uint32_t first, uint32_t end, double sign,
                      double delay, double sums[SHARED][SHARED])
{
    double products[TERMS][TERMS] = { { 0.0 } }, once[3] = { 0.0 }, twice[3] = { 0.0 };
    const struct identify_sample *begin = &block->samples[first];
    struct push_integral push = { .block = block, .delay = delay, .time = -1.0 };
    integral_to(&push, begin->time);
    push.once = push.twice = 0.0;
    for (uint32_t n = first; n < end; n++) {
        const struct identify_sample *now = &block->samples[n];
        const double t = now->time - begin->time;
        double term[TERMS] = { [ONE] = 1.0, [TIME] = t, [FRICTION] = 0.5 * sign * t * t };
        integral_to(&push, now->time);
        term[U] = push.twice;
        term[CONSTANT] = 0.5 * t * t;
        for (int k = 0; k < 3; k++) {
            if (n > first) {
                const double before = now[-1].y[k], dt = now->time - now[-1].time;
                twice[k] += dt * (once[k] + dt * (2.0 * before + now->y[k]) / 6.0);
                once[k] += 0.5 * dt * (before + now->y[k]);
            }
            term[I + k] = once[k];
            term[S + k] = twice[k];
            term[Y + k] = now->y[k];
        }
        add_products(products, term);
    }
    add_slide(products, sums);
}

/* The same in pieces, so that what the model leaves out does not add up. */
static void sum_pieces(const struct identify_block *block, uint32_t first, uint32_t end,
                       double sign, double delay, double sums[SHARED][SHARED])
{
    const double time = block->samples[end - 1].time - block->samples[first].time;
    const uint32_t pieces = 1 + (uint32_t)(time / SLIDE_TIME_MAX), length = (end - first) / pieces;
    for (uint32_t piece = 0; piece < pieces; piece++)
        sum_slide(block, first + piece * length, first + (piece + 1) * length, sign, delay, sums);
}

/* The direction of a slide at a sample: 1 or -1; 0 if the device may not slide there. */
static double slide_sign(const struct identify_block *block, uint32_t n, uint32_t half,
                         double speed_min)
{
    if (n < half || n + half >= block->sample_count)
        return 0.0;
    const struct identify_sample *from = &block->samples[n - half], *to = &block->samples[n + half];
    const double moved = to->y[block->axis] - from->y[block->axis], dt = to->time - from->time;
    return moved > speed_min * dt ? 1.0 : moved < -speed_min * dt ? -1.0 : 0.0;
}

/*
 * Add up all slides for this delay. Where the direction changes, the window of the speed reaches beyond the change: the
 * samples beside it do not count.
 */
static void sum_slides(const struct identify_record *record, const struct identify_fit_def *def,
                       double delay, struct sums *sums)
{
    const double slow = SLIDE_SPEED * def->speed, least_window = 1.25 * def->step / slow;
    const uint32_t half = (uint32_t)fmax(2.0, ceil(fmin(SPEED_WINDOW, least_window) / def->period));
    const double speed_min = fmax(slow, 1.25 * def->step / ((double)half * def->period));
    memset(sums, 0, sizeof *sums);
    for (uint32_t b = 0; b < record->count; b++) {
        const struct identify_block *block = &record->blocks[b];
        for (uint32_t n = 0; n < block->sample_count;) {
            const double sign = slide_sign(block, n, half, speed_min);
            uint32_t end = n + 1;
            while (end < block->sample_count && slide_sign(block, end, half, speed_min) == sign)
                end++;
            if (sign != 0.0 && end - n >= SLIDE_SAMPLES_MIN + 2 * half)
                sum_pieces(block, n + half, end - half, sign, delay,
                           sums->of[block->axis][block->number]);
            n = end;
        }
    }
}

/* ---- the linear fit ---- */

struct solution {
    double x[3][UNKNOWNS]; /* of each coordinate */
    double residual;       /* sum of squares, m2 */
    int is_whole;          /* W is determined */
};

static double symmetric(const double a[SHARED][SHARED], int i, int j)
{
    return i >= j ? a[i][j] : a[j][i];
}

/* Fit one coordinate to the sums of the three axes. Terms have the sign with which they stand in the equation. */
static void solve_coordinate(const double sums[3][SHARED][SHARED], int coordinate, int with_spring,
                             struct solution *solution)
{
    double a[UNKNOWNS][UNKNOWNS] = { { 0.0 } }, b[UNKNOWNS] = { 0.0 }, square = 0.0;
    double *x = solution->x[coordinate];
    const int unknowns = with_spring ? UNKNOWNS : UNKNOWNS - 1, y = Y - OWN + coordinate;
    for (int axis = 0; axis < 3; axis++) {
        const struct {
            int unknown, term;
            double sign;
        } map[] = { { W_OF + axis, U - OWN, 1.0 },
                    { P_OF + axis, FRICTION - OWN, -1.0 },
                    { C_OF, I - OWN, -1.0 },
                    { C_OF + 1, I + 1 - OWN, -1.0 },
                    { C_OF + 2, I + 2 - OWN, -1.0 },
                    { H_OF + axis, CONSTANT - OWN, 1.0 },
                    { K_OF, S + coordinate - OWN, -1.0 } };
        const int terms = (int)(sizeof map / sizeof *map) - !with_spring;
        for (int i = 0; i < terms; i++) {
            for (int j = 0; j < terms; j++)
                a[map[i].unknown][map[j].unknown] +=
                    map[i].sign * map[j].sign * symmetric(sums[axis], map[i].term, map[j].term);
            b[map[i].unknown] += map[i].sign * symmetric(sums[axis], y, map[i].term);
        }
        square += sums[axis][y][y];
    }
    x[K_OF] = 0.0;
    identify_solve(unknowns, (const double(*)[UNKNOWNS])a, b, x);
    for (int i = 0; i < unknowns; i++)
        square -= x[i] * b[i];
    solution->residual += fmax(square, 0.0);
    solution->is_whole &= x[W_OF + coordinate] > 0.0;
}

/* Fit the blocks of all numbers but `without` (-1: all). */
static struct solution solve(const struct sums *sums, uint32_t numbers, int without,
                             int with_spring)
{
    static const double none[SHARED][SHARED];
    struct solution solution = { .is_whole = 1 };
    double total[3][SHARED][SHARED];
    for (int axis = 0; axis < 3; axis++) {
        memcpy(total[axis], none, sizeof none);
        for (int number = 0; number < (int)numbers; number++)
            for (int i = 0; i < SHARED && number != without; i++)
                for (int j = 0; j <= i; j++)
                    total[axis][i][j] += sums->of[axis][number][i][j];
    }
    for (int coordinate = 0; coordinate < 3; coordinate++)
        solve_coordinate((const double(*)[SHARED][SHARED])total, coordinate, with_spring,
                         &solution);
    return solution;
}

/* ---- the delay ---- */

/* How far the least of a parabola through three residuals at -1, 0, 1 lies from the middle, within -1 and 1. */
static double parabola_least(double before, double middle, double after)
{
    const double curve = before - 2.0 * middle + after;
    const double shift = curve > 0.0 ? 0.5 * (before - after) / curve : before < after ? -1.0 : 1.0;
    return fmax(-1.0, fmin(1.0, shift));
}

struct search {
    const struct identify_record *record;
    const struct identify_fit_def *def;
    struct sums *sums; /* of [0] a shorter delay, [1] the delay, [2] a longer one */
    int with_spring;
};

static double residual_at(const struct search *search, double delay, int slot)
{
    sum_slides(search->record, search->def, delay, &search->sums[slot]);
    return solve(&search->sums[slot], search->record->numbers, -1, search->with_spring).residual;
}

/* The delay of the least residual. *width is the distance of the three delays whose sums remain. */
static double find_delay(const struct search *search, double *width)
{
    const double period = search->def->period, coarse = fmax(period, 1e-3);
    double delay = -period, least = HUGE_VAL;
    for (double tried = -period; tried <= search->def->delay_max; tried += coarse) {
        const double residual = residual_at(search, tried, 1);
        if (residual < least) {
            least = residual;
            delay = tried;
        }
    }
    *width = coarse;
    for (int i = 0;; i++) {
        double residual[3];
        for (int k = 0; k < 3; k++)
            residual[k] = residual_at(search, delay + (k - 1) * *width, k);
        const double shift = parabola_least(residual[0], residual[1], residual[2]);
        if (i >= 5 && (fabs(shift) < 0.05 || i >= 12))
            return delay;
        delay += shift * *width;
        *width = fmax(0.5 * *width, 0.1 * period);
    }
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
        const double *x = solution->x[i], own = x[W_OF + i];
        memcpy(inverse + 3 * i, x + W_OF, 3 * sizeof *x);
        memcpy(rate + 3 * i, x + C_OF, 3 * sizeof *x);
        friction[i] = own > 0.0 ? x[P_OF + i] / own : 0.0;
        stiffness[i] = own > 0.0 ? x[K_OF] / own : 0.0;
    }
    identify_symmetric(inverse);
    outcome.is_sound &= identify_inverse(inverse, outcome.mass);
    identify_product(outcome.mass, rate, outcome.damping);
    identify_symmetric(outcome.damping);
    identify_eigen(outcome.mass, values, outcome.mass_vectors);
    outcome.is_sound &= values[0] > 0.0;
    set_kinds(outcome.value[MASS], values[0], values[1], values[2]);
    identify_eigen(outcome.damping, values, outcome.damping_vectors);
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
static int set_value(const struct outcome *all, const struct outcome *without, uint32_t count,
                     int value, double margin, dpt_identified *out)
{
    const double *kinds = all->value[value];
    const double chance = 3.0 * error_of(without, count, value, SPREAD);
    const int are_alike = kinds[SPREAD] <= fmax(0.05 * fabs(kinds[MEAN]), chance) + margin;
    const int kind = are_alike ? MEAN : LEAST;
    const double error = students_t(count - 1) * error_of(without, count, value, kind) + margin;
    *out = (dpt_identified){ kinds[kind], kinds[kind] - error, kinds[kind] + error };
    return are_alike;
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
    const double force = MODEL_ERROR * def->force;
    memcpy(fit->mass_matrix, all->mass, sizeof fit->mass_matrix);
    memcpy(fit->damping_matrix, all->damping, sizeof fit->damping_matrix);
    if (!set_value(all, without, count, MASS, MODEL_ERROR * all->value[MASS][MEAN], &fit->mass))
        memcpy(fit->mass_direction, all->mass_vectors, sizeof fit->mass_direction);
    if (!set_value(all, without, count, DAMPING, force / def->speed, &fit->damping))
        memcpy(fit->damping_direction, all->damping_vectors, sizeof fit->damping_direction);
    set_value(all, without, count, COULOMB, force, &fit->friction);
    set_value(all, without, count, DELAY, 0.02 * def->period, &fit->delay);
    clamp_to_zero(&fit->damping);
    clamp_to_zero(&fit->friction);
    clamp_to_zero(&fit->delay);
}

/* Fit all blocks, and again without each of them. Returns 0 if the record does not tell. */
static int fit_all(const struct search *search, struct outcome *all, struct outcome *without)
{
    const uint32_t numbers = search->record->numbers;
    double width;
    const double delay = find_delay(search, &width);
    const struct solution solution = solve(&search->sums[1], numbers, -1, search->with_spring);
    *all = outcome_of(&solution, delay);
    int is_sound = all->is_sound;
    for (uint32_t number = 0; number < numbers; number++) {
        struct solution left[3];
        for (int k = 0; k < 3; k++)
            left[k] = solve(&search->sums[k], numbers, (int)number, search->with_spring);
        const double shift = parabola_least(left[0].residual, left[1].residual, left[2].residual);
        without[number] = outcome_of(&left[1], delay + shift * width);
        is_sound &= without[number].is_sound;
    }
    return is_sound;
}

static dpt_result fit_with(struct search *search, struct identify_fit *fit)
{
    struct outcome all, without[IDENTIFY_BLOCKS_MAX];
    const uint32_t numbers = search->record->numbers;
    const struct identify_fit_def *def = search->def;
    search->with_spring = 1;
    const int has_spring = fit_all(search, &all, without);
    if (has_spring) {
        const double at_end = MODEL_ERROR * def->force / def->range;
        set_value(&all, without, numbers, STIFFNESS, at_end, &fit->stiffness);
        fit->is_held =
            fit->stiffness.low > 0.0 && fit->stiffness.value * def->range > HELD_FORCE * def->force;
    }
    search->with_spring = fit->is_held;
    if (!fit->is_held && !fit_all(search, &all, without))
        return DPT_E_EMPTY;
    set_fit(&all, without, numbers, def, fit);
    return DPT_OK;
}

dpt_result identify_fit(const struct identify_record *record, const struct identify_fit_def *def,
                        struct identify_fit *fit)
{
    struct search search = { .record = record, .def = def };
    memset(fit, 0, sizeof *fit);
    if (record->numbers < 4)
        return DPT_E_EMPTY;
    search.sums = malloc(3 * sizeof *search.sums);
    if (!search.sums)
        return DPT_E_MEMORY;
    const dpt_result result = fit_with(&search, fit);
    free(search.sums);
    return result;
}
