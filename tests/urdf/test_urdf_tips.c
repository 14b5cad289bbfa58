/* SPDX-License-Identifier: BSD-3-Clause */
/* Tips and jaws of tools from small descriptions, against closed forms: how far each reaches, at any jaws. */
#include "urdf/small_robot.h"

/* The greatest x n over a tip's surface, in the tool's frame, with jaws at these coordinates. */
static double tip_support(const struct robot *robot, uint32_t index, const double *jaws, const double n[3])
{
    dpt_arm_tip tip = { .size = sizeof tip };
    dpt_pose pose;
    double most = -1e300;
    CHECK(dpt_arm_get_tip(robot->arm, index, &tip) == DPT_OK &&
              dpt_arm_tip_pose(robot->arm, index, jaws, &pose) == DPT_OK,
          "tip %u", index);
    const double w = pose.orientation[0], *q = pose.orientation + 1;
    for (uint32_t c = 0; c < tip.corner_count; c++) {
        const double *v = tip.corners + 3 * c;
        double t[3], sum = 0;
        for (int k = 0; k < 3; k++)
            t[k] = 2 * (q[(k + 1) % 3] * v[(k + 2) % 3] - q[(k + 2) % 3] * v[(k + 1) % 3]);
        for (int k = 0; k < 3; k++)
            sum += n[k] * (pose.position[k] + v[k] + w * t[k] + q[(k + 1) % 3] * t[(k + 2) % 3] -
                           q[(k + 2) % 3] * t[(k + 1) % 3]);
        most = fmax(most, sum);
    }
    return most + tip.radius;
}

/* How far a tip reaches along x, y, z and back. */
static void check_box(const struct robot *robot, uint32_t index, const double *jaws, const double want[6],
                      double tolerance)
{
    for (int k = 0; k < 6; k++) {
        const double n[3] = { k % 3 == 0 ? (k < 3 ? 1 : -1) : 0, k % 3 == 1 ? (k < 3 ? 1 : -1) : 0,
                              k % 3 == 2 ? (k < 3 ? 1 : -1) : 0 };
        const double reach = tip_support(robot, index, jaws, n);
        CHECK(reach > want[k] - 1e-9 && reach < want[k] + tolerance + 1e-9, "tip %u, direction %d: reaches %g, not %g",
              index, k, reach, want[k]);
    }
}

/*
 * A gripper: a palm, two jaws by one joint and its mimic, a finger that slides on the first, and a wheel behind the
 * wrist. What is fixed is told at any jaws; the others by closed forms.
 */
static void jaws_of_a_gripper(void)
{
    struct robot robot = robot_in(
        "<link name=\"base\"/><link name=\"wrist\"/>"
        "<link name=\"palm\"><collision><origin xyz=\"0 0 0.1\"/><geometry><box size=\"0.2 0.1 "
        "0.06\"/></geometry></collision></link>"
        "<link name=\"left\"><collision><origin xyz=\"0.1 0 0\"/><geometry><box size=\"0.2 0.02 "
        "0.04\"/></geometry></collision></link>"
        "<link name=\"right\"><collision><origin xyz=\"0.1 0 0\"/><geometry><cylinder "
        "radius=\"0.05\" length=\"0.02\"/></geometry></collision></link>"
        "<link name=\"nail\"><collision><geometry><sphere radius=\"0.03\"/></geometry></collision></link>"
        "<link name=\"pin\"/>" JOINT("j", "continuous", "base", "wrist", "")
            JOINT("f", "fixed", "wrist", "palm", "<origin xyz=\"0 0 3\"/>")
                JOINT("squeeze", "revolute", "palm", "left",
                      "<origin xyz=\"0 0.05 0.2\"/><axis xyz=\"0 0 1\"/><limit lower=\"0\" "
                      "upper=\"0.7\" effort=\"1\" velocity=\"1\"/>")
                    JOINT("follow", "revolute", "palm", "right",
                          "<origin xyz=\"0 -0.05 0.2\"/><axis xyz=\"0 0 1\"/><mimic joint=\"squeeze\" "
                          "multiplier=\"-1\"/><limit lower=\"-0.7\" upper=\"0\" effort=\"1\" "
                          "velocity=\"1\"/>") JOINT("slide", "prismatic", "left", "nail",
                                                    "<origin xyz=\"0.2 0 0\"/><axis xyz=\"1 0 0\"/><limit lower=\"0\" "
                                                    "upper=\"0.1\" effort=\"1\" velocity=\"1\"/>")
                        JOINT("empty", "revolute", "palm", "pin",
                              "<axis xyz=\"0 0 1\"/><limit lower=\"0\" upper=\"1\" effort=\"1\" velocity=\"1\"/>"),
        "palm");
    dpt_arm_joint jaw = { .size = sizeof jaw };
    CHECK(robot.info.joints == 1 && robot.info.tips == 4 && robot.info.jaws == 2 && robot.info.jaw_links == 3 &&
              robot.info.segments == 0,
          "%u joints, %u tips, %u jaws, %u jaw links", robot.info.joints, robot.info.tips, robot.info.jaws,
          robot.info.jaw_links);
    CHECK(dpt_arm_get_jaw(robot.arm, 0, &jaw) == DPT_OK && !strcmp(jaw.name, "squeeze") &&
              jaw.kind == DPT_JOINT_REVOLUTE && jaw.upper == 0.7,
          "%s", jaw.name);
    CHECK(dpt_arm_get_jaw(robot.arm, 1, &jaw) == DPT_OK && !strcmp(jaw.name, "slide") &&
              jaw.kind == DPT_JOINT_PRISMATIC && jaw.upper == 0.1,
          "%s", jaw.name);
    CHECK(strstr(robot.notes, "joint 'empty' is no part of the arm: held at 0") && !strstr(robot.notes, "'squeeze'") &&
              !strstr(robot.notes, "'slide'") && strstr(robot.notes, "link 'right': a cylinder is felt"),
          "%s", robot.notes);
    for (int i = 0; i < 8; i++) {
        const double jaws[2] = { 0.1 * i, 0.01 * i }, c = cos(jaws[0]), s = sin(jaws[0]);
        check_box(&robot, 0, jaws, (double[6]){ 0.1, 0.05, 0.13, 0.1, 0.05, -0.07 }, 0);
        /* The left one, 0.2 x 0.02, turned by the angle about (0, 0.05). */
        check_box(&robot, 1, jaws,
                  (double[6]){ fmax(0.2 * c, 0) + 0.01 * s, 0.05 + 0.2 * s + 0.01 * c, 0.22, 0.01 * s, -0.05 + 0.01 * c,
                               -0.18 },
                  0);
        /* The right one, round about z at 0.1 from (0, -0.05): 16 sides are up to 2 % of 0.05 outside. */
        check_box(
            &robot, 2, jaws,
            (double[6]){ 0.1 * c + 0.05, -0.05 - 0.1 * s + 0.05, 0.21, -0.1 * c + 0.05, 0.05 + 0.1 * s + 0.05, -0.19 },
            0.02 * 0.05);
        const double out = 0.2 + jaws[1];
        check_box(
            &robot, 3, jaws,
            (double[6]){ out * c + 0.03, 0.05 + out * s + 0.03, 0.23, -out * c + 0.03, -0.05 - out * s + 0.03, -0.17 },
            0.022 * 0.03);
        /* Between its corners the octahedron is least. */
        const double n[3] = { sqrt(1.0 / 3), sqrt(1.0 / 3), sqrt(1.0 / 3) };
        const double reach = tip_support(&robot, 3, jaws, n);
        const double ball = n[0] * (out * c + 0.05 + out * s + 0.2) + 0.03;
        CHECK(reach > ball - 1e-9, "the ball reaches %g, its tip %g", ball, reach);
    }
    dpt_compiled_free(&robot.compiled);
}

/* A mesh of the tool is its hull; one that cannot be read is noted, and the rest is the tool. */
static void meshes_of_a_tool(void)
{
    char path[600];
    snprintf(path, sizeof path, "%s/wedge.obj", scratch);
    FILE *file = fopen(path, "w");
    fputs("v 0 0 0\nv 2 0 0\nv 0 1 0\nv 0 0 4\nv 0.1 0.1 0.1\nf 1 3 2\nf 1 2 5\nf 2 3 4\nf 3 1 4\nf 5 4 1\n", file);
    fclose(file);
    struct robot robot =
        robot_in("<link name=\"base\"/><link name=\"tip\">"
                 "<collision><origin xyz=\"0 0 1\"/><geometry><mesh filename=\"wedge.obj\" scale=\"0.1 0.1 "
                 "0.1\"/></geometry></collision>"
                 "<collision><geometry><mesh filename=\"none.obj\"/></geometry></collision>"
                 "<collision><geometry><mesh filename=\"some.dae\"/></geometry></collision>"
                 "<collision><geometry><box size=\"1 0 0\"/></geometry></collision>"
                 "</link>" JOINT("j", "continuous", "base", "tip", ""),
                 "tip");
    CHECK(robot.info.tips == 1 && robot.info.jaws == 0, "%u tips", robot.info.tips);
    check_box(&robot, 0, NULL, (double[6]){ 0.2, 0.1, 1.4, 0, 0, -1 }, 1e-7);
    CHECK(strstr(robot.notes, "link 'tip': a mesh is felt as its hull, of 4 corners") &&
              strstr(robot.notes, "none.obj") && strstr(robot.notes, "is COLLADA") &&
              strstr(robot.notes, ": left out of the tool") &&
              strstr(robot.notes, "link 'tip': a shape of the tool is left out: it is too thin"),
          "%s", robot.notes);
    dpt_compiled_free(&robot.compiled);
    remove(path);
}

int main(void)
{
    if (!scratch_make("urdf_tips"))
        return 1;
    TEST(jaws_of_a_gripper);
    TEST(meshes_of_a_tool);
    scratch_remove();
    return check_report();
}
