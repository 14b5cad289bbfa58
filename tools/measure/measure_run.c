/* SPDX-License-Identifier: BSD-3-Clause */
#include "measure/measure_run.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/return_if_error.h"
#include "platform/clock.h"
#include "shape/mesh_size.h"

/* Its box is wider than the mesh's by this many diagonals: what gives way stays within. */
#define FAT_MARGIN 4.0

static dpt_result add_body(struct measure_brute *brute, const struct scene_body *body, uint32_t i)
{
    dpt_deformable_def def;
    dpt_mesh_info info = { .size = sizeof info };
    if (!body->springs)
        return dpt_body_add(brute->stage.world, body->mesh, &body->pose, &brute->id[i]);
    dpt_deformable_def_init(&def);
    dpt_mesh_get_info(body->mesh, &info);
    def.mesh = body->mesh;
    def.pose = &body->pose;
    for (int k = 0; k < 3; k++) {
        def.box_min[k] = info.box_min[k] - FAT_MARGIN * box_diagonal(&info);
        def.box_max[k] = info.box_max[k] + FAT_MARGIN * box_diagonal(&info);
    }
    const size_t bytes = dpt_deformable_bytes(&def);
    brute->body_block[i] = malloc(bytes);
    if (!brute->body_block[i])
        return DPT_E_MEMORY;
    return dpt_body_add_deformable(brute->stage.world, brute->body_block[i], bytes, &def, &brute->id[i]);
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
    DPT_TRY(scene_stage_open(&brute->stage, &def));
    for (uint32_t i = 0; i < bodies->count; i++)
        DPT_TRY(add_body(brute, &bodies->body[i], i));
    return scene_stage_add_tool(&brute->stage, tool->segments, brute->segments, NULL, 0);
}

void measure_brute_close(struct measure_brute *brute)
{
    scene_stage_close(&brute->stage);
    for (uint32_t i = 0; i < brute->body_count; i++)
        free(brute->body_block[i]);
}

/* A world that was reset searches again, though nothing has moved. */
static dpt_result search(struct measure_brute *brute)
{
    dpt_step step = { .size = sizeof step };
    brute->ns = UINT32_MAX;
    for (uint32_t i = 0; i < brute->searches; i++) {
        dpt_world_reset(brute->stage.world);
        const uint64_t begin = clock_now();
        DPT_TRY(dpt_world_step(brute->stage.world, 1e-3, &step));
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
        DPT_TRY(dpt_body_set_vertices(brute->stage.world, brute->id[i], 0, count, vertices, -1.0));
    }
    DPT_TRY(dpt_tool_set_segments(brute->stage.world, brute->stage.tool, tool->segments, brute->segments));
    DPT_TRY(search(brute));
    dpt_hit nearest = DPT_HIT_INIT;
    dpt_tool_get_hit(world, id, &nearest);
    *error = 0.0;
    for (uint32_t i = 0; i < brute->segments; i++) {
        dpt_hit hit = DPT_HIT_INIT, true_hit = DPT_HIT_INIT;
        dpt_tool_get_segment_hit(world, id, i, &hit);
        DPT_TRY(dpt_tool_get_segment_hit(brute->stage.world, brute->stage.tool, i, &true_hit));
        *error = fmax(*error, off_by(&hit, nearest.segment, true_hit.distance));
    }
    return DPT_OK;
}

/* Of the diagonal: by how much distances may differ and be the same. */
#define TOLERANCE 1e-9

/* Pairs of a segment and a triangle that brute force looks at in about a second. */
#define CHECKED_PAIRS 1.2e7

/* A world with the scene's bodies and its tool, and another one by which it is checked. */
struct measured {
    struct scene_stage stage;
    struct scene_bodies bodies; /* the scene's, with what the setting changes; memory in the world is their own */
    struct measure_tool tool;
    struct measure_brute brute;
    int by_processor; /* as in measure_effort */
};

static int has_soft(const struct scene_bodies *bodies)
{
    int is_soft = 0;
    for (uint32_t i = 0; i < bodies->count; i++)
        is_soft |= scene_body_is_soft(&bodies->body[i]);
    return is_soft;
}

/* Physics apart from the ticks: before the bodies are added. Returns 0, or 2 after a message. */
static int choose_physics(struct measured *measured, const struct measure_run *run, const struct scene *scene)
{
    const double rate = run->setting.physics;
    dpt_host_error error = { .size = sizeof error };
    if (!(rate > 0.0) || !has_soft(&measured->bodies))
        return 0;
    dpt_result result = scene_physics_choose(&measured->bodies, "the scene", "--physics", rate, &error);
    if (result == DPT_OK)
        result = scene_physics_check_loop("--physics", rate, 1.0 / run->setting.dt, &error);
    return complain_of(scene->command, result, &error);
}

/* Create the world, with the scene's bodies and its tool. */
static dpt_result fill_world(struct measured *measured, const struct measure_run *run, const struct scene *scene,
                             const dpt_world_def *def)
{
    struct scene_stage *stage = &measured->stage;
    const struct measure_setting *setting = &run->setting;
    const struct force_options force = { .law = setting->world.law,
                                         .stiffness = setting->world.stiffness,
                                         .friction = setting->friction,
                                         .damping = setting->damping };
    const double physics = has_soft(&measured->bodies) ? setting->physics : 0.0;
    DPT_TRY(scene_stage_open(stage, def));
    DPT_TRY(scene_stage_add_bodies(stage, &measured->bodies, &force, physics));
    DPT_TRY(scene_stage_add_tool(stage, scene->segments, scene->segment_count, &force, setting->lock_rotation));
    return scene->tips.count ? scene_tips_add(&scene->tips, stage->world, stage->tool) : DPT_OK;
}

/* Returns 0, or 2 after a message. */
static int measured_open(struct measured *measured, struct measure_run *run, const struct scene *scene)
{
    const struct measure_setting *setting = &run->setting;
    const dpt_baseline_def baseline = { .size = sizeof baseline,
                                        .parts = setting->parts,
                                        .one_step = setting->one_step };
    dpt_world_def def = setting->world;
    memset(measured, 0, sizeof *measured);
    measured->bodies = scene->bodies;
    measure_setting_change(setting, &measured->bodies);
    measure_tool_begin(&measured->tool, scene);
    def.max_bodies = scene->bodies.count;
    def.max_tools = 1;
    def.max_segments = scene->segment_count;
    def.max_tips = scene->tips.count;
    def.max_channels = scene_bodies_channels(&scene->bodies);
    def.baseline = &baseline;
    if (choose_physics(measured, run, scene))
        return 2;
    const dpt_result result = fill_world(measured, run, scene, &def);
    run->world_bytes = measured->stage.bytes;
    return result == DPT_OK ? 0 : complain(scene->command, "%s", dpt_result_text(result));
}

static void measured_close(struct measured *measured)
{
    measure_brute_close(&measured->brute);
    scene_stage_close(&measured->stage);
    scene_bodies_leave(&measured->bodies);
}

/* By the clock, and of the processor where that is asked for. */
struct moment {
    uint64_t clock, thread;
};

static struct moment moment_now(const struct measured *measured)
{
    const uint64_t thread = measured->by_processor ? clock_thread() : 0;
    return (struct moment){ .clock = clock_now(), .thread = thread };
}

/* ns: of a tick that nothing interrupts the clock's time is the exact one, as asking for the processor's takes some itself. */
static uint32_t ns_since(const struct measured *measured, struct moment begin)
{
    const uint64_t clock = clock_now() - begin.clock;
    const uint64_t thread = measured->by_processor ? clock_thread() - begin.thread : clock;
    const uint64_t ns = thread < clock ? thread : clock;
    return ns < UINT32_MAX ? (uint32_t)ns : UINT32_MAX;
}

static void read_answers(const struct measured *measured, const dpt_step *step, struct measure_tick *tick)
{
    dpt_hit hit = DPT_HIT_INIT;
    dpt_tool_get_hit(measured->stage.world, measured->stage.tool, &hit);
    tick->distance = hit.distance;
    tick->gap = hit.flags & DPT_HIT_FLAG_GAP ? hit.gap : NAN;
    tick->work = step->work;
    tick->status = (uint8_t)hit.status;
    tick->contact = (uint8_t)hit.contact;
    tick->hit_flags = (uint8_t)hit.flags;
    tick->is_jump = (uint8_t)measured->tool.is_jump;
    tick->contacts = (uint16_t)(step->contacts < UINT16_MAX ? step->contacts : UINT16_MAX);
}

/* What gives way has stepped: what is solved together with it is felt from then on. */
static void read_force(const struct measured *measured, struct measure_tick *tick)
{
    dpt_force_info force = { .size = sizeof force };
    dpt_tool_get_force_info(measured->stage.world, measured->stage.tool, &force);
    measure_tool_weigh(&measured->tool, &force.wrench, tick->wrench);
    tick->lag = force.lag;
    tick->force_reason = (uint8_t)force.reason;
    tick->force_flags = (uint8_t)force.flags;
}

static dpt_result check(struct measured *measured, struct measure_run *run, size_t row)
{
    struct measure_check *check = &run->check;
    double error;
    if (!check->every || row % check->every)
        return DPT_OK;
    if (!row)
        DPT_TRY(measure_brute_open(&measured->brute, &measured->bodies, &measured->tool, run->check.searches));
    DPT_TRY(measure_brute_compare(&measured->brute, &measured->bodies, &measured->tool, measured->stage.world,
                                  measured->stage.tool, &error));
    check->ns[check->ticks++] = measured->brute.ns;
    check->work = measured->brute.work > check->work ? measured->brute.work : check->work;
    check->wrong += error <= check->tolerance ? 0 : 1;
    check->error = fmax(check->error, error);
    return DPT_OK;
}

/* A step of the world and of what gives way, and what both took. */
static dpt_result step(struct measured *measured, struct measure_run *run, size_t row, int is_first)
{
    const double dt = run->setting.dt;
    struct measure_tick *tick = &run->tick[row];
    dpt_step told = { .size = sizeof told };
    struct moment begin = moment_now(measured);
    scene_bodies_begin_tick(&measured->bodies, row);
    DPT_TRY(scene_stage_step_world(&measured->stage, dt, &told));
    const uint32_t ns = ns_since(measured, begin);
    if (is_first) {
        read_answers(measured, &told, tick);
        DPT_TRY(check(measured, run, row));
    }
    begin = moment_now(measured);
    DPT_TRY(scene_stage_step_soft(&measured->stage, dt));
    for (uint32_t i = 0; measured->bodies.is_held && i < measured->bodies.count; i++)
        DPT_TRY(measured->bodies.body[i].held_why);
    const uint32_t soft_ns = measured->bodies.steps || measured->stage.physics ? ns_since(measured, begin) : 0;
    if (is_first)
        read_force(measured, tick);
    tick->ns = is_first || ns < tick->ns ? ns : tick->ns;
    tick->soft_ns = is_first || soft_ns < tick->soft_ns ? soft_ns : tick->soft_ns;
    return DPT_OK;
}

static void run_pass(struct measured *measured, struct measure_run *run, const struct csv_table *trace,
                     const struct measure_effort *effort, uint32_t pass)
{
    for (size_t row = 0; row < run->ticks; row++) {
        const double done = ((double)pass + (double)row / (double)run->ticks) / effort->passes;
        if (effort->meter && row % 64 == 0)
            meter_show(effort->meter, effort->name, effort->begin + done * (effort->end - effort->begin));
        measure_tool_lead(&measured->tool, trace, row);
        dpt_result result = measure_tool_move(&measured->tool, measured->stage.world, measured->stage.tool);
        if (result == DPT_OK)
            result = step(measured, run, row, pass == 0);
        if (result == DPT_OK)
            continue;
        run->failure = result;
        run->failed_tick = row;
        memset(run->tick + row, 0, (run->ticks - row) * sizeof *run->tick);
        return;
    }
}

static void note_memory(const struct measured *measured, struct measure_run *run)
{
    dpt_world_info used = { .size = sizeof used };
    run->body_bytes = run->mesh_bytes = 0;
    for (uint32_t i = 0; i < measured->bodies.count; i++) {
        const struct scene_body *body = &measured->bodies.body[i];
        dpt_mesh_info info = { .size = sizeof info };
        dpt_mesh_get_info(body->mesh, &info);
        run->mesh_bytes += info.bytes;
        run->body_bytes += body->block_bytes + body->springs_bytes;
        run->diagonal = fmax(run->diagonal, box_diagonal(&info));
    }
    run->check.tolerance = TOLERANCE * run->diagonal;
    dpt_world_get_info(measured->stage.world, &used);
    run->kernel = used.kernel;
}

int measure_run(struct measure_run *run, const struct scene *scene, const struct csv_table *trace,
                const struct measure_setting *setting, const struct measure_effort *effort)
{
    const char *fault = measure_setting_fault(setting, scene);
    memset(run, 0, sizeof *run);
    run->setting = *setting;
    run->setting.world.baseline = NULL;
    run->check.searches = effort->searches ? effort->searches : 1;
    /* Where a tool moves triangles out of its way, they lie elsewhere after the step than it found them. */
    run->check.every = scene_bodies_displace(&scene->bodies) ? 0 : effort->every;
    run->usage.size = sizeof run->usage;
    if (fault)
        return complain(scene->command, "%s", fault);
    struct measured *measured = calloc(1, sizeof *measured);
    run->tick = calloc(trace->rows, sizeof *run->tick);
    run->ticks = trace->rows;
    if (run->check.every)
        run->check.ns = calloc(trace->rows / run->check.every + 1, sizeof *run->check.ns);
    const int has_room = measured && run->tick && (run->check.ns || !run->check.every);
    int status = has_room ? 0 : complain(scene->command, "memory ran out");
    uint64_t taken = 0, used = 0; /* by the clock, and of the processor */
    for (uint32_t pass = 0; status == 0 && pass < effort->passes; pass++) {
        status = measured_open(measured, run, scene);
        if (status == 0) {
            const uint64_t begin = clock_now(), begin_thread = clock_thread();
            note_memory(measured, run);
            measured->by_processor = effort->by_processor;
            run_pass(measured, run, trace, effort, pass);
            taken += clock_now() - begin;
            used += clock_thread() - begin_thread;
            dpt_world_get_info(measured->stage.world, &run->usage);
        }
        measured_close(measured);
        if (run->failure != DPT_OK)
            break;
    }
    run->busy = used ? fmax(1.0, (double)taken / (double)used) : 1.0;
    free(measured);
    return status;
}

void measure_run_free(struct measure_run *run)
{
    free(run->tick);
    free(run->check.ns);
    run->tick = NULL;
    run->check.ns = NULL;
    run->ticks = 0;
}

size_t measure_check_every(const struct scene *scene, const struct csv_table *trace)
{
    double triangles = 0.0;
    for (uint32_t i = 0; i < scene->bodies.count; i++) {
        dpt_mesh_info info = { .size = sizeof info };
        dpt_mesh_get_info(scene->bodies.body[i].mesh, &info);
        triangles += info.triangles;
    }
    const double every = ceil(triangles * scene->segment_count * (double)trace->rows / CHECKED_PAIRS);
    return (size_t)fmax(1.0, fmin(every, (double)trace->rows));
}

double measure_wrench_size(const double wrench[6])
{
    double square = 0.0;
    for (int k = 0; k < 6; k++)
        square += wrench[k] * wrench[k];
    return sqrt(square);
}

const char *const tick_histogram_words[TICK_HISTOGRAMS] = { "ns", "work" };

/* `steps` to a doubling, rounded to whole numbers, each of them once. */
static const struct {
    double first;
    int steps, doublings;
} bins[TICK_HISTOGRAMS] = { { 16.0, 8, 16 }, { 1.0, 4, 16 } };

int tick_histogram_edges(enum tick_histogram_of of, double edges[TICK_HISTOGRAM_EDGES])
{
    int count = 0;
    for (int i = 0; i <= bins[of].steps * bins[of].doublings; i++) {
        const double edge = floor(bins[of].first * pow(2.0, (double)i / bins[of].steps) + 0.5);
        if (!count || edge > edges[count - 1])
            edges[count++] = edge;
    }
    return count;
}

struct tick_histogram tick_histogram_count(enum tick_histogram_of of, const double *sorted, size_t count)
{
    double edges[TICK_HISTOGRAM_EDGES];
    struct tick_histogram histogram = { .bin = { 0 } };
    const int edge_count = tick_histogram_edges(of, edges);
    int bin = 0;
    for (size_t i = 0; i < count; i++) {
        while (bin < edge_count && sorted[i] >= edges[bin])
            bin++;
        histogram.bin[bin]++;
    }
    return histogram;
}
