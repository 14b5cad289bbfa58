/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/snapshot_scene.h"

#include <math.h>

#include "lib/random.h"

static const uint32_t strides[KINDS_END] = { 0, 80, 304, 224, 144, 32, 12 };

uint64_t seed = 1;
unsigned char block[ROOM];
size_t bytes;

const dpt_segment segments_of[TOOL_COUNT][3] = {
    { { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.1 }, 0.003 } },
    { { { 0.0, 0.0, 0.0 }, { 0.06, 0.0, 0.0 }, 0.002 } },
    { { { 0.0, 0.0, 0.0 }, { 0.03, 0.0, 0.0 }, 0.004 },
      { { 0.03, 0.0, 0.0 }, { 0.04, 0.02, 0.0 }, 0.002 },
      { { 0.03, 0.0, 0.0 }, { 0.04, -0.02, 0.0 }, 0.0 } },
    { { { -0.02, 0.0, 0.0 }, { 0.02, 0.0, 0.0 }, 0.005 } },
};
const uint32_t segment_counts[TOOL_COUNT] = { 1, 1, 3, 1 };

void scene_open(struct scene *scene)
{
    static const dpt_pose aside = { { 0.4, 0.0, 0.0 }, { 1.0, 0.0, 0.0, 0.0 } };
    dpt_world_def def = rig_def(DPT_LAW_PROXY);
    dpt_deformable_def deform;
    fixture_from_shape(&scene->liver, "liver", 2000);
    fixture_from_shape(&scene->cloth, "cloth", 1800);
    def.max_bodies = 4;
    def.max_tools = TOOL_COUNT;
    def.max_segments = SEGMENT_COUNT;
    def.strip = DPT_STRIP_KIND_SHADOW;
    def.strip_capacity = 256;
    def.margin = 0.01;
    def.budget = 2500;
    rig_open(&scene->rig, &def, scene->liver.mesh, NULL, 0);
    scene->body[0] = scene->rig.body;
    dpt_deformable_def_init(&deform);
    deform.mesh = scene->cloth.mesh;
    deform.pose = &aside;
    deform.response = DPT_RESPONSE_DISPLACE;
    scene->body[1] = rig_add_deformable(&scene->rig, &deform);
    dpt_body_set_user(scene->rig.world, scene->body[1], 0x1122334455667788u);
    for (uint32_t i = 0; i < TOOL_COUNT; i++) {
        const dpt_pose identity = DPT_POSE_IDENTITY;
        scene->tool[i] = rig_add_tool(&scene->rig, segments_of[i], segment_counts[i]);
        rig_set_law(&scene->rig, scene->tool[i], i == 3 ? DPT_LAW_BED : DPT_LAW_PROXY, RIG_STIFFNESS);
        dpt_tool_set_user(scene->rig.world, scene->tool[i], 100 + i);
        scene->pose[i] = identity;
    }
}

void scene_close(struct scene *scene)
{
    rig_close(&scene->rig);
    fixture_free(&scene->liver);
    fixture_free(&scene->cloth);
}

/* Each tool wanders over one of the bodies, up and down through its surface; the second one is free. */
static void move_tools(struct scene *scene, uint64_t tick)
{
    for (uint32_t i = 0; i < TOOL_COUNT; i++) {
        dpt_pose *pose = &scene->pose[i];
        const double phase = 1e-3 * (double)tick * (1.0 + 0.3 * i);
        double size = 0.0;
        pose->position[0] = (i % 2 ? 0.4 : 0.0) + 0.05 * sin(3.0 * phase);
        pose->position[1] = 0.06 + 0.07 * cos(5.0 * phase);
        pose->position[2] = 0.05 * cos(2.0 * phase);
        for (int k = 0; k < 4; k++)
            pose->orientation[k] += random_in(&seed, -0.01, 0.01);
        for (int k = 0; k < 4; k++)
            size += pose->orientation[k] * pose->orientation[k];
        for (int k = 0; k < 4; k++)
            pose->orientation[k] /= sqrt(size);
        dpt_segment given = segments_of[1][0];
        for (int k = 0; k < 3; k++) {
            given.a[k] = pose->position[k];
            given.b[k] = pose->position[k] + (k == 0 ? 0.06 : 0.01 * sin((double)k * phase));
        }
        if (i == 1)
            dpt_tool_set_segments(scene->rig.world, scene->tool[i], &given, 1);
        else
            dpt_tool_set_pose(scene->rig.world, scene->tool[i], pose);
    }
}

void step(struct scene *scene, uint64_t tick)
{
    move_tools(scene, tick);
    rig_tick(&scene->rig);
}

dpt_snapshot_def all_of_it(void)
{
    dpt_snapshot_def def;
    dpt_snapshot_def_init(&def);
    def.max_vertices = 1 << 20;
    return def;
}

void take(const struct scene *scene, const dpt_snapshot_def *def)
{
    const size_t enough = dpt_snapshot_bytes(scene->rig.world, def);
    CHECK(enough > 0 && enough <= ROOM && enough % 8 == 0, "%zu bytes", enough);
    memset(block, 0xcc, sizeof block);
    CHECK(dpt_world_take_snapshot(scene->rig.world, def, block, enough, &bytes) == DPT_OK, "not taken");
    CHECK(bytes > 0 && bytes <= enough && bytes % 8 == 0 && block[bytes] == 0xcc, "%zu bytes", bytes);
}

void scene_in_contact(struct scene *scene)
{
    scene_open(scene);
    for (uint64_t tick = 0; tick < 900; tick++)
        step(scene, tick);
}

uint32_t word(size_t at)
{
    return (uint32_t)block[at] | (uint32_t)block[at + 1] << 8 | (uint32_t)block[at + 2] << 16 |
           (uint32_t)block[at + 3] << 24;
}

uint64_t wide(size_t at)
{
    return word(at) | (uint64_t)word(at + 4) << 32;
}

double number(size_t at)
{
    const uint64_t bits = wide(at);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

size_t item(uint32_t kind, uint32_t i, uint32_t *count)
{
    for (uint32_t k = 0; k < word(44); k++) {
        const size_t entry = word(12) + 24 * (size_t)k;
        if (word(entry) != kind)
            continue;
        CHECK(word(entry + 8) == strides[kind] && wide(entry + 16) % 8 == 0, "stride, offset");
        *count = word(entry + 4);
        return (size_t)wide(entry + 16) + (size_t)i * strides[kind];
    }
    CHECK(0, "no section %u", (unsigned)kind);
    *count = 0;
    return 0;
}
