/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Worlds: memory, ids, the tick over several bodies and segments, the penalty against closed forms, and
 * what happens when the input is not valid. That the nearest pair is right is for test_query and
 * test_exactness; here it is compared with the stateless answer.
 */
#include "world/small_def.h"

static void memory_is_what_it_says(void)
{
    dpt_world_def def = small_def();
    def.certificate_bytes = 1000000 - 1;
    const size_t expected = dpt_world_bytes(&def);
    CHECK(expected > 0, "no bytes");
    unsigned char *block = malloc(expected + 64);
    dpt_world *world;
    memset(block, 0xa5, expected + 64);
    CHECK(dpt_world_create(block, expected - 1, &def, &world) == DPT_E_MEMORY, "too small");
    CHECK(dpt_world_create(block + 4, expected, &def, &world) == DPT_E_ALIGN, "misaligned");
    CHECK(dpt_world_create(block + 8, expected, &def, &world) == DPT_OK, "8 is enough");
    CHECK(dpt_world_create(NULL, expected, &def, &world) == DPT_E_ARGUMENT, "no block");
    CHECK(dpt_world_create(block, expected, NULL, &world) == DPT_E_ARGUMENT, "no def");
    CHECK(dpt_world_create(block, expected, &def, NULL) == DPT_E_ARGUMENT, "no world");
    for (size_t i = expected + 8; i < expected + 64; i++)
        CHECK(block[i] == 0xa5, "wrote behind the block at %zu", i);
    free(block);
}

/* A def of a newer caller, one for a kernel that is not here, and defaults of other sizes. */
static void other_defs_are_checked(void)
{
    dpt_world_def good = small_def(), def;
    struct {
        dpt_world_def def;
        uint32_t newer[2];
    } longer = { good, { 0, 0 } };
    longer.def.size = sizeof longer;
    CHECK(dpt_world_bytes(&longer.def) == dpt_world_bytes(&good), "a longer def, rest 0");
    longer.newer[1] = 1;
    CHECK(dpt_world_bytes(&longer.def) == 0, "a longer def that asks for more");
    def = good;
    def.kernel = 77;
    size_t bytes = dpt_world_bytes(&def);
    void *block = malloc(bytes);
    dpt_world *world;
    memset(block, 0xa5, bytes);
    CHECK(dpt_world_create(block, bytes, &def, &world) == DPT_E_UNSUPPORTED, "kernel");
    size_t same = 0;
    while (same < bytes && ((unsigned char *)block)[same] == 0xa5)
        same++;
    CHECK(same == bytes, "a block that was refused is written at %zu", same);
    free(block);
    memset(&longer, 0x55, sizeof longer);
    dpt_world_def_defaults(&longer.def, sizeof longer);
    CHECK(dpt_world_bytes(&longer.def) > 0 && longer.newer[0] == 0 && longer.newer[1] == 0,
          "the defaults of a longer def leave its tail as it was");
    memset(&def, 0x55, sizeof def);
    dpt_world_def_defaults(&def, 8);
    CHECK(def.size == 8 && def.max_tools == 0x55555555, "wrote more than the caller's size");
}

static void defs_are_checked(void)
{
    dpt_world_def good = small_def(), def;
    CHECK(good.size == sizeof good && good.stiffness == 500.0, "defaults");
    CHECK(dpt_world_bytes(NULL) == 0, "NULL");
#define REFUSED(field, value)                                                                                          \
    def = good;                                                                                                        \
    def.field = value;                                                                                                 \
    CHECK(dpt_world_bytes(&def) == 0, #field " = " #value)
    REFUSED(size, 8);
    REFUSED(max_bodies, 0);
    REFUSED(max_bodies, 65536);
    REFUSED(max_tools, 0);
    REFUSED(max_segments, 0);
    REFUSED(method, 4);
    dpt_baseline_def paper, wrong;
    dpt_baseline_def_init(&paper);
    REFUSED(reserved_pointer, &paper);
    REFUSED(law, 3);
#define REFUSED_BASELINE(field, value)                                                                                 \
    wrong = paper;                                                                                                     \
    wrong.field = value;                                                                                               \
    REFUSED(baseline, &wrong)
    REFUSED_BASELINE(size, 8);
    REFUSED_BASELINE(parts, 0);
    REFUSED_BASELINE(parts, 2); /* of another method than the paper's */
    REFUSED_BASELINE(one_step, 2);
    REFUSED_BASELINE(reserved, 1);
#undef REFUSED_BASELINE
    def = good;
    def.method = DPT_METHOD_PAPER;
    def.baseline = &paper;
    paper.parts = 64;
    CHECK(dpt_world_bytes(&def) > dpt_world_bytes(&good), "64 parts");
    paper.parts = 65;
    CHECK(dpt_world_bytes(&def) == 0, "65 parts");
    REFUSED(until, 3);
    def = good;
    def.method = DPT_METHOD_TREE;
    CHECK(dpt_world_bytes(&def) > 0, "tree");
    def.budget = 1;
    CHECK(dpt_world_bytes(&def) == 0, "only the exact method has a budget");
    REFUSED(stiffness, -1.0);
    REFUSED(stiffness, NAN);
    REFUSED(stiffness, INFINITY);
#undef REFUSED
    other_defs_are_checked();
}

static void ids_die_with_their_things(void)
{
    struct fixture box;
    struct rig made;
    dpt_world_def def = small_def();
    if (!fixture_from_shape(&box, "box", 12))
        return;
    rig_open(&made, &def, NULL, NULL, 0);
    dpt_segment line = capsule(0, 0, 1, 0, 0, 2, 0);
    dpt_body body, again;
    dpt_tool tool;
    dpt_hit hit = DPT_HIT_INIT;
    dpt_pose pose = DPT_POSE_IDENTITY;
    body = rig_add_body(&made, box.mesh, NULL);
    tool = rig_add_tool(&made, &line, 1);
    CHECK(dpt_body_set_pose(made.world, tool, &pose) == DPT_E_HANDLE, "a tool is no body");
    CHECK(dpt_tool_set_pose(made.world, body, &pose) == DPT_E_HANDLE, "a body is no tool");
    CHECK(dpt_tool_get_hit(made.world, 0, &hit) == DPT_E_HANDLE, "null id");
    CHECK(dpt_body_remove(made.world, body) == DPT_OK, "remove");
    CHECK(dpt_body_remove(made.world, body) == DPT_E_HANDLE, "removed twice");
    again = rig_add_body(&made, box.mesh, NULL);
    CHECK(again != body, "the old id is valid again");
    CHECK(dpt_body_set_pose(made.world, body, &pose) == DPT_E_HANDLE, "stale id");
    uint64_t random = 1;
    for (int i = 0; i < 100000; i++) {
        uint32_t id = (uint32_t)random_bits(&random);
        if (id != again)
            CHECK(dpt_body_set_pose(made.world, id, &pose) == DPT_E_HANDLE, "id %08x", id);
    }
    for (int i = 1; i < 4; i++)
        body = rig_add_body(&made, box.mesh, NULL);
    CHECK(dpt_body_add(made.world, box.mesh, NULL, &body) == DPT_E_FULL, "five bodies in four");
    rig_close(&made);
    fixture_free(&box);
}

/*
 * A simulator that adds and removes for ever: 3 rounds of a slot's generations, and the oldest of several slots first.
 */
static void slots_are_used_for_ever(void)
{
    enum { GENERATIONS = 4095, ROUNDS = 3, BODIES = 4 };
    static dpt_body gone[GENERATIONS * ROUNDS];
    struct fixture box;
    struct rig made;
    dpt_world_def def = small_def();
    dpt_segment line = capsule(0, 0, 1, 0, 0, 2, 0);
    dpt_pose pose = DPT_POSE_IDENTITY;
    dpt_body body[BODIES], next;
    dpt_tool tool;
    if (!fixture_from_shape(&box, "box", 12))
        return;
    rig_open(&made, &def, NULL, NULL, 0);
    for (int i = 0; i < GENERATIONS * ROUNDS; i++) {
        gone[i] = rig_add_body(&made, box.mesh, NULL);
        CHECK(dpt_tool_add(made.world, &line, 1, &tool) == DPT_OK && dpt_tool_remove(made.world, tool) == DPT_OK &&
                  dpt_tool_remove(made.world, tool) == DPT_E_HANDLE,
              "tool %d", i);
        for (int k = i > GENERATIONS - 1 ? i - (GENERATIONS - 1) : 0; k < i; k += 97)
            CHECK(dpt_body_set_pose(made.world, gone[k], &pose) == DPT_E_HANDLE, "body %d is there after %d", k, i - k);
        CHECK(dpt_body_remove(made.world, gone[i]) == DPT_OK, "body %d", i);
    }
    CHECK(gone[0] == gone[GENERATIONS] && gone[0] != gone[1], "generations come round");
    for (int i = 0; i < BODIES; i++)
        body[i] = rig_add_body(&made, box.mesh, NULL);
    static const int order[BODIES] = { 2, 0, 3, 1 };
    for (int i = 0; i < BODIES; i++)
        dpt_body_remove(made.world, body[order[i]]);
    for (int i = 0; i < BODIES; i++) {
        next = rig_add_body(&made, box.mesh, NULL);
        CHECK((next & 0xffff) == (body[order[i]] & 0xffff), "slot %u, not %u", next & 0xffff, body[order[i]] & 0xffff);
    }
    rig_close(&made);
    fixture_free(&box);
}

static void segments_are_shared_out(void)
{
    struct rig made;
    struct fixture box;
    dpt_world_def def = small_def();
    if (!fixture_from_shape(&box, "box", 12))
        return;
    dpt_segment many[7];
    for (int i = 0; i < 7; i++)
        many[i] = capsule(i, 0, 1, i, 0, 2, 0);
    dpt_tool a, b, d;
    dpt_hit before = DPT_HIT_INIT, after = DPT_HIT_INIT;
    rig_open(&made, &def, box.mesh, NULL, 0);
    CHECK(dpt_tool_add(made.world, many, 7, &a) == DPT_E_FULL, "seven in six");
    CHECK(dpt_tool_add(made.world, many, 0, &a) == DPT_E_ARGUMENT, "none");
    a = rig_add_tool(&made, many, 2);
    b = rig_add_tool(&made, many + 2, 3);
    rig_add_tool(&made, many + 5, 1);
    CHECK(dpt_tool_add(made.world, many, 1, &d) == DPT_E_FULL, "four tools in three");
    rig_tick(&made);
    dpt_tool_get_segment_hit(made.world, b, 1, &before);
    CHECK(dpt_tool_remove(made.world, a) == DPT_OK, "remove a");
    rig_tick(&made);
    dpt_tool_get_segment_hit(made.world, b, 1, &after);
    after.work = before.work;
    CHECK(!memcmp(&before, &after, sizeof before), "b's answer moved with its memory");
    CHECK(dpt_tool_get_segment_hit(made.world, b, 3, &after) == DPT_E_ARGUMENT, "no such segment");
    a = rig_add_tool(&made, many, 2);
    dpt_tool_get_hit(made.world, a, &after);
    CHECK(after.status == DPT_STATUS_STALE, "a new tool knows something");
    rig_close(&made);
    fixture_free(&box);
}

/* Two boxes that move, a rigid tool of three segments that turns: the least of all stateless answers. */
static void many_bodies_and_segments(void)
{
    struct fixture mesh[2];
    struct rig made;
    dpt_world_def def = small_def();
    dpt_body body[2];
    if (!fixture_from_shape(&mesh[0], "torus", 2000) || !fixture_from_shape(&mesh[1], "star", 2000))
        return;
    const dpt_segment parts[3] = { capsule(0, 0, 0, 0.1, 0, 0, 0.002), capsule(0.1, 0, 0, 0.15, 0.03, 0, 0.001),
                                   capsule(0.1, 0, 0, 0.15, -0.03, 0, 0.004) };
    rig_open(&made, &def, NULL, parts, 3);
    for (int i = 0; i < 2; i++)
        body[i] = rig_add_body(&made, mesh[i].mesh, NULL);
    int asked[2] = { 0, 0 };
    for (int tick = 0; tick < 3000; tick++) {
        double t = 1e-3 * tick, angle = 2.0 * t;
        dpt_pose pose[2] = { { { 0.2 * sin(t), 0.1, 0 }, { cos(t), 0, sin(t), 0 } },
                             { { -0.2, 0.3 * sin(0.7 * t), 0 }, { cos(angle), sin(angle), 0, 0 } } };
        dpt_pose at = { { 0.15 * cos(3.0 * t), 0.1 * sin(5.0 * t), 0.1 * sin(t) }, { cos(t), 0, 0, sin(t) } };
        dpt_step out = { .size = sizeof out };
        for (int i = 0; i < 2; i++)
            dpt_body_set_pose(made.world, body[i], &pose[i]);
        dpt_tool_set_pose(made.world, made.tool, &at);
        CHECK(dpt_world_step(made.world, 1e-3, &out) == DPT_OK, "step");
        double least = HUGE_VAL, c = cos(2.0 * t), s = sin(2.0 * t);
        for (uint32_t k = 0; k < 3; k++) {
            dpt_hit hit = DPT_HIT_INIT, one[2] = { DPT_HIT_INIT, DPT_HIT_INIT };
            const double *a = parts[k].a, *b = parts[k].b;
            double ends[6] = {
                at.position[0] + c * a[0] - s * a[1], at.position[1] + s * a[0] + c * a[1], at.position[2] + a[2],
                at.position[0] + c * b[0] - s * b[1], at.position[1] + s * b[0] + c * b[1], at.position[2] + b[2]
            };
            for (int i = 0; i < 2; i++)
                dpt_query_segments(mesh[i].mesh, &pose[i], ends, NULL, 1, &one[i], NULL);
            double expected = fmin(one[0].distance, one[1].distance);
            dpt_tool_get_segment_hit(made.world, made.tool, k, &hit);
            CHECK(fabs(hit.distance - expected) <= 2.0 * hit.error_bound, "off by %g", hit.distance - expected);
            CHECK(hit.segment == k, "segment %u", hit.segment);
            asked[hit.body == body[1]]++;
            least = fmin(least, hit.distance - parts[k].radius);
        }
        dpt_hit best = DPT_HIT_INIT;
        dpt_tool_get_hit(made.world, made.tool, &best);
        CHECK(best.distance - parts[best.segment].radius == least, "not the nearest segment");
        CHECK(out.status == DPT_STATUS_EXACT, "status %u", out.status);
    }
    CHECK(asked[0] > 500 && asked[1] > 500, "nearest %d and %d times", asked[0], asked[1]);
    rig_close(&made);
    fixture_free(&mesh[0]);
    fixture_free(&mesh[1]);
}

static void a_step_goes_as_far_as_asked(void)
{
    struct fixture box;
    if (!fixture_from_shape(&box, "box", 12))
        return;
    for (uint32_t until = 0; until <= DPT_UNTIL_CONTACT; until++) {
        struct rig made;
        dpt_world_def def = small_def();
        dpt_hit hit = DPT_HIT_INIT;
        dpt_wrench wrench;
        dpt_segment part = capsule(0, 0, 0, 0.01, 0, 0, 0.01);
        def.until = until;
        rig_open(&made, &def, box.mesh, &part, 1);
        rig_tick(&made);
        dpt_tool_get_hit(made.world, made.tool, &hit);
        dpt_tool_get_wrench(made.world, made.tool, &wrench);
        double force = fabs(wrench.force[0]) + fabs(wrench.force[1]) + fabs(wrench.force[2]);
        CHECK(hit.status == DPT_STATUS_EXACT, "until %u", until);
        dpt_segment through = capsule(-1, 0.001, 0.002, 1, 0.002, 0.001, 0);
        dpt_tool_set_segments(made.world, made.tool, &through, 1);
        rig_tick(&made);
        dpt_hit crossing = DPT_HIT_INIT;
        dpt_tool_get_hit(made.world, made.tool, &crossing);
        CHECK(crossing.distance == 0.0 && (crossing.flags & DPT_HIT_FLAG_CROSSING), "until %u: crossing", until);
        CHECK((hit.flags & DPT_HIT_FLAG_GAP) == (until == DPT_UNTIL_TRACK ? 0 : DPT_HIT_FLAG_GAP), "gap");
        CHECK((force > 0.0) == (until == DPT_UNTIL_RESPOND), "force %g", force);
        rig_close(&made);
    }
    fixture_free(&box);
}

/* Along an edge two triangles are as near: the one of last tick stays. */
static void history_keeps_the_triangle(void)
{
    const double vertices[] = { 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0 };
    const uint32_t corners[] = { 0, 1, 2, 0, 2, 3 };
    struct fixture square;
    struct rig made;
    dpt_world_def def = small_def();
    dpt_segment part = capsule(0, 0, 0, 0, 0, 0, 0);
    dpt_hit hit = DPT_HIT_INIT;
    if (!fixture_from_arrays(&square, vertices, 4, corners, 2))
        return;
    rig_open(&made, &def, square.mesh, &part, 1);
    const struct {
        double x, y;
        uint32_t triangle;
    } ticks[] = {
        { 0.5, 0.5, 0 }, { 0.4, 0.6, 1 }, { 0.5, 0.5, 1 }, { 0.2, 0.2, 1 }, { 0.7, 0.3, 0 }, { 0.5, 0.5, 0 }
    };
    for (size_t i = 0; i < sizeof ticks / sizeof *ticks; i++) {
        dpt_pose pose = { { ticks[i].x, ticks[i].y, 0.25 }, { 1, 0, 0, 0 } };
        rig_step_to(&made, &pose);
        dpt_tool_get_hit(made.world, made.tool, &hit);
        CHECK(hit.triangle == ticks[i].triangle, "tick %zu: triangle %u", i, hit.triangle);
    }
    dpt_pose pose = { { 0.5, 0.5, 0.25 }, { 1, 0, 0, 0 } }, side = pose;
    side.position[0] = 0.4;
    rig_step_to(&made, &side);
    dpt_tool_teleport(made.world, made.tool, &pose);
    rig_tick(&made);
    dpt_tool_get_hit(made.world, made.tool, &hit);
    CHECK(hit.triangle == 0, "a teleport remembers triangle %u", hit.triangle);
    rig_close(&made);
    fixture_free(&square);
}

/* Two bodies in the same place are as near: the one that answered first stays. */
static void equal_bodies_do_not_rattle(void)
{
    struct fixture box;
    struct rig made;
    dpt_world_def def = small_def();
    dpt_body body[2];
    dpt_hit hit = DPT_HIT_INIT;
    if (!fixture_from_shape(&box, "box", 12))
        return;
    dpt_segment part = capsule(0.2, 0, 0, 0.3, 0, 0, 0);
    rig_open(&made, &def, NULL, &part, 1);
    body[0] = rig_add_body(&made, box.mesh, NULL);
    body[1] = rig_add_body(&made, box.mesh, NULL);
    for (int tick = 0; tick < 10; tick++) {
        rig_tick(&made);
        dpt_tool_get_hit(made.world, made.tool, &hit);
        CHECK(hit.body == body[0], "tick %d", tick);
    }
    dpt_pose away = { { -1, 0, 0 }, { 1, 0, 0, 0 } };
    dpt_body_set_pose(made.world, body[0], &away);
    rig_tick(&made);
    dpt_body_set_pose(made.world, body[0], &(dpt_pose)DPT_POSE_IDENTITY);
    rig_tick(&made);
    dpt_tool_get_hit(made.world, made.tool, &hit);
    CHECK(hit.body == body[1], "the second one answered last");
    rig_close(&made);
    fixture_free(&box);
}

int main(void)
{
    TEST(memory_is_what_it_says);
    TEST(defs_are_checked);
    TEST(ids_die_with_their_things);
    TEST(slots_are_used_for_ever);
    TEST(segments_are_shared_out);
    TEST(many_bodies_and_segments);
    TEST(a_step_goes_as_far_as_asked);
    TEST(history_keeps_the_triangle);
    TEST(equal_bodies_do_not_rattle);
    return check_report();
}
