/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Read this first: a stylus comes down on a mesh and feels it.
 *
 *     build/dynpoint make liver -o liver.stl && build/dynpoint compile liver.stl -o liver.dpa
 *     cc first_touch.c $(pkg-config --cflags --libs libdynpoint) -o first_touch
 *     ./first_touch liver.dpa
 */
#include <dynpoint.h>
#include <stdio.h>
#include <stdlib.h>

static void must(const char *call, dpt_result result)
{
    if (result == DPT_OK)
        return;
    fprintf(stderr, "%s: %s (%s)\n", call, dpt_result_text(result), dpt_result_name(result));
    exit(1);
}

int main(int argc, char **argv)
{
    /* Any way to get the file into memory will do; malloc's is aligned well enough. */
    FILE *file = argc == 2 ? fopen(argv[1], "rb") : NULL;
    long size = file != NULL && fseek(file, 0, SEEK_END) == 0 ? ftell(file) : -1;
    void *bytes = size > 0 ? malloc((size_t)size) : NULL;
    if (bytes == NULL || fseek(file, 0, SEEK_SET) != 0 || fread(bytes, 1, (size_t)size, file) != (size_t)size) {
        fprintf(stderr, "usage: first_touch FILE.dpa\n");
        return 2;
    }
    fclose(file);

    /* The mesh is used where its bytes lie. Lengths are metres. */
    const dpt_mesh *mesh;
    dpt_mesh_info info = { .size = sizeof info };
    must("dpt_mesh_open", dpt_mesh_open(bytes, (size_t)size, &mesh));
    must("dpt_mesh_get_info", dpt_mesh_get_info(mesh, &info));

    /* Where is it nearest to the middle of its box's top? A segment of no length is a point. */
    const double x = 0.5 * (info.box_min[0] + info.box_max[0]);
    const double y = 0.5 * (info.box_min[1] + info.box_max[1]);
    const double ends[6] = { x, y, info.box_max[2], x, y, info.box_max[2] };
    dpt_hit top = DPT_HIT_INIT;
    must("dpt_query_segments", dpt_query_segments(mesh, NULL, ends, NULL, 1, &top, NULL));

    /* A world lives in a block of ours; here with its defaults. */
    dpt_world_def def;
    dpt_world_def_init(&def);
    void *block = malloc(dpt_world_bytes(&def));
    dpt_world *world;
    must("dpt_world_create", dpt_world_create(block, dpt_world_bytes(&def), &def, &world));

    /* The stylus in its own frame: the tip at the origin, 0.15 m upright, 2 mm in radius. */
    const dpt_segment stylus = { { 0, 0, 0 }, { 0, 0, 0.15 }, 0.002 };
    dpt_body body;
    dpt_tool tool;
    must("dpt_body_add", dpt_body_add(world, mesh, NULL, &body));
    must("dpt_tool_add", dpt_tool_add(world, &stylus, 1, &tool));

    /* Straight down there, the tip from 6 mm above to 0.5 mm: then it is pressed in by 1.5 mm. */
    static const char *const words[] = { "unknown", "separated", "touching", "penetrating" };
    dpt_pose pose = { { top.q[0], top.q[1], 0 }, { 1, 0, 0, 0 } };
    for (int tick = 0; tick <= 200; tick++) {
        dpt_step step = { .size = sizeof step };
        dpt_wrench wrench;
        pose.position[2] = top.q[2] + 0.006 - 0.0055 * tick / 200;
        must("dpt_tool_set_pose", dpt_tool_set_pose(world, tool, &pose));
        must("dpt_world_step", dpt_world_step(world, 0.001, &step));
        must("dpt_tool_get_wrench", dpt_tool_get_wrench(world, tool, &wrench));
        if (tick % 20 == 0)
            printf("tick %3d  distance %6.3f mm  %-11s  force %6.3f %6.3f %6.3f N\n", tick, 1e3 * step.distance,
                   words[step.contact], wrench.force[0], wrench.force[1], wrench.force[2]);
    }
    free(block);
    free(bytes);
    return 0;
}
