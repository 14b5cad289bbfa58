/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/tissue_scene.h"

#include <math.h>

enum { HOLD = 1200, LOOKED_AT = 300 };

static int make_mesh(const struct tissue *tissue, struct fixture *fixture, uint32_t kind)
{
    const dpt_spring_region below = { .kind = DPT_REGION_BOX, .fixed = 1, .box = { -1, -1, -1, 1, 1, -0.02 } };
    const dpt_spring_region border[2] = { { .kind = DPT_REGION_BOX, .fixed = 1, .box = { -1, -1, -1, -0.099, 1, 1 } },
                                          { .kind = DPT_REGION_BOX, .fixed = 1, .box = { 0.099, -1, -1, 1, 1, 1 } } };
    const int is_sheet = kind == DPT_NET_SHEET;
    const double damping = tissue->is_undamped ? 0.0 : 1.0;
    const dpt_spring_net_def net = { .size = sizeof net,
                                     .kind = kind,
                                     .young = tissue->young > 0.0 ? tissue->young
                                              : is_sheet          ? 1e5
                                                                  : 2e4,
                                     .thickness = is_sheet ? 1e-3 : 0.0,
                                     .density = 1000.0,
                                     .drag = 5.0 * damping,
                                     .viscosity = 1e-3 * damping,
                                     .spacing = is_sheet ? 0.0 : 0.02,
                                     .regions = is_sheet ? border : &below,
                                     .region_count = is_sheet ? 2 : 1 };
    return fixture_with_springs(fixture, is_sheet ? "membrane" : "sphere", tissue->triangles ? tissue->triangles : 512,
                                &net);
}

int tissue_add(struct tissue *tissue, uint32_t kind, uint32_t integrator, double load_radius, double x)
{
    const uint32_t i = tissue->count++;
    dpt_pose pose = DPT_POSE_IDENTITY;
    dpt_deformable_def deform;
    dpt_springs_def springs;
    dpt_mesh_info info = { .size = sizeof info };
    pose.position[0] = x;
    dpt_deformable_def_init(&deform);
    dpt_springs_def_init(&springs);
    if (!make_mesh(tissue, &tissue->mesh[i], kind))
        return 0;
    deform.mesh = springs.mesh = tissue->mesh[i].mesh;
    deform.pose = &pose;
    deform.load_radius = load_radius;
    deform.period = tissue->period;
    deform.max_points = 64;
    springs.integrator = integrator;
    springs.sleep_speed = tissue->is_sleepless ? 0.0 : springs.sleep_speed;
    tissue->body[i] = rig_add_deformable(&tissue->rig, &deform);
    tissue->springs[i] = rig_add_springs(&tissue->rig, &springs);
    dpt_mesh_get_info(tissue->mesh[i].mesh, &info);
    tissue->top = info.box_max[2];
    return tissue->body[i] && tissue->springs[i];
}

void tissue_begin(struct tissue *tissue, double stiffness, double lean)
{
    tissue_begin_thin(tissue, stiffness, lean, 0.004);
}

void tissue_begin_thin(struct tissue *tissue, double stiffness, double lean, double radius)
{
    const dpt_segment upright = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.06 }, radius };
    const dpt_segment lying = { { 0.0, 0.0, -0.03 }, { 0.0, 0.0, 0.03 }, radius };
    const double axis[3] = { 0.0, 1.0, 0.0 };
    memset(tissue, 0, sizeof *tissue);
    tissue->radius = radius;
    rig_open(&tissue->rig, NULL, NULL, lean > 1.57 ? &lying : &upright, 1);
    rig_set_law(&tissue->rig, tissue->rig.tool, DPT_LAW_PROXY, stiffness);
    pose_orient(&tissue->rig.device, axis, lean);
    tissue->force.size = sizeof tissue->force;
}

void tissue_place(struct tissue *tissue, double depth)
{
    tissue->rig.device.position[2] = tissue->top + tissue->radius - depth;
}

void tissue_roughen(struct tissue *tissue, double static_friction, double kinetic_friction)
{
    for (uint32_t i = 0; i < tissue->count; i++) {
        dpt_body_settings settings = { .size = sizeof settings };
        dpt_body_get_settings(tissue->rig.world, tissue->body[i], &settings);
        settings.static_friction = static_friction;
        settings.kinetic_friction = kinetic_friction;
        CHECK(dpt_body_set_settings(tissue->rig.world, tissue->body[i], &settings) == DPT_OK, "not rough");
    }
}

void tissue_soften(struct tissue *tissue, double stiffness)
{
    for (uint32_t i = 0; i < tissue->count; i++) {
        dpt_body_settings settings = { .size = sizeof settings };
        dpt_body_get_settings(tissue->rig.world, tissue->body[i], &settings);
        settings.stiffness = stiffness;
        CHECK(dpt_body_set_settings(tissue->rig.world, tissue->body[i], &settings) == DPT_OK, "not soft");
    }
}

void tissue_close(struct tissue *tissue)
{
    rig_close(&tissue->rig);
    for (uint32_t i = 0; i < tissue->count; i++)
        fixture_free(&tissue->mesh[i]);
}

double tissue_tick(struct tissue *tissue)
{
    rig_step(&tissue->rig);
    for (uint32_t i = 0; i < tissue->count; i++)
        tissue->info[i].size = sizeof tissue->info[i];
    const dpt_result result = dpt_bodies_step_springs(tissue->rig.world, tissue->body, tissue->springs, tissue->count,
                                                      tissue->rig.dt, tissue->info);
    CHECK(result == DPT_OK, "%s", dpt_result_name(result));
    dpt_tool_get_force_info(tissue->rig.world, tissue->rig.tool, &tissue->force);
    tissue->wrench = tissue->force.wrench;
    return length3(tissue->wrench.force);
}

double tissue_press_and_hold(struct tissue *tissue, double depth, double *mean)
{
    double last = 0.0, jump = 0.0;
    tissue_place(tissue, -0.001);
    rig_place(&tissue->rig);
    for (double at = -0.001; at < depth; at += TISSUE_PRESS) {
        tissue_place(tissue, at);
        tissue_tick(tissue);
    }
    *mean = 0.0;
    for (int i = 0; i < HOLD; i++) {
        const double force = tissue_tick(tissue);
        if (i >= HOLD - LOOKED_AT) {
            jump = fmax(jump, fabs(force - last));
            *mean += force / LOOKED_AT;
        }
        last = force;
    }
    return jump;
}
