/* SPDX-License-Identifier: BSD-3-Clause */
/* Strips without a world: routes with and without a table, shadows, overlaps. */
#include "fuzz/calls/rules.h"

enum { STRIPS = 2, BLOCK = 1 << 16, TABLE_BLOCK = 1 << 18, OVERLAPS_MAX = 12 };

struct strip {
    dpt_strip *open;
    dpt_strip_def def;
    const struct subject *of; /* what its triangles are of; NULL: unknown, or none */
    uint32_t count;
};

static struct strip strips[STRIPS];
static uint64_t blocks[STRIPS][BLOCK / 8], table_block[TABLE_BLOCK / 8];
static const dpt_route_table *table;
static const struct subject *table_of;

static struct strip *draw_strip(void)
{
    struct strip *strip = &strips[draw_below(STRIPS)];
    return strip->open ? strip : NULL;
}

/* Numbers that are there, dropped, or too large. */
static uint32_t draw_triangle(const struct subject *subject)
{
    return draw_one_in(20) ? (uint32_t)draw_bits() >> draw_below(32) : draw_below(subject->source_triangles);
}

/* By its own accessor, which other calls are held to. */
static int is_dropped(const struct subject *subject, uint32_t triangle)
{
    double corners[9];
    return dpt_mesh_get_triangle(subject->mesh, triangle, corners) != DPT_OK;
}

static void triangle_codes(const struct subject *subject, uint32_t triangle, struct codes *codes)
{
    may_fail(codes, triangle >= subject->source_triangles, DPT_E_ARGUMENT);
    may_fail(codes, triangle < subject->source_triangles && is_dropped(subject, triangle), DPT_E_DROPPED);
}

/* What the strip tells: as many triangles as fit, each once and there. Empty after an error. */
static void read_triangles(struct strip *strip, const struct subject *subject, dpt_result result, int is_route)
{
    uint32_t count = 77, flags = 77;
    const uint32_t *triangles = CALL(dpt_strip_get_triangles, strip->open, &count, draw_one_in(4) ? NULL : &flags);
    HOLDS(triangles && count <= strip->def.capacity, "%u of %u", count, strip->def.capacity);
    HOLDS(result == DPT_OK || count == 0, "%u triangles after an error", count);
    HOLDS(flags == 77 || flags <= 7, "flags %x", flags);
    HOLDS(flags == 77 || !(flags & DPT_STRIP_FLAG_FULL) || count == strip->def.capacity || !is_route, "cut at %u of %u",
          count, strip->def.capacity);
    for (uint32_t i = 0; i < count; i++) {
        triangle_must_be_there(subject, triangles[i]);
        for (uint32_t k = 0; k < i; k++)
            HOLDS(triangles[k] != triangles[i], "triangle %u is there twice", triangles[i]);
    }
    strip->of = count ? subject : NULL;
    strip->count = count;
    game_digest(triangles, count * sizeof *triangles);
}

static void create(void)
{
    const int which = (int)draw_below(STRIPS);
    struct strip *strip = &strips[which];
    const dpt_strip_def good = { .capacity = draw_one_in(20) ? 0 : 1 + draw_below(30),
                                 .search = draw_one_in(3) ? 0 : 1 + draw_below(120),
                                 .reserved = draw_one_in(30) ? 1u : 0u };
    struct codes codes = { .count = 0 };
    const int no_def = draw_one_in(40);
    const void *given = NULL;
    if (!no_def)
        given = draw_input(0, &good, draw_size(sizeof good, sizeof good), sizeof good, sizeof good, &codes);
    may_fail(&codes, no_def || !good.capacity || good.reserved, DPT_E_ARGUMENT);
    const size_t bytes = CALL(dpt_strip_bytes, given);
    HOLDS((bytes == 0) == (codes.count > 0), "%zu bytes", bytes);
    HOLDS(bytes <= 1024u + 96u * good.capacity + 36u * good.search, "%zu bytes for %u, %u", bytes, good.capacity,
          good.search);
    const int no_block = draw_one_in(40), no_strip = draw_one_in(40);
    const size_t off = draw_one_in(20) ? 1 + draw_below(7) : 0;
    const size_t room = bytes && draw_one_in(10) ? bytes - 1 - draw_below(8) : bytes;
    may_fail(&codes, no_block || no_strip, DPT_E_ARGUMENT);
    may_fail(&codes, off != 0, DPT_E_ALIGN);
    may_fail(&codes, room < bytes, DPT_E_MEMORY);
    dpt_strip *made = NULL;
    memset(blocks[which], 0x5c, sizeof blocks[which]);
    const dpt_result result =
        RESULT(dpt_strip_create, no_block ? NULL : (char *)blocks[which] + off, room, given, no_strip ? NULL : &made);
    expect(result, &codes);
    outputs_are_guarded(0, 1);
    const unsigned char *behind = (const unsigned char *)blocks[which] + off + room;
    for (int i = 0; i < 32; i++)
        HOLDS(behind[i] == 0x5c, "written behind the block");
    *strip = (struct strip){ .open = result == DPT_OK ? made : NULL, .def = good };
    if (strip->open)
        read_triangles(strip, &subjects[0], DPT_E_ARGUMENT, 0);
}

static void nothing(void)
{
    uint32_t count = 77, flags = 77;
    HOLDS(!CALL(dpt_strip_get_triangles, NULL, &count, &flags) && count == 0 && flags == 0, "%u, %x", count, flags);
    CALL(dpt_strip_get_triangles, NULL, NULL, NULL);
}

static void route(void)
{
    struct strip *strip = draw_strip();
    const struct subject *subject = draw_subject();
    const uint32_t from = draw_triangle(subject), to = draw_triangle(subject);
    const int no_strip = !strip, no_mesh = draw_one_in(40);
    struct codes codes = { .count = 0 };
    may_fail(&codes, no_strip || no_mesh, DPT_E_ARGUMENT);
    triangle_codes(subject, from, &codes);
    triangle_codes(subject, to, &codes);
    codes.or_done = !codes.count;
    may_fail(&codes, codes.or_done, DPT_E_UNREACHABLE);
    may_fail(&codes, codes.or_done, DPT_E_FULL);
    call_with("%llu to %llu, search %llu", from, to, strip ? strip->def.search : 0, 0);
    const dpt_result result =
        RESULT(dpt_strip_route, strip ? strip->open : NULL, no_mesh ? NULL : subject->mesh, from, to);
    expect(result, &codes);
    if (!strip)
        return;
    read_triangles(strip, subject, result, 1);
    if (result != DPT_OK)
        return;
    const uint32_t *triangles = CALL(dpt_strip_get_triangles, strip->open, NULL, NULL);
    HOLDS(triangles[0] == from, "it begins at %u, and not at %u", triangles[0], from);
    HOLDS(strip->count == strip->def.capacity || triangles[strip->count - 1] == to, "it ends at %u, and not at %u",
          triangles[strip->count - 1], to);
}

static void routes(void)
{
    struct strip *strip = draw_strip();
    const struct subject *subject = draw_subject();
    const uint32_t a = draw_triangle(subject), b = draw_triangle(subject), p = draw_triangle(subject);
    const int no_mesh = draw_one_in(40);
    struct codes codes = { .count = 0 };
    may_fail(&codes, !strip || no_mesh, DPT_E_ARGUMENT);
    triangle_codes(subject, a, &codes);
    triangle_codes(subject, b, &codes);
    triangle_codes(subject, p, &codes);
    codes.or_done = !codes.count;
    may_fail(&codes, 1, DPT_E_UNREACHABLE);
    may_fail(&codes, 1, DPT_E_FULL);
    call_with("%llu, %llu, %llu", a, b, p, 0);
    const dpt_result result =
        RESULT(dpt_strip_routes, strip ? strip->open : NULL, no_mesh ? NULL : subject->mesh, a, b, p);
    expect(result, &codes);
    if (strip)
        read_triangles(strip, subject, result, 1);
}

static void make_table(void)
{
    const struct subject *subject = draw_subject();
    const int no_mesh = draw_one_in(20), no_block = draw_one_in(20), no_table = draw_one_in(20);
    const size_t bytes = CALL(dpt_route_table_bytes, no_mesh ? NULL : subject->mesh);
    HOLDS(no_mesh ? bytes == 0 : bytes >= 2u * subject->triangles * subject->triangles, "%zu bytes", bytes);
    const size_t off = draw_one_in(12) ? 1 + draw_below(7) : 0;
    const size_t room = bytes && draw_one_in(12) ? bytes - 1 : bytes;
    if (bytes > TABLE_BLOCK - 64)
        return;
    const dpt_route_table *made = NULL;
    struct codes codes = { .count = 0 };
    may_fail(&codes, no_mesh || no_block || no_table, DPT_E_ARGUMENT);
    may_fail(&codes, off != 0, DPT_E_ALIGN);
    may_fail(&codes, room < bytes, DPT_E_MEMORY);
    table = NULL;
    memset((char *)table_block + off + room, 0x5c, 32);
    const dpt_result result = RESULT(dpt_route_table_create, no_block ? NULL : (char *)table_block + off, room,
                                     no_mesh ? NULL : subject->mesh, no_table ? NULL : &made);
    expect(result, &codes);
    for (int i = 0; i < 32; i++)
        HOLDS(((unsigned char *)table_block)[off + room + (size_t)i] == 0x5c, "written behind it");
    if (result == DPT_OK) {
        table = made;
        table_of = subject;
    }
}

/* The same route as without a table. */
static void route_by_table(void)
{
    struct strip *strip = draw_strip();
    const int no_table = !table || draw_one_in(20);
    const struct subject *subject = table_of ? table_of : &subjects[0];
    const uint32_t from = draw_triangle(subject), to = draw_triangle(subject);
    struct codes codes = { .count = 0 };
    may_fail(&codes, !strip || no_table, DPT_E_ARGUMENT);
    triangle_codes(subject, from, &codes);
    triangle_codes(subject, to, &codes);
    codes.or_done = !codes.count;
    may_fail(&codes, 1, DPT_E_UNREACHABLE);
    call_with("%llu to %llu", from, to, 0, 0);
    const dpt_result result =
        RESULT(dpt_strip_route_by_table, strip ? strip->open : NULL, no_table ? NULL : table, from, to);
    expect(result, &codes);
    if (!strip)
        return;
    read_triangles(strip, subject, result, 1);
    if (no_table || strip->def.search < 100)
        return;
    uint32_t first[32];
    const uint32_t count = strip->count;
    memcpy(first, CALL(dpt_strip_get_triangles, strip->open, NULL, NULL), count * sizeof *first);
    const dpt_result searched = RESULT(dpt_strip_route, strip->open, subject->mesh, from, to);
    read_triangles(strip, subject, searched, 1);
    if (searched == DPT_E_FULL)
        return;
    HOLDS(searched == result && strip->count == count &&
              !memcmp(first, CALL(dpt_strip_get_triangles, strip->open, NULL, NULL), count * sizeof *first),
          "%s by a search, %s by the table", dpt_result_name(searched), dpt_result_name(result));
}

static void shadow(void)
{
    struct strip *strip = draw_strip();
    const struct subject *subject = draw_subject();
    const dpt_pose pose = draw_pose(NULL);
    dpt_shadow good = { .triangle = draw_triangle(subject),
                        .segment = draw_segment(),
                        .direction = { draw_in(-1.0, 1.0), draw_in(-1.0, 1.0), draw_in(-1.0, 1.0) },
                        .width = draw_in(0.0, 0.02),
                        .depth = draw_in(0.0, 0.2) };
    double *numbers[] = { good.direction, &good.width, &good.depth };
    if (draw_one_in(12))
        *numbers[draw_below(3)] = draw_odd_number();
    if (draw_one_in(40))
        memset(good.direction, 0, sizeof good.direction);
    const int no_mesh = draw_one_in(40), no_pose = draw_one_in(3), no_shadow = draw_one_in(40);
    struct codes codes = { .count = 0 };
    const void *given = NULL;
    may_fail(&codes, !strip || no_mesh || no_shadow, DPT_E_ARGUMENT);
    if (!no_shadow)
        given = draw_input(0, &good, draw_size(sizeof good, sizeof good), sizeof good, sizeof good, &codes);
    segment_codes(&good.segment, &codes);
    if (!no_pose)
        pose_codes(&pose, &codes);
    triangle_codes(subject, good.triangle, &codes);
    const double *d = good.direction;
    const double most = fmax(fabs(d[0]), fmax(fabs(d[1]), fabs(d[2])));
    int is_finite = isfinite(d[0]) && isfinite(d[1]) && isfinite(d[2]);
    may_fail(&codes, !is_finite || most > 1e100, DPT_E_FINITE);
    may_fail(&codes, is_finite && most < 1e-100, DPT_E_ARGUMENT);
    for (int k = 0; k < 2; k++) {
        const double number = k ? good.depth : good.width;
        may_fail(&codes, number < 0.0, DPT_E_ARGUMENT);
        may_fail(&codes, !(fabs(number) <= DPT_COORDINATE_MAX), DPT_E_FINITE);
    }
    call_with("from triangle %llu", good.triangle, 0, 0, 0);
    const dpt_result result = RESULT(dpt_strip_shadow, strip ? strip->open : NULL, no_mesh ? NULL : subject->mesh,
                                     no_pose ? NULL : &pose, given);
    expect(result, &codes);
    if (strip)
        read_triangles(strip, subject, result, 0);
}

static void overlaps(void)
{
    struct strip *strip = draw_strip();
    if (!strip)
        return;
    const struct subject *subject = strip->of && !draw_one_in(20) ? strip->of : draw_subject();
    const dpt_pose pose = draw_pose(NULL);
    const dpt_segment segment = draw_segment();
    const int32_t side = draw_one_in(20) ? (int32_t)draw_below(5) - 2 : draw_one_in(2) ? 1 : -1;
    const int no_strip = draw_one_in(40), no_mesh = draw_one_in(40), no_pose = draw_one_in(3);
    const int no_segment = draw_one_in(40), no_array = draw_one_in(20), no_count = draw_one_in(40);
    const uint32_t size = draw_size(sizeof(dpt_overlap), sizeof(dpt_overlap));
    const uint32_t capacity = draw_below(OVERLAPS_MAX), room = size > 4096 || size < 8 ? 8 : size;
    struct codes codes = { .count = 0 };
    uint32_t count = 77;
    may_fail(&codes,
             no_strip || no_mesh || no_segment || no_count || (no_array && capacity) || (side != 1 && side != -1) ||
                 (strip->count && subject != strip->of),
             DPT_E_ARGUMENT);
    if (!no_array && capacity)
        size_codes_of_output(size, sizeof(dpt_overlap), 1, &codes);
    if (!no_segment)
        segment_codes(&segment, &codes);
    if (!no_pose)
        pose_codes(&pose, &codes);
    unsigned char *out = output_of(0, (size_t)room * capacity);
    if (capacity)
        memcpy(out, &size, sizeof size);
    call_with("%llu triangles, capacity %llu, size %llu", strip->count, capacity, size, 0);
    const dpt_result result = RESULT(dpt_strip_overlaps, no_strip ? NULL : strip->open, no_mesh ? NULL : subject->mesh,
                                     no_pose ? NULL : &pose, no_segment ? NULL : &segment, side,
                                     no_array ? NULL : (void *)out, capacity, no_count ? NULL : &count);
    expect(result, &codes);
    outputs_are_guarded(0, 1);
    HOLDS(count == (result == DPT_OK ? strip->count : 0) || count == 77, "%u of %u", count, strip->count);
    HOLDS(result != DPT_OK || count != 77, "no count");
    if (result != DPT_OK || size != sizeof(dpt_overlap))
        return;
    const uint32_t given = count < capacity ? count : capacity;
    const dpt_overlap *answers = (const dpt_overlap *)(const void *)out;
    for (uint32_t i = 0; i < given; i++)
        numbers_are_finite(&answers[i].distance, 10, "an overlap");
    overlaps_must_hold(answers, given, segment.radius);
    HOLDS(output_is_untouched(0, capacity && !given ? sizeof size : (size_t)given * size),
          "written behind the last of %u", given);
    game_digest(out, (size_t)given * size);
}

static void end(void)
{
    memset(strips, 0, sizeof strips);
    table = NULL;
    table_of = NULL;
}

static const struct move moves[] = {
    { "create", create, 6 }, { "nothing", nothing, 1 },       { "route", route, 6 },
    { "routes", routes, 5 }, { "make table", make_table, 1 }, { "route by table", route_by_table, 4 },
    { "shadow", shadow, 8 }, { "overlaps", overlaps, 8 },     { NULL, NULL, 0 }
};

const struct noun strip_noun = { "strip", NULL, end, moves };
