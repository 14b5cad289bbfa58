/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Kinematics against 4x4 matrices in long double (oracle/arm.h), differences of those, closed forms and balances.
 *
 *     test_kinematics [ARMS | bits | time]
 *
 * With `bits`, what other machines must give alike, and nothing that needs a wide long double (cross.sh). With `time`,
 * how long the calls take on an arm of six joints: the least mean of twenty runs.
 */
#include <time.h>

#include "lib/arm_random.h"
#include "oracle/arm.h"

#define ROUNDING 0x1p-51

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
        const double allowed = ROUNDING * turns * reach;
        forward_worst = fmax(forward_worst, off / allowed);
        CHECK(off <= allowed, "position off by %g, %g allowed", off, allowed);
        for (int k = 0; k < 3; k++) {
            const double turned = (double)fabsl(m[i][k] - truth.m[i][k]);
            forward_worst = fmax(forward_worst, turned / (ROUNDING * turns));
            CHECK(turned <= ROUNDING * turns, "turned by %g, %g allowed", turned, ROUNDING * turns);
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
        for (uint32_t k = 0; k < arrays.def.joint_count; k++)
            joints[k] = random_in(&random, -DPT_COORDINATE_MAX, DPT_COORDINATE_MAX);
        if (arm.open)
            expect_forward(&arrays.def, arm.open, joints);
        dpt_compiled_free(&arm.file);
    }
    printf("    error at most %.2f of what is allowed\n", forward_worst);
}

/* Asked for is 1e-9; the difference that is compared with is better. */
#define ALLOWED 1e-11

static double motion_worst;

static void expect_near(const char *what, double is, long double should, double size)
{
    const double off = fabs((double)(is - should)) / fmax(1.0, size);
    motion_worst = fmax(motion_worst, off);
    CHECK(off <= ALLOWED, "%s is %.17g, not %.17g", what, is, (double)should);
}

static void expect_motion(uint64_t *random, const dpt_arm_def *def, const dpt_arm *arm,
                          const double *joints)
{
    const uint32_t n = def->joint_count;
    double jacobian[6 * DPT_JOINTS_MAX], rates[DPT_JOINTS_MAX], efforts[DPT_JOINTS_MAX];
    double twist[6], power = 0.0, loads[6];
    long double true_twist[6], true_power = 0.0;
    dpt_wrench wrench;
    for (uint32_t i = 0; i < n; i++)
        rates[i] = random_in(random, -2.0, 2.0);
    for (int k = 0; k < 6; k++)
        loads[k] = random_in(random, -5.0, 5.0);
    memcpy(wrench.force, loads, sizeof wrench.force);
    memcpy(wrench.torque, loads + 3, sizeof wrench.torque);

    oracle_twist(def, joints, rates, true_twist);
    CHECK(dpt_arm_velocity(arm, joints, rates, twist, twist + 3) == DPT_OK, "velocity");
    for (int k = 0; k < 6; k++)
        expect_near(k < 3 ? "velocity" : "spin", twist[k], true_twist[k], 0.0);

    CHECK(dpt_arm_jacobian(arm, joints, jacobian) == DPT_OK, "jacobian");
    for (uint32_t i = 0; i < n; i++) {
        double one[DPT_JOINTS_MAX] = { 0 };
        long double column[6];
        one[i] = 1.0;
        oracle_twist(def, joints, one, column);
        for (uint32_t row = 0; row < 6; row++)
            expect_near("jacobian", jacobian[row * n + i], column[row], 0.0);
    }

    /* What the motors give goes to the hand: virtual work. */
    CHECK(dpt_arm_efforts(arm, joints, &wrench, efforts) == DPT_OK, "efforts");
    for (uint32_t i = 0; i < n; i++)
        power += efforts[i] * rates[i];
    for (int k = 0; k < 6; k++)
        true_power += loads[k] * true_twist[k];
    expect_near("power", power, true_power, fabs(power));
}

static void expect_weight(uint64_t *random, const dpt_arm_def *def, const dpt_arm *arm,
                          const double *joints)
{
    double efforts[DPT_JOINTS_MAX], gravity[3];
    for (int k = 0; k < 3; k++)
        gravity[k] = random_in(random, -10.0, 10.0);
    CHECK(dpt_arm_weight(arm, joints, gravity, efforts) == DPT_OK, "weight");
    for (uint32_t i = 0; i < def->joint_count; i++)
        expect_near("weight", efforts[i], oracle_weight(def, joints, i, gravity), fabs(efforts[i]));
}

static void motion_is_the_differences(void)
{
    uint64_t random = 2;
    motion_worst = 0.0;
    for (uint64_t i = 0; i < arms; i++) {
        struct arm_arrays arrays;
        double joints[DPT_JOINTS_MAX];
        arm_random(&random, &arrays);
        struct arm arm = arm_of(&arrays.def);
        joints_random(&random, &arrays.def, joints);
        if (arm.open) {
            expect_motion(&random, &arrays.def, arm.open, joints);
            expect_weight(&random, &arrays.def, arm.open, joints);
        }
        dpt_compiled_free(&arm.file);
    }
    printf("    off by at most %.1e\n", motion_worst);
}

/* The random arms are what they should be: all numbers of joints, mimics, sliders, links beside the way. */
static void random_arms_have_all_there_is(void)
{
    uint64_t random = 1, mimics = 0, sliders = 0, beside = 0, still = 0;
    uint64_t counts[DPT_JOINTS_MAX + 1] = { 0 };
    for (uint64_t i = 0; i < arms; i++) {
        struct arm_arrays arrays;
        arm_random(&random, &arrays);
        uint32_t way = 0, leading = 0;
        for (uint32_t at = arrays.def.tool_link; at != DPT_NONE; at = arrays.links[at].parent) {
            way++;
            leading |= 1u << arrays.links[at].joint;
            mimics += arrays.links[at].factor != 1.0;
            sliders += arrays.links[at].slides;
        }
        beside += way < arrays.def.link_count;
        still += leading != (1u << arrays.def.joint_count) - 1;
        counts[arrays.def.joint_count]++;
    }
    CHECK(mimics > arms / 4 && sliders > arms / 4 && beside > arms / 4 && still > arms / 8,
          "%llu mimics, %llu sliders, %llu with links beside, %llu with joints beside the way",
          (unsigned long long)mimics, (unsigned long long)sliders, (unsigned long long)beside,
          (unsigned long long)still);
    for (int n = 1; n <= DPT_JOINTS_MAX; n++)
        CHECK(counts[n] > arms / 40, "%llu arms of %d joints", (unsigned long long)counts[n], n);
}

/* A chain of `count` links, each moved by a joint of its own. */
static void chain(struct arm_arrays *arm, uint32_t count, uint32_t kind)
{
    *arm = (struct arm_arrays){ .def = { .size = sizeof arm->def,
                                         .joint_count = count,
                                         .link_count = count,
                                         .tool_link = count - 1,
                                         .tool = DPT_POSE_IDENTITY } };
    arm->def.joints = arm->joints;
    arm->def.links = arm->links;
    for (uint32_t i = 0; i < count; i++) {
        arm->joints[i] = (dpt_arm_joint){ .size = sizeof(dpt_arm_joint), .kind = kind };
        arm->links[i] = (dpt_arm_link){ .size = sizeof(dpt_arm_link),
                                        .parent = i - 1,
                                        .joint = i,
                                        .slides = kind == DPT_JOINT_PRISMATIC,
                                        .pose = DPT_POSE_IDENTITY,
                                        .axis = { 0.0, 0.0, 1.0 },
                                        .factor = 1.0 };
    }
}

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
            CHECK(fabs(got[k] - jacobian[k]) < 5e-15, "jacobian %d: %g, not %g", k, got[k],
                  jacobian[k]);
        for (int k = 0; k < 2; k++)
            CHECK(fabs(weight[k] - held[k]) < 2e-14, "weight %d: %g, not %g", k, weight[k],
                  held[k]);
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
            CHECK(tool.position[k] == q[k] && v[k] == rates[k] && w[k] == 0.0 &&
                      efforts[k] == wrench.force[k],
                  "slider %d", k);
            CHECK(weight[k] == -g[k] * (7 - (1 << k) + 1), "weight %d: %g", k, weight[k]);
            for (int row = 0; row < 6; row++)
                CHECK(jacobian[3 * row + k] == (row == k), "jacobian %d %d", row, k);
        }
        CHECK(tool.orientation[0] == 1.0 && tool.orientation[1] == 0.0 &&
                  tool.orientation[2] == 0.0 && tool.orientation[3] == 0.0,
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
        CHECK(fabs(tool.position[0] - 0.4 * cos(q)) < 1e-15 &&
                  fabs(tool.position[1] - 0.4 * sin(q)) < 1e-15,
              "at %g", q);
        CHECK(fabs(tool.orientation[0] - 1.0) < 1e-15 && fabs(tool.orientation[3]) < 1e-15 &&
                  jacobian[5] == 0.0,
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
                apart += (now.orientation[k] - last.orientation[k]) *
                         (now.orientation[k] - last.orientation[k]);
            const double turned = 0.01 * sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
            CHECK(sqrt(apart) <= 0.5 * turned + 0.005, "a jump of %g where it turns by %g",
                  sqrt(apart), turned);
            for (uint32_t k = 0; k < arrays.def.joint_count; k++)
                joints[k] += 0.01 * rates[k];
        }
        dpt_compiled_free(&arm.file);
    }
}

/* 64 links in a row, and one more joint than the way to the tool needs. */
static void largest_arm(void)
{
    struct arm_arrays arrays;
    double joints[DPT_JOINTS_MAX];
    const double down[3] = { 0.0, 0.0, -9.81 };
    chain(&arrays, DPT_JOINTS_MAX, DPT_JOINT_CONTINUOUS);
    uint64_t random = 5;
    for (uint32_t i = 0; i < DPT_ARM_LINKS_MAX; i++) {
        arrays.links[i] = arrays.links[0];
        arrays.links[i].parent = i - 1;
        arrays.links[i].joint = i < DPT_JOINTS_MAX ? i : i % (DPT_JOINTS_MAX - 1);
        arrays.links[i].pose = pose_random(&random, 0.1);
        arrays.links[i].mass = 0.1;
    }
    arrays.links[7].parent = 5;
    arrays.links[8].parent = 6;
    arrays.def.link_count = DPT_ARM_LINKS_MAX;
    arrays.def.tool_link = DPT_ARM_LINKS_MAX - 1;
    struct arm arm = arm_of(&arrays.def);
    joints_random(&random, &arrays.def, joints);
    if (arm.open) {
        double weight[DPT_JOINTS_MAX], jacobian[6 * DPT_JOINTS_MAX];
        expect_forward(&arrays.def, arm.open, joints);
        expect_motion(&random, &arrays.def, arm.open, joints);
        expect_weight(&random, &arrays.def, arm.open, joints);
        dpt_arm_weight(arm.open, joints, down, weight);
        dpt_arm_jacobian(arm.open, joints, jacobian);
        for (int row = 0; row < 6; row++)
            CHECK(jacobian[DPT_JOINTS_MAX * row + 7] == 0.0, "row %d", row);
    }
    dpt_compiled_free(&arm.file);
}

static void every_call_is_total(void)
{
    struct arm_arrays arrays;
    uint64_t random = 6;
    do
        arm_random(&random, &arrays);
    while (arrays.def.joint_count < 4);
    struct arm arm = arm_of(&arrays.def);
    const dpt_arm *a = arm.open;
    const uint32_t n = arrays.def.joint_count;
    double q[DPT_JOINTS_MAX] = { 0 }, r[DPT_JOINTS_MAX] = { 0 }, g[3] = { 0 };
    double out[6 * DPT_JOINTS_MAX], kept[6 * DPT_JOINTS_MAX];
    dpt_wrench wrench = { { 0 }, { 0 } };
    dpt_pose tool = DPT_POSE_IDENTITY;
    for (int i = 0; i < 6 * DPT_JOINTS_MAX; i++)
        out[i] = kept[i] = 1e5 + i;
#define NULLS(call) CHECK((call) == DPT_E_ARGUMENT, "%s", #call)
    NULLS(dpt_arm_forward(NULL, q, &tool));
    NULLS(dpt_arm_forward(a, NULL, &tool));
    NULLS(dpt_arm_forward(a, q, NULL));
    NULLS(dpt_arm_velocity(NULL, q, r, out, out));
    NULLS(dpt_arm_velocity(a, NULL, r, out, out));
    NULLS(dpt_arm_velocity(a, q, NULL, out, out));
    NULLS(dpt_arm_velocity(a, q, r, NULL, out));
    NULLS(dpt_arm_velocity(a, q, r, out, NULL));
    NULLS(dpt_arm_jacobian(NULL, q, out));
    NULLS(dpt_arm_jacobian(a, NULL, out));
    NULLS(dpt_arm_jacobian(a, q, NULL));
    NULLS(dpt_arm_efforts(NULL, q, &wrench, out));
    NULLS(dpt_arm_efforts(a, NULL, &wrench, out));
    NULLS(dpt_arm_efforts(a, q, NULL, out));
    NULLS(dpt_arm_efforts(a, q, &wrench, NULL));
    NULLS(dpt_arm_weight(NULL, q, g, out));
    NULLS(dpt_arm_weight(a, NULL, g, out));
    NULLS(dpt_arm_weight(a, q, NULL, out));
    NULLS(dpt_arm_weight(a, q, g, NULL));

    const double bad[] = { NAN, INFINITY, -INFINITY, 1.0000001e6, -1e300 };
#define REFUSED(number, call)                                                                      \
    do {                                                                                           \
        const double before = (number);                                                            \
        (number) = bad[i];                                                                         \
        CHECK((call) == DPT_E_FINITE, "%g: %s", bad[i], #call);                                    \
        (number) = before;                                                                         \
    } while (0)
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        for (uint32_t k = 0; k < n; k++) {
            REFUSED(q[k], dpt_arm_forward(a, q, &tool));
            REFUSED(q[k], dpt_arm_velocity(a, q, r, out, out + 3));
            REFUSED(r[k], dpt_arm_velocity(a, q, r, out, out + 3));
            REFUSED(q[k], dpt_arm_jacobian(a, q, out));
            REFUSED(q[k], dpt_arm_efforts(a, q, &wrench, out));
            REFUSED(q[k], dpt_arm_weight(a, q, g, out));
        }
        for (int k = 0; k < 3; k++) {
            REFUSED(wrench.force[k], dpt_arm_efforts(a, q, &wrench, out));
            REFUSED(wrench.torque[k], dpt_arm_efforts(a, q, &wrench, out));
            REFUSED(g[k], dpt_arm_weight(a, q, g, out));
        }
    }
    CHECK(!memcmp(out, kept, sizeof out) && tool.position[0] == 0.0 && tool.orientation[0] == 1.0,
          "an output is written in spite of an error");

    for (uint32_t k = 0; k < n; k++)
        q[k] = r[k] = k % 2 ? DPT_COORDINATE_MAX : -DPT_COORDINATE_MAX;
    for (int k = 0; k < 3; k++)
        wrench.force[k] = wrench.torque[k] = g[k] = DPT_COORDINATE_MAX;
    double length = 0.0;
    CHECK(dpt_arm_forward(a, q, &tool) == DPT_OK, "huge joints");
    for (int k = 0; k < 4; k++)
        length += tool.orientation[k] * tool.orientation[k];
    CHECK(fabs(length - 1.0) < 1e-13 && isfinite(tool.position[0]), "a quaternion of %g", length);
    CHECK(dpt_arm_velocity(a, q, r, out, out + 3) == DPT_OK &&
              dpt_arm_efforts(a, q, &wrench, out + 6) == DPT_OK &&
              dpt_arm_weight(a, q, g, out + 6 + n) == DPT_OK,
          "huge joints");
    for (uint32_t i = 0; i < 6 + 2 * n; i++)
        CHECK(isfinite(out[i]), "output %u", i);
    CHECK(dpt_arm_jacobian(a, q, out) == DPT_OK, "huge joints");
    for (uint32_t i = 0; i < 6 * n; i++)
        CHECK(isfinite(out[i]), "jacobian %u", i);
    dpt_compiled_free(&arm.file);
}

static uint64_t hash;

static void mix(const double *numbers, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        uint64_t bits;
        memcpy(&bits, &numbers[i], sizeof bits);
        hash = (hash ^ bits) * 0x100000001b3u;
    }
}

/* The number is that of an x86-64; every other machine must come to it. */
static void same_bits_everywhere(void)
{
    uint64_t random = 7;
    hash = 0xcbf29ce484222325u;
    for (int i = 0; i < 200; i++) {
        struct arm_arrays arrays;
        double q[DPT_JOINTS_MAX], r[DPT_JOINTS_MAX], twist[6], out[6 * DPT_JOINTS_MAX];
        dpt_wrench wrench;
        dpt_pose tool;
        arm_random(&random, &arrays);
        const uint32_t n = arrays.def.joint_count;
        struct arm arm = arm_of(&arrays.def);
        joints_random(&random, &arrays.def, q);
        joints_random(&random, &arrays.def, r);
        for (int k = 0; k < 3; k++) {
            wrench.force[k] = random_in(&random, -1.0, 1.0);
            wrench.torque[k] = random_in(&random, -1.0, 1.0);
        }
        if (!arm.open)
            continue;
        dpt_arm_forward(arm.open, q, &tool);
        mix(tool.position, 3);
        mix(tool.orientation, 4);
        dpt_arm_velocity(arm.open, q, r, twist, twist + 3);
        mix(twist, 6);
        dpt_arm_jacobian(arm.open, q, out);
        mix(out, 6 * n);
        dpt_arm_efforts(arm.open, q, &wrench, out);
        mix(out, n);
        dpt_arm_weight(arm.open, q, wrench.force, out);
        mix(out, n);
        dpt_compiled_free(&arm.file);
    }
    CHECK(hash == 0xb92313de611df800u, "0x%016llx", (unsigned long long)hash);
}

static double now_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return 1e9 * (double)now.tv_sec + (double)now.tv_nsec;
}

static int print_times(void)
{
    enum { RUNS = 20, CALLS = 20000, KINDS = 5 };
    static const char *const names[] = { "forward", "velocity", "jacobian", "efforts", "weight" };
    const double down[3] = { 0.0, 0.0, -9.81 }, rates[6] = { 1.0, 1.0, 1.0, 1.0, 1.0, 1.0 };
    const dpt_wrench wrench = { { 1.0, 2.0, 3.0 }, { 0.1, 0.2, 0.3 } };
    struct arm_arrays arrays;
    uint64_t random = 9;
    double least[KINDS] = { 0.0 }, q[6] = { 0.0 }, out[36] = { 0.0 }, sum = 0.0;
    dpt_pose tool = DPT_POSE_IDENTITY;
    chain(&arrays, 6, DPT_JOINT_CONTINUOUS);
    for (int i = 0; i < 6; i++) {
        arrays.links[i].pose = pose_random(&random, 0.3);
        unit_random(&random, arrays.links[i].axis, 3);
        arrays.links[i].mass = 1.0;
    }
    struct arm arm = arm_of(&arrays.def);
    for (int kind = 0; arm.open && kind < KINDS; kind++)
        for (int run = 0; run < RUNS; run++) {
            const double begin = now_ns();
            for (int i = 0; i < CALLS; i++) {
                q[i % 6] += 1e-3;
                if (kind == 0)
                    dpt_arm_forward(arm.open, q, &tool);
                else if (kind == 1)
                    dpt_arm_velocity(arm.open, q, rates, out, out + 3);
                else if (kind == 2)
                    dpt_arm_jacobian(arm.open, q, out);
                else if (kind == 3)
                    dpt_arm_efforts(arm.open, q, &wrench, out);
                else
                    dpt_arm_weight(arm.open, q, down, out);
                sum += tool.position[0] + out[0];
            }
            const double mean = (now_ns() - begin) / CALLS;
            least[kind] = run ? fmin(least[kind], mean) : mean;
        }
    for (int kind = 0; arm.open && kind < KINDS; kind++)
        printf("%s %.0f ns\n", names[kind], least[kind]);
    dpt_compiled_free(&arm.file);
    return !isfinite(sum);
}

int main(int argc, char **argv)
{
    if (argc > 1 && !strcmp(argv[1], "time"))
        return print_times();
    const int bits = argc > 1 && !strcmp(argv[1], "bits");
    if (argc > 1 && !bits)
        arms = strtoull(argv[1], NULL, 10);
    TEST(same_bits_everywhere);
    if (bits)
        return check_report();
    TEST(random_arms_have_all_there_is);
    TEST(forward_is_the_matrices);
    TEST(motion_is_the_differences);
    TEST(planar_arm_has_its_closed_form);
    TEST(gantry_is_exact);
    TEST(parallelogram_keeps_its_tool_upright);
    TEST(orientation_is_continuous);
    TEST(largest_arm);
    TEST(every_call_is_total);
    return check_report();
}
