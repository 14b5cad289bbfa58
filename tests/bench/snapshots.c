/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a snapshot costs a tick: of the liver of 50,332 triangles with a stylus in it, rigid, and deformable with all of its
 * vertices.
 *
 *     snapshots [TICKS]     prints CSV: subject, bytes, contacts; of a snapshot and of a step median and 99 %, us
 *
 * One snapshot after each step, so that memory is as warm as it is in a loop that makes one every 16th.
 */
#include <math.h>
#include <stdio.h>

#include "bench/timing.h"
#include "dynpoint.h"
#include "dynpoint/compile.h"
#include "scene/shape.h"

static void fail(const char *what)
{
    fprintf(stderr, "snapshots: %s\n", what);
    exit(2);
}

static const dpt_mesh *make_liver(dpt_compiled *compiled)
{
    struct shape shape;
    shape_reason reason;
    dpt_diag diag = { .size = sizeof diag };
    const dpt_mesh *mesh;
    if (shape_make("liver", 50332, 0, &shape, reason) ||
        dpt_compile_arrays(shape.vertices, shape.vertex_count, shape.corners, shape.triangle_count, NULL, compiled,
                           &diag) != DPT_OK ||
        dpt_mesh_open(compiled->bytes, compiled->size, &mesh) != DPT_OK)
        fail("no liver");
    shape_free(&shape);
    return mesh;
}

static double at(double *times, int count, double share)
{
    qsort(times, (size_t)count, sizeof *times, by_size);
    return 1e-3 * times[(int)(share * (count - 1))];
}

/* The stylus slides through the top of the liver, 3 mm deep. */
static void run(const char *name, const dpt_mesh *mesh, int deforms, int ticks)
{
    const dpt_segment stylus = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.1 }, 0.002 };
    dpt_mesh_info info = { .size = sizeof info };
    dpt_world_def def;
    dpt_deformable_def deform;
    dpt_snapshot_def wanted;
    dpt_world *world;
    dpt_body body;
    dpt_tool tool;
    uint32_t contacts = 0;
    size_t bytes = 0;
    dpt_mesh_get_info(mesh, &info);
    dpt_world_def_init(&def);
    def.max_contacts = 32;
    dpt_deformable_def_init(&deform);
    dpt_snapshot_def_init(&wanted);
    wanted.max_vertices = deforms ? info.vertices : 0;
    deform.mesh = mesh;
    void *block = malloc(dpt_world_bytes(&def)), *own = malloc(dpt_deformable_bytes(&deform));
    double *snapshot_ns = calloc((size_t)ticks, sizeof *snapshot_ns);
    double *step_ns = calloc((size_t)ticks, sizeof *step_ns);
    if (!block || !own || !snapshot_ns || !step_ns ||
        dpt_world_create(block, dpt_world_bytes(&def), &def, &world) != DPT_OK)
        fail("no world");
    const dpt_result added = deforms
                                 ? dpt_body_add_deformable(world, own, dpt_deformable_bytes(&deform), &deform, &body)
                                 : dpt_body_add(world, mesh, NULL, &body);
    if (added != DPT_OK || dpt_tool_add(world, &stylus, 1, &tool) != DPT_OK)
        fail("no body or no tool");
    const size_t capacity = dpt_snapshot_bytes(world, &wanted);
    void *snapshot = malloc(capacity);
    for (int i = 0; snapshot && i < ticks; i++) {
        dpt_pose pose = DPT_POSE_IDENTITY;
        dpt_snapshot_info found = { .size = sizeof found };
        const double come = fmin(1.0, i / 500.0);
        pose.position[0] = 0.01 * sin(1e-3 * i);
        pose.position[1] = 0.5 * (info.box_min[1] + info.box_max[1]);
        pose.position[2] = info.box_max[2] + 0.01 - 0.015 * come;
        dpt_tool_set_pose(world, tool, &pose);
        const double begin = now();
        dpt_world_step(world, 0.001, NULL);
        const double stepped = now();
        if (dpt_world_take_snapshot(world, &wanted, snapshot, capacity, &bytes) != DPT_OK)
            fail("no snapshot");
        snapshot_ns[i] = now() - stepped;
        step_ns[i] = stepped - begin;
        dpt_snapshot_get_info(snapshot, bytes, &found);
        contacts = found.contacts;
    }
    printf("%s,%zu,%u,%.2f,%.2f,%.1f,%.1f\n", name, bytes, (unsigned)contacts, at(snapshot_ns, ticks, 0.5),
           at(snapshot_ns, ticks, 0.99), at(step_ns, ticks, 0.5), at(step_ns, ticks, 0.99));
    free(snapshot);
    free(snapshot_ns);
    free(step_ns);
    free(block);
    free(own);
}

int main(int argc, char **argv)
{
    const int ticks = argc > 1 ? atoi(argv[1]) : 20000;
    dpt_compiled compiled;
    const dpt_mesh *mesh = make_liver(&compiled);
    if (ticks < 1000)
        fail("from 1000 ticks on");
    puts("subject,bytes,contacts,snapshot_us,snapshot_p99_us,step_us,step_p99_us");
    run("rigid", mesh, 0, ticks);
    run("all vertices", mesh, 1, ticks);
    dpt_compiled_free(&compiled);
    return 0;
}
