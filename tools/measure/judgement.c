/* SPDX-License-Identifier: BSD-3-Clause */
#include "measure/judgement.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/return_if_error.h"
#include "clock.h"
#include "run/replay_report.h"
#include "shape/mesh_size.h"

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

/* Its box is wider than the mesh's by this many diagonals: what gives way stays within. */
#define ROOM 4.0

static dpt_result add_body(struct measure_brute *brute, const struct scene_body *body, uint32_t i)
{
    dpt_deformable_def def;
    dpt_mesh_info info = { .size = sizeof info };
    if (!body->springs)
        return dpt_body_add(brute->world, body->mesh, &body->pose, &brute->id[i]);
    dpt_deformable_def_init(&def);
    dpt_mesh_get_info(body->mesh, &info);
    def.mesh = body->mesh;
    def.pose = &body->pose;
    for (int k = 0; k < 3; k++) {
        def.box_min[k] = info.box_min[k] - ROOM * box_diagonal(&info);
        def.box_max[k] = info.box_max[k] + ROOM * box_diagonal(&info);
    }
    const size_t bytes = dpt_deformable_bytes(&def);
    brute->body_block[i] = malloc(bytes);
    if (!brute->body_block[i])
        return DPT_E_MEMORY;
    return dpt_body_add_deformable(brute->world, brute->body_block[i], bytes, &def, &brute->id[i]);
}

dpt_result measure_brute_open(struct measure_brute *brute, const struct scene_bodies *bodies,
                              const struct measure_tool *tool, uint32_t searches)
{
    dpt_world_def def;
    memset(brute, 0, sizeof *brute);
    brute->searches = searches;
    brute->segments = tool->scene->segment_count;
    brute->body_count = bodies->count;
    dpt_world_def_init(&def);
    def.method = DPT_METHOD_BRUTE;
    def.until = DPT_UNTIL_TRACK;
    def.law = DPT_LAW_POINT;
    def.max_bodies = bodies->count;
    def.max_tools = 1;
    def.max_segments = brute->segments;
    def.max_tips = 0;
    const size_t bytes = dpt_world_bytes(&def);
    brute->block = malloc(bytes);
    if (!brute->block)
        return DPT_E_MEMORY;
    DPT_TRY(dpt_world_create(brute->block, bytes, &def, &brute->world));
    for (uint32_t i = 0; i < bodies->count; i++)
        DPT_TRY(add_body(brute, &bodies->body[i], i));
    return dpt_tool_add(brute->world, tool->segments, brute->segments, &brute->tool);
}

void measure_brute_close(struct measure_brute *brute)
{
    free(brute->block);
    for (uint32_t i = 0; i < brute->body_count; i++)
        free(brute->body_block[i]);
}

/* A world that was reset searches again, though nothing has moved. */
static dpt_result search(struct measure_brute *brute)
{
    dpt_step step = { .size = sizeof step };
    brute->ns = UINT32_MAX;
    for (uint32_t i = 0; i < brute->searches; i++) {
        dpt_world_reset(brute->world);
        const uint64_t begin = clock_now();
        DPT_TRY(dpt_world_step(brute->world, 1e-3, &step));
        const uint64_t ns = clock_now() - begin;
        brute->ns = ns < brute->ns ? (uint32_t)ns : brute->ns;
        brute->work = step.work;
    }
    return DPT_OK;
}

/*
 * m: how far a segment's hit is off. Of one that is not the tool's only a bound may be told, where it is far (near_only):
 * then it is how far the truth is outside of that.
 */
static double off_by(const dpt_hit *hit, uint32_t nearest, double truth)
{
    if (hit->status == DPT_STATUS_BOUNDED && hit->segment != nearest)
        return fmax(0.0, fmax(hit->lower_bound - truth, truth - hit->distance));
    return fabs(hit->distance - truth);
}

dpt_result measure_brute_compare(struct measure_brute *brute, const struct scene_bodies *bodies,
                                 const struct measure_tool *tool, const dpt_world *world, dpt_tool id, double *error)
{
    for (uint32_t i = 0; i < bodies->count; i++) {
        const float *vertices;
        uint32_t count;
        if (!brute->body_block[i])
            continue;
        DPT_TRY(dpt_body_get_vertices(world, bodies->body[i].id, &vertices, &count));
        DPT_TRY(dpt_body_set_vertices(brute->world, brute->id[i], 0, count, vertices, -1.0));
    }
    DPT_TRY(dpt_tool_set_segments(brute->world, brute->tool, tool->segments, brute->segments));
    DPT_TRY(search(brute));
    dpt_hit nearest = DPT_HIT_INIT;
    dpt_tool_get_hit(world, id, &nearest);
    *error = 0.0;
    for (uint32_t i = 0; i < brute->segments; i++) {
        dpt_hit hit = DPT_HIT_INIT, true_hit = DPT_HIT_INIT;
        dpt_tool_get_segment_hit(world, id, i, &hit);
        DPT_TRY(dpt_tool_get_segment_hit(brute->world, brute->tool, i, &true_hit));
        *error = fmax(*error, off_by(&hit, nearest.segment, true_hit.distance));
    }
    return DPT_OK;
}
