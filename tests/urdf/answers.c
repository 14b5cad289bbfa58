/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What the library says of an arm, for oracles in other languages: `answers ARM.dpa`. Each line on standard input holds
 * the joints, their rates, a wrench (6) and gravity (3); each line out the pose (7), velocity and spin (6), the Jacobian
 * (6 rows), the efforts for the wrench and those for the weight.
 */
#include <stdio.h>
#include <stdlib.h>

#include "dynpoint.h"

static int read_numbers(double *number, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
        if (scanf("%lf", &number[i]) != 1)
            return 0;
    return 1;
}

static void write_numbers(const double *number, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
        printf("%.17g ", number[i]);
}

static int answer(const dpt_arm *arm, uint32_t joints)
{
    double q[DPT_JOINTS_MAX], rates[DPT_JOINTS_MAX], wrench[6], gravity[3];
    if (!read_numbers(q, joints) || !read_numbers(rates, joints) || !read_numbers(wrench, 6) ||
        !read_numbers(gravity, 3))
        return 0;
    dpt_pose pose;
    dpt_wrench w = { { wrench[0], wrench[1], wrench[2] }, { wrench[3], wrench[4], wrench[5] } };
    double velocity[3], spin[3], jacobian[6 * DPT_JOINTS_MAX], efforts[DPT_JOINTS_MAX], weight[DPT_JOINTS_MAX];
    if (dpt_arm_forward(arm, q, &pose) != DPT_OK || dpt_arm_velocity(arm, q, rates, velocity, spin) != DPT_OK ||
        dpt_arm_jacobian(arm, q, jacobian) != DPT_OK || dpt_arm_efforts(arm, q, &w, efforts) != DPT_OK ||
        dpt_arm_weight(arm, q, gravity, weight) != DPT_OK)
        return 0;
    write_numbers(pose.position, 3);
    write_numbers(pose.orientation, 4);
    write_numbers(velocity, 3);
    write_numbers(spin, 3);
    write_numbers(jacobian, 6 * joints);
    write_numbers(efforts, joints);
    write_numbers(weight, joints);
    putchar('\n');
    return 1;
}

int main(int argc, char **argv)
{
    static union {
        double aligned;
        unsigned char bytes[1 << 24];
    } room;
    FILE *file = argc == 2 ? fopen(argv[1], "rb") : NULL;
    size_t size = file ? fread(room.bytes, 1, sizeof room.bytes, file) : 0;
    const dpt_arm *arm;
    dpt_arm_info info = { .size = sizeof info };
    if (dpt_arm_convert(room.bytes, size, NULL) != DPT_OK || dpt_arm_open(room.bytes, size, &arm) != DPT_OK ||
        dpt_arm_get_info(arm, &info) != DPT_OK) {
        fprintf(stderr, "usage: answers ARM.dpa\n");
        return 2;
    }
    while (answer(arm, info.joints))
        ;
    fclose(file);
    return 0;
}
