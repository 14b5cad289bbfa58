/* SPDX-License-Identifier: BSD-3-Clause */
#include "arm.h"

#include <math.h>

static const struct oracle_frame identity = {
    { { 1, 0, 0, 0 }, { 0, 1, 0, 0 }, { 0, 0, 1, 0 }, { 0, 0, 0, 1 } }
};

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
    struct oracle_frame parent =
        is->parent == DPT_NONE ? identity : oracle_link(def, joints, is->parent);
    return times(times(parent, of_pose(&is->pose)), motion(is, joints));
}

struct oracle_frame oracle_tool(const dpt_arm_def *def, const long double *joints)
{
    return times(oracle_link(def, joints, def->tool_link), of_pose(&def->tool));
}

void oracle_column(const dpt_arm_def *def, const double *joints, uint32_t j, long double step,
                   long double column[6])
{
    long double at[DPT_JOINTS_MAX];
    for (uint32_t i = 0; i < def->joint_count; i++)
        at[i] = joints[i];
    const struct oracle_frame now = oracle_tool(def, at);
    at[j] = joints[j] - step;
    const struct oracle_frame before = oracle_tool(def, at);
    at[j] = joints[j] + step;
    const struct oracle_frame after = oracle_tool(def, at);
    /* The matrix of the spin is dR/dt R^T. */
    long double spin[3][3];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            spin[i][k] = 0;
            for (int n = 0; n < 3; n++)
                spin[i][k] += (after.m[i][n] - before.m[i][n]) / (2 * step) * now.m[k][n];
        }
    for (int i = 0; i < 3; i++)
        column[i] = (after.m[i][3] - before.m[i][3]) / (2 * step);
    column[3] = (spin[2][1] - spin[1][2]) / 2;
    column[4] = (spin[0][2] - spin[2][0]) / 2;
    column[5] = (spin[1][0] - spin[0][1]) / 2;
}

long double oracle_potential(const dpt_arm_def *def, const long double *joints,
                             const double gravity[3])
{
    long double sum = 0;
    for (uint32_t i = 0; i < def->link_count; i++) {
        const struct oracle_frame f = oracle_link(def, joints, i);
        const double *c = def->links[i].centre;
        for (int k = 0; k < 3; k++)
            sum -= def->links[i].mass * gravity[k] *
                   (f.m[k][0] * c[0] + f.m[k][1] * c[1] + f.m[k][2] * c[2] + f.m[k][3]);
    }
    return sum;
}
