/* SPDX-License-Identifier: BSD-3-Clause */
/* Hulls and tips: made of good and of odd corners, asked for their parts, given to tools and taken away. */
#include "dynpoint/hull.h"
#include "dynpoint/tip.h"
#include "fuzz/calls/world_model.h"

enum { HULL_ROOM = 1024, HULLS = 3 };

/* A hull that lasts for the game; tips are made of these. */
static struct lasting {
    uint64_t block[HULL_ROOM];
    const dpt_hull *hull;
} lasting[HULLS];

static void begin(void)
{
    for (int i = 0; i < HULLS; i++) {
        double corners[3 * 16];
        const uint32_t count = 5 + draw_below(12);
        for (uint32_t k = 0; k < 3 * count; k++)
            corners[k] = draw_in(-0.01, 0.01);
        const dpt_hull_def def = { .size = sizeof def,
                                   .corner_count = count,
                                   .corners = corners,
                                   .radius = draw_one_in(2) ? 0.0 : draw_in(0.0, 0.002) };
        const dpt_result result =
            RESULT(dpt_hull_create, lasting[i].block, sizeof lasting[i].block, &def, &lasting[i].hull);
        HOLDS(result == DPT_OK, "%u corners anywhere in a cube: %d", count, result);
    }
}

/* What a hull tells holds together: each edge is in two faces, each corner in three at least, or the hull is flat. */
static void parts_must_hold(const dpt_hull *hull, const dpt_hull_info *info)
{
    uint32_t corners[DPT_HULL_CORNERS_MAX], count, sides = 0, ends[2];
    double at[3];
    HOLDS(info->corners >= 3 && info->corners <= DPT_HULL_CORNERS_MAX && info->corners + info->faces == info->edges + 2,
          "%u corners, %u edges, %u faces", info->corners, info->edges, info->faces);
    for (uint32_t f = 0; f < info->faces; f++) {
        HOLDS(RESULT(dpt_hull_get_face, hull, f, corners, DPT_HULL_CORNERS_MAX, &count) == DPT_OK && count >= 3 &&
                  count <= info->corners,
              "face %u has %u corners", f, count);
        for (uint32_t i = 0; i < count; i++)
            HOLDS(corners[i] < info->corners, "corner %u of face %u", corners[i], f);
        sides += count;
    }
    HOLDS(sides == 2 * info->edges, "%u sides of %u edges", sides, info->edges);
    for (uint32_t e = 0; e < info->edges; e++)
        HOLDS(RESULT(dpt_hull_get_edge, hull, e, ends) == DPT_OK && ends[0] < info->corners &&
                  ends[1] < info->corners && ends[0] != ends[1],
              "edge %u", e);
    for (uint32_t c = 0; c < info->corners; c++) {
        HOLDS(RESULT(dpt_hull_get_corner, hull, c, at) == DPT_OK, "corner %u", c);
        numbers_are_finite(at, 3, "corner");
    }
}

/* Of any corners. */
static void create(void)
{
    double corners[3 * (DPT_HULL_CORNERS_MAX + 2)];
    static uint64_t room[HULL_ROOM];
    const uint32_t count = draw_one_in(20) ? DPT_HULL_CORNERS_MAX + 1 : draw_below(20);
    const int is_flat = draw_one_in(8), is_odd = draw_one_in(8);
    for (uint32_t k = 0; k < 3 * count; k++)
        corners[k] = is_flat && k % 3 == 2 ? 0.0 : draw_in(-0.02, 0.02);
    if (is_odd && count)
        corners[draw_below(3 * count)] = draw_odd_number();
    if (draw_one_in(6) && count > 1)
        memcpy(corners + 3, corners, 3 * sizeof *corners);
    const dpt_hull_def good = { .corner_count = count,
                                .corners = draw_one_in(40) ? NULL : corners,
                                .reserved_pointer = draw_one_in(40) ? corners : NULL,
                                .radius = draw_one_in(10) ? draw_odd_number() : 0.001 };
    const int no_def = draw_one_in(40), no_block = draw_one_in(40), no_out = draw_one_in(40);
    const int is_short = draw_one_in(20), is_odd_block = draw_one_in(20);
    struct codes codes = { .count = 0 };
    const void *def =
        no_def ? NULL : draw_input(2, &good, draw_size(sizeof good, sizeof good), sizeof good, sizeof good, &codes);
    may_fail(&codes,
             no_def || no_block || no_out || count < 3 || count > DPT_HULL_CORNERS_MAX || !good.corners ||
                 good.reserved_pointer,
             DPT_E_ARGUMENT);
    may_fail(&codes, !(good.radius >= 0.0 && good.radius <= DPT_COORDINATE_MAX), DPT_E_FINITE);
    for (uint32_t k = 0; good.corners && k < 3 * count; k++)
        may_fail(&codes, !(fabs(corners[k]) <= DPT_COORDINATE_MAX), DPT_E_FINITE);
    may_fail(&codes, is_odd_block, DPT_E_ALIGN);
    may_fail(&codes, is_short, DPT_E_MEMORY);
    /* Corners that are equal, or nearly on a line or in a plane, make none. */
    const int may_be_none = codes.count == 0;
    if (may_be_none)
        may_fail(&codes, 1, DPT_E_ARGUMENT);
    codes.or_done = may_be_none;
    const size_t bytes = CALL(dpt_hull_bytes, def);
    HOLDS(!bytes == !may_be_none || is_short || is_odd_block || no_block || no_out, "%zu bytes", bytes);
    const dpt_hull *hull = (const dpt_hull *)(uintptr_t)8;
    const dpt_result result = RESULT(dpt_hull_create, no_block ? NULL : (char *)room + (is_odd_block ? 4 : 0),
                                     is_short ? bytes / 2 : sizeof room - 8, def, no_out ? NULL : &hull);
    expect(result, &codes);
    if (result != DPT_OK) {
        HOLDS(no_out || !hull, "a hull on an error");
        return;
    }
    dpt_hull_info info = { .size = sizeof info };
    HOLDS(RESULT(dpt_hull_get_info, hull, &info) == DPT_OK && info.radius == good.radius && info.corners <= count,
          "%u corners of %u", info.corners, count);
    parts_must_hold(hull, &info);
    game_digest(&info, sizeof info);
}

/* The getters, and numbers that are none. */
static void ask(void)
{
    const dpt_hull *hull = draw_one_in(20) ? NULL : lasting[draw_below(HULLS)].hull;
    const uint32_t number = draw_below(80), size = draw_size(sizeof(dpt_hull_info), sizeof(dpt_hull_info));
    uint32_t two[2], many[DPT_HULL_CORNERS_MAX], count;
    double at[3];
    dpt_hull_info info = { .size = sizeof info };
    if (hull)
        HOLDS(RESULT(dpt_hull_get_info, hull, &info) == DPT_OK, "no info");
    struct codes codes = { .count = 0 };
    const int no_out = draw_one_in(20);
    may_fail(&codes, !hull || no_out, DPT_E_ARGUMENT);
    if (!no_out)
        size_codes_of_output(size, sizeof info, 0, &codes);
    expect(RESULT(dpt_hull_get_info, hull, no_out ? NULL : output_sized(0, size)), &codes);
    outputs_are_guarded(0, 1);
    const int has_corner = hull && number < info.corners, has_edge = hull && number < info.edges;
    const int has_face = hull && number < info.faces;
    HOLDS((RESULT(dpt_hull_get_corner, hull, number, no_out ? NULL : at) == DPT_OK) == (has_corner && !no_out),
          "corner %u of %u", number, info.corners);
    HOLDS((RESULT(dpt_hull_get_edge, hull, number, no_out ? NULL : two) == DPT_OK) == (has_edge && !no_out),
          "edge %u of %u", number, info.edges);
    const uint32_t capacity = draw_below(6);
    HOLDS((RESULT(dpt_hull_get_face, hull, number, many, capacity, no_out ? NULL : &count) == DPT_OK) ==
              (has_face && !no_out),
          "face %u of %u", number, info.faces);
}

static void shapes(void)
{
    double corners[3 * DPT_HULL_CORNERS_MAX];
    const dpt_hull_shape good = { .kind = draw_below(draw_one_in(10) ? 6 : 4),
                                  .sides = draw_one_in(2) ? 0 : draw_below(70),
                                  .reserved = draw_one_in(40) ? 1u : 0u,
                                  .extent = { draw_in(0.001, 0.03), draw_one_in(12) ? draw_odd_number() : 0.01,
                                              draw_in(0.001, 0.03) } };
    const int is_round = good.kind == DPT_HULL_KIND_CYLINDER || good.kind == DPT_HULL_KIND_CONE;
    const uint32_t most = good.kind == DPT_HULL_KIND_CYLINDER ? 32 : 63;
    const uint32_t sides = is_round && !good.sides ? 16 : good.sides;
    const uint32_t capacity = draw_one_in(4) ? draw_below(20) : DPT_HULL_CORNERS_MAX;
    const uint32_t wanted = good.kind == DPT_HULL_KIND_BOX     ? 8
                            : good.kind == DPT_HULL_KIND_WEDGE ? 6
                            : good.kind == DPT_HULL_KIND_CONE  ? sides + 1
                                                               : 2 * sides;
    const int no_shape = draw_one_in(40), no_count = draw_one_in(40);
    struct codes codes = { .count = 0 };
    uint32_t count = 77;
    const void *given =
        no_shape ? NULL : draw_input(2, &good, draw_size(sizeof good, sizeof good), sizeof good, sizeof good, &codes);
    may_fail(&codes,
             no_shape || no_count || good.kind > DPT_HULL_KIND_CONE || good.reserved ||
                 (is_round ? sides < 3 || sides > most : good.sides != 0),
             DPT_E_ARGUMENT);
    may_fail(&codes, !(good.extent[1] >= 0.0 && good.extent[1] <= DPT_COORDINATE_MAX), DPT_E_FINITE);
    may_fail(&codes, codes.count == 0 && wanted > capacity, DPT_E_FULL);
    const dpt_result result = RESULT(dpt_hull_shape_corners, given, corners, capacity, no_count ? NULL : &count);
    expect(result, &codes);
    HOLDS(result != DPT_OK || count == wanted, "%u corners, not %u", count, wanted);
    if (result == DPT_OK)
        numbers_are_finite(corners, 3 * (size_t)count, "corners");
}

static void query(void)
{
    const struct subject *subject = draw_subject();
    const dpt_pose pose = draw_pose(NULL), hull_pose = draw_pose(NULL);
    const int no_mesh = draw_one_in(60), no_hull = draw_one_in(60), no_out = draw_one_in(60);
    const int no_pose = draw_one_in(3), no_hull_pose = draw_one_in(3);
    const uint32_t size = draw_size(sizeof(dpt_hit), sizeof(dpt_hit));
    struct codes codes = { .count = 0 };
    may_fail(&codes, no_mesh || no_hull || no_out, DPT_E_ARGUMENT);
    if (!no_out)
        size_codes_of_output(size, sizeof(dpt_hit), 0, &codes);
    if (!no_pose)
        pose_codes(&pose, &codes);
    if (!no_hull_pose)
        pose_codes(&hull_pose, &codes);
    void *out = no_out ? NULL : output_sized(0, size);
    const dpt_result result =
        RESULT(dpt_query_hull, no_mesh ? NULL : subject->mesh, no_pose ? NULL : &pose,
               no_hull ? NULL : lasting[draw_below(HULLS)].hull, no_hull_pose ? NULL : &hull_pose, out);
    expect(result, &codes);
    outputs_are_guarded(0, 1);
    dpt_hit hit;
    if (result != DPT_OK || !output_read(0, size, sizeof hit, 32, &hit))
        return;
    HOLDS(hit.status == DPT_STATUS_EXACT && hit.lower_bound <= hit.distance && hit.triangle < subject->source_triangles,
          "status %u, triangle %u", hit.status, hit.triangle);
    game_digest(&hit, sizeof hit);
}

static void near(void)
{
    const struct subject *subject = draw_subject();
    const dpt_pose pose = draw_pose(NULL);
    const dpt_segment segment = draw_segment();
    double ends[6];
    memcpy(ends, segment.a, sizeof segment.a);
    memcpy(ends + 3, segment.b, sizeof segment.b);
    const double reach = draw_one_in(12) ? draw_odd_number() : draw_in(0.0, 0.2);
    uint32_t triangles[TRIANGLES_MOST], count = 0;
    const int no_mesh = draw_one_in(60), no_ends = draw_one_in(60), no_out = draw_one_in(60);
    struct codes codes = { .count = 0 };
    dpt_segment asked = segment;
    asked.radius = 0.0;
    may_fail(&codes, no_mesh || no_ends || no_out, DPT_E_ARGUMENT);
    if (!no_ends)
        segment_codes(&asked, &codes);
    may_fail(&codes, !(reach >= 0.0 && reach <= DPT_COORDINATE_MAX), DPT_E_FINITE);
    pose_codes(&pose, &codes);
    const dpt_result result = RESULT(dpt_query_triangles, no_mesh ? NULL : subject->mesh, &pose, no_ends ? NULL : ends,
                                     reach, triangles, TRIANGLES_MOST, no_out ? NULL : &count);
    expect(result, &codes);
    HOLDS(result != DPT_OK || count <= subject->triangles, "%u triangles of %u", count, subject->triangles);
    for (uint32_t i = 0; result == DPT_OK && i < count; i++)
        HOLDS(triangles[i] < subject->source_triangles, "triangle %u", triangles[i]);
}

/* A tip is sent elsewhere in its tool. Without a proxy it is there at once, else after a step. */
static void move_tip(struct scene *scene, uint32_t id, const struct model_tool *tool, uint32_t count,
                     const dpt_pose *given)
{
    const uint32_t tip = draw_below(count + 1);
    const int no_world = draw_one_in(60), no_pose = draw_one_in(60), no_tool = draw_one_in(60);
    const dpt_pose pose = draw_pose(NULL);
    const uint32_t of = no_tool ? 0 : id;
    struct codes codes = { .count = 0 };
    dpt_result result = DPT_OK;
    may_fail(&codes, no_world || no_pose || tip >= count, DPT_E_ARGUMENT);
    may_fail(&codes, no_tool, DPT_E_HANDLE);
    if (!no_pose)
        pose_codes(&pose, &codes);
    call_with("scene %llu, id %llx, tip %llu", (uint64_t)(scene - scenes), of, tip, 0);
    EACH_WORLD(scene, i)
    SAME_RESULT(i, result,
                RESULT(dpt_tool_set_tip_pose, world_or_null(scene, i, no_world), of, tip, no_pose ? NULL : &pose));
    expect(result, &codes);
    EACH_WORLD(scene, i)
    {
        dpt_pose now;
        const dpt_result found = RESULT(dpt_tool_get_tip_pose, scene->world[i], id, tip, &now);
        HOLDS(found == (tip < count ? DPT_OK : DPT_E_ARGUMENT), "%s", dpt_result_name(found));
        const dpt_pose *wanted = result == DPT_OK && !has_proxy(scene, tool->law) ? &pose : given;
        HOLDS(found != DPT_OK || !memcmp(&now, wanted, sizeof now), "tip %u is elsewhere", tip);
    }
}

/* Tips come and go again: the tool is as if it had been placed anew. */
static void give_tips(void)
{
    struct scene *scene = draw_scene();
    if (!scene)
        return;
    const uint32_t id = draw_tool_id(scene), count = draw_below(6);
    struct model_tool *tool = scene_tool(scene, id);
    const int no_world = draw_one_in(60), no_tips = draw_one_in(60), no_hull = draw_one_in(30);
    const int is_reserved = draw_one_in(60), has_pose = draw_one_in(2);
    const dpt_pose identity = DPT_POSE_IDENTITY, drawn = draw_pose(NULL);
    const dpt_pose pose = has_pose ? drawn : identity;
    struct codes codes = { .count = 0 };
    dpt_tip tips[6];
    dpt_result result = DPT_OK;
    for (uint32_t i = 0; i < count; i++)
        tips[i] = (dpt_tip){ .size = sizeof *tips,
                             .reserved = (uint32_t)is_reserved,
                             .hull = no_hull ? NULL : lasting[draw_below(HULLS)].hull,
                             .pose = has_pose ? &pose : NULL };
    may_fail(&codes, no_world || (count && (no_tips || no_hull || is_reserved)), DPT_E_ARGUMENT);
    may_fail(&codes, !tool, DPT_E_HANDLE);
    if (count && !no_tips)
        pose_codes(&pose, &codes);
    may_fail(&codes, count > scene->def.max_tips, DPT_E_FULL);
    may_fail(&codes,
             count && tool &&
                 (tool->is_free || (scene->def.until == DPT_UNTIL_RESPOND && !has_proxy(scene, tool->law))),
             DPT_E_UNSUPPORTED);
    call_with("scene %llu, id %llx, %llu tips", (uint64_t)(scene - scenes), id, count, 0);
    EACH_WORLD(scene, i)
    SAME_RESULT(i, result,
                RESULT(dpt_tool_set_tips, world_or_null(scene, i, no_world), id, no_tips ? NULL : tips, count));
    expect(result, &codes);
    if (result != DPT_OK)
        return;
    move_tip(scene, id, tool, count, &pose);
    EACH_WORLD(scene, i)
    HOLDS(RESULT(dpt_tool_set_tips, scene->world[i], id, NULL, 0) == DPT_OK, "tips stay");
    scene->is_as_stepped = 0;
    tool->is_placed_anew = 1;
    if (tool->answers == ANSWERS_THERE)
        tool->answers = ANSWERS_EITHER;
}

static const struct move moves[] = { { "create", create, 6 }, { "ask", ask, 6 },   { "shapes", shapes, 4 },
                                     { "query", query, 6 },   { "near", near, 4 }, { "give tips", give_tips, 6 },
                                     { NULL, NULL, 0 } };

const struct noun hull_noun = { "hull", begin, NULL, moves };
