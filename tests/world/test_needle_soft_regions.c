/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Regions of a body that gives way (dpt_body_set_regions): each wall ruptures by the law of its triangle, each layer cuts
 * and rubs by that of the triangle by which the needle goes in, as of a rigid body; what cannot be given is refused.
 */
#include "world/soft_needle.h"

enum { TRIANGLES_MOST = 12 * SOFT_NEEDLE_CELLS * SOFT_NEEDLE_CELLS * SOFT_NEEDLE_CELLS };

#define STIFFNESS 500.0

static const dpt_body_region
    soft = { .size = sizeof soft, .puncture_force = 0.3, .cutting_force = 0.05, .shaft_friction = 10.0 },
    tough = { .size = sizeof tough, .puncture_force = 0.9, .cutting_force = 0.2, .shaft_friction = 35.0 };

static int is_in(const struct soft_needle *needle)
{
    return (needle->tool->force.flags & DPT_FORCE_FLAG_INSERTED) != 0;
}

/* N: along the needle, where its spring ends, against going in. */
static double axial(const struct soft_needle *needle)
{
    double ends[6], force = 0.0;
    tissue_tool_end(needle->tool, ends);
    for (int k = 0; k < 3; k++)
        force += needle->tool->force.wrench.force[k] * (ends[3 + k] - ends[k]) / NEEDLE_LENGTH;
    return force;
}

static void check_near(double is, double wanted, const char *what, int kind)
{
    CHECK(fabs(is - wanted) <= 0.02 * fabs(wanted), "%d: %s is %.6g, not %.6g", kind, what, is, wanted);
}

/* The number of each triangle, by the height of its middle at rest: 2 beneath, 1 above. */
static uint32_t number_triangles(const struct soft_needle *needle, double height, uint8_t *of)
{
    dpt_mesh_info info = { .size = sizeof info };
    dpt_mesh_get_info(needle->body->mesh.mesh, &info);
    CHECK(info.source_triangles <= TRIANGLES_MOST, "%u triangles", info.source_triangles);
    for (uint32_t i = 0; i < info.source_triangles; i++) {
        double corners[9];
        dpt_mesh_get_triangle(needle->body->mesh.mesh, i, corners);
        of[i] = corners[2] + corners[5] + corners[8] < 3.0 * height ? 2 : 1;
    }
    return info.source_triangles;
}

static void set_regions(struct soft_needle *needle, const uint8_t *of, uint32_t triangles, const dpt_body_region *first,
                        const dpt_body_region *second)
{
    const dpt_body_region both[2] = { *first, *second };
    const dpt_result result = dpt_body_set_regions(needle->tissue.rig.world, needle->body->id, of, triangles, both, 2);
    CHECK(result == DPT_OK, "regions: %s", dpt_result_name(result));
}

/* Of a mesh that is open beside: two plates of 30 mm, 20 mm apart, which hang together on one side. */
static int is_bracket(int x, int y, int z)
{
    (void)y;
    return x < 2 || z < 3 || z >= 5;
}

/* Down to a depth, and there it stands. Returns the largest force on the way. */
static double peak_to(struct soft_needle *needle, double depth)
{
    double most = 0.0;
    while (needle->depth < depth) {
        needle->depth += NEEDLE_SLOW;
        soft_needle_tick(needle);
        most = fmax(most, axial(needle));
    }
    soft_needle_hold(needle, 200);
    return most;
}

/* Likewise the largest of the tip alone, in the channel: what friction takes does not count. */
static double pressed_to(struct soft_needle *needle, double depth)
{
    double most = 0.0;
    while (needle->depth < depth) {
        needle->depth += NEEDLE_SLOW;
        soft_needle_tick(needle);
        most = fmax(most, soft_needle_channel(needle).tip);
    }
    soft_needle_hold(needle, 200);
    return most;
}

/* The hand goes on by 0.5 mm: the shaft slips, and the tip cuts. */
static double slipping(struct soft_needle *needle)
{
    soft_needle_go(needle, needle->depth + 5e-4);
    return axial(needle);
}

/* Through the upper plate, which is soft, into the lower one. */
static void each_wall_and_layer_has_its_law(void)
{
    for (int i = 0; i < TISSUE_INTEGRATORS; i++) {
        struct tissue_def def = soft_needle_liver(tissue_integrators[i]);
        const dpt_body_settings gel = soft_needle_gel(70.0);
        static uint8_t of[TRIANGLES_MOST];
        struct soft_needle needle;
        double lengths[SOFT_NEEDLE_STRETCHES];
        def.arrays = soft_needle_cells(is_bracket);
        def.young = 5e4;
        def.spacing = SOFT_NEEDLE_CELL;
        def.floor = 0.005;
        if (!soft_needle_open(&needle, &def, &gel, STIFFNESS))
            return;
        set_regions(&needle, of, number_triangles(&needle, 0.045, of), &soft, &tough);
        const double slack = 2.0 * STIFFNESS * NEEDLE_SLOW;
        const double first = peak_to(&needle, 0.005);
        CHECK(first >= soft.puncture_force && first <= soft.puncture_force + slack, "%d: the first wall at %g N", i,
              first);
        peak_to(&needle, 0.02);
        const double felt = slipping(&needle);
        CHECK(soft_needle_stretches(&needle, lengths) == 1 && lengths[0] > 0.01, "%d: not in one plate", i);
        check_near(felt, soft.cutting_force + soft.shaft_friction * lengths[0], "in the first plate", i);
        peak_to(&needle, 0.04);
        const double between = slipping(&needle);
        CHECK(soft_needle_stretches(&needle, lengths) == 1 && lengths[0] > 0.028, "%d: not between", i);
        check_near(between, soft.shaft_friction * lengths[0], "between the plates", i);
        const double third = pressed_to(&needle, 0.06);
        CHECK(third >= tough.puncture_force && third <= tough.puncture_force + slack, "%d: the third wall at %g N", i,
              third);
        peak_to(&needle, 0.072);
        const double both = slipping(&needle);
        const uint32_t stretches = soft_needle_stretches(&needle, lengths);
        const dpt_channel channel = soft_needle_channel(&needle);
        CHECK(stretches == 2 && lengths[0] > 0.008, "%d: %u stretches", i, stretches);
        check_near(both, tough.cutting_force + tough.shaft_friction * lengths[0] + soft.shaft_friction * lengths[1],
                   "in both plates", i);
        CHECK(channel.ruptures == 3 && channel.layers == 2 && fabs(channel.friction + channel.tip - both) < 1e-2 * both,
              "%d: %u ruptures, %u layers, %g and %g N", i, channel.ruptures, channel.layers, channel.friction,
              channel.tip);
        soft_needle_close(&needle);
    }
}

/* Physics of somebody else's that tells a compliance: the same plates, and the same law. */
static void others_physics_has_regions(void)
{
    const struct tissue_def def = {
        .arrays = soft_needle_cells(is_bracket), .young = 5e4, .spacing = SOFT_NEEDLE_CELL, .floor = -1.0
    };
    const dpt_body_settings gel = soft_needle_gel(70.0);
    static uint8_t of[TRIANGLES_MOST];
    dpt_deformable_def deform;
    struct soft_needle needle;
    double lengths[SOFT_NEEDLE_STRETCHES];
    dpt_springs *none = NULL;
    if (!soft_needle_open_over(&needle, &def, STIFFNESS))
        return;
    dpt_deformable_def_init(&deform);
    deform.mesh = needle.body->mesh.mesh;
    deform.compliance = 5e-4;
    deform.max_points = 64;
    needle.body->id = rig_add_deformable(&needle.tissue.rig, &deform);
    soft_needle_set_gel(&needle, needle.body, &gel);
    set_regions(&needle, of, number_triangles(&needle, 0.045, of), &soft, &tough);
    while (needle.depth < 0.067) {
        needle.depth += NEEDLE_SLOW;
        soft_needle_aim(&needle);
        tissue_rig_step_world(&needle.tissue);
        dpt_bodies_step_springs(needle.tissue.rig.world, &needle.body->id, &none, 1, needle.tissue.rig.dt, NULL);
        dpt_tool_get_force_info(needle.tissue.rig.world, needle.tool->id, &needle.tool->force);
    }
    const uint32_t stretches = soft_needle_stretches(&needle, lengths);
    CHECK(is_in(&needle) && stretches == 2 && lengths[0] > 0.008, "%u stretches", stretches);
    check_near(axial(&needle),
               tough.cutting_force + tough.shaft_friction * lengths[0] + soft.shaft_friction * lengths[1],
               "in both plates", 0);
    soft_needle_close(&needle);
}

/* Of a ball whose lower half is tough, or cannot be pierced: it goes in by the one law, and is held by the other. */
static void a_far_side_of_its_own(void)
{
    for (int is_hard = 0; is_hard < 2; is_hard++) {
        struct tissue_def def = soft_needle_liver(DPT_INTEGRATOR_IMPLICIT);
        const dpt_body_settings gel = soft_needle_gel(70.0);
        const dpt_body_region hard = { .size = sizeof hard };
        static uint8_t of[TRIANGLES_MOST];
        struct soft_needle needle;
        def.shape = "box";
        def.triangles = 432;
        if (!soft_needle_open(&needle, &def, &gel, STIFFNESS))
            return;
        set_regions(&needle, of, number_triangles(&needle, -0.035, of), &soft, is_hard ? &hard : &tough);
        soft_needle_go(&needle, 0.04);
        check_near(axial(&needle), soft.cutting_force + soft.shaft_friction * soft_needle_inside(&needle), "within",
                   is_hard);
        const double most = pressed_to(&needle, 0.092);
        const dpt_channel channel = soft_needle_channel(&needle);
        CHECK(channel.ruptures == (is_hard ? 1 : 2), "%d: %u ruptures", is_hard, channel.ruptures);
        CHECK(is_hard ? most > 2.0 * tough.puncture_force
                      : most >= tough.puncture_force && most < tough.puncture_force + 0.02,
              "%d: %g N at the far side", is_hard, most);
        soft_needle_close(&needle);
    }
}

/* Its hole closes round it: it counts as inside until it has been outside. Then the other law holds. */
static void a_needle_that_is_in_counts_as_inside(void)
{
    const struct tissue_def def = soft_needle_liver(DPT_INTEGRATOR_SYMPLECTIC);
    const dpt_body_settings gel = soft_needle_gel(15.0);
    static uint8_t of[TRIANGLES_MOST];
    struct soft_needle needle;
    if (!soft_needle_open(&needle, &def, &gel, STIFFNESS))
        return;
    soft_needle_go(&needle, 0.02);
    CHECK(is_in(&needle), "it is not in");
    set_regions(&needle, of, number_triangles(&needle, -1.0, of), &tough, &soft);
    soft_needle_tick(&needle);
    CHECK(!is_in(&needle) && soft_needle_channels(&needle, NULL, 0) == 0 &&
              needle.tool->force.reason == DPT_FORCE_INSIDE,
          "reason %u", needle.tool->force.reason);
    soft_needle_go(&needle, -0.003);
    CHECK(needle.tool->force.reason == DPT_FORCE_FREE, "it cannot be drawn out: reason %u", needle.tool->force.reason);
    const double most = peak_to(&needle, 0.03);
    CHECK(most >= tough.puncture_force && most < tough.puncture_force + 0.05 && is_in(&needle), "%g N", most);
    const double felt = slipping(&needle);
    check_near(felt, tough.cutting_force + tough.shaft_friction * soft_needle_inside(&needle), "the other law", 0);
    /* Without regions, the body's own again. */
    CHECK(dpt_body_set_regions(needle.tissue.rig.world, needle.body->id, NULL, 0, NULL, 0) == DPT_OK, "none");
    soft_needle_go(&needle, -0.003);
    const double own = peak_to(&needle, 0.02);
    CHECK(own >= gel.puncture_force && own < gel.puncture_force + 0.05, "%g N", own);
    soft_needle_close(&needle);
}

/* What nothing pierces takes no region that says otherwise. */
static void what_is_refused(void)
{
    const struct tissue_def def = soft_needle_liver(DPT_INTEGRATOR_SYMPLECTIC);
    const dpt_body_region none = { .size = sizeof none, .shaft_friction = 3.0 };
    static uint8_t of[TRIANGLES_MOST];
    dpt_deformable_def deform;
    struct soft_needle needle;
    if (!soft_needle_open_over(&needle, &def, STIFFNESS))
        return;
    const uint32_t triangles = number_triangles(&needle, -1.0, of);
    dpt_deformable_def_init(&deform);
    deform.mesh = needle.body->mesh.mesh;
    deform.response = DPT_RESPONSE_DISPLACE;
    dpt_world *world = needle.tissue.rig.world;
    needle.body->id = rig_add_deformable(&needle.tissue.rig, &deform);
    CHECK(dpt_body_set_regions(world, needle.body->id, of, triangles, &soft, 1) == DPT_E_UNSUPPORTED, "displaced");
    CHECK(dpt_body_set_regions(world, needle.body->id, of, triangles, &none, 1) == DPT_OK, "none pierces it");
    soft_needle_close(&needle);
}

int main(void)
{
    TEST(each_wall_and_layer_has_its_law);
    TEST(others_physics_has_regions);
    TEST(a_far_side_of_its_own);
    TEST(a_needle_that_is_in_counts_as_inside);
    TEST(what_is_refused);
    return check_report();
}
