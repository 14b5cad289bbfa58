/* SPDX-License-Identifier: BSD-3-Clause */
#include "chart/chart_bodies.h"

#include <math.h>
#include <stdlib.h>

#include "cli/command_options.h"
#include "clock.h"
#include "run/replay_report.h"
#include "shape/mesh_size.h"

enum { PASSES = 3, REFITS = 9 };

/* Of its size: by so much the body grows in each of them. */
#define GROWTH 2e-3

/* Of the diagonal: so far above it is the tool. */
#define ABOVE 0.05

static double seconds_since(uint64_t begin)
{
    return 1e-9 * (double)(clock_now() - begin);
}

static dpt_result compile_again(struct chart_body *measured, const dpt_mesh *mesh)
{
    const float *xyz;
    const uint32_t *corners, *numbers;
    uint32_t vertices, triangles;
    dpt_compile_def def;
    dpt_result result = DPT_OK;
    dpt_mesh_get_vertices(mesh, &xyz, &vertices);
    dpt_mesh_get_triangles(mesh, &corners, &numbers, &triangles);
    double *places = malloc((size_t)vertices * 3 * sizeof *places);
    if (!places)
        return DPT_E_MEMORY;
    for (size_t i = 0; i < (size_t)vertices * 3; i++)
        places[i] = xyz[i];
    dpt_compile_def_init(&def);
    for (int pass = 0; result == DPT_OK && pass < PASSES; pass++) {
        dpt_compiled compiled = { .bytes = NULL };
        dpt_diag diag = { .size = sizeof diag };
        const uint64_t begin = clock_now();
        result = dpt_compile_arrays(places, vertices, corners, triangles, &def, &compiled, &diag);
        measured->compile = fmin(measured->compile, seconds_since(begin));
        dpt_compiled_free(&compiled);
    }
    free(places);
    return result;
}

static dpt_result add_again(struct chart_body *measured, dpt_world *world, const dpt_mesh *mesh)
{
    dpt_result result = DPT_OK;
    for (int pass = 0; result == DPT_OK && pass < PASSES; pass++) {
        dpt_body body;
        const uint64_t begin = clock_now();
        result = dpt_body_add(world, mesh, NULL, &body);
        measured->add = fmin(measured->add, seconds_since(begin));
        if (result == DPT_OK)
            result = dpt_body_remove(world, body);
    }
    return result;
}

/* A tool above the box, and a body that grows about its middle. */
static dpt_result refit(struct chart_body *measured, dpt_world *world, const dpt_mesh *mesh)
{
    dpt_deformable_def def;
    dpt_mesh_info info = { .size = sizeof info };
    dpt_segment needle = { .radius = 0.0 };
    dpt_body body;
    dpt_tool tool;
    const float *xyz;
    uint32_t count;
    dpt_mesh_get_info(mesh, &info);
    dpt_mesh_get_vertices(mesh, &xyz, &count);
    for (int k = 0; k < 3; k++) {
        needle.a[k] = 0.5 * (info.box_min[k] + info.box_max[k]);
        needle.b[k] = k ? needle.a[k] : info.box_max[k];
    }
    needle.a[2] = needle.b[2] = info.box_max[2] + ABOVE * box_diagonal(&info);
    dpt_deformable_def_init(&def);
    def.mesh = mesh;
    measured->deform_bytes = dpt_deformable_bytes(&def);
    void *block = malloc(measured->deform_bytes);
    float *moved = malloc((size_t)count * 3 * sizeof *moved);
    dpt_result result = block && moved ? DPT_OK : DPT_E_MEMORY;
    if (result == DPT_OK)
        result = dpt_body_add_deformable(world, block, measured->deform_bytes, &def, &body);
    if (result == DPT_OK)
        result = dpt_tool_add(world, &needle, 1, &tool);
    if (result == DPT_OK)
        result = dpt_world_step(world, 1e-3, NULL);
    double took[REFITS] = { 0.0 };
    for (int pass = 0; result == DPT_OK && pass < REFITS; pass++) {
        for (size_t i = 0; i < (size_t)count * 3; i++) {
            const double middle = 0.5 * (info.box_min[i % 3] + info.box_max[i % 3]);
            moved[i] = (float)(middle + (1.0 + GROWTH * (pass + 1)) * (xyz[i] - middle));
        }
        const uint64_t begin = clock_now();
        result = dpt_body_set_vertices(world, body, 0, count, moved, -1.0);
        if (result == DPT_OK)
            result = dpt_world_step(world, 1e-3, NULL);
        took[pass] = seconds_since(begin);
    }
    sort_numbers(took, REFITS);
    measured->refit = percentile(took, REFITS, 0.5);
    free(moved);
    free(block);
    return result;
}

int chart_body_measure(struct chart_body *measured, const struct scene *scene, uint32_t body)
{
    const dpt_mesh *mesh = scene->bodies.body[body].mesh;
    dpt_mesh_info info = { .size = sizeof info };
    dpt_world_def def;
    dpt_world *world;
    dpt_mesh_get_info(mesh, &info);
    *measured = (struct chart_body){
        .triangles = info.triangles, .mesh_bytes = info.bytes, .compile = HUGE_VAL, .add = HUGE_VAL
    };
    dpt_world_def_init(&def);
    def.until = DPT_UNTIL_TRACK;
    void *block = malloc(dpt_world_bytes(&def));
    dpt_result result = block ? dpt_world_create(block, dpt_world_bytes(&def), &def, &world) : DPT_E_MEMORY;
    if (result == DPT_OK)
        result = compile_again(measured, mesh);
    if (result == DPT_OK)
        result = add_again(measured, world, mesh);
    if (result == DPT_OK)
        result = refit(measured, world, mesh);
    free(block);
    return result == DPT_OK ? 0 : complain(scene->command, "%s", dpt_result_text(result));
}
