/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Snapshots. Each field stands in the block where docs/format.md says, with the value that the world's own getters give;
 * the library's readers find the same; what does not fit is left out and told; taking one changes nothing.
 *
 *     test_snapshot [PER CENT]   of the ticks
 */
#include <math.h>

#include "world/snapshot_scene.h"

enum { LIST = 4096 };

static int are(size_t at, const double *values, int count)
{
    int same = 1;
    for (int k = 0; k < count; k++)
        same &= number(at + 8 * (size_t)k) == values[k];
    return same;
}

static int is_near(size_t at, const double expected[3])
{
    double worst = 0.0;
    for (int k = 0; k < 3; k++)
        worst = fmax(worst, fabs(number(at + 8 * (size_t)k) - expected[k]));
    return worst <= 1e-12;
}

/* ---- what is in it ---- */

static void compare_bodies(const struct scene *scene)
{
    uint32_t count, vertices;
    item(BODIES, 0, &count);
    CHECK(count == 2, "%u bodies", (unsigned)count);
    for (uint32_t i = 0; i < count; i++) {
        const size_t at = item(BODIES, i, &count);
        dpt_pose pose;
        uint64_t user;
        dpt_body_get_pose(scene->rig.world, word(at), &pose);
        dpt_body_get_user(scene->rig.world, word(at), &user);
        CHECK(word(at) == scene->body[i] && wide(at + 16) == user && are(at + 24, pose.position, 3) &&
                  are(at + 48, pose.orientation, 4),
              "body %u", (unsigned)i);
        CHECK(word(at + 4) == i, "body %u: flags %u", (unsigned)i, (unsigned)word(at + 4));
    }
    const float *own;
    const size_t at = item(VERTICES, 0, &vertices), body = item(BODIES, 1, &count);
    dpt_body_get_vertices(scene->rig.world, scene->body[1], &own, &count);
    CHECK(word(body + 8) == 0 && word(body + 12) == count && vertices == count, "%u vertices", (unsigned)vertices);
    for (uint32_t i = 0; i < 3 * count; i++) {
        const uint32_t bits = word(at + 4 * (size_t)i);
        if (memcmp(&bits, own + i, sizeof bits) != 0) {
            CHECK(0, "vertex %u", (unsigned)(i / 3));
            break;
        }
    }
}

static void compare_segment(const struct scene *scene, uint32_t t, uint32_t s, size_t at)
{
    dpt_hit hit = DPT_HIT_INIT;
    dpt_pose pose, proxy;
    double end[3];
    const dpt_segment *segment = &segments_of[t][s];
    dpt_tool_get_segment_hit(scene->rig.world, scene->tool[t], s, &hit);
    CHECK(word(at) == hit.status && word(at + 4) == hit.contact && word(at + 8) == hit.flags &&
              word(at + 12) == hit.triangle && word(at + 16) == hit.body && word(at + 20) == hit.work &&
              word(at + 24) == t && word(at + 28) == 0,
          "words of segment %u of tool %u", (unsigned)s, (unsigned)t);
    CHECK(are(at + 136, hit.p, 3) && are(at + 160, hit.q, 3) && number(at + 184) == hit.distance &&
              number(at + 192) == hit.gap && number(at + 200) == hit.depth && number(at + 208) == hit.error_bound &&
              number(at + 216) == hit.lower_bound && number(at + 80) == segment->radius,
          "numbers of segment %u of tool %u", (unsigned)s, (unsigned)t);
    dpt_tool_get_proxy(scene->rig.world, scene->tool[t], &proxy);
    if (t == 1) { /* free: its frame begins at a, and x points to b */
        const double length =
            sqrt(pow(number(at + 56) - number(at + 32), 2) + pow(number(at + 64) - number(at + 40), 2) +
                 pow(number(at + 72) - number(at + 48), 2));
        const double b[3] = { length, 0.0, 0.0 };
        CHECK(is_near(at + 32, scene->pose[1].position), "a of the free tool");
        CHECK(is_near(at + 88, proxy.position), "a of its proxy");
        pose_point(&proxy, b, end);
        double apart = 0.0;
        for (int k = 0; k < 3; k++)
            apart = fmax(apart, fabs(end[k] - number(at + 112 + 8 * (size_t)k)));
        CHECK(apart <= 2e-3, "b of its proxy: %g m, which grows slowly to the device's length", apart);
        return;
    }
    dpt_tool_get_pose(scene->rig.world, scene->tool[t], &pose);
    pose_point(&pose, segment->a, end);
    CHECK(is_near(at + 32, end), "a of tool %u", (unsigned)t);
    pose_point(&pose, segment->b, end);
    CHECK(is_near(at + 56, end), "b of tool %u", (unsigned)t);
    pose_point(&proxy, segment->a, end);
    CHECK(is_near(at + 88, end), "a of the proxy of tool %u", (unsigned)t);
    pose_point(&proxy, segment->b, end);
    CHECK(is_near(at + 112, end), "b of the proxy of tool %u", (unsigned)t);
}

static void compare_contacts(const struct scene *scene, uint32_t t, size_t tool, uint32_t *seen)
{
    static dpt_contact contacts[LIST];
    uint32_t count, all;
    contacts[0].size = sizeof *contacts;
    dpt_tool_get_contacts(scene->rig.world, scene->tool[t], contacts, LIST, &count);
    CHECK(word(tool + 28) == count && word(tool + 24) == *seen, "%u contacts, not %u", (unsigned)word(tool + 28),
          (unsigned)count);
    for (uint32_t i = 0; i < count; i++) {
        const size_t at = item(CONTACTS, (*seen)++, &all);
        const dpt_contact *c = &contacts[i];
        CHECK(word(at) == c->id && word(at + 4) == c->body && word(at + 8) == c->segment &&
                  word(at + 12) == c->triangle && word(at + 16) == c->contact && word(at + 20) == c->flags &&
                  word(at + 24) == t && word(at + 28) == 0,
              "words of contact %u", (unsigned)i);
        CHECK(number(at + 32) == c->s0 && number(at + 40) == c->s1 && number(at + 48) == c->s &&
                  number(at + 56) == c->gap && are(at + 64, c->p, 3) && are(at + 88, c->q, 3) &&
                  are(at + 112, c->normal, 3) && number(at + 136) == c->overlap,
              "numbers of contact %u", (unsigned)i);
    }
}

static void compare_strips(const struct scene *scene, uint32_t t, size_t tool, uint32_t *seen)
{
    static dpt_overlap overlaps[LIST];
    uint32_t all, sum = 0;
    CHECK(word(tool + 32) == *seen, "strips of tool %u", (unsigned)t);
    for (uint32_t s = 0; s < segment_counts[t]; s++) {
        uint32_t count;
        overlaps[0].size = sizeof *overlaps;
        dpt_tool_get_strip(scene->rig.world, scene->tool[t], s, overlaps, LIST, &count, NULL);
        sum += count;
        for (uint32_t i = 0; i < count; i++) {
            const size_t at = item(STRIPS, (*seen)++, &all);
            const dpt_overlap *o = &overlaps[i];
            CHECK(word(at) == o->triangle && word(at + 8) == s && word(at + 12) == o->flags &&
                      number(at + 16) == o->gap && number(at + 24) == o->overlap &&
                      (word(at + 4) == scene->body[0] || word(at + 4) == scene->body[1]),
                  "triangle %u of the strip", (unsigned)i);
        }
    }
    CHECK(word(tool + 36) == sum, "%u triangles, not %u", (unsigned)word(tool + 36), (unsigned)sum);
}

static uint64_t contacts_seen, strips_seen, forces_seen, held_seen;

static void compare_tools(const struct scene *scene)
{
    uint32_t count, segments = 0, contacts = 0, strips = 0;
    item(TOOLS, 0, &count);
    CHECK(count == TOOL_COUNT, "%u tools", (unsigned)count);
    for (uint32_t t = 0; t < count; t++) {
        const size_t at = item(TOOLS, t, &count);
        dpt_force_info report = { .size = sizeof report };
        dpt_tool_settings settings = { .size = sizeof settings };
        dpt_hit hit = DPT_HIT_INIT;
        dpt_pose pose, proxy;
        dpt_tool_get_force_info(scene->rig.world, scene->tool[t], &report);
        dpt_tool_get_settings(scene->rig.world, scene->tool[t], &settings);
        dpt_tool_get_pose(scene->rig.world, scene->tool[t], &pose);
        dpt_tool_get_proxy(scene->rig.world, scene->tool[t], &proxy);
        dpt_tool_get_hit(scene->rig.world, scene->tool[t], &hit);
        CHECK(word(at) == scene->tool[t] && word(at + 4) == settings.law && word(at + 8) == report.reason &&
                  word(at + 12) == report.flags && word(at + 16) == segments && word(at + 20) == segment_counts[t] &&
                  word(at + 40) == hit.segment && word(at + 44) == (t == 1) && wide(at + 48) == 100 + t &&
                  wide(at + 56) == report.folds,
              "words of tool %u", (unsigned)t);
        CHECK(are(at + 64, pose.position, 3) && are(at + 88, pose.orientation, 4) && are(at + 120, proxy.position, 3) &&
                  are(at + 144, proxy.orientation, 4),
              "poses of tool %u", (unsigned)t);
        CHECK(are(at + 176, report.wrench.force, 3) && are(at + 200, report.wrench.torque, 3) &&
                  number(at + 224) == report.energy && number(at + 232) == report.lag &&
                  number(at + 240) == report.body_work,
              "force of tool %u", (unsigned)t);
        for (uint32_t s = 0; s < segment_counts[t]; s++)
            compare_segment(scene, t, s, item(SEGMENTS, segments++, &count));
        compare_contacts(scene, t, at, &contacts);
        compare_strips(scene, t, at, &strips);
        forces_seen += report.reason == DPT_FORCE_ACTS;
        held_seen += memcmp(&pose, &proxy, sizeof pose) != 0;
        item(TOOLS, t, &count);
    }
    item(SEGMENTS, 0, &count);
    CHECK(count == segments, "segments");
    item(CONTACTS, 0, &count);
    CHECK(count == contacts, "contacts");
    item(STRIPS, 0, &count);
    CHECK(count == strips, "strips");
    contacts_seen += contacts;
    strips_seen += strips;
}

static void it_tells_what_the_getters_tell(void)
{
    struct scene scene;
    const dpt_snapshot_def def = all_of_it();
    const uint64_t ticks = part_of(4000);
    double time = 0.0;
    scene_open(&scene);
    for (uint64_t tick = 0; tick < ticks; tick++) {
        step(&scene, tick);
        time += 0.001;
        if (tick % 3)
            continue;
        take(&scene, &def);
        CHECK(memcmp(block,
                     "\x89"
                     "DPS\r\n\x1a\n",
                     8) == 0 &&
                  word(8) == 1 && word(12) == 64 && wide(16) == bytes && word(44) == 6 && word(52) == 0 &&
                  wide(56) == 0,
              "header");
        CHECK(wide(24) == tick + 1 && number(32) == time && word(40) == 0, "step %llu, %g s",
              (unsigned long long)wide(24), number(32));
        compare_bodies(&scene);
        compare_tools(&scene);
    }
    CHECK(contacts_seen >= least_seen(2000) && strips_seen >= least_seen(20000) && forces_seen >= least_seen(1000) &&
              held_seen >= least_seen(1000),
          "%llu contacts, %llu triangles, %llu forces, %llu held", (unsigned long long)contacts_seen,
          (unsigned long long)strips_seen, (unsigned long long)forces_seen, (unsigned long long)held_seen);
    scene_close(&scene);
}

/* ---- the library's readers ---- */

#define SAME_WORDS(from, type, first, at, count)                                                                       \
    CHECK(!memcmp((const char *)(from) + offsetof(type, first), block + (at), 4 * (count)), #type)
#define SAME_NUMBERS(from, type, first, at, count)                                                                     \
    CHECK(!memcmp((const char *)(from) + offsetof(type, first), block + (at), 8 * (count)), #type)

/* Field by field in the order of the page; this machine is little-endian, or the words are compared elsewhere. */
static void readers_agree(const dpt_snapshot_info *info)
{
    uint32_t count;
    for (uint32_t i = 0; i < info->bodies; i++) {
        dpt_snapshot_body body = { .size = sizeof body };
        CHECK(dpt_snapshot_get_body(block, bytes, i, &body) == DPT_OK, "body");
        SAME_WORDS(&body, dpt_snapshot_body, id, item(BODIES, i, &count), 4);
        SAME_NUMBERS(&body, dpt_snapshot_body, user, item(BODIES, i, &count) + 16, 8);
    }
    for (uint32_t i = 0; i < info->tools; i++) {
        dpt_snapshot_tool tool = { .size = sizeof tool };
        CHECK(dpt_snapshot_get_tool(block, bytes, i, &tool) == DPT_OK, "tool");
        SAME_WORDS(&tool, dpt_snapshot_tool, id, item(TOOLS, i, &count), 12);
        SAME_NUMBERS(&tool, dpt_snapshot_tool, user, item(TOOLS, i, &count) + 48, 32);
    }
    for (uint32_t i = 0; i < info->segments; i++) {
        dpt_snapshot_segment segment = { .size = sizeof segment };
        CHECK(dpt_snapshot_get_segment(block, bytes, i, &segment) == DPT_OK, "segment");
        SAME_WORDS(&segment, dpt_snapshot_segment, status, item(SEGMENTS, i, &count), 8);
        SAME_NUMBERS(&segment, dpt_snapshot_segment, a, item(SEGMENTS, i, &count) + 32, 24);
    }
    for (uint32_t i = 0; i < info->contacts; i++) {
        dpt_snapshot_contact contact = { .size = sizeof contact };
        CHECK(dpt_snapshot_get_contact(block, bytes, i, &contact) == DPT_OK, "contact");
        SAME_WORDS(&contact, dpt_snapshot_contact, id, item(CONTACTS, i, &count), 8);
        SAME_NUMBERS(&contact, dpt_snapshot_contact, s0, item(CONTACTS, i, &count) + 32, 14);
    }
    for (uint32_t i = 0; i < info->strip; i++) {
        dpt_snapshot_strip strip = { .size = sizeof strip };
        CHECK(dpt_snapshot_get_strip(block, bytes, i, &strip) == DPT_OK, "strip");
        SAME_WORDS(&strip, dpt_snapshot_strip, triangle, item(STRIPS, i, &count), 4);
        SAME_NUMBERS(&strip, dpt_snapshot_strip, gap, item(STRIPS, i, &count) + 16, 2);
    }
    float *xyz = malloc(3 * sizeof *xyz * (info->vertices + 1));
    CHECK(dpt_snapshot_get_vertices(block, bytes, 0, info->vertices, xyz) == DPT_OK, "vertices");
    CHECK(!memcmp(xyz, block + item(VERTICES, 0, &count), 12 * (size_t)info->vertices), "vertices");
    CHECK(dpt_snapshot_get_vertices(block, bytes, 1, info->vertices, xyz) == DPT_E_ARGUMENT, "too many vertices");
    free(xyz);
}

static void readers_find_what_is_there(void)
{
    struct scene scene;
    const dpt_snapshot_def def = all_of_it();
    dpt_snapshot_info info = { .size = sizeof info };
    dpt_snapshot_tool tool = { .size = sizeof tool };
    scene_in_contact(&scene);
    take(&scene, &def);
    CHECK(dpt_snapshot_get_info(block, bytes, &info) == DPT_OK, "no info");
    CHECK(info.version == 1 && info.flags == 0 && info.steps == 900 && info.work == word(48) &&
              info.time == number(32) && info.bodies == 2 && info.tools == TOOL_COUNT &&
              info.segments == SEGMENT_COUNT && info.contacts > 0 && info.strip > 0 && info.vertices > 0,
          "info");
    readers_agree(&info);
    CHECK(dpt_snapshot_get_tool(block, bytes, TOOL_COUNT, &tool) == DPT_E_ARGUMENT && tool.id == 0,
          "a tool that is not there");
    CHECK(dpt_snapshot_get_tool(NULL, bytes, 0, &tool) == DPT_E_ARGUMENT &&
              dpt_snapshot_get_tool(block, bytes, 0, NULL) == DPT_E_ARGUMENT &&
              dpt_snapshot_get_info(block, bytes, NULL) == DPT_E_ARGUMENT &&
              dpt_snapshot_get_vertices(block, bytes, 0, 1, NULL) == DPT_E_ARGUMENT,
          "NULL");
    scene_close(&scene);
}

/* ---- room ---- */

static void what_does_not_fit_is_told(void)
{
    struct scene scene;
    dpt_snapshot_info info = { .size = sizeof info }, whole = { .size = sizeof whole };
    dpt_snapshot_def def = all_of_it();
    scene_in_contact(&scene);
    take(&scene, &def);
    CHECK(dpt_snapshot_get_info(block, bytes, &whole) == DPT_OK, "no info");
    CHECK(whole.contacts > 1 && whole.strip > 20, "%u contacts, %u triangles", (unsigned)whole.contacts,
          (unsigned)whole.strip);
    def.max_contacts = whole.contacts - 1;
    def.max_strip = 20;
    def.max_vertices = whole.vertices - 1;
    take(&scene, &def);
    CHECK(dpt_snapshot_get_info(block, bytes, &info) == DPT_OK, "no info");
    CHECK(info.flags ==
              (DPT_SNAPSHOT_FLAG_CONTACTS_CUT | DPT_SNAPSHOT_FLAG_STRIPS_CUT | DPT_SNAPSHOT_FLAG_VERTICES_CUT),
          "flags %u", (unsigned)info.flags);
    CHECK(info.contacts == whole.contacts - 1 && info.strip == 20 && info.vertices == 0, "%u %u %u",
          (unsigned)info.contacts, (unsigned)info.strip, (unsigned)info.vertices);
    dpt_snapshot_body body = { .size = sizeof body };
    dpt_snapshot_get_body(block, bytes, 1, &body);
    CHECK(body.first_vertex == DPT_NONE && body.vertices == whole.vertices, "vertices left out");
    const dpt_snapshot_def none = { .size = sizeof none };
    take(&scene, &none);
    dpt_snapshot_get_info(block, bytes, &info);
    CHECK(!info.contacts && !info.strip && !info.vertices && info.segments == SEGMENT_COUNT && info.flags == 0,
          "none: flags %u", (unsigned)info.flags);
    memset(block, 0xcc, sizeof block);
    size_t written = 7;
    CHECK(dpt_world_take_snapshot(scene.rig.world, &none, block, bytes - 1, &written) == DPT_E_MEMORY &&
              block[0] == 0xcc && written == 0,
          "too small a block");
    def.max_contacts = (1 << 20) + 1;
    CHECK(dpt_world_take_snapshot(scene.rig.world, &def, block, ROOM, &written) == DPT_E_LIMIT &&
              dpt_snapshot_bytes(scene.rig.world, &def) == 0,
          "too many contacts");
    CHECK(dpt_world_take_snapshot(NULL, NULL, block, ROOM, &written) == DPT_E_ARGUMENT &&
              dpt_world_take_snapshot(scene.rig.world, NULL, NULL, ROOM, &written) == DPT_E_ARGUMENT &&
              dpt_world_take_snapshot(scene.rig.world, NULL, block, ROOM, NULL) == DPT_E_ARGUMENT &&
              dpt_snapshot_bytes(NULL, NULL) == 0,
          "NULL");
    scene_close(&scene);
}

/* Taking one neither changes the world nor depends on what was in the block. */
static void a_world_does_not_notice(void)
{
    struct scene with, without;
    const dpt_snapshot_def def = all_of_it();
    scene_open(&with);
    scene_open(&without);
    for (uint64_t tick = 0; tick < 600; tick++) {
        const uint64_t before = seed;
        step(&with, tick);
        take(&with, &def);
        seed = before;
        step(&without, tick);
        for (uint32_t t = 0; t < TOOL_COUNT; t++) {
            dpt_wrench a, b;
            dpt_tool_get_wrench(with.rig.world, with.tool[t], &a);
            dpt_tool_get_wrench(without.rig.world, without.tool[t], &b);
            CHECK(!memcmp(&a, &b, sizeof a), "tick %llu, tool %u", (unsigned long long)tick, (unsigned)t);
        }
    }
    static unsigned char again[ROOM];
    size_t size;
    memset(again, 0x33, sizeof again);
    dpt_world_take_snapshot(with.rig.world, &def, again, ROOM, &size);
    CHECK(size == bytes && !memcmp(again, block, size), "other bytes");
    scene_close(&with);
    scene_close(&without);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(it_tells_what_the_getters_tell);
    TEST(readers_find_what_is_there);
    TEST(what_does_not_fit_is_told);
    TEST(a_world_does_not_notice);
    return check_report();
}
