/* SPDX-License-Identifier: BSD-3-Clause */
#include "lib/arm_random.h"

struct arm arm_of(const dpt_arm_def *def)
{
    struct arm arm = { { NULL, 0 }, NULL };
    dpt_diag diag = { .size = sizeof diag };
    dpt_result result = dpt_compile_arm(def, &arm.file, &diag);
    if (result == DPT_OK)
        result = dpt_arm_convert(arm.file.bytes, arm.file.size, NULL);
    if (result == DPT_OK)
        result = dpt_arm_open(arm.file.bytes, arm.file.size, &arm.open);
    CHECK(result == DPT_OK, "%s: %s", dpt_result_name(result), diag.text);
    return arm;
}

/* A joint of its own while there is room for one, or one that there is. */
static void joint_random(uint64_t *random, struct arm_arrays *arm, dpt_arm_link *link, uint32_t most)
{
    dpt_arm_def *def = &arm->def;
    link->slides = random_bits(random) % 4 == 0;
    link->factor = 1.0;
    link->offset = 0.0;
    if (def->joint_count == 0 || (def->joint_count < most && random_bits(random) % 4)) {
        link->joint = def->joint_count++;
        dpt_arm_joint *joint = &arm->joints[link->joint];
        *joint = (dpt_arm_joint){ .size = sizeof *joint,
                                  .kind = link->slides              ? DPT_JOINT_PRISMATIC
                                          : random_bits(random) % 2 ? DPT_JOINT_REVOLUTE
                                                                    : DPT_JOINT_CONTINUOUS };
        if (joint->kind != DPT_JOINT_CONTINUOUS) {
            joint->lower = random_in(random, -3.0, 0.0);
            joint->upper = random_in(random, 0.0, 3.0);
        }
        joint->effort = random_in(random, 0.0, 10.0);
        snprintf(joint->name, sizeof joint->name, "joint_%u", link->joint);
    } else {
        link->joint = (uint32_t)(random_bits(random) % def->joint_count);
        link->factor = random_in(random, 0.2, 2.0) * (random_bits(random) % 2 ? 1.0 : -1.0);
        link->offset = random_in(random, -1.0, 1.0);
    }
}

void arm_random(uint64_t *random, struct arm_arrays *arm)
{
    dpt_arm_def *def = &arm->def;
    uint8_t leads[DPT_ARM_LINKS_MAX] = { 0 };
    const uint32_t most = 1 + (uint32_t)(random_bits(random) % DPT_JOINTS_MAX);
    memset(arm, 0, sizeof *arm);
    *def = (dpt_arm_def){ .size = sizeof *def,
                          .joints = arm->joints,
                          .links = arm->links,
                          .segments = arm->segments,
                          .bodies = arm->bodies,
                          .name = "random",
                          .root_name = "base",
                          .tool_name = "tool" };
    def->link_count = most + (uint32_t)(random_bits(random) % 6);
    def->tool_link = (uint32_t)(random_bits(random) % def->link_count);
    def->tool = pose_random(random, 0.3);
    for (uint32_t i = 0; i < def->link_count; i++) {
        dpt_arm_link *link = &arm->links[i];
        *link = (dpt_arm_link){ .size = sizeof *link, .parent = i - 1 };
        if (random_bits(random) % 4 == 0)
            link->parent = (uint32_t)(random_bits(random) % (i + 1)) - 1; /* -1: DPT_NONE */
        link->pose = pose_random(random, 0.5);
        unit_random(random, link->axis, 3);
        link->mass = random_bits(random) % 4 ? random_in(random, 0.0, 3.0) : 0.0;
        for (int k = 0; k < 3; k++)
            link->centre[k] = random_in(random, -0.2, 0.2);
    }
    for (uint32_t i = def->tool_link; i != DPT_NONE; i = arm->links[i].parent)
        leads[i] = 1;
    for (uint32_t i = 0; i < def->link_count; i++)
        if (leads[i])
            joint_random(random, arm, &arm->links[i], most);
    for (uint32_t i = 0; i < def->link_count; i++)
        if (!leads[i])
            joint_random(random, arm, &arm->links[i], most);
}
