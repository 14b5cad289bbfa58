/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Your physics, our contact: a needle is held still, and an organ beats against it and gives way. Physics moves the
 * vertices a hundred times a second, in a thread of its own. The haptic loop takes them a thousand times a second, and
 * hands back what the needle does to them. Physics tells how far a vertex gives way to a newton in one of its steps, so the
 * loop feels the organ give way in each tick.
 *
 *     build/dynpoint make liver 5000 -o liver.stl
 *     cc own_physics.c $(pkg-config --cflags --libs libdynpoint_compile libdynpoint) -lm -pthread -o own_physics
 *     ./own_physics liver.stl                 five seconds, in two threads
 *     ./own_physics liver.stl --one-thread    the same as fast as it can: each run gives the same numbers
 */
#define _POSIX_C_SOURCE 200809L
#include <dynpoint.h>
#include <dynpoint/compile.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define TURN   6.283185307179586
#define TICK   0.001 /* s, of the haptic loop */
#define PERIOD 0.01  /* s, of physics */
#define BEAT   0.05  /* the organ grows and shrinks by this part, once a second */
#define TAU    0.03  /* s, in which a vertex goes back to its place */
#define DRAG   6.0   /* Ns/m, of a vertex */
#define RADIUS 0.001 /* m, of the needle */
enum { TICKS = 5000, TICKS_A_PERIOD = 10 };
enum { LOADS_MAX = 16 * 256 }; /* dpt_deformable_def.max_points, and the most vertices of one */

struct loads {
    uint32_t count;
    dpt_load load[LOADS_MAX];
};

/* Where vertices are, and the loads that have brought them there. */
struct answer {
    float *positions;
    struct loads loads;
};

struct scene {
    const dpt_mesh *mesh;
    const float *rest; /* its vertices; physics that has them in another order needs a table */
    uint32_t vertices;

    /* Between the threads. */
    dpt_latest latest_answer, latest_loads;
    struct answer answers[DPT_LATEST_PLACES];
    struct loads loads[DPT_LATEST_PLACES];

    /* Of physics. */
    double middle[3], *now, *force; /* 3 numbers a vertex */
    int periods;

    /* Of the haptic loop. */
    void *world_block, *body_block;
    dpt_world *world;
    dpt_body body;
    dpt_tool tool;
    dpt_pose device;
    double held_at; /* m, the height of the needle's tip */
};

struct felt {
    dpt_pose proxy;
    double depth;
    dpt_force_info report;
};

#define MUST(call) must(#call, call)
static void must(const char *call, dpt_result result)
{
    if (result == DPT_OK)
        return;
    fprintf(stderr, "%s: %s (%s)\n", call, dpt_result_text(result), dpt_result_name(result));
    exit(1);
}

static void *must_allocate(size_t bytes)
{
    void *block = calloc(1, bytes);
    MUST(block != NULL ? DPT_OK : DPT_E_MEMORY);
    return block;
}

/* How much of its way a vertex goes in a step. */
static double part_of_step(void)
{
    return 1 - exp(-PERIOD / TAU);
}

/* Yours. Here a spring pulls each vertex to its place in the organ: x' = (place - x) / TAU + force / DRAG. */
static void physics_step(struct scene *scene)
{
    const double beat = BEAT * sin(TURN * PERIOD * ++scene->periods);
    struct answer *answer = &scene->answers[scene->latest_answer.writing];
    const struct loads *loads;

    dpt_latest_take(&scene->latest_loads); /* the last ones, where there are no newer ones */
    loads = &scene->loads[scene->latest_loads.reading];
    answer->loads = *loads;
    memset(scene->force, 0, 3 * scene->vertices * sizeof *scene->force);
    for (uint32_t i = 0; i < loads->count; i++)
        for (uint32_t k = 0; k < 3; k++)
            scene->force[3 * loads->load[i].vertex + k] += loads->load[i].force[k];

    for (uint32_t i = 0; i < 3 * scene->vertices; i++) {
        const double rest = (double)scene->rest[i];
        const double place = rest + beat * (rest - scene->middle[i % 3]);
        scene->now[i] += part_of_step() * (place + TAU / DRAG * scene->force[i] - scene->now[i]);
        answer->positions[i] = (float)scene->now[i];
    }
    dpt_latest_publish(&scene->latest_answer);
}

/* The needle comes down for half a second; then it is held. */
static struct felt haptic_tick(struct scene *scene, int tick)
{
    struct loads *loads = &scene->loads[scene->latest_loads.writing];
    struct felt felt = { .report.size = sizeof felt.report };
    double seconds;
    scene->device.position[2] = scene->held_at + 0.01 * fmax(0, 1 - 2 * TICK * tick);

    if (dpt_latest_take(&scene->latest_answer)) {
        const struct answer *answer = &scene->answers[scene->latest_answer.reading];
        MUST(dpt_body_set_answered_loads(scene->world, scene->body, answer->loads.load, answer->loads.count));
        MUST(dpt_body_set_vertices(scene->world, scene->body, 0, scene->vertices, answer->positions, -1));
    }
    MUST(dpt_tool_set_pose(scene->world, scene->tool, &scene->device));
    MUST(dpt_world_step(scene->world, TICK, NULL));
    MUST(dpt_body_step_springs(scene->world, scene->body, NULL, TICK, NULL)); /* the organ gives way */
    MUST(dpt_tool_get_force_info(scene->world, scene->tool, &felt.report));   /* to the device */
    MUST(dpt_tool_get_proxy(scene->world, scene->tool, &felt.proxy));         /* to the screen */
    MUST(dpt_body_get_mean_loads(scene->world, scene->body, loads->load, LOADS_MAX, &loads->count, &seconds));
    dpt_latest_publish(&scene->latest_loads);

    felt.depth = felt.proxy.position[2] - scene->device.position[2];
    return felt;
}

static void open_physics(struct scene *scene, const dpt_mesh_info *info)
{
    const size_t numbers = 3 * (size_t)info->vertices;
    dpt_latest_init(&scene->latest_answer);
    dpt_latest_init(&scene->latest_loads);
    for (int i = 0; i < DPT_LATEST_PLACES; i++)
        scene->answers[i].positions = must_allocate(numbers * sizeof(float));
    scene->now = must_allocate(numbers * sizeof(double));
    scene->force = must_allocate(numbers * sizeof(double));
    for (size_t i = 0; i < numbers; i++)
        scene->now[i] = (double)scene->rest[i];
    for (int k = 0; k < 3; k++)
        scene->middle[k] = 0.5 * (info->box_min[k] + info->box_max[k]);
}

static void open_haptics(struct scene *scene, const dpt_mesh_info *info)
{
    const dpt_segment needle = { { 0, 0, 0 }, { 0, 0, 0.15 }, RADIUS };
    dpt_world_def world_def;
    dpt_deformable_def body_def;
    dpt_hit top = DPT_HIT_INIT;

    dpt_world_def_init(&world_def);
    scene->world_block = must_allocate(dpt_world_bytes(&world_def));
    MUST(dpt_world_create(scene->world_block, dpt_world_bytes(&world_def), &world_def, &scene->world));

    dpt_deformable_def_init(&body_def);
    body_def.mesh = scene->mesh;
    body_def.period = PERIOD;                          /* vertices move smoothly from one step of physics to the next */
    body_def.load_radius = 0.01;                       /* m: the needle's force is spread over a patch */
    body_def.compliance = part_of_step() * TAU / DRAG; /* m/N: how far a newton moves a vertex in a step of physics */
    scene->body_block = must_allocate(dpt_deformable_bytes(&body_def));
    MUST(dpt_body_add_deformable(scene->world, scene->body_block, dpt_deformable_bytes(&body_def), &body_def,
                                 &scene->body));

    MUST(dpt_tool_add(scene->world, &needle, 1, &scene->tool));

    /* Over the place of the organ that is nearest to the middle of its box's top. */
    const double x = scene->middle[0], y = scene->middle[1], z = info->box_max[2];
    const double above[6] = { x, y, z, x, y, z };
    MUST(dpt_query_segments(scene->mesh, NULL, above, NULL, 1, &top, NULL));
    scene->device = (dpt_pose){ { top.q[0], top.q[1], 0 }, { 1, 0, 0, 0 } };
    scene->held_at = top.q[2] + RADIUS - 0.002;
}

static void open_scene(struct scene *scene, const dpt_mesh *mesh)
{
    dpt_mesh_info info = { .size = sizeof info };
    memset(scene, 0, sizeof *scene);
    scene->mesh = mesh;
    MUST(dpt_mesh_get_info(mesh, &info));
    MUST(dpt_mesh_get_vertices(mesh, &scene->rest, &scene->vertices));
    open_physics(scene, &info);
    open_haptics(scene, &info);
}

static void close_scene(struct scene *scene)
{
    for (int i = 0; i < DPT_LATEST_PLACES; i++)
        free(scene->answers[i].positions);
    free(scene->now);
    free(scene->force);
    free(scene->world_block);
    free(scene->body_block);
}

/* Move `time` on by so much, and sleep until then. */
static void sleep_until_next(struct timespec *time, double seconds)
{
    time->tv_nsec += (long)(1e9 * seconds);
    time->tv_sec += time->tv_nsec / 1000000000;
    time->tv_nsec %= 1000000000;
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, time, NULL);
}

static void *physics_thread(void *scene)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    for (;;) {
        physics_step(scene);
        sleep_until_next(&time, PERIOD); /* in which the thread is cancelled */
    }
    return NULL;
}

/* With a device, dpt_loop_run (loop.h) does what this loop does. */
static void run_in_two_threads(struct scene *scene, struct felt *felt)
{
    struct timespec time;
    pthread_t physics;
    MUST(pthread_create(&physics, NULL, physics_thread, scene) == 0 ? DPT_OK : DPT_E_SYSTEM);
    clock_gettime(CLOCK_MONOTONIC, &time);
    for (int tick = 0; tick < TICKS; tick++) {
        felt[tick] = haptic_tick(scene, tick);
        sleep_until_next(&time, TICK);
    }
    pthread_cancel(physics);
    pthread_join(physics, NULL);
}

static void run_in_one_thread(struct scene *scene, struct felt *felt)
{
    for (int tick = 0; tick < TICKS; tick++) {
        if (tick % TICKS_A_PERIOD == 0)
            physics_step(scene);
        felt[tick] = haptic_tick(scene, tick);
    }
}

/* A table of every tenth of a second. Returns whether the needle lost the surface in any tick. */
static int print_felt(const struct felt *felt)
{
    int is_lost = 0;
    printf("time, s  proxy, mm  depth, mm  force, N\n");
    for (int tick = 0; tick < TICKS; tick++) {
        const dpt_force_info *report = &felt[tick].report;
        is_lost |= report->reason == DPT_FORCE_INSIDE || report->flags & DPT_FORCE_FLAG_SQUEEZED;
        if (tick % 100 == 0)
            printf("%7.1f  %9.4f  %9.4f  %8.4f\n", TICK * tick, 1e3 * felt[tick].proxy.position[2],
                   1e3 * felt[tick].depth, report->wrench.force[2]);
    }
    return is_lost;
}

int main(int argc, char **argv)
{
    static struct scene scene;
    static struct felt felt[TICKS];
    const int is_steady = argc == 3 && strcmp(argv[2], "--one-thread") == 0;
    dpt_compiled file;
    const dpt_mesh *mesh;
    if (argc != 2 && !is_steady) {
        fprintf(stderr, "usage: own_physics MESH [--one-thread]\n");
        return 2;
    }
    MUST(dpt_compile_file(argv[1], NULL, &file, NULL));
    MUST(dpt_mesh_open(file.bytes, file.size, &mesh));
    open_scene(&scene, mesh);
    if (is_steady)
        run_in_one_thread(&scene, felt);
    else
        run_in_two_threads(&scene, felt);
    close_scene(&scene);
    dpt_compiled_free(&file);
    return print_felt(felt);
}
