/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a budget does to the side of an open sheet: a side that is not decided yet pushes nobody, and is decided as if
 * there were no budget as soon as the work is done. The truth is a world without a budget, and a flat sheet whose depth
 * is known in closed form.
 */
#include "track/budget_contact_scene.h"

/* The sweep found the side of a sheet in a tick that had nothing left for the contact. */
static void a_side_waits_for_its_contact(void)
{
    struct subject sheet;
    uint32_t waited = 0;
    if (!subject_from_shape(&sheet, "membrane", 512))
        return;
    contact_margin = 0.002;
    for (uint32_t budget = 2; budget < 60; budget++) {
        const dpt_segment above = { { 0.01, 0.02, 0.006 }, { 0.012, 0.02, 0.035 }, 0.0005 };
        const dpt_segment through = { { 0.01, 0.02, -0.001 }, { 0.012, 0.02, 0.028 }, 0.0005 };
        contact_world_open(&small_world, sheet.mesh, &above, budget);
        for (int tick = 0; tick < 20; tick++)
            contact_world_step(&small_world);
        dpt_tool_set_segments(small_world.rig.world, small_world.rig.tool, &through, 1);
        contact_world_step(&small_world);
        dpt_sweep sweep = { .size = sizeof sweep };
        dpt_tool_get_sweep(small_world.rig.world, small_world.rig.tool, 0, &sweep);
        int found = sweep.status == DPT_SWEEP_HIT, at_once = is_known(&small_world);
        for (int tick = 0; tick < 20 && !is_known(&small_world); tick++)
            contact_world_step(&small_world);
        waited += found && !at_once && is_known(&small_world);
        if (is_known(&small_world))
            CHECK(small_world.rig.hit.contact == DPT_CONTACT_PENETRATING &&
                      fabs(small_world.rig.hit.gap + 0.0015) < 1e-6,
                  "budget %u: contact %u, gap %g", budget, small_world.rig.hit.contact, small_world.rig.hit.gap);
        CHECK(!found || budget < 30 || is_known(&small_world), "budget %u: the side is lost", budget);
        rig_close(&small_world.rig);
    }
    printf("    %u budgets found the side first\n", waited);
    CHECK(waited > 0, "none");
    subject_close(&sheet);
}

/* Over the flat sheet, far enough from its borders that no nearest point lies there. */
static dpt_segment inner_axis(uint64_t *seed)
{
    dpt_segment axis = { .radius = 0.0 };
    for (int k = 0; k < 3; k++) {
        axis.a[k] = random_in(seed, -0.06, 0.06) * (k == 2 ? 0.5 : 1.0);
        axis.b[k] = random_in(seed, -0.06, 0.06) * (k == 2 ? 0.5 : 1.0);
    }
    return axis;
}

/*
 * Through the flat sheet and back, again and again, from the front, slowly and so fast that the nearest pair is bounded
 * too: whatever is unknown on the way, what is told is right. Behind is how deep the lower end is; in front nothing
 * pushes.
 */
static void a_side_outlives_what_is_unknown(void)
{
    static const uint32_t budgets[] = { 25, 50, 100, 200 };
    struct subject sheet;
    uint64_t seed = 5;
    if (!subject_from_shape(&sheet, "membrane", 512))
        return;
    contact_margin = 0.001;
    for (uint32_t run = 0; run < 8; run++) {
        dpt_segment axis = inner_axis(&seed), way = axis;
        uint32_t known = 0, unknown = 0, behind = 0, through = 0;
        axis.a[2] = axis.b[2] = 0.02;
        contact_world_open(&small_world, sheet.mesh, &axis, budgets[run % 4]);
        for (uint32_t tick = 0; tick < 2 * tick_count(); tick++) {
            if (tick % 150 == 50)
                way = inner_axis(&seed);
            for (int k = 0; k < 3; k++) {
                axis.a[k] += (way.a[k] - axis.a[k]) / (run < 4 ? 100.0 : 5.0);
                axis.b[k] += (way.b[k] - axis.b[k]) / (run < 4 ? 100.0 : 5.0);
            }
            dpt_tool_set_segments(small_world.rig.world, small_world.rig.tool, &axis, 1);
            contact_world_step(&small_world);
            const double low = fmin(axis.a[2], axis.b[2]), high = fmax(axis.a[2], axis.b[2]);
            unknown += !is_known(&small_world);
            if (!is_known(&small_world))
                continue;
            known++;
            behind += low < -1e-5;
            through += high < -1e-5;
            CHECK(fabs(small_world.rig.hit.gap - low) < 1e-5, "budget %u, tick %u: gap %g, not %g (%g)",
                  budgets[run % 4], tick, small_world.rig.hit.gap, low, high);
            dpt_wrench wrench;
            dpt_tool_get_wrench(small_world.rig.world, small_world.rig.tool, &wrench);
            CHECK(low < -1e-5 ? wrench.force[2] > 0.0 : low < 0.0 || wrench.force[2] == 0.0,
                  "budget %u, tick %u: force %g", budgets[run % 4], tick, wrench.force[2]);
        }
        printf("    budget %3u: %u ticks known, %u unknown, %u behind, %u wholly\n", budgets[run % 4], known, unknown,
               behind, through);
        rig_close(&small_world.rig);
    }
    subject_close(&sheet);
}

/*
 * Through the sheet near its border, out over that and round to the other side, where a side that is kept would push it
 * up. What is unknown on the way must not keep it: nothing pushes once it is round.
 */
static void a_side_ends_at_the_border(void)
{
    static const double way[][3] = { { 0.09, 0.03, 60 },   { 0.09, -0.004, 60 }, { 0.106, -0.004, 30 },
                                     { 0.106, -0.04, 60 }, { 0.07, -0.04, 60 },  { 0.07, -0.0215, 200 } };
    struct subject sheet;
    uint32_t unknown = 0, pushed = 0, known = 0;
    if (!subject_from_shape(&sheet, "membrane", 512))
        return;
    contact_margin = 0.001;
    for (uint32_t budget = 5; budget <= 100; budget += 5) {
        dpt_segment axis = { { way[0][0], -0.0723, way[0][1] }, { way[0][0], 0.0723, 0.0 }, 0.0 };
        axis.b[2] = axis.a[2] + 0.005;
        contact_world_open(&small_world, sheet.mesh, &axis, budget);
        for (size_t leg = 0; leg < sizeof way / sizeof *way; leg++) {
            const double from[2] = { axis.a[0], axis.a[2] };
            for (int tick = 1; tick <= (int)way[leg][2]; tick++) {
                double t = tick / way[leg][2];
                axis.a[0] = axis.b[0] = from[0] + t * (way[leg][0] - from[0]);
                axis.a[2] = from[1] + t * (way[leg][1] - from[1]);
                axis.b[2] = axis.a[2] + 0.005;
                dpt_tool_set_segments(small_world.rig.world, small_world.rig.tool, &axis, 1);
                contact_world_step(&small_world);
                unknown += leg == 1 && !is_known(&small_world);
                pushed += leg == 1 && small_world.rig.hit.contact == DPT_CONTACT_PENETRATING;
                known += leg == 5 && is_known(&small_world);
                CHECK(leg < 4 || small_world.rig.hit.contact != DPT_CONTACT_PENETRATING,
                      "budget %u, leg %zu, %d: gap %g", budget, leg, tick, small_world.rig.hit.gap);
            }
        }
        rig_close(&small_world.rig);
    }
    printf("    through: %u ticks unknown, %u pushed; then %u known\n", unknown, pushed, known);
    CHECK(unknown > 100 && pushed > 10 && known > 3900, "%u, %u, %u", unknown, pushed, known);
    subject_close(&sheet);
}

/*
 * Over the borders of a cloth with folds, where stretches are behind that no crossing tells of: they are found where
 * they were a tick ago, known or not. Else each tick would look for them anew, and most would be unknown. And a tool
 * that is free again is soon known to be, with little.
 */
static void what_is_unknown_goes_on(void)
{
    static const uint32_t budgets[2] = { SMALL, SMALL / 4 };
    for (int b = 0; b < 2; b++) {
        struct subject cloth;
        uint64_t seed = 7;
        uint32_t near = 0, near_unknown = 0, free_ticks = 0, free_unknown = 0;
        if (!subject_from_shape(&cloth, "cloth", 800))
            return;
        contact_margin = 0.001;
        dpt_segment axis = random_axis(&cloth, &seed, 0.9), way = axis;
        contact_world_open(&ample_world, cloth.mesh, &axis, 0);
        contact_world_open(&small_world, cloth.mesh, &axis, budgets[b]);
        for (uint32_t tick = 0; tick < 4 * tick_count(); tick++) {
            if (tick % 150 == 0)
                way = random_axis(&cloth, &seed, 0.9);
            for (int k = 0; k < 3; k++) {
                const double away = k == 2 && tick / 150 % 4 == 3 ? 0.2 : 0.0;
                axis.a[k] += (way.a[k] + away - axis.a[k]) / 100.0;
                axis.b[k] += (way.b[k] + away - axis.b[k]) / 100.0;
            }
            dpt_tool_set_segments(ample_world.rig.world, ample_world.rig.tool, &axis, 1);
            dpt_tool_set_segments(small_world.rig.world, small_world.rig.tool, &axis, 1);
            contact_world_step(&ample_world);
            contact_world_step(&small_world);
            near += is_known(&ample_world) && ample_world.count;
            near_unknown += is_known(&ample_world) && ample_world.count && !is_known(&small_world);
            free_ticks += is_known(&ample_world) && !ample_world.count;
            free_unknown += is_known(&ample_world) && !ample_world.count && !is_known(&small_world);
        }
        rig_close(&ample_world.rig);
        rig_close(&small_world.rig);
        printf("    budget %3u: of %u ticks in reach %u are unknown, of %u that are free %u\n", budgets[b], near,
               near_unknown, free_ticks, free_unknown);
        CHECK(near > tick_count() && (b || near_unknown < near / 8), "%u of %u", near_unknown, near);
        CHECK(free_ticks > tick_count() / 4 && free_unknown < free_ticks / 100, "%u of %u", free_unknown, free_ticks);
        subject_close(&cloth);
    }
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(a_side_waits_for_its_contact);
    TEST(a_side_outlives_what_is_unknown);
    TEST(a_side_ends_at_the_border);
    TEST(what_is_unknown_goes_on);
    return check_report();
}
