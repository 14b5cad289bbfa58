/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Whether a ball's proxy hangs where nothing holds it: frictionless wipes, 5 mm deep and at 0.1 m/s, beside the local minimum
 * that a ball reaches by steps of 1 um (oracle/ball_path.h).
 *
 *     proxy_hangs [RUNS=3 [MESH [RADIUS]]]
 *
 * A CSV, of RUNS runs of 2,000 ticks: the mean force of the library and of the oracle, N; their ratio; the share of the ticks
 * in which the proxy is farther from the device than the oracle by 5 %, and in which it is nearer.
 */
#define _GNU_SOURCE
#include <stdio.h>

#include "bench_mesh.h"
#include "lib/hand_motion.h"
#include "lib/rig.h"
#include "oracle/ball_path.h"

enum { RUN_TICKS = 2000, RUNS = 3 };

#define DEPTH     5e-3
#define CLEARANCE 2e-6 /* of the diagonal */
#define FOLD_SPEED 1.0 /* m/s: a proxy goes 2 |device's motion| + that in a tick at most */
#define AS_FAR    0.05

static const double radii[] = { 1e-6, 1e-4, 1e-3 };
enum { RADII = sizeof radii / sizeof *radii };

struct sums {
    uint64_t ticks, farther, nearer, folding;
    double force, oracle;
};

static void run_once(const struct solid *solid, double radius, uint64_t seed, struct sums *sums)
{
    const dpt_segment ball = { { 0, 0, 0 }, { 0, 0, 0 }, radius };
    struct rig rig;
    struct hand hand;
    struct ball_path path;
    hand_begin(&hand, solid, HAND_WIPE, HAND_FOLLOWS, DEPTH, seed);
    rig_open(&rig, NULL, solid->mesh, &ball, 1);
    hand_move(&hand, &rig.device);
    rig_place(&rig);
    if (!ball_path_open(&path, solid->corners, solid->place.triangles, radius + CLEARANCE * fmin(1, solid->diagonal),
                        rig.device.position))
        exit(2);
    for (int tick = 0; tick < RUN_TICKS && rig.force.reason <= DPT_FORCE_FREE; tick++) {
        const dpt_pose before = rig.device;
        hand_move(&hand, &rig.device);
        rig_step(&rig);
        const double longest = 2 * apart(before.position, rig.device.position) + FOLD_SPEED * RIG_DT;
        sums->folding += !ball_path_follow(&path, rig.device.position, longest);
        const double far = apart(rig.proxy.position, rig.device.position), due = apart(path.at, rig.device.position);
        sums->ticks++;
        sums->force += rig_force(&rig);
        sums->oracle += RIG_STIFFNESS * due;
        sums->farther += far > (1 + AS_FAR) * due + 1e-5;
        sums->nearer += far < (1 - AS_FAR) * due - 1e-5;
        if (getenv("TELL") && (far > (1 + AS_FAR) * due + 1e-5 || far < (1 - AS_FAR) * due - 1e-5))
            fprintf(stderr, "%llu,%d,%.6g,%.6g,%.6g,lag %g,flags %u\n", (unsigned long long)seed, tick, 1e3 * far, 1e3 * due, 1e3*apart(path.at, rig.proxy.position), rig.force.lag, rig.force.flags);
    }
    ball_path_close(&path);
    rig_close(&rig);
}

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
            struct sums sums = { 0 };
            if (radius > 0 && radius != radii[r])
                continue;
            for (int i = 0; i < runs; i++)
                run_once(&solid, radii[r], 1000 + (uint64_t)i, &sums);
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
