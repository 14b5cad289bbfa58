/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What lies on tools and is held by friction alone weighs on them what it weighs, and comes to rest: a sheet on a ball, a
 * block on three rods, a sheet over a rod. Oracle: mass times gravity. And a cloth that is dropped on a rod stays on it.
 */
#include <math.h>

#include "lib/fixture.h"
#include "lib/rig.h"

#define GRAVITY 9.81

enum { TOOLS_MAX = 3, SECONDS = 10, CASES = 3 };

struct load {
    const char *shape;
    uint64_t triangles;
    uint32_t kind; /* DPT_NET_... */
    double drag, stiffness, height;
    uint32_t count;
    dpt_segment tools[TOOLS_MAX];
};

static const struct load loads[CASES] = {
    { "membrane", 512, DPT_NET_SHEET, 20.0, 500.0, 0.041, 1, { { { 0, 0, 0 }, { 0, 0, 0 }, 0.04 } } },
    { "sphere",
      512,
      DPT_NET_VOLUME,
      20.0,
      4000.0,
      0.095,
      3,
      { { { -0.05, -0.2, 0 }, { -0.05, 0.2, 0 }, 0.004 },
        { { 0.05, -0.2, 0 }, { 0.05, 0.2, 0 }, 0.004 },
        { { -0.2, 0.05, 0 }, { 0.2, 0.05, 0 }, 0.004 } } },
    { "membrane", 512, DPT_NET_SHEET, 20.0, 500.0, 0.005, 1, { { { 0.003, -0.2, 0 }, { 0.003, 0.2, 0 }, 0.004 } } },
};

struct scene {
    struct rig rig;
    struct fixture mesh;
    dpt_tool tools[TOOLS_MAX];
    dpt_body body;
    dpt_springs *springs;
    double weight; /* N */
};

static int open_mesh(struct scene *scene, const struct load *load)
{
    const int is_sheet = load->kind == DPT_NET_SHEET;
    const dpt_spring_net_def net = { .size = sizeof net,
                                     .kind = load->kind,
                                     .young = is_sheet ? 2e5 : 4e4,
                                     .thickness = is_sheet ? 5e-4 : 0.0,
                                     .density = is_sheet ? 400.0 : 1000.0,
                                     .drag = load->drag,
                                     .viscosity = is_sheet ? 1e-4 : 1e-3,
                                     .spacing = is_sheet ? 0.0 : 0.02 };
    dpt_mesh_springs info = { .size = sizeof info };
    if (!fixture_with_springs(&scene->mesh, load->shape, load->triangles, &net))
        return 0;
    CHECK(dpt_mesh_get_springs(scene->mesh.mesh, &info) == DPT_OK, "no springs");
    for (uint32_t i = 0; i < info.nodes; i++)
        scene->weight += GRAVITY * (double)info.mass[i];
    return 1;
}

static void open_scene(struct scene *scene, const struct load *load)
{
    dpt_deformable_def deform;
    dpt_springs_def springs;
    dpt_pose pose = DPT_POSE_IDENTITY;
    memset(scene, 0, sizeof *scene);
    rig_open(&scene->rig, NULL, NULL, load->tools, 1);
    scene->tools[0] = scene->rig.tool;
    for (uint32_t i = 1; i < load->count; i++)
        scene->tools[i] = rig_add_tool(&scene->rig, &load->tools[i], 1);
    for (uint32_t i = 0; i < load->count; i++)
        rig_set_law(&scene->rig, scene->tools[i], DPT_LAW_PROXY, load->stiffness);
    rig_place(&scene->rig);
    if (!open_mesh(scene, load))
        return;
    dpt_deformable_def_init(&deform);
    dpt_springs_def_init(&springs);
    pose.position[2] = load->height;
    deform.mesh = springs.mesh = scene->mesh.mesh;
    deform.pose = &pose;
    for (int k = 0; k < 3; k++) {
        deform.box_min[k] = -1.0;
        deform.box_max[k] = 1.0;
    }
    springs.gravity[2] = -GRAVITY;
    springs.sleep_speed = 0.01;
    scene->body = rig_add_deformable(&scene->rig, &deform);
    scene->springs = rig_add_springs(&scene->rig, &springs);
    rig_set_body(&scene->rig, (dpt_body_settings){ .static_friction = 0.5, .kinetic_friction = 0.5 });
}

/* The force on all tools, upwards. */
static double force_of(const struct scene *scene, const struct load *load)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < load->count; i++) {
        dpt_force_info info = { .size = sizeof info };
        dpt_tool_get_force_info(scene->rig.world, scene->tools[i], &info);
        sum += info.wrench.force[2];
    }
    return sum;
}

static void what_lies_on_tools_weighs_what_it_weighs(void)
{
    for (int i = 0; i < (int)part_of(CASES); i++) {
        const struct load *load = &loads[i];
        struct scene scene;
        dpt_springs_info info = { .size = sizeof info };
        dpt_result result = DPT_OK;
        open_scene(&scene, load);
        info.active = scene.springs ? UINT32_MAX : 0;
        for (int t = 0; t < 1000 * SECONDS && info.active && result == DPT_OK; t++) {
            dpt_world_step(scene.rig.world, 1e-3, NULL);
            result = dpt_body_step_springs(scene.rig.world, scene.body, scene.springs, 1e-3, &info);
            CHECK(result == DPT_OK, "case %d: %s in tick %d", i, dpt_result_name(result), t);
        }
        const double off = -force_of(&scene, load) / scene.weight - 1.0;
        CHECK(info.active == 0, "case %d: %u nodes are awake", i, info.active);
        CHECK(fabs(off) < 0.02, "case %d: %g N are off by %.2f %%", i, scene.weight, 100.0 * off);
        rig_close(&scene.rig);
        fixture_free(&scene.mesh);
    }
}

/* A loose cloth drops on a rod by a few centimetres and wraps it: the rod never finds itself on its other side. */
static void a_cloth_that_wraps_a_rod_stays_on_it(void)
{
    const struct load loose = {
        "cloth", 2048, DPT_NET_SHEET, 2.0, 500.0, 0.03, 1, { { { 0.003, -0.2, 0 }, { 0.003, 0.2, 0 }, 0.004 } }
    };
    struct scene scene;
    uint32_t touched = 0, lost = 0, squeezed = 0;
    open_scene(&scene, &loose);
    for (int t = 0; t < 450 && scene.springs; t++) {
        dpt_force_info info = { .size = sizeof info };
        dpt_world_step(scene.rig.world, 1e-3, NULL);
        const dpt_result result = dpt_body_step_springs(scene.rig.world, scene.body, scene.springs, 1e-3, NULL);
        CHECK(result == DPT_OK, "%s in tick %d", dpt_result_name(result), t);
        dpt_tool_get_force_info(scene.rig.world, scene.tools[0], &info);
        touched += info.reason == DPT_FORCE_ACTS;
        lost += info.reason == DPT_FORCE_INSIDE;
        squeezed += (info.flags & DPT_FORCE_FLAG_SQUEEZED) != 0;
    }
    CHECK(touched > 300 && lost == 0, "it was touched in %u ticks, and lost in %u", touched, lost);
    CHECK(10 * squeezed < touched, "it had no room in %u ticks of %u", squeezed, touched);
    rig_close(&scene.rig);
    fixture_free(&scene.mesh);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(what_lies_on_tools_weighs_what_it_weighs);
    TEST(a_cloth_that_wraps_a_rod_stays_on_it);
    return check_report();
}
