/* SPDX-License-Identifier: BSD-3-Clause */
#include "identify_slides.h"

#include <math.h>
#include <string.h>

#include "base/vec3.h"

/* ---- the sensor's step ---- */

/* Fewer changes than this tell nothing. */
enum { CHANGES_MIN = 4 };

/* Of a grid, changes up to so many steps are looked at, and lie within this fraction of a step from it. */
static const double STEPS_MAX = 20.0, GRID_ERROR = 0.02;

static double change(const struct identify_sample *samples, uint32_t n, int k)
{
    return fabs(samples[n].y[k] - samples[n - 1].y[k]);
}

/* The step of a coordinate that lies on a grid: all small changes are multiples of the least. 0: it does not. */
static double grid_step(const struct identify_sample *samples, uint32_t count, int k)
{
    double step = HUGE_VAL, sum = 0.0, steps = 0.0;
    uint32_t small = 0, fitting = 0, still = 0;
    for (uint32_t n = 1; n < count; n++) {
        const double size = change(samples, n, k);
        still += size < 1e-12;
        if (size >= 1e-12)
            step = fmin(step, size);
    }
    for (uint32_t n = 1; n < count; n++) {
        const double size = change(samples, n, k), whole = floor(size / step + 0.5);
        if (size < 1e-12 || size > STEPS_MAX * step)
            continue;
        small++;
        fitting += fabs(size - whole * step) < GRID_ERROR * step;
        sum += size;
        steps += whole;
    }
    return small >= CHANGES_MIN && still >= CHANGES_MIN && (double)fitting > 0.95 * (double)small ? sum / steps : 0.0;
}

enum { NEAR = 5, BINS = 400 };

static double length_of_change(const struct identify_sample *samples, uint32_t n)
{
    return length(sub(vec3_of(samples[n].y), vec3_of(samples[n - 1].y)));
}

/* The bin of a length, 20 to a decade from 1e-12 on. */
static int bin_of(double size)
{
    const int bin = (int)floor(20.0 * (log10(size) + 12.0));
    return bin < 0 ? 0 : bin >= BINS ? BINS - 1 : bin;
}

/*
 * Encoders of joints give no grid of positions. Where the device moves so slowly that half of the samples repeat the
 * one before, each change is mostly one step: their median.
 */
static double slow_step(const struct identify_sample *samples, uint32_t count)
{
    uint32_t bins[BINS] = { 0 }, changes = 0, seen = 0, still = 0;
    for (uint32_t n = 1; n < count; n++) {
        still += length_of_change(samples, n) < 1e-12;
        if (n > 2 * NEAR + 1)
            still -= length_of_change(samples, n - 2 * NEAR - 1) < 1e-12;
        if (n < 2 * NEAR + 1 || still <= NEAR)
            continue;
        const double size = length_of_change(samples, n - NEAR);
        if (size >= 1e-12) {
            bins[bin_of(size)]++;
            changes++;
        }
    }
    if (changes < 2 * CHANGES_MIN)
        return 0.0;
    for (int bin = 0; bin < BINS; bin++) {
        seen += bins[bin];
        if (2 * seen >= changes)
            return pow(10.0, ((double)bin + 0.5) / 20.0 - 12.0);
    }
    return 0.0;
}

double identify_step(const struct identify_sample *samples, uint32_t count)
{
    double step = 0.0;
    for (int k = 0; k < 3; k++)
        step = fmax(step, grid_step(samples, count, k));
    return step > 0.0 ? step : slow_step(samples, count);
}

/* ---- slides ---- */

enum { SLIDE_SAMPLES_MIN = 8 };

/* Longest piece of a slide, s. */
static const double SLIDE_TIME_MAX = 0.25;

/*
 * Half of the window over which the speed is taken that tells whether the device slides, s, at most. The device slides
 * if it is faster than a part of the speed that the pushes aim at, and by so many steps in the window.
 */
static const double SPEED_WINDOW = 0.004, SLIDE_SPEED = 0.1, SLIDE_STEPS = 2.5;

/* Samples `first` to before `end` of a block. */
struct slide {
    const struct identify_block *block;
    uint32_t first, end;
    double sign;
};

/* ---- the double integral of the motor's force ---- */

struct push_integral {
    const struct identify_block *block;
    uint32_t next; /* command */
    double delay, lag, time, command, force, once, twice;
};

/* The force approaches the command exponentially: f = c + (f0 - c) exp(-t / lag). */
static void integral_move(struct push_integral *integral, double time)
{
    const double dt = time - integral->time, lag = integral->lag, command = integral->command;
    const double gone = lag > 0.0 ? lag * (1.0 - exp(-dt / lag)) : 0.0;
    const double off = integral->force - command;
    integral->twice += dt * (integral->once + 0.5 * dt * command) + off * lag * (dt - gone);
    integral->once += dt * command + off * gone;
    integral->force = lag > 0.0 ? integral->force - off * gone / lag : command;
    integral->time = time;
}

static void integral_to(struct push_integral *integral, double time)
{
    const struct identify_block *block = integral->block;
    for (; integral->next < block->command_count && block->commands[integral->next].time + integral->delay <= time;
         integral->next++) {
        const struct identify_command *command = &block->commands[integral->next];
        if (command->time + integral->delay > integral->time)
            integral_move(integral, command->time + integral->delay);
        integral->command = command->force;
    }
    integral_move(integral, time);
}

/* ---- the terms of a slide's samples ---- */

/* With the slide's own: 1 and t come before the shared ones. */
enum { OWN = 2, ALL_TERMS = OWN + TERMS };

struct slide_terms {
    const struct slide *slide;
    struct push_integral push;
    double before[3], once[3], twice[3];
    double of[ALL_TERMS];
};

static void terms_begin(struct slide_terms *terms, const struct slide *slide, const struct identify_view *view)
{
    memset(terms, 0, sizeof *terms);
    terms->slide = slide;
    terms->push = (struct push_integral){ .block = slide->block, .delay = view->delay, .lag = view->lag, .time = -1.0 };
    integral_to(&terms->push, slide->block->samples[slide->first].time);
    terms->push.once = terms->push.twice = 0.0;
}

/* The terms of sample n, with I and S of the motion y. To be called for each sample in turn. */
static void terms_next(struct slide_terms *terms, uint32_t n, const double *y)
{
    const struct slide *slide = terms->slide;
    const struct identify_sample *now = &slide->block->samples[n];
    const double t = now->time - slide->block->samples[slide->first].time;
    const double dt = n > slide->first ? now->time - now[-1].time : 0.0;
    double *shared = terms->of + OWN;
    integral_to(&terms->push, now->time);
    terms->of[0] = 1.0;
    terms->of[1] = t;
    shared[TERM_U] = terms->push.twice;
    shared[TERM_FRICTION] = 0.5 * slide->sign * t * t;
    shared[TERM_CONSTANT] = 0.5 * t * t;
    for (int k = 0; k < 3; k++) {
        terms->twice[k] += dt * (terms->once[k] + dt * (2.0 * terms->before[k] + y[k]) / 6.0);
        terms->once[k] += 0.5 * dt * (terms->before[k] + y[k]);
        terms->before[k] = y[k];
        shared[TERM_I + k] = terms->once[k];
        shared[TERM_S + k] = terms->twice[k];
        shared[TERM_Y + k] = now->y[k];
    }
}

/* What the known unknowns make of the shared terms, for coordinate k. */
static double shared_part(const struct slide_terms *terms, const double *known, int k)
{
    const double *shared = terms->of + OWN;
    const uint32_t axis = terms->slide->block->axis;
    double sum = known[UNKNOWN_W + axis] * shared[TERM_U] - known[UNKNOWN_P + axis] * shared[TERM_FRICTION] +
                 known[UNKNOWN_H + axis] * shared[TERM_CONSTANT] - known[UNKNOWN_K] * shared[TERM_S + k];
    for (int j = 0; j < 3; j++)
        sum -= known[UNKNOWN_C + j] * shared[TERM_I + j];
    return sum;
}

/* Predict the motion: the shared part, and the line through what is left. */
static void predict(const struct slide *slide, const struct identify_view *view)
{
    const struct identify_sample *samples = slide->block->samples;
    const double begin = samples[slide->first].time;
    double count = 0.0, sum_t = 0.0, sum_tt = 0.0, sum[3] = { 0.0 }, sum_by_t[3] = { 0.0 };
    struct slide_terms terms;
    terms_begin(&terms, slide, view);
    for (uint32_t n = slide->first; n < slide->end; n++) {
        const double t = samples[n].time - begin;
        terms_next(&terms, n, samples[n].y);
        count += 1.0;
        sum_t += t;
        sum_tt += t * t;
        for (int k = 0; k < 3; k++) {
            view->predicted[n][k] = shared_part(&terms, view->known[k], k);
            sum[k] += samples[n].y[k] - view->predicted[n][k];
            sum_by_t[k] += t * (samples[n].y[k] - view->predicted[n][k]);
        }
    }
    for (int k = 0; k < 3; k++) {
        const double slope = (count * sum_by_t[k] - sum_t * sum[k]) / (count * sum_tt - sum_t * sum_t);
        const double offset = (sum[k] - slope * sum_t) / count;
        for (uint32_t n = slide->first; n < slide->end; n++)
            view->predicted[n][k] += offset + slope * (samples[n].time - begin);
    }
}

/* ---- sums ---- */

static void add_products(double products[ALL_TERMS][ALL_TERMS], const double *term)
{
    for (int i = 0; i < ALL_TERMS; i++)
        for (int j = 0; j <= i; j++)
            products[i][j] += term[i] * term[j];
}

/* Eliminate the slide's own terms, and add the rest. */
static void add_slide(double products[ALL_TERMS][ALL_TERMS], double sums[TERMS][TERMS])
{
    for (int own = 0; own < OWN; own++) {
        const double pivot = products[own][own];
        for (int i = own + 1; i < ALL_TERMS && pivot > 0.0; i++) {
            const double ratio = products[i][own] / pivot;
            for (int j = own + 1; j <= i; j++)
                products[i][j] -= ratio * products[j][own];
        }
    }
    for (int i = 0; i < TERMS; i++)
        for (int j = 0; j <= i; j++)
            sums[i][j] += products[OWN + i][OWN + j];
}

static void sum_slide(const struct identify_view *view, const struct slide *slide, struct identify_sums *sums)
{
    const struct identify_block *block = slide->block;
    double products[ALL_TERMS][ALL_TERMS] = { { 0.0 } };
    struct slide_terms terms;
    if (view->known)
        predict(slide, view);
    terms_begin(&terms, slide, view);
    for (uint32_t n = slide->first; n < slide->end; n++) {
        terms_next(&terms, n, view->known ? view->predicted[n] : block->samples[n].y);
        add_products(products, terms.of);
    }
    add_slide(products, sums->of[block->axis][block->number]);
}

/* The same in pieces, so that what the model leaves out does not add up. */
static void sum_pieces(const struct identify_view *view, const struct slide *whole, struct identify_sums *sums)
{
    const struct identify_sample *samples = whole->block->samples;
    const double time = samples[whole->end - 1].time - samples[whole->first].time;
    const uint32_t pieces = 1 + (uint32_t)(time / SLIDE_TIME_MAX);
    const uint32_t count = (whole->end - whole->first) / pieces;
    for (uint32_t piece = 0; piece < pieces; piece++) {
        struct slide slide = *whole;
        slide.first = whole->first + piece * count;
        slide.end = slide.first + count;
        sum_slide(view, &slide, sums);
    }
}

/* The direction of a slide at a sample: 1 or -1; 0 if the device may not slide there. */
static double slide_sign(const struct identify_block *block, uint32_t n, uint32_t half, double speed_min)
{
    if (n < half || n + half >= block->sample_count)
        return 0.0;
    const struct identify_sample *from = &block->samples[n - half], *to = &block->samples[n + half];
    const double moved = to->y[block->axis] - from->y[block->axis], dt = to->time - from->time;
    return moved > speed_min * dt ? 1.0 : moved < -speed_min * dt ? -1.0 : 0.0;
}

/*
 * Where the direction changes, the window of the speed reaches beyond the change: samples beside it do not count.
 */
void identify_slides_sum(const struct identify_view *view, struct identify_sums *sums)
{
    const struct identify_fit_def *def = view->def;
    const double slow = SLIDE_SPEED * def->speed, steps = 0.5 * SLIDE_STEPS * def->step;
    const uint32_t half = (uint32_t)fmax(2.0, ceil(fmin(SPEED_WINDOW, steps / slow) / def->period));
    const uint32_t beside = half / 2;
    const double speed_min = fmax(slow, steps / ((double)half * def->period));
    memset(sums, 0, sizeof *sums);
    for (uint32_t b = 0; b < view->record->count; b++) {
        const struct identify_block *block = &view->record->blocks[b];
        for (uint32_t n = 0; n < block->sample_count;) {
            const double sign = slide_sign(block, n, half, speed_min);
            uint32_t end = n + 1;
            while (end < block->sample_count && slide_sign(block, end, half, speed_min) == sign)
                end++;
            if (sign != 0.0 && end - n >= SLIDE_SAMPLES_MIN + 2 * beside)
                sum_pieces(view, &(struct slide){ block, n + beside, end - beside, sign }, sums);
            n = end;
        }
    }
}
