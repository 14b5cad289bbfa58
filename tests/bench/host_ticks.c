/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a tick of a host costs beside the same calls by hand, a count of contacts among them: `host_ticks MESH.dpa host|hand [TICKS]`. A simulated hand
 * slides over a mesh. Both ways print the same sum of forces; count their instructions by
 *
 *     valgrind --tool=callgrind --callgrind-out-file=/dev/null --toggle-collect=by_host host_ticks MESH.dpa host
 *     valgrind --tool=callgrind --callgrind-out-file=/dev/null --toggle-collect=by_hand host_ticks MESH.dpa hand
 */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dynpoint.h"
#include "dynpoint/guard.h"
#include "dynpoint/host.h"
#include "dynpoint/passivity.h"

#define LENGTH 0.1
#define RADIUS 0.002
#define PERIOD 1e-3

/* Where the hand is: it goes in and out of the top, and to and fro. */
static void hold(dpt_device_state *state, int tick)
{
    const double turn = fmod(1e-3 * tick, 1.0), wave = turn < 0.5 ? turn : 1.0 - turn;
    *state = (dpt_device_state){ .size = sizeof *state,
                                 .status = DPT_DEVICE_STATUS_READY,
                                 .fresh = 1,
                                 .sequence = (uint64_t)tick + 1,
                                 .time_ns = 1000000 * ((uint64_t)tick + 1),
                                 .pose = DPT_POSE_IDENTITY };
    state->pose.position[0] = 0.04 * wave;
    state->pose.position[1] = -0.06 * wave;
    state->pose.position[2] = 0.01 * wave;
}

static void *load(const char *path, size_t *size)
{
    FILE *file = fopen(path, "rb");
    void *bytes = NULL;
    long end = -1;
    if (file && fseek(file, 0, SEEK_END) == 0 && (end = ftell(file)) > 0) {
        rewind(file);
        *size = (size_t)end;
        if (posix_memalign(&bytes, 64, *size) || fread(bytes, 1, *size, file) != *size)
            exit(2);
    }
    if (file)
        fclose(file);
    return bytes;
}

static dpt_device_info device(void)
{
    return (dpt_device_info){ .size = sizeof(dpt_device_info),
                              .rate = 1000.0,
                              .pose_dofs = 3,
                              .wrench_dofs = 3,
                              .mass = 0.1,
                              .damping = 0.5,
                              .force_max = 5.0 };
}

__attribute__((noinline)) static double by_host(dpt_host *host, int ticks)
{
    double sum = 0.0;
    for (int i = 0; i < ticks; i++) {
        dpt_device_state state;
        dpt_wrench wrench;
        hold(&state, i);
        dpt_host_tick(host, &state, state.time_ns, &wrench);
        sum += wrench.force[0] + wrench.force[1] + wrench.force[2];
    }
    return sum;
}

struct hand {
    dpt_world *world;
    dpt_tool tool;
    dpt_passivity passivity;
    dpt_guard guard;
    double origin[3];
    int contacts;
};

__attribute__((noinline)) static double by_hand(struct hand *hand, int ticks)
{
    double sum = 0.0;
    dpt_wrench sent = { { 0.0 }, { 0.0 } };
    for (int i = 0; i < ticks; i++) {
        dpt_device_state state;
        dpt_segment stylus = { .radius = RADIUS };
        dpt_force_info force = { .size = sizeof force };
        dpt_hit hit = DPT_HIT_INIT;
        hold(&state, i);
        for (int k = 0; k < 3; k++)
            stylus.a[k] = stylus.b[k] = hand->origin[k] + state.pose.position[k];
        stylus.b[2] += LENGTH;
        dpt_tool_set_segments(hand->world, hand->tool, &stylus, 1);
        const dpt_result result = dpt_world_step(hand->world, PERIOD, NULL);
        dpt_tool_get_force_info(hand->world, hand->tool, &force);
        const dpt_passivity_sample sample = { .size = sizeof sample,
                                              .dt = PERIOD,
                                              .energy = force.energy,
                                              .body_work = force.body_work,
                                              .pose = state.pose,
                                              .sent = sent };
        memset(force.wrench.torque, 0, sizeof force.wrench.torque);
        dpt_passivity_step(&hand->passivity, &sample, &force.wrench);
        dpt_guard_step(&hand->guard, state.time_ns, result == DPT_OK ? &force.wrench : NULL, 1, &sent);
        dpt_tool_get_hit(hand->world, hand->tool, &hit);
        hand->contacts += hit.contact != DPT_CONTACT_SEPARATED;
        sum += sent.force[0] + sent.force[1] + sent.force[2];
    }
    return sum;
}

/* What the host chose, by hand. */
static int open_hand(struct hand *hand, const dpt_mesh *mesh, const dpt_host_info *chosen)
{
    const dpt_device_info info = device();
    const dpt_segment stylus = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, LENGTH }, RADIUS };
    dpt_world_def def;
    dpt_passivity_def passive;
    dpt_guard_def guard;
    dpt_tool_settings settings = { .size = sizeof settings };
    dpt_body body;
    dpt_world_def_init(&def);
    dpt_passivity_def_init(&passive);
    dpt_guard_def_init(&guard);
    def.max_bodies = def.max_tools = def.max_segments = 1;
    def.max_contacts = 0;
    def.budget = chosen->budget;
    passive.damping = info.damping;
    passive.force_max = fmin(guard.force_max, info.force_max);
    passive.torque_max = 0.0;
    passive.force_slew = guard.force_slew;
    passive.torque_slew = guard.torque_slew;
    guard.torque_max = 0.0;
    void *block = malloc(dpt_world_bytes(&def));
    if (!block || dpt_world_create(block, dpt_world_bytes(&def), &def, &hand->world) != DPT_OK ||
        dpt_body_add(hand->world, mesh, NULL, &body) != DPT_OK ||
        dpt_tool_add(hand->world, &stylus, 1, &hand->tool) != DPT_OK)
        return 0;
    dpt_tool_get_settings(hand->world, hand->tool, &settings);
    settings.stiffness = chosen->stiffness;
    settings.rotational_stiffness = chosen->rotational_stiffness;
    settings.lock_rotation = settings.near_only = 1;
    hand->passivity.size = sizeof hand->passivity;
    hand->guard.size = sizeof hand->guard;
    return dpt_tool_set_settings(hand->world, hand->tool, &settings) == DPT_OK &&
           dpt_passivity_init(&hand->passivity, &passive) == DPT_OK && dpt_guard_init(&hand->guard, &guard) == DPT_OK;
}

int main(int argc, char **argv)
{
    const int ticks = argc > 3 ? atoi(argv[3]) : 2000;
    size_t size = 0;
    const dpt_mesh *mesh;
    dpt_mesh_info info = { .size = sizeof info };
    dpt_host_info chosen = { .size = sizeof chosen };
    dpt_host_error error = { .size = sizeof error };
    const dpt_device_info held = device();
    dpt_host_def def;
    dpt_host *host;
    void *bytes = argc > 2 ? load(argv[1], &size) : NULL;
    if (!bytes || dpt_mesh_open(bytes, size, &mesh) != DPT_OK || dpt_mesh_get_info(mesh, &info) != DPT_OK) {
        fprintf(stderr, "usage: host_ticks MESH.dpa host|hand [TICKS]\n");
        return 2;
    }
    const dpt_host_body body = { .size = sizeof body, .mesh = mesh };
    dpt_host_def_init(&def);
    def.bodies = &body;
    def.body_count = 1;
    def.info = &held;
    def.friction = 0.0;
    for (int k = 0; k < 3; k++)
        def.origin[k] = k == 1 ? info.box_max[k] + RADIUS + 0.005 : 0.5 * (info.box_min[k] + info.box_max[k]);
    if (dpt_host_open(&def, &host, &error) != DPT_OK) {
        fprintf(stderr, "%s\n", error.text);
        return 2;
    }
    dpt_host_get_info(host, &chosen);
    if (!strcmp(argv[2], "host")) {
        printf("%.17g\n", by_host(host, ticks));
        dpt_host_get_info(host, &chosen);
        printf("%d ticks, %d in contact\n", ticks, (int)chosen.contacts);
        return 0;
    }
    static struct hand hand;
    memcpy(hand.origin, def.origin, sizeof hand.origin);
    if (!open_hand(&hand, mesh, &chosen))
        return 2;
    printf("%.17g\n", by_hand(&hand, ticks));
    printf("%d ticks, %d in contact\n", ticks, hand.contacts);
    return 0;
}
