/* SPDX-License-Identifier: BSD-3-Clause */
/* Proxies: asked for at any time, and pressed into what is near, while bodies come and go. */
#include "fuzz/calls/rules.h"

static void get_pose(int is_end)
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
        const dpt_pose identity = DPT_POSE_IDENTITY;
        dpt_pose *out = output_of(i, sizeof *out);
        const dpt_world *world = world_or_null(scene, i, no_world);
        dpt_pose *pose = no_out ? NULL : out;
        SAME_RESULT(i, result,
                    is_end ? RESULT(dpt_tool_get_end, world, id, pose) : RESULT(dpt_tool_get_proxy, world, id, pose));
        HOLDS(result == DPT_OK || output_is_untouched(i, 0) || !memcmp(out, &identity, sizeof *out),
              "a pose on an error");
        HOLDS(result != DPT_OK || has_proxy(scene, tool->law) || !memcmp(out, &tool->pose, sizeof *out),
              "not the tool's pose, and no proxy");
    }
    expect(result, &codes);
    outputs_are_guarded(0, scene->world_count);
    if (scene->world_count == 2)
        outputs_agree(1);
    if (result == DPT_OK)
        game_digest(output_at(0), sizeof(dpt_pose));
}

static void get_proxy(void)
{
    get_pose(0);
}

static void get_end(void)
{
    get_pose(1);
}

/* The device goes on by `step`, as what it is; a free one's size changes now and then. */
static void lead(struct scene *scene, struct model_tool *tool, const double step[3])
{
    struct codes codes = { .count = 0 };
    dpt_result result = DPT_OK;
    if (!tool->is_free) {
        dpt_pose pose = tool->pose;
        if (draw_one_in(3)) {
            const dpt_pose turned = draw_pose(&tool->pose);
            memcpy(pose.orientation, turned.orientation, sizeof pose.orientation);
        }
        for (int k = 0; k < 3; k++)
            pose.position[k] += step[k];
        pose_codes(&pose, &codes);
        EACH_WORLD(scene, w)
        SAME_RESULT(w, result, RESULT(dpt_tool_set_pose, scene->world[w], tool->id, &pose));
        expect(result, &codes);
        tool_has_pose(scene, tool, result == DPT_OK ? &pose : NULL);
        return;
    }
    dpt_segment segments[SEGMENTS_MAX];
    memcpy(segments, tool->segment, tool->count * sizeof *segments);
    for (uint32_t i = 0; i < tool->count; i++)
        for (int k = 0; k < 3; k++) {
            segments[i].a[k] += step[k];
            segments[i].b[k] += step[k] + draw_in(-0.0005, 0.0005);
        }
    if (draw_one_in(20))
        segments[0].radius *= draw_in(0.5, 1.5);
    segments_codes(scene, tool, segments, tool->count, &codes);
    EACH_WORLD(scene, w)
    SAME_RESULT(w, result, RESULT(dpt_tool_set_segments, scene->world[w], tool->id, segments, tool->count));
    expect(result, &codes);
    tool_has_segments(scene, tool, result == DPT_OK ? segments : NULL);
}

/* A body moves a little. */
static void stir(struct scene *scene)
{
    struct model_body *body = &scene->body[draw_below(scene->body_count)];
    const double step = draw_one_in(4) ? 0.02 : 0.001;
    dpt_pose pose = body->pose;
    struct codes codes = { .count = 0 };
    dpt_result result = DPT_OK;
    for (int k = 0; k < 3; k++)
        pose.position[k] += draw_in(-step, step);
    pose_codes(&pose, &codes);
    EACH_WORLD(scene, w)
    SAME_RESULT(w, result, RESULT(dpt_body_set_pose, scene->world[w], body->id, &pose));
    expect(result, &codes);
    body->is_usable = result == DPT_OK;
    if (body->is_usable)
        body->pose = pose;
    scene->is_as_stepped = 0;
}

/* What began inside feels nothing: mostly it is put elsewhere first. */
static void put_elsewhere(struct scene *scene, struct model_tool *tool)
{
    dpt_force_info report = { .size = sizeof report };
    HOLDS(RESULT(dpt_tool_get_force_info, scene->world[0], tool->id, &report) == DPT_OK, "no report");
    if (report.reason != DPT_FORCE_INSIDE || tool->is_free || draw_one_in(4))
        return;
    const dpt_pose pose = draw_pose(NULL);
    struct codes codes = { .count = 0 };
    dpt_result result = DPT_OK;
    pose_codes(&pose, &codes);
    EACH_WORLD(scene, w)
    SAME_RESULT(w, result, RESULT(dpt_tool_teleport, scene->world[w], tool->id, &pose));
    expect(result, &codes);
    tool_has_pose(scene, tool, result == DPT_OK ? &pose : NULL);
    tool->is_placed_anew = 1;
    if (tool->is_usable && tool->answers == ANSWERS_THERE)
        tool->answers = ANSWERS_EITHER;
    scene_steps(scene);
}

/* From where it is past the nearest surface, askew, and back. */
static void press(void)
{
    struct scene *scene = draw_scene();
    struct model_tool *tool = scene && scene->tool_count ? &scene->tool[draw_below(scene->tool_count)] : NULL;
    dpt_hit hit = DPT_HIT_INIT;
    if (!tool || !has_proxy(scene, tool->law) || !tool->is_usable)
        return;
    const uint32_t id = tool->id, ticks = 4 + draw_below(24);
    put_elsewhere(scene, tool);
    HOLDS(RESULT(dpt_tool_get_hit, scene->world[0], id, &hit) == DPT_OK, "no hit");
    twin_finds_hits(scene, id);
    const double speed = draw_one_in(4) ? 0.006 : 0.0015;
    double step[3];
    for (int k = 0; k < 3; k++) {
        const double toward = hit.distance > 0.0 ? (hit.q[k] - hit.p[k]) / hit.distance : 0.0;
        step[k] = speed * (toward + draw_in(-0.7, 0.7));
        if (hit.distance < 0.2)
            step[k] += toward * hit.distance / (0.4 * ticks);
    }
    const int bodies_move = draw_one_in(4);
    for (uint32_t i = 0; i < ticks; i++) {
        const double back[3] = { -step[0], -step[1], -step[2] };
        lead(scene, tool, i < 2 * ticks / 3 ? step : back);
        if (bodies_move && scene->body_count && draw_one_in(2))
            stir(scene);
        scene_steps(scene);
    }
}

/* It is given what a getter gives, and leaves it as it is. */
static void look_at(void *user, const dpt_force_info *report, double dt, dpt_wrench *wrench)
{
    HOLDS(user == &met[0] && dt > 0.0 && report->size == sizeof *report &&
              !memcmp(wrench, &report->wrench, sizeof *wrench),
          "reason %u, dt %g", report->reason, dt);
    met[MET_SHAPED]++;
}

static void set_shaper(void)
{
    struct scene *scene = draw_scene();
    if (!scene)
        return;
    const uint32_t id = draw_tool_id(scene);
    struct model_tool *tool = scene_tool(scene, id);
    const int no_world = draw_one_in(60), is_shaped = draw_one_in(2);
    struct codes codes = { .count = 0 };
    dpt_result result = DPT_OK;
    may_fail(&codes, no_world, DPT_E_ARGUMENT);
    may_fail(&codes, !tool, DPT_E_HANDLE);
    call_with("scene %llu, id %llx, set %llu", (uint64_t)(scene - scenes), id, (uint64_t)is_shaped, 0);
    EACH_WORLD(scene, i)
    SAME_RESULT(
        i, result,
        RESULT(dpt_tool_set_shaper, world_or_null(scene, i, no_world), id, is_shaped ? look_at : NULL, &met[0]));
    expect(result, &codes);
    if (result == DPT_OK)
        tool->is_shaped = is_shaped;
}

static const struct move moves[] = { { "get proxy", get_proxy, 4 },
                                     { "get end", get_end, 2 },
                                     { "press", press, 12 },
                                     { "set shaper", set_shaper, 3 },
                                     { NULL, NULL, 0 } };

const struct noun proxy_noun = { "proxy", NULL, NULL, moves };
