/* SPDX-License-Identifier: BSD-3-Clause */
/* A tool without a proxy feels its curved tip through dpt_tool_set_shaper: on a plate, and pressed on a liver. */
#include "convex/convex_shapes.h"
#include "lib/fixture.h"
#include "lib/rig.h"

static uint64_t seed = 21;
static struct fixture liver, plate;

struct scene {
    struct rig rig;
    dpt_pose body_pose;
    dpt_convex_shape shape;
    dpt_convex_body body;
    dpt_convex_contact contact;
    dpt_convex_shaper shaper;
};

static void open_scene(struct scene *scene, const dpt_mesh *mesh, uint32_t law, uint32_t tip_law)
{
    const dpt_world_def def = rig_def(law);
    /* The segment is up the shaft: the tip alone is felt. */
    const dpt_segment shaft = { { 0.0, 0.0, 0.05 }, { 0.0, 0.0, 0.1 }, 0.001 };
    memset(scene, 0, sizeof *scene);
    scene->body_pose = (dpt_pose){ { 0.01, -0.02, 0.03 }, { 0.6, 0.0, 0.8, 0.0 } };
    rig_open(&scene->rig, &def, NULL, &shaft, 1);
    rig_add_body(&scene->rig, mesh, &scene->body_pose);
    scene->shape = (dpt_convex_shape){ .size = sizeof scene->shape,
                                       .kind = DPT_CONVEX_KIND_ELLIPSOID,
                                       .flags = DPT_CONVEX_FLAG_OUTSIDE,
                                       .pose = DPT_POSE_IDENTITY,
                                       .extent = { 0.006, 0.004, 0.01 },
                                       .outside = { 0.0, 0.0, 0.02 } };
    scene->body = (dpt_convex_body){ mesh, &scene->body_pose };
    scene->contact.size = sizeof scene->contact;
    scene->shaper = (dpt_convex_shaper){ .size = sizeof scene->shaper,
                                         .law = tip_law,
                                         .world = scene->rig.world,
                                         .shape = &scene->shape,
                                         .bodies = &scene->body,
                                         .contact = &scene->contact,
                                         .tool = scene->rig.tool,
                                         .body_count = 1,
                                         .stiffness = 400.0 };
    CHECK(dpt_tool_set_shaper(scene->rig.world, scene->rig.tool, dpt_convex_shape_wrench, &scene->shaper) == DPT_OK,
          "a shaper");
}

/* One step with the tool at a pose in the body's frame. */
static dpt_wrench step_at(struct scene *scene, const dpt_pose *in_body, double world[3])
{
    dpt_pose *pose = &scene->rig.device;
    pose_point(&scene->body_pose, in_body->position, pose->position);
    turn_times(scene->body_pose.orientation, in_body->orientation, pose->orientation);
    memcpy(world, pose->position, sizeof pose->position);
    rig_step(&scene->rig);
    return scene->rig.force.wrench;
}

static void a_plate_pushes_by_stiffness_times_depth(void)
{
    for (uint32_t law = DPT_LAW_POINT; law <= DPT_LAW_BED; law++) {
        struct scene scene;
        const double k = law == DPT_LAW_BED ? 200.0 : 400.0;
        double strongest = 0.0;
        open_scene(&scene, plate.mesh, DPT_LAW_POINT, law);
        for (int i = 0; i < 200; i++) {
            const double depth = random_in(&seed, -1e-3, 2e-3), tilt = random_in(&seed, -0.8, 0.8);
            /* Half of the ellipsoid's height, as it is tilted about x. */
            const double y = 0.002 * sin(tilt), z = 0.005 * cos(tilt);
            const dpt_pose at = { { random_in(&seed, -0.1, 0.1), random_in(&seed, -0.5, 0.0),
                                    sqrt(y * y + z * z) - depth },
                                  { cos(0.5 * tilt), sin(0.5 * tilt), 0.0, 0.0 } };
            double origin[3], up[3], arm[3];
            const double normal[3] = { 0.0, 0.0, 1.0 };
            const dpt_wrench wrench = step_at(&scene, &at, origin);
            turn3(scene.body_pose.orientation, normal, up);
            const double force = dot3(wrench.force, up), wanted = k * fmax(0.0, depth);
            CHECK(fabs(force - wanted) <= k * 2e-6 && fabs(sqrt(dot3(wrench.force, wrench.force)) - wanted) <= k * 2e-6,
                  "law %u, %g deep: %g N and not %g", law, depth, force, wanted);
            CHECK(fabs(scene.shaper.energy - 0.5 * k * scene.contact.depth * scene.contact.depth) <= 1e-12 &&
                      scene.shaper.body == (depth > 1e-6 ? 0 : scene.shaper.body),
                  "energy");
            for (int j = 0; j < 3; j++)
                arm[j] = scene.contact.point[j] - origin[j];
            const double torque[3] = { arm[1] * wrench.force[2] - arm[2] * wrench.force[1],
                                       arm[2] * wrench.force[0] - arm[0] * wrench.force[2],
                                       arm[0] * wrench.force[1] - arm[1] * wrench.force[0] };
            for (int j = 0; j < 3; j++)
                CHECK(fabs(torque[j] - wrench.torque[j]) <= 1e-12, "torque");
            strongest = fmax(strongest, sqrt(dot3(torque, torque)));
        }
        CHECK(scene.shaper.errors == 0, "%u errors", scene.shaper.errors);
        CHECK(strongest > 1e-4, "no torque: %g Nm", strongest);
        rig_close(&scene.rig);
    }
}

/*
 * Pressed on a liver and slid over it, in steps of 0.02 mm: outward, and no step of the force is larger than stiffness times
 * the motion and the depth times the turn of the direction; the depth itself changes by no more than the motion.
 */
static void a_liver_pushes_outward_and_without_jumps(void)
{
    uint64_t felt = 0, turns = 0, jumps = 0;
    double worst = 0.0, strongest = 0.0;
    const uint64_t paths = part_of(60);
    for (uint64_t path = 0; path < paths; path++) {
        struct scene scene;
        double t[9], n[3], course[3], before[3] = { 0.0, 0.0, 0.0 }, way[3] = { 0.0, 0.0, 0.0 };
        double last = 0.0;
        open_scene(&scene, liver.mesh, DPT_LAW_POINT, path % 2 ? DPT_LAW_BED : DPT_LAW_POINT);
        const double k = path % 2 ? 200.0 : 400.0, pace = 2e-5;
        dpt_mesh_get_triangle(liver.mesh, (uint32_t)(random_bits(&seed) % 5000), t);
        const double u[3] = { t[3] - t[0], t[4] - t[1], t[5] - t[2] };
        const double v[3] = { t[6] - t[0], t[7] - t[1], t[8] - t[2] };
        n[0] = u[1] * v[2] - u[2] * v[1];
        n[1] = u[2] * v[0] - u[0] * v[2];
        n[2] = u[0] * v[1] - u[1] * v[0];
        unit3(n);
        memcpy(course, u, sizeof course);
        unit3(course);
        /* The shaft along the normal: the least turn from z. */
        dpt_pose at = { { 0.0, 0.0, 0.0 }, { 1.0 + n[2], -n[1], n[0], 0.0 } };
        double size = 0.0;
        for (int j = 0; j < 4; j++)
            size += at.orientation[j] * at.orientation[j];
        if (size < 0.01) {
            rig_close(&scene.rig);
            continue;
        }
        for (int j = 0; j < 4; j++)
            at.orientation[j] /= sqrt(size);
        for (int i = 0; i < 300; i++) {
            /* Down for 100 steps, to 1 mm below the triangle's plane; then along it. */
            const double off = 0.005 + 0.001 - pace * (i < 100 ? i : 100);
            const double slid = pace * (i < 100 ? 0 : i - 100);
            double origin[3], outward[3];
            for (int j = 0; j < 3; j++)
                at.position[j] = (t[j] + t[3 + j] + t[6 + j]) / 3.0 + off * n[j] + slid * course[j];
            const dpt_wrench wrench = step_at(&scene, &at, origin);
            const double force = sqrt(dot3(wrench.force, wrench.force));
            turn3(scene.body_pose.orientation, n, outward);
            strongest = fmax(strongest, force);
            felt += force > 0.0;
            CHECK(force <= 0.0 || dot3(wrench.force, outward) > 0.0, "path %llu, step %d: inward",
                  (unsigned long long)path, i);
            CHECK(fabs(force - k * scene.contact.depth) <= 1e-9, "%g N of %g m", force, scene.contact.depth);
            double jump = 0.0, turn = 0.0;
            for (int j = 0; j < 3; j++) {
                jump += (wrench.force[j] - before[j]) * (wrench.force[j] - before[j]);
                turn += (scene.contact.direction[j] - way[j]) * (scene.contact.direction[j] - way[j]);
            }
            jump = sqrt(jump);
            turn = last > 0.0 && scene.contact.depth > 0.0 ? sqrt(turn) : 0.0;
            turns += turn > 0.1;
            const double allowed = k * (pace * 1.001 + fmax(last, scene.contact.depth) * turn + 2.0 * 1e-4 * 0.005);
            if (i > 0) {
                CHECK(jump <= allowed, "path %llu, step %d: a jump of %g N, and %g are allowed",
                      (unsigned long long)path, i, jump, allowed);
                CHECK(fabs(scene.contact.depth - last) <= pace * 1.001 + 2.0 * 1e-4 * 0.005,
                      "path %llu, step %d: the depth goes from %g to %g", (unsigned long long)path, i, last,
                      scene.contact.depth);
                worst = fmax(worst, fabs(scene.contact.depth - last) / pace);
                jumps += fabs(scene.contact.depth - last) > 1.05 * pace;
            }
            memcpy(before, wrench.force, sizeof before);
            memcpy(way, scene.contact.direction, sizeof way);
            last = scene.contact.depth;
        }
        CHECK(scene.shaper.errors == 0, "%u errors", scene.shaper.errors);
        rig_close(&scene.rig);
    }
    printf("    felt in %llu steps, up to %g N; the depth changed by up to %.3f of the motion; "
           "%llu turns of over 0.1 rad, %llu jumps\n",
           (unsigned long long)felt, strongest, worst, (unsigned long long)turns, (unsigned long long)jumps);
    CHECK(felt >= 100 * paths, "%llu felt", (unsigned long long)felt);
}

/* What is not valid adds nothing; a touch that fails is counted. */
static void a_shaper_that_is_not_valid_adds_nothing(void)
{
    struct scene scene;
    dpt_wrench wrench = { { 1.0, 2.0, 3.0 }, { 4.0, 5.0, 6.0 } };
    const dpt_wrench was = wrench;
    open_scene(&scene, plate.mesh, DPT_LAW_POINT, DPT_LAW_POINT);
    const dpt_convex_shaper good = scene.shaper;
    dpt_convex_shaper bad = good;
#define ADDS_NOTHING(change)                                                                                           \
    do {                                                                                                               \
        bad = good;                                                                                                    \
        change;                                                                                                        \
        dpt_convex_shape_wrench(&bad, NULL, 0.001, &wrench);                                                           \
        CHECK(!memcmp(&wrench, &was, sizeof was), "%s", #change);                                                      \
    } while (0)
    ADDS_NOTHING(bad.size = 8);
    ADDS_NOTHING(bad.law = DPT_LAW_PROXY);
    ADDS_NOTHING(bad.shape = NULL);
    ADDS_NOTHING(bad.bodies = NULL);
    ADDS_NOTHING(bad.stiffness = -1.0);
    ADDS_NOTHING(bad.stiffness = NAN);
    ADDS_NOTHING(bad.world = NULL);
    CHECK(bad.errors == 1, "%u errors", bad.errors);
    scene.body.mesh = NULL;
    ADDS_NOTHING((void)0);
    CHECK(bad.errors == 1, "%u errors", bad.errors);
    scene.shape.extent[0] = NAN;
    scene.body.mesh = plate.mesh;
    ADDS_NOTHING((void)0);
    CHECK(bad.errors == 1 && scene.contact.status == DPT_STATUS_STALE && bad.body == DPT_NONE, "%u errors", bad.errors);
    dpt_convex_shape_wrench(&bad, NULL, 0.001, NULL);
    rig_close(&scene.rig);
}

/* A free tip has no force, a pressed one adds to that of the law, and a second body adds to the first. */
static void forces_add_up(void)
{
    struct scene scene;
    double origin[3];
    const dpt_pose at = { { 0.0, -0.2, 0.004 }, { 1.0, 0.0, 0.0, 0.0 } };
    open_scene(&scene, plate.mesh, DPT_LAW_BED, DPT_LAW_POINT);
    const dpt_wrench one = step_at(&scene, &at, origin);
    const dpt_convex_body bodies[2] = { scene.body, scene.body };
    scene.shaper.bodies = bodies;
    scene.shaper.body_count = 2;
    const dpt_pose near = { { 0.0, -0.2, 0.004 + 1e-12 }, { 1.0, 0.0, 0.0, 0.0 } };
    const dpt_wrench two = step_at(&scene, &near, origin);
    for (int k = 0; k < 3; k++)
        CHECK(fabs(two.force[k] - 2.0 * one.force[k]) < 1e-6, "%g and %g", two.force[k], one.force[k]);
    CHECK(sqrt(dot3(one.force, one.force)) > 0.3, "no force");
    dpt_force_info report = { .size = sizeof report };
    dpt_tool_get_force_info(scene.rig.world, scene.rig.tool, &report);
    CHECK(report.flags & DPT_FORCE_FLAG_SHAPED, "its flag");
    rig_close(&scene.rig);
}

int main(int argc, char **argv)
{
    const double vertices[9] = { -1, -1, 0, 1, -1, 0, 0, 1, 0 };
    const uint32_t triangle[3] = { 0, 1, 2 };
    take_percent(argc, argv);
    if (!fixture_from_arrays(&plate, vertices, 3, triangle, 1) || !fixture_from_shape(&liver, "liver", 5000))
        return check_failed++, check_report();
    TEST(a_plate_pushes_by_stiffness_times_depth);
    TEST(a_liver_pushes_outward_and_without_jumps);
    TEST(a_shaper_that_is_not_valid_adds_nothing);
    TEST(forces_add_up);
    fixture_free(&plate);
    fixture_free(&liver);
    return check_report();
}
