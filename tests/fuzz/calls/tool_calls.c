/* SPDX-License-Identifier: BSD-3-Clause */
/* Tools: added, removed, moved as rigid or free ones, asked, in every order and beyond every capacity. */
#include "fuzz/calls/world_model.h"

enum { CHURN_MAX = 4200 };

static void add_one(struct scene *scene, const dpt_segment *segments, uint32_t count, int no_world, int no_out)
{
    struct codes codes = { .count = 0 };
    dpt_tool id[2] = { 0x5a5a5a5a, 0x5a5a5a5a };
    dpt_result result = DPT_OK;
    may_fail(&codes, no_world || !segments || no_out || !count, DPT_E_ARGUMENT);
    for (uint32_t i = 0; segments && i < count; i++)
        segment_codes(&segments[i], &codes);
    if (!no_world)
        may_fail(&codes,
                 scene->tool_count == scene->def.max_tools || count > scene->def.max_segments - scene->segment_count,
                 DPT_E_FULL);
    call_with("scene %llu, %llu segments beside %llu, %llu tools", (uint64_t)(scene - scenes), count,
              scene->segment_count, scene->tool_count);
    EACH_WORLD(scene, i)
    SAME_RESULT(i, result,
                RESULT(dpt_tool_add, world_or_null(scene, i, no_world), segments, count, no_out ? NULL : &id[i]));
    expect(result, &codes);
    if (result != DPT_OK) {
        HOLDS(id[0] == 0x5a5a5a5a || id[0] == 0, "an id %x on an error", id[0]);
        return;
    }
    HOLDS(scene->world_count < 2 || id[0] == id[1], "the twin has id %x, and not %x", id[1], id[0]);
    HOLDS(scene->tool_count < TOOLS_MAX && count <= SEGMENTS_MAX, "more than the model holds");
    scene_takes_id(scene, &scene->removed_tools, id[0]);
    struct model_tool *tool = &scene->tool[scene->tool_count++];
    *tool = (struct model_tool){ .id = id[0],
                                 .is_usable = 1,
                                 .count = count,
                                 .pose = DPT_POSE_IDENTITY,
                                 .law = scene->def.law,
                                 .stiffness = scene->def.stiffness,
                                 .is_placed_anew = 1 };
    memcpy(tool->segment, segments, count * sizeof *segments);
    scene->segment_count += count;
    if (scene->least.tools < scene->tool_count)
        scene->least.tools = scene->tool_count;
    if (scene->least.segments < scene->segment_count)
        scene->least.segments = scene->segment_count;
    scene->is_as_stepped = 0;
}

/* In a block of their exact length; NULL is the caller's to draw. */
static const dpt_segment *draw_segments(uint32_t count)
{
    dpt_segment *segments = output_of(OUTPUTS - 1, count * sizeof *segments);
    for (uint32_t i = 0; i < count; i++)
        segments[i] = draw_segment();
    for (uint32_t i = 1; i < count && draw_one_in(2); i++)
        memcpy(segments[i].a, segments[i - 1].b, sizeof segments[i].a);
    return segments;
}

static void add(void)
{
    struct scene *scene = draw_scene();
    if (!scene)
        return;
    const uint32_t count = draw_one_in(30) ? 0 : 1 + draw_below(draw_one_in(6) ? 12 : 3);
    const dpt_segment *segments = draw_segments(count);
    add_one(scene, draw_one_in(60) ? NULL : segments, count, draw_one_in(60), draw_one_in(60));
}

static void remove_one(struct scene *scene, uint32_t id, int no_world)
{
    struct codes codes = { .count = 0 };
    struct model_tool *tool = scene_tool(scene, id);
    dpt_result result = DPT_OK;
    may_fail(&codes, no_world, DPT_E_ARGUMENT);
    may_fail(&codes, !tool, DPT_E_HANDLE);
    call_with("scene %llu, id %llx", (uint64_t)(scene - scenes), id, 0, 0);
    EACH_WORLD(scene, i)
    SAME_RESULT(i, result, RESULT(dpt_tool_remove, world_or_null(scene, i, no_world), id));
    expect(result, &codes);
    if (result == DPT_OK)
        scene_remove_tool(scene, tool);
}

static void remove_any(void)
{
    struct scene *scene = draw_scene();
    if (scene)
        remove_one(scene, draw_tool_id(scene), draw_one_in(60));
}

/* In and out, until ids come round. */
static void churn(void)
{
    struct scene *scene = draw_scene();
    if (!scene || scene->tool_count == scene->def.max_tools || scene->segment_count == scene->def.max_segments)
        return;
    const uint32_t times = draw_one_in(20) ? CHURN_MAX : 1 + draw_below(20);
    const dpt_segment segment = { { 0.0, 0.0, 0.0 }, { 0.1, 0.0, 0.0 }, 0.001 };
    for (uint32_t i = 0; i < times; i++) {
        add_one(scene, &segment, 1, 0, 0);
        const uint32_t id = scene->tool[scene->tool_count - 1].id;
        remove_one(scene, id, 0);
        HOLDS(!CALL(dpt_tool_is_valid, scene->world[0], id), "id %x is still there", id);
    }
}

/* dpt_tool_set_pose and dpt_tool_teleport. */
static void move(void)
{
    struct scene *scene = draw_scene();
    if (!scene)
        return;
    const uint32_t id = draw_tool_id(scene);
    struct model_tool *tool = scene_tool(scene, id);
    const dpt_pose pose = draw_pose(tool ? &tool->pose : NULL);
    const int no_world = draw_one_in(60), no_pose = draw_one_in(60), jumps = draw_one_in(3);
    struct codes codes = { .count = 0 };
    dpt_result result = DPT_OK;
    may_fail(&codes, no_world || no_pose, DPT_E_ARGUMENT);
    may_fail(&codes, !tool, DPT_E_HANDLE);
    if (!no_pose)
        pose_codes(&pose, &codes);
    call_with("scene %llu, id %llx", (uint64_t)(scene - scenes), id, 0, 0);
    EACH_WORLD(scene, i)
    {
        dpt_world *world = world_or_null(scene, i, no_world);
        const dpt_pose *given = no_pose ? NULL : &pose;
        SAME_RESULT(i, result,
                    jumps ? RESULT(dpt_tool_teleport, world, id, given) : RESULT(dpt_tool_set_pose, world, id, given));
    }
    expect(result, &codes);
    if (no_world || !tool)
        return;
    tool_has_pose(scene, tool, result == DPT_OK ? &pose : NULL);
    if (tool->is_usable && jumps)
        tool->is_placed_anew = 1;
    if (tool->is_usable && jumps && tool->answers == ANSWERS_THERE)
        tool->answers = ANSWERS_EITHER;
}

static void set_segments(void)
{
    struct scene *scene = draw_scene();
    if (!scene)
        return;
    const uint32_t id = draw_tool_id(scene);
    struct model_tool *tool = scene_tool(scene, id);
    uint32_t count = tool ? tool->count : 1;
    if (draw_one_in(30))
        count = draw_below(4);
    dpt_segment *segments = (dpt_segment *)(uintptr_t)draw_segments(count);
    for (uint32_t i = 0; tool && i < count && i < tool->count && draw_one_in(8) == 0; i++)
        for (int k = 0; k < 3; k++) {
            const double step = draw_in(-0.004, 0.004);
            segments[i].a[k] = tool->segment[i].a[k] + step;
            segments[i].b[k] = tool->segment[i].b[k] + step;
        }
    const int no_world = draw_one_in(60), no_segments = draw_one_in(60);
    struct codes codes = { .count = 0 };
    dpt_result result = DPT_OK;
    may_fail(&codes, no_world, DPT_E_ARGUMENT);
    segments_codes(scene, tool, no_segments ? NULL : segments, count, &codes);
    call_with("scene %llu, id %llx, %llu segments", (uint64_t)(scene - scenes), id, count, 0);
    EACH_WORLD(scene, i)
    SAME_RESULT(
        i, result,
        RESULT(dpt_tool_set_segments, world_or_null(scene, i, no_world), id, no_segments ? NULL : segments, count));
    expect(result, &codes);
    if (no_world || !tool)
        return;
    tool_has_segments(scene, tool, result == DPT_OK ? segments : NULL);
}

static void get_pose(void)
{
    struct scene *scene = draw_scene();
    if (!scene)
        return;
    const uint32_t id = draw_tool_id(scene);
    const struct model_tool *tool = scene_tool(scene, id);
    const int no_world = draw_one_in(60), no_out = draw_one_in(60);
    struct codes codes = { .count = 0 };
    dpt_result result = DPT_OK;
    may_fail(&codes, no_world || no_out, DPT_E_ARGUMENT);
    may_fail(&codes, !tool, DPT_E_HANDLE);
    call_with("scene %llu, id %llx", (uint64_t)(scene - scenes), id, 0, 0);
    EACH_WORLD(scene, i)
    {
        dpt_pose *out = output_of(i, sizeof *out);
        SAME_RESULT(i, result, RESULT(dpt_tool_get_pose, world_or_null(scene, i, no_world), id, no_out ? NULL : out));
        const dpt_pose identity = DPT_POSE_IDENTITY;
        const dpt_pose *expected = result == DPT_OK ? &tool->pose : &identity;
        HOLDS((result != DPT_OK && output_is_untouched(i, 0)) || !memcmp(out, expected, sizeof *out),
              "not the last pose that could be used");
    }
    expect(result, &codes);
    outputs_are_guarded(0, scene->world_count);
}

static void user(void)
{
    struct scene *scene = draw_scene();
    if (!scene)
        return;
    const uint32_t id = draw_tool_id(scene);
    struct model_tool *tool = scene_tool(scene, id);
    const int no_world = draw_one_in(60), sets = draw_one_in(2), no_out = !sets && draw_one_in(60);
    const uint64_t value = draw_bits();
    struct codes codes = { .count = 0 };
    dpt_result result = DPT_OK;
    may_fail(&codes, no_world || no_out, DPT_E_ARGUMENT);
    may_fail(&codes, !tool, DPT_E_HANDLE);
    call_with("scene %llu, id %llx, %llx", (uint64_t)(scene - scenes), id, value, 0);
    EACH_WORLD(scene, i)
    {
        dpt_world *world = world_or_null(scene, i, no_world);
        uint64_t *out = output_of(i, sizeof *out);
        SAME_RESULT(i, result,
                    sets ? RESULT(dpt_tool_set_user, world, id, value)
                         : RESULT(dpt_tool_get_user, world, id, no_out ? NULL : out));
        HOLDS(sets || no_out || output_is_untouched(i, 0) || *out == (result == DPT_OK ? tool->user : 0), "user %llx",
              (unsigned long long)*out);
        HOLDS(sets || result != DPT_OK || !output_is_untouched(i, 0), "nothing was told");
    }
    expect(result, &codes);
    outputs_are_guarded(0, scene->world_count);
    if (sets && result == DPT_OK)
        tool->user = value;
}

static void set_settings(void)
{
    struct scene *scene = draw_scene();
    if (!scene)
        return;
    const uint32_t id = draw_tool_id(scene);
    struct model_tool *tool = scene_tool(scene, id);
    const int no_world = draw_one_in(60), no_settings = draw_one_in(60);
    const dpt_tool_settings settings = { .law = draw_one_in(20)  ? draw_below(5)
                                                : draw_one_in(2) ? DPT_LAW_PROXY
                                                : draw_one_in(3) ? DPT_LAW_BED
                                                                 : DPT_LAW_POINT,
                                         .stiffness = draw_one_in(4) ? draw_odd_number() : draw_in(0.0, 1500.0),
                                         .rotational_stiffness = draw_one_in(8)   ? draw_odd_number()
                                                                 : draw_one_in(2) ? 0.0
                                                                                  : draw_in(0.001, 5.0),
                                         .damping = draw_one_in(16)  ? draw_odd_number()
                                                    : draw_one_in(4) ? draw_in(0.0, 5.0)
                                                                     : 0.0,
                                         .lock_rotation = draw_one_in(30)  ? 2u
                                                          : draw_one_in(5) ? 1u
                                                                           : 0u,
                                         .near_only = draw_one_in(60)  ? 2u
                                                      : draw_one_in(3) ? 1u
                                                                       : 0u,
                                         /* These worlds have no room for channels: no tool of theirs pierces. */
                                         .piercing = draw_one_in(30) ? draw_below(4) : 0u };
    const uint32_t size = draw_size(offsetof(dpt_tool_settings, piercing), sizeof settings);
    const uint32_t piercing = size >= offsetof(dpt_tool_settings, reserved) ? settings.piercing : 0u;
    struct codes codes = { .count = 0 };
    dpt_result result = DPT_OK;
    may_fail(&codes, no_world || no_settings, DPT_E_ARGUMENT);
    may_fail(&codes, !tool, DPT_E_HANDLE);
    const void *given = NULL;
    if (!no_settings) {
        given = draw_input(0, &settings, size, offsetof(dpt_tool_settings, piercing), sizeof settings, &codes);
        may_fail(&codes,
                 settings.law > DPT_LAW_PROXY || !(settings.stiffness >= 0.0 && settings.stiffness <= 1e9) ||
                     !(settings.rotational_stiffness >= 0.0 && settings.rotational_stiffness <= 1e9) ||
                     !(settings.damping >= 0.0 && settings.damping <= 1e9) || settings.lock_rotation > 1 ||
                     settings.near_only > 1 || piercing > DPT_PIERCING_B,
                 DPT_E_ARGUMENT);
        may_fail(&codes, piercing > 0, DPT_E_UNSUPPORTED);
        may_fail(&codes, tool && tool->is_free && tool->count > 1 && has_proxy(scene, settings.law), DPT_E_UNSUPPORTED);
    }
    call_with("scene %llu, id %llx", (uint64_t)(scene - scenes), id, 0, 0);
    EACH_WORLD(scene, i)
    SAME_RESULT(i, result, RESULT(dpt_tool_set_settings, world_or_null(scene, i, no_world), id, given));
    expect(result, &codes);
    if (result != DPT_OK)
        return;
    tool->stiffness = settings.stiffness;
    tool->rotational_stiffness = settings.rotational_stiffness;
    tool->damping = settings.damping;
    tool->lock_rotation = settings.lock_rotation;
    tool->near_only = settings.near_only;
    scene->is_as_stepped = 0;
    if (tool->law == settings.law)
        return;
    tool->law = settings.law;
    tool->is_placed_anew = 1;
    if (tool->answers == ANSWERS_THERE)
        tool->answers = ANSWERS_EITHER;
}

static void get_settings(void)
{
    struct scene *scene = draw_scene();
    if (!scene)
        return;
    const uint32_t id = draw_tool_id(scene);
    const struct model_tool *tool = scene_tool(scene, id);
    const int no_world = draw_one_in(60), no_out = draw_one_in(60);
    dpt_tool_settings now;
    const uint32_t size = draw_size(offsetof(dpt_tool_settings, piercing), sizeof now);
    struct codes codes = { .count = 0 };
    dpt_result result = DPT_OK;
    may_fail(&codes, no_world || no_out, DPT_E_ARGUMENT);
    may_fail(&codes, !tool, DPT_E_HANDLE);
    if (!no_out)
        size_codes_of_output(size, offsetof(dpt_tool_settings, piercing), 0, &codes);
    call_with("scene %llu, id %llx, size %llu", (uint64_t)(scene - scenes), id, size, 0);
    EACH_WORLD(scene, i)
    {
        void *out = output_sized(i, size);
        SAME_RESULT(i, result,
                    RESULT(dpt_tool_get_settings, world_or_null(scene, i, no_world), id, no_out ? NULL : out));
    }
    expect(result, &codes);
    outputs_are_guarded(0, scene->world_count);
    if (result == DPT_OK && output_read(0, size, sizeof now, 8, &now))
        HOLDS(now.stiffness == tool->stiffness && now.law == tool->law &&
                  now.rotational_stiffness == tool->rotational_stiffness && now.damping == tool->damping &&
                  now.lock_rotation == tool->lock_rotation && now.near_only == tool->near_only,
              "law %u, stiffness %g, %g, and not %u, %g, %g", now.law, now.stiffness, now.rotational_stiffness,
              tool->law, tool->stiffness, tool->rotational_stiffness);
}

static void is_valid(void)
{
    struct scene *scene = draw_scene();
    if (!scene)
        return;
    for (int k = 0; k < 4; k++) {
        const uint32_t id = draw_tool_id(scene);
        const int no_world = draw_one_in(60);
        call_with("scene %llu, id %llx", (uint64_t)(scene - scenes), id, 0, 0);
        EACH_WORLD(scene, i)
        HOLDS(CALL(dpt_tool_is_valid, world_or_null(scene, i, no_world), id) == (!no_world && scene_tool(scene, id)),
              "id %x", id);
    }
}

void scene_gets_tools(struct scene *scene)
{
    for (uint32_t k = 1 + draw_below(3); k; k--) {
        const uint32_t count = 1 + draw_below(3);
        add_one(scene, draw_segments(count), count, 0, 0);
    }
}

static const struct move moves[] = { { "add", add, 12 },
                                     { "remove", remove_any, 4 },
                                     { "churn", churn, 1 },
                                     { "move", move, 24 },
                                     { "set segments", set_segments, 12 },
                                     { "get pose", get_pose, 4 },
                                     { "user", user, 6 },
                                     { "set settings", set_settings, 4 },
                                     { "get settings", get_settings, 4 },
                                     { "is valid", is_valid, 3 },
                                     { NULL, NULL, 0 } };

const struct noun tool_noun = { "tool", NULL, NULL, moves };
