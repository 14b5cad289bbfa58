/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Arms as arrays: random trees of links with mimics, sliders and links beside the way to the tool; and what is compiled
 * from such, open.
 */
#ifndef DPT_TESTS_ARM_RANDOM_H
#define DPT_TESTS_ARM_RANDOM_H

#include "dynpoint.h"
#include "dynpoint/compile.h"
#include "lib/check.h"
#include "lib/pose.h"

struct arm_arrays {
    dpt_arm_def def;
    dpt_arm_joint joints[DPT_JOINTS_MAX];
    dpt_arm_link links[DPT_ARM_LINKS_MAX];
    dpt_segment segments[4];
    dpt_arm_body bodies[4];
    dpt_arm_joint jaws[2];
    dpt_arm_link jaw_links[4];
    dpt_arm_tip tips[4];
};

struct arm {
    dpt_compiled file;
    const dpt_arm *open;
};

/* In the host's byte order; NULL when it does not compile, and the test has failed. */
struct arm arm_of(const dpt_arm_def *def);

/* Joints that lead to the tool first: so its way is given joints before all else. */
void arm_random(uint64_t *random, struct arm_arrays *arm);

#endif
