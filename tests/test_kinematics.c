/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Kinematics against 4x4 matrices in long double (oracle/arm.h), differences of those, closed forms and balances.
 *
 *     test_kinematics [ARMS | bits]
 *
 * With `bits`, what other machines must give alike, and nothing that needs a wide long double (cross.sh).
 */
#include "arm_random.h"
#include "oracle/arm.h"

#define EPSILON 0x1p-53

static uint64_t arms = 3000;

static void joints_random(uint64_t *random, const dpt_arm_def *def, double *joints)
{
    for (uint32_t i = 0; i < def->joint_count; i++)
        joints[i] = def->joints[i].kind == DPT_JOINT_PRISMATIC ? random_in(random, -0.5, 0.5)
                                                               : random_in(random, -7.0, 7.0);
}

/* How far a link's chain reaches at most, and by how many roundings the angles on it may be off. */
static void size_of_path(const dpt_arm_def *def, const double *joints, double *reach, double *turns)
{
    const double *tool = def->tool.position;
    *reach = sqrt(tool[0] * tool[0] + tool[1] * tool[1] + tool[2] * tool[2]);
    *turns = 1.0;
    for (uint32_t i = def->tool_link; i != DPT_NONE; i = def->links[i].parent) {
        const dpt_arm_link *link = &def->links[i];
        const double *at = link->pose.position;
        const double by = fabs(link->factor * joints[link->joint]) + fabs(link->offset);
        *reach += sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]);
        *reach += link->slides ? by : 0.0;
        *turns += link->slides ? 3.0 : 3.0 + 2.0 * by;
    }
}

static double forward_worst; /* of the error, as a part of what is allowed */

/* The orientation as a matrix is what is compared: the oracle knows no quaternions. */
static void expect_forward(const dpt_arm_def *def, const dpt_arm *arm, const double *joints)
{
    long double wide[DPT_JOINTS_MAX];
    double reach, turns;
    dpt_pose tool;
    for (uint32_t i = 0; i < def->joint_count; i++)
        wide[i] = joints[i];
    const struct oracle_frame truth = oracle_tool(def, wide);
    CHECK(dpt_arm_forward(arm, joints, &tool) == DPT_OK, "forward");
    size_of_path(def, joints, &reach, &turns);
    const long double w = tool.orientation[0], x = tool.orientation[1], y = tool.orientation[2],
                      z = tool.orientation[3];
    const long double m[3][3] = {
        { w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y) },
        { 2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x) },
        { 2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z }
    };
    for (int i = 0; i < 3; i++) {
        const double off = (double)fabsl(tool.position[i] - truth.m[i][3]);
        const double allowed = 2.0 * EPSILON * turns * reach;
        forward_worst = fmax(forward_worst, off / allowed);
        CHECK(off <= allowed && off < 1e-13, "position off by %g, %g allowed", off, allowed);
        for (int k = 0; k < 3; k++) {
            const double turned = (double)fabsl(m[i][k] - truth.m[i][k]);
            forward_worst = fmax(forward_worst, turned / (2.0 * EPSILON * turns));
            CHECK(turned <= 2.0 * EPSILON * turns && turned < 1e-13, "turned by %g, %g allowed",
                  turned, 2.0 * EPSILON * turns);
        }
    }
}

static void forward_is_the_matrices(void)
{
    uint64_t random = 1;
    forward_worst = 0.0;
    for (uint64_t i = 0; i < arms; i++) {
        struct arm_arrays arrays;
        double joints[DPT_JOINTS_MAX];
        arm_random(&random, &arrays);
        struct arm arm = arm_of(&arrays.def);
        for (int pose = 0; arm.open && pose < 4; pose++) {
            joints_random(&random, &arrays.def, joints);
            expect_forward(&arrays.def, arm.open, joints);
        }
        dpt_compiled_free(&arm.file);
    }
    printf("    error at most %.2f of what is allowed\n", forward_worst);
}

int main(int argc, char **argv)
{
    if (argc > 1)
        arms = strtoull(argv[1], NULL, 10);
    TEST(forward_is_the_matrices);
    return check_report();
}
