/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Where an arm's links are, from the definition in dynpoint/arm.h alone: 4x4 matrices in long double, libm's sine
 * and cosine, and no derivative that is not a difference. Reads the arrays that an arm is compiled from. Of a joint's
 * coordinate differentiate by `step`: the error is of its square.
 */
#ifndef DPT_TESTS_ORACLE_ARM_H
#define DPT_TESTS_ORACLE_ARM_H

#include "dynpoint/compile.h"

struct oracle_frame {
    long double m[4][4]; /* of a point's x, y, z, 1 to the root's */
};

/* The frame of a link; of the tool. */
struct oracle_frame oracle_link(const dpt_arm_def *def, const long double *joints, uint32_t link);
struct oracle_frame oracle_tool(const dpt_arm_def *def, const long double *joints);

/* Velocity of the tool's origin, then spin, when the joints move at `rates`. */
void oracle_twist(const dpt_arm_def *def, const double *joints, const double *rates, long double twist[6]);

/* How the potential energy of all links, J, changes with joint `j`. */
long double oracle_weight(const dpt_arm_def *def, const double *joints, uint32_t j, const double gravity[3]);

#endif
