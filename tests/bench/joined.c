/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a tool of many segments costs beside one of a single segment: a catheter of 0.2 m, bent to a quarter of a circle, as
 * 1, 16 and 64 segments that join, searched for all or `near_only`, and as 64 tools of a segment each, the loose ones.
 * They make the same motions at 0.1 m/s, a tick each in turns:
 *
 *     away   20 mm above the mesh
 *     tip    upright, with its end pressed 5 mm in, and sliding
 *     lying  with its middle pressed 5 mm in, across, and sliding
 *
 * A CSV: mesh, triangles, until, motion, tool, segments, ticks, median and 99 % in us of processor time, and the median as a
 * multiple of the single segment's.
 *
 *     joined [RUNS=20]
 */
#define _GNU_SOURCE
#include <stdio.h>
#include <string.h>

#include "lib/pose.h"
#include "lib/solid.h"
#include "timing.h"

enum { TICKS = 400, SETTLED = 100, LOOSE = 64, TOOLS = 6 };

#define LENGTH 0.2
#define RADIUS 0.001
#define BEND   1.5707963267948966

static const struct tool_kind {
    const char *name;
    uint32_t segments, tools, near_only;
} kinds[TOOLS] = { { "single", 1, 1, 0 },     { "joined", 16, 1, 0 },         { "joined_near", 16, 1, 1 },
                   { "joined", LOOSE, 1, 0 }, { "joined_near", LOOSE, 1, 1 }, { "loose", LOOSE, LOOSE, 0 } };

struct stage_of_tool {
    void *block;
    dpt_world *world;
    dpt_tool tools[LOOSE];
    double *took;
    uint32_t ticks;
};

static void fail(const char *what)
{
    fprintf(stderr, "joined: %s\n", what);
    exit(2);
}

/* The point of the arc at that share of its length: it begins along z. The point at `origin` is at the origin. */
static void arc_point(double share, double origin, double x[3])
{
    const double r = LENGTH / BEND;
    x[0] = r * (cos(BEND * origin) - cos(BEND * share));
    x[1] = 0;
    x[2] = r * (sin(BEND * share) - sin(BEND * origin));
}

static void open_tool(struct stage_of_tool *stage, const struct solid *solid, const struct tool_kind *kind,
                      uint32_t until, double origin, uint32_t ticks)
{
    dpt_segment segments[LOOSE];
    dpt_world_def def;
    dpt_body body;
    dpt_world_def_init(&def);
    def.until = until;
    def.max_segments = def.max_tools = LOOSE;
    memset(stage, 0, sizeof *stage);
    stage->took = malloc(ticks * sizeof *stage->took);
    stage->block = malloc(dpt_world_bytes(&def));
    if (!stage->took || !stage->block || dpt_world_create(stage->block, dpt_world_bytes(&def), &def, &stage->world) ||
        dpt_body_add(stage->world, solid->mesh, NULL, &body))
        fail("no world");
    for (uint32_t i = 0; i < kind->segments; i++) {
        arc_point(i / (double)kind->segments, origin, segments[i].a);
        arc_point((i + 1) / (double)kind->segments, origin, segments[i].b);
        segments[i].radius = RADIUS;
    }
    for (uint32_t t = 0; t < kind->tools; t++) {
        dpt_tool_settings settings = { .size = sizeof settings };
        if (dpt_tool_add(stage->world, segments + t, kind->segments / kind->tools, &stage->tools[t]) ||
            dpt_tool_get_settings(stage->world, stage->tools[t], &settings))
            fail("no tool");
        settings.near_only = kind->near_only;
        if (dpt_tool_set_settings(stage->world, stage->tools[t], &settings))
            fail("no settings");
    }
}

static void tick(struct stage_of_tool *stage, const struct tool_kind *kind, const dpt_pose *pose, int number)
{
    const double begin = processor_time();
    for (uint32_t t = 0; t < kind->tools; t++)
        if (number ? dpt_tool_set_pose(stage->world, stage->tools[t], pose)
                   : dpt_tool_teleport(stage->world, stage->tools[t], pose))
            fail("no pose");
    if (dpt_world_step(stage->world, 1e-3, NULL))
        fail("no step");
    const double took = processor_time() - begin;
    if (number >= SETTLED)
        stage->took[stage->ticks++] = took;
}

static void run(struct stage_of_tool *stages, const struct solid *solid, int motion, uint64_t *seed)
{
    const float *v = solid->corners + 9 * (random_bits(seed) % solid->info.triangles);
    double at[3], e[3], f[3], out[3];
    dpt_pose pose;
    for (int k = 0; k < 3; k++) {
        at[k] = (v[k] + v[3 + k] + v[6 + k]) / 3.0;
        e[k] = v[3 + k] - v[k];
        f[k] = v[6 + k] - v[k];
    }
    for (int k = 0; k < 3; k++)
        out[k] = e[(k + 1) % 3] * f[(k + 2) % 3] - e[(k + 2) % 3] * f[(k + 1) % 3];
    unit3(out);
    unit3(e);
    turn_from_z(motion == 2 ? e : out, pose.orientation);
    for (int number = 0; number < TICKS; number++) {
        const double height = motion ? fmax(-0.005, 0.003 - 1e-4 * number) : 0.02;
        const double slid = 1e-4 * number;
        for (int k = 0; k < 3; k++)
            pose.position[k] = at[k] + height * out[k] + slid * e[k];
        for (int t = 0; t < TOOLS; t++)
            tick(&stages[t], &kinds[t], &pose, number);
    }
}

static void measure(const char *name, uint64_t count, uint32_t until, int motion, int runs)
{
    static const char *const motions[] = { "away", "tip", "lying" };
    struct solid solid;
    struct stage_of_tool stages[TOOLS];
    uint64_t seed = 7;
    double single = 0;
    if (!solid_from_shape(&solid, name, count))
        fail(name);
    for (int t = 0; t < TOOLS; t++)
        open_tool(&stages[t], &solid, &kinds[t], until, motion == 2 ? 0.5 : 0, (uint32_t)runs * TICKS);
    for (int i = 0; i < runs; i++)
        run(stages, &solid, motion, &seed);
    for (int t = 0; t < TOOLS; t++) {
        struct stage_of_tool *stage = &stages[t];
        qsort(stage->took, stage->ticks, sizeof *stage->took, by_size);
        const double half = stage->took[stage->ticks / 2];
        single = t ? single : half;
        printf("%s,%u,%s,%s,%s,%u,%u,%.2f,%.1f,%.2f\n", name, solid.info.triangles,
               until == DPT_UNTIL_TRACK ? "track" : "respond", motions[motion], kinds[t].name, kinds[t].segments,
               stage->ticks, half, stage->took[stage->ticks * 99u / 100u], half / single);
        free(stage->took);
        free(stage->block);
    }
    solid_close(&solid);
}

int main(int argc, char **argv)
{
    const int runs = argc > 1 ? atoi(argv[1]) : 20;
    if (runs < 1)
        fail("RUNS is a number above 0");
    puts("mesh,triangles,until,motion,tool,segments,ticks,median_us,p99_us,ratio");
    measure("liver", 50332, DPT_UNTIL_TRACK, 0, runs);
    for (int motion = 0; motion < 3; motion++)
        measure("liver", 50332, DPT_UNTIL_RESPOND, motion, runs);
    for (int motion = 0; motion < 3; motion++)
        measure("torus", 61358, DPT_UNTIL_RESPOND, motion, runs);
    return 0;
}
