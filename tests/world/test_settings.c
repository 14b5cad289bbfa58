/* SPDX-License-Identifier: BSD-3-Clause */
/* What may be set of bodies and tools at any time, and that it counts from the next step on. */
#include <math.h>

#include "lib/fixture.h"

static struct fixture sheet;

struct scene {
    void *block;
    dpt_world *world;
    dpt_body body;
    dpt_tool tool[2];
};

/* Both tools lie flat above the sheet, away from its border. */
static void scene_open(struct scene *scene)
{
    const dpt_segment line = { { -0.01, 0.0, 0.0 }, { 0.01, 0.0, 0.0 }, 0.002 };
    dpt_world_def def;
    dpt_world_def_init(&def);
    def.stiffness = 300.0;
    def.side_limit = 0.03;
    scene->block = malloc(dpt_world_bytes(&def));
    CHECK(dpt_world_create(scene->block, dpt_world_bytes(&def), &def, &scene->world) == DPT_OK,
          "create");
    CHECK(dpt_body_add(scene->world, sheet.mesh, NULL, &scene->body) == DPT_OK, "body");
    for (int i = 0; i < 2; i++)
        CHECK(dpt_tool_add(scene->world, &line, 1, &scene->tool[i]) == DPT_OK, "tool");
}

static double pushed(const struct scene *scene, int i)
{
    dpt_wrench wrench;
    dpt_tool_get_wrench(scene->world, scene->tool[i], &wrench);
    return wrench.force[2];
}

/* Both tools go down to that height in steps shorter than their radius. */
static void lower(const struct scene *scene, double *from, double to)
{
    for (int k = 1; k <= 40; k++) {
        const double z = *from + (to - *from) * k / 40;
        const dpt_pose pose = { { 0.0, 0.0, z }, { 1.0, 0.0, 0.0, 0.0 } };
        for (int i = 0; i < 2; i++)
            dpt_tool_set_pose(scene->world, scene->tool[i], &pose);
        dpt_world_step(scene->world, 0.001, NULL);
    }
    *from = to;
}

static void each_tool_has_its_stiffness(void)
{
    struct scene of;
    dpt_tool_settings settings = { .size = sizeof settings };
    double z = 0.01;
    scene_open(&of);
    CHECK(dpt_tool_get_settings(of.world, of.tool[0], &settings) == DPT_OK &&
              settings.stiffness == 300.0 && settings.reserved == 0,
          "the def's, %g", settings.stiffness);
    settings.stiffness = 900.0;
    CHECK(dpt_tool_set_settings(of.world, of.tool[1], &settings) == DPT_OK, "set");
    lower(&of, &z, 0.001);
    CHECK(fabs(pushed(&of, 0) - 0.3) < 1e-6, "%g N", pushed(&of, 0));
    CHECK(fabs(pushed(&of, 1) - 0.9) < 1e-6, "%g N", pushed(&of, 1));

    const double wrong[] = { -1.0, 2e9, NAN, INFINITY };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        settings.stiffness = wrong[i];
        CHECK(dpt_tool_set_settings(of.world, of.tool[1], &settings) == DPT_E_ARGUMENT, "%g",
              wrong[i]);
    }
    settings = (dpt_tool_settings){ .size = sizeof settings, .reserved = 1, .stiffness = 1.0 };
    CHECK(dpt_tool_set_settings(of.world, of.tool[1], &settings) == DPT_E_ARGUMENT, "reserved");
    CHECK(dpt_tool_get_settings(of.world, of.tool[1], &settings) == DPT_OK &&
              settings.stiffness == 900.0,
          "refused settings change nothing: %g", settings.stiffness);
    CHECK(dpt_tool_set_settings(of.world, of.body, &settings) == DPT_E_HANDLE &&
              dpt_tool_get_settings(of.world, 0, &settings) == DPT_E_HANDLE &&
              dpt_tool_set_settings(NULL, of.tool[0], &settings) == DPT_E_ARGUMENT &&
              dpt_tool_set_settings(of.world, of.tool[0], NULL) == DPT_E_ARGUMENT &&
              dpt_tool_get_settings(of.world, of.tool[0], NULL) == DPT_E_ARGUMENT,
          "what cannot be taken");

    dpt_tool_remove(of.world, of.tool[1]);
    const dpt_segment line = { { -0.01, 0.0, 0.0 }, { 0.01, 0.0, 0.0 }, 0.002 };
    dpt_tool_add(of.world, &line, 1, &of.tool[1]);
    dpt_tool_get_settings(of.world, of.tool[1], &settings);
    CHECK(settings.stiffness == 300.0, "a new tool in that slot has the def's, not %g",
          settings.stiffness);
    free(of.block);
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
        CHECK(dpt_body_get_settings(of.world, of.body, &settings) == DPT_OK &&
                  settings.side_limit == 0.03,
              "the def's, %g", settings.side_limit);
        settings.side_limit = limits[i];
        CHECK(dpt_body_set_settings(of.world, of.body, &settings) == DPT_OK, "set");
        lower(&of, &z, 0.002 - 0.95 * limits[i]);
        CHECK(fabs(pushed(&of, 0) - 300.0 * 0.95 * limits[i]) < 1e-6, "limit %g: %g N", limits[i],
              pushed(&of, 0));
        lower(&of, &z, 0.002 - 1.05 * limits[i]);
        CHECK(pushed(&of, 0) == 0.0, "beyond %g: %g N", limits[i], pushed(&of, 0));
        free(of.block);
    }
    struct scene of;
    scene_open(&of);
    dpt_body_settings settings = { .size = sizeof settings, .side_limit = NAN };
    CHECK(dpt_body_set_settings(of.world, of.body, &settings) == DPT_E_ARGUMENT, "NaN");
    settings.side_limit = 2e6;
    CHECK(dpt_body_set_settings(of.world, of.body, &settings) == DPT_E_ARGUMENT, "2e6");
    CHECK(dpt_body_set_settings(of.world, of.tool[0], &settings) == DPT_E_HANDLE, "a tool's id");
    CHECK(dpt_body_get_settings(of.world, of.body, &settings) == DPT_OK &&
              settings.side_limit == 0.03,
          "refused settings change nothing");
    free(of.block);
}

int main(void)
{
    if (!fixture_from_shape(&sheet, "membrane", 0))
        return 2;
    TEST(each_tool_has_its_stiffness);
    TEST(each_body_has_its_side_limit);
    fixture_free(&sheet);
    return check_report();
}
