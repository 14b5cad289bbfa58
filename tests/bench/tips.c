/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a tick costs with a tip beside a bare segment. Tools of about 30 mm come down on random places of a mesh at 0.1 m/s, to
 * 5 mm below it, then slide by 0.1 mm and turn by 1 mrad a tick. All tools take the same ticks, in turns. A CSV: mesh,
 * triangles, tool, its corners, friction, how many contacts the world has, the ticks on which it was held, median and 99 % of these in us of processor time,
 * both as a share of the segment's, the least gap of the proxy that a query finds on each 50th of them, m, and the folds.
 *
 *     tips [RUNS=40]
 */
#define _GNU_SOURCE
#include <stdio.h>
#include <string.h>

#include "dynpoint/tip.h"
#include "lib/solid.h"
#include "timing.h"

enum { TICKS = 600, TOOLS = 5, EACH = 50 };

static const struct tool_kind {
    const char *name;
    int has_tip;
    uint32_t kind, sides;
    double extent[3];
} kinds[TOOLS] = { { "segment", 0, 0, 0, { 0 } },
                   { "blade", 1, DPT_HULL_KIND_WEDGE, 0, { 0.03, 0.001, 0.008 } },
                   { "plate", 1, DPT_HULL_KIND_BOX, 0, { 0.03, 0.008, 0.001 } },
                   { "cone", 1, DPT_HULL_KIND_CONE, 15, { 0.004, 0, 0.012 } },
                   { "cylinder", 1, DPT_HULL_KIND_CYLINDER, 8, { 0.006, 0, 0.012 } } };

struct held_world {
    void *block;
    dpt_world *world;
    dpt_tool tool;
    uint64_t hull_block[2048];
    const dpt_hull *hull;
    double *took;
    uint32_t corners, held, folds;
    double least;
};

static void fail(const char *what)
{
    fprintf(stderr, "tips: %s\n", what);
    exit(2);
}

static void make_hull(const struct tool_kind *kind, struct held_world *stage)
{
    double corners[3 * DPT_HULL_CORNERS_MAX];
    dpt_hull_shape shape = { .size = sizeof shape, .kind = kind->kind, .sides = kind->sides };
    dpt_hull_def def = { .size = sizeof def, .corners = corners };
    memcpy(shape.extent, kind->extent, sizeof shape.extent);
    if (dpt_hull_shape_corners(&shape, corners, DPT_HULL_CORNERS_MAX, &def.corner_count) ||
        dpt_hull_create(stage->hull_block, sizeof stage->hull_block, &def, &stage->hull))
        fail("no hull");
    stage->corners = def.corner_count;
}

static void open_stage(struct held_world *stage, const struct solid *solid, const struct tool_kind *kind,
                       double friction, uint32_t contacts, uint32_t ticks)
{
    const dpt_segment rod = { { -0.015, 0, 0 }, { 0.015, 0, 0 }, 0.002 }, point = { { 0 }, { 0 }, 0 };
    dpt_body_settings settings = { .size = sizeof settings };
    dpt_world_def def;
    dpt_body body;
    dpt_world_def_init(&def);
    def.max_contacts = contacts;
    memset(stage, 0, sizeof *stage);
    stage->least = 1;
    stage->took = malloc(ticks * sizeof *stage->took);
    stage->block = malloc(dpt_world_bytes(&def));
    if (!stage->took || !stage->block || dpt_world_create(stage->block, dpt_world_bytes(&def), &def, &stage->world) ||
        dpt_body_add(stage->world, solid->mesh, NULL, &body) || dpt_body_get_settings(stage->world, body, &settings) ||
        dpt_tool_add(stage->world, kind->has_tip ? &point : &rod, 1, &stage->tool))
        fail("no world");
    settings.static_friction = settings.kinetic_friction = friction;
    dpt_body_set_settings(stage->world, body, &settings);
    if (!kind->has_tip)
        return;
    make_hull(kind, stage);
    const dpt_tip tip = { .size = sizeof tip, .hull = stage->hull };
    if (dpt_tool_set_tips(stage->world, stage->tool, &tip, 1))
        fail("no tip");
}

/* One tick; what it took counts while the tool is held. */
static void tick(struct held_world *stage, const struct solid *solid, const dpt_pose *pose, int number)
{
    dpt_force_info force = { .size = sizeof force };
    const double begin = processor_time();
    const dpt_result result = number ? dpt_tool_set_pose(stage->world, stage->tool, pose)
                                     : dpt_tool_teleport(stage->world, stage->tool, pose);
    if (result || dpt_world_step(stage->world, 1e-3, NULL))
        fail("no step");
    const double took = processor_time() - begin;
    dpt_tool_get_force_info(stage->world, stage->tool, &force);
    if (force.reason != DPT_FORCE_ACTS)
        return;
    stage->took[stage->held++] = took;
    stage->folds += (force.flags & DPT_FORCE_FLAG_FOLD) != 0;
    if (!stage->hull || stage->held % EACH)
        return;
    dpt_hit hit = DPT_HIT_INIT;
    dpt_pose proxy;
    dpt_tool_get_proxy(stage->world, stage->tool, &proxy);
    dpt_query_hull(solid->mesh, NULL, stage->hull, &proxy, &hit);
    stage->least = hit.distance < stage->least ? hit.distance : stage->least;
}

/* A place of the mesh, the way out, a way along, and an orientation. */
struct place {
    double at[3], out[3], along[3], turn[3];
    dpt_pose pose;
};

static struct place any_place(const struct solid *solid, uint64_t *seed)
{
    const float *v = solid->corners + 9 * (random_bits(seed) % solid->info.triangles);
    struct place place;
    double e[3], f[3], square = 0;
    for (int k = 0; k < 3; k++) {
        place.at[k] = (v[k] + v[3 + k] + v[6 + k]) / 3.0;
        e[k] = v[3 + k] - v[k];
        f[k] = v[6 + k] - v[k];
        place.turn[k] = random_in(seed, -1, 1);
    }
    for (int k = 0; k < 3; k++)
        place.out[k] = e[(k + 1) % 3] * f[(k + 2) % 3] - e[(k + 2) % 3] * f[(k + 1) % 3];
    memcpy(place.along, e, sizeof e);
    unit3(place.out);
    unit3(place.along);
    unit3(place.turn);
    for (int k = 0; k < 4; k++) {
        place.pose.orientation[k] = random_in(seed, -1, 1);
        square += place.pose.orientation[k] * place.pose.orientation[k];
    }
    for (int k = 0; k < 4; k++)
        place.pose.orientation[k] /= sqrt(square);
    return place;
}

/* q = turn * q, of a small turn about a unit axis. */
static void turn_by(double q[4], const double axis[3], double angle)
{
    const double w = cos(angle / 2), s = sin(angle / 2);
    const double d[4] = { w, s * axis[0], s * axis[1], s * axis[2] }, o[4] = { q[0], q[1], q[2], q[3] };
    q[0] = d[0] * o[0] - d[1] * o[1] - d[2] * o[2] - d[3] * o[3];
    q[1] = d[0] * o[1] + d[1] * o[0] + d[2] * o[3] - d[3] * o[2];
    q[2] = d[0] * o[2] - d[1] * o[3] + d[2] * o[0] + d[3] * o[1];
    q[3] = d[0] * o[3] + d[1] * o[2] - d[2] * o[1] + d[3] * o[0];
}

static void run(struct held_world *stages, const struct solid *solid, uint64_t *seed)
{
    struct place place = any_place(solid, seed);
    double down = 0.03, slid = 0;
    for (int number = 0; number < TICKS; number++) {
        down = fmax(-0.005, down - 1e-4 * (number > 0));
        slid += down == -0.005 ? 1e-4 : 0;
        for (int k = 0; k < 3; k++)
            place.pose.position[k] = place.at[k] + down * place.out[k] + slid * place.along[k];
        if (slid > 0)
            turn_by(place.pose.orientation, place.turn, 1e-3);
        for (int t = 0; t < TOOLS; t++)
            tick(&stages[t], solid, &place.pose, number);
    }
}

static void measure(const char *name, uint64_t count, double friction, uint32_t contacts, int runs)
{
    struct solid solid;
    struct held_world stages[TOOLS];
    uint64_t seed = 7;
    if (!solid_from_shape(&solid, name, count))
        fail(name);
    for (int t = 0; t < TOOLS; t++)
        open_stage(&stages[t], &solid, &kinds[t], friction, contacts, (uint32_t)runs * TICKS);
    for (int i = 0; i < runs; i++)
        run(stages, &solid, &seed);
    double median = 0, slow = 0;
    for (int t = 0; t < TOOLS; t++) {
        struct held_world *stage = &stages[t];
        qsort(stage->took, stage->held, sizeof *stage->took, by_size);
        const double half = stage->took[stage->held / 2], most = stage->took[stage->held * 99u / 100u];
        median = t ? median : half;
        slow = t ? slow : most;
        printf("%s,%u,%s,%u,%g,%u,%u,%.1f,%.1f,%.2f,%.2f,", name, solid.info.triangles, kinds[t].name, stage->corners,
               friction, contacts, stage->held, half, most, half / median, most / slow);
        if (stage->hull)
            printf("%.3g", stage->least);
        printf(",%u\n", stage->folds);
        free(stage->took);
        free(stage->block);
    }
    solid_close(&solid);
}

int main(int argc, char **argv)
{
    const int runs = argc > 1 ? atoi(argv[1]) : 40;
    if (runs < 1)
        fail("RUNS is a number above 0");
    puts("mesh,triangles,tool,corners,friction,contacts,held,median_us,p99_us,median_ratio,p99_ratio,least_gap,folds");
    measure("liver", 50332, 0, 32, runs);
    measure("liver", 50332, 0, 0, runs);
    measure("liver", 50332, 0.3, 0, runs);
    measure("torus", 61358, 0, 0, runs);
    measure("star", 20480, 0, 0, runs);
    return 0;
}
