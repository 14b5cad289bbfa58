/* SPDX-License-Identifier: BSD-3-Clause */
/* Turn a robot, with a tool at one of its links, into the flat arrays of an arm. */
#ifndef DPT_URDF_CHAIN_H
#define DPT_URDF_CHAIN_H

#include "urdf/robot.h"

/* Where a link of the robot is attached to the arm. */
struct Attachment {
    size_t arm_link; /* link of the arm that it is fixed to; none: the root */
    Frame pose;      /* in that link's frame; joints that are no part of the arm are held still */
    /* of the links of the robot that fixed joints join to this one: the first */
    size_t fixed_group;
};

/* A link that a joint below the tool moves: a jaw of the tool. Its frame is the joint's. */
struct Jaw {
    size_t joint;      /* of the robot */
    size_t parent;     /* of the jaw links; none: the tool */
    size_t coordinate; /* of the jaws: the one that moves it */
    Frame pose;        /* in the parent's frame, at factor * coordinate + offset = 0 */
    double factor, offset;
};

/* Whether a link of the robot is a part of the tool: fixed to it, or behind a jaw. */
struct ToolPart {
    bool is_part;
    size_t jaw_link; /* none: it is fixed to the tool */
    Frame pose;      /* in the jaw link's frame, or the tool's */
};

struct Chain {
    size_t tool_link;                /* link of the robot that is the tool */
    std::vector<size_t> coordinates; /* of each joint of the arm: the joint of the robot */
    std::vector<dpt_arm_joint> joints;
    std::vector<dpt_arm_link> links;
    std::vector<dpt_segment> segments;
    std::vector<size_t> jaws; /* of each jaw: the joint of the robot */
    std::vector<Jaw> jaw_links;
    std::vector<ToolPart> tool_parts;    /* of each link of the robot */
    std::vector<Attachment> attachments; /* of each link of the robot */
};

/* Build the arm. `tool` names the tool's link; NULL is the only link without children. Throws a fault, adds notes. */
Chain chain_of(const Robot &robot, const char *tool, Notes &notes);

dpt_pose pose_of(const Frame &frame);

/* A joint that an arm can have, as its arrays have it. Throws a fault if its name is too long. */
dpt_arm_joint arm_joint(const Joint &joint);

/* Whether a shape of a part of the tool is a segment: one that a jaw does not move, and a capsule within 1 % or so. */
bool is_segment(const Shape &shape, const ToolPart &part);

/*
 * Copy a name, and fill the rest of `to` with zeros. Throws a fault if it is too long. `what` is its kind in the
 * message, such as "joint".
 */
void put_name(char to[DPT_ARM_NAME], const std::string &name, const char *what, size_t line);

#endif
