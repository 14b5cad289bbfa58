/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Files of release 0.2 stay readable: a snapshot, and a recording of `dynpoint run`. Meshes and arms of its formats are
 * looked at by test_mesh and test_arm.
 *
 * tests/golden/snapshot_0_2 is what `test_golden_snapshot write`, compiled with release 0.2, wrote to its standard output
 * on a little-endian machine. recording_0_2.dpr is what its program wrote:
 *
 *     dynpoint run tests/golden/torus_6.dpa --device 'sim:?hand=press&cycle=0.1' --ticks 80 --at 0,0.1435,0
 *         --friction 0.4 --record tests/golden/recording_0_2.dpr
 */
#include <math.h>

#include "dynpoint.h"
#include "lib/check.h"

static uint64_t mesh_file[2048], block[1 << 18], file[8192];

static size_t read_golden(const char *path, void *to, size_t room)
{
    FILE *from = fopen(path, "rb");
    const size_t size = from ? fread(to, 1, room, from) : 0;
    CHECK(from && size < room, "%s: %zu bytes", path, size);
    if (from)
        fclose(from);
    return size;
}

/* A rod that was pressed onto the torus from above, its strip, and its contact. */
static size_t take(void *to, size_t room)
{
    const dpt_segment rod = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.08 }, 0.004 };
    dpt_pose pose = { { 0.1, 0.0, 0.06 }, { 0.9961946980917455, 0.08715574274765817, 0.0, 0.0 } };
    const dpt_mesh *mesh;
    dpt_world_def def;
    dpt_world *world;
    dpt_snapshot_def snapshot;
    dpt_body body;
    dpt_tool tool;
    size_t bytes = 0;
    const size_t size = read_golden("tests/golden/torus_6.dpa", mesh_file, sizeof mesh_file);
    dpt_world_def_init(&def);
    def.max_contacts = 8;
    def.strip = DPT_STRIP_KIND_SHADOW;
    def.max_bodies = def.max_tools = def.max_segments = 1;
    if (dpt_mesh_open(mesh_file, size, &mesh) != DPT_OK || dpt_world_bytes(&def) > sizeof block ||
        dpt_world_create(block, sizeof block, &def, &world) != DPT_OK ||
        dpt_body_add(world, mesh, NULL, &body) != DPT_OK || dpt_tool_add(world, &rod, 1, &tool) != DPT_OK)
        return 0;
    dpt_body_set_user(world, body, 11);
    dpt_tool_set_user(world, tool, 22);
    for (int i = 0; i < 20; i++) {
        pose.position[2] = fmax(pose.position[2] - 0.002, 0.041);
        dpt_tool_set_pose(world, tool, &pose);
        dpt_world_step(world, 1e-3, NULL);
    }
    dpt_snapshot_def_init(&snapshot);
    return dpt_world_take_snapshot(world, &snapshot, to, room, &bytes) == DPT_OK ? bytes : 0;
}

static int is_little_endian(void)
{
    const uint16_t one = 1;
    return *(const unsigned char *)&one;
}

/* What the release told of the same scene. Friction settles to 1e-3 of a motion's length, by each its own way. */
static void a_snapshot_stays_readable(void)
{
    static uint64_t again[8192];
    dpt_snapshot_info info = { .size = sizeof info };
    dpt_snapshot_body body = { .size = sizeof body };
    dpt_snapshot_tool tool = { .size = sizeof tool }, now = { .size = sizeof now };
    dpt_snapshot_segment segment = { .size = sizeof segment };
    dpt_snapshot_contact contact = { .size = sizeof contact };
    dpt_snapshot_strip strip = { .size = sizeof strip };
    if (!is_little_endian()) {
        SKIP("a snapshot of 0.2", "it is of a little-endian machine");
        return;
    }
    const size_t size = read_golden("tests/golden/snapshot_0_2", file, sizeof file), made = take(again, sizeof again);
    CHECK(dpt_snapshot_get_info(file, size, &info) == DPT_OK && info.bodies == 1 && info.tools == 1 &&
              info.segments == 1 && info.contacts == 1 && info.strip > 0 && info.steps == 20 &&
              fabs(info.time - 0.02) < 1e-12 && !info.flags,
          "%u bodies, %u contacts, strips of %u", info.bodies, info.contacts, info.strip);
    CHECK(dpt_snapshot_get_body(file, size, 0, &body) == DPT_OK && body.user == 11 && !body.vertices, "body");
    CHECK(dpt_snapshot_get_tool(file, size, 0, &tool) == DPT_OK && tool.user == 22 && tool.law == DPT_LAW_PROXY &&
              tool.reason == DPT_FORCE_ACTS && tool.wrench.force[2] > 0.1 && tool.pose.position[2] == 0.041,
          "%g N", tool.wrench.force[2]);
    CHECK(!memcmp(&tool.end, &tool.proxy, sizeof tool.end), "where a step ended was not told yet");
    CHECK(dpt_snapshot_get_segment(file, size, 0, &segment) == DPT_OK && segment.radius == 0.004 &&
              segment.body == body.id && segment.proxy_a[2] > segment.a[2],
          "segment");
    CHECK(dpt_snapshot_get_contact(file, size, 0, &contact) == DPT_OK && contact.body == body.id && contact.id,
          "contact");
    CHECK(dpt_snapshot_get_strip(file, size, info.strip - 1, &strip) == DPT_OK && strip.body == body.id, "strip");
    CHECK(made == size + sizeof tool.end && dpt_snapshot_get_tool(again, made, 0, &now) == DPT_OK,
          "%zu bytes, and %zu now", size, made);
    for (int k = 0; k < 3; k++)
        CHECK(fabs(now.wrench.force[k] - tool.wrench.force[k]) < 1e-4 * tool.wrench.force[2],
              "axis %d: %g N, and %g now", k, tool.wrench.force[k], now.wrench.force[k]);
}

static void a_recording_stays_readable(void)
{
    static dpt_record records[128] = { { .size = sizeof *records } };
    dpt_record_header header = { .size = sizeof header };
    size_t at = 0;
    uint32_t count = 0, felt = 0;
    const size_t size = read_golden("tests/golden/recording_0_2.dpr", file, sizeof file);
    CHECK(dpt_record_header_read(file, size, &header, &at) == DPT_OK && header.writer_version == 0x000200 &&
              header.rate == 1000.0 && strstr(header.text, "scene=tests/golden/torus_6.dpa\n") &&
              strstr(header.text, "friction=0.4"),
          "header");
    CHECK(dpt_record_read(file, size, &at, records, 128, &count) == DPT_OK && count == 80 && at == size,
          "%u records, %zu of %zu bytes", count, at, size);
    for (uint32_t i = 0; i < count; i++)
        felt += fabs(records[i].asked.force[1]) > 0.1;
    CHECK(felt > 40, "%u ticks with a force", felt);
}

int main(int argc, char **argv)
{
    if (argc > 1 && !strcmp(argv[1], "write")) {
        const size_t size = take(file, sizeof file);
        return !size || fwrite(file, size, 1, stdout) != 1;
    }
    TEST(a_snapshot_stays_readable);
    TEST(a_recording_stays_readable);
    return check_report();
}
