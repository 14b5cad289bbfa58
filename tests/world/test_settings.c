/* SPDX-License-Identifier: BSD-3-Clause */
/* What may be set of bodies and tools at any time, and that it counts from the next step on. */
#include "lib/fixture.h"
#include "lib/rig.h"

static struct fixture sheet;

struct scene {
    struct rig rig;
    dpt_tool tool[2];
};

/* Both tools lie flat above the sheet, away from its border. */
static void scene_open(struct scene *scene)
{
    const dpt_segment line = { { -0.01, 0.0, 0.0 }, { 0.01, 0.0, 0.0 }, 0.002 };
    dpt_world_def def = rig_def(DPT_LAW_POINT);
    def.stiffness = 300.0;
    def.side_limit = 0.03;
    rig_open(&scene->rig, &def, sheet.mesh, NULL, 0);
    for (int i = 0; i < 2; i++)
        scene->tool[i] = rig_add_tool(&scene->rig, &line, 1);
}

static double pushed(const struct scene *scene, int i)
{
    dpt_wrench wrench;
    dpt_tool_get_wrench(scene->rig.world, scene->tool[i], &wrench);
    return wrench.force[2];
}

/* Both tools go down to that height in steps shorter than their radius. */
static void lower(struct scene *scene, double *from, double to)
{
    for (int k = 1; k <= 40; k++) {
        const double z = *from + (to - *from) * k / 40;
        const dpt_pose pose = { { 0.0, 0.0, z }, { 1.0, 0.0, 0.0, 0.0 } };
        for (int i = 0; i < 2; i++)
            dpt_tool_set_pose(scene->rig.world, scene->tool[i], &pose);
        rig_tick(&scene->rig);
    }
    *from = to;
}

static void each_tool_has_its_stiffness(void)
{
    struct scene of;
    dpt_tool_settings settings = { .size = sizeof settings };
    double z = 0.01;
    scene_open(&of);
    CHECK(dpt_tool_get_settings(of.rig.world, of.tool[0], &settings) == DPT_OK && settings.stiffness == 300.0 &&
              settings.law == DPT_LAW_POINT,
          "the def's, %g", settings.stiffness);
    settings.stiffness = 900.0;
    CHECK(dpt_tool_set_settings(of.rig.world, of.tool[1], &settings) == DPT_OK, "set");
    lower(&of, &z, 0.001);
    CHECK(fabs(pushed(&of, 0) - 0.3) < 1e-6, "%g N", pushed(&of, 0));
    CHECK(fabs(pushed(&of, 1) - 0.9) < 1e-6, "%g N", pushed(&of, 1));

    const double wrong[] = { -1.0, 2e9, NAN, INFINITY };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        settings.stiffness = wrong[i];
        CHECK(dpt_tool_set_settings(of.rig.world, of.tool[1], &settings) == DPT_E_ARGUMENT, "%g", wrong[i]);
    }
    settings = (dpt_tool_settings){ .size = sizeof settings, .stiffness = 1.0 };
    settings.law = DPT_LAW_PROXY + 1;
    CHECK(dpt_tool_set_settings(of.rig.world, of.tool[1], &settings) == DPT_E_ARGUMENT, "law 3");
    CHECK(dpt_tool_get_settings(of.rig.world, of.tool[1], &settings) == DPT_OK && settings.stiffness == 900.0,
          "refused settings change nothing: %g", settings.stiffness);
    CHECK(dpt_tool_set_settings(of.rig.world, of.rig.body, &settings) == DPT_E_HANDLE &&
              dpt_tool_get_settings(of.rig.world, 0, &settings) == DPT_E_HANDLE &&
              dpt_tool_set_settings(NULL, of.tool[0], &settings) == DPT_E_ARGUMENT &&
              dpt_tool_set_settings(of.rig.world, of.tool[0], NULL) == DPT_E_ARGUMENT &&
              dpt_tool_get_settings(of.rig.world, of.tool[0], NULL) == DPT_E_ARGUMENT,
          "what cannot be taken");

    dpt_tool_remove(of.rig.world, of.tool[1]);
    const dpt_segment line = { { -0.01, 0.0, 0.0 }, { 0.01, 0.0, 0.0 }, 0.002 };
    of.tool[1] = rig_add_tool(&of.rig, &line, 1);
    dpt_tool_get_settings(of.rig.world, of.tool[1], &settings);
    CHECK(settings.stiffness == 300.0, "a new tool in that slot has the def's, not %g", settings.stiffness);
    rig_close(&of.rig);
}

static void each_tool_has_its_law(void)
{
    struct scene of;
    dpt_tool_settings settings = { .size = sizeof settings };
    dpt_force_info force = { .size = sizeof force };
    dpt_pose proxy;
    double z = 0.01;
    scene_open(&of);
    dpt_tool_get_settings(of.rig.world, of.tool[1], &settings);
    CHECK(settings.rotational_stiffness == 0.0, "by the tool's shape, not %g", settings.rotational_stiffness);
    settings.law = DPT_LAW_PROXY;
    settings.rotational_stiffness = 0.25;
    CHECK(dpt_tool_set_settings(of.rig.world, of.tool[1], &settings) == DPT_OK, "set");
    CHECK(dpt_tool_get_settings(of.rig.world, of.tool[1], &settings) == DPT_OK && settings.law == DPT_LAW_PROXY &&
              settings.rotational_stiffness == 0.25 && settings.stiffness == 300.0,
          "law %u, %g Nm/rad", settings.law, settings.rotational_stiffness);
    lower(&of, &z, 0.001);
    for (int i = 0; i < 2; i++) {
        CHECK(fabs(pushed(&of, i) - 0.3) < 1e-3, "%g N", pushed(&of, i));
        CHECK(dpt_tool_get_force_info(of.rig.world, of.tool[i], &force) == DPT_OK &&
                  force.law == (i ? DPT_LAW_PROXY : DPT_LAW_POINT) && (force.energy > 0.0) == i,
              "law %u, %g J", force.law, force.energy);
        dpt_tool_get_proxy(of.rig.world, of.tool[i], &proxy);
        CHECK(fabs(proxy.position[2] - (i ? 0.002 : z)) < 1e-5, "%g m", proxy.position[2]);
    }
    /* A change of the law is a teleport: the side of the sheet is not known any more. */
    settings.law = DPT_LAW_POINT;
    CHECK(dpt_tool_set_settings(of.rig.world, of.tool[1], &settings) == DPT_OK, "set");
    dpt_tool_get_force_info(of.rig.world, of.tool[1], &force);
    CHECK(force.reason == DPT_FORCE_STALE && pushed(&of, 1) == 0.0, "reason %u", force.reason);

    const double wrong[] = { -1.0, 2e9, NAN, INFINITY };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        settings.rotational_stiffness = wrong[i];
        CHECK(dpt_tool_set_settings(of.rig.world, of.tool[1], &settings) == DPT_E_ARGUMENT, "%g", wrong[i]);
    }
    rig_close(&of.rig);
}

static void each_body_has_its_friction(void)
{
    const struct {
        double statics, kinetic;
        dpt_result expected;
    } cases[] = { { 0.5, 0.3, DPT_OK },          { 10.0, 10.0, DPT_OK },         { 0.3, 0.5, DPT_E_ARGUMENT },
                  { 10.1, 0.0, DPT_E_ARGUMENT }, { -0.1, -0.1, DPT_E_ARGUMENT }, { NAN, 0.0, DPT_E_ARGUMENT },
                  { 0.5, NAN, DPT_E_ARGUMENT },  { 0.5, -0.1, DPT_E_ARGUMENT },  { 0.0, 0.0, DPT_OK } };
    struct scene of;
    dpt_body_settings settings = { .size = sizeof settings };
    scene_open(&of);
    dpt_body_get_settings(of.rig.world, of.rig.body, &settings);
    CHECK(settings.static_friction == 0.0 && settings.kinetic_friction == 0.0, "a new body: %g, %g",
          settings.static_friction, settings.kinetic_friction);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const dpt_body_settings before = settings;
        settings.static_friction = cases[i].statics;
        settings.kinetic_friction = cases[i].kinetic;
        const dpt_body_settings given = settings;
        CHECK(dpt_body_set_settings(of.rig.world, of.rig.body, &settings) == cases[i].expected, "%g, %g",
              cases[i].statics, cases[i].kinetic);
        dpt_body_get_settings(of.rig.world, of.rig.body, &settings);
        CHECK(!memcmp(&settings, cases[i].expected == DPT_OK ? &given : &before, sizeof settings), "%g, %g: now %g, %g",
              cases[i].statics, cases[i].kinetic, settings.static_friction, settings.kinetic_friction);
    }
    rig_close(&of.rig);
}

/* A tool behind a sheet is pushed back until it is deeper than the body's limit. */
static void each_body_has_its_side_limit(void)
{
    const double limits[] = { 0.03, 0.01, 0.05 };
    for (size_t i = 0; i < sizeof limits / sizeof *limits; i++) {
        struct scene of;
        dpt_body_settings settings = { .size = sizeof settings };
        double z = 0.01;
        scene_open(&of);
        CHECK(dpt_body_get_settings(of.rig.world, of.rig.body, &settings) == DPT_OK && settings.side_limit == 0.03,
              "the def's, %g", settings.side_limit);
        settings.side_limit = limits[i];
        CHECK(dpt_body_set_settings(of.rig.world, of.rig.body, &settings) == DPT_OK, "set");
        lower(&of, &z, 0.002 - 0.95 * limits[i]);
        CHECK(fabs(pushed(&of, 0) - 300.0 * 0.95 * limits[i]) < 1e-6, "limit %g: %g N", limits[i], pushed(&of, 0));
        lower(&of, &z, 0.002 - 1.05 * limits[i]);
        CHECK(pushed(&of, 0) == 0.0, "beyond %g: %g N", limits[i], pushed(&of, 0));
        rig_close(&of.rig);
    }
    struct scene of;
    scene_open(&of);
    dpt_body_settings settings = { .size = sizeof settings, .side_limit = NAN };
    CHECK(dpt_body_set_settings(of.rig.world, of.rig.body, &settings) == DPT_E_ARGUMENT, "NaN");
    settings.side_limit = 2e6;
    CHECK(dpt_body_set_settings(of.rig.world, of.rig.body, &settings) == DPT_E_ARGUMENT, "2e6");
    CHECK(dpt_body_set_settings(of.rig.world, of.tool[0], &settings) == DPT_E_HANDLE, "a tool's id");
    CHECK(dpt_body_get_settings(of.rig.world, of.rig.body, &settings) == DPT_OK && settings.side_limit == 0.03,
          "refused settings change nothing");
    rig_close(&of.rig);
}

/* Without contacts a sheet has no sides for the laws point and bed. A proxy needs none, nor does a solid. */
static void contacts_tell_the_sides_of_sheets(void)
{
    const dpt_segment needle = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.1 }, 0.004 };
    for (uint32_t i = 0; i < 6; i++) {
        const uint32_t law = i / 2;
        struct fixture membrane;
        struct rig rig;
        dpt_world_def def;
        dpt_world_def_init(&def);
        CHECK(def.max_contacts == 0, "%u contacts by default", def.max_contacts);
        def.law = law;
        def.max_contacts = i % 2 ? 8 : 0;
        fixture_from_shape(&membrane, "membrane", 512);
        rig_open(&rig, &def, membrane.mesh, &needle, 1);
        for (int k = 0; k < 5; k++) {
            const dpt_pose pose = { { 0.011, 0.007, 0.01 - 0.003 * k }, { 1.0, 0.0, 0.0, 0.0 } };
            rig_step_to(&rig, &pose);
        }
        const uint32_t wanted = i % 2 || law == DPT_LAW_PROXY ? DPT_FORCE_ACTS : DPT_FORCE_UNDECIDED;
        CHECK(rig.force.reason == wanted, "law %u, %u contacts: reason %u", law, def.max_contacts, rig.force.reason);
        uint32_t count = 7;
        const dpt_result listed = dpt_tool_get_contacts(rig.world, rig.tool, NULL, 0, &count);
        CHECK(listed == (i % 2 ? DPT_OK : DPT_E_FULL) && count == i % 2, "law %u, %u contacts: %s, %u", law,
              def.max_contacts, dpt_result_name(listed), count);
        rig_close(&rig);
        fixture_free(&membrane);
    }
}

int main(void)
{
    if (!fixture_from_shape(&sheet, "membrane", 0))
        return 2;
    TEST(each_tool_has_its_stiffness);
    TEST(each_tool_has_its_law);
    TEST(each_body_has_its_side_limit);
    TEST(each_body_has_its_friction);
    fixture_free(&sheet);
    TEST(contacts_tell_the_sides_of_sheets);
    return check_report();
}
