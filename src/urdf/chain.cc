/* SPDX-License-Identifier: BSD-3-Clause */
#include "urdf/chain.h"

#include <algorithm>
#include <cmath>
#include <cstring>

dpt_pose pose_of(const Frame &frame)
{
    return { { frame.position.x, frame.position.y, frame.position.z },
             { frame.w, frame.v.x, frame.v.y, frame.v.z } };
}

void put_name(char to[DPT_ARM_NAME], const std::string &name, const char *what, size_t line)
{
    if (name.size() >= DPT_ARM_NAME)
        refuse(DPT_E_LIMIT, line, "%s %s: its name is longer than %d bytes", what,
               quoted(name).c_str(), DPT_ARM_NAME - 1);
    std::memset(to, 0, DPT_ARM_NAME);
    std::memcpy(to, name.data(), name.size());
}

dpt_arm_joint arm_joint(const Joint &from)
{
    dpt_arm_joint joint = {};
    joint.size = sizeof joint;
    joint.kind = from.kind == Joint::PRISMATIC    ? DPT_JOINT_PRISMATIC
                 : from.kind == Joint::CONTINUOUS ? DPT_JOINT_CONTINUOUS
                                                  : DPT_JOINT_REVOLUTE;
    joint.lower = from.lower;
    joint.upper = from.upper;
    joint.velocity = from.velocity;
    joint.effort = from.effort;
    joint.damping = from.damping;
    joint.friction = from.friction;
    put_name(joint.name, from.name, "joint", from.line);
    return joint;
}

bool is_segment(const Shape &shape, const ToolPart &part)
{
    return part.jaw_link == none &&
           (shape.kind == Shape::SPHERE || shape.kind == Shape::CAPSULE ||
            (shape.kind == Shape::CYLINDER && 2.0 * shape.radius <= shape.length));
}

namespace
{

/* A joint's value is factor * the value of joint `base` + offset. */
struct Motion {
    size_t base; /* joint of the robot; none: this joint does not move */
    double factor;
    double offset;
};

std::string joint_text(const Joint &joint)
{
    return "joint " + quoted(joint.name);
}

bool is_movable(const Joint &joint)
{
    return joint.kind == Joint::REVOLUTE || joint.kind == Joint::CONTINUOUS ||
           joint.kind == Joint::PRISMATIC;
}

struct ChainBuilder {
    const Robot &robot;
    Notes &notes;
    Chain chain;
    std::vector<size_t> path;    /* joints of the robot, from the root to the tool */
    std::vector<Motion> motions; /* of each joint of the robot */

    void find_tool(const char *name);
    void find_path();
    Motion resolve_mimics(size_t index) const;
    void find_coordinates();
    void add_coordinate(size_t index);
    void find_tool_parts();
    void add_tool_part(size_t link);
    bool has_shape(size_t link) const;
    bool add_jaw(size_t link, const ToolPart &parent);
    bool is_jaw(const Joint &joint) const;
    void attach_links();
    Attachment attach(size_t child, const Attachment &parent);
    Frame held_frame(const Joint &joint, double value, bool mimics) const;
    void add_masses();
    void collect_capsules();
    void check_mimics();

    bool is_coordinate(size_t joint) const
    {
        return std::find(chain.coordinates.begin(), chain.coordinates.end(), joint) !=
               chain.coordinates.end();
    }
};

void ChainBuilder::find_tool(const char *name)
{
    std::vector<size_t> candidates;
    for (size_t i = 0; i < robot.links.size(); i++) {
        if (name ? robot.links[i].name == name : robot.links[i].children.empty())
            candidates.push_back(i);
    }
    if (candidates.empty())
        refuse(DPT_E_ARGUMENT, 0, "there is no link %s to be the tool", quoted(name).c_str());
    if (candidates.size() > 1) {
        std::string text = line_of_text("name the link that is the tool by --tool: %zu have no children: ",
                                        candidates.size());
        for (size_t i = 0; i < candidates.size(); i++) {
            /* As many names as a dpt_diag has room for; the first one in any case. */
            const std::string name = (i ? ", " : "") + quoted(robot.links[candidates[i]].name);
            if (i > 0 && text.size() + name.size() + sizeof ", ..." > sizeof(dpt_diag::text)) {
                text += ", ...";
                break;
            }
            text += name;
        }
        refuse(DPT_E_ARGUMENT, 0, "%s", text.c_str());
    }
    chain.tool_link = candidates[0];
}

void ChainBuilder::find_path()
{
    for (size_t link = chain.tool_link; robot.links[link].joint != none;
         link = robot.joints[robot.links[link].joint].parent)
        path.push_back(robot.links[link].joint);
    std::reverse(path.begin(), path.end());
    for (size_t index : path) {
        const Joint &joint = robot.joints[index];
        if (joint.kind == Joint::FLOATING || joint.kind == Joint::PLANAR)
            refuse(DPT_E_UNSUPPORTED, joint.line,
                   "%s on the way to the tool is %s: an arm has revolute, continuous and prismatic "
                   "ones",
                   joint_text(joint).c_str(),
                   joint.kind == Joint::FLOATING ? "floating" : "planar");
    }
}

/* Follow a chain of mimics to the joint that mimics no other, and multiply out factors and offsets on the way. */
Motion ChainBuilder::resolve_mimics(size_t index) const
{
    Motion motion = { index, 1.0, 0.0 };
    for (size_t steps = 0; robot.joints[motion.base].mimics != none; steps++) {
        const Joint &joint = robot.joints[motion.base];
        if (steps > robot.joints.size())
            refuse(DPT_E_SYNTAX, robot.joints[index].line, "%s mimics itself, by way of others",
                   joint_text(robot.joints[index]).c_str());
        motion.offset += motion.factor * joint.offset;
        motion.factor *= joint.factor;
        motion.base = joint.mimics;
    }
    const Joint &base = robot.joints[motion.base];
    if (motion.base != index && !is_movable(base))
        refuse(DPT_E_UNSUPPORTED, robot.joints[index].line,
               "%s mimics %s, which neither turns about an axis nor slides along one",
               joint_text(robot.joints[index]).c_str(), quoted(base.name).c_str());
    if (!(std::fabs(motion.factor) <= DPT_COORDINATE_MAX) ||
        !(std::fabs(motion.offset) <= DPT_COORDINATE_MAX))
        refuse(DPT_E_FINITE, robot.joints[index].line,
               "%s: its multiplier and offset, through all that it mimics, are beyond 1e6",
               joint_text(robot.joints[index]).c_str());
    if (motion.factor == 0.0 || !is_movable(robot.joints[index]))
        motion.base = none;
    return motion;
}

void ChainBuilder::add_coordinate(size_t index)
{
    const Joint &from = robot.joints[index];
    if (chain.joints.size() == DPT_JOINTS_MAX)
        refuse(DPT_E_LIMIT, from.line,
               "%s is the ninth on the way to the tool: an arm has at most %d",
               joint_text(from).c_str(), DPT_JOINTS_MAX);
    chain.coordinates.push_back(index);
    chain.joints.push_back(arm_joint(from));
    if (from.kind != Joint::CONTINUOUS && from.lower == from.upper)
        notes.add(from.line, joint_text(from) + " cannot move: its limits are equal");
}

void ChainBuilder::find_coordinates()
{
    for (size_t i = 0; i < robot.joints.size(); i++)
        motions.push_back(resolve_mimics(i));
    for (size_t index : path)
        if (motions[index].base != none && !is_coordinate(motions[index].base))
            add_coordinate(motions[index].base);
    if (chain.coordinates.empty())
        refuse(DPT_E_UNSUPPORTED, robot.links[chain.tool_link].line,
               "link %s is the tool, and no joint between it and the root %s moves",
               quoted(robot.links[chain.tool_link].name).c_str(),
               quoted(robot.links[robot.root].name).c_str());
}

/* An arm has the limits of its coordinates alone. Note each mimicking joint whose own limits are narrower. */
void ChainBuilder::check_mimics()
{
    for (size_t i = 0; i < robot.joints.size(); i++) {
        const Joint &joint = robot.joints[i];
        const Motion &motion = motions[i];
        if (joint.mimics == none || motion.base == none || !is_coordinate(motion.base) ||
            joint.kind == Joint::CONTINUOUS)
            continue;
        const Joint &base = robot.joints[motion.base];
        double a = motion.factor * base.lower + motion.offset,
               b = motion.factor * base.upper + motion.offset,
               slack = 1e-9 * (1.0 + std::fabs(a - b));
        if (base.kind == Joint::CONTINUOUS || std::min(a, b) < joint.lower - slack ||
            std::max(a, b) > joint.upper + slack)
            notes.add(joint.line, joint_text(joint) + " leaves its own limits when " +
                                      quoted(base.name) + ", which it mimics, goes to its");
    }
}

/* Whether any link from this one on has a collision shape. */
bool ChainBuilder::has_shape(size_t link) const
{
    std::vector<size_t> queue(1, link);
    for (size_t i = 0; i < queue.size(); i++) {
        const Link &at = robot.links[queue[i]];
        if (!at.shapes.empty())
            return true;
        queue.insert(queue.end(), at.children.begin(), at.children.end());
    }
    return false;
}

/* A link that its joint moves in the tool, if there is room for another jaw. */
bool ChainBuilder::add_jaw(size_t link, const ToolPart &parent)
{
    const size_t index = robot.links[link].joint;
    const Motion &motion = motions[index];
    size_t coordinate =
        std::find(chain.jaws.begin(), chain.jaws.end(), motion.base) - chain.jaws.begin();
    if (chain.jaw_links.size() == DPT_ARM_LINKS_MAX || coordinate == DPT_JOINTS_MAX)
        return false;
    /* A jaw moves a link in the way of its kind; one that is mimicked by others alone does not. */
    if (coordinate == chain.jaws.size())
        chain.jaws.push_back(motion.base);
    chain.jaw_links.push_back({ index, parent.jaw_link, coordinate,
                                parent.pose * robot.joints[index].origin, motion.factor,
                                motion.offset });
    chain.tool_parts[link] = { true, chain.jaw_links.size() - 1, identity };
    return true;
}

bool ChainBuilder::is_jaw(const Joint &joint) const
{
    return chain.tool_parts[joint.child].is_part &&
           chain.tool_parts[joint.child].jaw_link != none &&
           robot.joints[chain.jaw_links[chain.tool_parts[joint.child].jaw_link].joint].child ==
               joint.child;
}

void ChainBuilder::add_tool_part(size_t link)
{
    const Joint &joint = robot.joints[robot.links[link].joint];
    const Motion &motion = motions[robot.links[link].joint];
    const ToolPart &parent = chain.tool_parts[joint.parent];
    if (!parent.is_part)
        return;
    if (joint.kind == Joint::FIXED)
        chain.tool_parts[link] = { true, parent.jaw_link, parent.pose * joint.origin };
    else if (motion.base != none && !is_coordinate(motion.base) && is_movable(joint) &&
             is_movable(robot.joints[motion.base]) && has_shape(link))
        add_jaw(link, ToolPart(parent));
}

/* All that is fixed to the tool's link, and what joints below move. */
void ChainBuilder::find_tool_parts()
{
    size_t top = chain.tool_link;
    Frame pose = identity;
    while (robot.links[top].joint != none &&
           robot.joints[robot.links[top].joint].kind == Joint::FIXED) {
        pose = pose * inverse(robot.joints[robot.links[top].joint].origin);
        top = robot.joints[robot.links[top].joint].parent;
    }
    chain.tool_parts.assign(robot.links.size(), ToolPart{ false, none, identity });
    chain.tool_parts[top] = { true, none, pose };
    std::vector<size_t> queue(1, top);
    for (size_t i = 0; i < queue.size(); i++)
        for (size_t child : robot.links[queue[i]].children) {
            add_tool_part(child);
            queue.push_back(child);
        }
}

/* The frame of a joint that is no part of the arm, held at `value` (rad or m), in its parent link's frame. Notes it. */
Frame ChainBuilder::held_frame(const Joint &joint, double value, bool mimics) const
{
    if (!is_movable(joint)) {
        if (joint.kind != Joint::FIXED)
            notes.add(joint.line, joint_text(joint) + " is no part of the arm: held at its origin");
        return joint.origin;
    }
    if (!is_jaw(joint))
        notes.add(joint.line, joint_text(joint) + " is no part of the arm: held" +
                                  (value == 0.0 ? " at 0"
                                   : mimics     ? " where what it mimics puts it"
                                                : " at its limit nearest to 0"));
    Frame motion = identity;
    if (joint.kind == Joint::PRISMATIC) {
        motion.position = value * joint.axis;
    } else {
        motion.w = std::cos(0.5 * value);
        motion.v = std::sin(0.5 * value) * joint.axis;
    }
    return joint.origin * motion;
}

Attachment ChainBuilder::attach(size_t child, const Attachment &parent)
{
    const size_t index = robot.links[child].joint;
    const Joint &joint = robot.joints[index];
    const Motion &motion = motions[index];
    if (motion.base == none || !is_coordinate(motion.base)) {
        double value = motion.offset;
        if (motion.base != none) {
            const Joint &base = robot.joints[motion.base];
            double base_value = base.kind == Joint::CONTINUOUS
                                    ? 0.0
                                    : std::max(base.lower, std::min(base.upper, 0.0));
            value += motion.factor * base_value;
        }
        return { parent.arm_link, parent.pose * held_frame(joint, value, joint.mimics != none),
                 joint.kind == Joint::FIXED ? parent.fixed_group : child };
    }
    if (chain.links.size() == DPT_ARM_LINKS_MAX)
        refuse(DPT_E_LIMIT, joint.line, "%s: more than %d links move with the arm",
               joint_text(joint).c_str(), DPT_ARM_LINKS_MAX);
    dpt_arm_link link = {};
    link.size = sizeof link;
    link.parent = parent.arm_link == none ? DPT_NONE : static_cast<uint32_t>(parent.arm_link);
    link.joint = static_cast<uint32_t>(
        std::find(chain.coordinates.begin(), chain.coordinates.end(), motion.base) -
        chain.coordinates.begin());
    link.slides = joint.kind == Joint::PRISMATIC;
    link.pose = pose_of(parent.pose * joint.origin);
    link.axis[0] = joint.axis.x;
    link.axis[1] = joint.axis.y;
    link.axis[2] = joint.axis.z;
    link.factor = motion.factor;
    link.offset = motion.offset;
    chain.links.push_back(link);
    return { chain.links.size() - 1, identity, child };
}

void ChainBuilder::attach_links()
{
    chain.attachments.assign(robot.links.size(), Attachment{ none, identity, robot.root });
    std::vector<size_t> queue(1, robot.root);
    for (size_t i = 0; i < queue.size(); i++) {
        for (size_t child : robot.links[queue[i]].children) {
            chain.attachments[child] = attach(child, chain.attachments[queue[i]]);
            queue.push_back(child);
        }
    }
}

/* Add the mass of each link of the robot to the link of the arm that it is fixed to, and average the centres. */
void ChainBuilder::add_masses()
{
    std::vector<Vec> mass_moments(chain.links.size(), Vec{ 0.0, 0.0, 0.0 });
    for (size_t i = 0; i < robot.links.size(); i++) {
        const Attachment &attachment = chain.attachments[i];
        if (attachment.arm_link == none)
            continue;
        chain.links[attachment.arm_link].mass += robot.links[i].mass;
        mass_moments[attachment.arm_link] =
            mass_moments[attachment.arm_link] +
            robot.links[i].mass * (attachment.pose * robot.links[i].centre);
    }
    double mass = 0.0;
    for (size_t i = 0; i < chain.links.size(); i++) {
        dpt_arm_link &link = chain.links[i];
        mass += link.mass;
        if (!(link.mass > 0.0))
            continue;
        link.centre[0] = mass_moments[i].x / link.mass;
        link.centre[1] = mass_moments[i].y / link.mass;
        link.centre[2] = mass_moments[i].z / link.mass;
    }
    if (!(mass > 0.0))
        notes.add(robot.joints[chain.coordinates[0]].line,
                  "no link from " + joint_text(robot.joints[chain.coordinates[0]]) +
                      " on has a mass: the arm is not held up against its weight");
}

/* Half the length of the axis of a shape that is a segment, along z of the shape's frame. */
double half_length_of(const Shape &shape)
{
    if (shape.kind == Shape::SPHERE)
        return 0.0;
    return 0.5 * shape.length - (shape.kind == Shape::CYLINDER ? shape.radius : 0.0);
}

void ChainBuilder::collect_capsules()
{
    for (size_t i = 0; i < robot.links.size(); i++) {
        const Link &link = robot.links[i];
        const ToolPart &part = chain.tool_parts[i];
        size_t ignored_shapes = 0;
        for (const Shape &shape : link.shapes) {
            if (!part.is_part) {
                ignored_shapes += chain.attachments[i].fixed_group != robot.root ||
                                  (shape.kind != Shape::BOX && shape.kind != Shape::MESH);
                continue;
            }
            if (!is_segment(shape, part))
                continue;
            if (chain.segments.size() == DPT_ARM_SEGMENTS_MAX)
                refuse(DPT_E_LIMIT, link.line, "link %s: the tool has more than %d capsules",
                       quoted(link.name).c_str(), DPT_ARM_SEGMENTS_MAX);
            const Frame in_tool = part.pose * shape.origin;
            const Vec a = in_tool * Vec{ 0.0, 0.0, -half_length_of(shape) },
                      b = in_tool * Vec{ 0.0, 0.0, half_length_of(shape) };
            chain.segments.push_back({ { a.x, a.y, a.z }, { b.x, b.y, b.z }, shape.radius });
        }
        if (ignored_shapes)
            notes.add(link.line,
                      line_of_text("link %s: %zu collision shape%s left out: neither the "
                                   "tool's nor meshes and boxes of the scene",
                                   quoted(link.name).c_str(), ignored_shapes,
                                   ignored_shapes > 1 ? "s" : ""));
    }
}

} // namespace

Chain chain_of(const Robot &robot, const char *tool, Notes &notes)
{
    ChainBuilder builder = { robot, notes, Chain(), {}, {} };
    builder.find_tool(tool);
    builder.find_path();
    builder.find_coordinates();
    builder.check_mimics();
    builder.find_tool_parts();
    builder.attach_links();
    builder.add_masses();
    builder.collect_capsules();
    return builder.chain;
}
