/* SPDX-License-Identifier: BSD-3-Clause */
#include "plan/plan_trace.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/crc32.h"
#include "base/vec3.h"
#include "cli/command_options.h"
#include "measure/measure_setting.h"
#include "plan/plan_file.h"

/* Of a row: the tick, and two ends. */
enum { COLUMNS = 7 };

/* s: of the hand. */
#define HAND_TICK 1e-3

/* From the seed of one stretch to that of the next. */
#define STRETCH_SEED 1000003

/* And of a trace to another one's. */
#define OTHER_SEED 68718952447u

static int make_room(struct csv_table *trace, const char *command, size_t rows)
{
    *trace = (struct csv_table){ .columns = COLUMNS };
    trace->values = malloc((rows ? rows : 1) * COLUMNS * sizeof *trace->values);
    return trace->values ? 0 : complain(command, "memory ran out");
}

/* Add a row. One that does not go on from the last one leaves a tick out. */
static double *add_row(struct csv_table *trace, int is_jump)
{
    double *row = trace->values + trace->rows * COLUMNS;
    row[0] = trace->rows ? row[-COLUMNS] + (is_jump ? 2.0 : 1.0) : 0.0;
    trace->rows++;
    return row;
}

/* Slide over a body for as many of the hand's ticks. Returns 0, or 2 after a message. */
static int slide(struct csv_table *trace, const struct scene *scene, const struct measure_hand *hand)
{
    struct csv_table slid;
    const int status = measure_trace_make(&slid, scene, hand);
    for (size_t i = 0; status == 0 && i < slid.rows; i++)
        memcpy(add_row(trace, i == 0) + 1, csv_table_row(&slid, i) + 1, (COLUMNS - 1) * sizeof *slid.values);
    if (status == 0)
        csv_table_free(&slid);
    return status;
}

/* m: how far the tool reaches from the point that is led; 0: not at all. */
static double reach_of(const struct scene *scene)
{
    double reach = scene->has_stylus ? scene->length : 0.0;
    for (uint32_t i = 0; !scene->has_stylus && i < scene->segment_count; i++)
        reach = fmax(reach, fmax(length(vec3_of(scene->segments[i].a)), length(vec3_of(scene->segments[i].b))));
    return reach;
}

int plan_trace_make(struct csv_table *trace, const struct scene *scene, uint64_t seed, uint64_t ticks, double rate,
                    double speed)
{
    struct csv_table slow;
    const double pace = 1.0 / (rate * HAND_TICK);
    const uint32_t stretches = 2 * scene->bodies.count;
    const uint64_t hand_ticks = (uint64_t)ceil((double)ticks * pace) + stretches;
    *trace = (struct csv_table){ .rows = 0 };
    int status = make_room(&slow, scene->command, (size_t)hand_ticks);
    for (uint32_t i = 0; status == 0 && i < stretches; i++) {
        const uint64_t from = hand_ticks * i / stretches, to = hand_ticks * (i + 1) / stretches;
        const struct measure_hand hand = { .body = i % scene->bodies.count,
                                           .seed = seed + (uint64_t)i * STRETCH_SEED,
                                           .ticks = (size_t)(to - from),
                                           .length = reach_of(scene),
                                           .speed = speed,
                                           .stands = !scene->has_stylus };
        status = slide(&slow, scene, &hand);
    }
    /* The hand moves at its own speed, whatever the rate. */
    if (status == 0)
        status = plan_trace_play(trace, scene->command, &slow, pace);
    csv_table_free(&slow);
    return status;
}

struct csv_table plan_trace_part(const struct csv_table *trace, size_t from, size_t to)
{
    struct csv_table part = *trace;
    part.values = trace->values + from * trace->columns;
    part.rows = to - from;
    return part;
}

/* Rows `from` to `to`, without a jump between them, from one end or from the other. */
static void play_stretch(struct csv_table *out, const struct csv_table *trace, size_t from, size_t to, double pace)
{
    const double last = (double)(to - 1 - from);
    for (double at = 0.0; at <= last; at += fabs(pace)) {
        const double place = pace > 0.0 ? at : last - at;
        const size_t before = from + (size_t)floor(place);
        const size_t after = before + 1 < to ? before + 1 : before;
        const double share = place - floor(place);
        const double *a = csv_table_row(trace, before), *b = csv_table_row(trace, after);
        double *row = add_row(out, at == 0.0);
        for (int k = 1; k < COLUMNS; k++)
            row[k] = a[k] + share * (b[k] - a[k]);
    }
}

int plan_trace_play(struct csv_table *out, const char *command, const struct csv_table *trace, double pace)
{
    size_t jumps = 0;
    for (size_t i = 0; i < trace->rows; i++)
        jumps += (size_t)trace_is_jump(trace, i);
    if (make_room(out, command, (size_t)((double)trace->rows / fabs(pace)) + 2 * jumps + 2))
        return 2;
    for (size_t from = 0, to; from < trace->rows; from = to) {
        for (to = from + 1; to < trace->rows && !trace_is_jump(trace, to); to++) {
        }
        play_stretch(out, trace, from, to, pace);
    }
    return 0;
}

int plan_trace_of(struct csv_table *out, const struct scene *scene, const struct plan *plan,
                  const struct csv_table *whole, int which)
{
    const size_t middle = whole->rows / 2;
    const struct csv_table second = plan_trace_part(whole, middle, whole->rows);
    if (which >= PLAN_OTHER)
        return plan_trace_make(out, scene, plan->motion.seed + OTHER_SEED * (uint64_t)(which - PLAN_BACKWARDS),
                               plan->motion.ticks / 2, plan->asked.rate, 0.0);
    if (which == PLAN_BACKWARDS)
        return plan_trace_play(out, scene->command, &second, -PLAN_SPEED_FACTOR);
    *out = which == PLAN_FIRST_HALF ? plan_trace_part(whole, 0, middle) : second;
    return 0;
}

void plan_trace_leave(struct csv_table *trace, int which)
{
    if (which >= PLAN_BACKWARDS)
        csv_table_free(trace);
}

double plan_trace_speed(const struct csv_table *trace, double dt)
{
    double fastest = 0.0;
    for (size_t i = 1; i < trace->rows; i++) {
        const double *before = csv_table_row(trace, i - 1), *now = csv_table_row(trace, i);
        if (trace_is_jump(trace, i))
            continue;
        for (int end = 1; end < COLUMNS; end += 3)
            fastest = fmax(fastest, length(sub(vec3_of(now + end), vec3_of(before + end))));
    }
    return fastest / dt;
}

void plan_scene_def(const struct plan *plan, struct scene_def *def)
{
    def->path = plan->scene;
    if (isnan(def->length))
        def->length = plan->length;
    if (isnan(def->radius))
        def->radius = plan->radius;
    if (isnan(def->force.friction))
        def->force.friction = plan->setting.friction;
    if (def->force.damping == 0.0)
        def->force.damping = plan->setting.damping;
}

void plan_meshes_of(struct plan *plan, const struct scene *scene)
{
    plan->mesh_count = scene->bodies.count;
    for (uint32_t i = 0; i < plan->mesh_count; i++) {
        const dpt_mesh *mesh = scene->bodies.body[i].mesh;
        const float *vertices;
        const uint32_t *corners, *numbers;
        uint32_t count;
        struct crc32 crc;
        crc32_init(&crc);
        dpt_mesh_get_vertices(mesh, &vertices, &count);
        plan->mesh[i].crc32 = crc32_more(&crc, 0, vertices, (size_t)count * 3 * sizeof *vertices);
        dpt_mesh_get_triangles(mesh, &corners, &numbers, &count);
        plan->mesh[i].crc32 = crc32_more(&crc, plan->mesh[i].crc32, corners, (size_t)count * 3 * sizeof *corners);
        plan->mesh[i].triangles = count;
    }
}

int plan_scene_check(const struct plan *plan, const struct scene *scene, const char *path)
{
    struct plan here = { .mesh_count = 0 };
    plan_meshes_of(&here, scene);
    if (here.mesh_count != plan->mesh_count)
        return complain(scene->command, "%s: its scene has %" PRIu32 " bodies, and %s has %" PRIu32, path,
                        plan->mesh_count, plan->scene, here.mesh_count);
    for (uint32_t i = 0; i < here.mesh_count; i++)
        if (here.mesh[i].crc32 != plan->mesh[i].crc32)
            return complain(scene->command, "%s: meshes[%" PRIu32 "]: another mesh than now in %s: plan again", path, i,
                            plan->scene);
    if (scene->file.bytes != plan->identity.bytes || scene->file.crc32 != plan->identity.crc32)
        return complain(scene->command, "%s: %s or its meshes have changed since: plan again", path, plan->scene);
    return 0;
}

/* How a judgement counts for a plan. What a setting does not ask for is as wrong as it can be. */
static void figures_of(struct plan_figures *figures, const struct judgement *judgement, const struct measure_run *run,
                       const struct plan_bench *bench)
{
    const uint64_t undecided = judgement->has_contact ? judgement->unknown : judgement->bounded + judgement->stale;
    *figures = (struct plan_figures){
        .ticks = run->ticks,
        .failed = run->failure == DPT_OK ? 0 : run->ticks - run->failed_tick,
        .distance_error = judgement->distance_error,
        .force_error = judgement->has_wrench ? judgement->wrench.max : bench->wrench_peak,
        .felt = judgement->wrench_ticks,
        .near_folds = judgement->near_fold_ticks,
        .unknown = undecided > bench->unknown ? undecided - bench->unknown : 0,
        .contacts = run->usage.contacts,
        .strip = run->usage.strip,
        .work = run->usage.work,
        .work_p999 = judgement->work.p999,
        .time_median = 1e-9 * judgement->whole_ns.median,
        .time_p999 = 1e-9 * judgement->whole_ns.p999,
        .bytes = run->world_bytes + run->body_bytes,
        .busy = run->busy,
    };
    for (size_t i = 0; i < run->ticks; i++)
        figures->work_total += run->tick[i].work;
}

static int run_and_judge(const struct plan_bench *bench, const struct measure_setting *setting, uint32_t passes,
                         struct measure_run *run, struct judgement *judgement)
{
    struct meter alone = { .began = 0 };
    struct plan_progress *progress = bench->progress;
    const double to = progress ? progress->at + 0.25 * (progress->until - progress->at) : 1.0;
    const struct measure_effort effort = { .passes = passes,
                                           .by_processor = 1,
                                           .meter = progress ? &progress->meter : &alone,
                                           .name = progress ? "plan" : "a setting",
                                           .begin = progress ? progress->at : 0.0,
                                           .end = to };
    int status = measure_run(run, bench->scene, bench->trace, setting, &effort);
    if (progress)
        progress->at = to;
    else
        meter_show(&alone, "", 1.0);
    const struct measure_run *reference = bench->reference.tick ? &bench->reference : run;
    if (status == 0 && measure_judge(judgement, run, reference))
        status = complain(bench->scene->command, "memory ran out");
    return status;
}

struct measure_setting plan_richest(const struct measure_setting *setting, const struct scene *scene)
{
    struct measure_setting richest = measure_setting_richest(setting, scene);
    richest.world.budget = PLAN_BUDGET_AMPLE;
    return richest;
}

int plan_bench_open(struct plan_bench *bench, const struct scene *scene, const struct csv_table *trace,
                    const struct measure_setting *setting)
{
    const struct measure_setting richest = plan_richest(setting, scene);
    struct judgement judgement;
    struct measure_run run;
    *bench = (struct plan_bench){ .progress = bench->progress, .scene = scene, .trace = trace };
    const int status = run_and_judge(bench, &richest, 1, &run, &judgement);
    bench->reference = run;
    if (status)
        return status;
    if (run.failure != DPT_OK)
        return complain(scene->command,
                        "the richest setting fails at tick %zu: %s. The scene needs another trace, "
                        "as run --record F.csv writes it",
                        run.failed_tick, dpt_result_text(run.failure));
    figures_of(&bench->richest, &judgement, &run, bench);
    bench->unknown = judgement.unknown;
    bench->wrench_peak = judgement.wrench_peak;
    bench->richest.unknown = 0;
    return 0;
}

int plan_bench_measure(const struct plan_bench *bench, const struct measure_setting *setting, uint32_t passes,
                       struct plan_figures *figures)
{
    struct judgement judgement;
    struct measure_run run;
    const int status = run_and_judge(bench, setting, passes, &run, &judgement);
    if (status == 0)
        figures_of(figures, &judgement, &run, bench);
    measure_run_free(&run);
    return status;
}

void plan_bench_close(struct plan_bench *bench)
{
    measure_run_free(&bench->reference);
}
