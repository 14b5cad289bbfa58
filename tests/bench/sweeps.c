/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a motion costs: random jumps and turns of a tool of 0.15 m with a radius of 2 mm, from anywhere in a mesh's box,
 * 0.1 m wider on every side. `try` is dpt_tool_try_pose; `point` and `proxy` are the step of a world with that law in which
 * the tool has moved so, with the nearest pair, contact and force, and with sweep_budget as it is by default. A CSV: mesh,
 * triangles, how, jump in m, turn in rad (each from half of that on), the share that touches something, and microseconds of
 * processor time.
 *
 *     sweeps [MOTIONS=3000]
 */
#define _GNU_SOURCE
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "lib/arm_random.h"
#include "lib/fixture.h"
#include "lib/random.h"
#include "timing.h"

static uint64_t rng = 7;

static void direction(double unit[3])
{
    double square;
    do {
        square = 0.0;
        for (int k = 0; k < 3; k++) {
            unit[k] = random_in(&rng, -1.0, 1.0);
            square += unit[k] * unit[k];
        }
    } while (!(square > 0.01 && square <= 1.0));
    for (int k = 0; k < 3; k++)
        unit[k] /= sqrt(square);
}

/* The pose after a turn about a random axis, and a jump. */
static dpt_pose moved(const dpt_pose *from, double jump, double turn)
{
    dpt_pose to = *from;
    double axis[3], way[3], square = 0.0;
    const double *q = from->orientation;
    direction(axis);
    direction(way);
    const double w = cos(0.5 * turn),
                 v[3] = { sin(0.5 * turn) * axis[0], sin(0.5 * turn) * axis[1], sin(0.5 * turn) * axis[2] };
    to.orientation[0] = w * q[0] - v[0] * q[1] - v[1] * q[2] - v[2] * q[3];
    for (int k = 0; k < 3; k++) {
        const int l = (k + 1) % 3, m = (k + 2) % 3;
        to.orientation[k + 1] = w * q[k + 1] + q[0] * v[k] + v[l] * q[m + 1] - v[m] * q[l + 1];
        to.position[k] += jump * way[k];
    }
    for (int k = 0; k < 4; k++)
        square += to.orientation[k] * to.orientation[k];
    for (int k = 0; k < 4; k++)
        to.orientation[k] /= sqrt(square);
    return to;
}

enum how { TRY, POINT, PROXY };
static const char *const how_names[] = { "try", "point", "proxy" };

static void measure(const char *name, const dpt_mesh *mesh, enum how how, double jump, double turn, int motions)
{
    dpt_mesh_info info = { .size = sizeof info };
    dpt_world_def def;
    dpt_world *world;
    dpt_body body;
    dpt_tool tool;
    const dpt_segment segment = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.15 }, 0.002 };
    double *took = malloc((size_t)motions * sizeof *took);
    int met = 0;
    dpt_world_def_init(&def);
    def.max_contacts = 32;
    def.law = how == PROXY ? DPT_LAW_PROXY : DPT_LAW_POINT;
    void *block = malloc(dpt_world_bytes(&def));
    if (!took || !block || dpt_mesh_get_info(mesh, &info) ||
        dpt_world_create(block, dpt_world_bytes(&def), &def, &world) || dpt_body_add(world, mesh, NULL, &body) ||
        dpt_tool_add(world, &segment, 1, &tool))
        exit(2);
    for (int i = 0; i < motions; i++) {
        dpt_pose from = pose_random(&rng, 0.0), reached;
        dpt_sweep first = { .size = sizeof first };
        for (int k = 0; k < 3; k++)
            from.position[k] = random_in(&rng, info.box_min[k] - 0.1, info.box_max[k] + 0.1);
        const dpt_pose to = moved(&from, jump * random_in(&rng, 0.5, 1.0), turn * random_in(&rng, 0.5, 1.0));
        dpt_tool_teleport(world, tool, &from);
        if (how != TRY && (dpt_world_step(world, 1e-3, NULL) || dpt_tool_set_pose(world, tool, &to)))
            exit(2);
        const double begin = processor_time();
        const dpt_result result =
            how == TRY ? dpt_tool_try_pose(world, tool, &to, 0.0, &first, &reached) : dpt_world_step(world, 1e-3, NULL);
        took[i] = processor_time() - begin;
        if (result || (how == POINT && dpt_tool_get_sweep(world, tool, 0, &first)) ||
            (how == PROXY && dpt_tool_get_proxy(world, tool, &reached)))
            exit(2);
        met += how == PROXY ? memcmp(&reached, &to, sizeof to) != 0 : first.status == DPT_SWEEP_HIT;
    }
    qsort(took, (size_t)motions, sizeof *took, by_size);
    printf("%s,%u,%s,%g,%g,%.2f,%.1f,%.1f,%.1f,%.1f\n", name, info.triangles, how_names[how], jump, turn,
           (double)met / motions, took[motions / 2], took[(int)(0.99 * motions)], took[(int)(0.999 * motions)],
           took[motions - 1]);
    free(took);
    free(block);
}

int main(int argc, char **argv)
{
    static const double jump[] = { 0.005, 0.05, 0.3, 1.0, 0.0, 0.0, 0.05, 1.0 };
    static const double turn[] = { 0.0, 0.0, 0.0, 0.0, 0.1, 3.14159, 0.5, 3.14159 };
    static const struct {
        const char *name;
        uint64_t triangles;
    } shapes[] = { { "liver", 50332 }, { "torus", 61358 }, { "star", 20480 }, { "torus", 1000000 } };
    const int motions = argc > 1 ? atoi(argv[1]) : 3000;
    puts("mesh,triangles,how,jump,turn,met,median_us,p99_us,p999_us,most_us");
    for (size_t i = 0; i < sizeof shapes / sizeof shapes[0]; i++) {
        struct fixture fixture;
        if (motions < 1 || !fixture_from_shape(&fixture, shapes[i].name, shapes[i].triangles))
            return 2;
        for (enum how how = TRY; how <= PROXY; how++)
            for (size_t k = 0; k < sizeof jump / sizeof jump[0]; k++)
                measure(shapes[i].name, fixture.mesh, how, jump[k], turn[k], motions);
        fixture_free(&fixture);
    }
    return 0;
}
