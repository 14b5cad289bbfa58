/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A needle and a body that it may pierce, in a world of its own: settings, steps, jumps, needles put in, bodies that go
 * and come, well and badly. What must hold: codes; wrenches and channels that are finite, of bodies that are there and
 * at most as many as there is room for. What a needle goes through is for test_needle_soak.
 */
#include "fuzz/calls/rules.h"

enum { CHANNELS_MOST = 3, ACTIONS = 40, REGIONS_MOST = 3, FACES_MOST = 4096 };

static struct {
    const struct subject *subject;
    dpt_world *world;
    unsigned char *block;
    dpt_body body;
    dpt_tool tool;
    dpt_pose pose;
} needle;

static void add_body(void)
{
    const dpt_body_settings settings = { .size = sizeof settings,
                                         .stiffness = draw_one_in(2) ? 0.0 : draw_in(1.0, 5000.0),
                                         .puncture_force = draw_one_in(2) ? 0.0 : draw_in(0.01, 50.0),
                                         .toughness = draw_in(1.0, 1e4),
                                         .cutting_force = draw_in(0.0, 20.0),
                                         .shaft_friction = draw_in(0.0, 1000.0),
                                         .shaft_viscosity = draw_one_in(2) ? 0.0 : draw_in(0.0, 1000.0),
                                         .shaft_stiffness = draw_one_in(2) ? 0.0 : draw_in(0.0, 1e6) };
    HOLDS(dpt_body_add(needle.world, needle.subject->mesh, NULL, &needle.body) == DPT_OK, "no body");
    HOLDS(RESULT(dpt_body_set_settings, needle.world, needle.body, &settings) == DPT_OK, "no settings");
}

/* Open it, if it is not. */
static void open_world(void)
{
    const dpt_pose identity = DPT_POSE_IDENTITY;
    const dpt_segment shaft = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, draw_in(0.1, 8.0) }, draw_in(0.001, 0.2) };
    dpt_world_def def;
    dpt_tool_settings settings = { .size = sizeof settings };
    needle.subject = draw_subject();
    dpt_world_def_init(&def);
    def.max_bodies = def.max_tools = def.max_segments = 1;
    def.max_tips = 0;
    def.max_channels = 1 + draw_below(CHANNELS_MOST);
    def.budget = draw_one_in(3) ? 1 + draw_below(2000) : 0;
    const size_t room = dpt_world_bytes(&def);
    needle.block = malloc(room);
    HOLDS(dpt_world_create(needle.block, room, &def, &needle.world) == DPT_OK, "no world");
    HOLDS(dpt_tool_add(needle.world, &shaft, 1, &needle.tool) == DPT_OK, "no tool");
    dpt_tool_get_settings(needle.world, needle.tool, &settings);
    settings.piercing = 1 + draw_below(2);
    HOLDS(RESULT(dpt_tool_set_settings, needle.world, needle.tool, &settings) == DPT_OK, "no settings");
    needle.pose = identity;
    add_body();
}

/* Regions of the body, well and badly. */
static void set_regions(void)
{
    static uint8_t of_triangle[FACES_MOST];
    dpt_mesh_info info = { .size = sizeof info };
    dpt_body_region regions[REGIONS_MOST] = { { .size = sizeof *regions } };
    const int no_world = draw_one_in(30), no_body = draw_one_in(30), is_short = draw_one_in(30),
              is_odd = draw_one_in(30);
    const int has_too_many = draw_one_in(30), is_wrong = draw_one_in(30);
    const uint32_t count = has_too_many ? DPT_BODY_REGIONS_MAX + 1 : draw_below(REGIONS_MOST + 1);
    struct codes codes = { .count = 0 };
    dpt_mesh_get_info(needle.subject->mesh, &info);
    if (info.source_triangles > FACES_MOST)
        return;
    for (uint32_t i = 0; i < info.source_triangles; i++)
        of_triangle[i] = (uint8_t)draw_below((count < REGIONS_MOST ? count : REGIONS_MOST) + 1);
    for (uint32_t i = 0; i < REGIONS_MOST; i++)
        regions[i] = (dpt_body_region){ .size = sizeof *regions,
                                        .puncture_force = draw_one_in(3) ? 0.0 : draw_in(0.01, 50.0),
                                        .toughness = draw_one_in(3) ? 0.0 : draw_in(1.0, 1e4),
                                        .cutting_force = draw_in(0.0, 20.0),
                                        .shaft_friction = draw_in(0.0, 1000.0),
                                        .shaft_viscosity = draw_in(0.0, 1000.0) };
    if (is_wrong)
        regions[0].toughness = -1.0;
    if (is_odd)
        of_triangle[draw_below(info.source_triangles)] = REGIONS_MOST + 1;
    may_fail(&codes, no_world, DPT_E_ARGUMENT);
    may_fail(&codes, no_body, DPT_E_HANDLE);
    may_fail(&codes, has_too_many, DPT_E_LIMIT);
    may_fail(&codes, count && (is_short || is_wrong), DPT_E_ARGUMENT);
    may_fail(&codes, count && is_odd, DPT_E_INDEX);
    expect(RESULT(dpt_body_set_regions, no_world ? NULL : needle.world, no_body ? 0 : needle.body, of_triangle,
                  info.source_triangles - (uint32_t)is_short, regions, count),
           &codes);
    if (codes.count)
        dpt_body_set_regions(needle.world, needle.body, NULL, 0, NULL, 0);
}

static void look(void)
{
    dpt_wrench wrench;
    dpt_channel channels[CHANNELS_MOST] = { { .size = sizeof *channels } };
    uint32_t count = 77;
    dpt_tool_get_wrench(needle.world, needle.tool, &wrench);
    for (int k = 0; k < 3; k++)
        HOLDS(isfinite(wrench.force[k]) && isfinite(wrench.torque[k]), "a wrench of %g N", wrench.force[k]);
    HOLDS(RESULT(dpt_tool_get_channels, needle.world, needle.tool, channels, CHANNELS_MOST, &count) == DPT_OK,
          "no channels");
    HOLDS(count <= CHANNELS_MOST, "%u channels", count);
    for (uint32_t i = 0; i < count && i < CHANNELS_MOST; i++)
        HOLDS(channels[i].body == needle.body && channels[i].id && channels[i].ruptures &&
                  isfinite(channels[i].depth) && channels[i].inside >= 0.0 && isfinite(channels[i].friction) &&
                  isfinite(channels[i].tip),
              "channel %u of body %x", channels[i].id, channels[i].body);
    static unsigned char snapshot[1 << 14];
    dpt_snapshot_channel seen = { .size = sizeof seen };
    size_t bytes = 0;
    HOLDS(dpt_world_take_snapshot(needle.world, NULL, snapshot, sizeof snapshot, &bytes) == DPT_OK, "no snapshot");
    const uint32_t which = draw_below(CHANNELS_MOST);
    const dpt_result read = RESULT(dpt_snapshot_get_channel, snapshot, bytes, which, &seen);
    HOLDS(which < count ? read == DPT_OK && seen.id == channels[which].id && seen.depth == channels[which].depth
                        : read == DPT_E_ARGUMENT,
          "channel %u of %u in a snapshot: %s", which, count, dpt_result_name(read));
    game_digest(&wrench, sizeof wrench);
    game_digest(&count, sizeof count);
}

static void move(void)
{
    const double reach = draw_one_in(10) ? 10.0 : 0.5;
    for (int k = 0; k < 3; k++)
        needle.pose.position[k] += draw_in(-reach, reach);
    if (draw_one_in(8)) {
        double *q = needle.pose.orientation, size = 0.0;
        for (int k = 0; k < 4; k++) {
            q[k] = draw_in(-1.0, 1.0);
            size += q[k] * q[k];
        }
        for (int k = 0; k < 4; k++)
            q[k] = size > 1e-3 ? q[k] / sqrt(size) : k == 0;
    }
    (draw_one_in(20) ? dpt_tool_teleport : dpt_tool_set_pose)(needle.world, needle.tool, &needle.pose);
    HOLDS(dpt_world_step(needle.world, draw_one_in(2) ? 1e-3 : 1e-4, NULL) == DPT_OK, "no tick");
}

static void put_in(void)
{
    const int no_world = draw_one_in(20), no_tool = draw_one_in(20);
    struct codes codes = { .count = 0 };
    may_fail(&codes, no_world, DPT_E_ARGUMENT);
    may_fail(&codes, no_tool, DPT_E_HANDLE);
    /* Whether it goes into the body depends on where it is. */
    codes.or_done = !codes.count;
    may_fail(&codes, !codes.count, DPT_E_ARGUMENT);
    may_fail(&codes, codes.or_done, DPT_E_FULL);
    expect(RESULT(dpt_tool_insert, no_world ? NULL : needle.world, no_tool ? 0 : needle.tool), &codes);
}

static void end(void)
{
    open_world();
    for (int i = 0; i < ACTIONS; i++) {
        if (draw_one_in(6))
            put_in();
        if (draw_one_in(20)) {
            HOLDS(dpt_body_remove(needle.world, needle.body) == DPT_OK, "it stays");
            add_body();
        }
        if (draw_one_in(10))
            set_regions();
        if (draw_one_in(40))
            HOLDS(dpt_world_reset(needle.world) == DPT_OK, "no reset");
        move();
        look();
    }
    free(needle.block);
    memset(&needle, 0, sizeof needle);
}

static const struct move moves[] = { { NULL, NULL, 0 } };

const struct noun needle_noun = { "needle", NULL, end, moves };
