/* SPDX-License-Identifier: BSD-3-Clause */
/* Kinematics of arms whose motion is known in closed form: an arm in a plane, a gantry, a parallelogram, a turning wrist. */
#include "arm/arm_chain.h"
#include "oracle/arm.h"

/* Two links of 0.3 m and 0.2 m in the plane, each of its mass in its middle, gravity down y. */
static void planar_arm_has_its_closed_form(void)
{
    const double l1 = 0.3, l2 = 0.2, m1 = 1.5, m2 = 0.7, down[3] = { 0.0, -9.81, 0.0 };
    struct arm_arrays arrays;
    chain(&arrays, 2, DPT_JOINT_CONTINUOUS);
    arrays.links[1].pose.position[0] = l1;
    arrays.def.tool.position[0] = l2;
    arrays.links[0].mass = m1;
    arrays.links[0].centre[0] = 0.5 * l1;
    arrays.links[1].mass = m2;
    arrays.links[1].centre[0] = 0.5 * l2;
    struct arm arm = arm_of(&arrays.def);
    for (int i = 0; arm.open && i < 1000; i++) {
        const double q[2] = { 0.013 * i - 6.0, 0.7 - 0.011 * i };
        const double c1 = cos(q[0]), s1 = sin(q[0]), c12 = cos(q[0] + q[1]), s12 = sin(q[0] + q[1]);
        const double jacobian[12] = {
            -l1 * s1 - l2 * s12, -l2 * s12, l1 * c1 + l2 * c12, l2 * c12, 0, 0, 0, 0, 0, 0, 1, 1
        };
        const double held[2] = { 9.81 * (m1 * 0.5 * l1 * c1 + m2 * (l1 * c1 + 0.5 * l2 * c12)),
                                 9.81 * m2 * 0.5 * l2 * c12 };
        double got[12], weight[2];
        dpt_pose tool;
        dpt_arm_forward(arm.open, q, &tool);
        dpt_arm_jacobian(arm.open, q, got);
        dpt_arm_weight(arm.open, q, down, weight);
        CHECK(fabs(tool.position[0] - l1 * c1 - l2 * c12) < 5e-15 &&
                  fabs(tool.position[1] - l1 * s1 - l2 * s12) < 5e-15 && tool.position[2] == 0.0,
              "at %g, %g", tool.position[0], tool.position[1]);
        CHECK(fabs(tool.orientation[0] - cos(0.5 * (q[0] + q[1]))) < 5e-15 &&
                  fabs(tool.orientation[3] - sin(0.5 * (q[0] + q[1]))) < 5e-15,
              "turned to %g, %g", tool.orientation[0], tool.orientation[3]);
        for (int k = 0; k < 12; k++)
            CHECK(fabs(got[k] - jacobian[k]) < 5e-15, "jacobian %d: %g, not %g", k, got[k], jacobian[k]);
        for (int k = 0; k < 2; k++)
            CHECK(fabs(weight[k] - held[k]) < 2e-14, "weight %d: %g, not %g", k, weight[k], held[k]);
    }
    dpt_compiled_free(&arm.file);
}

/* Three sliders along x, y and z: sums alone, to the bit. */
static void gantry_is_exact(void)
{
    struct arm_arrays arrays;
    const double g[3] = { 0.5, -0.25, -9.81 };
    uint64_t random = 3;
    chain(&arrays, 3, DPT_JOINT_PRISMATIC);
    for (int k = 0; k < 3; k++) {
        memset(arrays.links[k].axis, 0, sizeof arrays.links[k].axis);
        arrays.links[k].axis[k] = 1.0;
        arrays.links[k].mass = 1 << k;
    }
    struct arm arm = arm_of(&arrays.def);
    for (int i = 0; arm.open && i < 1000; i++) {
        double q[3], rates[3], v[3], w[3], efforts[3], jacobian[18], weight[3];
        dpt_wrench wrench = { .torque = { 1.0, 2.0, 3.0 } };
        dpt_pose tool;
        for (int k = 0; k < 3; k++) {
            q[k] = random_in(&random, -1e6, 1e6);
            rates[k] = random_in(&random, -1.0, 1.0);
            wrench.force[k] = random_in(&random, -10.0, 10.0);
        }
        dpt_arm_forward(arm.open, q, &tool);
        dpt_arm_velocity(arm.open, q, rates, v, w);
        dpt_arm_efforts(arm.open, q, &wrench, efforts);
        dpt_arm_jacobian(arm.open, q, jacobian);
        dpt_arm_weight(arm.open, q, g, weight);
        for (int k = 0; k < 3; k++) {
            CHECK(tool.position[k] == q[k] && v[k] == rates[k] && w[k] == 0.0 && efforts[k] == wrench.force[k],
                  "slider %d", k);
            CHECK(weight[k] == -g[k] * (7 - (1 << k) + 1), "weight %d: %g", k, weight[k]);
            for (int row = 0; row < 6; row++)
                CHECK(jacobian[3 * row + k] == (row == k), "jacobian %d %d", row, k);
        }
        CHECK(tool.orientation[0] == 1.0 && tool.orientation[1] == 0.0 && tool.orientation[2] == 0.0 &&
                  tool.orientation[3] == 0.0,
              "turned");
    }
    dpt_compiled_free(&arm.file);
}

/*
 * One joint: a bar of 0.4 m turns by q, the one at its end by -q, so that the tool stays upright; a second bar beside,
 * of which the tool knows nothing, bears 2 kg at its end.
 */
static void parallelogram_keeps_its_tool_upright(void)
{
    struct arm_arrays arrays;
    const double down[3] = { 0.0, -9.81, 0.0 };
    const dpt_wrench wrench = { { 1.0, 2.0, 0.0 }, { 0.0, 0.0, 5.0 } };
    chain(&arrays, 3, DPT_JOINT_REVOLUTE);
    arrays.def.joint_count = 1;
    arrays.def.tool_link = 1;
    arrays.joints[0].lower = -1.0;
    arrays.joints[0].upper = 1.0;
    for (int i = 0; i < 3; i++)
        arrays.links[i].joint = 0;
    arrays.links[1].pose.position[0] = 0.4;
    arrays.links[1].factor = -1.0;
    arrays.links[2].parent = DPT_NONE;
    arrays.links[2].pose.position[1] = 0.1;
    arrays.links[2].mass = 2.0;
    arrays.links[2].centre[0] = 0.4;
    struct arm arm = arm_of(&arrays.def);
    for (double q = -3.0; arm.open && q <= 3.0; q += 0.01) {
        double effort, weight, jacobian[6];
        dpt_pose tool;
        dpt_arm_forward(arm.open, &q, &tool);
        dpt_arm_efforts(arm.open, &q, &wrench, &effort);
        dpt_arm_weight(arm.open, &q, down, &weight);
        dpt_arm_jacobian(arm.open, &q, jacobian);
        CHECK(fabs(tool.position[0] - 0.4 * cos(q)) < 1e-15 && fabs(tool.position[1] - 0.4 * sin(q)) < 1e-15, "at %g",
              q);
        CHECK(fabs(tool.orientation[0] - 1.0) < 1e-15 && fabs(tool.orientation[3]) < 1e-15 && jacobian[5] == 0.0,
              "turned at %g", q);
        CHECK(fabs(effort - 0.4 * (2.0 * cos(q) - sin(q))) < 1e-14, "effort at %g: %g", q, effort);
        CHECK(fabs(weight - 2.0 * 9.81 * 0.4 * cos(q)) < 1e-13, "weight at %g: %g", q, weight);
    }
    dpt_compiled_free(&arm.file);
}

/* Nowhere does the quaternion jump to its opposite: it goes half the angle that the tool turns by. */
static void orientation_is_continuous(void)
{
    uint64_t random = 4;
    for (int i = 0; i < 100; i++) {
        struct arm_arrays arrays;
        double joints[DPT_JOINTS_MAX], rates[DPT_JOINTS_MAX], v[3], w[3];
        dpt_pose last, now;
        arm_random(&random, &arrays);
        struct arm arm = arm_of(&arrays.def);
        for (uint32_t k = 0; k < arrays.def.joint_count; k++) {
            joints[k] = random_in(&random, -20.0, 0.0);
            rates[k] = random_in(&random, 0.5, 1.0);
        }
        for (int step = 0; arm.open && step < 4000; step++, last = now) {
            double apart = 0.0;
            dpt_arm_forward(arm.open, joints, &now);
            dpt_arm_velocity(arm.open, joints, rates, v, w);
            for (int k = 0; step && k < 4; k++)
                apart += (now.orientation[k] - last.orientation[k]) * (now.orientation[k] - last.orientation[k]);
            const double turned = 0.01 * sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
            CHECK(sqrt(apart) <= 0.5 * turned + 0.005, "a jump of %g where it turns by %g", sqrt(apart), turned);
            for (uint32_t k = 0; k < arrays.def.joint_count; k++)
                joints[k] += 0.01 * rates[k];
        }
        dpt_compiled_free(&arm.file);
    }
}

int main(void)
{
    TEST(planar_arm_has_its_closed_form);
    TEST(gantry_is_exact);
    TEST(parallelogram_keeps_its_tool_upright);
    TEST(orientation_is_continuous);
    return check_report();
}
