/* SPDX-License-Identifier: BSD-3-Clause */
#include <math.h>
#include "lib/fixture.h"
#include "lib/rig.h"

static void weigh(const char *name, uint64_t tri, uint32_t kind, const dpt_segment *rods, int count, double z0, uint32_t integ, double dt)
{
    struct rig rig;
    struct fixture fixture;
    const dpt_spring_net_def net = { .size = sizeof net, .kind = kind, .young = kind == DPT_NET_SHEET ? 2e5 : 2e4, .thickness = kind == DPT_NET_SHEET ? 5e-4 : 0, .density = kind == DPT_NET_SHEET ? 400.0 : 1000, .drag = 2.0, .viscosity = kind == DPT_NET_SHEET ? 1e-4 : 1e-3, .spacing = kind == DPT_NET_SHEET ? 0 : 0.02 };
    rig_open(&rig, NULL, NULL, rods, 1);
    const double K = kind == DPT_NET_SHEET ? 500 : 4000; rig_set_law(&rig, rig.tool, DPT_LAW_PROXY, K);
    dpt_tool tools[8] = { rig.tool };
    for (int i = 1; i < count; i++) { tools[i] = rig_add_tool(&rig, rods + i, 1); rig_set_law(&rig, tools[i], DPT_LAW_PROXY, K); }
    rig_place(&rig);
    if (!fixture_with_springs(&fixture, name, tri, &net)) return;
    dpt_deformable_def deform; dpt_springs_def springs;
    dpt_deformable_def_init(&deform); dpt_springs_def_init(&springs);
    dpt_pose pose = DPT_POSE_IDENTITY; pose.position[2] = z0;
    deform.mesh = springs.mesh = fixture.mesh; deform.pose = &pose; deform.max_points = 64; for (int k = 0; k < 3; k++) { deform.box_min[k] = -1; deform.box_max[k] = 1; }
    springs.integrator = integ; springs.gravity[2] = -9.81; springs.max_substeps = 64;
    springs.sleep_speed = 0.01;
    dpt_body body = rig_add_deformable(&rig, &deform);
    dpt_springs *s = rig_add_springs(&rig, &springs);
    dpt_body_settings set = { .size = sizeof set };
    dpt_body_get_settings(rig.world, body, &set); { double mu = getenv("MU") ? atof(getenv("MU")) : 0.5; set.static_friction = set.kinetic_friction = mu; } dpt_body_set_settings(rig.world, body, &set);
    const dpt_mesh_springs *x; (void)x;
    dpt_mesh_springs mi = { .size = sizeof mi };
    dpt_mesh_get_springs(fixture.mesh, &mi);
    double mass = 0; for (uint32_t i = 0; i < mi.nodes; i++) mass += (double)mi.mass[i];
    dpt_springs_info info = { .size = sizeof info };
    printf("%s mass %g weight %g stable %g\n", name, mass, mass * 9.81, dpt_springs_get_stable_step(s));
    for (int t = 0; t < (int)(5 / dt); t++) {
        dpt_world_step(rig.world, dt, NULL); { static uint32_t lastr; dpt_force_info fi = { .size = sizeof fi }; dpt_tool_get_force_info(rig.world, tools[0], &fi); if (fi.reason == 5 && lastr != 5) printf("AT %d flags %u\n", t, fi.flags); lastr = fi.reason; }
        dpt_result r = dpt_body_step_springs(rig.world, body, s, dt, &info);
        if (r) { printf("t %d result %s\n", t, dpt_result_name(r)); break; }
        double f[3] = {0}; uint32_t fl = 0, st = 0, sl = 0;
        for (int i = 0; i < count; i++) { dpt_force_info fi = { .size = sizeof fi }; dpt_tool_get_force_info(rig.world, tools[i], &fi); for (int k = 0; k < 3; k++) f[k] += fi.wrench.force[k]; fl |= fi.flags; st += fi.sticking; sl += fi.slipping; }
        if (t % (int)(0.5 / dt) == 0 || (getenv("FROM") && t >= atoi(getenv("FROM")) && t < atoi(getenv("FROM")) + 12)) { { dpt_pose pr; dpt_tool_get_proxy(rig.world, tools[0], &pr); dpt_force_info fi = { .size = sizeof fi }; dpt_tool_get_force_info(rig.world, tools[0], &fi); const float *vp; uint32_t vc; dpt_body_get_vertices(rig.world, body, &vp, &vc); double zmax = -9; for (uint32_t q = 0; q < vc; q++) zmax = fmax(zmax, vp[3*q+2]); printf(" [reason %u proxy %.5f %.5f top %.5f]", fi.reason, pr.position[0], pr.position[2], zmax + z0); } printf("  t %.3f f %.5f %.5f %.5f flags %u st %u sl %u active %u substeps %u\n", t * dt, f[0], f[1], f[2], fl, st, sl, info.active, info.substeps); }
    }
    rig_close(&rig);
    fixture_free(&fixture);
}

static void explore(void)
{
    const dpt_segment rod = { { 0.003, -0.2, 0 }, { 0.003, 0.2, 0 }, 0.004 };
    const dpt_segment ball = { { 0.0, 0.0, 0 }, { 0.0, 0.0, 0 }, 0.04 };
    const dpt_segment three[3] = { { { -0.05, -0.2, 0 }, { -0.05, 0.2, 0 }, 0.004 }, { { 0.05, -0.2, 0 }, { 0.05, 0.2, 0 }, 0.004 }, { {-0.2, 0.05, 0}, {0.2, 0.05, 0}, 0.004 } };
    weigh("membrane", 512, DPT_NET_SHEET, &rod, 1, 0.01, 0, 1e-3);
    weigh("membrane", 512, DPT_NET_SHEET, &ball, 1, 0.05, 0, 1e-3);
    weigh("cloth", 2048, DPT_NET_SHEET, &rod, 1, 0.03, 0, 1e-3);
    weigh("sphere", 512, DPT_NET_VOLUME, three, 3, 0.1, 0, 1e-3);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(explore);
    return check_report();
}
