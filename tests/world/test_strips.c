/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Strips in a world: the same as those that are asked for without one (tests/strip/test_strip.c), of the nearest body,
 * on the tool's side, and gone when there is nothing under the tool.
 */
#include "lib/fixture.h"
#include "lib/rig.h"
#include "strip/strip_state.h"

enum { CAPACITY = 512 };

struct lab {
    struct fixture fixture;
    struct rig rig;
};

static dpt_world_def def_with(uint32_t strip)
{
    dpt_world_def def = rig_def(DPT_LAW_POINT);
    def.strip = strip;
    def.strip_capacity = CAPACITY;
    def.margin = 0.005;
    return def;
}

static dpt_segment lying(double height)
{
    return (dpt_segment){ { -0.031, 0.0123, height }, { 0.042, 0.0017, height }, 0.001 };
}

static void lab_open(struct lab *lab, const dpt_world_def *def, const char *shape, uint64_t count, const dpt_pose *pose,
                     const dpt_segment *segment)
{
    fixture_from_shape(&lab->fixture, shape, count);
    rig_open(&lab->rig, def, NULL, segment, 1);
    rig_add_body(&lab->rig, lab->fixture.mesh, pose);
}

static void lab_close(struct lab *lab)
{
    rig_close(&lab->rig);
    fixture_free(&lab->fixture);
}

static void step(struct lab *lab, const dpt_segment *segment)
{
    CHECK(dpt_tool_set_segments(lab->rig.world, lab->rig.tool, segment, 1) == DPT_OK, "segments");
    rig_tick(&lab->rig);
}

/* How many triangles, their overlaps in `overlaps`. */
static uint32_t strip_of(const struct lab *lab, dpt_tool tool, dpt_overlap *overlaps)
{
    uint32_t count = 77, flags;
    overlaps[0].size = sizeof *overlaps;
    dpt_result result = dpt_tool_get_strip(lab->rig.world, tool, 0, overlaps, CAPACITY, &count, &flags);
    CHECK(result == DPT_OK && count <= CAPACITY, "%s, %u", dpt_result_name(result), count);
    return count;
}

static int by_triangle(const void *a, const void *b)
{
    uint32_t x = ((const dpt_overlap *)a)->triangle, y = ((const dpt_overlap *)b)->triangle;
    return (x > y) - (x < y);
}

static int by_number(const void *a, const void *b)
{
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

static dpt_strip *alone(void **block, uint32_t search)
{
    const dpt_strip_def def = { .size = sizeof def, .capacity = CAPACITY, .search = search };
    dpt_strip *strip = NULL;
    *block = malloc(dpt_strip_bytes(&def));
    CHECK(dpt_strip_create(*block, dpt_strip_bytes(&def), &def, &strip) == DPT_OK, "strip");
    return strip;
}

/* The world's strip is the one of `strip`, in whatever order. */
static void check_same(const struct lab *lab, const dpt_strip *strip, const char *what)
{
    static dpt_overlap overlaps[CAPACITY];
    static uint32_t sorted[CAPACITY];
    uint32_t count, wanted, same = 0;
    const uint32_t *triangles = dpt_strip_get_triangles(strip, &wanted, NULL);
    memcpy(sorted, triangles, wanted * sizeof *sorted);
    qsort(sorted, wanted, sizeof *sorted, by_number);
    count = strip_of(lab, lab->rig.tool, overlaps);
    qsort(overlaps, count, sizeof *overlaps, by_triangle);
    for (uint32_t i = 0; i < count && i < wanted; i++)
        same += overlaps[i].triangle == sorted[i];
    CHECK(count == wanted && same == count, "%s: %u triangles, not %u, %u alike", what, count, wanted, same);
}

/* A segment of some centimetres through a corner of a random triangle of the liver, which is turned and moved. */
static void jump_to_liver(const dpt_mesh *mesh, uint64_t *random, dpt_segment *segment)
{
    double corners[9];
    dpt_mesh_get_triangle(mesh, (uint32_t)random_in(random, 0.0, 5568.0), corners);
    double x = corners[0] * 0.28 + corners[2] * 0.96, z = corners[2] * 0.28 - corners[0] * 0.96;
    const double at[3] = { x + 0.1, corners[1] - 0.2, z + 0.3 };
    for (int k = 0; k < 3; k++) {
        segment->a[k] = at[k] + random_in(random, -0.04, 0.04);
        segment->b[k] = at[k] + random_in(random, -0.04, 0.04);
    }
}

static void shadow_is_that_of_the_nearest_pair(void)
{
    dpt_world_def def = def_with(DPT_STRIP_KIND_SHADOW);
    def.strip_width = 0.002;
    const dpt_pose pose = { { 0.1, -0.2, 0.3 }, { 0.8, 0.0, 0.6, 0.0 } };
    struct lab lab;
    struct fixture liver;
    void *block;
    uint64_t random = 5;
    uint32_t near_ticks = 0, deep = 0, empty = 0;
    dpt_segment segment = lying(0.0);
    lab_open(&lab, &def, "liver", 5568, &pose, &segment);
    fixture_from_shape(&liver, "liver", 5568);
    dpt_strip *strip = alone(&block, 0);
    for (int tick = 0; tick < 3000; tick++) {
        dpt_hit hit = DPT_HIT_INIT;
        if (tick % 50 == 0)
            jump_to_liver(liver.mesh, &random, &segment);
        for (int k = 0; k < 3; k++) {
            double way = random_in(&random, -3e-4, 3e-4);
            segment.a[k] += way;
            segment.b[k] += way;
        }
        step(&lab, &segment);
        dpt_tool_get_hit(lab.rig.world, lab.rig.tool, &hit);
        int near = hit.contact == DPT_CONTACT_PENETRATING || hit.distance <= def.margin + 0.001;
        dpt_overlap overlaps[CAPACITY];
        uint32_t count = strip_of(&lab, lab.rig.tool, overlaps);
        if (!near) {
            CHECK(count == 0, "%u triangles, %g m away", count, hit.distance);
            empty++;
            continue;
        }
        near_ticks++;
        deep += hit.distance == 0.0;
        if (hit.distance == 0.0)
            continue;
        double length = 0.0;
        dpt_shadow shadow = {
            .size = sizeof shadow, .triangle = hit.triangle, .segment = segment, .width = def.strip_width
        };
        for (int k = 0; k < 3; k++) {
            shadow.direction[k] = hit.q[k] - hit.p[k];
            length += (segment.b[k] - segment.a[k]) * (segment.b[k] - segment.a[k]);
        }
        shadow.depth = 0.25 * sqrt(length) + 0.001 + def.margin;
        CHECK(dpt_strip_shadow(strip, liver.mesh, &pose, &shadow) == DPT_OK, "shadow");
        check_same(&lab, strip, "shadow");
    }
    CHECK(near_ticks > 500 && deep > 100 && empty > 100, "%u near_ticks, %u crossing, %u away", near_ticks, deep,
          empty);
    free(block);
    fixture_free(&liver);
    lab_close(&lab);
}

static uint32_t nearest_to(const dpt_mesh *mesh, const double point[3])
{
    const double ends[6] = { point[0], point[1], point[2], point[0], point[1], point[2] };
    dpt_hit hit = DPT_HIT_INIT;
    dpt_query_segments(mesh, NULL, ends, NULL, 1, &hit, NULL);
    return hit.triangle;
}

static void routes_lead_from_the_ends(void)
{
    const dpt_world_def def = def_with(DPT_STRIP_KIND_ROUTES);
    struct lab lab;
    void *block;
    dpt_segment segment = lying(0.003);
    lab_open(&lab, &def, "membrane", 0, NULL, &segment);
    dpt_strip *strip = alone(&block, 4096);
    for (int tick = 0; tick < 50; tick++) {
        dpt_hit hit = DPT_HIT_INIT;
        segment.a[0] += 0.0005;
        segment.b[1] -= 0.0007;
        step(&lab, &segment);
        dpt_tool_get_hit(lab.rig.world, lab.rig.tool, &hit);
        uint32_t a = nearest_to(lab.fixture.mesh, segment.a);
        uint32_t b = nearest_to(lab.fixture.mesh, segment.b);
        CHECK(dpt_strip_routes(strip, lab.fixture.mesh, a, b, hit.triangle) == DPT_OK, "routes");
        check_same(&lab, strip, "routes");
    }
    free(block);
    lab_close(&lab);
}

static void overlaps_are_on_the_side_of_the_tool(void)
{
    const dpt_world_def def = def_with(DPT_STRIP_KIND_SHADOW);
    dpt_overlap overlaps[CAPACITY];
    /* From in front and from behind, free first; then so deep. */
    for (double side = -1.0; side <= 1.0; side += 2.0)
        for (double height = 0.003; height > -0.003; height -= 0.0005) {
            struct lab lab;
            dpt_segment above = lying(side * 0.004), segment = lying(side * height);
            double least = HUGE_VAL;
            lab_open(&lab, &def, "membrane", 0, NULL, &above);
            step(&lab, &above);
            step(&lab, &segment);
            dpt_hit hit = DPT_HIT_INIT;
            dpt_tool_get_hit(lab.rig.world, lab.rig.tool, &hit);
            uint32_t count = strip_of(&lab, lab.rig.tool, overlaps);
            CHECK(count > 10, "%u triangles", count);
            for (uint32_t i = 0; i < count; i++) {
                CHECK(overlaps[i].overlap == fmax(0.0, -overlaps[i].gap), "overlap");
                least = fmin(least, overlaps[i].gap);
            }
            CHECK((hit.flags & DPT_HIT_FLAG_GAP) && fabs(least - hit.gap) < 1e-9, "side %g, height %g: %g, not %g",
                  side, height, least, hit.gap);
            lab_close(&lab);
        }
}

static void nothing_under_the_tool_is_no_strip(void)
{
    dpt_world_def def = def_with(DPT_STRIP_KIND_SHADOW);
    dpt_overlap overlaps[CAPACITY];
    struct lab lab;
    dpt_segment near = lying(0.004), far = lying(0.1);
    lab_open(&lab, &def, "membrane", 0, NULL, &near);
    step(&lab, &near);
    CHECK(strip_of(&lab, lab.rig.tool, overlaps) > 10, "near");
    step(&lab, &far);
    CHECK(strip_of(&lab, lab.rig.tool, overlaps) == 0, "far");
    step(&lab, &near);
    const dpt_pose bad = { { NAN, 0.0, 0.0 }, { 1.0, 0.0, 0.0, 0.0 } };
    dpt_tool_set_pose(lab.rig.world, lab.rig.tool, &bad);
    dpt_world_step(lab.rig.world, 0.001, NULL);
    CHECK(strip_of(&lab, lab.rig.tool, overlaps) == 0, "stale");
    step(&lab, &near);
    CHECK(strip_of(&lab, lab.rig.tool, overlaps) > 10, "back");
    CHECK(dpt_world_step(lab.rig.world, -1.0, NULL) == DPT_E_ARGUMENT, "dt");
    CHECK(strip_of(&lab, lab.rig.tool, overlaps) == 0, "after an error");
    step(&lab, &near);
    dpt_body_remove(lab.rig.world, lab.rig.body);
    CHECK(strip_of(&lab, lab.rig.tool, overlaps) == 0, "its body is gone");
    lab_close(&lab);

    def.until = DPT_UNTIL_TRACK;
    lab_open(&lab, &def, "membrane", 0, NULL, &near);
    step(&lab, &near);
    CHECK(strip_of(&lab, lab.rig.tool, overlaps) == 0, "no contact is asked for");
    lab_close(&lab);

    def = def_with(DPT_STRIP_KIND_NONE);
    lab_open(&lab, &def, "membrane", 0, NULL, &near);
    step(&lab, &near);
    CHECK(strip_of(&lab, lab.rig.tool, overlaps) == 0, "none is asked for");
    lab_close(&lab);
}

static void a_removed_tool_leaves_the_others_theirs(void)
{
    const dpt_world_def def = def_with(DPT_STRIP_KIND_SHADOW);
    static dpt_overlap before[3][CAPACITY], after[CAPACITY];
    const dpt_segment first = lying(0.001);
    dpt_tool tool[3];
    uint32_t count[3];
    struct lab lab;
    lab_open(&lab, &def, "membrane", 0, NULL, &first);
    tool[0] = lab.rig.tool;
    for (int i = 1; i < 3; i++) {
        dpt_segment next = lying(0.001 * (1 + i));
        next.b[0] += 0.01 * i;
        tool[i] = rig_add_tool(&lab.rig, &next, 1);
    }
    dpt_world_step(lab.rig.world, 0.001, NULL);
    for (int i = 0; i < 3; i++)
        count[i] = strip_of(&lab, tool[i], before[i]);
    CHECK(count[0] > 10 && count[2] > count[0], "%u and %u", count[0], count[2]);
    dpt_tool_remove(lab.rig.world, tool[0]);
    for (int round = 0; round < 2; round++) {
        for (int i = 1; i < 3; i++) {
            uint32_t now = strip_of(&lab, tool[i], after);
            CHECK(now == count[i] && !memcmp(after, before[i], now * sizeof *after), "tool %d: %u triangles, not %u", i,
                  now, count[i]);
        }
        dpt_world_step(lab.rig.world, 0.001, NULL);
    }
    lab_close(&lab);
}

/* After 2^32 walks, what an earlier one of the same number found is not there: a strip of nearly the same is whole. */
static void walks_are_counted_from_1_again(void)
{
    struct fixture fixture;
    void *blocks[2];
    dpt_shadow shadow = { .size = sizeof shadow,
                          .segment = lying(0.004),
                          .direction = { 0, 0, -1 },
                          .triangle = 300,
                          .width = 0.05,
                          .depth = 0.1 };
    fixture_from_shape(&fixture, "membrane", 0);
    dpt_strip *strip = alone(&blocks[0], 0), *other = alone(&blocks[1], 0);
    uint32_t counts[3];
    CHECK(dpt_strip_shadow(strip, fixture.mesh, NULL, &shadow) == DPT_OK, "first");
    dpt_strip_get_triangles(strip, &counts[0], NULL);
    shadow.width = 0.049;
    strip->walk.stamp = UINT32_MAX;
    CHECK(dpt_strip_shadow(strip, fixture.mesh, NULL, &shadow) == DPT_OK, "again");
    CHECK(dpt_strip_shadow(other, fixture.mesh, NULL, &shadow) == DPT_OK, "alone");
    dpt_strip_get_triangles(strip, &counts[1], NULL);
    dpt_strip_get_triangles(other, &counts[2], NULL);
    CHECK(counts[0] > 50 && counts[1] == counts[2] && counts[2] > 50, "%u, %u, %u", counts[0], counts[1], counts[2]);
    free(blocks[0]);
    free(blocks[1]);
    fixture_free(&fixture);
}

static void defs_and_arguments_are_checked(void)
{
    dpt_world_def def = def_with(DPT_STRIP_KIND_ROUTES), none = def_with(DPT_STRIP_KIND_NONE);
    const dpt_strip_def strip = { .size = sizeof strip, .capacity = CAPACITY, .search = def.strip_search };
    CHECK(dpt_world_bytes(&def) == dpt_world_bytes(&none) + def.max_segments * (640 + dpt_strip_bytes(&strip)),
          "bytes");
    none.strip_capacity = 1 << 20;
    CHECK(dpt_world_bytes(&none) + 16 * dpt_strip_bytes(&strip) < dpt_world_bytes(&def),
          "what is not asked for costs nothing");
#define REFUSED(field, value)                                                                                          \
    def = def_with(DPT_STRIP_KIND_SHADOW);                                                                             \
    def.field = value;                                                                                                 \
    CHECK(dpt_world_bytes(&def) == 0, #field " = " #value)
    REFUSED(strip, 3);
    REFUSED(strip_capacity, 0);
    REFUSED(strip_capacity, (1 << 20) + 1);
    REFUSED(strip_width, -1.0);
    REFUSED(strip_width, NAN);
    REFUSED(strip_depth, INFINITY);
#undef REFUSED
    def = def_with(DPT_STRIP_KIND_SHADOW);
    struct lab lab;
    dpt_segment near = lying(0.004);
    dpt_overlap overlap = { .size = sizeof overlap };
    uint32_t count = 77;
    lab_open(&lab, &def, "membrane", 0, NULL, &near);
    step(&lab, &near);
    CHECK(dpt_tool_get_strip(NULL, lab.rig.tool, 0, &overlap, 1, &count, NULL) == DPT_E_ARGUMENT, "no world");
    CHECK(dpt_tool_get_strip(lab.rig.world, lab.rig.tool, 1, &overlap, 1, &count, NULL) == DPT_E_ARGUMENT, "segment 1");
    CHECK(dpt_tool_get_strip(lab.rig.world, lab.rig.body, 0, &overlap, 1, &count, NULL) == DPT_E_HANDLE, "a body");
    CHECK(dpt_tool_get_strip(lab.rig.world, lab.rig.tool, 0, NULL, 1, &count, NULL) == DPT_E_ARGUMENT, "no room");
    CHECK(dpt_tool_get_strip(lab.rig.world, lab.rig.tool, 0, NULL, 0, &count, NULL) == DPT_OK && count > 10,
          "count alone");
    overlap.size = 8;
    CHECK(dpt_tool_get_strip(lab.rig.world, lab.rig.tool, 0, &overlap, 1, &count, NULL) == DPT_E_SIZE, "size");
    lab_close(&lab);
}

int main(void)
{
    TEST(shadow_is_that_of_the_nearest_pair);
    TEST(routes_lead_from_the_ends);
    TEST(overlaps_are_on_the_side_of_the_tool);
    TEST(nothing_under_the_tool_is_no_strip);
    TEST(a_removed_tool_leaves_the_others_theirs);
    TEST(walks_are_counted_from_1_again);
    TEST(defs_and_arguments_are_checked);
    return check_report();
}
