/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef DPT_TESTS_ARM_CHAIN_H
#define DPT_TESTS_ARM_CHAIN_H

#include "lib/arm_random.h"

/* A chain of `count` links, each moved by a joint of its own. */
static inline void chain(struct arm_arrays *arm, uint32_t count, uint32_t kind)
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

#endif
