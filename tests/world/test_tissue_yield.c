/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Tissue whose own surface yields, in series with springs and coupling (dpt_body_settings.stiffness), solved together with the
 * tools that touch it: how stiff it is felt, that it is silent under a tool that is held still, and its energy.
 *
 *     test_tissue_yield [PER CENT = 100]
 */
#include "world/tissue_rig.h"

/* N: of a tool upright on its tip, 3 mm deep in tissue that hardly gives way. */
static double hold(double coupling, double surface)
{
    struct tissue_rig tissue;
    double mean = 0.0;
    struct tissue_def def = tissue_asleep(DPT_NET_VOLUME, DPT_INTEGRATOR_IMPLICIT);
    def.young = 3e8;
    tissue_rig_open_rod(&tissue, coupling, 0.0, 0.004);
    if (tissue_rig_add_soft(&tissue, &def)) {
        tissue_body_soften(&tissue, &tissue.body[0], surface);
        tissue_rod_press_and_hold(&tissue, 0.003, &mean);
    }
    tissue_rig_close(&tissue);
    return mean;
}

/* Coupling and surface are felt one after the other. */
static void it_is_in_series(void)
{
    static const double stiffness[][2] = { { 500.0, 250.0 }, { 2000.0, 800.0 }, { 500.0, 5000.0 } };
    for (int i = 0; i < 3; i++) {
        const double coupling = stiffness[i][0], surface = stiffness[i][1];
        const double hard = hold(coupling, 0.0), expected = hard / (1.0 + coupling / surface);
        const double found = hold(coupling, surface);
        CHECK(hard > 1.0, "case %d: %g N", i, hard);
        CHECK(fabs(found - expected) <= 0.01 * expected, "case %d: %g N, not %g", i, found, expected);
    }
}

static void it_is_silent(void)
{
    static const double leans[] = { 0.0, 0.6, 1.2, 1.5708 };
    for (int kind = 0; kind < 2; kind++)
        for (int i = 0; i < (int)part_of(24); i++) {
            struct tissue_rig tissue;
            double mean;
            const struct tissue_def def =
                tissue_asleep(kind ? DPT_NET_SHEET : DPT_NET_VOLUME, tissue_integrators[i % 3]);
            struct tissue_tool *rod = tissue_rig_open_rod(&tissue, i & 1 ? 2000.0 : 200.0, leans[i / 6], 0.004);
            if (tissue_rig_add_soft(&tissue, &def)) {
                tissue_body_soften(&tissue, &tissue.body[0], i / 3 & 1 ? 300.0 : 3000.0);
                const double jump = tissue_rod_press_and_hold(&tissue, 0.006, &mean);
                CHECK(mean > 1e-3, "case %d: it is not touched: %g N", i, mean);
                CHECK(jump <= fmax(1e-3 * mean, 1e-4), "case %d: jumps of %g N at %g N", i, jump, mean);
                CHECK(!(rod->force.flags & DPT_FORCE_FLAG_CROWDED), "case %d: flags %u", i, rod->force.flags);
            }
            tissue_rig_close(&tissue);
        }
}

/* Pressed in and out again, slowly: the hand gets back no more than it gave, and the energy that is told is what it gave. */
static void it_gives_no_energy(void)
{
    for (int i = 0; i < 3; i++) {
        struct tissue_rig tissue;
        double given = 0.0, most = 0.0, force = 0.0, told = 0.0, moved = 0.0;
        const struct tissue_def def = tissue_asleep(DPT_NET_VOLUME, tissue_integrators[i]);
        struct tissue_tool *rod = tissue_rig_open_rod(&tissue, 500.0, 0.8, 0.004);
        if (tissue_rig_add_soft(&tissue, &def)) {
            tissue_body_soften(&tissue, &tissue.body[0], 400.0);
            tissue_rod_lower(&tissue, -0.001);
            tissue_rig_place(&tissue);
            for (int t = 0; t <= 1600; t++) {
                const double from = rod->device.position[2];
                tissue_rod_lower(&tissue, 0.005 * sin(3.1415926 * t / 1600.0) - 0.0005);
                tissue_rig_tick(&tissue);
                given -= 0.5 * (force + rod->force.wrench.force[2]) * (rod->device.position[2] - from);
                force = rod->force.wrench.force[2];
                told = rod->force.energy;
                moved += rod->force.body_work;
                most = fmax(most, given);
                CHECK(fabs(told - moved - given) <= 1e-9 + 1e-6 * most, "tick %d: %g J of %g, %g J by the body", t,
                      told, given, moved);
            }
        }
        CHECK(most > 1e-4 && given >= -1e-3 * most, "%g J of %g are given back", -given, most);
        CHECK(force == 0.0, "%g N at the end", force);
        tissue_rig_close(&tissue);
    }
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(it_is_in_series);
    TEST(it_is_silent);
    TEST(it_gives_no_energy);
    return check_report();
}
