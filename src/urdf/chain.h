/* SPDX-License-Identifier: BSD-3-Clause */
/* A robot with a tool at one of its links, as the flat arrays of an arm. */
#ifndef DPT_URDF_CHAIN_H
#define DPT_URDF_CHAIN_H

#include "urdf/robot.h"

/* Where a link of the robot is. */
struct Attachment {
    size_t arm_link;    /* link of the arm; none: the root */
    Frame pose;         /* in it, what does not move with the arm being held */
    size_t fixed_group; /* first of the links that fixed joints join to this one */
};

struct Chain {
    size_t tool_link;                /* link of the robot */
    std::vector<size_t> coordinates; /* joints of the robot */
    std::vector<dpt_arm_joint> joints;
    std::vector<dpt_arm_link> links;
    std::vector<dpt_segment> segments;
    std::vector<Attachment> attachments; /* of each link of the robot */
};

/* `tool` may be NULL: the only link without children. */
Chain chain_of(const Robot &robot, const char *tool, Notes &notes);

dpt_pose pose_of(const Frame &frame);

/* A name into a field of DPT_ARM_NAME bytes, the rest zeros; a fault when it is too long. `what`: "joint". */
void put_name(char to[DPT_ARM_NAME], const std::string &name, const char *what, size_t line);

#endif
