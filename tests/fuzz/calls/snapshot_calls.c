/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Snapshots, taken at any moment: they name the bodies and tools that are there, and tell of them what the getters tell.
 * The twin's is the same bytes. Damaged, they are read or refused.
 */
#include "fuzz/calls/rules.h"

enum { ROOM = OUTPUT_ROOM - 64 };

static unsigned char kept[OUTPUT_ROOM];
static size_t kept_bytes;

static void begin(void)
{
    kept_bytes = 0;
}

static void defaults(void)
{
    const uint32_t size = draw_size(sizeof(dpt_snapshot_def), sizeof(dpt_snapshot_def));
    const int no_def = draw_one_in(20);
    dpt_snapshot_def whole;
    dpt_snapshot_def_init(&whole);
    void *def = output_of_defaults(0, size);
    CALL(dpt_snapshot_def_defaults, no_def ? NULL : def, size);
    defaults_must_hold(0, size, no_def, &whole, sizeof whole);
}

static void bodies_must_hold(struct scene *scene, const dpt_snapshot_info *info)
{
    HOLDS(info->bodies == scene->body_count, "%u bodies, not %u", info->bodies, scene->body_count);
    for (uint32_t i = 0; i < info->bodies; i++) {
        dpt_snapshot_body body = { .size = sizeof body };
        HOLDS(RESULT(dpt_snapshot_get_body, kept, kept_bytes, i, &body) == DPT_OK, "body %u", i);
        const struct model_body *model = scene_body(scene, body.id);
        HOLDS(model && model->user == body.user, "body %x", body.id);
        HOLDS(((body.flags & DPT_SNAPSHOT_BODY_FLAG_STALE) == 0) == (model->is_usable != 0), "flags %x", body.flags);
        HOLDS(!(body.flags & DPT_SNAPSHOT_BODY_FLAG_HELD) || model->soft, "flags %x", body.flags);
        HOLDS((body.vertices > 0) == (model->soft != NULL), "%u vertices", body.vertices);
        if (model->is_usable && !model->soft)
            HOLDS(!memcmp(&body.pose, &model->pose, sizeof body.pose), "another pose");
        if (body.vertices == 0 || body.first_vertex == DPT_NONE)
            continue;
        static float xyz[3 * VERTICES_MOST];
        const float *own;
        uint32_t count;
        HOLDS(body.vertices <= VERTICES_MOST, "%u vertices", body.vertices);
        HOLDS(RESULT(dpt_snapshot_get_vertices, kept, kept_bytes, body.first_vertex, body.vertices, xyz) == DPT_OK,
              "vertices");
        HOLDS(dpt_body_get_vertices(scene->world[0], body.id, &own, &count) == DPT_OK && count == body.vertices &&
                  !memcmp(own, xyz, 12 * (size_t)count),
              "other vertices");
    }
}

static void segments_must_hold(const struct scene *scene, const dpt_snapshot_tool *tool, const dpt_snapshot_info *info,
                               uint32_t index)
{
    HOLDS(tool->segments > 0 && tool->first_segment + tool->segments <= info->segments, "%u segments", tool->segments);
    for (uint32_t i = 0; i < tool->segments; i++) {
        dpt_snapshot_segment segment = { .size = sizeof segment };
        dpt_hit hit = DPT_HIT_INIT;
        HOLDS(RESULT(dpt_snapshot_get_segment, kept, kept_bytes, tool->first_segment + i, &segment) == DPT_OK,
              "segment %u", i);
        dpt_tool_get_segment_hit(scene->world[0], tool->id, i, &hit);
        HOLDS(segment.tool == index && segment.status == hit.status && segment.contact == hit.contact &&
                  segment.flags == hit.flags && segment.triangle == hit.triangle && segment.body == hit.body &&
                  segment.work == hit.work && !memcmp(segment.p, hit.p, sizeof hit.p) &&
                  !memcmp(segment.q, hit.q, sizeof hit.q) && segment.distance == hit.distance && segment.gap == hit.gap,
              "segment %u of %x", i, tool->id);
        numbers_are_finite(segment.a, sizeof(double[24]) / sizeof(double), "a segment");
    }
}

static void tools_must_hold(struct scene *scene, const dpt_snapshot_info *info, uint32_t wanted)
{
    uint32_t contacts = 0;
    HOLDS(info->tools == scene->tool_count && info->segments == scene->segment_count, "%u tools, %u segments",
          info->tools, info->segments);
    for (uint32_t i = 0; i < info->tools; i++) {
        dpt_snapshot_tool tool = { .size = sizeof tool };
        dpt_force_info report = { .size = sizeof report };
        dpt_pose proxy;
        uint32_t count;
        HOLDS(RESULT(dpt_snapshot_get_tool, kept, kept_bytes, i, &tool) == DPT_OK, "tool %u", i);
        const struct model_tool *model = scene_tool(scene, tool.id);
        HOLDS(model && model->user == tool.user && model->count == tool.segments &&
                  (uint32_t)model->is_free == tool.is_free && model->law == tool.law,
              "tool %x", tool.id);
        dpt_tool_get_force_info(scene->world[0], tool.id, &report);
        HOLDS(report.reason == tool.reason && report.flags == tool.flags &&
                  !memcmp(&report.wrench, &tool.wrench, sizeof tool.wrench) && report.energy == tool.energy &&
                  report.folds == tool.folds,
              "force of %x", tool.id);
        dpt_tool_get_proxy(scene->world[0], tool.id, &proxy);
        HOLDS(!memcmp(&proxy, &tool.proxy, sizeof proxy), "proxy of %x", tool.id);
        dpt_tool_get_end(scene->world[0], tool.id, &proxy);
        HOLDS(!memcmp(&proxy, &tool.end, sizeof proxy), "end of %x", tool.id);
        segments_must_hold(scene, &tool, info, i);
        dpt_tool_get_contacts(scene->world[0], tool.id, NULL, 0, &count);
        HOLDS(tool.first_contact == contacts, "contacts of %x", tool.id);
        HOLDS(tool.contacts == count || wanted == 0 || info->flags & DPT_SNAPSHOT_FLAG_CONTACTS_CUT,
              "%u contacts, not %u", tool.contacts, count);
        contacts += tool.contacts;
    }
    HOLDS(contacts == info->contacts, "%u contacts", info->contacts);
}

static void items_must_hold(const dpt_snapshot_info *info)
{
    for (uint32_t i = 0; i < info->contacts; i++) {
        dpt_snapshot_contact contact = { .size = sizeof contact };
        HOLDS(RESULT(dpt_snapshot_get_contact, kept, kept_bytes, i, &contact) == DPT_OK, "contact %u", i);
        HOLDS(contact.s0 >= 0.0 && contact.s1 <= 1.0 && contact.s0 <= contact.s1, "%g to %g", contact.s0, contact.s1);
    }
    for (uint32_t i = 0; i < info->strip; i++) {
        dpt_snapshot_strip strip = { .size = sizeof strip };
        HOLDS(RESULT(dpt_snapshot_get_strip, kept, kept_bytes, i, &strip) == DPT_OK, "strip %u", i);
        HOLDS(isfinite(strip.gap) && isfinite(strip.overlap), "%g, %g", strip.gap, strip.overlap);
    }
}

static dpt_snapshot_def draw_def(void)
{
    const dpt_snapshot_def def = { .max_contacts = draw_one_in(30) ? (uint32_t)draw_bits() : draw_below(40),
                                   .max_strip = draw_one_in(30) ? (uint32_t)draw_bits() : draw_below(60),
                                   .max_vertices =
                                       draw_one_in(30) ? (uint32_t)draw_bits() : draw_below(2 * VERTICES_MOST) };
    return def;
}

static void take(void)
{
    struct scene *scene = draw_scene();
    if (!scene)
        return;
    const dpt_snapshot_def good = draw_def();
    const int no_world = draw_one_in(60), no_block = draw_one_in(60), no_bytes = draw_one_in(60);
    const int no_def = draw_one_in(8);
    struct codes codes = { .count = 0 };
    const void *def = NULL;
    if (!no_def) {
        def = draw_input(2, &good, draw_size(sizeof good, sizeof good), sizeof good, sizeof good, &codes);
        may_fail(&codes, good.max_contacts > 1u << 20 || good.max_strip > 1u << 20 || good.max_vertices > 1u << 28,
                 DPT_E_LIMIT);
    }
    const int is_bad = codes.count > 0 || no_world;
    size_t enough[2] = { 0, 0 }, written[2] = { 77, 77 };
    EACH_WORLD(scene, i)
    enough[i] = CALL(dpt_snapshot_bytes, world_or_null(scene, i, no_world), def);
    HOLDS((enough[0] == 0) == is_bad && enough[0] % 8 == 0 && (scene->world_count < 2 || enough[0] == enough[1]),
          "%zu and %zu bytes", enough[0], enough[1]);
    size_t capacity = enough[0] <= ROOM ? enough[0] : ROOM;
    const int is_short = draw_one_in(8);
    if (is_short)
        capacity = draw_below((uint32_t)capacity + 1);
    may_fail(&codes, no_world || no_block || no_bytes, DPT_E_ARGUMENT);
    const int may_be_full = !codes.count && (is_short || enough[0] > ROOM);
    dpt_result result = DPT_OK;
    EACH_WORLD(scene, i)
    {
        unsigned char *out = output_of(i, capacity);
        SAME_RESULT(i, result,
                    RESULT(dpt_world_take_snapshot, world_or_null(scene, i, no_world), def, no_block ? NULL : out,
                           capacity, no_bytes ? NULL : &written[i]));
    }
    if (may_be_full && result == DPT_E_MEMORY)
        HOLDS(output_is_untouched(0, 0) && written[0] == 0, "half of a snapshot");
    else
        expect(result, &codes);
    outputs_are_guarded(0, scene->world_count);
    if (result != DPT_OK)
        return;
    HOLDS(written[0] <= capacity && written[0] % 8 == 0 && written[0] > 0, "%zu bytes", written[0]);
    memcpy(kept, output_at(0), written[0]);
    kept_bytes = written[0];
    HOLDS(scene->world_count < 2 || (written[1] == kept_bytes && !memcmp(kept, output_at(1), kept_bytes)),
          "the twin's is another");
    game_digest(kept, kept_bytes);
    dpt_snapshot_info info = { .size = sizeof info };
    HOLDS(RESULT(dpt_snapshot_get_info, kept, kept_bytes, &info) == DPT_OK, "it does not hold");
    bodies_must_hold(scene, &info);
    tools_must_hold(scene, &info, no_def ? 256 : good.max_contacts);
    items_must_hold(&info);
}

/* One reader, of any item; what it fills, and its codes. */
static void read_one(size_t bytes, int is_sound)
{
    const uint32_t index = draw_below(12);
    const uint32_t kind = draw_below(7);
    const int no_out = draw_one_in(30);
    static const uint32_t today[] = { sizeof(dpt_snapshot_info),    sizeof(dpt_snapshot_body),
                                      sizeof(dpt_snapshot_tool),    sizeof(dpt_snapshot_segment),
                                      sizeof(dpt_snapshot_contact), sizeof(dpt_snapshot_strip),
                                      sizeof(dpt_snapshot_channel) };
    const uint32_t first = kind == 0   ? (uint32_t)offsetof(dpt_snapshot_info, channels)
                           : kind == 2 ? (uint32_t)offsetof(dpt_snapshot_tool, end)
                                       : today[kind];
    const uint32_t size = draw_size(first, today[kind]);
    struct codes codes = { .count = 0 };
    void *given = output_sized(0, size), *out = no_out ? NULL : given;
    if (!no_out)
        size_codes_of_output(size, first, 0, &codes);
    const int has_good_size = !codes.count && !no_out;
    dpt_result result;
    switch (kind) {
    case 0:
        result = RESULT(dpt_snapshot_get_info, kept, bytes, out);
        break;
    case 1:
        result = RESULT(dpt_snapshot_get_body, kept, bytes, index, out);
        break;
    case 2:
        result = RESULT(dpt_snapshot_get_tool, kept, bytes, index, out);
        break;
    case 3:
        result = RESULT(dpt_snapshot_get_segment, kept, bytes, index, out);
        break;
    case 4:
        result = RESULT(dpt_snapshot_get_contact, kept, bytes, index, out);
        break;
    case 5:
        result = RESULT(dpt_snapshot_get_strip, kept, bytes, index, out);
        break;
    default:
        result = RESULT(dpt_snapshot_get_channel, kept, bytes, index, out);
        break;
    }
    may_fail(&codes, no_out, DPT_E_ARGUMENT);
    outputs_are_guarded(0, 1);
    if (!has_good_size)
        expect(result, &codes);
    else if (is_sound)
        HOLDS(result == DPT_OK || (kind && result == DPT_E_ARGUMENT), "%s", dpt_result_name(result));
}

static void read(void)
{
    if (kept_bytes)
        read_one(kept_bytes, 1);
}

static void vertices(void)
{
    dpt_snapshot_info info = { .size = sizeof info };
    float xyz[24];
    if (!kept_bytes || dpt_snapshot_get_info(kept, kept_bytes, &info) != DPT_OK)
        return;
    const uint32_t first = draw_one_in(10) ? (uint32_t)draw_bits() : draw_below(info.vertices + 4);
    const uint32_t count = draw_below(9);
    const int no_xyz = draw_one_in(20);
    struct codes codes = { .count = 0 };
    may_fail(&codes, no_xyz || (uint64_t)first + count > info.vertices, DPT_E_ARGUMENT);
    expect(RESULT(dpt_snapshot_get_vertices, kept, kept_bytes, first, count, no_xyz ? NULL : xyz), &codes);
}

/* Cut, or with other bytes: it stays so until another is taken. */
static void damage(void)
{
    if (!kept_bytes)
        return;
    unsigned char *copy = output_of(1, kept_bytes);
    memcpy(copy, kept, kept_bytes);
    for (uint32_t i = draw_below(4); i > 0; i--)
        kept[draw_below(draw_one_in(2) ? 208 : (uint32_t)kept_bytes)] = (unsigned char)draw_bits();
    const size_t bytes = draw_one_in(3) ? draw_below((uint32_t)kept_bytes + 1) : kept_bytes;
    for (int i = 0; i < 4; i++)
        read_one(bytes, 0);
    memcpy(kept, copy, kept_bytes);
}

static const struct move moves[] = { { "defaults", defaults, 1 }, { "take", take, 8 },     { "read", read, 6 },
                                     { "vertices", vertices, 2 }, { "damage", damage, 2 }, { NULL, NULL, 0 } };

const struct noun snapshot_noun = { "snapshot", begin, NULL, moves };
