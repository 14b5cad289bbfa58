/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a tick costs while the tool stands still. A tool of 0.15 m with a radius of 2 mm comes down on a mesh at 0.1 m/s to 5 mm
 * below its highest point, and stays there. In a second world a setting is given again before every tick, to what it is: there
 * nothing rests. A CSV: mesh, triangles, law, friction, tip or lying, the share of the still ticks that rest, and the median ns
 * of a tick of both worlds.
 *
 *     rests [TICKS=2000]
 */
#define _GNU_SOURCE
#include <stdio.h>

#include "lib/fixture.h"
#include "timing.h"

struct stage {
    dpt_world *world;
    dpt_tool tool;
    void *block;
};

static void open_stage(struct stage *stage, const dpt_mesh *mesh, uint32_t law, double friction, int lies)
{
    const dpt_segment lying = { { -0.075, 0.0, 0.0 }, { 0.075, 0.0, 0.0 }, 0.002 };
    const dpt_segment tip = { { 0.0, 0.0, 0.0 }, { 0.05, 0.0, 0.14 }, 0.002 };
    dpt_body_settings settings = { .size = sizeof settings };
    dpt_world_def def;
    dpt_body body;
    dpt_world_def_init(&def);
    def.law = law;
    stage->block = malloc(dpt_world_bytes(&def));
    if (!stage->block || dpt_world_create(stage->block, dpt_world_bytes(&def), &def, &stage->world) ||
        dpt_body_add(stage->world, mesh, NULL, &body) ||
        dpt_tool_add(stage->world, lies ? &lying : &tip, 1, &stage->tool) ||
        dpt_body_get_settings(stage->world, body, &settings))
        exit(2);
    settings.static_friction = friction;
    settings.kinetic_friction = 0.75 * friction;
    if (dpt_body_set_settings(stage->world, body, &settings))
        exit(2);
}

/* One tick; ns. */
static double tick(const struct stage *stage, const dpt_pose *pose, int is_nudged)
{
    dpt_tool_settings settings = { .size = sizeof settings };
    dpt_tool_get_settings(stage->world, stage->tool, &settings);
    if (is_nudged)
        dpt_tool_set_settings(stage->world, stage->tool, &settings);
    const double begin = now();
    dpt_tool_set_pose(stage->world, stage->tool, pose);
    if (dpt_world_step(stage->world, 1e-3, NULL))
        exit(2);
    return now() - begin;
}

static void measure(const char *name, const dpt_mesh *mesh, uint32_t law, double friction, int lies, int ticks)
{
    static const char *const laws[] = { "bed", "point", "proxy" };
    double *took[2] = { malloc((size_t)ticks * sizeof(double)), malloc((size_t)ticks * sizeof(double)) };
    dpt_mesh_info info = { .size = sizeof info };
    struct stage stage[2];
    int rested = 0;
    if (!took[0] || !took[1] || dpt_mesh_get_info(mesh, &info))
        exit(2);
    for (int s = 0; s < 2; s++)
        open_stage(&stage[s], mesh, law, friction, lies);
    dpt_pose pose = { { 0.0, 0.0, info.box_max[2] + 0.05 }, { 1.0, 0.0, 0.0, 0.0 } };
    for (int k = 0; k < 2; k++)
        pose.position[k] = 0.5 * (info.box_min[k] + info.box_max[k]);
    for (; pose.position[2] > info.box_max[2] - 0.005; pose.position[2] -= 1e-4)
        for (int s = 0; s < 2; s++)
            tick(&stage[s], &pose, s);
    for (int i = 0; i < ticks; i++) {
        dpt_hit hit = { .size = sizeof hit };
        for (int s = 0; s < 2; s++)
            took[s][i] = tick(&stage[s], &pose, s);
        dpt_tool_get_hit(stage[0].world, stage[0].tool, &hit);
        rested += hit.work == 0;
    }
    for (int s = 0; s < 2; s++) {
        qsort(took[s], (size_t)ticks, sizeof *took[s], by_size);
        free(stage[s].block);
    }
    printf("%s,%u,%s,%g,%s,%.3f,%.0f,%.0f\n", name, info.triangles,
           law == DPT_LAW_BED     ? laws[0]
           : law == DPT_LAW_POINT ? laws[1]
                                  : laws[2],
           friction, lies ? "lying" : "tip", (double)rested / ticks, took[0][ticks / 2], took[1][ticks / 2]);
    free(took[0]);
    free(took[1]);
}

int main(int argc, char **argv)
{
    static const struct {
        const char *name;
        uint64_t triangles;
    } shapes[] = { { "liver", 50332 }, { "torus", 61358 }, { "star", 20480 } };
    const int ticks = argc > 1 ? atoi(argv[1]) : 2000;
    puts("mesh,triangles,law,friction,tool,rested,rest_ns,nudged_ns");
    for (size_t i = 0; i < sizeof shapes / sizeof shapes[0]; i++) {
        struct fixture fixture;
        if (ticks < 1 || !fixture_from_shape(&fixture, shapes[i].name, shapes[i].triangles))
            return 2;
        for (int lies = 0; lies < 2; lies++) {
            measure(shapes[i].name, fixture.mesh, DPT_LAW_POINT, 0.0, lies, ticks);
            measure(shapes[i].name, fixture.mesh, DPT_LAW_BED, 0.0, lies, ticks);
            measure(shapes[i].name, fixture.mesh, DPT_LAW_PROXY, 0.0, lies, ticks);
            measure(shapes[i].name, fixture.mesh, DPT_LAW_PROXY, 0.4, lies, ticks);
        }
        fixture_free(&fixture);
    }
    return 0;
}
