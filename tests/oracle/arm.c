/* SPDX-License-Identifier: BSD-3-Clause */
#include "oracle/arm.h"

#include <math.h>

#define STEP 0x1p-14L

static const struct oracle_frame identity = { { { 1, 0, 0, 0 }, { 0, 1, 0, 0 }, { 0, 0, 1, 0 }, { 0, 0, 0, 1 } } };

static struct oracle_frame times(struct oracle_frame a, struct oracle_frame b)
{
    struct oracle_frame c;
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 4; k++) {
            c.m[i][k] = 0;
            for (int n = 0; n < 4; n++)
                c.m[i][k] += a.m[i][n] * b.m[n][k];
        }
    return c;
}

/* The turn by an angle about an axis that need not be of unit length (Rodrigues). */
static struct oracle_frame turn(const long double axis[3], long double angle)
{
    long double size = sqrtl(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
    struct oracle_frame f = identity;
    if (size == 0)
        return f;
    const long double x = axis[0] / size, y = axis[1] / size, z = axis[2] / size;
    const long double c = cosl(angle), s = sinl(angle), d = 1 - c;
    const long double m[3][3] = { { c + x * x * d, x * y * d - z * s, x * z * d + y * s },
                                  { y * x * d + z * s, c + y * y * d, y * z * d - x * s },
                                  { z * x * d - y * s, z * y * d + x * s, c + z * z * d } };
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            f.m[i][k] = m[i][k];
    return f;
}

static struct oracle_frame of_pose(const dpt_pose *pose)
{
    const double *q = pose->orientation;
    const long double axis[3] = { q[1], q[2], q[3] };
    const long double sine = sqrtl(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
    struct oracle_frame f = turn(axis, 2 * atan2l(sine, q[0]));
    for (int i = 0; i < 3; i++)
        f.m[i][3] = pose->position[i];
    return f;
}

static struct oracle_frame motion(const dpt_arm_link *link, const long double *joints)
{
    const long double by = link->factor * joints[link->joint] + link->offset;
    const long double axis[3] = { link->axis[0], link->axis[1], link->axis[2] };
    if (!link->slides)
        return turn(axis, by);
    struct oracle_frame f = identity;
    for (int i = 0; i < 3; i++)
        f.m[i][3] = by * axis[i];
    return f;
}

struct oracle_frame oracle_link(const dpt_arm_def *def, const long double *joints, uint32_t link)
{
    const dpt_arm_link *is = &def->links[link];
    struct oracle_frame parent = is->parent == DPT_NONE ? identity : oracle_link(def, joints, is->parent);
    return times(times(parent, of_pose(&is->pose)), motion(is, joints));
}

struct oracle_frame oracle_tool(const dpt_arm_def *def, const long double *joints)
{
    return times(oracle_link(def, joints, def->tool_link), of_pose(&def->tool));
}

/* The joints after a time of moving at `rates`. */
static void moved(const dpt_arm_def *def, const double *joints, const double *rates, long double time, long double *out)
{
    for (uint32_t i = 0; i < def->joint_count; i++)
        out[i] = joints[i] + time * rates[i];
}

/* The matrix of the spin is dR/dt R^T. */
static void twist_by(const dpt_arm_def *def, const double *joints, const double *rates, long double step,
                     long double twist[6])
{
    long double at[DPT_JOINTS_MAX] = { 0 }, spin[3][3];
    moved(def, joints, rates, 0, at);
    const struct oracle_frame f = oracle_tool(def, at);
    moved(def, joints, rates, -step, at);
    const struct oracle_frame f0 = oracle_tool(def, at);
    moved(def, joints, rates, step, at);
    const struct oracle_frame f1 = oracle_tool(def, at);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            spin[i][k] = 0;
            for (int n = 0; n < 3; n++)
                spin[i][k] += (f1.m[i][n] - f0.m[i][n]) / (2 * step) * f.m[k][n];
        }
    for (int i = 0; i < 3; i++)
        twist[i] = (f1.m[i][3] - f0.m[i][3]) / (2 * step);
    twist[3] = (spin[2][1] - spin[1][2]) / 2;
    twist[4] = (spin[0][2] - spin[2][0]) / 2;
    twist[5] = (spin[1][0] - spin[0][1]) / 2;
}

void oracle_twist(const dpt_arm_def *def, const double *joints, const double *rates, long double twist[6])
{
    long double twice[6];
    twist_by(def, joints, rates, STEP, twist);
    twist_by(def, joints, rates, 2 * STEP, twice);
    for (int k = 0; k < 6; k++)
        twist[k] = (4 * twist[k] - twice[k]) / 3;
}

static long double potential(const dpt_arm_def *def, const long double *joints, const double gravity[3])
{
    long double sum = 0;
    for (uint32_t i = 0; i < def->link_count; i++) {
        const struct oracle_frame f = oracle_link(def, joints, i);
        const double *c = def->links[i].centre;
        for (int k = 0; k < 3; k++)
            sum -=
                def->links[i].mass * gravity[k] * (f.m[k][0] * c[0] + f.m[k][1] * c[1] + f.m[k][2] * c[2] + f.m[k][3]);
    }
    return sum;
}

long double oracle_weight(const dpt_arm_def *def, const double *joints, uint32_t j, const double gravity[3])
{
    double rates[DPT_JOINTS_MAX] = { 0 };
    long double at[DPT_JOINTS_MAX] = { 0 }, slope[2];
    rates[j] = 1;
    for (int i = 0; i < 2; i++) {
        const long double step = (i + 1) * STEP;
        moved(def, joints, rates, step, at);
        slope[i] = potential(def, at, gravity);
        moved(def, joints, rates, -step, at);
        slope[i] = (slope[i] - potential(def, at, gravity)) / (2 * step);
    }
    return (4 * slope[0] - slope[1]) / 3;
}
