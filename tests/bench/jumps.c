/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a nearest pair costs after motions of each length, with kept planes and by the tree alone. A tool of 0.15 m walks
 * about a mesh in steps of one length, and turns to another way after each eighth. A CSV: mesh, triangles, step in m, and
 * microseconds of processor time of the methods exact and tree: median, 99 %, and how many times the tree's time.
 *
 *     jumps [STEPS=4000]
 */
#define _GNU_SOURCE
#include <math.h>
#include <stdio.h>

#include "lib/arm_random.h"
#include "lib/fixture.h"
#include "lib/random.h"
#include "timing.h"

struct times {
    double median, p99;
};

static struct times walk(const dpt_mesh *mesh, uint32_t method, double step, int steps)
{
    dpt_mesh_info info = { .size = sizeof info };
    dpt_world_def def;
    dpt_world *world;
    dpt_body body;
    dpt_tool tool;
    const dpt_segment segment = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.15 }, 0.002 };
    double *took = malloc((size_t)steps * sizeof *took), way[3] = { 0.0, 0.0, 0.0 };
    uint64_t rng = 11;
    dpt_world_def_init(&def);
    def.law = DPT_LAW_POINT;
    def.until = DPT_UNTIL_TRACK;
    def.method = method;
    void *block = malloc(dpt_world_bytes(&def));
    if (!took || !block || dpt_mesh_get_info(mesh, &info) ||
        dpt_world_create(block, dpt_world_bytes(&def), &def, &world) || dpt_body_add(world, mesh, NULL, &body) ||
        dpt_tool_add(world, &segment, 1, &tool))
        exit(2);
    dpt_pose pose = pose_random(&rng, 0.0);
    for (int k = 0; k < 3; k++)
        pose.position[k] = 0.5 * (info.box_min[k] + info.box_max[k]);
    pose.position[2] = info.box_max[2] + 0.005;
    for (int i = 0; i < steps; i++) {
        double size = 0.0;
        for (int k = 0; k < 3 && i % 8 == 0; k++)
            way[k] = random_in(&rng, -1.0, 1.0);
        for (int k = 0; k < 3; k++)
            size += way[k] * way[k];
        for (int k = 0; k < 3; k++) {
            const double low = info.box_min[k] - 0.03, high = info.box_max[k] + 0.03;
            const double to = pose.position[k] + step * way[k] / sqrt(size);
            if (to < low || to > high)
                way[k] = -way[k];
            pose.position[k] = fmin(fmax(to, low), high);
        }
        const double begin = processor_time();
        if (dpt_tool_set_pose(world, tool, &pose) || dpt_world_step(world, 1e-3, NULL))
            exit(2);
        took[i] = processor_time() - begin;
    }
    qsort(took, (size_t)steps, sizeof *took, by_size);
    const struct times times = { took[steps / 2], took[(int)(0.99 * steps)] };
    free(took);
    free(block);
    return times;
}

int main(int argc, char **argv)
{
    static const double steps[] = { 3e-4, 1e-3, 3e-3, 0.005, 0.01, 0.02, 0.05, 0.2 };
    static const struct {
        const char *name;
        uint64_t triangles;
    } shapes[] = { { "liver", 50332 }, { "torus", 5568 }, { "torus", 61358 }, { "star", 20480 }, { "torus", 1000000 } };
    const int count = argc > 1 ? atoi(argv[1]) : 4000;
    puts("mesh,triangles,step,exact_us,exact_p99_us,tree_us,tree_p99_us,ratio,ratio_p99");
    for (size_t i = 0; i < sizeof shapes / sizeof shapes[0]; i++) {
        struct fixture fixture;
        if (count < 1 || !fixture_from_shape(&fixture, shapes[i].name, shapes[i].triangles))
            return 2;
        for (size_t k = 0; k < sizeof steps / sizeof steps[0]; k++) {
            const struct times exact = walk(fixture.mesh, DPT_METHOD_EXACT, steps[k], count);
            const struct times tree = walk(fixture.mesh, DPT_METHOD_TREE, steps[k], count);
            printf("%s,%llu,%g,%.2f,%.1f,%.2f,%.1f,%.2f,%.2f\n", shapes[i].name,
                   (unsigned long long)shapes[i].triangles, steps[k], exact.median, exact.p99, tree.median, tree.p99,
                   exact.median / tree.median, exact.p99 / tree.p99);
        }
        fixture_free(&fixture);
    }
    return 0;
}
