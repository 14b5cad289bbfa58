/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a tick of a proxy takes, without contacts: a ball of 1 mm, a line of 0.1 m with a radius of 1 mm, a thin one of
 * 0.2 m without, a fork of three segments; and tools with a tip of 30 mm at the end of a point: a blade, a plate and a
 * cone of 16 corners.
 *
 *     open   20 mm above the mesh, at 0.1 m/s
 *     rest   pressed 3 mm in, with a tremor of 0.05 mm
 *     wipe   3 mm below the surface, from place to place at 0.1 m/s
 *     fast   the same at 1 m/s
 *     poke   in and out by 5 mm, at one place after another
 *     move   as wipe, but the tool rests and the mesh moves
 *     twin   as wipe, over two meshes: the second one is moved by some mm, so that each is outside in places
 *     sway   as twin, but the second mesh goes to and fro by 2 mm, once in a second
 *
 * A CSV: mesh, triangles, tool, motion, friction, ticks, median, 99 % and worst in us of processor time, the least of
 * REPEATS runs; then the sum of all forces, N: two builds that feel the same print the same.
 *
 *     proxy_ticks [MESH=liver [TOOL [MOTION [TICKS=20000 [FRICTION=0 [REPEATS=3]]]]]]
 *
 * MESH is liver, torus, star, or veins and stomach from the folder DPT_DATA. TOOL and MOTION "": all. proxy_ticks.sh runs two builds in turns.
 */
#define _GNU_SOURCE
#include <stdio.h>
#include <string.h>

#include "dynpoint/tip.h"
#include "lib/pose.h"
#include "lib/solid.h"
#include "timing.h"

enum { OPEN, REST, WIPE, FAST, POKE, MOVE, TWIN, SWAY, MOTIONS };
enum { BALL, LINE, THIN, FORK, BLADE, PLATE, CONE, TOOLS };

static const char *const hand_motions[MOTIONS] = { "open", "rest", "wipe", "fast", "poke", "move", "twin", "sway" };

static const struct {
    const char *name;
    uint32_t count;
    dpt_segment segments[3];
    uint32_t tip, sides; /* the tip's kind; UINT32_MAX: there is none */
    double extent[3];
} tools[TOOLS] = { { "ball", 1, { { { 0, 0, 0 }, { 0, 0, 0 }, 1e-3 } }, UINT32_MAX, 0, { 0 } },
                   { "line", 1, { { { 0, 0, 0 }, { 0, 0, 0.1 }, 1e-3 } }, UINT32_MAX, 0, { 0 } },
                   { "thin", 1, { { { 0, 0, 0 }, { 0, 0, 0.2 }, 0 } }, UINT32_MAX, 0, { 0 } },
                   { "fork",
                     3,
                     { { { 0, 0, 0.02 }, { 0, 0, 0.1 }, 1e-3 },
                       { { 0, 0, 0.02 }, { 0.005, 0, 0 }, 1e-3 },
                       { { 0, 0, 0.02 }, { -0.005, 0, 0 }, 1e-3 } },
                     UINT32_MAX,
                     0,
                     { 0 } },
                   { "blade", 1, { { { 0 }, { 0 }, 0 } }, DPT_HULL_KIND_WEDGE, 0, { 0.03, 0.001, 0.008 } },
                   { "plate", 1, { { { 0 }, { 0 }, 0 } }, DPT_HULL_KIND_BOX, 0, { 0.03, 0.008, 0.001 } },
                   { "cone", 1, { { { 0 }, { 0 }, 0 } }, DPT_HULL_KIND_CONE, 15, { 0.004, 0, 0.012 } } };

enum { SETTLED = 100, STAY = 500 };

#define PRESSED 3e-3
#define POKED   5e-3
#define ABOVE   0.02
#define TREMOR  5e-5
#define HOP     0.04

/* m: where the second mesh is. */
static const double aside[3] = { 3e-3, 2e-3, -1e-3 };

static const struct {
    const char *name;
    uint64_t triangles;
    const char *file; /* below the folder DPT_DATA, in mm; NULL: a shape */
} meshes[] = { { "liver", 50332, NULL },
               { "torus", 61358, NULL },
               { "star", 20480, NULL },
               { "veins", 14600, "meshes/organs/hepatic_veins_sks.obj" },
               { "stomach", 9724, "meshes/organs/openhelp_stomach.stl" } };

/* A mesh of the list. */
static int open_mesh(struct solid *solid, size_t mesh)
{
    const char *data = getenv("DPT_DATA");
    char path[1024];
    if (!meshes[mesh].file)
        return solid_from_shape(solid, meshes[mesh].name, meshes[mesh].triangles);
    snprintf(path, sizeof path, "%s/%s", data ? data : ".", meshes[mesh].file);
    return solid_from_file(solid, meshes[mesh].name, path, 1e-3);
}

struct hand {
    const struct solid *solid;
    int motion, tool;
    uint64_t seed;
    double at[3], out[3];        /* a place on the surface, and away from it */
    double next[3], next_out[3]; /* where it goes */
    double gone, way;            /* m, on the way there */
};

static void fail(const char *what)
{
    fprintf(stderr, "proxy_ticks: %s\n", what);
    exit(2);
}

static void go_on(struct hand *hand)
{
    memcpy(hand->at, hand->next, sizeof hand->at);
    memcpy(hand->out, hand->next_out, sizeof hand->out);
    do
        solid_random_place(hand->solid, &hand->seed, hand->next, hand->next_out);
    while (apart(hand->at, hand->next) > HOP || apart(hand->at, hand->next) == 0.0);
    hand->way = apart(hand->at, hand->next);
    hand->gone = 0;
}

static double height_at(const struct hand *hand, int tick)
{
    if (tick < SETTLED)
        return ABOVE - (hand->motion == OPEN ? 0.0 : (ABOVE + PRESSED) * tick / SETTLED);
    if (hand->motion == POKE)
        return POKED * cos(6.2831853 * tick / STAY);
    return hand->motion == OPEN ? ABOVE : -PRESSED;
}

static void hand_pose(struct hand *hand, int tick, dpt_pose *pose)
{
    const double step = hand->motion == FAST ? 1e-3 : 1e-4;
    const int moves = hand->motion != REST && hand->motion != POKE;
    double tilted[3], out[3];
    if (tick >= SETTLED && moves && (hand->gone += step) >= hand->way)
        go_on(hand);
    if (tick >= SETTLED && hand->motion == POKE && tick % STAY == 0)
        go_on(hand);
    const double share = moves ? hand->gone / hand->way : 0.0, height = height_at(hand, tick);
    for (int k = 0; k < 3; k++)
        out[k] = hand->out[k] + share * (hand->next_out[k] - hand->out[k]);
    unit3(out);
    for (int k = 0; k < 3; k++) {
        pose->position[k] = hand->at[k] + share * (hand->next[k] - hand->at[k]) + height * out[k];
        if (hand->motion == REST && tick >= SETTLED)
            pose->position[k] += TREMOR * sin((0.06 + 0.007 * k) * tick + k);
        tilted[k] = out[k];
    }
    tilted[0] += 1.2;
    unit3(tilted);
    turn_from_z(tilted, pose->orientation);
}

/* A hand that moves over a mesh, as a mesh that moves under a hand. */
static void exchange(dpt_pose *pose, dpt_pose *body)
{
    static const double origin[3] = { 0, 0, 0 };
    pose_local(pose, origin, body->position);
    for (int k = 0; k < 4; k++)
        body->orientation[k] = k == 0 ? pose->orientation[k] : -pose->orientation[k];
    *pose = (dpt_pose)DPT_POSE_IDENTITY;
}

/* Give a tool its tip; the hull lies in a block that lasts. */
static int add_tip(dpt_world *world, dpt_tool handle, int tool)
{
    static uint64_t block[2048];
    double corners[3 * DPT_HULL_CORNERS_MAX];
    dpt_hull_shape shape = { .size = sizeof shape, .kind = tools[tool].tip, .sides = tools[tool].sides };
    dpt_hull_def def = { .size = sizeof def, .corners = corners };
    dpt_tip tip = { .size = sizeof tip };
    memcpy(shape.extent, tools[tool].extent, sizeof shape.extent);
    return !dpt_hull_shape_corners(&shape, corners, DPT_HULL_CORNERS_MAX, &def.corner_count) &&
           !dpt_hull_create(block, sizeof block, &def, &tip.hull) && !dpt_tool_set_tips(world, handle, &tip, 1);
}

/* Returns the sum of all forces; took[]: of each tick after the first ones, us. */
static double run(const struct solid *solid, int tool, int motion, int ticks, double friction, double *took)
{
    struct hand hand = { .solid = solid, .motion = motion, .tool = tool, .seed = 7 };
    dpt_world_def def;
    dpt_world *world;
    dpt_body body;
    dpt_tool handle;
    dpt_body_settings settings = { .size = sizeof settings };
    dpt_pose pose, place = DPT_POSE_IDENTITY;
    double sum = 0;
    dpt_world_def_init(&def);
    def.until = DPT_UNTIL_RESPOND;
    def.max_contacts = 0;
    void *block = malloc(dpt_world_bytes(&def));
    if (!block || dpt_world_create(block, dpt_world_bytes(&def), &def, &world) ||
        dpt_body_add(world, solid->mesh, NULL, &body) ||
        dpt_tool_add(world, tools[tool].segments, tools[tool].count, &handle) ||
        dpt_body_get_settings(world, body, &settings))
        fail("no world");
    if (tools[tool].tip != UINT32_MAX && !add_tip(world, handle, tool))
        fail("no tip");
    settings.static_friction = settings.kinetic_friction = friction;
    if (dpt_body_set_settings(world, body, &settings))
        fail("no settings");
    memcpy(place.position, aside, sizeof aside);
    if ((motion == TWIN || motion == SWAY) &&
        (dpt_body_add(world, solid->mesh, &place, &body) || dpt_body_set_settings(world, body, &settings)))
        fail("no second body");
    solid_random_place(solid, &hand.seed, hand.next, hand.next_out);
    go_on(&hand);
    for (int tick = 0; tick < SETTLED + ticks; tick++) {
        dpt_wrench wrench;
        hand_pose(&hand, tick, &pose);
        if (motion == MOVE)
            exchange(&pose, &place);
        if (motion == SWAY)
            place.position[0] = aside[0] + 2e-3 * sin(6.2831853e-3 * tick);
        const double begin = processor_time();
        if ((motion == MOVE || motion == SWAY) && dpt_body_set_pose(world, body, &place))
            fail("no place");
        if (tick ? dpt_tool_set_pose(world, handle, &pose) : dpt_tool_teleport(world, handle, &pose))
            fail("no pose");
        if (dpt_world_step(world, 1e-3, NULL) || dpt_tool_get_wrench(world, handle, &wrench))
            fail("no step");
        if (tick >= SETTLED)
            took[tick - SETTLED] = processor_time() - begin;
        sum += length3(wrench.force);
    }
    free(block);
    return sum;
}

static void measure(size_t mesh, int tool, int motion, int ticks, double friction, int repeats)
{
    const char *name = meshes[mesh].name;
    struct solid solid;
    double best[3] = { INFINITY, INFINITY, INFINITY }, sum = 0;
    double *took = malloc((size_t)ticks * sizeof *took);
    if (!took || !open_mesh(&solid, mesh))
        fail(name);
    for (int i = 0; i < repeats; i++) {
        sum = run(&solid, tool, motion, ticks, friction, took);
        qsort(took, (size_t)ticks, sizeof *took, by_size);
        best[0] = fmin(best[0], took[ticks / 2]);
        best[1] = fmin(best[1], took[(int)(0.99 * ticks)]);
        best[2] = fmin(best[2], took[ticks - 1]);
    }
    printf("%s,%u,%s,%s,%g,%d,%.2f,%.2f,%.1f,%.17g\n", name, solid.info.triangles, tools[tool].name,
           hand_motions[motion], friction, ticks, best[0], best[1], best[2], sum);
    fflush(stdout);
    free(took);
    solid_close(&solid);
}

int main(int argc, char **argv)
{
    const char *mesh = argc > 1 ? argv[1] : "liver", *tool = argc > 2 ? argv[2] : "", *motion = argc > 3 ? argv[3] : "";
    const int ticks = argc > 4 ? atoi(argv[4]) : 20000;
    const double friction = argc > 5 ? atof(argv[5]) : 0.0;
    const int repeats = argc > 6 ? atoi(argv[6]) : 3;
    if (ticks < 1 || repeats < 1)
        fail("TICKS and REPEATS are numbers above 0");
    puts("mesh,triangles,tool,motion,friction,ticks,median_us,p99_us,worst_us,force");
    for (size_t m = 0; m < sizeof meshes / sizeof *meshes; m++)
        for (int t = 0; t < TOOLS && !strcmp(mesh, meshes[m].name); t++)
            for (int k = 0; k < MOTIONS; k++)
                if ((!*tool || !strcmp(tool, tools[t].name)) && (!*motion || !strcmp(motion, hand_motions[k])))
                    measure(m, t, k, ticks, friction, repeats);
    return 0;
}
