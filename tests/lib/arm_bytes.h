/* SPDX-License-Identifier: BSD-3-Clause */
/* Compiled arms for tests of what reads them: chains of joints, each on the last one. */
#ifndef DPT_TESTS_ARM_FILE_H
#define DPT_TESTS_ARM_FILE_H

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "dynpoint/compile.h"
#include "lib/check.h"

struct chain_joint {
    double at[3], axis[3]; /* in the frame of the last one */
    double lower, upper, effort, mass;
    uint32_t kind;
};

/* Turns about z, then twice about y, as the arms of many haptic devices; 0.2 m and 0.2 m, bent in the middle. */
static const struct chain_joint elbow[] = {
    { { 0.0, 0.0, 0.1 }, { 0.0, 0.0, 1.0 }, -1.2, 1.2, 2.0, 0.5, DPT_JOINT_REVOLUTE },
    { { 0.0, 0.0, 0.1 }, { 0.0, 1.0, 0.0 }, -1.4, 0.2, 2.0, 0.2, DPT_JOINT_REVOLUTE },
    { { 0.2, 0.0, 0.0 }, { 0.0, 1.0, 0.0 }, 0.4, 2.0, 2.0, 0.1, DPT_JOINT_REVOLUTE },
};
static const double elbow_tool[3] = { 0.2, 0.0, 0.0 };

/* Slides along x, y and z. */
static const struct chain_joint gantry[] = {
    { { 0.0, 0.0, 0.0 }, { 1.0, 0.0, 0.0 }, -0.25, 0.25, 16.0, 0.0, DPT_JOINT_PRISMATIC },
    { { 0.0, 0.0, 0.0 }, { 0.0, 1.0, 0.0 }, -0.25, 0.25, 16.0, 0.0, DPT_JOINT_PRISMATIC },
    { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 1.0 }, -0.25, 0.25, 16.0, 0.0, DPT_JOINT_PRISMATIC },
};
static const double no_tool[3] = { 0.0, 0.0, 0.0 };

/* Writes it to a new file, whose name it fills in. */
void arm_file(char path[64], const struct chain_joint *chain, uint32_t count, const double tool[3]);

#endif
