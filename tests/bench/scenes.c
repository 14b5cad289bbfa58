/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The scenes of the paper's Table 1.
 *
 *     scenes DIR [TICKS]      prints CSV, a row a scene, method and stage (play.h); writes what the peers need into DIR
 *
 * The stylus comes down on the first body, goes to and fro by 1 cm at 1 Hz and up and down by 3 mm at 0.7 Hz, so that
 * it presses half of the time. In the cloth's scene it is the sword: the cloth falls on to it, and it rests. First the scene runs with what a world
 * does by default, its force and its physics in one thread: the rows `scene`, until `respond` for dpt_world_step, and
 * `physics` for dpt_body_step_springs as well. The motion of tool and vertices is recorded in the world's frame,
 * vertices in float, and played through all methods: these rows are play.c's. DIR/NAME.scene has the distances of the
 * scene itself, as OUT.csv has them, but without names of triangles.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench/play.h"
#include "bench/timing.h"
#include "dynpoint/compile.h"
#include "scene/scene_list.h"
#include "scene/shape.h"

enum { BODIES = LISTED_BODIES_MAX, TICKS_MAX = 10000 };

static const char *const names[] = { "membrane", "cloth", "laparoscopy", "liver" };

struct body {
    dpt_compiled compiled, placed_compiled;
    const dpt_mesh *mesh;
    const dpt_mesh *placed; /* of a rigid body: in the world's frame */
    dpt_mesh_info info;
};

struct soft {
    void *block, *springs_block;
    dpt_springs *springs;
    dpt_body id;
};

struct stage {
    void *block;
    dpt_world *world;
    dpt_tool tool;
    struct soft soft[BODIES];
};

struct bench {
    const struct listed_scene *scene;
    struct body body[BODIES];
    int bodies;
    uint32_t triangles, springs;
    double touch[3];
    int ticks;
    double *ends; /* 6 a tick */
    double *distances;
    float *record; /* the positions of the first body's vertices in the world's frame, where it is soft */
    uint32_t vertices;
};

/* The paper's wall lies over the organs, with its hole over the liver; that of the scene is inclined round its port. */
static dpt_pose pose_of(const struct listed_body *listed)
{
    return strcmp(listed->shape, "wall")
               ? listed->pose
               : (dpt_pose){ { 0.0, 0.0, 0.0 }, { 0.70710678118654752, -0.70710678118654752, 0.0, 0.0 } };
}

static void fail(const char *what)
{
    fprintf(stderr, "scenes: %s\n", what);
    exit(2);
}

static void *array(size_t bytes)
{
    void *made = malloc(bytes);
    if (!bytes || !made)
        fail("no memory");
    return made;
}

static void compile(const struct shape *shape, const dpt_compile_def *def, dpt_compiled *compiled,
                    const dpt_mesh **mesh)
{
    if (dpt_compile_arrays(shape->vertices, shape->vertex_count, shape->corners, shape->triangle_count, def, compiled,
                           NULL) != DPT_OK ||
        dpt_mesh_open(compiled->bytes, compiled->size, mesh) != DPT_OK)
        fail("a body cannot be compiled");
}

/* From the frame of a body into the world's; in place. */
static void to_world(const dpt_pose *pose, double x[3])
{
    const double w = pose->orientation[0], *v = pose->orientation + 1;
    double t[3], out[3];
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        t[k] = 2.0 * (v[i] * x[j] - v[j] * x[i]);
    }
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        out[k] = x[k] + w * t[k] + v[i] * t[j] - v[j] * t[i] + pose->position[k];
    }
    memcpy(x, out, sizeof out);
}

static void make_body(struct bench *bench, const struct listed_body *listed)
{
    struct body *body = &bench->body[bench->bodies++];
    struct shape shape;
    shape_reason reason;
    dpt_compile_def def;
    dpt_compile_def_init(&def);
    def.springs = listed->springs.kind ? &listed->springs : NULL;
    if (shape_make(listed->shape, listed->triangles, 0, &shape, reason))
        fail(reason);
    compile(&shape, &def, &body->compiled, &body->mesh);
    body->info.size = sizeof body->info;
    if (dpt_mesh_get_info(body->mesh, &body->info) != DPT_OK)
        fail("a body has no info");
    if (body->info.springs && bench->bodies > 1)
        fail("only the first body may be soft");
    body->placed = body->mesh;
    if (!body->info.springs) {
        const dpt_pose pose = pose_of(listed);
        for (size_t i = 0; i < shape.vertex_count; i++)
            to_world(&pose, shape.vertices + 3 * i);
        def.springs = NULL;
        compile(&shape, &def, &body->placed_compiled, &body->placed);
    }
    shape_free(&shape);
    bench->triangles += body->info.triangles;
    bench->springs += body->info.springs;
}

static dpt_result add_soft(const struct bench *bench, struct stage *stage, int i)
{
    const struct listed_body *listed = &bench->scene->bodies[i];
    struct soft *soft = &stage->soft[i];
    dpt_deformable_def deform;
    dpt_springs_def springs;
    dpt_deformable_def_init(&deform);
    dpt_springs_def_init(&springs);
    deform.mesh = springs.mesh = bench->body[i].mesh;
    deform.pose = &listed->pose;
    deform.load_radius = listed->load_radius;
    for (int k = 0; k < 3; k++) {
        deform.box_min[k] = -1.0;
        deform.box_max[k] = 1.0;
    }
    springs.integrator = listed->integrator;
    springs.iterations = listed->iterations ? listed->iterations : springs.iterations;
    /* Gravity is that of the cloth alone, which lies: its own z is up. */
    springs.gravity[2] = -bench->scene->gravity;
    soft->block = array(dpt_deformable_bytes(&deform));
    soft->springs_block = array(dpt_springs_bytes(&springs));
    const dpt_result result =
        dpt_body_add_deformable(stage->world, soft->block, dpt_deformable_bytes(&deform), &deform, &soft->id);
    return result != DPT_OK
               ? result
               : dpt_springs_create(soft->springs_block, dpt_springs_bytes(&springs), &springs, &soft->springs);
}

/* What falls lies on a tool that rests. */
static int rests(const struct bench *bench)
{
    return bench->scene->gravity > 0.0;
}

static dpt_segment stylus_of(const struct bench *bench)
{
    const struct listed_scene *scene = bench->scene;
    return rests(bench) ? (dpt_segment){ { 0, 0, 0 }, { 0, 0, scene->length }, scene->radius }
                        : (dpt_segment){ { 0, 0, 0 }, { 0, scene->length, 0 }, scene->radius };
}

/* The default world, or one that looks for the nearest pair alone. */
static void open_stage(const struct bench *bench, struct stage *stage, int tracks)
{
    const struct listed_scene *scene = bench->scene;
    dpt_world_def world;
    const dpt_segment stylus = stylus_of(bench);
    memset(stage, 0, sizeof *stage);
    dpt_world_def_init(&world);
    world.until = tracks ? DPT_UNTIL_TRACK : DPT_UNTIL_RESPOND;
    stage->block = array(dpt_world_bytes(&world));
    dpt_result result = dpt_world_create(stage->block, dpt_world_bytes(&world), &world, &stage->world);
    for (int i = 0; i < bench->bodies && result == DPT_OK; i++) {
        const dpt_pose pose = pose_of(&scene->bodies[i]);
        result = bench->body[i].info.springs
                     ? add_soft(bench, stage, i)
                     : dpt_body_add(stage->world, bench->body[i].mesh, &pose, &stage->soft[i].id);
    }
    if (result == DPT_OK)
        result = dpt_tool_add(stage->world, &stylus, 1, &stage->tool);
    if (result != DPT_OK)
        fail(dpt_result_text(result));
}

static void close_stage(struct stage *stage)
{
    free(stage->block);
    for (int i = 0; i < BODIES; i++) {
        free(stage->soft[i].block);
        free(stage->soft[i].springs_block);
    }
}

static dpt_pose pose_at(const struct bench *bench, int tick)
{
    const double t = 1e-3 * tick;
    dpt_pose pose = DPT_POSE_IDENTITY;
    memcpy(pose.position, bench->touch, sizeof pose.position);
    if (!rests(bench)) {
        pose.position[1] += tick < 200 ? 0.008 * (1.0 - 5.0 * t) : 0.003 * sin(4.398229715 * (t - 0.2));
        pose.position[0] += 0.01 * sin(6.2831853 * t);
    }
    return pose;
}

static void place(const struct bench *bench, const struct stage *stage, int tick)
{
    const dpt_pose pose = pose_at(bench, tick);
    if ((tick ? dpt_tool_set_pose(stage->world, stage->tool, &pose)
              : dpt_tool_teleport(stage->world, stage->tool, &pose)) != DPT_OK)
        fail("the tool does not move");
}

/* Lower the stylus by its distance until it touches. */
static void find_touch(struct bench *bench)
{
    struct stage stage;
    const dpt_mesh_info *info = &bench->body[0].info;
    const int lies = bench->scene->bodies[0].pose.orientation[1] != 0.0;
    bench->touch[0] = 0.5 * (info->box_min[0] + info->box_max[0]);
    bench->touch[1] = (lies ? info->box_max[2] : info->box_max[1]) + 0.02;
    bench->touch[2] = lies ? 0.0 : 0.5 * (info->box_min[2] + info->box_max[2]);
    if (rests(bench)) {
        memcpy(bench->touch, bench->scene->origin, sizeof bench->touch);
        return;
    }
    open_stage(bench, &stage, 1);
    for (int i = 0; i < 100; i++) {
        dpt_pose pose = DPT_POSE_IDENTITY;
        dpt_hit hit = DPT_HIT_INIT;
        memcpy(pose.position, bench->touch, sizeof pose.position);
        if (dpt_tool_teleport(stage.world, stage.tool, &pose) != DPT_OK ||
            dpt_world_step(stage.world, 1e-3, NULL) != DPT_OK ||
            dpt_tool_get_hit(stage.world, stage.tool, &hit) != DPT_OK)
            fail("no way to the body");
        bench->touch[1] -= hit.distance - bench->scene->radius;
    }
    close_stage(&stage);
}

static void record(struct bench *bench, const struct stage *stage, int tick)
{
    const dpt_pose pose = pose_at(bench, tick);
    const dpt_segment stylus = stylus_of(bench);
    const float *positions;
    uint32_t count;
    for (int k = 0; k < 3; k++) {
        bench->ends[6 * tick + k] = stylus.a[k] + pose.position[k];
        bench->ends[6 * tick + 3 + k] = stylus.b[k] + pose.position[k];
    }
    if (!bench->record)
        return;
    if (dpt_body_get_vertices(stage->world, stage->soft[0].id, &positions, &count) != DPT_OK)
        fail("vertices");
    float *to = bench->record + 3 * (size_t)bench->vertices * (size_t)tick;
    for (uint32_t v = 0; v < count; v++) {
        double x[3];
        for (uint32_t k = 0; k < 3; k++)
            x[k] = (double)positions[3 * v + k];
        to_world(&bench->scene->bodies[0].pose, x);
        for (uint32_t k = 0; k < 3; k++)
            to[3 * v + k] = (float)x[k];
    }
}

static void print_row(const struct bench *bench, const char *until, double *times)
{
    qsort(times, (size_t)bench->ticks, sizeof *times, by_size);
    printf("%s,scene,%s,%d,0,%.0f,%.0f\n", bench->scene->name, until, bench->ticks, times[bench->ticks / 2],
           times[99 * bench->ticks / 100]);
}

/* The scene as it is, with force and physics. */
static void run(struct bench *bench)
{
    static double step[TICKS_MAX], whole[TICKS_MAX];
    struct stage stage;
    const float *rest;
    bench->ends = array(6 * (size_t)bench->ticks * sizeof *bench->ends);
    bench->distances = array((size_t)bench->ticks * sizeof *bench->distances);
    dpt_mesh_get_vertices(bench->body[0].mesh, &rest, &bench->vertices);
    if (bench->body[0].info.springs)
        bench->record = array(3 * (size_t)bench->vertices * (size_t)bench->ticks * sizeof *bench->record);
    open_stage(bench, &stage, 0);
    for (int tick = 0; tick < bench->ticks; tick++) {
        record(bench, &stage, tick);
        place(bench, &stage, tick);
        const double begin = now();
        if (dpt_world_step(stage.world, 1e-3, NULL) != DPT_OK)
            fail("a tick failed");
        step[tick] = now() - begin;
        dpt_hit hit = DPT_HIT_INIT;
        dpt_tool_get_hit(stage.world, stage.tool, &hit);
        bench->distances[tick] = hit.distance;
        if (stage.soft[0].springs &&
            dpt_body_step_springs(stage.world, stage.soft[0].id, stage.soft[0].springs, 1e-3, NULL) != DPT_OK)
            fail("physics failed");
        whole[tick] = now() - begin;
    }
    close_stage(&stage);
    print_row(bench, "respond", step);
    print_row(bench, "physics", whole);
}

static void write_distances(const struct bench *bench, const char *dir)
{
    char path[500];
    snprintf(path, sizeof path, "%s/%s.scene", dir, bench->scene->name);
    FILE *file = fopen(path, "w");
    if (!file)
        fail("DIR cannot be written to");
    fprintf(file, "tick,distance,triangle\n");
    for (int tick = 0; tick < bench->ticks; tick++)
        fprintf(file, "%d,%.17g,0\n", tick, bench->distances[tick]);
    if (fclose(file))
        fail("DIR cannot be written to");
}

static const float *recorded_at(void *self, int tick)
{
    const struct bench *bench = self;
    return bench->record + 3 * (size_t)bench->vertices * (size_t)tick;
}

static void play_methods(struct bench *bench, const char *dir)
{
    struct play play = { .name = bench->scene->name,
                         .bodies = bench->bodies,
                         .with_brute = 1,
                         .radius = bench->scene->radius,
                         .ends = bench->ends,
                         .ticks = bench->ticks,
                         .positions = bench->record ? recorded_at : NULL,
                         .self = bench,
                         .first = bench->record };
    for (int i = 0; i < bench->bodies; i++)
        play.mesh[i] = bench->body[i].placed;
    play_all(&play, stdout, dir);
    play_write(&play, dir);
    if (play.positions)
        play_write_motion(&play, dir);
}

int main(int argc, char **argv)
{
    const int ticks = argc > 2 ? atoi(argv[2]) : 3000;
    if (argc < 2 || argc > 3 || ticks < 2 || ticks > TICKS_MAX)
        fail("DIR and TICKS, 2 to 10000, are needed");
    printf("scene,method,until,ticks,positions,step,step_p99\n");
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        struct bench bench = { .scene = scene_listed(names[i]), .ticks = ticks };
        for (const struct listed_body *body = bench.scene->bodies; body->shape; body++)
            make_body(&bench, body);
        fprintf(stderr, "%s: %u triangles, %u springs\n", bench.scene->name, bench.triangles, bench.springs);
        find_touch(&bench);
        run(&bench);
        write_distances(&bench, argv[1]);
        play_methods(&bench, argv[1]);
        free(bench.ends);
        free(bench.distances);
        free(bench.record);
        for (int k = 0; k < bench.bodies; k++) {
            dpt_compiled_free(&bench.body[k].compiled);
            dpt_compiled_free(&bench.body[k].placed_compiled);
        }
    }
    return 0;
}
