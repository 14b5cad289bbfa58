/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a caller keeps at, and asks of, the things in a world: poses, values of its own, whether an id is alive, jumps,
 * and how much of the world was in use. The bodies' answers themselves are for other tests.
 */
#include "lib/fixture.h"
#include "lib/rig.h"

static struct fixture fixture;

static const dpt_segment probe = { { -0.02, 0.1, 0.0 }, { 0.02, 0.1, 0.0 }, 0.004 };

static dpt_pose at(double x, double y, double z)
{
    return (dpt_pose){ { x, y, z }, { 0.8, 0.0, 0.0, 0.6 } };
}

static void scene_open(struct rig *scene)
{
    dpt_world_def def = rig_def(DPT_LAW_POINT);
    def.max_bodies = 6;
    def.max_tools = 5;
    def.max_segments = 9;
    def.margin = 0.01;
    def.max_contacts = 16;
    def.strip = 1;
    def.strip_capacity = 64;
    const dpt_pose pose = at(0.0, 0.0, 0.0);
    rig_open(scene, &def, NULL, &probe, 1);
    rig_add_body(scene, fixture.mesh, &pose);
}

static void same_pose(const dpt_pose *a, const dpt_pose *b)
{
    CHECK(!memcmp(a, b, sizeof *a), "%g %g %g", a->position[0], a->position[1], a->position[2]);
}

static void poses_are_told(void)
{
    struct rig of;
    scene_open(&of);
    const dpt_pose identity = DPT_POSE_IDENTITY, there = at(0.1, 0.2, 0.3), first = at(0, 0, 0);
    dpt_pose bad = there, told;
    bad.orientation[0] = 9.0;
    CHECK(dpt_body_get_pose(of.world, of.body, &told) == DPT_OK, "added");
    same_pose(&told, &first);
    dpt_body_set_pose(of.world, of.body, &there);
    dpt_body_set_pose(of.world, of.body, &bad);
    dpt_body_get_pose(of.world, of.body, &told);
    same_pose(&told, &there);
    dpt_tool_get_pose(of.world, of.tool, &told);
    same_pose(&told, &identity);
    dpt_tool_set_pose(of.world, of.tool, &there);
    dpt_tool_set_pose(of.world, of.tool, &bad);
    dpt_tool_get_pose(of.world, of.tool, &told);
    same_pose(&told, &there);
    dpt_tool_set_segments(of.world, of.tool, &probe, 1);
    CHECK(dpt_tool_get_pose(of.world, of.tool, &told) == DPT_OK, "given in the world");
    same_pose(&told, &identity);
    CHECK(dpt_tool_get_pose(of.world, of.body, &told) == DPT_E_HANDLE, "a body's id");
    same_pose(&told, &identity);
    CHECK(dpt_body_get_pose(of.world, of.body, NULL) == DPT_E_ARGUMENT, "nowhere to");
    rig_close(&of);
}

static void values_stay_with_their_owners(void)
{
    struct rig of;
    scene_open(&of);
    uint64_t user = 1;
    CHECK(dpt_body_get_user(of.world, of.body, &user) == DPT_OK && user == 0, "not 0 at first");
    dpt_body_set_user(of.world, of.body, UINT64_MAX - 1);
    dpt_tool_set_user(of.world, of.tool, 7);
    dpt_world_reset(of.world);
    CHECK(dpt_body_get_user(of.world, of.body, &user) == DPT_OK && user == UINT64_MAX - 1, "body");
    CHECK(dpt_tool_get_user(of.world, of.tool, &user) == DPT_OK && user == 7, "tool");
    dpt_body next;
    for (uint32_t i = 0; i < 20; i++) {
        CHECK(dpt_body_add(of.world, fixture.mesh, NULL, &next) == DPT_OK, "add");
        CHECK(dpt_body_get_user(of.world, next, &user) == DPT_OK && user == 0, "another's value");
        dpt_body_set_user(of.world, next, 3);
        dpt_body_remove(of.world, next);
        CHECK(dpt_body_get_user(of.world, next, &user) == DPT_E_HANDLE && user == 0, "removed");
        CHECK(dpt_body_set_user(of.world, next, 3) == DPT_E_HANDLE, "removed");
    }
    CHECK(dpt_tool_set_user(of.world, of.body, 3) == DPT_E_HANDLE, "a body's id");
    rig_close(&of);
}

static void an_id_is_alive_or_not(void)
{
    struct rig of;
    scene_open(&of);
    CHECK(dpt_body_is_valid(of.world, of.body) == 1, "body");
    CHECK(dpt_tool_is_valid(of.world, of.tool) == 1, "tool");
    CHECK(!dpt_body_is_valid(of.world, of.tool) && !dpt_tool_is_valid(of.world, of.body), "kind");
    CHECK(!dpt_body_is_valid(NULL, of.body) && !dpt_tool_is_valid(NULL, of.tool), "no world");
    uint64_t random = 5;
    for (uint32_t i = 0; i < 20000; i++) {
        const uint32_t any = i < 10 ? i : (uint32_t)random_bits(&random);
        CHECK(dpt_body_is_valid(of.world, any) == (any == of.body), "%x", any);
        CHECK(dpt_tool_is_valid(of.world, any) == (any == of.tool), "%x", any);
    }
    dpt_body_remove(of.world, of.body);
    dpt_tool_remove(of.world, of.tool);
    CHECK(!dpt_body_is_valid(of.world, of.body) && !dpt_tool_is_valid(of.world, of.tool), "gone");
    rig_close(&of);
}

struct reading {
    dpt_hit hit;
    dpt_sweep sweep;
    dpt_contact contacts[4];
    uint32_t count;
};

static struct reading tick(const struct rig *of)
{
    struct reading read = { .hit = DPT_HIT_INIT, .sweep = { .size = sizeof(dpt_sweep) } };
    dpt_step step = { .size = sizeof step };
    read.contacts[0].size = sizeof read.contacts[0];
    CHECK(dpt_world_step(of->world, 0.001, &step) == DPT_OK, "step");
    dpt_tool_get_hit(of->world, of->tool, &read.hit);
    dpt_tool_get_sweep(of->world, of->tool, 0, &read.sweep);
    dpt_tool_get_contacts(of->world, of->tool, read.contacts, 4, &read.count);
    for (uint32_t i = 0; i < 4 && i < read.count; i++)
        read.contacts[i].id = read.contacts[i].body = 0;
    read.hit.body = read.sweep.body = read.hit.work = 0;
    return read;
}

/* A jump across the tool is not a sweep, and is what removing and adding the body gives. */
static void a_jump_is_not_a_motion(void)
{
    struct rig jumps, adds, moves;
    struct rig *all[3] = { &jumps, &adds, &moves };
    const dpt_pose before = at(0.0, 0.0, -0.3), after = at(0.0, 0.0, 0.3);
    for (uint32_t i = 0; i < 3; i++) {
        scene_open(all[i]);
        dpt_body_set_pose(all[i]->world, all[i]->body, &before);
        tick(all[i]);
        tick(all[i]);
    }
    CHECK(dpt_body_teleport(jumps.world, jumps.body, &after) == DPT_OK, "teleport");
    dpt_body_remove(adds.world, adds.body);
    dpt_body_add(adds.world, fixture.mesh, &after, &adds.body);
    dpt_body_set_pose(moves.world, moves.body, &after);
    const struct reading jumped = tick(&jumps), added = tick(&adds), moved = tick(&moves);
    CHECK(moved.sweep.status == DPT_SWEEP_HIT, "the control met nothing: %u", moved.sweep.status);
    CHECK(jumped.sweep.status != DPT_SWEEP_HIT, "a jump was swept");
    CHECK(!memcmp(&jumped, &added, sizeof jumped), "not as if removed and added");
    dpt_pose bad = after;
    bad.position[0] = 1e300;
    CHECK(dpt_body_teleport(jumps.world, jumps.body, &bad) != DPT_OK, "a bad pose");
    CHECK(dpt_body_teleport(jumps.world, jumps.tool, &after) == DPT_E_HANDLE, "a tool's id");
    for (uint32_t i = 0; i < 3; i++)
        rig_close(all[i]);
}

static dpt_world_info usage_of(const struct rig *of)
{
    dpt_world_info usage = { .size = sizeof usage };
    CHECK(dpt_world_get_info(of->world, &usage) == DPT_OK, "usage");
    return usage;
}

static void the_most_in_use_is_told(void)
{
    struct rig of;
    scene_open(&of);
    dpt_world_info usage = usage_of(&of);
    CHECK(usage.bodies == 1 && usage.tools == 1 && usage.segments == 1, "%u %u %u", usage.bodies, usage.tools,
          usage.segments);
    CHECK(!usage.contacts && !usage.strip && !usage.work, "before the first step");
    const dpt_segment three[3] = { probe, probe, probe };
    dpt_body bodies[3];
    dpt_tool tool;
    for (uint32_t i = 0; i < 3; i++)
        dpt_body_add(of.world, fixture.mesh, NULL, &bodies[i]);
    for (uint32_t i = 0; i < 3; i++)
        dpt_body_remove(of.world, bodies[i]);
    dpt_body_add(of.world, fixture.mesh, NULL, &bodies[0]);
    dpt_body_remove(of.world, bodies[0]);
    dpt_tool_add(of.world, three, 3, &tool);
    dpt_tool_remove(of.world, tool);
    uint32_t most_contacts = 0, most_work = 0, most_strip = 0;
    for (uint32_t i = 0; i < 60; i++) {
        const dpt_pose pose = at(0.0, 0.0, -0.12 + 0.004 * i);
        dpt_step step = { .size = sizeof step };
        dpt_tool_set_pose(of.world, of.tool, &pose);
        dpt_world_step(of.world, 0.001, &step);
        uint32_t strip = 0;
        dpt_overlap overlap = { .size = sizeof overlap };
        dpt_tool_get_strip(of.world, of.tool, 0, &overlap, 1, &strip, NULL);
        most_contacts = step.contacts > most_contacts ? step.contacts : most_contacts;
        most_work = step.work > most_work ? step.work : most_work;
        most_strip = strip > most_strip ? strip : most_strip;
    }
    dpt_world_reset(of.world);
    usage = usage_of(&of);
    CHECK(usage.bodies == 4 && usage.tools == 2 && usage.segments == 4, "%u %u %u", usage.bodies, usage.tools,
          usage.segments);
    CHECK(most_contacts > 0 && usage.contacts == most_contacts, "%u, counted %u", usage.contacts, most_contacts);
    CHECK(most_work > 0 && usage.work == most_work, "%u, counted %u", usage.work, most_work);
    CHECK(most_strip > 0 && usage.strip == most_strip, "%u, counted %u", usage.strip, most_strip);
    rig_close(&of);
}

/* Regions that found no room count: that is what the number is for. */
static void a_lack_is_told(void)
{
    dpt_world_def def = rig_def(DPT_LAW_POINT);
    struct rig of;
    def.margin = 0.01;
    def.max_tools = 1;
    def.max_segments = 4;
    def.max_contacts = 1;
    const dpt_segment four[4] = { probe, probe, probe, probe };
    rig_open(&of, &def, fixture.mesh, four, 4);
    const dpt_pose inside = at(0.0, 0.0, 0.0);
    dpt_step step = { .size = sizeof step };
    dpt_tool_set_pose(of.world, of.tool, &inside);
    dpt_world_step(of.world, 0.001, &step);
    const dpt_world_info usage = usage_of(&of);
    CHECK(step.contacts == 1 && (step.flags & DPT_STEP_FLAG_CONTACTS_FULL), "no lack: %u", step.contacts);
    CHECK(usage.contacts == 4, "%u regions wanted", usage.contacts);
    rig_close(&of);
}

/* So does one whose side was to be remembered when two lines flew through a sheet at once, to beyond its side limit. */
static void a_lack_of_room_for_sides_is_told(void)
{
    struct fixture sheet;
    if (!fixture_from_shape(&sheet, "membrane", 18))
        return;
    dpt_world_def def = rig_def(DPT_LAW_POINT);
    struct rig of;
    def.max_contacts = 1;
    def.side_limit = 0.01;
    const dpt_segment two[2] = { { { -0.02, 0.01, 0 }, { -0.02, 0.03, 0 }, 0.0 },
                                 { { 0.02, 0.01, 0 }, { 0.02, 0.03, 0 }, 0.0 } };
    rig_open(&of, &def, sheet.mesh, two, 2);
    dpt_step step = { .size = sizeof step };
    for (int i = 0; i < 2; i++) {
        const dpt_pose pose = { { 0.0, 0.0, i ? -0.05 : 0.05 }, { 1.0, 0.0, 0.0, 0.0 } };
        dpt_tool_set_pose(of.world, of.tool, &pose);
        dpt_world_step(of.world, 0.001, &step);
    }
    const dpt_world_info usage = usage_of(&of);
    CHECK(step.flags & DPT_STEP_FLAG_CONTACTS_FULL, "no lack");
    CHECK(usage.contacts == 2, "%u wanted", usage.contacts);
    rig_close(&of);
    fixture_free(&sheet);
}

static void the_pair_alone_is_the_same_pair(void)
{
    enum { ASKED = 400 };
    static double ends[6 * ASKED], radii[ASKED];
    static dpt_hit full[ASKED], alone[ASKED];
    uint64_t random = 9;
    for (uint32_t i = 0; i < 6 * ASKED; i++)
        ends[i] = random_in(&random, -0.15, 0.15);
    for (uint32_t i = 0; i < ASKED; i++)
        radii[i] = random_in(&random, 0.0, 0.01);
    const dpt_query_def pair = { .size = sizeof pair, .pair = 1 };
    full[0].size = alone[0].size = sizeof full[0];
    dpt_query_segments(fixture.mesh, NULL, ends, radii, ASKED, full, NULL);
    CHECK(dpt_query_segments(fixture.mesh, NULL, ends, radii, ASKED, alone, &pair) == DPT_OK, "ok");
    uint32_t gaps = 0;
    for (uint32_t i = 0; i < ASKED; i++) {
        const dpt_hit *a = &full[i], *b = &alone[i];
        CHECK(a->triangle == b->triangle && a->distance == b->distance && a->s == b->s &&
                  !memcmp(a->p, b->p, sizeof a->p) && !memcmp(a->q, b->q, sizeof a->q),
              "segment %u: %g and %g", i, a->distance, b->distance);
        CHECK(b->contact == DPT_CONTACT_UNKNOWN && !(b->flags & DPT_HIT_FLAG_GAP) && b->gap == 0.0 && b->depth == 0.0,
              "segment %u has a contact", i);
        gaps += a->flags & DPT_HIT_FLAG_GAP ? 1 : 0;
    }
    CHECK(gaps == ASKED, "%u of %u have a gap", gaps, (unsigned)ASKED);
}

static void all_triangles_at_once(void)
{
    const float *xyz = NULL;
    const uint32_t *corners = NULL, *numbers = NULL;
    uint32_t vertices = 0, triangles = 0;
    CHECK(dpt_mesh_get_vertices(fixture.mesh, &xyz, &vertices) == DPT_OK, "vertices");
    CHECK(dpt_mesh_get_triangles(fixture.mesh, &corners, &numbers, &triangles) == DPT_OK, "corners");
    dpt_mesh_info info = { .size = sizeof info };
    dpt_mesh_get_info(fixture.mesh, &info);
    CHECK(vertices == info.vertices && triangles == info.triangles, "%u, %u", vertices, triangles);
    for (uint32_t t = 0; t < triangles; t++) {
        double one[9];
        CHECK(dpt_mesh_get_triangle(fixture.mesh, numbers[t], one) == DPT_OK, "number %u", numbers[t]);
        for (uint32_t i = 0; i < 9; i++)
            CHECK(one[i] == (double)xyz[3 * corners[3 * t + i / 3] + i % 3], "triangle %u", t);
    }
    CHECK(dpt_mesh_get_triangles(fixture.mesh, &corners, NULL, &triangles) == DPT_OK, "no numbers");
    CHECK(dpt_mesh_get_triangles(NULL, &corners, NULL, &triangles) == DPT_E_ARGUMENT, "no mesh");
    CHECK(dpt_mesh_get_vertices(fixture.mesh, NULL, &vertices) == DPT_E_ARGUMENT, "nowhere to");
}

static void the_version_is_a_number_too(void)
{
    char text[32];
    const uint32_t number = dpt_version_number();
    snprintf(text, sizeof text, "%u.%u.%u", number >> 16, number >> 8 & 255, number & 255);
    CHECK(!strcmp(text, dpt_version()), "%s is not %s", text, dpt_version());
}

int main(void)
{
    if (!fixture_from_shape(&fixture, "torus", 2000))
        return 2;
    TEST(poses_are_told);
    TEST(values_stay_with_their_owners);
    TEST(an_id_is_alive_or_not);
    TEST(a_jump_is_not_a_motion);
    TEST(the_most_in_use_is_told);
    TEST(a_lack_is_told);
    TEST(a_lack_of_room_for_sides_is_told);
    TEST(the_pair_alone_is_the_same_pair);
    TEST(all_triangles_at_once);
    TEST(the_version_is_a_number_too);
    fixture_free(&fixture);
    return check_report();
}
