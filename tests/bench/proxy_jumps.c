/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a hand must not feel of a proxy as set by default, over five meshes: two of them real organs below DPT_DATA.
 *
 *     proxy_jumps [RUNS=20 [MESH [TOOL [MOTION [HOLDING [FRICTION=0]]]]]]
 *
 * MESH, TOOL, MOTION, HOLDING "": all. A CSV, of RUNS runs of 2,000 ticks each: the counts of proxy/jump_run.h. Each one is
 * told on standard error, too.
 */
#define _GNU_SOURCE
#include <stdio.h>

#include "bench_mesh.h"
#include "proxy/jump_run.h"

enum { RUN_TICKS = 2000, RUNS = 20 };

#define DEPTH 3e-3
#define POKED 5e-3

static const struct {
    const char *name;
    dpt_segment segment;
} tools[] = { { "ball", { { 0, 0, 0 }, { 0, 0, 0 }, 1e-3 } },
              { "line", { { 0, 0, 0 }, { 0, 0, 0.1 }, 0 } },
              { "rod", { { 0, 0, 0 }, { 0, 0, 0.1 }, 1e-3 } } };
enum { TOOLS = sizeof tools / sizeof *tools };

static int is_wanted(const char *wanted, const char *name)
{
    return !*wanted || !strcmp(wanted, name);
}

int main(int argc, char **argv)
{
    const int runs = argc > 1 ? atoi(argv[1]) : RUNS;
    const char *wanted[4] = { "", "", "", "" };
    for (int k = 0; k < 4 && k + 2 < argc; k++)
        wanted[k] = argv[k + 2];
    const double friction = argc > 6 ? atof(argv[6]) : 0;
    puts("mesh,triangles,tool,motion,holding,friction,ticks,acts,jumps,largest,puts,early,passed,overlaps,folds,"
         "mean_N");
    for (int m = 0; m < BENCH_MESHES; m++) {
        struct solid solid;
        struct soak_oracle oracle;
        if (!is_wanted(wanted[0], bench_meshes[m].name) || !bench_mesh_open(&solid, m))
            continue;
        if (!soak_oracle_open(&oracle, &solid))
            return 2;
        for (int t = 0; t < TOOLS; t++)
            for (int k = 0; k < HAND_MOTIONS; k++)
                for (int h = 0; h < HAND_HOLDINGS; h++) {
                    struct jump_counts c = { 0 };
                    if (!is_wanted(wanted[1], tools[t].name) || !is_wanted(wanted[2], hand_motion_names[k]) ||
                        !is_wanted(wanted[3], hand_holding_names[h]))
                        continue;
                    struct jump_run_def def = { .oracle = &oracle,
                                                .segment = tools[t].segment,
                                                .motion = k,
                                                .holding = h,
                                                .depth = k == HAND_POKE ? POKED : DEPTH,
                                                .friction = friction,
                                                .ticks = RUN_TICKS,
                                                .tell = stderr };
                    for (int i = 0; i < runs; i++) {
                        def.seed = 1000 + (uint64_t)i;
                        jump_run(&def, &c);
                    }
                    printf("%s,%u,%s,%s,%s,%g,%llu,%llu,%llu,%.3f,%llu,%llu,%llu,%llu,%llu,%.3f\n",
                           bench_meshes[m].name, solid.info.triangles, tools[t].name, hand_motion_names[k],
                           hand_holding_names[h], friction, (unsigned long long)c.ticks, (unsigned long long)c.acts,
                           (unsigned long long)c.jumps, c.largest, (unsigned long long)c.puts,
                           (unsigned long long)c.early, (unsigned long long)c.passed, (unsigned long long)c.overlaps,
                           (unsigned long long)c.folds, c.ticks ? c.force / (double)c.ticks : 0.0);
                    fflush(stdout);
                }
        soak_oracle_close(&oracle);
        solid_close(&solid);
    }
    return check_report();
}
