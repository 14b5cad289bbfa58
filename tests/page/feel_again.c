/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What the native library answers to a motion that was recorded in the page (docs/page.md): a snapshot after each tick.
 *
 *     feel_again MESH.dpa MOTION LAW STIFFNESS LOAD_RADIUS >SNAPSHOTS
 *
 * MOTION: doubles of this machine: the body's pose, the tool's segment, then the tool's pose in each tick. LAW is a number
 * of world.h. A mesh with springs is a body that deforms, its springs stepped in each tick; the last snapshot has its
 * vertices. LOAD_RADIUS: of dpt_deformable_def.
 */
#include <dynpoint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { POSE = 7, SEGMENT = 7 };
#define DT 0.001

static void must(int is_good, const char *what)
{
    if (is_good)
        return;
    fprintf(stderr, "feel_again: %s\n", what);
    exit(2);
}

static void *read_file(const char *path, size_t *size)
{
    FILE *file = fopen(path, "rb");
    must(file && fseek(file, 0, SEEK_END) == 0, path);
    *size = (size_t)ftell(file);
    rewind(file);
    void *bytes = malloc(*size + 8);
    must(bytes && fread(bytes, 1, *size, file) == *size, path);
    fclose(file);
    return bytes;
}

static dpt_springs *add_body(dpt_world *world, const dpt_mesh *mesh, const dpt_pose *pose, double load_radius,
                             dpt_body *body)
{
    dpt_mesh_info info = { .size = sizeof info };
    dpt_deformable_def def;
    dpt_springs_def springs_def;
    dpt_springs *springs;
    must(!dpt_mesh_get_info(mesh, &info), "the mesh");
    if (!info.springs) {
        must(!dpt_body_add(world, mesh, pose, body), "the body");
        return NULL;
    }
    dpt_deformable_def_init(&def);
    def.mesh = mesh;
    def.pose = pose;
    def.load_radius = load_radius;
    dpt_springs_def_init(&springs_def);
    springs_def.mesh = mesh;
    void *block = malloc(dpt_deformable_bytes(&def)), *net = malloc(dpt_springs_bytes(&springs_def));
    must(block && net && !dpt_body_add_deformable(world, block, dpt_deformable_bytes(&def), &def, body) &&
             !dpt_springs_create(net, dpt_springs_bytes(&springs_def), &springs_def, &springs),
         "the body that deforms");
    return springs;
}

static void put_snapshot(const dpt_world *world, uint32_t vertices)
{
    dpt_snapshot_def def;
    size_t bytes;
    dpt_snapshot_def_init(&def);
    def.max_vertices = vertices;
    const size_t room = dpt_snapshot_bytes(world, &def);
    void *block = malloc(room);
    must(block && !dpt_world_take_snapshot(world, &def, block, room, &bytes), "a snapshot");
    must(fwrite(block, 1, bytes, stdout) == bytes, "standard output");
    free(block);
}

int main(int argc, char **argv)
{
    size_t size, motion_size;
    const dpt_mesh *mesh;
    dpt_mesh_info info = { .size = sizeof info };
    dpt_world *world;
    dpt_world_def def;
    dpt_tool tool;
    dpt_body body;
    dpt_segment segment;
    dpt_pose pose;
    must(argc == 6, "MESH.dpa MOTION LAW STIFFNESS LOAD_RADIUS");
    const void *file = read_file(argv[1], &size);
    const double *motion = read_file(argv[2], &motion_size);
    const size_t ticks = (motion_size / sizeof *motion - POSE - SEGMENT) / POSE;
    must(!dpt_mesh_open(file, size, &mesh) && !dpt_mesh_get_info(mesh, &info), argv[1]);
    memcpy(&pose, motion, sizeof pose);
    memcpy(&segment, motion + POSE, sizeof segment);
    dpt_world_def_init(&def);
    def.max_bodies = def.max_tools = def.max_segments = 1;
    def.law = (uint32_t)atoi(argv[3]);
    def.max_contacts = 32;
    def.stiffness = atof(argv[4]);
    void *block = malloc(dpt_world_bytes(&def));
    must(block && !dpt_world_create(block, dpt_world_bytes(&def), &def, &world), "the world");
    dpt_springs *springs = add_body(world, mesh, &pose, atof(argv[5]), &body);
    dpt_tool_settings settings = { .size = sizeof settings };
    must(!dpt_tool_add(world, &segment, 1, &tool) && !dpt_tool_get_settings(world, tool, &settings), "the tool");
    settings.lock_rotation = 1;
    must(!dpt_tool_set_settings(world, tool, &settings), "the tool's settings");
    /* As the page: a report reads the hits, so their search is part of the step's work. */
    dpt_step report = { .size = sizeof report };
    for (size_t tick = 0; tick < ticks; tick++) {
        memcpy(&pose, motion + POSE + SEGMENT + tick * POSE, sizeof pose);
        must(!dpt_tool_set_pose(world, tool, &pose) && !dpt_world_step(world, DT, &report), "a step");
        must(!springs || !dpt_body_step_springs(world, body, springs, DT, NULL), "the springs' step");
        put_snapshot(world, springs && tick + 1 == ticks ? info.vertices : 0);
    }
    return 0;
}
