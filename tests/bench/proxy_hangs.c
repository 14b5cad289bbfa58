/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Whether a ball's proxy hangs where nothing holds it: proxy/hang_run.h, on five meshes.
 *
 *     proxy_hangs [RUNS=3 [MESH [RADIUS]]]
 *
 * A CSV, of RUNS runs of 2,000 ticks: the mean force of the library and of the oracle, N; their ratio; shares of the ticks.
 */
#define _GNU_SOURCE
#include <stdio.h>

#include "bench_mesh.h"
#include "proxy/hang_run.h"

enum { RUN_TICKS = 2000, RUNS = 3 };

static const double radii[] = { 1e-6, 1e-4, 1e-3 };
enum { RADII = sizeof radii / sizeof *radii };

int main(int argc, char **argv)
{
    const int runs = argc > 1 ? atoi(argv[1]) : RUNS;
    const char *mesh = argc > 2 ? argv[2] : "";
    const double radius = argc > 3 ? atof(argv[3]) : 0;
    puts("mesh,triangles,radius,ticks,force_N,oracle_N,ratio,farther,nearer,folding");
    for (int m = 0; m < BENCH_MESHES; m++) {
        struct solid solid;
        if ((*mesh && strcmp(mesh, bench_meshes[m].name) != 0) || !bench_mesh_open(&solid, m))
            continue;
        for (int r = 0; r < RADII; r++) {
            struct hang_sums sums = { 0 };
            if (radius > 0 && radius != radii[r])
                continue;
            for (int i = 0; i < runs; i++)
                hang_run(&solid, radii[r], 1000 + (uint64_t)i, RUN_TICKS, &sums);
            const double ticks = (double)sums.ticks;
            printf("%s,%u,%g,%.0f,%.3f,%.3f,%.3f,%.4f,%.4f,%llu\n", solid.name, solid.info.triangles, radii[r], ticks,
                   sums.force / ticks, sums.oracle / ticks, sums.force / sums.oracle, (double)sums.farther / ticks,
                   (double)sums.nearer / ticks, (unsigned long long)sums.folding);
            fflush(stdout);
        }
        solid_close(&solid);
    }
    return check_report();
}
