/* SPDX-License-Identifier: BSD-3-Clause */
#include "measure/judgement.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "platform/clock.h"
#include "run/replay_report.h"

/* One number of a tick; NAN where there is none. */
typedef double pick_number(const struct measure_tick *tick);

static double work_of(const struct measure_tick *tick)
{
    return tick->work;
}

static double ns_of(const struct measure_tick *tick)
{
    return tick->ns;
}

static double soft_ns_of(const struct measure_tick *tick)
{
    return tick->soft_ns;
}

static double whole_ns_of(const struct measure_tick *tick)
{
    return ns_of(tick) + soft_ns_of(tick);
}

static int crosses(const struct measure_tick *tick)
{
    return tick->status != DPT_STATUS_STALE && tick->distance == 0.0;
}

static double crossing_ns_of(const struct measure_tick *tick)
{
    return crosses(tick) ? ns_of(tick) : NAN;
}

struct judgement_spread judgement_spread_of(double *numbers, size_t count)
{
    sort_numbers(numbers, count);
    return (struct judgement_spread){ .median = percentile(numbers, count, 0.5),
                                      .p99 = percentile(numbers, count, 0.99),
                                      .p999 = percentile(numbers, count, 0.999),
                                      .max = percentile(numbers, count, 1.0) };
}

static double other_ns_of(const struct measure_tick *tick)
{
    return crosses(tick) ? NAN : ns_of(tick);
}

/* Over all ticks but the first. */
static struct judgement_spread spread_over(const struct measure_run *run, pick_number *pick, double *room,
                                           size_t *count)
{
    *count = 0;
    for (size_t i = 1; i < run->ticks; i++) {
        const double number = pick(&run->tick[i]);
        if (!isnan(number))
            room[(*count)++] = number;
    }
    return judgement_spread_of(room, *count);
}

static int is_in_contact(const struct measure_tick *tick)
{
    return tick->contact == DPT_CONTACT_TOUCHING || tick->contact == DPT_CONTACT_PENETRATING;
}

static void judge_distance(struct judgement *judgement, size_t i, const struct measure_tick *tick,
                           const struct measure_tick *truth, double tolerance)
{
    const double error = fabs(tick->distance - truth->distance);
    const int is_wrong = !(error <= tolerance);
    judgement->wrong += (size_t)is_wrong;
    judgement->wrong_exact += is_wrong && tick->status == DPT_STATUS_EXACT;
    judgement->missed_crossings += is_wrong && crosses(truth);
    if (error > judgement->distance_error) {
        judgement->distance_error = error;
        judgement->distance_tick = i;
    }
}

static void judge_contact(struct judgement *judgement, const struct measure_tick *tick,
                          const struct measure_tick *truth)
{
    judgement->unknown += tick->contact == DPT_CONTACT_UNKNOWN;
    judgement->missed += is_in_contact(truth) && tick->contact == DPT_CONTACT_SEPARATED;
    judgement->invented += truth->contact == DPT_CONTACT_SEPARATED && is_in_contact(tick);
}

static int folds(const struct measure_run *run, size_t i)
{
    return (run->tick[i].force_flags & DPT_FORCE_FLAG_FOLD) != 0;
}

/* 1 for each tick that is near a fold of either run. */
static void mark_folds(unsigned char *near_fold, const struct measure_run *run, const struct measure_run *reference)
{
    memset(near_fold, 0, run->ticks);
    for (size_t i = 0; i < run->ticks; i++) {
        if (!folds(run, i) && !folds(reference, i))
            continue;
        const size_t from = i > JUDGEMENT_FOLD_TICKS ? i - JUDGEMENT_FOLD_TICKS : 0;
        for (size_t k = from; k <= i + JUDGEMENT_FOLD_TICKS && k < run->ticks; k++)
            near_fold[k] = 1;
    }
}

static double apart(const double a[6], const double b[6])
{
    double difference[6];
    for (int k = 0; k < 6; k++)
        difference[k] = a[k] - b[k];
    return measure_wrench_size(difference);
}

static void judge_wrenches(struct judgement *judgement, const struct measure_run *run,
                           const struct measure_run *reference, const unsigned char *near_fold, double *room)
{
    double largest = -1.0;
    for (size_t i = 0; i < run->ticks; i++) {
        const struct measure_tick *tick = &run->tick[i], *truth = &reference->tick[i];
        if (tick->status == DPT_STATUS_STALE || truth->status == DPT_STATUS_STALE)
            continue;
        const double size = measure_wrench_size(truth->wrench);
        const double error = apart(tick->wrench, truth->wrench);
        judgement->wrench_peak = fmax(judgement->wrench_peak, size);
        if (!(size > 0.0 || error > 0.0))
            continue;
        if (near_fold[i]) {
            judgement->near_fold_ticks++;
            judgement->near_fold_error = fmax(judgement->near_fold_error, error);
            continue;
        }
        room[judgement->wrench_ticks++] = error;
        if (error > largest) {
            largest = error;
            judgement->wrench_tick = i;
        }
    }
    judgement->wrench = judgement_spread_of(room, judgement->wrench_ticks);
}

/* Of the run alone. */
static void judge_force(struct judgement *judgement, const struct measure_run *run, const unsigned char *near_fold)
{
    for (size_t i = 0; i < run->ticks; i++) {
        const struct measure_tick *tick = &run->tick[i];
        judgement->folds += (size_t)folds(run, i);
        judgement->inside += tick->force_reason == DPT_FORCE_INSIDE;
        judgement->undecided += tick->force_reason == DPT_FORCE_UNDECIDED;
        judgement->lag = fmax(judgement->lag, tick->lag);
        if (i == 0 || tick->is_jump)
            continue;
        const double jump = apart(tick->wrench, tick[-1].wrench);
        judgement->jump = fmax(judgement->jump, jump);
        if (!near_fold[i])
            judgement->calm_jump = fmax(judgement->calm_jump, jump);
    }
}

static void judge_answers(struct judgement *judgement, const struct measure_run *run,
                          const struct measure_run *reference)
{
    size_t *const by_status[] = { &judgement->stale, &judgement->local, &judgement->bounded, &judgement->exact };
    for (size_t i = 0; i < run->ticks; i++) {
        const struct measure_tick *tick = &run->tick[i], *truth = &reference->tick[i];
        ++*by_status[tick->status];
        if (tick->status == DPT_STATUS_STALE || truth->status == DPT_STATUS_STALE)
            continue;
        judge_distance(judgement, i, tick, truth, reference->check.tolerance);
        if (judgement->has_contact)
            judge_contact(judgement, tick, truth);
    }
}

static void judge_cost(struct judgement *judgement, const struct measure_run *run, double *room)
{
    size_t count;
    judgement->work = spread_over(run, work_of, room, &count);
    judgement->histogram[TICK_HISTOGRAM_WORK] = tick_histogram_count(TICK_HISTOGRAM_WORK, room, count);
    judgement->ns = spread_over(run, ns_of, room, &count);
    judgement->histogram[TICK_HISTOGRAM_NS] = tick_histogram_count(TICK_HISTOGRAM_NS, room, count);
    judgement->soft_ns = spread_over(run, soft_ns_of, room, &count);
    judgement->whole_ns = spread_over(run, whole_ns_of, room, &count);
    judgement->crossing_ns = spread_over(run, crossing_ns_of, room, &judgement->crossings);
    judgement->other_ns = spread_over(run, other_ns_of, room, &count);
    judgement->first_ns = run->tick[0].ns;
    judgement->first_work = run->tick[0].work;
}

int measure_judge(struct judgement *judgement, const struct measure_run *run, const struct measure_run *reference)
{
    memset(judgement, 0, sizeof *judgement);
    if (!run->ticks || run->ticks != reference->ticks)
        return -1;
    double *room = malloc(run->ticks * sizeof *room);
    unsigned char *near_fold = malloc(run->ticks);
    const int has_room = room && near_fold;
    if (has_room) {
        const uint32_t until = run->setting.world.until;
        const uint32_t truth_until = reference->setting.world.until;
        judgement->ticks = run->ticks;
        judgement->has_contact = until != DPT_UNTIL_TRACK && truth_until != DPT_UNTIL_TRACK;
        judgement->has_wrench = until == DPT_UNTIL_RESPOND && truth_until == DPT_UNTIL_RESPOND;
        mark_folds(near_fold, run, reference);
        judge_answers(judgement, run, reference);
        if (judgement->has_wrench)
            judge_wrenches(judgement, run, reference, near_fold, room);
        judge_force(judgement, run, near_fold);
        judge_cost(judgement, run, room);
    }
    free(room);
    free(near_fold);
    return has_room ? 0 : -1;
}
