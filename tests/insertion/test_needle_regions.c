/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Regions of a body's surface (dpt_body_set_regions): each wall ruptures by the law of its triangle, each layer cuts and
 * rubs by that of the triangle by which the needle goes in; what cannot be given is refused.
 */
#include "insertion/needle_rig.h"

#include "lib/size_checks.h"

enum { PLATES = 2, TRIANGLES = 12 * PLATES };

#define THICK 0.02
#define PITCH 0.03

static const dpt_body_region tough = {
    .size = sizeof tough, .puncture_force = 2.5, .cutting_force = 1.2, .shaft_friction = 90.0, .shaft_viscosity = 20.0
};

/* The greatest force up to a depth. */
static double peak_to(struct needle_rig *needle, double depth)
{
    double most = 0;
    while (needle->depth < depth) {
        needle->depth += 2e-5;
        needle_step(needle);
        most = fmax(most, needle_force(needle));
    }
    return most;
}

static void check_near(double is, double wanted, const char *what)
{
    CHECK(fabs(is - wanted) <= 0.02 * fabs(wanted), "%s is %.6g, not %.6g", what, is, wanted);
}

/* The second plate's whole surface is tough: force against length inside of each layer. */
static void each_wall_and_layer_has_its_law(void)
{
    struct needle_rig needle;
    struct solid pile;
    uint8_t of[TRIANGLES] = { 0 };
    memset(of + 12, 1, 12);
    needle_open_over_plates(&needle, &pile, PLATES, THICK, PITCH);
    CHECK(dpt_body_set_regions(needle.rig.world, needle.rig.body, of, TRIANGLES, &tough, 1) == DPT_OK, "regions");
    check_near(peak_to(&needle, 0.004), 1.0, "the first wall");
    needle_go(&needle, 0.016, 0.02);
    check_near(needle_force(&needle), 0.5 + 40 * needle_channel(&needle).inside, "in the first plate");
    peak_to(&needle, 0.026);
    dpt_channel channel = needle_channel(&needle);
    CHECK(channel.ruptures == 2 && channel.layers == 1, "%u ruptures", channel.ruptures);
    check_near(needle_force(&needle), 40 * THICK, "between the plates");
    check_near(peak_to(&needle, 0.039), 40 * THICK + 2.5, "the tough wall");
    needle_go(&needle, 0.049, 0.02);
    channel = needle_channel(&needle);
    const double second = channel.inside - THICK;
    CHECK(channel.ruptures == 3 && channel.layers == 2 && second > 0.008, "%u ruptures, %g m", channel.ruptures,
          second);
    /* The speed is that of the channel as a whole; viscosity is by the second layer alone. */
    check_near(needle_force(&needle), 1.2 + 40 * THICK + 90 * second + 20 * second * 0.02, "in both plates");
    /* At rest the viscous part ends, and the rest stays. */
    for (int i = 0; i < 200; i++)
        needle_step(&needle);
    const double inside = needle_channel(&needle).inside - THICK;
    check_near(needle_force(&needle), 1.2 + 40 * THICK + 90 * inside, "at rest");
    needle_close(&needle);
    solid_close(&pile);
}

/* One region is the skin of a plate's far side: it holds, while the near side is soft; one that cannot be pierced holds all. */
static void a_far_side_of_its_own(void)
{
    struct needle_rig needle;
    struct solid pile;
    uint8_t of[TRIANGLES] = { 0 };
    dpt_body_region hard = { .size = sizeof hard };
    needle_open_over_plates(&needle, &pile, PLATES, THICK, PITCH);
    /* What a triangle is: by its corners. */
    for (uint32_t i = 0; i < TRIANGLES; i++) {
        double corners[9];
        dpt_mesh_get_triangle(pile.mesh, i, corners);
        of[i] = fmax(corners[2], fmax(corners[5], corners[8])) < NEEDLE_TOP - THICK + 1e-6 && i < 12;
    }
    CHECK(dpt_body_set_regions(needle.rig.world, needle.rig.body, of, TRIANGLES, &tough, 1) == DPT_OK, "regions");
    check_near(peak_to(&needle, 0.004), 1.0, "the near side");
    needle_go(&needle, 0.015, 0.02);
    check_near(needle_force(&needle), 0.5 + 40 * needle_channel(&needle).inside, "the layer is the near side's");
    check_near(peak_to(&needle, 0.0265), 2.5 + 40 * THICK, "the far side");
    CHECK(needle_channel(&needle).ruptures == 2, "%u ruptures", needle_channel(&needle).ruptures);
    needle_go(&needle, -0.01, 0.05);
    CHECK(dpt_body_set_regions(needle.rig.world, needle.rig.body, of, TRIANGLES, &hard, 1) == DPT_OK, "regions");
    CHECK(needle_channels(&needle, NULL, 0) == 0, "its holes close");
    CHECK(peak_to(&needle, 0.05) > 9 && needle_channel(&needle).ruptures == 1, "a hard side is pierced");
    needle_close(&needle);
    solid_close(&pile);
}

/* Its hole closes round it: it counts as inside until it has been outside, as after a teleport of the body. */
static void a_needle_that_is_in_counts_as_inside(void)
{
    struct needle_rig needle;
    struct solid pile;
    const uint8_t of[TRIANGLES] = { 0 };
    needle_open_over_plates(&needle, &pile, PLATES, THICK, PITCH);
    needle_go(&needle, 0.012, 0.02);
    CHECK(needle.rig.force.flags & DPT_FORCE_FLAG_INSERTED, "it is not in");
    CHECK(dpt_body_set_regions(needle.rig.world, needle.rig.body, of, TRIANGLES, &tough, 1) == DPT_OK, "regions");
    needle_step(&needle);
    CHECK(needle_channels(&needle, NULL, 0) == 0 && needle.rig.force.reason == DPT_FORCE_INSIDE, "reason %u, %g N",
          needle.rig.force.reason, needle_force(&needle));
    needle_go(&needle, -0.005, 0.02);
    CHECK(needle.rig.force.reason == DPT_FORCE_FREE, "it cannot be drawn out: reason %u", needle.rig.force.reason);
    check_near(peak_to(&needle, 0.004), 1.0, "the wall");
    needle_close(&needle);
    solid_close(&pile);
}

/* To and fro through both, with all that may differ: no tick gains energy, and each rupture is flagged. */
static void nothing_is_gained(void)
{
    struct needle_rig needle;
    struct solid pile;
    dpt_body_settings gel = needle_gel();
    uint8_t of[TRIANGLES];
    dpt_body_region slick = { .size = sizeof slick, .puncture_force = 0.3, .shaft_friction = 2.0 },
                    both[2] = { slick, tough };
    for (int kind = 0; kind < 4; kind++) {
        struct needle_wander wander = { .seed = 3 + (uint64_t)kind };
        double stored = 0, last = 0, deepest = 0;
        for (int i = 0; i < TRIANGLES; i++)
            of[i] = (uint8_t)((i >= 12) == (kind & 1) ? 1 : 2);
        needle_open_over_plates(&needle, &pile, PLATES, THICK, PITCH);
        gel.shaft_stiffness = kind & 2 ? 6e3 : 0;
        rig_set_body(&needle.rig, gel);
        CHECK(dpt_body_set_regions(needle.rig.world, needle.rig.body, of, TRIANGLES, both, 2) == DPT_OK, "regions");
        wander.depth = needle.depth;
        for (int i = 0; i < (int)part_of(30000); i++) {
            const double before = needle.depth;
            needle_wander(&needle, &wander);
            const double force = needle_force(&needle);
            const double gained = needle.rig.force.energy - stored - 0.5 * (force + last) * (needle.depth - before);
            CHECK(gained <= 1e-9 + 4e-7 * fabs(force), "kind %d, tick %d: %g J gained", kind, i, gained);
            stored = needle.rig.force.energy;
            last = force;
            deepest = fmax(deepest, needle_tip(&needle));
        }
        CHECK(deepest > PITCH + 0.01, "it was never in both: %g", deepest);
        needle_close(&needle);
        solid_close(&pile);
    }
}

static void what_is_refused(void)
{
    struct needle_rig needle;
    struct solid pile;
    uint8_t of[TRIANGLES] = { 0 };
    dpt_body_region regions[DPT_BODY_REGIONS_MAX + 1] = { { .size = sizeof *regions } };
    needle_open_over_plates(&needle, &pile, PLATES, THICK, PITCH);
    dpt_world *world = needle.rig.world;
    const dpt_body body = needle.rig.body;
    for (int i = 0; i <= DPT_BODY_REGIONS_MAX; i++)
        regions[i].size = sizeof *regions;
    CHECK(dpt_body_set_regions(NULL, body, of, TRIANGLES, regions, 1) == DPT_E_ARGUMENT, "no world");
    CHECK(dpt_body_set_regions(world, 0, of, TRIANGLES, regions, 1) == DPT_E_HANDLE, "no body");
    CHECK(dpt_body_set_regions(world, body, NULL, TRIANGLES, regions, 1) == DPT_E_ARGUMENT, "no triangles");
    CHECK(dpt_body_set_regions(world, body, of, TRIANGLES, NULL, 1) == DPT_E_ARGUMENT, "no regions");
    CHECK(dpt_body_set_regions(world, body, of, TRIANGLES - 1, regions, 1) == DPT_E_ARGUMENT, "too few triangles");
    CHECK(dpt_body_set_regions(world, body, of, TRIANGLES, regions, DPT_BODY_REGIONS_MAX + 1) == DPT_E_LIMIT,
          "too many");
    of[TRIANGLES - 1] = 2;
    CHECK(dpt_body_set_regions(world, body, of, TRIANGLES, regions, 1) == DPT_E_INDEX, "a region that is not there");
    of[TRIANGLES - 1] = DPT_BODY_REGIONS_MAX;
    CHECK(dpt_body_set_regions(world, body, of, TRIANGLES, regions, DPT_BODY_REGIONS_MAX) == DPT_OK,
          "as many as there may be");
    const double wrong[] = { -1.0, 2e9, NAN };
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 5; k++) {
            double *numbers = &regions[0].puncture_force;
            numbers[k] = wrong[i];
            CHECK(dpt_body_set_regions(world, body, of, TRIANGLES, regions, DPT_BODY_REGIONS_MAX) == DPT_E_ARGUMENT,
                  "%g", wrong[i]);
            numbers[k] = 0.0;
        }
    /* An array that is not there any more: without regions it is not read. */
    CHECK(dpt_body_set_regions(world, body, (const uint8_t *)(uintptr_t)64, 0, NULL, 0) == DPT_OK, "none");
    check_near(peak_to(&needle, 0.004), 1.0, "without regions the body's own law holds");
    needle_close(&needle);
    solid_close(&pile);
    needle_open(&needle, NULL, 0);
    CHECK(dpt_body_set_regions(needle.rig.world, needle.rig.body, of, 12, regions, 1) == DPT_E_UNSUPPORTED,
          "no channels");
    needle_close(&needle);
}

static struct needle_rig sized_needle;

static dpt_result region_in(void *given)
{
    static const uint8_t of[12];
    return dpt_body_set_regions(sized_needle.rig.world, sized_needle.rig.body, of, 12, given, 1);
}

static void the_struct_is_taken_as_far_as_it_goes(void)
{
    static const struct sized in = { "dpt_body_region", sizeof(dpt_body_region), sizeof(dpt_body_region), region_in };
    needle_open(&sized_needle, NULL, 1);
    check_input(&in, &tough);
    needle_close(&sized_needle);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(each_wall_and_layer_has_its_law);
    TEST(a_far_side_of_its_own);
    TEST(a_needle_that_is_in_counts_as_inside);
    TEST(nothing_is_gained);
    TEST(what_is_refused);
    TEST(the_struct_is_taken_as_far_as_it_goes);
    return check_report();
}
