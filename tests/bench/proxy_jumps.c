/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a hand must not feel of a proxy as set by default, over five meshes: two of them real organs below DPT_DATA.
 *
 *     proxy_jumps [RUNS=20 [MESH [TOOL [MOTION [HOLDING [FRICTION=0]]]]]]
 *
 * MESH, TOOL, MOTION, HOLDING "": all. A CSV, of RUNS runs of 2,000 ticks each:
 *
 *     jumps     ticks in which the wrench changed by more than K (3 |device's motion|_M + 1 m/s dt), and the largest of
 *               all changes as a share of that
 *     puts      proxies that were put, and how many of them while the device had turned by less than 1 rad since it was
 *               free last
 *     passed    a proxy with a force or in the open that is on the other side of a closed mesh
 *     overlaps  triangles nearer than the radius
 *
 * Each one is told on standard error, too.
 */
#define _GNU_SOURCE
#include <stdio.h>

#include "bench_mesh.h"
#include "lib/hand_motion.h"
#include "lib/rig.h"
#include "proxy/soak_oracle.h"

enum { RUN_TICKS = 2000, JUDGED_EACH = 16, RUNS = 20 };

#define DEPTH       3e-3
#define POKED       5e-3
#define FOLD_SPEED  1.0
#define ROUNDING    1e-6
#define OVERLAPPING 1e-9

static const struct {
    const char *name;
    dpt_segment segment;
} tools[] = { { "ball", { { 0, 0, 0 }, { 0, 0, 0 }, 1e-3 } },
              { "line", { { 0, 0, 0 }, { 0, 0, 0.1 }, 0 } },
              { "rod", { { 0, 0, 0 }, { 0, 0, 0.1 }, 1e-3 } } };
enum { TOOLS = sizeof tools / sizeof *tools };

struct counts {
    uint64_t ticks, acts, jumps, puts, put_early, passed, overlaps, folds;
    double largest; /* jump, as a share of the bound */
    double force;   /* N, sum */
};

struct run {
    const char *name;
    struct soak_oracle *oracle;
    struct rig rig;
    struct hand hand;
    double stiffness, rho, friction;
    double free_turn[3]; /* the tool's axis when it was free last */
    int was_inside, was_put;
    struct counts *counts;
};

static void axis_of(const struct run *run, const dpt_pose *pose, double axis[3], double centre[3])
{
    double ends[6];
    pose_ends(pose, &run->rig.segments[0], ends);
    point_at(ends, 0.5, centre);
    for (int k = 0; k < 3; k++)
        axis[k] = ends[3 + k] - ends[k];
    unit3(axis);
}

static double angle(const double a[3], const double b[3])
{
    double across[3];
    cross3(a, b, across);
    return atan2(length3(across), dot3(a, b));
}

/* The norm of the device's motion. */
static double motion(const struct run *run, const dpt_pose *from, const dpt_pose *to)
{
    double u[3], v[3], c[3], d[3];
    axis_of(run, from, u, c);
    axis_of(run, to, v, d);
    const double shift = apart(c, d), turn = run->rho * angle(u, v);
    return sqrt(shift * shift + turn * turn);
}

/* Force, and torque about the device's centre over rho. */
static void felt(const struct run *run, double w[6])
{
    const dpt_wrench *wrench = &run->rig.force.wrench;
    double axis[3], centre[3], lever[3], moment[3];
    axis_of(run, &run->rig.device, axis, centre);
    for (int k = 0; k < 3; k++)
        lever[k] = centre[k] - run->rig.device.position[k];
    cross3(lever, wrench->force, moment);
    for (int k = 0; k < 3; k++) {
        w[k] = wrench->force[k];
        w[3 + k] = run->rho > 0 ? (wrench->torque[k] - moment[k]) / run->rho : 0;
    }
}

static void tell(const struct run *run, const char *what, double value, double turned)
{
    const dpt_force_info *force = &run->rig.force;
    double u[3], v[3], c[3];
    axis_of(run, &run->rig.device, u, c);
    axis_of(run, &run->rig.proxy, v, c);
    fprintf(stderr, "%s,%llu,%s,%g,reason %u,flags %u,force %.3g,device turned %.2f,from the proxy %.2f\n", run->name,
            (unsigned long long)run->hand.tick, what, value, force->reason, force->flags, length3(force->wrench.force),
            turned, run->rho > 0 ? angle(u, v) : 0.0);
}

static void judge_side(struct run *run, double turned)
{
    double ends[6];
    uint64_t seed = run->hand.tick;
    rig_proxy_ends(&run->rig, 0, ends);
    const double radius = run->rig.segments[0].radius;
    const double gap = soak_distance(run->oracle, ends, radius + 2e-3) - radius;
    if (gap < -OVERLAPPING) {
        run->counts->overlaps++;
        tell(run, "overlaps", gap, turned);
    }
    if (!run->oracle->is_closed)
        return;
    const int is_inside = soak_is_inside(run->oracle, ends, &seed) || soak_is_inside(run->oracle, ends + 3, &seed);
    if (is_inside && !run->was_inside) {
        run->counts->passed++;
        tell(run, "passed", gap, turned);
    }
    run->was_inside = is_inside;
}

static void tick(struct run *run)
{
    struct counts *counts = run->counts;
    const dpt_pose before = run->rig.device;
    double was[6], is[6], axis[3], centre[3], change = 0;
    felt(run, was);
    hand_move(&run->hand, &run->rig.device);
    rig_step(&run->rig);
    felt(run, is);
    const dpt_force_info *force = &run->rig.force;
    for (int k = 0; k < 6; k++)
        change += (is[k] - was[k]) * (is[k] - was[k]);
    axis_of(run, &run->rig.device, axis, centre);
    if (force->reason == DPT_FORCE_FREE)
        memcpy(run->free_turn, axis, sizeof axis);
    const double turned = run->rho > 0 ? angle(axis, run->free_turn) : 0;
    const double bound = run->stiffness * (3 * motion(run, &before, &run->rig.device) + FOLD_SPEED * RIG_DT);
    const double jump = sqrt(change) / bound;
    const int is_put =
        force->reason > DPT_FORCE_FREE || force->flags & (DPT_FORCE_FLAG_REPLACED | DPT_FORCE_FLAG_SQUEEZED);
    counts->ticks++;
    counts->acts += force->reason == DPT_FORCE_ACTS;
    counts->force += length3(force->wrench.force);
    counts->largest = fmax(counts->largest, jump);
    if (jump > 1 + ROUNDING) {
        counts->jumps++;
        tell(run, "jump", jump, turned);
    }
    if (is_put && !run->was_put) {
        counts->puts++;
        counts->put_early += turned < 1;
        tell(run, "put", 0, turned);
    }
    run->was_put = is_put;
    if (!is_put && (run->hand.tick % JUDGED_EACH == 0 || jump > 0.9))
        judge_side(run, turned);
}

static void run_once(struct soak_oracle *oracle, int tool, int motions, int holding, double friction, uint64_t seed,
                     struct counts *counts)
{
    char name[160];
    struct run run = { .oracle = oracle, .counts = counts, .name = name };
    dpt_tool_settings settings = { .size = sizeof settings };
    dpt_body_settings body = { .size = sizeof body };
    snprintf(name, sizeof name, "%s,%s,%s,%s,%g,%llu", oracle->solid->name, tools[tool].name, hand_motion_names[motions],
             hand_holding_names[holding], friction, (unsigned long long)seed);
    hand_begin(&run.hand, oracle->solid, motions, holding, motions == HAND_POKE ? POKED : DEPTH, seed);
    rig_open(&run.rig, NULL, oracle->solid->mesh, &tools[tool].segment, 1);
    dpt_tool_get_settings(run.rig.world, run.rig.tool, &settings);
    dpt_body_get_settings(run.rig.world, run.rig.body, &body);
    body.static_friction = body.kinetic_friction = friction;
    rig_set_body(&run.rig, body);
    run.stiffness = settings.stiffness;
    run.rho = apart(tools[tool].segment.a, tools[tool].segment.b) / sqrt(12);
    hand_move(&run.hand, &run.rig.device);
    rig_place(&run.rig);
    /* A place in a fold of the mesh has no room above it. */
    const int ticks = run.rig.force.reason == DPT_FORCE_FREE ? RUN_TICKS : 0;
    for (int i = 0; i < ticks; i++)
        tick(&run);
    counts->folds += run.rig.force.folds;
    rig_close(&run.rig);
}

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
    puts("mesh,triangles,tool,motion,holding,friction,ticks,acts,jumps,largest,puts,put_early,passed,overlaps,folds,mean_N");
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
                    struct counts c = { 0 };
                    if (!is_wanted(wanted[1], tools[t].name) || !is_wanted(wanted[2], hand_motion_names[k]) ||
                        !is_wanted(wanted[3], hand_holding_names[h]))
                        continue;
                    for (int i = 0; i < runs; i++)
                        run_once(&oracle, t, k, h, friction, 1000 + (uint64_t)i, &c);
                    printf("%s,%u,%s,%s,%s,%g,%llu,%llu,%llu,%.3f,%llu,%llu,%llu,%llu,%llu,%.3f\n", bench_meshes[m].name,
                           solid.info.triangles, tools[t].name, hand_motion_names[k], hand_holding_names[h], friction,
                           (unsigned long long)c.ticks, (unsigned long long)c.acts, (unsigned long long)c.jumps,
                           c.largest, (unsigned long long)c.puts, (unsigned long long)c.put_early,
                           (unsigned long long)c.passed, (unsigned long long)c.overlaps, (unsigned long long)c.folds,
                           c.ticks ? c.force / (double)c.ticks : 0.0);
                    fflush(stdout);
                }
        soak_oracle_close(&oracle);
        solid_close(&solid);
    }
    return check_report();
}
