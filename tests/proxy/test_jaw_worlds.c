/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Jaws in a world: calls that are refused, tools that come and go, budgets, rest, kernels, snapshots. Oracles: closed forms
 * on a flat sheet, and the same world again.
 *
 *     test_jaw_worlds
 */
#include "proxy/jaw_rig.h"

/* What contacts are held apart by, at most: 2e-6 of the largest body, up to 1 m. */
#define CLEARANCE 2e-6

static void what_cannot_be_is_refused(void)
{
    struct jaws jaws;
    dpt_pose pose = DPT_POSE_IDENTITY, bad = pose;
    jaws_open(&jaws, NULL, jaw_sheet.mesh, 0);
    stand_at_rim(&jaws, 0, 0.3);
    dpt_world *world = jaws.rig.world;
    const dpt_tool tool = jaws.rig.tool;
    CHECK(dpt_tool_set_tip_pose(NULL, tool, 0, &pose) == DPT_E_ARGUMENT, "no world");
    CHECK(dpt_tool_set_tip_pose(world, 0, 0, &pose) == DPT_E_HANDLE, "no tool");
    CHECK(dpt_tool_set_tip_pose(world, tool, 2, &pose) == DPT_E_ARGUMENT, "no third tip");
    CHECK(dpt_tool_set_tip_pose(world, tool, 0, NULL) == DPT_E_ARGUMENT, "no pose");
    bad.orientation[0] = 1.1;
    CHECK(dpt_tool_set_tip_pose(world, tool, 0, &bad) == DPT_E_POSE, "no turn");
    bad = pose;
    bad.position[1] = NAN;
    CHECK(dpt_tool_set_tip_pose(world, tool, 0, &bad) == DPT_E_FINITE, "no number");
    CHECK(dpt_tool_get_tip_pose(NULL, tool, 0, &pose) == DPT_E_ARGUMENT, "no world");
    CHECK(dpt_tool_get_tip_pose(world, 0, 0, &pose) == DPT_E_HANDLE, "no tool");
    CHECK(dpt_tool_get_tip_pose(world, tool, 2, &pose) == DPT_E_ARGUMENT, "no third tip");
    CHECK(dpt_tool_get_tip_pose(world, tool, 0, NULL) == DPT_E_ARGUMENT, "nowhere to write");
    rig_step(&jaws.rig);
    CHECK(jaw_is_there(&jaws, 0) && jaw_is_there(&jaws, 1), "a jaw went elsewhere");
    const dpt_tip with_bad = { .size = sizeof with_bad, .hull = jaws.hulls[0], .pose = &bad };
    CHECK(dpt_tool_set_tips(world, tool, &with_bad, 1) == DPT_E_FINITE, "given at no pose");
    CHECK(jaw_is_there(&jaws, 1), "the tips that it has are gone");
    rig_close(&jaws.rig);
}

/* FNV-1a */
static uint64_t mixed(uint64_t hash, const void *bytes, size_t size)
{
    for (size_t i = 0; i < size; i++)
        hash = (hash ^ ((const unsigned char *)bytes)[i]) * 0x100000001b3;
    return hash;
}

static uint64_t run_of(const dpt_world_def *def, long *wrong)
{
    struct jaws jaws;
    uint64_t hash = 0xcbf29ce484222325;
    jaws_open(&jaws, def, jaw_sheet.mesh, 0.0002);
    stand_at_rim(&jaws, 0.01, 0.4);
    for (int tick = 0; tick < 300; tick++) {
        jaws_want(&jaws, fmax(0, 0.4 - 0.004 * tick));
        jaws.rig.device.position[2] = 1e-3 * sin(0.05 * tick);
        rig_step(&jaws.rig);
        *wrong += jaws_passed(&jaws) > 0;
        for (int j = 0; j < 2; j++) {
            const dpt_pose pose = jaw_pose(&jaws, j);
            hash = mixed(hash, &pose, sizeof pose);
        }
        hash = mixed(hash, &jaws.rig.proxy, sizeof jaws.rig.proxy);
        hash = mixed(hash, &jaws.rig.force.wrench, sizeof jaws.rig.force.wrench);
    }
    rig_close(&jaws.rig);
    return hash;
}

static void the_same_bits(void)
{
    long wrong = 0;
    dpt_world_def def = rig_def(DPT_LAW_PROXY);
    const uint64_t first = run_of(&def, &wrong);
    def.kernel = DPT_KERNEL_SCALAR;
    CHECK(run_of(&def, &wrong) == first && wrong == 0, "other bits, or %ld are through", wrong);
}

/* Whatever the budget leaves undone: no jaw is through, and in the end both are closed. */
static void budgets_let_nothing_through(void)
{
    const struct oracle_triangles triangles = tip_triangles(&jaw_sheet);
    static const uint32_t budgets[] = { 1, 10, 40, 100, 300, 1000 };
    for (size_t b = 0; b < sizeof budgets / sizeof *budgets; b++) {
        struct jaws jaws;
        dpt_world_def def = rig_def(DPT_LAW_PROXY);
        def.budget = budgets[b];
        long wrong = 0;
        jaws_open(&jaws, &def, jaw_sheet.mesh, 0);
        stand_at_rim(&jaws, 0, 0.5);
        for (int tick = 0; tick < 60; tick++)
            rig_step(&jaws.rig);
        for (int tick = 0; tick < 400; tick++) {
            jaws_want(&jaws, tick < 2 ? 0.25 : 0);
            rig_step(&jaws.rig);
            wrong += jaws.rig.force.reason != DPT_FORCE_INSIDE && jaws.rig.force.reason != DPT_FORCE_UNDECIDED &&
                     jaws_passed(&jaws) > 0;
        }
        const double gap = jaw_gap(&jaws, 0, &triangles, 0.2).upper;
        CHECK(wrong == 0 && (def.budget < 300 || gap < CLEARANCE), "budget %u: %ld are through, gap %g", def.budget,
              wrong, gap);
        rig_close(&jaws.rig);
    }
    free((void *)triangles.corners);
}

/* Jaws that are closed on a sheet rest; a snapshot has their edges where they are. */
static void jaws_rest_and_are_seen(void)
{
    struct jaws jaws;
    jaws_open(&jaws, NULL, jaw_sheet.mesh, 0);
    stand_at_rim(&jaws, 0, 0.3);
    jaws_want(&jaws, 0);
    for (int tick = 0; tick < 60; tick++)
        rig_step(&jaws.rig);
    rig_step(&jaws.rig);
    CHECK(jaws.rig.step.work == 0, "work %u", jaws.rig.step.work);
    jaws_want(&jaws, 0.2);
    rig_step(&jaws.rig);
    const size_t room = dpt_snapshot_bytes(jaws.rig.world, NULL);
    void *block = malloc(room);
    size_t bytes;
    dpt_snapshot_tool tool = { .size = sizeof tool };
    CHECK(dpt_world_take_snapshot(jaws.rig.world, NULL, block, room, &bytes) == DPT_OK &&
              dpt_snapshot_get_tool(block, bytes, 0, &tool) == DPT_OK && tool.segments == 25,
          "%u segments", tool.segments);
    double highest = 0, lowest = 0;
    for (uint32_t i = 0; i < tool.segments; i++) {
        dpt_snapshot_segment segment = { .size = sizeof segment };
        dpt_snapshot_get_segment(block, bytes, tool.first_segment + i, &segment);
        highest = fmax(highest, segment.a[2]);
        lowest = fmin(lowest, segment.b[2]);
    }
    const double far = JAW_LENGTH * sin(0.2) + JAW_HEIGHT * cos(0.2);
    CHECK(fabs(highest - far) < 1e-9 && fabs(lowest + far) < 1e-9, "%g to %g, not %g", lowest, highest, far);
    free(block);
    rig_close(&jaws.rig);
}

/* The tips of a later tool move up when one is removed: each stays where it is in its tool. */
static void tools_keep_their_jaws(void)
{
    struct jaws first, second;
    dpt_tool other;
    dpt_hit hit = DPT_HIT_INIT;
    jaws_open(&first, NULL, jaw_sheet.mesh, 0);
    stand_at_rim(&first, 0, 0.3);
    dpt_tool_add(first.rig.world, &rig_point, 1, &other);
    second = first;
    second.rig.tool = other;
    jaws_give(&second, 0);
    second.rig.device.position[2] = 0.1;
    dpt_tool_teleport(first.rig.world, other, &second.rig.device);
    jaws_want(&second, 0.5);
    dpt_world_step(first.rig.world, RIG_DT, NULL);
    dpt_tool_remove(first.rig.world, first.rig.tool);
    dpt_tool_add(first.rig.world, &rig_point, 1, &first.rig.tool);
    jaws_give(&first, 0);
    jaws_want(&first, -0.7);
    second.rig.device.position[2] = 0.09;
    dpt_tool_set_pose(first.rig.world, other, &second.rig.device);
    dpt_world_step(first.rig.world, RIG_DT, NULL);
    dpt_tool_get_segment_hit(first.rig.world, other, 2, &hit);
    const double low = 0.09 - JAW_LENGTH * sin(0.5) - JAW_HEIGHT * cos(0.5);
    CHECK(jaw_is_there(&second, 0) && jaw_is_there(&second, 1) && fabs(hit.distance - low) < 1e-9, "%g, not %g",
          hit.distance, low);
    rig_close(&first.rig);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    if (!jaw_sheet_open())
        return check_report();
    TEST(what_cannot_be_is_refused);
    TEST(the_same_bits);
    TEST(budgets_let_nothing_through);
    TEST(jaws_rest_and_are_seen);
    TEST(tools_keep_their_jaws);
    solid_close(&jaw_sheet);
    return check_report();
}
