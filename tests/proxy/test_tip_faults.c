/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Tips and bodies that appear, jump, come up and turn under them. Oracles: closed forms on flat faces, and a brute force
 * over all triangles (oracle/hull_surface.h). It cannot judge what lies between two ticks.
 *
 *     test_tip_faults [PER CENT of the random cases = 100]
 */
#include "proxy/tip_rig.h"

static const double plate[3] = { 0.02, 0.008, 0.001 }, blade[3] = { 0.02, 0.001, 0.006 };
static const double cube[3] = { 0.006, 0.006, 0.006 };

/* The top of the box of `dynpoint make`. */
#define TOP 0.04

static struct solid box;

/* A body that comes up takes the tip along; one that turns under it never enters it. */
static void moving_bodies_push_a_tip(void)
{
    const struct oracle_triangles triangles = tip_triangles(&box);
    uint64_t seed = 3;
    long looked = 0, met = 0;
    for (uint64_t run = 0; run < part_of(60); run++) {
        struct tip_rig tip;
        tip_rig_open(&tip, NULL, box.mesh, run % 2 ? DPT_HULL_KIND_BOX : DPT_HULL_KIND_WEDGE, run % 2 ? plate : blade,
                     run % 3 ? 0 : 0.0005);
        struct rig *rig = &tip.rig;
        double axis[3] = { random_in(&seed, -1, 1), random_in(&seed, -1, 1), random_in(&seed, -1, 1) };
        unit3(axis);
        pose_orient(&rig->device, axis, random_in(&seed, -0.5, 0.5));
        rig->device.position[2] = TOP + 0.02;
        rig_place(rig);
        dpt_pose body = DPT_POSE_IDENTITY;
        const double up = pow(10, random_in(&seed, -5, -3.3)), turn = random_in(&seed, -2e-3, 2e-3);
        for (int tick = 1; tick <= 120; tick++) {
            body.position[2] = tick * up;
            pose_orient(&body, axis, tick * turn);
            if (tick == 40)
                rig->device.position[2] = TOP + 0.005;
            dpt_body_set_pose(rig->world, rig->body, &body);
            rig_step(rig);
            if (tick % 8 || rig->force.reason != DPT_FORCE_ACTS ||
                (rig->force.flags & (DPT_FORCE_FLAG_SQUEEZED | DPT_FORCE_FLAG_REPLACED)))
                continue;
            /* The tool as the body sees it. */
            dpt_pose seen;
            const double back[4] = { body.orientation[0], -body.orientation[1], -body.orientation[2],
                                     -body.orientation[3] };
            pose_local(&body, rig->proxy.position, seen.position);
            turn_times(back, rig->proxy.orientation, seen.orientation);
            looked++;
            met += !(tip_rig_gap(&tip, &triangles, &seen, 0.01).lower >= 0);
        }
        rig_close(rig);
    }
    CHECK(looked >= (long)least_seen(200) && met == 0, "%ld of %ld meet", met, looked);
    free((void *)triangles.corners);
}

/*
 * A tip that is inside a body gives no force, though its segment is outside; not where it begins there, and not where it is
 * given to a tool that stands there. Once it has been outside it is felt.
 */
static void a_tip_that_begins_inside_is_not_felt(void)
{
    static const dpt_segment above = { { 0, 0, 0.05 }, { 0, 0, 0.06 }, 0.001 };
    for (int is_given = 0; is_given < 2; is_given++) {
        struct tip_rig tip;
        rig_open(&tip.rig, NULL, box.mesh, &above, 1);
        struct rig *rig = &tip.rig;
        if (!is_given)
            tip_rig_give(&tip, DPT_HULL_KIND_BOX, cube, 0);
        rig->device.position[2] = TOP - 0.02;
        rig_place(rig);
        if (is_given) {
            CHECK(rig->force.reason == DPT_FORCE_FREE, "reason %u", rig->force.reason);
            tip_rig_give(&tip, DPT_HULL_KIND_BOX, cube, 0);
        }
        for (int tick = 0; tick < 5; tick++) {
            rig->device.position[2] += 1e-4;
            rig_step(rig);
            CHECK(rig->force.reason == DPT_FORCE_INSIDE && rig_force(rig) == 0, "reason %u, %g N", rig->force.reason,
                  rig_force(rig));
        }
        rig->device.position[2] = TOP + 0.02;
        rig_step(rig);
        rig_step(rig);
        CHECK(rig->force.reason == DPT_FORCE_FREE, "outside: reason %u", rig->force.reason);
        while (rig->device.position[2] > TOP) {
            rig->device.position[2] -= 2e-4;
            rig_step(rig);
        }
        CHECK(rig->force.reason == DPT_FORCE_ACTS && rig->force.wrench.force[2] > 1, "pressed: reason %u, %g N",
              rig->force.reason, rig->force.wrench.force[2]);
        rig_close(rig);
    }
}

/* A body that jumps while the tool stands still: the next answers are of where it is. */
static void a_body_that_jumps_is_seen(void)
{
    struct tip_rig tip;
    tip_rig_open(&tip, NULL, box.mesh, DPT_HULL_KIND_BOX, plate, 0);
    struct rig *rig = &tip.rig;
    rig->device.position[2] = TOP + 0.01;
    rig_place(rig);
    for (int tick = 0; tick < 5; tick++) {
        dpt_pose body = DPT_POSE_IDENTITY;
        dpt_hit hit = DPT_HIT_INIT;
        const double down = 0.002 * tick;
        body.position[2] = -down;
        dpt_body_teleport(rig->world, rig->body, &body);
        rig_step(rig);
        dpt_tool_get_segment_hit(rig->world, rig->tool, 1, &hit);
        CHECK(fabs(hit.distance - (0.01 + down - plate[2] / 2)) < 1e-9, "%g m lower: %g", down, hit.distance);
    }
    for (int tick = 0; tick < 5; tick++) {
        dpt_pose body = DPT_POSE_IDENTITY;
        dpt_hit hit = DPT_HIT_INIT;
        body.position[2] = -0.01 - 0.001 * tick;
        dpt_body_set_pose(rig->world, rig->body, &body);
        rig_step(rig);
        dpt_tool_get_segment_hit(rig->world, rig->tool, 1, &hit);
        CHECK(fabs(hit.distance - (0.01 - body.position[2] - plate[2] / 2)) < 1e-9, "moved to %g: %g", body.position[2],
              hit.distance);
    }
    dpt_body_settings unfelt = { .size = sizeof unfelt };
    dpt_body_get_settings(rig->world, rig->body, &unfelt);
    unfelt.unfelt = 1;
    dpt_body_set_settings(rig->world, rig->body, &unfelt);
    rig_step(rig);
    dpt_hit hit = DPT_HIT_INIT;
    dpt_tool_get_segment_hit(rig->world, rig->tool, 1, &hit);
    CHECK(hit.status == DPT_STATUS_STALE, "status %u of no body", hit.status);
    rig_close(rig);
}

/* A body that appears round a tip that was outside: no force until it has been outside again, also not from inside. */
static void a_body_that_appears_round_a_tip_is_not_felt(void)
{
    static const dpt_segment above = { { 0, 0, 0.1 }, { 0, 0, 0.11 }, 0.001 };
    struct tip_rig tip;
    dpt_body made;
    rig_open(&tip.rig, NULL, NULL, &above, 1);
    tip_rig_give(&tip, DPT_HULL_KIND_BOX, cube, 0);
    struct rig *rig = &tip.rig;
    rig_place(rig);
    dpt_body_add(rig->world, box.mesh, NULL, &made);
    while (rig->device.position[2] < TOP + 0.01) {
        rig->device.position[2] += 5e-4;
        rig_step(rig);
        CHECK(rig->force.reason != DPT_FORCE_ACTS && rig_force(rig) == 0, "at %g: reason %u, %g N",
              rig->device.position[2], rig->force.reason, rig_force(rig));
    }
    CHECK(rig->force.reason == DPT_FORCE_FREE, "outside: reason %u", rig->force.reason);
    rig_close(rig);
}

/* The lowest corner of a tip above a height. */
static double lowest_over(const struct tip_rig *tip, double height)
{
    double corners[3 * ORACLE_CORNERS], lowest = HUGE_VAL;
    tip_rig_corners(tip, &tip->rig.proxy, corners);
    for (uint32_t c = 0; c < tip->as.corner_count; c++)
        lowest = fmin(lowest, corners[3 * c + 2] - height);
    return lowest;
}

/*
 * A sheet that comes up by as much as 0.2 m a tick takes a tip along, whether its body moves or its vertices do. It starts
 * below the tip and ends above where the device holds it. The tool's segment is beside the
 * sheet, and the tool does not turn: it would lie down, and start again.
 */
static void sheets_that_come_up_are_not_passed(void)
{
    static const double steps[] = { 1e-3, 1e-2, 5e-2, 0.2 };
    static const dpt_segment beside = { { 0.15, 0, 0 }, { 0.16, 0, 0 }, 0.001 };
    struct solid sheet;
    if (!solid_from_shape(&sheet, "membrane", 128))
        return;
    const float *rest;
    uint32_t vertices;
    dpt_mesh_get_vertices(sheet.mesh, &rest, &vertices);
    for (int i = 0; i < 8; i++) {
        const double step = steps[i / 2];
        const int is_soft = i % 2;
        struct tip_rig tip;
        dpt_pose pose = DPT_POSE_IDENTITY;
        dpt_body soft = 0;
        rig_open(&tip.rig, NULL, is_soft ? NULL : sheet.mesh, &beside, 1);
        tip_rig_give(&tip, DPT_HULL_KIND_WEDGE, blade, 0);
        struct rig *rig = &tip.rig;
        dpt_deformable_def def;
        dpt_deformable_def_init(&def);
        def.mesh = sheet.mesh;
        for (int k = 0; k < 3; k++) {
            def.box_min[k] = -1;
            def.box_max[k] = 1;
        }
        void *block = malloc(dpt_deformable_bytes(&def));
        float *at = malloc(3 * vertices * sizeof *at);
        memcpy(at, rest, 3 * vertices * sizeof *at);
        if (is_soft) {
            const dpt_result result =
                dpt_body_add_deformable(rig->world, block, dpt_deformable_bytes(&def), &def, &soft);
            CHECK(result == DPT_OK, "soft: %s", dpt_result_name(result));
        }
        dpt_tool_settings settings = { .size = sizeof settings };
        dpt_tool_get_settings(rig->world, rig->tool, &settings);
        settings.lock_rotation = 1;
        dpt_tool_set_settings(rig->world, rig->tool, &settings);
        pose_orient(&rig->device, (const double[3]){ 0.6, 0.8, 0 }, 0.2);
        rig->device.position[2] = 0.4 * step + 0.006;
        rig_place(rig);
        for (int tick = 1; tick <= 3; tick++) {
            const double height = tick * step;
            pose.position[2] = height;
            for (uint32_t v = 0; v < vertices; v++)
                at[3 * v + 2] = (float)height;
            if (is_soft)
                dpt_body_set_vertices(rig->world, soft, 0, vertices, at, -1.0);
            else
                dpt_body_set_pose(rig->world, rig->body, &pose);
            rig_step(rig);
            const double lowest = lowest_over(&tip, is_soft ? (double)(float)height : height);
            CHECK(lowest > 0 && (tick == 1 || rig->force.reason == DPT_FORCE_ACTS),
                  "soft %d, %g m a tick, tick %d: %g over it, reason %u, flags %u", is_soft, step, tick, lowest,
                  rig->force.reason, rig->force.flags);
        }
        rig_close(rig);
        free(block);
        free(at);
    }
    solid_close(&sheet);
}

/* Half a turn within a tick, whose ends would go through a sheet that both poses are far from. */
static void a_turn_through_a_sheet_is_not_free(void)
{
    struct solid sheet;
    struct tip_rig tip;
    if (!solid_from_shape(&sheet, "membrane", 512))
        return;
    tip_rig_open(&tip, NULL, sheet.mesh, DPT_HULL_KIND_BOX, plate, 0);
    struct rig *rig = &tip.rig;
    rig->device.position[2] = -0.006;
    rig_place(rig);
    pose_orient(&rig->device, (const double[3]){ 0, 1, 0 }, 3);
    rig_step(rig);
    CHECK(rig->force.reason == DPT_FORCE_ACTS || (rig->force.flags & DPT_FORCE_FLAG_REPLACED), "reason %u, flags %u",
          rig->force.reason, rig->force.flags);
    rig_close(rig);
    solid_close(&sheet);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    if (!solid_from_shape(&box, "box", 300))
        return check_report();
    TEST(a_tip_that_begins_inside_is_not_felt);
    TEST(a_body_that_jumps_is_seen);
    TEST(a_turn_through_a_sheet_is_not_free);
    TEST(a_body_that_appears_round_a_tip_is_not_felt);
    TEST(sheets_that_come_up_are_not_passed);
    TEST(moving_bodies_push_a_tip);
    solid_close(&box);
    return check_report();
}
