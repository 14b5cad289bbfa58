/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Kinematics against 4x4 matrices in long double (oracle/arm.h), and differences of those.
 *
 *     test_kinematics [ARMS | bits | time]
 *
 * With `bits`, what other machines must give alike, and nothing that needs a wide long double (cross.sh). With `time`,
 * how long the calls take on an arm of six joints: the least mean of twenty runs.
 */
#include <time.h>

#include "arm/arm_chain.h"
#include "oracle/arm.h"

#define ROUNDING 0x1p-51

static uint64_t arms = 3000;

static void joints_random(uint64_t *random, const dpt_arm_def *def, double *joints)
{
    for (uint32_t i = 0; i < def->joint_count; i++)
        joints[i] =
            def->joints[i].kind == DPT_JOINT_PRISMATIC ? random_in(random, -0.5, 0.5) : random_in(random, -7.0, 7.0);
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
    const long double m[3][3] = { { w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y) },
                                  { 2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x) },
                                  { 2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z } };
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

static void expect_motion(uint64_t *random, const dpt_arm_def *def, const dpt_arm *arm, const double *joints)
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

static void expect_weight(uint64_t *random, const dpt_arm_def *def, const dpt_arm *arm, const double *joints)
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

static void nulls_are_refused(const dpt_arm *a)
{
    double q[DPT_JOINTS_MAX] = { 0 }, r[DPT_JOINTS_MAX] = { 0 }, g[3] = { 0 };
    double out[6 * DPT_JOINTS_MAX];
    dpt_wrench wrench = { { 0 }, { 0 } };
    dpt_pose tool = DPT_POSE_IDENTITY;
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
}

static void numbers_beyond_are_refused(const dpt_arm *a, uint32_t n)
{
    double q[DPT_JOINTS_MAX] = { 0 }, r[DPT_JOINTS_MAX] = { 0 }, g[3] = { 0 };
    double out[6 * DPT_JOINTS_MAX], kept[6 * DPT_JOINTS_MAX];
    dpt_wrench wrench = { { 0 }, { 0 } };
    dpt_pose tool = DPT_POSE_IDENTITY;
    for (int i = 0; i < 6 * DPT_JOINTS_MAX; i++)
        out[i] = kept[i] = 1e5 + i;
    const double bad[] = { NAN, INFINITY, -INFINITY, 1.0000001e6, -1e300 };
#define REFUSED(number, call)                                                                                          \
    do {                                                                                                               \
        const double before = (number);                                                                                \
        (number) = bad[i];                                                                                             \
        CHECK((call) == DPT_E_FINITE, "%g: %s", bad[i], #call);                                                        \
        (number) = before;                                                                                             \
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
}

static void huge_numbers_are_taken(const dpt_arm *a, uint32_t n)
{
    double q[DPT_JOINTS_MAX] = { 0 }, r[DPT_JOINTS_MAX] = { 0 }, g[3] = { 0 };
    double out[6 * DPT_JOINTS_MAX];
    dpt_wrench wrench = { { 0 }, { 0 } };
    dpt_pose tool = DPT_POSE_IDENTITY;
    for (uint32_t k = 0; k < n; k++)
        q[k] = r[k] = k % 2 ? DPT_COORDINATE_MAX : -DPT_COORDINATE_MAX;
    for (int k = 0; k < 3; k++)
        wrench.force[k] = wrench.torque[k] = g[k] = DPT_COORDINATE_MAX;
    double length = 0.0;
    CHECK(dpt_arm_forward(a, q, &tool) == DPT_OK, "huge joints");
    for (int k = 0; k < 4; k++)
        length += tool.orientation[k] * tool.orientation[k];
    CHECK(fabs(length - 1.0) < 1e-13 && isfinite(tool.position[0]), "a quaternion of %g", length);
    CHECK(dpt_arm_velocity(a, q, r, out, out + 3) == DPT_OK && dpt_arm_efforts(a, q, &wrench, out + 6) == DPT_OK &&
              dpt_arm_weight(a, q, g, out + 6 + n) == DPT_OK,
          "huge joints");
    for (uint32_t i = 0; i < 6 + 2 * n; i++)
        CHECK(isfinite(out[i]), "output %u", i);
    CHECK(dpt_arm_jacobian(a, q, out) == DPT_OK, "huge joints");
    for (uint32_t i = 0; i < 6 * n; i++)
        CHECK(isfinite(out[i]), "jacobian %u", i);
}

static void every_call_is_total(void)
{
    struct arm_arrays arrays;
    uint64_t random = 6;
    do
        arm_random(&random, &arrays);
    while (arrays.def.joint_count < 4);
    struct arm arm = arm_of(&arrays.def);
    nulls_are_refused(arm.open);
    numbers_beyond_are_refused(arm.open, arrays.def.joint_count);
    huge_numbers_are_taken(arm.open, arrays.def.joint_count);
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
    TEST(largest_arm);
    TEST(every_call_is_total);
    return check_report();
}
