/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What happens to a proxy when its world changes under it: bodies are added, removed, teleported and jump, tools
 * turn and change their law, input is missing for some ticks. Oracles: closed forms on boxes, and a brute force over
 * all triangles of all bodies. It cannot judge what lies between two ticks.
 *
 *     test_proxy_faults [PER CENT of the random cases = 100]
 */
#include "lib/rig.h"
#include "lib/solid.h"

static const dpt_segment needle = { { 0, 0, 0 }, { 0, 0, 0.08 }, 0.002 };
static const dpt_segment tip = { { 0, 0, 0 }, { 0, 0, 0.01 }, 0.002 };

/* Box of `dynpoint make`: 0.12 x 0.10 x 0.08 m. Its top is at 0.04. */
#define TOP 0.04

/* The needle's end is pressed `depth` into the top of the rig's box. */
static void press(struct rig *rig, double depth)
{
    rig->device.position[2] = TOP + needle.radius + 0.001;
    rig_place(rig);
    while (rig->device.position[2] > TOP + needle.radius - depth + 5e-5) {
        rig->device.position[2] -= 1e-4;
        rig_step(rig);
    }
}

/*
 * A body in the slot of one that was removed has other triangles. Those that were near are not asked of it, also
 * where a third body moves near in the same tick, so that constraints are gathered before the search.
 */
static void a_reused_slot_has_no_old_triangles(void)
{
    struct solid large, small;
    dpt_world_def def = rig_def(DPT_LAW_PROXY);
    if (!solid_from_shape(&large, "sphere", 20480) || !solid_from_shape(&small, "box", 12))
        return;
    def.max_bodies = 2;
    for (int turn = 0; turn < 20; turn++) {
        struct rig rig;
        dpt_body mover, made;
        dpt_pose pose = DPT_POSE_IDENTITY;
        rig_open(&rig, &def, large.mesh, &needle, 1);
        pose.position[0] = 0.25;
        dpt_body_add(rig.world, small.mesh, &pose, &mover);
        pose_orient(&rig.device, (const double[3]){ 1, 0, 0 }, 0.3 * turn);
        turn3(rig.device.orientation, (const double[3]){ 0, 0, 0.103 }, rig.device.position);
        rig_place(&rig);
        CHECK(rig.force.reason == DPT_FORCE_FREE, "turn %d: reason %u", turn, rig.force.reason);
        dpt_body_remove(rig.world, rig.body);
        dpt_body_add(rig.world, small.mesh, NULL, &made);
        pose.position[0] = 0.24;
        dpt_body_set_pose(rig.world, mover, &pose);
        rig_step(&rig);
        const double away = apart(rig.device.position, rig.proxy.position);
        CHECK(away == 0 && rig.force.reason == DPT_FORCE_FREE, "turn %d: %g m away, reason %u", turn, away,
              rig.force.reason);
        rig_close(&rig);
    }
    solid_close(&large);
    solid_close(&small);
}

/* A body that appears round a proxy is one in which the tool begins: no force until it was outside. */
static void a_body_that_appears_round_it_is_not_felt(void)
{
    struct solid box;
    if (!solid_from_shape(&box, "box", 300))
        return;
    for (int teleports = 0; teleports < 2; teleports++) {
        struct rig rig;
        dpt_body made;
        const dpt_pose here = DPT_POSE_IDENTITY;
        dpt_pose away = here;
        away.position[0] = 1;
        rig_open(&rig, NULL, NULL, &tip, 1);
        if (teleports)
            dpt_body_add(rig.world, box.mesh, &away, &made);
        rig.device.position[2] = -0.005;
        rig_place(&rig);
        CHECK(rig.force.reason == DPT_FORCE_FREE, "reason %u", rig.force.reason);
        if (teleports)
            dpt_body_teleport(rig.world, made, &here);
        else
            dpt_body_add(rig.world, box.mesh, NULL, &made);
        for (int i = 0; i < 400; i++) {
            rig.device.position[0] += 5e-4;
            rig_step(&rig);
            CHECK(rig_force(&rig) == 0, "tick %d: %g N", i, rig_force(&rig));
        }
        CHECK(rig.force.reason == DPT_FORCE_FREE, "outside: reason %u", rig.force.reason);
        for (int i = 0; i < 290; i++) {
            rig.device.position[0] -= 5e-4;
            rig_step(&rig);
        }
        CHECK(rig.force.reason == DPT_FORCE_ACTS && rig.force.wrench.force[0] > 0, "back at it: reason %u, %g N",
              rig.force.reason, rig.force.wrench.force[0]);
        rig_close(&rig);
    }
    solid_close(&box);
}

/* One that appears elsewhere changes nothing, also where it is large, and the ticks are short. */
static void a_body_that_appears_elsewhere_changes_nothing(void)
{
    struct solid box, huge;
    struct rig rig;
    dpt_body made;
    const double corners[] = { 0, 0, -500, 1000, 0, -500, 0, 1000, -500, 1000, 1000, -501 };
    const uint32_t numbers[] = { 0, 1, 2, 1, 3, 2 };
    if (!solid_from_shape(&box, "box", 300) || !solid_from_arrays(&huge, "huge", corners, 4, numbers, 2))
        return;
    rig_open(&rig, NULL, box.mesh, &needle, 1);
    press(&rig, 0.002);
    const double force = rig_force(&rig);
    dpt_body_add(rig.world, huge.mesh, NULL, &made);
    for (int i = 0; i < 20; i++) {
        dpt_tool_set_pose(rig.world, rig.tool, &rig.device);
        dpt_world_step(rig.world, 1e-5, NULL);
    }
    rig_step(&rig);
    CHECK(rig.force.reason == DPT_FORCE_ACTS && fabs(rig_force(&rig) - force) < 1e-3 * force,
          "%g N before, %g N after, reason %u", force, rig_force(&rig), rig.force.reason);
    /* And it still follows. */
    for (int i = 0; i < 100; i++) {
        rig.device.position[0] += 1e-4;
        rig_step(&rig);
    }
    CHECK(fabs(rig.proxy.position[0] - rig.device.position[0]) < 1e-5, "stuck at %g, device at %g",
          rig.proxy.position[0], rig.device.position[0]);
    rig_close(&rig);
    solid_close(&box);
    solid_close(&huge);
}

/*
 * What moves while the tool or another body has no valid pose may come to be where the proxy is: then it is not felt.
 */
static void bodies_that_move_unseen_are_not_entered(void)
{
    struct solid box;
    if (!solid_from_shape(&box, "box", 300))
        return;
    for (int of_body = 0; of_body < 2; of_body++) {
        struct rig rig;
        dpt_body other;
        dpt_pose pose = DPT_POSE_IDENTITY, far = DPT_POSE_IDENTITY;
        rig_open(&rig, NULL, box.mesh, &tip, 1);
        far.position[0] = 5;
        dpt_body_add(rig.world, box.mesh, &far, &other);
        rig.device.position[2] = 0.1;
        rig_place(&rig);
        if (of_body)
            dpt_body_set_pose(rig.world, other, NULL);
        for (int i = 0; i < 10; i++) {
            if (!of_body)
                dpt_tool_set_pose(rig.world, rig.tool, NULL);
            pose.position[2] = 0.01 * (i + 1);
            dpt_body_set_pose(rig.world, rig.body, &pose);
            dpt_world_step(rig.world, RIG_DT, &rig.step);
            dpt_tool_get_force_info(rig.world, rig.tool, &rig.force);
            CHECK(rig.force.reason == DPT_FORCE_STALE && rig_force(&rig) == 0, "reason %u", rig.force.reason);
        }
        dpt_body_set_pose(rig.world, other, &far);
        for (int i = 0; i < 400; i++) {
            rig.device.position[0] += 5e-4;
            rig_step(&rig);
            CHECK(rig_force(&rig) == 0, "%d, tick %d: %g N", of_body, i, rig_force(&rig));
        }
        CHECK(rig.force.reason == DPT_FORCE_FREE, "outside: reason %u", rig.force.reason);
        rig_close(&rig);
    }
    solid_close(&box);
}

/* Input that is missing for some ticks loses no contact where bodies rest. */
static void missing_input_loses_no_contact(void)
{
    struct solid box;
    struct rig rig;
    if (!solid_from_shape(&box, "box", 300))
        return;
    rig_open(&rig, NULL, box.mesh, &needle, 1);
    press(&rig, 0.003);
    const double force = rig_force(&rig);
    for (int i = 0; i < 5; i++) {
        dpt_tool_set_pose(rig.world, rig.tool, NULL);
        dpt_world_step(rig.world, RIG_DT, NULL);
        dpt_tool_get_force_info(rig.world, rig.tool, &rig.force);
        CHECK(rig.force.reason == DPT_FORCE_STALE && rig_force(&rig) == 0, "reason %u", rig.force.reason);
    }
    rig_step(&rig);
    CHECK(rig.force.reason == DPT_FORCE_ACTS && fabs(rig_force(&rig) - force) < 1e-3 * force, "%g N before, %g N after",
          force, rig_force(&rig));
    rig_close(&rig);
    solid_close(&box);
}

/* A change of the law is a teleport to where the tool is: the other law's answer is that of a new tool there. */
static void another_law_begins_at_the_device(void)
{
    struct solid box;
    struct rig rig;
    if (!solid_from_shape(&box, "box", 300))
        return;
    rig_open(&rig, NULL, box.mesh, &needle, 1);
    press(&rig, 0.003);
    dpt_tool_settings settings = { .size = sizeof settings };
    dpt_tool_get_settings(rig.world, rig.tool, &settings);
    settings.law = DPT_LAW_POINT;
    dpt_tool_set_settings(rig.world, rig.tool, &settings);
    for (int i = 0; i < 3; i++) {
        dpt_hit hit = DPT_HIT_INIT;
        dpt_world_step(rig.world, RIG_DT, NULL);
        dpt_tool_get_force_info(rig.world, rig.tool, &rig.force);
        dpt_tool_get_hit(rig.world, rig.tool, &hit);
        CHECK(fabs(rig_force(&rig) - RIG_STIFFNESS * 0.003) < 0.1 && fabs(hit.depth - 0.003) < 2e-4,
              "tick %d: %g N, %g m deep", i, rig_force(&rig), hit.depth);
    }
    settings.law = DPT_LAW_PROXY;
    dpt_tool_set_settings(rig.world, rig.tool, &settings);
    for (int i = 0; i < 3; i++) {
        dpt_world_step(rig.world, RIG_DT, NULL);
        dpt_tool_get_force_info(rig.world, rig.tool, &rig.force);
        CHECK(rig.force.reason == DPT_FORCE_INSIDE && rig_force(&rig) == 0, "reason %u, %g N", rig.force.reason,
              rig_force(&rig));
    }
    rig_close(&rig);
    solid_close(&box);
}

/* Without the body that held it, the proxy goes to its device at the speed of a fold, and the force ends. */
static void a_removed_body_ends_its_force(void)
{
    struct solid box;
    struct rig rig;
    if (!solid_from_shape(&box, "box", 300))
        return;
    rig_open(&rig, NULL, box.mesh, &needle, 1);
    press(&rig, 0.005);
    dpt_body_remove(rig.world, rig.body);
    double last = rig_force(&rig);
    for (int i = 0; i < 8; i++) {
        rig_step(&rig);
        CHECK(rig_force(&rig) <= fmax(0, last - 0.9 * RIG_STIFFNESS * RIG_DT), "tick %d: %g N", i, rig_force(&rig));
        last = rig_force(&rig);
    }
    CHECK(rig.force.reason == DPT_FORCE_FREE && !memcmp(&rig.proxy, &rig.device, sizeof rig.proxy), "reason %u, %g N",
          rig.force.reason, last);
    rig_close(&rig);
    solid_close(&box);
}

/* In the open it is the device, bit for bit: however fast that turns, and where it turns about its own axis alone. */
static void in_the_open_every_turn_is_followed(void)
{
    const dpt_segment dumbbell[2] = { { { 0, 0, -0.05 }, { 0, 0, -0.05 }, 0.003 },
                                      { { 0, 0, 0.05 }, { 0, 0, 0.05 }, 0.003 } };
    const dpt_segment bent[2] = { { { 0, 0, 0 }, { 0, 0, 0.04 }, 0.002 }, { { 0, 0, 0 }, { 0.02, 0, -0.01 }, 0.001 } };
    const dpt_segment ball = { { 0, 0, 0 }, { 0, 0, 0 }, 0.003 };
    const struct {
        const dpt_segment *segments;
        uint32_t count;
    } tools[] = { { &needle, 1 }, { dumbbell, 2 }, { bent, 2 }, { &ball, 1 } };
    struct solid box;
    uint64_t seed = 7;
    if (!solid_from_shape(&box, "box", 300))
        return;
    for (size_t t = 0; t < sizeof tools / sizeof *tools; t++) {
        struct rig rig;
        rig_open(&rig, NULL, box.mesh, tools[t].segments, tools[t].count);
        rig.device.position[2] = 1;
        rig_place(&rig);
        for (int i = 0; i < 200; i++) {
            double axis[3] = { 0, 0, 1 };
            if (i > 20)
                random_unit(&seed, axis);
            pose_orient(&rig.device, axis, i < 20 ? 0.01 * i : random_in(&seed, -3.1, 3.1));
            rig_step(&rig);
            CHECK(!memcmp(&rig.proxy, &rig.device, sizeof rig.proxy), "tool %zu, tick %d: the proxy lags", t, i);
            CHECK(rig.force.reason == DPT_FORCE_FREE && rig_force(&rig) == 0, "tool %zu, tick %d: %g N", t, i,
                  rig_force(&rig));
        }
        rig_close(&rig);
    }
    solid_close(&box);
}

/* Balls alone make a tool that turns: one end is pressed down, and is felt. */
static void balls_apart_are_a_tool_that_turns(void)
{
    const dpt_segment dumbbell[2] = { { { -0.03, 0, 0 }, { -0.03, 0, 0 }, 0.003 },
                                      { { 0.03, 0, 0 }, { 0.03, 0, 0 }, 0.003 } };
    struct solid box;
    struct rig rig;
    if (!solid_from_shape(&box, "box", 300))
        return;
    rig_open(&rig, NULL, box.mesh, dumbbell, 2);
    rig.device.position[2] = TOP + 0.004;
    rig_place(&rig);
    for (int i = 0; i < 100; i++) {
        pose_orient(&rig.device, (const double[3]){ 0, 1, 0 }, 1e-3 * i);
        rig_step(&rig);
        for (uint32_t s = 0; s < 2; s++) {
            double ends[6];
            rig_proxy_ends(&rig, s, ends);
            CHECK(ends[2] > TOP + 0.003, "tick %d: ball %u at %g", i, s, ends[2] - TOP);
        }
    }
    CHECK(rig.force.reason == DPT_FORCE_ACTS && rig_force(&rig) > 0.1, "reason %u, %g N", rig.force.reason,
          rig_force(&rig));
    rig_close(&rig);
    solid_close(&box);
}

/* A body that pushes a tool is no fold. */
static void a_push_is_no_fold(void)
{
    struct solid box;
    struct rig rig;
    dpt_pose pose = DPT_POSE_IDENTITY;
    if (!solid_from_shape(&box, "box", 300))
        return;
    rig_open(&rig, NULL, box.mesh, &needle, 1);
    rig.device.position[2] = TOP + needle.radius + 0.001;
    rig_place(&rig);
    for (int i = 0; i < 100; i++) {
        pose.position[2] += 1e-4;
        dpt_body_set_pose(rig.world, rig.body, &pose);
        rig_step(&rig);
    }
    CHECK(rig.force.folds == 0 && rig_force(&rig) > 4, "%llu folds, %g N", (unsigned long long)rig.force.folds,
          rig_force(&rig));
    rig_close(&rig);
    solid_close(&box);
}

/* A free segment may grow and a body may move in the same tick: neither enters the other. */
static void a_segment_that_grows_meets_a_body_that_moves(void)
{
    struct solid box;
    if (!solid_from_shape(&box, "box", 300))
        return;
    for (int i = 1; i < 20; i++) {
        struct rig rig;
        dpt_pose pose = DPT_POSE_IDENTITY;
        dpt_segment given = { { 0, 0, TOP + 0.012 }, { 0, 0, TOP + 0.1 }, 0.001 };
        rig_open(&rig, NULL, box.mesh, &given, 1);
        for (int k = 0; k < 2; k++) {
            dpt_tool_set_segments(rig.world, rig.tool, &given, 1);
            dpt_world_step(rig.world, RIG_DT, NULL);
        }
        given.radius = 0.001 + 0.0005 * i;
        pose.position[2] = 0.01 - 0.0005 * i + 0.002;
        dpt_tool_set_segments(rig.world, rig.tool, &given, 1);
        dpt_body_set_pose(rig.world, rig.body, &pose);
        dpt_world_step(rig.world, RIG_DT, NULL);
        dpt_tool_get_force_info(rig.world, rig.tool, &rig.force);
        CHECK(!(rig.force.flags & DPT_FORCE_FLAG_SQUEEZED) && rig.force.reason <= DPT_FORCE_FREE,
              "radius %g: reason %u, flags %u", given.radius, rig.force.reason, rig.force.flags);
        dpt_tool_get_proxy(rig.world, rig.tool, &rig.proxy);
        const double gap = rig.proxy.position[2] - TOP - pose.position[2] - given.radius;
        CHECK(gap > 0, "radius %g: gap %g", given.radius, gap);
        rig_close(&rig);
    }
    solid_close(&box);
}

/* A sheet that moves by any way a tick, and others, is not passed: the proxy stays on its side of it. */
static void sheets_that_move_fast_are_not_passed(void)
{
    enum { OTHERS = 8 };
    const double steps[] = { 1e-3, 1e-2, 5e-2, 0.2, 1 };
    struct solid sheet;
    if (!solid_from_shape(&sheet, "membrane", 512))
        return;
    for (int i = 0; i < 20; i++) {
        const double step = steps[i % 5];
        struct rig rig;
        dpt_pose pose = DPT_POSE_IDENTITY, far = DPT_POSE_IDENTITY;
        rig_open(&rig, NULL, sheet.mesh, i % 2 ? &needle : &tip, 1);
        far.position[0] = 3;
        for (int k = 0; k < OTHERS && i % 4 > 1; k++) {
            dpt_body other;
            far.position[1] = k;
            dpt_body_add(rig.world, sheet.mesh, &far, &other);
        }
        pose.position[2] = -0.5 * step;
        dpt_body_teleport(rig.world, rig.body, &pose);
        rig.device.position[2] = 0.4 * step + 0.003;
        rig_place(&rig);
        for (int k = 0; k < 3; k++) {
            pose.position[2] += step;
            dpt_body_set_pose(rig.world, rig.body, &pose);
            rig_step(&rig);
            const double gap = rig.proxy.position[2] - pose.position[2] - needle.radius;
            CHECK(gap > 0 && (k == 0 || rig.force.reason == DPT_FORCE_ACTS), "%g m a tick, tick %d: gap %g, reason %u",
                  step, k, gap, rig.force.reason);
        }
        /* And a device that jumps to the other side. */
        rig.device.position[2] = pose.position[2] - 3 * step - 0.2;
        rig_step(&rig);
        const double gap = rig.proxy.position[2] - pose.position[2] - needle.radius;
        CHECK(gap > 0, "%g m a tick: jumped through, gap %g", step, gap);
        rig_close(&rig);
    }
    solid_close(&sheet);
}

/*
 * Beside a floor, which is nearest, stands a wall. The device jumps through the wall, or the wall past the device: only a
 * sweep can tell.
 */
static void a_wall_that_is_not_nearest_is_not_passed(void)
{
    enum { OTHERS = 8 };
    struct solid sheet;
    if (!solid_from_shape(&sheet, "membrane", 512))
        return;
    for (int i = 0; i < 16; i++) {
        struct rig rig;
        dpt_body wall;
        dpt_pose pose = DPT_POSE_IDENTITY, far = DPT_POSE_IDENTITY;
        const double step = i % 4 == 0 ? 0.06 : i % 4 == 1 ? 0.075 : i % 4 == 2 ? 0.09 : 0.15;
        const int moves = i / 4 % 2, has_others = i / 8;
        rig_open(&rig, NULL, sheet.mesh, &needle, 1);
        pose_orient(&pose, (const double[3]){ 0, 1, 0 }, 0.5 * 3.14159265358979);
        pose.position[0] = 0.05;
        dpt_body_add(rig.world, sheet.mesh, &pose, &wall);
        far.position[0] = 3;
        for (int k = 0; k < OTHERS && has_others; k++) {
            dpt_body other;
            far.position[1] = k;
            dpt_body_add(rig.world, sheet.mesh, &far, &other);
        }
        rig.device.position[2] = 0.003;
        rig_place(&rig);
        rig_step(&rig);
        CHECK(rig.force.reason == DPT_FORCE_FREE, "reason %u", rig.force.reason);
        pose.position[0] -= moves ? step : 0;
        rig.device.position[0] += moves ? 0 : step;
        dpt_body_set_pose(rig.world, wall, &pose);
        for (int k = 0; k < 100; k++)
            rig_step(&rig);
        const double gap = pose.position[0] - rig.proxy.position[0] - needle.radius;
        CHECK(gap > 0 && gap < 1e-5 && rig.proxy.position[2] > needle.radius, "%s by %g: gap %g, at %g, reason %u",
              moves ? "the wall" : "the device", step, gap, rig.proxy.position[2], rig.force.reason);
        rig_close(&rig);
    }
    solid_close(&sheet);
}

/* Whatever stiffnesses are allowed: all numbers stay finite, and nothing is entered. */
static void extreme_stiffnesses_stay_finite(void)
{
    const double values[] = { 0, 5e-324, 1e-300, 1e-150, 1e-9, 1, 500, 1e9 };
    const size_t count = sizeof values / sizeof *values;
    struct solid box;
    if (!solid_from_shape(&box, "box", 300))
        return;
    for (size_t i = 0; i < count * count; i++) {
        struct rig rig;
        dpt_tool_settings settings = { .size = sizeof settings };
        rig_open(&rig, NULL, box.mesh, &needle, 1);
        dpt_tool_get_settings(rig.world, rig.tool, &settings);
        settings.stiffness = values[i / count];
        settings.rotational_stiffness = values[i % count];
        const dpt_result result = dpt_tool_set_settings(rig.world, rig.tool, &settings);
        CHECK(result == DPT_OK, "%s", dpt_result_name(result));
        pose_orient(&rig.device, (const double[3]){ 1, 0, 0 }, 0.5);
        press(&rig, 0.004);
        double ends[6];
        rig_proxy_ends(&rig, 0, ends);
        const double *f = rig.force.wrench.force, *t = rig.force.wrench.torque;
        const double sum = f[0] + f[1] + f[2] + t[0] + t[1] + t[2] + rig.force.energy + rig.force.lag +
                           rig.proxy.position[0] + rig.proxy.orientation[0];
        CHECK(isfinite(sum), "K %g, K_r %g: %g", settings.stiffness, settings.rotational_stiffness, sum);
        CHECK(ends[2] > TOP + needle.radius && ends[5] > TOP, "K %g, K_r %g: end at %g", settings.stiffness,
              settings.rotational_stiffness, ends[2] - TOP);
        rig_close(&rig);
    }
    solid_close(&box);
}

/* After a reset a world gives the same bits again, wherever it was. */
static void a_reset_world_repeats_itself(void)
{
    struct solid liver;
    struct rig rig;
    static dpt_force_info first[600];
    if (!solid_from_shape(&liver, "liver", 2000))
        return;
    rig_open(&rig, NULL, liver.mesh, &needle, 1);
    for (int turn = 0; turn < 3; turn++) {
        uint64_t seed = 5;
        dpt_world_reset(rig.world);
        dpt_tool_get_force_info(rig.world, rig.tool, &rig.force);
        CHECK(rig.force.reason == DPT_FORCE_STALE, "reason %u", rig.force.reason);
        pose_orient(&rig.device, (const double[3]){ 0, 1, 0 }, 0.4);
        rig.device.position[0] = rig.device.position[1] = 0.01;
        rig.device.position[2] = liver.place.high[2] + 0.01;
        uint64_t acts = 0;
        for (int i = 0; i < 600; i++) {
            rig.device.position[2] -= 1e-4;
            rig.device.position[0] += random_in(&seed, -1e-4, 2e-4);
            rig_step(&rig);
            acts += rig.force.reason == DPT_FORCE_ACTS;
            if (turn == 0)
                first[i] = rig.force;
            CHECK(!memcmp(&first[i], &rig.force, sizeof rig.force), "turn %d, tick %d differs", turn, i);
        }
        CHECK(acts > 100, "only %llu ticks with a force", (unsigned long long)acts);
    }
    rig_close(&rig);
    solid_close(&liver);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(a_reused_slot_has_no_old_triangles);
    TEST(a_body_that_appears_round_it_is_not_felt);
    TEST(a_body_that_appears_elsewhere_changes_nothing);
    TEST(bodies_that_move_unseen_are_not_entered);
    TEST(missing_input_loses_no_contact);
    TEST(another_law_begins_at_the_device);
    TEST(a_removed_body_ends_its_force);
    TEST(in_the_open_every_turn_is_followed);
    TEST(balls_apart_are_a_tool_that_turns);
    TEST(a_push_is_no_fold);
    TEST(a_segment_that_grows_meets_a_body_that_moves);
    TEST(sheets_that_move_fast_are_not_passed);
    TEST(a_wall_that_is_not_nearest_is_not_passed);
    TEST(extreme_stiffnesses_stay_finite);
    TEST(a_reset_world_repeats_itself);
    return check_report();
}
