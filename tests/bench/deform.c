/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The nearest pair of a tool and a body whose vertices move each tick.
 *
 *     deform MESH.dpa TRACE.csv modes|dent STEP OUT.csv     times; prints CSV, a row a subject
 *     deform MESH.dpa MESH.tri                              the mesh with vertices as they are handed over
 *
 * The subjects are a deformable body with each kernel of this machine; `still`, one whose vertices never move; and
 * `rigid`, a rigid body. They take turns of TURN ticks, each with a world of its own, so that what else the machine does
 * meets all of them; and turns begin at other ticks in each pass, since in the first tick of a turn nothing is in the
 * cache. Times are in ns, least of PASSES passes a tick, the first tick left out: `set` of dpt_body_set_vertices (of
 * a dent, _vertex_list), `step` of dpt_world_step until track, `other` of the steps in which the axis does not cross.
 * `work` is the steps', in units. The first EARLY ticks and every EVERY-th are compared with brute force over their
 * positions: `wrong` is how many differ by more than their error bound and the oracle's own error, `error` the largest
 * difference, in m. OUT.csv has tick, distance and, of the ticks that were compared, the brute force's.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/plain_files.h"
#include "bench/timing.h"
#include "bench/vertex_motion.h"
#include "dynpoint.h"
#include "oracle/brute.h"

enum { TICKS_MAX = 20000, PASSES = 3, TURN = 250, EVERY = 20, EARLY = 50, SUBJECTS = 7 };

struct subject {
    const char *name;
    uint32_t kernel;
    int is_rigid, is_still;
    void *world_block, *body_block;
    dpt_world *world;
    dpt_body body;
    dpt_tool tool;
    double *set, *step, *distance; /* by tick */
    uint32_t *work;
    double error;
    uint32_t checked, wrong;
};

struct bench {
    const dpt_mesh *mesh;
    const float *rest;
    const uint32_t *corners;
    uint32_t vertices, triangles;
    double *trace; /* 6 numbers a tick */
    size_t ticks;
    struct vertex_motion motion;
    double *brute; /* of the ticks that are compared */
};

static void fail(const char *what)
{
    fprintf(stderr, "deform: %s\n", what);
    exit(2);
}

static void *array(size_t count, size_t bytes)
{
    void *made = calloc(count, bytes);
    if (!made)
        fail("no memory");
    return made;
}

static void set_tool(const struct bench *bench, struct subject *subject, size_t tick)
{
    dpt_segment segment = { .radius = 0.0 };
    memcpy(segment.a, bench->trace + 6 * tick, sizeof segment.a);
    memcpy(segment.b, bench->trace + 6 * tick + 3, sizeof segment.b);
    if (subject->tool)
        dpt_tool_set_segments(subject->world, subject->tool, &segment, 1);
    else if (dpt_tool_add(subject->world, &segment, 1, &subject->tool) != DPT_OK)
        fail("no tool");
}

/* A world with nothing known; 0 where the machine does not have the kernel. */
static int open_world(const struct bench *bench, struct subject *subject)
{
    dpt_world_def def;
    dpt_deformable_def deform;
    dpt_world_def_init(&def);
    dpt_deformable_def_init(&deform);
    def.until = DPT_UNTIL_TRACK;
    def.kernel = subject->kernel;
    deform.mesh = bench->mesh;
    const size_t bytes = dpt_deformable_bytes(&deform);
    subject->world_block = malloc(dpt_world_bytes(&def));
    subject->body_block = malloc(bytes);
    subject->tool = 0;
    if (!subject->world_block || !subject->body_block)
        fail("no memory");
    if (dpt_world_create(subject->world_block, dpt_world_bytes(&def), &def, &subject->world) != DPT_OK)
        return 0;
    if ((subject->is_rigid
             ? dpt_body_add(subject->world, bench->mesh, NULL, &subject->body)
             : dpt_body_add_deformable(subject->world, subject->body_block, bytes, &deform, &subject->body)) != DPT_OK)
        fail("no body");
    return 1;
}

static void close_world(struct subject *subject)
{
    free(subject->world_block);
    free(subject->body_block);
}

static dpt_result hand_over(const struct bench *bench, struct subject *subject)
{
    const struct vertex_motion *motion = &bench->motion;
    return motion->is_dent
               ? dpt_body_set_vertex_list(subject->world, subject->body, motion->list, motion->count, motion->listed,
                                          -1.0)
               : dpt_body_set_vertices(subject->world, subject->body, 0, bench->vertices, motion->positions, -1.0);
}

static double brute_force(const struct bench *bench, const float *positions, size_t tick)
{
    oracle_mesh *mesh = oracle_brute_open(positions, bench->vertices, bench->corners, bench->triangles);
    if (!mesh)
        fail("no memory");
    const double distance = oracle_brute(mesh, bench->trace + 6 * tick, NULL);
    oracle_brute_close(mesh);
    return distance;
}

/* The error of the brute force is below 1e-14 of the largest coordinate. */
static double brute_error(const struct bench *bench, size_t tick)
{
    double largest = 0.0;
    for (int k = 0; k < 6; k++)
        largest = fmax(largest, fabs(bench->trace[6 * tick + (size_t)k]));
    for (size_t i = 0; i < 3 * (size_t)bench->vertices; i++)
        largest = fmax(largest, (double)fabsf(bench->motion.positions[i]));
    return 1e-14 * largest;
}

static void compare(struct bench *bench, struct subject *subject, size_t tick, const dpt_hit *hit)
{
    const int moves = !subject->is_rigid && !subject->is_still;
    double truth = moves ? bench->brute[tick] : -1.0;
    if (truth < 0.0)
        truth = brute_force(bench, moves ? bench->motion.positions : bench->rest, tick);
    if (moves)
        bench->brute[tick] = truth;
    const double error = fabs(hit->distance - truth);
    subject->error = fmax(subject->error, error);
    subject->checked++;
    subject->wrong += hit->status != DPT_STATUS_EXACT || error > hit->error_bound + brute_error(bench, tick);
}

static void run_tick(struct bench *bench, struct subject *subject, size_t tick, int pass)
{
    dpt_hit hit = DPT_HIT_INIT;
    dpt_result result = DPT_OK;
    double set = 0.0;
    if (!subject->is_rigid && !subject->is_still) {
        vertex_motion_at(&bench->motion, tick);
        const double begin = now();
        result = hand_over(bench, subject);
        set = now() - begin;
    }
    set_tool(bench, subject, tick);
    const double begin = now();
    const dpt_result stepped = dpt_world_step(subject->world, 1e-3, NULL);
    const double step = now() - begin;
    if (result != DPT_OK || stepped != DPT_OK)
        fail("a tick failed");
    dpt_tool_get_hit(subject->world, subject->tool, &hit);
    if (!pass) {
        subject->distance[tick] = hit.distance;
        subject->work[tick] = hit.work;
        if (tick % EVERY == 0 || tick < EARLY)
            compare(bench, subject, tick, &hit);
    } else if (hit.distance != subject->distance[tick]) {
        fail("two passes have different answers");
    }
    subject->set[tick] = pass && subject->set[tick] < set ? subject->set[tick] : set;
    subject->step[tick] = pass && subject->step[tick] < step ? subject->step[tick] : step;
}

static void run_pass(struct bench *bench, struct subject *subjects, int count, int pass)
{
    for (int s = 0; s < count; s++)
        open_world(bench, &subjects[s]);
    size_t begin = 0, end = (size_t)(TURN * (pass + 1) / PASSES);
    for (; begin < bench->ticks; begin = end, end += TURN)
        for (int s = 0; s < count; s++)
            for (size_t tick = begin; tick < end && tick < bench->ticks; tick++)
                run_tick(bench, &subjects[s], tick, pass);
    for (int s = 0; s < count; s++)
        close_world(&subjects[s]);
}

/* Prints the median and the 99 % of what is chosen, the first tick left out. */
static void print_quantiles(const double *values, const double *distance, size_t ticks, int others_alone)
{
    double *sorted = array(ticks, sizeof *sorted);
    size_t count = 0;
    for (size_t i = 1; i < ticks; i++)
        if (!others_alone || distance[i] > 0.0)
            sorted[count++] = values[i];
    qsort(sorted, count, sizeof *sorted, by_size);
    if (count)
        printf(",%.0f,%.0f", sorted[(count - 1) / 2], sorted[99 * (count - 1) / 100]);
    else
        printf(",,");
    free(sorted);
}

static void print_row(const struct bench *bench, const struct subject *subject)
{
    double *work = array(bench->ticks, sizeof *work), largest = 0.0;
    size_t crossing = 0;
    for (size_t i = 0; i < bench->ticks; i++)
        work[i] = subject->work[i];
    for (size_t i = 1; i < bench->ticks; i++) {
        crossing += subject->distance[i] == 0.0;
        largest = fmax(largest, subject->step[i]);
    }
    printf("%s,%zu,%zu", subject->name, bench->ticks - 1, crossing);
    print_quantiles(subject->set, subject->distance, bench->ticks, 0);
    print_quantiles(subject->step, subject->distance, bench->ticks, 0);
    print_quantiles(subject->step, subject->distance, bench->ticks, 1);
    printf(",%.0f", largest);
    print_quantiles(work, subject->distance, bench->ticks, 0);
    printf(",%u,%u,%.2g\n", subject->checked, subject->wrong, subject->error);
    free(work);
}

static int add_subject(const struct bench *bench, struct subject *subject, const char *name, uint32_t kernel)
{
    *subject = (struct subject){ .name = name, .kernel = kernel };
    subject->is_rigid = !strcmp(name, "rigid");
    subject->is_still = !strcmp(name, "still");
    subject->set = array(bench->ticks, sizeof(double));
    subject->step = array(bench->ticks, sizeof(double));
    subject->distance = array(bench->ticks, sizeof(double));
    subject->work = array(bench->ticks, sizeof(uint32_t));
    const int here = open_world(bench, subject);
    close_world(subject);
    return here;
}

static void write_answers(const struct bench *bench, const struct subject *subject, const char *path)
{
    FILE *file = fopen(path, "w");
    if (!file)
        fail("OUT.csv cannot be written");
    fprintf(file, "tick,distance,brute\n");
    for (size_t i = 0; i < bench->ticks; i++) {
        fprintf(file, "%zu,%.17g,", i, subject->distance[i]);
        fprintf(file, bench->brute[i] < 0.0 ? "\n" : "%.17g\n", bench->brute[i]);
    }
    if (fclose(file))
        fail("OUT.csv cannot be written");
}

int main(int argc, char **argv)
{
    static const struct {
        const char *name;
        uint32_t kernel;
    } chosen[SUBJECTS] = { { "avx512", DPT_KERNEL_AVX512 }, { "avx2", DPT_KERNEL_AVX2 },
                           { "sse2", DPT_KERNEL_SSE2 },     { "neon", DPT_KERNEL_NEON },
                           { "scalar", DPT_KERNEL_SCALAR }, { "still", DPT_KERNEL_AUTO },
                           { "rigid", DPT_KERNEL_AUTO } };
    struct subject subjects[SUBJECTS];
    struct bench bench = { .ticks = 0 };
    int count = 0;
    if (argc != 3 && argc != 6)
        fail("MESH.dpa TRACE.csv modes|dent STEP OUT.csv, or MESH.dpa MESH.tri");
    bench.mesh = plain_open_mesh(argv[1]);
    dpt_mesh_get_vertices(bench.mesh, &bench.rest, &bench.vertices);
    dpt_mesh_get_triangles(bench.mesh, &bench.corners, NULL, &bench.triangles);
    if (argc == 3) {
        plain_write_tri(argv[2], bench.rest, bench.vertices, bench.corners, bench.triangles);
        return 0;
    }
    bench.trace = plain_read_trace(argv[2], TICKS_MAX, &bench.ticks);
    if (!vertex_motion_open(&bench.motion, argv[3], atof(argv[4]), bench.rest, bench.vertices, bench.trace))
        fail("no such motion");
    bench.brute = array(bench.ticks, sizeof *bench.brute);
    for (size_t i = 0; i < bench.ticks; i++)
        bench.brute[i] = -1.0;
    for (int s = 0; s < SUBJECTS; s++)
        count += add_subject(&bench, &subjects[count], chosen[s].name, chosen[s].kernel);
    for (int pass = 0; pass < PASSES; pass++)
        run_pass(&bench, subjects, count, pass);
    for (int s = 1; s < count - 2; s++)
        if (memcmp(subjects[s].distance, subjects[0].distance, bench.ticks * sizeof(double)))
            fail("two kernels have different answers");
    for (int s = 0; s < count; s++)
        print_row(&bench, &subjects[s]);
    write_answers(&bench, &subjects[0], argv[5]);
    return 0;
}
