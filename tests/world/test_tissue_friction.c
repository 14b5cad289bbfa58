/* SPDX-License-Identifier: BSD-3-Clause */
#include <math.h>
#include "world/tissue_scene.h"

static void explore(void)
{
    static const double leans[] = { 0.0, 0.6, 1.2, 1.5708 };
    for (int kind = 0; kind < 2; kind++)
    for (int i = 0; i < 4; i++) {
        struct tissue tissue;
        double mean;
        tissue_begin(&tissue, 667.0, leans[i]);
        if (tissue_add(&tissue, kind ? DPT_NET_SHEET : DPT_NET_VOLUME, DPT_INTEGRATOR_SYMPLECTIC, 0.0, 0.0)) {
            tissue_roughen(&tissue, 0.5, 0.4);
            const double jump = tissue_press_and_hold(&tissue, 0.006, &mean);
            printf("kind %d lean %g hold: mean %g jump %g flags %u\n", kind, leans[i], mean, jump, tissue.force.flags);
            double x0 = tissue.rig.device.position[1], last = 0, worst = 0;
            for (int t = 0; t < 1500; t++) {
                tissue.rig.device.position[1] = x0 + 2e-5 * (t < 300 ? t : 300);
                double f = tissue_tick(&tissue);
                if (t) worst = fmax(worst, fabs(f - last));
                last = f;
                if (t % 60 == 0 && t < 700) {
                    printf(" y %.2f mm f %.4f %.4f %.4f n %.4f ratio %.3f st %u sl %u fl %u jump %.5f\n", 1e3*(tissue.rig.device.position[1]-x0), tissue.wrench.force[0], tissue.wrench.force[1], tissue.wrench.force[2], f,
                      hypot(tissue.wrench.force[0], tissue.wrench.force[1])/tissue.wrench.force[2], tissue.force.sticking, tissue.force.slipping, tissue.force.flags, worst);
                    worst = 0;
                }
            }
            printf(" held: jump %.6f active %u\n", worst, tissue.info[0].active);
        }
        tissue_close(&tissue);
    }
}

static void damped(void)
{
    for (int i = 0; i < 4; i++) {
        struct tissue tissue;
        double mean, peak = 0, e = 0, w=0, last[3]={0}, worst=0;
        tissue_begin(&tissue, 667.0, 1.2);
        dpt_tool_settings set = { .size = sizeof set };
        dpt_tool_get_settings(tissue.rig.world, tissue.rig.tool, &set);
        set.damping = i * 0.5;
        dpt_tool_set_settings(tissue.rig.world, tissue.rig.tool, &set);
        if (tissue_add(&tissue, DPT_NET_VOLUME, DPT_INTEGRATOR_SYMPLECTIC, 0.0, 0.0)) {
            tissue_roughen(&tissue, 0.5, 0.4);
            double jump = tissue_press_and_hold(&tissue, 0.006, &mean);
            printf("damping %g mean %g jump %g\n", set.damping, mean, jump);
            double lastf = mean, big = 0;
            for (int t = 0; t < 400; t++) { tissue_place(&tissue, 0.006 - 4e-5*t); double f = tissue_tick(&tissue); big = fmax(big, fabs(f-lastf)); if (t % 40 == 0) printf("   %d %.4f e %.3g w %.3g\n", t, f, tissue.force.energy, tissue.force.body_work); lastf = f; }
            printf("  out: biggest jump %g\n", big);
        }
        tissue_close(&tissue);
    }
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(damped);
    return check_report();
}
