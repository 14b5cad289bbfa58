/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The penalty against closed forms: a capsule over a plane and under it, a ball in a sphere, with normals of the faces
 * and smooth ones. And that input which is no number, or is missing, gives no force.
 */
#include "world/small_def.h"

/* On a flat sheet k (r - h) along its normal, on the side that the tool came from; torque about the tool's origin. */
static void penalty_on_a_plane(void)
{
    struct fixture sheet;
    struct rig made;
    dpt_world_def def = small_def();
    if (!fixture_from_shape(&sheet, "membrane", 0))
        return;
    dpt_segment part = capsule(-0.03, 0, 0, 0.02, 0, 0.001, 0.004);
    rig_open(&made, &def, sheet.mesh, &part, 1);
    for (int way = -1; way <= 1; way += 2)
        for (int i = 60; i >= -60; i--) {
            double height = 1e-4 * way * i + 3e-5;
            dpt_pose pose = { { 0.005, 0.007, height }, { 1, 0, 0, 0 } };
            dpt_wrench wrench;
            if (i == 60)
                dpt_tool_teleport(made.world, made.tool, &pose);
            else
                rig_step_to(&made, &pose);
            dpt_tool_get_wrench(made.world, made.tool, &wrench);
            /* From above the end a is the deepest, from below b, 0.001 higher. */
            double force = way > 0 ? 500.0 * fmax(0.0, 0.004 - height) : -500.0 * fmax(0.0, 0.004 + height + 0.001);
            double arm = way > 0 ? -0.03 : 0.02;
            CHECK(fabs(wrench.force[2] - force) < 1e-9, "%g N, not %g at %g", wrench.force[2], force, height);
            CHECK(fabs(wrench.force[0]) + fabs(wrench.force[1]) < 1e-9, "not along the normal");
            CHECK(fabs(wrench.torque[1] + arm * force) < 1e-9, "%g Nm, not %g", wrench.torque[1], -arm * force);
        }
    /* As free segments in the world, the torque is about the end a. */
    dpt_wrench wrench;
    dpt_segment world_part = capsule(-0.01, 0, 0.003, 0.04, 0, 0.001, 0.004);
    dpt_tool_set_segments(made.world, made.tool, &world_part, 1);
    rig_tick(&made);
    dpt_tool_get_wrench(made.world, made.tool, &wrench);
    CHECK(fabs(wrench.force[2] - 1.5) < 1e-12, "%g N", wrench.force[2]);
    CHECK(fabs(wrench.torque[1] + 0.05 * 1.5) < 1e-12, "%g Nm", wrench.torque[1]);
    rig_close(&made);
    fixture_free(&sheet);
}

/* A point in a ball is pushed along the radius; a fine sphere bounds the error by its facets. */
static void penalty_in_a_sphere(void)
{
    struct fixture sphere;
    struct rig made;
    dpt_world_def def = small_def();
    dpt_mesh_info info = { .size = sizeof info };
    if (!fixture_from_shape(&sphere, "sphere", 20000))
        return;
    dpt_mesh_get_info(sphere.mesh, &info);
    double radius = info.box_max[2], facet = 2e-3 * radius;
    dpt_segment point = capsule(0, 0, 0, 0, 0, 0, 0.003);
    rig_open(&made, &def, sphere.mesh, &point, 1);
    uint64_t random = 21;
    for (int i = 0; i < 2000; i++) {
        double x[3], size = 0.0;
        for (int k = 0; k < 3; k++)
            size += pow(x[k] = random_in(&random, -1.0, 1.0), 2.0);
        double from_centre = random_in(&random, 0.5, 1.1) * radius;
        dpt_pose pose = DPT_POSE_IDENTITY;
        for (int k = 0; k < 3; k++)
            pose.position[k] = x[k] * from_centre / sqrt(size);
        dpt_wrench wrench;
        rig_step_to(&made, &pose);
        dpt_tool_get_wrench(made.world, made.tool, &wrench);
        double expected = 500.0 * fmax(0.0, radius + 0.003 - from_centre), along_radius = 0.0;
        double total = 0.0;
        for (int k = 0; k < 3; k++) {
            along_radius += wrench.force[k] * x[k] / sqrt(size);
            total += pow(wrench.force[k], 2.0);
        }
        CHECK(fabs(along_radius - expected) < 500.0 * facet, "%g N, not %g", along_radius, expected);
        CHECK(along_radius >= 0.995 * sqrt(total), "%g of %g N along the radius", along_radius, sqrt(total));
    }
    rig_close(&made);
    fixture_free(&sphere);
}

/* A ball over a coarse sphere: smoothed, the way out follows the radius better, and nothing else changes. */
static void smooth_normals_change_the_way_out_alone(void)
{
    struct fixture sphere;
    struct rig made[2];
    double off[2] = { 0.0, 0.0 };
    uint64_t random = 77;
    uint32_t contacts = 0;
    if (!fixture_from_shape(&sphere, "sphere", 320))
        return;
    dpt_segment ball = capsule(0, 0, 0, 0, 0, 0, 0.01);
    dpt_mesh_info info = { .size = sizeof info };
    dpt_mesh_get_info(sphere.mesh, &info);
    for (uint32_t k = 0; k < 2; k++) {
        dpt_world_def def = small_def();
        def.smooth_normals = k;
        rig_open(&made[k], &def, sphere.mesh, &ball, 1);
    }
    for (int i = 0; i < 1000; i++) {
        dpt_pose pose = DPT_POSE_IDENTITY;
        double size = 0.0, far = info.box_max[2] * random_in(&random, 0.9, 1.1);
        for (int k = 0; k < 3; k++)
            size += pow(pose.position[k] = random_in(&random, -1.0, 1.0), 2.0);
        for (int k = 0; k < 3; k++)
            pose.position[k] *= far / sqrt(size);
        dpt_contact c[2] = { { .size = sizeof *c }, { .size = sizeof *c } };
        uint32_t count[2];
        for (int k = 0; k < 2; k++) {
            dpt_tool_teleport(made[k].world, made[k].tool, &pose);
            rig_tick(&made[k]);
            dpt_tool_get_contacts(made[k].world, made[k].tool, &c[k], 1, &count[k]);
        }
        CHECK(count[0] == count[1] && c[0].gap == c[1].gap && c[0].contact == c[1].contact &&
                  memcmp(c[0].q, c[1].q, sizeof c[0].q) == 0,
              "%u and %u regions, gaps %g and %g", count[0], count[1], c[0].gap, c[1].gap);
        for (int k = 0; k < 2 && count[0]; k++) {
            double along_radius = 0.0, square = 0.0;
            for (int j = 0; j < 3; j++) {
                along_radius += c[k].normal[j] * pose.position[j] / far;
                square += c[k].normal[j] * c[k].normal[j];
            }
            CHECK(fabs(square - 1.0) < 1e-12, "a normal of length %g", sqrt(square));
            off[k] += 1.0 - along_radius;
        }
        contacts += count[0];
    }
    CHECK(contacts > 300 && off[1] < 0.5 * off[0], "%u contacts, off %g and %g", contacts, off[0], off[1]);
    rig_close(&made[0]);
    rig_close(&made[1]);
    fixture_free(&sphere);
}

static void bad_input_gives_no_force(void)
{
    struct fixture box;
    struct rig made;
    dpt_world_def def = small_def();
    dpt_wrench wrench;
    dpt_step out = { .size = sizeof out };
    dpt_hit hit = DPT_HIT_INIT;
    if (!fixture_from_shape(&box, "box", 12))
        return;
    dpt_segment part = capsule(0, 0, 0, 0.01, 0, 0, 0.01);
    rig_open(&made, &def, NULL, &part, 1);
    CHECK(dpt_world_step(made.world, 1e-3, &out) == DPT_OK && out.status == DPT_STATUS_STALE, "empty");
    const dpt_body body = rig_add_body(&made, box.mesh, NULL);
    dpt_pose good = DPT_POSE_IDENTITY, bad = DPT_POSE_IDENTITY;
    bad.position[2] = NAN;
#define FORCE_IS(condition, what)                                                                                      \
    dpt_tool_get_wrench(made.world, made.tool, &wrench);                                                               \
    dpt_tool_get_hit(made.world, made.tool, &hit);                                                                     \
    CHECK((wrench.force[0] != 0.0 || wrench.force[1] != 0.0 || wrench.force[2] != 0.0) == (condition), what);          \
    CHECK((hit.status == DPT_STATUS_EXACT) == (condition), what " (status)")
    dpt_world_step(made.world, 1e-3, &out);
    FORCE_IS(1, "inside the box");
    CHECK(dpt_tool_set_pose(made.world, made.tool, &bad) == DPT_E_FINITE, "nan");
    dpt_world_step(made.world, 1e-3, &out);
    FORCE_IS(0, "tool pose is nan");
    dpt_tool_set_pose(made.world, made.tool, &good);
    dpt_world_step(made.world, 1e-3, &out);
    FORCE_IS(1, "tool pose is good again");
    CHECK(dpt_body_set_pose(made.world, body, &bad) == DPT_E_FINITE, "nan");
    dpt_world_step(made.world, 1e-3, &out);
    FORCE_IS(0, "body pose is nan");
    dpt_body_set_pose(made.world, body, &good);
    CHECK(dpt_world_step(made.world, NAN, &out) == DPT_E_ARGUMENT, "dt");
    FORCE_IS(0, "dt is nan");
    CHECK(dpt_world_step(made.world, 0.0, &out) == DPT_E_ARGUMENT, "dt 0");
    dpt_world_step(made.world, 1e-3, &out);
    FORCE_IS(1, "dt is good again");
    out.size = 4;
    CHECK(dpt_world_step(made.world, 1e-3, &out) == DPT_E_SIZE, "size");
    FORCE_IS(0, "after an error");
    part.a[1] = INFINITY;
    CHECK(dpt_tool_set_segments(made.world, made.tool, &part, 1) == DPT_E_FINITE, "inf");
    rig_tick(&made);
    FORCE_IS(0, "segments are infinite");
#undef FORCE_IS
    rig_close(&made);
    fixture_free(&box);
}

/* Any bits as numbers: no NaN comes out, ever. */
static void garbage_in_numbers_out(void)
{
    struct fixture torus;
    struct rig made;
    dpt_world_def def = small_def();
    uint64_t random = 77;
    if (!fixture_from_shape(&torus, "torus", 500))
        return;
    dpt_segment part = capsule(0, 0, 0, 0.1, 0, 0, 0.01);
    rig_open(&made, &def, torus.mesh, &part, 1);
    for (int i = 0; i < 50000; i++) {
        double number[14];
        for (int k = 0; k < 14; k++) {
            uint64_t bits = random_bits(&random);
            memcpy(&number[k], &bits, sizeof bits);
            if (bits % 3)
                number[k] = random_in(&random, -1.0, 1.0);
        }
        dpt_pose pose;
        memcpy(&pose, number, sizeof pose);
        memcpy(&part, number + 7, sizeof part);
        dpt_tool_set_pose(made.world, made.tool, &pose);
        if (i % 2)
            dpt_tool_set_segments(made.world, made.tool, &part, 1);
        if (i % 5 == 0)
            dpt_body_set_pose(made.world, made.body, &pose);
        if (i % 5 == 1)
            dpt_body_set_pose(made.world, made.body, &(dpt_pose)DPT_POSE_IDENTITY);
        dpt_world_step(made.world, i % 50 ? 1e-3 : number[3], NULL);
        dpt_hit hit = DPT_HIT_INIT;
        dpt_wrench wrench;
        dpt_tool_get_hit(made.world, made.tool, &hit);
        dpt_tool_get_wrench(made.world, made.tool, &wrench);
        double sum = hit.distance + hit.gap + hit.depth + hit.s + hit.error_bound + hit.lower_bound;
        for (int k = 0; k < 3; k++)
            sum += hit.p[k] + hit.q[k] + wrench.force[k] + wrench.torque[k];
        CHECK(isfinite(sum), "round %d", i);
    }
    rig_close(&made);
    fixture_free(&torus);
}

int main(void)
{
    TEST(penalty_on_a_plane);
    TEST(penalty_in_a_sphere);
    TEST(smooth_normals_change_the_way_out_alone);
    TEST(bad_input_gives_no_force);
    TEST(garbage_in_numbers_out);
    return check_report();
}
