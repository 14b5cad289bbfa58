/* SPDX-License-Identifier: BSD-3-Clause */
#include "chart/chart_rows.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/return_if_error.h"
#include "cli/command_options.h"
#include "cli/law_name.h"
#include "platform/clock.h"
#include "run/replay_report.h"
#include "scene/setting_words.h"
#include "shape/mesh_size.h"

/* Of a step's sweeps, in the row that limits them. */
enum { SWEEP_UNITS = 200 };

/* Runs to judge by: of each law, and the one without a force. */
enum { TRUTHS = 4, TRUTH_WITHOUT_FORCE = 3 };

static struct chart_row *add_row(struct chart_rows *rows, const struct scene *scene, enum chart_part part,
                                 const struct measure_setting *setting, const char *name)
{
    static const uint32_t untils[] = { DPT_UNTIL_TRACK, DPT_UNTIL_CONTACT, DPT_UNTIL_RESPOND };
    if (rows->count == CHART_ROWS_MAX)
        return NULL;
    struct chart_row *row = &rows->row[rows->count];
    *row = (struct chart_row){ .part = part, .setting = *setting };
    row->setting.world.until = untils[part];
    if (measure_setting_fault(&row->setting, scene))
        return NULL;
    snprintf(row->name, sizeof row->name, "%s", name);
    rows->count++;
    return row;
}

static void add_budgets(struct chart_rows *rows, const struct scene *scene, enum chart_part part,
                        const struct measure_setting *base, const char *name)
{
    static const uint32_t budgets[][3] = { { 8, 32, 0 }, { 0, 0, 0 }, { 400, 800, 1600 } };
    for (int i = 0; i < 3; i++) {
        struct measure_setting setting = *base;
        char whole[CHART_NAME];
        setting.world.budget = budgets[part][i];
        snprintf(whole, sizeof whole, "%s at %u units", name, (unsigned)budgets[part][i]);
        if (setting.world.budget)
            add_row(rows, scene, part, &setting, whole);
    }
}

static void add_papers(struct chart_rows *rows, const struct scene *scene, enum chart_part part,
                       const struct measure_setting *base)
{
    static const uint32_t parts[][7] = { { 1, 2, 4, 8, 16, 64 }, { 1, 4, 16, 64 }, { 1, 4, 16, 64 } };
    struct measure_setting setting = *base;
    char name[CHART_NAME];
    setting.world.method = DPT_METHOD_PAPER;
    setting.world.law = DPT_LAW_POINT;
    for (const uint32_t *count = parts[part]; *count; count++) {
        setting.parts = *count;
        snprintf(name, sizeof name, "paper in %u part%s", (unsigned)*count, *count == 1 ? "" : "s");
        add_row(rows, scene, part, &setting, name);
    }
}

/* Narrower kernels than the one that is used: the same answers, other times. */
static void add_kernels(struct chart_rows *rows, const struct scene *scene, const struct measure_setting *base)
{
    static const uint32_t kernels[] = { DPT_KERNEL_AVX2, DPT_KERNEL_SSE2, DPT_KERNEL_SCALAR };
    const uint32_t best = dpt_kernel_best();
    char name[CHART_NAME];
    for (size_t i = 0; i < sizeof kernels / sizeof *kernels; i++) {
        struct measure_setting setting = *base;
        setting.world.kernel = kernels[i];
        snprintf(name, sizeof name, "exact by %s", dpt_kernel_name(kernels[i]));
        const int is_here = kernels[i] == DPT_KERNEL_SCALAR || best <= DPT_KERNEL_AVX512;
        if (is_here && kernels[i] < best)
            add_row(rows, scene, CHART_PAIR, &setting, name);
    }
}

static void list_pairs(struct chart_rows *rows, const struct scene *scene, const struct measure_setting *base)
{
    struct measure_setting setting = *base;
    setting.world.law = DPT_LAW_POINT;
    add_row(rows, scene, CHART_PAIR, &setting, "exact");
    add_kernels(rows, scene, &setting);
    add_budgets(rows, scene, CHART_PAIR, &setting, "exact");
    setting.world.certificate_bytes = 0;
    add_row(rows, scene, CHART_PAIR, &setting, "exact without cache");
    setting = *base;
    setting.world.law = DPT_LAW_POINT;
    setting.world.method = DPT_METHOD_TREE;
    add_row(rows, scene, CHART_PAIR, &setting, "tree");
    setting.world.method = DPT_METHOD_BRUTE;
    add_row(rows, scene, CHART_PAIR, &setting, "brute force");
    add_papers(rows, scene, CHART_PAIR, base);
    setting.world.method = DPT_METHOD_PAPER;
    setting.one_step = 1;
    add_row(rows, scene, CHART_PAIR, &setting, "paper one step");
}

static void list_contacts(struct chart_rows *rows, const struct scene *scene, const struct measure_setting *base)
{
    struct measure_setting setting = *base;
    setting.world.law = DPT_LAW_POINT;
    add_row(rows, scene, CHART_CONTACT, &setting, "exact");
    setting.world.max_contacts = 0;
    add_row(rows, scene, CHART_CONTACT, &setting, "exact depth alone");
    setting.world.max_contacts = base->world.max_contacts;
    setting.world.method = DPT_METHOD_TREE;
    add_row(rows, scene, CHART_CONTACT, &setting, "tree");
    add_papers(rows, scene, CHART_CONTACT, base);
}

/* What gives way may be stepped otherwise, or not give way. */
static void list_soft(struct chart_rows *rows, const struct scene *scene, const struct measure_setting *base,
                      const char *law)
{
    const struct scene_body *soft = NULL;
    char name[CHART_NAME];
    for (uint32_t i = 0; !soft && i < scene->bodies.count; i++)
        soft = scene_body_is_soft(&scene->bodies.body[i]) ? &scene->bodies.body[i] : NULL;
    if (!soft)
        return;
    for (uint32_t i = 0; integrator_words[i]; i++) {
        struct measure_setting setting = *base;
        setting.integrator = (int32_t)i;
        snprintf(name, sizeof name, "%s %s", law, integrator_words[i]);
        if (i != soft->integrator)
            add_row(rows, scene, CHART_FORCE, &setting, name);
    }
    struct measure_setting setting = *base;
    setting.rigid = UINT64_MAX;
    snprintf(name, sizeof name, "%s rigid", law);
    add_row(rows, scene, CHART_FORCE, &setting, name);
}

static void add_sweep_budget(struct chart_rows *rows, const struct scene *scene, const struct measure_setting *base)
{
    struct measure_setting setting = *base;
    char name[CHART_NAME];
    setting.world.sweep_budget = SWEEP_UNITS;
    snprintf(name, sizeof name, "proxy sweeps at %d units", SWEEP_UNITS);
    add_row(rows, scene, CHART_FORCE, &setting, name);
}

static void list_forces(struct chart_rows *rows, const struct scene *scene, const struct measure_setting *base,
                        uint32_t law)
{
    struct measure_setting setting = *base;
    char name[CHART_NAME];
    setting.world.law = law;
    add_row(rows, scene, CHART_FORCE, &setting, law_name(law));
    add_budgets(rows, scene, CHART_FORCE, &setting, law_name(law));
    if (law == DPT_LAW_PROXY)
        add_sweep_budget(rows, scene, &setting);
    list_soft(rows, scene, &setting, law_name(law));
    setting.world.max_contacts = 0;
    snprintf(name, sizeof name, "%s without contacts", law_name(law));
    add_row(rows, scene, CHART_FORCE, &setting, name);
    setting.world.method = DPT_METHOD_TREE;
    snprintf(name, sizeof name, "%s by tree", law_name(law));
    add_row(rows, scene, CHART_FORCE, &setting, name);
    if (law == DPT_LAW_POINT)
        add_papers(rows, scene, CHART_FORCE, base);
}

void chart_rows_list(struct chart_rows *rows, const struct scene *scene, const struct measure_setting *base,
                     enum chart_part last)
{
    static const uint32_t laws[] = { DPT_LAW_PROXY, DPT_LAW_BED, DPT_LAW_POINT };
    memset(rows, 0, sizeof *rows);
    list_pairs(rows, scene, base);
    if (last >= CHART_CONTACT)
        list_contacts(rows, scene, base);
    for (size_t i = 0; last >= CHART_FORCE && i < sizeof laws / sizeof *laws; i++)
        list_forces(rows, scene, base, laws[i]);
}

/* The run that judges a row. */
static uint32_t truth_of(const struct chart_row *row)
{
    return row->part == CHART_FORCE ? row->setting.world.law : TRUTH_WITHOUT_FORCE;
}

static int measure_row(struct chart_row *row, const struct scene *scene, const struct csv_table *trace,
                       const struct measure_run *truth, const struct measure_effort *effort)
{
    struct measure_run run;
    int status = measure_run(&run, scene, trace, &row->setting, effort);
    row->failure = run.failure;
    row->world_bytes = run.world_bytes;
    row->body_bytes = run.body_bytes;
    if (status == 0 && measure_judge(&row->judged, &run, truth))
        status = complain(scene->command, "memory ran out");
    measure_run_free(&run);
    return status;
}

/* Brute force has looked at some ticks of the run that it is judged by. */
static int judge_brute(struct chart_row *row, const struct measure_check *check)
{
    struct judgement *judged = &row->judged;
    if (!check->ticks) {
        row->failure = DPT_E_UNSUPPORTED;
        return 0;
    }
    double *ns = malloc(check->ticks * sizeof *ns);
    if (!ns)
        return -1;
    for (size_t i = 0; i < check->ticks; i++)
        ns[i] = check->ns[i];
    *judged = (struct judgement){ .ticks = check->ticks,
                                  .exact = check->ticks,
                                  .wrong = check->wrong,
                                  .distance_error = check->error,
                                  .ns = judgement_spread_of(ns, check->ticks),
                                  .first_ns = check->ns[0] };
    judged->whole_ns = judged->ns;
    judged->work.median = judged->work.p99 = judged->work.max = check->work;
    free(ns);
    return 0;
}

/* Returns 0, or -1 if memory ran out. */
static int note_truth(struct chart_truth *truth, const struct measure_run *run)
{
    truth->check = run->check;
    truth->check.ns = NULL;
    truth->kernel = run->kernel;
    truth->diagonal = run->diagonal;
    truth->mesh_bytes = run->mesh_bytes;
    truth->ticks = run->ticks;
    truth->distance = malloc(run->ticks * sizeof *truth->distance);
    for (size_t i = 0; truth->distance && i < run->ticks; i++) {
        truth->distance[i] = run->tick[i].distance;
        truth->crossings += run->tick[i].distance == 0.0;
    }
    return truth->distance ? 0 : -1;
}

/* What this run judges: itself, once, and its rows, so that no more than two are held at a time. */
static int measure_by_truth(struct chart_rows *rows, uint32_t index, const struct scene *scene,
                            const struct csv_table *trace, const struct measure_effort *all, int *done)
{
    struct measure_effort of_row = *all;
    const double share = (all->end - all->begin) / rows->count;
    const int is_first = rows->truth.ticks == 0;
    const struct measure_effort once = { .passes = 1,
                                         .searches = all->passes,
                                         .every = is_first ? measure_check_every(scene, trace) : 0,
                                         .meter = all->meter,
                                         .name = all->name,
                                         .begin = all->begin + share * *done,
                                         .end = all->begin + share * *done };
    struct measure_run truth = { .tick = NULL };
    int status = 0;
    for (int i = 0; status == 0 && i < rows->count; i++) {
        struct chart_row *row = &rows->row[i];
        if (row->is_peer || truth_of(row) != index)
            continue;
        if (!truth.tick) {
            struct measure_setting richest = measure_setting_richest(&row->setting, scene);
            if (index == TRUTH_WITHOUT_FORCE)
                richest.world.until = DPT_UNTIL_CONTACT;
            status = measure_run(&truth, scene, trace, &richest, &once);
            if (status == 0 && is_first && note_truth(&rows->truth, &truth))
                status = complain(scene->command, "memory ran out");
        }
        of_row.begin = all->begin + share * *done;
        of_row.end = all->begin + share * ++*done;
        if (status == 0 && row->setting.world.method != DPT_METHOD_BRUTE)
            status = measure_row(row, scene, trace, &truth, &of_row);
        else if (status == 0 && judge_brute(row, &truth.check))
            status = complain(scene->command, "memory ran out");
        if (truth.failure != DPT_OK)
            row->failure = truth.failure;
    }
    measure_run_free(&truth);
    return status;
}

int chart_rows_measure(struct chart_rows *rows, const struct scene *scene, const struct csv_table *trace,
                       const struct measure_effort *effort)
{
    int status = 0, done = 0;
    for (uint32_t i = 0; status == 0 && i < TRUTHS; i++)
        status = measure_by_truth(rows, (i + TRUTH_WITHOUT_FORCE) % TRUTHS, scene, trace, effort, &done);
    return status;
}

void chart_rows_free(struct chart_rows *rows)
{
    free(rows->truth.distance);
    rows->truth.distance = NULL;
}

enum { PASSES = 3, REFITS = 9 };

/* Of its size: by so much the body grows in each of them. */
#define GROWTH 2e-3

/* Of the diagonal: so far above it is the tool. */
#define ABOVE 0.05

static double seconds_since(uint64_t begin)
{
    return 1e-9 * (double)(clock_now() - begin);
}

static dpt_result compile_again(struct chart_body *measured, const dpt_mesh *mesh)
{
    const float *xyz;
    const uint32_t *corners, *numbers;
    uint32_t vertices, triangles;
    dpt_compile_def def;
    dpt_result result = DPT_OK;
    dpt_mesh_get_vertices(mesh, &xyz, &vertices);
    dpt_mesh_get_triangles(mesh, &corners, &numbers, &triangles);
    double *places = malloc((size_t)vertices * 3 * sizeof *places);
    if (!places)
        return DPT_E_MEMORY;
    for (size_t i = 0; i < (size_t)vertices * 3; i++)
        places[i] = xyz[i];
    dpt_compile_def_init(&def);
    for (int pass = 0; result == DPT_OK && pass < PASSES; pass++) {
        dpt_compiled compiled = { .bytes = NULL };
        dpt_diag diag = { .size = sizeof diag };
        const uint64_t begin = clock_now();
        result = dpt_compile_arrays(places, vertices, corners, triangles, &def, &compiled, &diag);
        measured->compile = fmin(measured->compile, seconds_since(begin));
        dpt_compiled_free(&compiled);
    }
    free(places);
    return result;
}

static dpt_result add_again(struct chart_body *measured, dpt_world *world, const dpt_mesh *mesh)
{
    for (int pass = 0; pass < PASSES; pass++) {
        dpt_body body;
        const uint64_t begin = clock_now();
        DPT_TRY(dpt_body_add(world, mesh, NULL, &body));
        measured->add = fmin(measured->add, seconds_since(begin));
        DPT_TRY(dpt_body_remove(world, body));
    }
    return DPT_OK;
}

/* A tool above the box, and a body that grows about its middle. */
static dpt_result refit(struct chart_body *measured, struct scene_stage *stage, const dpt_mesh *mesh)
{
    dpt_deformable_def def;
    dpt_mesh_info info = { .size = sizeof info };
    dpt_segment needle = { .radius = 0.0 };
    dpt_body body;
    const float *xyz;
    uint32_t count;
    dpt_mesh_get_info(mesh, &info);
    dpt_mesh_get_vertices(mesh, &xyz, &count);
    for (int k = 0; k < 3; k++) {
        needle.a[k] = 0.5 * (info.box_min[k] + info.box_max[k]);
        needle.b[k] = k ? needle.a[k] : info.box_max[k];
    }
    needle.a[2] = needle.b[2] = info.box_max[2] + ABOVE * box_diagonal(&info);
    dpt_deformable_def_init(&def);
    def.mesh = mesh;
    measured->deform_bytes = dpt_deformable_bytes(&def);
    void *block = malloc(measured->deform_bytes);
    float *moved = malloc((size_t)count * 3 * sizeof *moved);
    dpt_result result = block && moved ? DPT_OK : DPT_E_MEMORY;
    if (result == DPT_OK)
        result = dpt_body_add_deformable(stage->world, block, measured->deform_bytes, &def, &body);
    if (result == DPT_OK)
        result = scene_stage_add_tool(stage, &needle, 1, NULL, 0);
    if (result == DPT_OK)
        result = dpt_world_step(stage->world, 1e-3, NULL);
    double took[REFITS] = { 0.0 };
    for (int pass = 0; result == DPT_OK && pass < REFITS; pass++) {
        for (size_t i = 0; i < (size_t)count * 3; i++) {
            const double middle = 0.5 * (info.box_min[i % 3] + info.box_max[i % 3]);
            moved[i] = (float)(middle + (1.0 + GROWTH * (pass + 1)) * (xyz[i] - middle));
        }
        const uint64_t begin = clock_now();
        result = dpt_body_set_vertices(stage->world, body, 0, count, moved, -1.0);
        if (result == DPT_OK)
            result = dpt_world_step(stage->world, 1e-3, NULL);
        took[pass] = seconds_since(begin);
    }
    sort_numbers(took, REFITS);
    measured->refit = percentile(took, REFITS, 0.5);
    free(moved);
    free(block);
    return result;
}

static dpt_result measure_in_world(struct chart_body *measured, struct scene_stage *stage, const dpt_world_def *def,
                                   const dpt_mesh *mesh)
{
    DPT_TRY(scene_stage_open(stage, def));
    DPT_TRY(compile_again(measured, mesh));
    DPT_TRY(add_again(measured, stage->world, mesh));
    return refit(measured, stage, mesh);
}

int chart_body_measure(struct chart_body *measured, const struct scene *scene, uint32_t body)
{
    const dpt_mesh *mesh = scene->bodies.body[body].mesh;
    dpt_mesh_info info = { .size = sizeof info };
    struct scene_stage stage = { .world = NULL };
    dpt_world_def def;
    dpt_mesh_get_info(mesh, &info);
    *measured = (struct chart_body){
        .triangles = info.triangles, .mesh_bytes = info.bytes, .compile = HUGE_VAL, .add = HUGE_VAL
    };
    dpt_world_def_init(&def);
    def.until = DPT_UNTIL_TRACK;
    const dpt_result result = measure_in_world(measured, &stage, &def, mesh);
    scene_stage_close(&stage);
    return result == DPT_OK ? 0 : complain(scene->command, "%s", dpt_result_text(result));
}
