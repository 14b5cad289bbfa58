/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What is asked twice at one pose is answered alike, bit for bit, and searched for once. It does not judge the answers
 * themselves.
 *
 *     test_same_pose [PER CENT of the poses = 100]
 */
#include "lib/random.h"
#include "lib/rig.h"
#include "lib/solid.h"

/* A setting that is given again, so that the tool does not rest. */
static void wake(const struct rig *rig)
{
    dpt_tool_settings settings = { .size = sizeof settings };
    CHECK(dpt_tool_get_settings(rig->world, rig->tool, &settings) == DPT_OK &&
              dpt_tool_set_settings(rig->world, rig->tool, &settings) == DPT_OK,
          "settings");
}

/* Poses beside three overlapping bodies: most are near the last one, some are far from it. */
static void move_among(dpt_pose *pose, const struct solid *solid, uint64_t t, uint64_t *seed)
{
    const double jump = t % 50 ? 0.01 : 1.5;
    for (int k = 0; k < 3; k++) {
        const double wide = solid->info.box_max[k] - solid->info.box_min[k];
        const double middle = 0.5 * (solid->info.box_max[k] + solid->info.box_min[k]);
        const double from = t % 50 ? pose->position[k] : middle + (k ? 0.0 : wide);
        pose->position[k] = from + jump * random_in(seed, -wide, wide);
    }
    pose_orient(pose, (const double[3]){ 0, 0.6, 0.8 }, 0.02 * (double)t);
}

static void the_nearest_of_several_bodies(void)
{
    static const struct {
        const char *shape;
        uint64_t count;
    } shapes[] = { { "box", 12 }, { "torus", 5568 }, { "star", 2000 } };
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        const dpt_segment segment = { { 0, 0, 0 }, { 0, 0, 0.03 }, 0.001 };
        dpt_world_def def = rig_def(DPT_LAW_POINT);
        uint64_t seed = 7 + i, searched = 0, again = 0, differ = 0;
        struct solid solid;
        struct rig rig;
        def.until = DPT_UNTIL_TRACK;
        if (!solid_from_shape(&solid, shapes[i].shape, shapes[i].count) ||
            !rig_open(&rig, &def, solid.mesh, &segment, 1))
            return;
        for (int b = 1; b < 3; b++) {
            dpt_pose pose = DPT_POSE_IDENTITY;
            pose.position[0] = 0.9 * b * (solid.info.box_max[0] - solid.info.box_min[0]);
            rig_add_body(&rig, solid.mesh, &pose);
        }
        for (uint64_t t = 0; t < part_of(4000); t++) {
            move_among(&rig.device, &solid, t, &seed);
            rig_step(&rig);
            dpt_hit first = rig.hit;
            searched += first.work;
            wake(&rig);
            rig_step(&rig);
            again += rig.hit.work;
            first.work = rig.hit.work;
            differ += memcmp(&first, &rig.hit, sizeof first) != 0;
        }
        CHECK(differ == 0, "%s: %u poses are answered differently", shapes[i].shape, (unsigned)differ);
        CHECK(searched > 0 && again == 0, "%s: %u units, and again %u", shapes[i].shape, (unsigned)searched,
              (unsigned)again);
        rig_close(&rig);
        solid_close(&solid);
    }
}

static void place(const dpt_pose *pose, const double x[3], double at[3])
{
    turn3(pose->orientation, x, at);
    for (int k = 0; k < 3; k++)
        at[k] += pose->position[k];
}

/* Without friction nothing feels the spin of a straight tool or a ball: it follows the device, and moves no surface. */
static void a_spin_that_is_not_felt(void)
{
    static const dpt_segment tools[] = { { { 0, 0, 0.01 }, { 0, 0, 0.09 }, 0 },
                                         { { 0, 0, 0.02 }, { 0, 0, 0.02 }, 0.001 } };
    struct solid liver;
    if (!solid_from_shape(&liver, "liver", 5000))
        return;
    for (size_t i = 0; i < sizeof tools / sizeof *tools; i++) {
        const double z[3] = { 0, 0, 1 };
        dpt_world_def def;
        struct rig rig;
        dpt_world_def_init(&def);
        rig_open(&rig, &def, liver.mesh, &tools[i], 1);
        for (int k = 0; k < 2; k++)
            rig.device.position[k] = 0.5 * (liver.info.box_min[k] + liver.info.box_max[k]) - tools[i].a[k];
        rig.device.position[2] = liver.info.box_max[2] + 0.01;
        rig_place(&rig);
        for (int t = 0; t < 600 && !(rig.force.reason == DPT_FORCE_ACTS && rig_force(&rig) > 0.5); t++) {
            rig.device.position[2] -= 1e-4;
            rig_step(&rig);
        }
        for (int t = 0; t < 100; t++)
            rig_step(&rig);
        CHECK(rig_force(&rig) > 0.4, "tool %zu does not touch: %g N", i, rig_force(&rig));
        const dpt_wrench held = rig.force.wrench;
        const dpt_pose lies = rig.proxy;
        for (int t = 1; t <= 200; t++) {
            double held_at[3], at[3], told[3], given[3];
            dpt_pose spun = rig.device;
            pose_orient(&spun, z, 0.01 * t);
            rig_step_to(&rig, &spun);
            CHECK(!memcmp(&held, &rig.force.wrench, sizeof held), "tool %zu, spun by %g: %g N more", i, 0.01 * t,
                  apart(held.force, rig.force.wrench.force));
            place(&lies, tools[i].a, held_at);
            place(&rig.proxy, tools[i].a, at);
            CHECK(apart(held_at, at) < 1e-15, "tool %zu, spun by %g: its end has moved by %g m", i, 0.01 * t,
                  apart(held_at, at));
            turn3(rig.proxy.orientation, (const double[3]){ 1, 0, 0 }, told);
            turn3(spun.orientation, (const double[3]){ 1, 0, 0 }, given);
            CHECK(apart(told, given) < 0.05, "tool %zu, spun by %g: told %g rad from there", i, 0.01 * t,
                  apart(told, given));
        }
        rig_close(&rig);
    }
    solid_close(&liver);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(the_nearest_of_several_bodies);
    TEST(a_spin_that_is_not_felt);
    return check_report();
}
