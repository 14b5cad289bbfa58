/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A proxy that is put at its device: because the device turned too far, because bodies left no room, because one
 * appeared round it, or moved unseen. Behind what it had in front it has no force, and says why, until it is in front
 * again, or far away: docs/algorithms/force.md.
 */
#include "force/side_scene.h"

enum { SHEET = 0, WALL = 4 };

static const dpt_segment lying = { { -0.03, 0, 0 }, { 0.03, 0, 0 }, 0.002 };

/* m: how deep the device is when the proxy is put: all of it is behind the surface. */
#define DEEP 0.035

/* Steps in which the device moves by `z` m in all; 1 if on each of them nothing is felt and the reason is that. */
static int is_unfelt_on_the_way(struct rig *rig, double z, uint32_t reason)
{
    int is_unfelt = 1;
    for (int i = 0; i < 100; i++) {
        rig->device.position[2] += z / 100;
        rig_step(rig);
        is_unfelt &= rig->force.reason == reason && rig_force(rig) == 0;
    }
    return is_unfelt;
}

static void lower(struct rig *rig, double z)
{
    for (int i = 0; i < 100; i++) {
        rig->device.position[2] -= z / 100;
        rig_step(rig);
    }
}

/* From below, where it was put, back in front: it is free there, and is held again. */
static void lead_back(struct side_scene *scene, double z)
{
    struct rig *rig = &scene->rig;
    lower(rig, -z);
    CHECK(rig->force.reason == DPT_FORCE_FREE, "%s: in front its reason is %u", scene->name, rig->force.reason);
    lower(rig, z);
    CHECK(rig->force.reason == DPT_FORCE_ACTS && rig_force(rig) > 0.5, "%s: reason %u, %g N", scene->name,
          rig->force.reason, rig_force(rig));
    side_scene_judge(scene);
}

/* Pressed on a surface. */
static int open_pressed(struct side_scene *scene, int shape)
{
    if (!side_scene_open(scene, shape, NULL, &lying, 1, 1))
        return 0;
    scene->rig.device.position[0] = 0.011;
    scene->rig.device.position[2] = 0.004;
    rig_place(&scene->rig);
    lower(&scene->rig, 0.004 + DEEP);
    CHECK(scene->rig.force.reason == DPT_FORCE_ACTS, "reason %u", scene->rig.force.reason);
    return 1;
}

/* Turn the device about y, by so much in all. Returns whether the proxy was put. */
static int turn_device(struct rig *rig, double from, double to)
{
    static const double y[3] = { 0, 1, 0 };
    int is_put = 0;
    for (int i = 1; i <= 100; i++) {
        pose_orient(&rig->device, y, from + (to - from) * i / 100);
        rig_step(rig);
        is_put |= (rig->force.flags & DPT_FORCE_FLAG_REPLACED) != 0;
    }
    return is_put;
}

static void turned_too_far_it_is_not_felt_behind(int shape)
{
    struct side_scene scene;
    struct rig *rig = &scene.rig;
    if (open_pressed(&scene, shape)) {
        CHECK(!turn_device(rig, 0, 0.99) && side_scene_judge(&scene), "%s: put too early", scene.name);
        CHECK(turn_device(rig, 0.99, 1.5), "%s: not put", scene.name);
        CHECK(turn_device(rig, 1.5, 0) == 0, "%s: put again", scene.name);
        CHECK(is_unfelt_on_the_way(rig, -0.01, DPT_FORCE_INSIDE), "%s: felt on the way down", scene.name);
        CHECK(is_unfelt_on_the_way(rig, 0.01 + DEEP, DPT_FORCE_INSIDE), "%s: felt from behind", scene.name);
        lead_back(&scene, 0.006);
    }
    side_scene_close(&scene);
    if (open_pressed(&scene, shape)) {
        CHECK(turn_device(rig, 0, 1.5), "%s: not put", scene.name);
        turn_device(rig, 1.5, 0);
        lower(rig, 0.06);
        CHECK(rig->force.reason == DPT_FORCE_FREE, "%s: far away its reason is %u", scene.name, rig->force.reason);
    }
    side_scene_close(&scene);
}

static void turned_too_far_it_is_not_felt_behind_a_sheet(void)
{
    turned_too_far_it_is_not_felt_behind(SHEET);
}

static void nor_behind_a_thin_wall(void)
{
    turned_too_far_it_is_not_felt_behind(WALL);
}

/* A box comes down on the tool, which the wall holds. */
static void squeezed_it_is_not_felt_behind(void)
{
    struct side_scene scene;
    struct solid box;
    struct rig *rig = &scene.rig;
    dpt_pose pose = DPT_POSE_IDENTITY;
    if (solid_from_shape(&box, "box", 300) && open_pressed(&scene, WALL)) {
        int is_squeezed = 0;
        pose.position[2] = 0.055;
        const dpt_body lid = rig_add_body(rig, box.mesh, &pose);
        lower(rig, 0);
        for (int i = 0; i < 300 && !is_squeezed; i++) {
            pose.position[2] -= 1e-4;
            dpt_body_set_pose(rig->world, lid, &pose);
            rig_step(rig);
            is_squeezed = (rig->force.flags & DPT_FORCE_FLAG_SQUEEZED) != 0;
        }
        CHECK(is_squeezed && rig->force.reason == DPT_FORCE_INSIDE, "reason %u, flags %u", rig->force.reason,
              rig->force.flags);
        for (int i = 0; i < 1000; i++) {
            pose.position[2] += 1e-4;
            dpt_body_set_pose(rig->world, lid, &pose);
            rig_step(rig);
        }
        CHECK(is_unfelt_on_the_way(rig, -0.01, DPT_FORCE_INSIDE), "felt below the wall: reason %u", rig->force.reason);
        CHECK(is_unfelt_on_the_way(rig, 0.01 + DEEP, DPT_FORCE_INSIDE), "felt below the wall: reason %u",
              rig->force.reason);
        lead_back(&scene, 0.006);
        side_scene_close(&scene);
    }
    solid_close(&box);
}

/* A body appears round the tool, which the sheet holds, and is taken away again. */
static void doubted_it_is_not_felt_behind(void)
{
    struct side_scene scene;
    struct solid box;
    struct rig *rig = &scene.rig;
    if (solid_from_shape(&box, "box", 300) && open_pressed(&scene, SHEET)) {
        const dpt_body round = rig_add_body(rig, box.mesh, NULL);
        lower(rig, 0);
        CHECK(rig->force.reason == DPT_FORCE_INSIDE, "reason %u", rig->force.reason);
        dpt_body_remove(rig->world, round);
        CHECK(is_unfelt_on_the_way(rig, -0.01, DPT_FORCE_INSIDE), "felt below the sheet: reason %u", rig->force.reason);
        CHECK(is_unfelt_on_the_way(rig, 0.01 + DEEP, DPT_FORCE_INSIDE), "felt below the sheet: reason %u",
              rig->force.reason);
        lead_back(&scene, 0.006);
        side_scene_close(&scene);
    }
    solid_close(&box);
}

/* While the tool has no pose, the sheet goes by, or only moves far away from it. */
static void a_sheet_that_moves_unseen(double by, double over)
{
    struct side_scene scene;
    struct rig *rig = &scene.rig;
    dpt_pose nowhere = DPT_POSE_IDENTITY;
    nowhere.position[0] = NAN;
    if (side_scene_open(&scene, SHEET, NULL, &lying, 1, 1)) {
        rig->device.position[2] = over;
        rig_place(rig);
        for (int i = 0; i < 50; i++) {
            dpt_tool_set_pose(rig->world, rig->tool, &nowhere);
            scene.body.position[2] += by / 50;
            dpt_body_set_pose(rig->world, rig->body, &scene.body);
            rig_tick(rig);
        }
        rig_step(rig);
        const int is_behind = by > over;
        CHECK(rig->force.reason == (is_behind ? DPT_FORCE_INSIDE : DPT_FORCE_FREE), "by %g m: reason %u", by,
              rig->force.reason);
        CHECK(!is_behind || is_unfelt_on_the_way(rig, 0.02, DPT_FORCE_INSIDE), "felt from behind");
        if (is_behind) {
            lower(rig, -0.4);
            CHECK(rig->force.reason == DPT_FORCE_FREE, "far away its reason is %u", rig->force.reason);
        }
    }
    side_scene_close(&scene);
}

static void a_sheet_that_goes_by_unseen_is_not_felt_from_behind(void)
{
    a_sheet_that_moves_unseen(0.05, 0.02);
    a_sheet_that_moves_unseen(0.01, 0.02);
    a_sheet_that_moves_unseen(0.0, 0.02);
}

int main(void)
{
    TEST(turned_too_far_it_is_not_felt_behind_a_sheet);
    TEST(nor_behind_a_thin_wall);
    TEST(squeezed_it_is_not_felt_behind);
    TEST(doubted_it_is_not_felt_behind);
    TEST(a_sheet_that_goes_by_unseen_is_not_felt_from_behind);
    return check_report();
}
