/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * An arm with all that the format has, as arrays and compiled. golden/arm_2_mesh_6.dpa holds it, arm_1_mesh_6.dpa the
 * same without tips.
 */
#ifndef DPT_TESTS_WHOLE_ARM_H
#define DPT_TESTS_WHOLE_ARM_H

#include "arm/arm_format.h"
#include "lib/arm_random.h"
#include "lib/dpa.h"

/* As the format has them: not by the library's structs. */
enum { HEADER = 336, JOINT = 120, LINK = 144, SEGMENT = 56, BODY = 136, TIP = 88, CORNER = 24 };
enum { JOINTS = 2, LINKS = 3, SEGMENTS = 2, BODIES = 2, JAWS = 2, JAW_LINKS = 3, TIPS = 3 };
enum {
    AT_JOINTS = HEADER,
    AT_LINKS = AT_JOINTS + JOINTS * JOINT,
    AT_SEGMENTS = AT_LINKS + LINKS * LINK,
    AT_BODIES = AT_SEGMENTS + SEGMENTS * SEGMENT,
    AT_JAWS = AT_BODIES + BODIES * BODY,
    AT_JAW_LINKS = AT_JAWS + JAWS * JOINT,
    AT_TIPS = AT_JAW_LINKS + JAW_LINKS * LINK,
    AT_CORNERS = AT_TIPS + TIPS * TIP,
    CORNERS = 4 + 3 + 4,
    AT_END = AT_CORNERS + CORNERS * CORNER
};

static struct file meshes[BODIES]; /* in the host's byte order, as all here */
static struct file whole;

/* A wedge-like tip, a flat one, and one at the end of a finger that slides on a jaw. */
static const double tip_corners[3 * CORNERS] = {
    0.0, 0.0, 0.0, 0.01, 0.0, 0.0, 0.0, 0.01, 0.0,  0.0, 0.0,   0.02, /* of the first */
    0.0, 0.0, 0.0, 0.03, 0.0, 0.0, 0.0, 0.0,  0.01,                   /* of the second */
    0.0, 0.0, 0.0, 0.02, 0.0, 0.0, 0.0, 0.02, 0.0,  0.0, 0.003, 0.004 /* of the third */
};

/* A lift that turns a bar, at whose end a link mimics the turn; two meshes around. At its tool two jaws. */
static const struct arm_arrays lift = {
    .def = { .size = sizeof(dpt_arm_def),
             .joint_count = JOINTS,
             .link_count = LINKS,
             .segment_count = SEGMENTS,
             .body_count = BODIES,
             .tool_link = 2,
             .tool = { { 0.0, 0.0, 0.125 }, { 0.5, 0.5, -0.5, 0.5 } },
             .name = "lift",
             .root_name = "floor",
             .tool_name = "tip",
             .source_bytes = 1234,
             .source_hash = 0x0123456789abcdefu,
             .jaw_count = JAWS,
             .jaw_link_count = JAW_LINKS,
             .tip_count = TIPS },
    .joints = { { .size = sizeof(dpt_arm_joint),
                  .kind = DPT_JOINT_PRISMATIC,
                  .lower = -0.25,
                  .upper = 0.5,
                  .velocity = 0.3,
                  .effort = 100.0,
                  .damping = 2.0,
                  .friction = 0.5,
                  .name = "rail" },
                { .size = sizeof(dpt_arm_joint), .kind = DPT_JOINT_CONTINUOUS, .name = "elbow" } },
    .links = { { .size = sizeof(dpt_arm_link),
                 .parent = DPT_NONE,
                 .joint = 0,
                 .slides = 1,
                 .pose = DPT_POSE_IDENTITY,
                 .axis = { 0.0, 0.0, 1.0 },
                 .factor = 1.0,
                 .mass = 4.0 },
               { .size = sizeof(dpt_arm_link),
                 .parent = 0,
                 .joint = 1,
                 .pose = { { 0.1, 0.2, 0.3 }, { 0.6, 0.0, 0.8, 0.0 } },
                 .axis = { 0.0, 1.0, 0.0 },
                 .factor = 1.0,
                 .offset = 0.25,
                 .mass = 1.5,
                 .centre = { 0.2, 0.0, 0.01 } },
               { .size = sizeof(dpt_arm_link),
                 .parent = 1,
                 .joint = 1,
                 .pose = { { 0.4, 0.0, 0.0 }, { 1.0, 0.0, 0.0, 0.0 } },
                 .axis = { 0.0, 0.6, -0.8 },
                 .factor = -2.0 } },
    .segments = { { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.1 }, 0.004 }, { { 0.01, 0.0, 0.0 }, { 0.0, 0.02, 0.1 }, 0.0 } },
    .bodies = { { .size = sizeof(dpt_arm_body), .pose = DPT_POSE_IDENTITY, .name = "table" },
                { .size = sizeof(dpt_arm_body),
                  .pose = { { 1.0, -2.0, 3.0 }, { 0.0, 0.0, 0.0, -1.0 } },
                  .name = "lamp" } },
    .jaws = { { .size = sizeof(dpt_arm_joint),
                .kind = DPT_JOINT_REVOLUTE,
                .upper = 0.7,
                .velocity = 3.0,
                .name = "squeeze" },
              { .size = sizeof(dpt_arm_joint),
                .kind = DPT_JOINT_PRISMATIC,
                .lower = -0.01,
                .upper = 0.01,
                .name = "slide" } },
    .jaw_links = { { .size = sizeof(dpt_arm_link),
                     .parent = DPT_NONE,
                     .joint = 0,
                     .pose = { { 0.0, 0.0, 0.1 }, { 0.6, 0.0, 0.8, 0.0 } },
                     .axis = { 0.0, 1.0, 0.0 },
                     .factor = 1.0 },
                   { .size = sizeof(dpt_arm_link),
                     .parent = DPT_NONE,
                     .joint = 0,
                     .pose = { { 0.0, 0.01, 0.1 }, { 1.0, 0.0, 0.0, 0.0 } },
                     .axis = { 0.0, 0.6, -0.8 },
                     .factor = -1.0,
                     .offset = 0.1 },
                   { .size = sizeof(dpt_arm_link),
                     .parent = 0,
                     .joint = 1,
                     .slides = 1,
                     .pose = { { 0.02, 0.0, 0.0 }, { 0.5, 0.5, -0.5, 0.5 } },
                     .axis = { 1.0, 0.0, 0.0 },
                     .factor = 1.0 } },
    .tips = { { .size = sizeof(dpt_arm_tip),
                .link = DPT_NONE,
                .corner_count = 4,
                .corners = tip_corners,
                .name = "palm" },
              { .size = sizeof(dpt_arm_tip),
                .link = 1,
                .corner_count = 3,
                .corners = tip_corners + 12,
                .radius = 0.001,
                .name = "jaw" },
              { .size = sizeof(dpt_arm_tip),
                .link = 2,
                .corner_count = 4,
                .corners = tip_corners + 21,
                .radius = 0.0,
                .name = "finger" } },
};

static inline void whole_arm(struct arm_arrays *arm)
{
    *arm = lift;
    arm->def.joints = arm->joints;
    arm->def.links = arm->links;
    arm->def.segments = arm->segments;
    arm->def.bodies = arm->bodies;
    arm->def.jaws = arm->jaws;
    arm->def.jaw_links = arm->jaw_links;
    arm->def.tips = arm->tips;
    for (int i = 0; i < BODIES; i++)
        arm->bodies[i].mesh = (const void *)meshes[i].bytes;
}

static inline void make_whole(void)
{
    struct arm_arrays arrays;
    meshes[0] = file_of_shape("box", 12);
    meshes[1] = file_of_holed_shape("sphere", 40, 1);
    whole_arm(&arrays);
    struct arm arm = arm_of(&arrays.def);
    whole = file_of(arm.file.bytes, arm.file.size);
    dpt_compiled_free(&arm.file);
}

static inline void free_whole(void)
{
    for (int i = 0; i < BODIES; i++)
        free(meshes[i].bytes);
    free(whole.bytes);
}

#endif
