/* SPDX-License-Identifier: BSD-3-Clause */
#include "urdf/robot.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <thread>

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include "urdf/outline.h"

/* Before 5.1, urdfdom does not define this class. */
namespace urdf
{
class Capsule;
}

namespace
{

/*
 * urdfdom passes text of the file to printf as a format. So no '%' may reach it. This character stands for '%' on the
 * way: no XML file can contain it.
 */
const char percent_stand_in = '\x01';

std::string hide_percent(std::string text)
{
    std::replace(text.begin(), text.end(), '%', percent_stand_in);
    return text;
}

std::string restore_percent(std::string text)
{
    std::replace(text.begin(), text.end(), percent_stand_in, '%');
    return text;
}

/* Reads capsules if this build's urdfdom has them: then, and only then, C is a complete type. */
template <class C, class = std::size_t> struct Capsules {
    static bool are_supported()
    {
        return false;
    }

    static bool read(const urdf::Geometry *, Shape *)
    {
        return false;
    }
};

template <class C> struct Capsules<C, decltype(sizeof(C))> {
    static bool are_supported()
    {
        return true;
    }

    static bool read(const urdf::Geometry *geometry, Shape *shape)
    {
        const C *capsule = dynamic_cast<const C *>(geometry);
        if (!capsule)
            return false;
        shape->kind = Shape::CAPSULE;
        shape->radius = capsule->radius;
        shape->length = capsule->length;
        return true;
    }
};

/*
 * Collects what urdfdom logs as a warning or an error in this thread. It does not log less important messages.
 *
 * console_bridge has one handler and one level for the whole process. So a mutex lets one file be read at a time, and
 * what other threads log meanwhile goes to the handler that was installed before. The destructor restores the level,
 * that handler and the one before it. Nothing is logged while handlers are exchanged.
 */
class LogCapture : public console_bridge::OutputHandler
{
  public:
    LogCapture()
        : lock(mutex()), thread(std::this_thread::get_id()),
          saved_level(console_bridge::getLogLevel())
    {
        console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_NONE);
        saved_handler = console_bridge::getOutputHandler();
        console_bridge::restorePreviousOutputHandler();
        saved_previous = console_bridge::getOutputHandler();
        console_bridge::useOutputHandler(this);
        console_bridge::setLogLevel(std::min(saved_level, console_bridge::CONSOLE_BRIDGE_LOG_WARN));
    }

    ~LogCapture()
    {
        console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_NONE);
        console_bridge::useOutputHandler(saved_previous);
        console_bridge::useOutputHandler(saved_handler);
        console_bridge::setLogLevel(saved_level);
    }

    void log(const std::string &text, console_bridge::LogLevel at, const char *file,
             int line) override
    {
        if (std::this_thread::get_id() == thread) {
            if (at >= console_bridge::CONSOLE_BRIDGE_LOG_WARN)
                lines.push_back(restore_percent(text));
        } else if (saved_handler && at >= saved_level)
            saved_handler->log(text, at, file, line);
    }

    std::vector<std::string> lines;

  private:
    static std::mutex &mutex()
    {
        static std::mutex one;
        return one;
    }

    std::lock_guard<std::mutex> lock;
    std::thread::id thread;
    console_bridge::LogLevel saved_level;
    console_bridge::OutputHandler *saved_handler, *saved_previous;
};

/* Find the first link or joint whose name stands in a message, between [] or ''. */
bool find_owner(const std::string &text, const Outline &outline, std::string *owner, size_t *line)
{
    for (size_t at = 0; (at = text.find_first_of("['", at)) != std::string::npos; at++) {
        size_t end = text.find(text[at] == '[' ? ']' : '\'', at + 1);
        if (end == std::string::npos)
            continue;
        std::string name = text.substr(at + 1, end - at - 1);
        auto joint = outline.joint_named.find(name), link = outline.link_named.find(name);
        bool is_joint = joint != outline.joint_named.end(),
             is_link = link != outline.link_named.end();
        if (is_joint && is_link) {
            size_t word_at = text.find("oint", at < 8 ? 0 : at - 8);
            is_joint = word_at != std::string::npos && word_at < at;
        }
        if (is_joint || is_link) {
            *owner = (is_joint ? "joint " : "link ") + quoted(name);
            *line = is_joint ? outline.joint_line(joint->second) : outline.link_line(link->second);
            return true;
        }
    }
    return false;
}

/* Throw a fault with the first message, which is the cause. A later message may name the link or joint. */
[[noreturn]] void report_errors(const std::vector<std::string> &lines, const Outline &outline)
{
    std::string owner;
    size_t line = 0;
    for (const std::string &text : lines) {
        if (!find_owner(text, outline, &owner, &line))
            continue;
        if (&text == &lines[0])
            break;
        refuse(DPT_E_SYNTAX, line, "%s: %s", owner.c_str(), lines[0].c_str());
    }
    refuse(DPT_E_SYNTAX, line, "%s", lines[0].c_str());
}

/* Throw a fault if a number is beyond 1e6. urdfdom refuses NaN and infinity itself. Returns the number. */
double check_bounded(double number, size_t line, const std::string &owner, const char *what)
{
    if (!(std::fabs(number) <= DPT_COORDINATE_MAX))
        refuse(DPT_E_FINITE, line, "%s: %s is beyond 1e6", owner.c_str(), what);
    return number;
}

double check_not_negative(double number, size_t line, const std::string &owner, const char *what)
{
    check_bounded(number, line, owner, what);
    if (number < 0.0)
        refuse(DPT_E_SYNTAX, line, "%s: %s is negative", owner.c_str(), what);
    return number;
}

Frame frame_of(const urdf::Pose &pose, size_t line, const std::string &owner)
{
    const urdf::Vector3 &p = pose.position;
    const urdf::Rotation &q = pose.rotation;
    for (double number : { p.x, p.y, p.z })
        check_bounded(number, line, owner, "its <origin>");
    return { { p.x, p.y, p.z }, q.w, { q.x, q.y, q.z } };
}

struct RobotBuilder {
    const Outline &outline;
    const urdf::ModelInterface &model;
    Notes &notes;
    Robot robot;

    size_t joint_index(const std::string &name) const
    {
        auto found = outline.joint_named.find(restore_percent(name));
        return found == outline.joint_named.end() ? none : found->second;
    }

    Shape read_shape(const urdf::Collision &collision, const Link &link);
    void read_link(size_t index);
    void read_limits(const urdf::Joint &from, size_t element, Joint *joint);
    void note_missing_limits(const Joint &joint, size_t element);
    void read_axis(const urdf::Joint &from, Joint *joint);
    void read_joint(size_t index);
    void connect_links();
};

Shape RobotBuilder::read_shape(const urdf::Collision &collision, const Link &link)
{
    const std::string owner = "link " + quoted(link.name);
    const urdf::Geometry *geometry = collision.geometry.get();
    Shape shape = {
        Shape::SPHERE, frame_of(collision.origin, link.line, owner), 0.0, 0.0, { 0.0, 0.0, 0.0 }, ""
    };
    if (const auto *sphere = dynamic_cast<const urdf::Sphere *>(geometry)) {
        shape.radius = sphere->radius;
    } else if (const auto *box = dynamic_cast<const urdf::Box *>(geometry)) {
        shape.kind = Shape::BOX;
        shape.size = { box->dim.x, box->dim.y, box->dim.z };
    } else if (const auto *cylinder = dynamic_cast<const urdf::Cylinder *>(geometry)) {
        shape.kind = Shape::CYLINDER;
        shape.radius = cylinder->radius;
        shape.length = cylinder->length;
    } else if (const auto *mesh = dynamic_cast<const urdf::Mesh *>(geometry)) {
        shape.kind = Shape::MESH;
        shape.file = restore_percent(mesh->filename);
        shape.size = { mesh->scale.x, mesh->scale.y, mesh->scale.z };
    } else if (!Capsules<urdf::Capsule>::read(geometry, &shape)) {
        refuse(DPT_E_UNSUPPORTED, link.line, "%s: a collision shape of unknown kind",
               owner.c_str());
    }
    check_not_negative(shape.radius, link.line, owner, "a shape's radius");
    check_not_negative(shape.length, link.line, owner, "a shape's length");
    if (shape.kind == Shape::BOX)
        for (double edge : { shape.size.x, shape.size.y, shape.size.z })
            check_not_negative(edge, link.line, owner, "a box's size");
    return shape;
}

void RobotBuilder::read_link(size_t index)
{
    const Element &element = outline.elements[outline.links[index]];
    Link link = { *element.attribute("name"), element.line, none, {}, 0.0, { 0.0, 0.0, 0.0 }, {} };
    const std::string owner = "link " + quoted(link.name);
    urdf::LinkConstSharedPtr from = model.getLink(hide_percent(link.name));
    if (!from)
        refuse(DPT_E_SYNTAX, link.line, "%s: urdfdom does not have it", owner.c_str());
    if (from->inertial) {
        link.mass = check_not_negative(from->inertial->mass, link.line, owner, "its mass");
        link.centre = frame_of(from->inertial->origin, link.line, owner).position;
    }
    for (const urdf::CollisionSharedPtr &collision : from->collision_array)
        link.shapes.push_back(read_shape(*collision, link));
    robot.links.push_back(link);
}

/*
 * Note a <limit> without `lower` or `upper`: urdfdom takes these as 0. The descendants of an element follow it directly
 * in the outline.
 */
void RobotBuilder::note_missing_limits(const Joint &joint, size_t element)
{
    for (size_t i = element + 1;
         i < outline.elements.size() && outline.elements[i].parent >= element; i++) {
        const Element &limit = outline.elements[i];
        if (limit.parent != element || limit.tag != "limit")
            continue;
        const bool has_lower = limit.attribute("lower"), has_upper = limit.attribute("upper");
        if (!has_lower || !has_upper)
            notes.add(joint.line, "joint " + quoted(joint.name) + " has no " +
                                      (has_lower   ? "upper limit: it is 0"
                                       : has_upper ? "lower limit: it is 0"
                                                   : "lower and upper limit: they are 0"));
    }
}

void RobotBuilder::read_limits(const urdf::Joint &from, size_t element, Joint *joint)
{
    const std::string owner = "joint " + quoted(joint->name);
    if (from.limits) {
        joint->lower = check_bounded(from.limits->lower, joint->line, owner, "its lower limit");
        joint->upper = check_bounded(from.limits->upper, joint->line, owner, "its upper limit");
        joint->velocity =
            check_not_negative(from.limits->velocity, joint->line, owner, "its velocity limit");
        joint->effort =
            check_not_negative(from.limits->effort, joint->line, owner, "its effort limit");
    }
    if (joint->lower > joint->upper)
        refuse(DPT_E_SYNTAX, joint->line, "%s: its lower limit is above its upper one",
               owner.c_str());
    if (joint->kind == Joint::CONTINUOUS && (joint->lower < 0.0 || joint->upper > 0.0))
        notes.add(joint->line, owner + " is continuous: its lower and upper limit are left out");
    if (joint->kind == Joint::CONTINUOUS)
        joint->lower = joint->upper = 0.0;
    else
        note_missing_limits(*joint, element);
    if (from.dynamics) {
        joint->damping =
            check_not_negative(from.dynamics->damping, joint->line, owner, "its damping");
        joint->friction =
            check_not_negative(from.dynamics->friction, joint->line, owner, "its friction");
    }
}

void RobotBuilder::read_axis(const urdf::Joint &from, Joint *joint)
{
    const std::string owner = "joint " + quoted(joint->name);
    Vec axis = { from.axis.x, from.axis.y, from.axis.z };
    double max_size = std::max({ std::fabs(axis.x), std::fabs(axis.y), std::fabs(axis.z) });
    if (!(max_size > 0.0))
        refuse(DPT_E_SYNTAX, joint->line, "%s: its axis is 0 0 0: give it a direction",
               owner.c_str());
    axis = (1.0 / max_size) * axis;
    joint->axis = (1.0 / std::sqrt(dot(axis, axis))) * axis;
    if (!(std::fabs(max_size * std::sqrt(dot(axis, axis)) - 1.0) < 1e-6))
        notes.add(joint->line, owner + ": its axis is made one of unit length");
}

void RobotBuilder::read_joint(size_t index)
{
    const Element &element = outline.elements[outline.joints[index]];
    Joint joint = {};
    joint.name = *element.attribute("name");
    joint.line = element.line;
    joint.mimics = none;
    const std::string owner = "joint " + quoted(joint.name);
    urdf::JointConstSharedPtr from = model.getJoint(hide_percent(joint.name));
    if (!from)
        refuse(DPT_E_SYNTAX, joint.line, "%s: urdfdom does not have it", owner.c_str());
    switch (from->type) {
    case urdf::Joint::FIXED:
        joint.kind = Joint::FIXED;
        break;
    case urdf::Joint::REVOLUTE:
        joint.kind = Joint::REVOLUTE;
        break;
    case urdf::Joint::CONTINUOUS:
        joint.kind = Joint::CONTINUOUS;
        break;
    case urdf::Joint::PRISMATIC:
        joint.kind = Joint::PRISMATIC;
        break;
    case urdf::Joint::PLANAR:
        joint.kind = Joint::PLANAR;
        break;
    case urdf::Joint::FLOATING:
        joint.kind = Joint::FLOATING;
        break;
    default:
        refuse(DPT_E_UNSUPPORTED, joint.line, "%s: a joint of unknown kind", owner.c_str());
    }
    joint.origin = frame_of(from->parent_to_joint_origin_transform, joint.line, owner);
    joint.parent = outline.link_named.at(restore_percent(from->parent_link_name));
    joint.child = outline.link_named.at(restore_percent(from->child_link_name));
    joint.axis = { 0.0, 0.0, 0.0 };
    if (joint.kind == Joint::REVOLUTE || joint.kind == Joint::CONTINUOUS ||
        joint.kind == Joint::PRISMATIC) {
        read_axis(*from, &joint);
        read_limits(*from, outline.joints[index], &joint);
    }
    if (from->mimic) {
        joint.mimics = joint_index(from->mimic->joint_name);
        joint.factor = check_bounded(from->mimic->multiplier, joint.line, owner, "its multiplier");
        joint.offset = check_bounded(from->mimic->offset, joint.line, owner, "its offset");
        if (joint.mimics == none)
            refuse(DPT_E_SYNTAX, joint.line, "%s mimics %s, and there is no such joint",
                   owner.c_str(), quoted(restore_percent(from->mimic->joint_name)).c_str());
    }
    robot.joints.push_back(joint);
}

void RobotBuilder::connect_links()
{
    for (size_t j = 0; j < robot.joints.size(); j++) {
        robot.links[robot.joints[j].child].joint = j;
        robot.links[robot.joints[j].parent].children.push_back(robot.joints[j].child);
    }
    robot.root = outline.link_named.at(restore_percent(model.getRoot()->name));
}

} // namespace

Robot read_robot(const std::string &xml, Notes &notes)
{
    Outline outline = outline_of(xml);
    outline_check(&outline, Capsules<urdf::Capsule>::are_supported(), notes);
    outline_check_tree(outline);
    urdf::ModelInterfaceSharedPtr model;
    {
        LogCapture log;
        model = urdf::parseURDF(hide_percent(outline_text(outline)));
        if (!log.lines.empty())
            report_errors(log.lines, outline);
    }
    if (!model)
        refuse(DPT_E_SYNTAX, 0, "urdfdom refuses it, and does not say why");
    RobotBuilder builder = { outline, *model, notes, Robot() };
    builder.robot.name = restore_percent(model->getName());
    for (size_t i = 0; i < outline.links.size(); i++)
        builder.read_link(i);
    for (size_t i = 0; i < outline.joints.size(); i++)
        builder.read_joint(i);
    builder.connect_links();
    return builder.robot;
}
