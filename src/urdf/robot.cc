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

/* An urdfdom before 5.1 leaves this one without a body. */
namespace urdf
{
class Capsule;
}

namespace
{

/*
 * urdfdom hands text of the file to printf as a format. No '%' gets there: it travels as a character that no file has.
 */
const char percent = '\x01';

std::string hidden(std::string text)
{
    std::replace(text.begin(), text.end(), '%', percent);
    return text;
}

std::string plain(std::string text)
{
    std::replace(text.begin(), text.end(), percent, '%');
    return text;
}

/* Capsules, where urdfdom has them: C is complete then. */
template <class C, class = std::size_t> struct Capsules {
    static bool are_known()
    {
        return false;
    }

    static bool take(const urdf::Geometry *, Shape *)
    {
        return false;
    }
};

template <class C> struct Capsules<C, decltype(sizeof(C))> {
    static bool are_known()
    {
        return true;
    }

    static bool take(const urdf::Geometry *geometry, Shape *shape)
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
 * Takes what urdfdom logs as warning or error; below that is what it took by default. Handlers and level are the
 * process's: one reads at a time, what other threads log meanwhile goes where it went, and at the end all are as they
 * were, the handler before the last one too. While they change nothing is logged.
 */
class Log : public console_bridge::OutputHandler
{
  public:
    Log() : alone(mutex()), owner(std::this_thread::get_id()), level(console_bridge::getLogLevel())
    {
        console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_NONE);
        before = console_bridge::getOutputHandler();
        console_bridge::restorePreviousOutputHandler();
        previous = console_bridge::getOutputHandler();
        console_bridge::useOutputHandler(this);
        console_bridge::setLogLevel(std::min(level, console_bridge::CONSOLE_BRIDGE_LOG_WARN));
    }

    ~Log()
    {
        console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_NONE);
        console_bridge::useOutputHandler(previous);
        console_bridge::useOutputHandler(before);
        console_bridge::setLogLevel(level);
    }

    void log(const std::string &text, console_bridge::LogLevel at, const char *file,
             int line) override
    {
        if (std::this_thread::get_id() == owner) {
            if (at >= console_bridge::CONSOLE_BRIDGE_LOG_WARN)
                lines.push_back(plain(text));
        } else if (before && at >= level)
            before->log(text, at, file, line);
    }

    std::vector<std::string> lines;

  private:
    static std::mutex &mutex()
    {
        static std::mutex one;
        return one;
    }

    std::lock_guard<std::mutex> alone;
    std::thread::id owner;
    console_bridge::LogLevel level;
    console_bridge::OutputHandler *before, *previous;
};

/* The first link or joint that a message names, between [] or ''. */
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
            size_t said = text.find("oint", at < 8 ? 0 : at - 8);
            is_joint = said != std::string::npos && said < at;
        }
        if (is_joint || is_link) {
            *owner = (is_joint ? "joint " : "link ") + quoted(name);
            *line = is_joint ? outline.joint_line(joint->second) : outline.link_line(link->second);
            return true;
        }
    }
    return false;
}

/* The first message is the cause; one of those behind it may say whose. */
[[noreturn]] void complain(const std::vector<std::string> &lines, const Outline &outline)
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

/* No number that is NaN or infinite gets through urdfdom; those beyond reason do. */
double bounded(double number, size_t line, const std::string &owner, const char *what)
{
    if (!(std::fabs(number) <= DPT_COORDINATE_MAX))
        refuse(DPT_E_FINITE, line, "%s: %s is beyond 1e6", owner.c_str(), what);
    return number;
}

double positive(double number, size_t line, const std::string &owner, const char *what)
{
    bounded(number, line, owner, what);
    if (number < 0.0)
        refuse(DPT_E_SYNTAX, line, "%s: %s is negative", owner.c_str(), what);
    return number;
}

Frame frame_of(const urdf::Pose &pose, size_t line, const std::string &owner)
{
    const urdf::Vector3 &p = pose.position;
    const urdf::Rotation &q = pose.rotation;
    for (double number : { p.x, p.y, p.z })
        bounded(number, line, owner, "its <origin>");
    return { { p.x, p.y, p.z }, q.w, { q.x, q.y, q.z } };
}

struct Builder {
    const Outline &outline;
    const urdf::ModelInterface &model;
    Notes &notes;
    Robot robot;

    size_t joint_index(const std::string &name) const
    {
        auto found = outline.joint_named.find(plain(name));
        return found == outline.joint_named.end() ? none : found->second;
    }

    Shape shape(const urdf::Collision &collision, const Link &link);
    void link(size_t index);
    void limits(const urdf::Joint &from, size_t element, Joint *joint);
    void missing_limits(const Joint &joint, size_t element);
    void axis(const urdf::Joint &from, Joint *joint);
    void joint(size_t index);
    void tree();
};

Shape Builder::shape(const urdf::Collision &collision, const Link &link)
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
        shape.file = plain(mesh->filename);
        shape.size = { mesh->scale.x, mesh->scale.y, mesh->scale.z };
    } else if (!Capsules<urdf::Capsule>::take(geometry, &shape)) {
        refuse(DPT_E_UNSUPPORTED, link.line, "%s: a collision shape of unknown kind",
               owner.c_str());
    }
    positive(shape.radius, link.line, owner, "a shape's radius");
    positive(shape.length, link.line, owner, "a shape's length");
    if (shape.kind == Shape::BOX)
        for (double edge : { shape.size.x, shape.size.y, shape.size.z })
            positive(edge, link.line, owner, "a box's size");
    return shape;
}

void Builder::link(size_t index)
{
    const Element &element = outline.elements[outline.links[index]];
    Link link = { *element.attribute("name"), element.line, none, {}, 0.0, { 0.0, 0.0, 0.0 }, {} };
    const std::string owner = "link " + quoted(link.name);
    urdf::LinkConstSharedPtr from = model.getLink(hidden(link.name));
    if (!from)
        refuse(DPT_E_SYNTAX, link.line, "%s: urdfdom does not have it", owner.c_str());
    if (from->inertial) {
        link.mass = positive(from->inertial->mass, link.line, owner, "its mass");
        link.centre = frame_of(from->inertial->origin, link.line, owner).p;
    }
    for (const urdf::CollisionSharedPtr &collision : from->collision_array)
        link.shapes.push_back(shape(*collision, link));
    robot.links.push_back(link);
}

/* What <limit> does not say is 0 to urdfdom. What is in an element stands behind it, before all else. */
void Builder::missing_limits(const Joint &joint, size_t element)
{
    for (size_t i = element + 1;
         i < outline.elements.size() && outline.elements[i].parent >= element; i++) {
        const Element &limit = outline.elements[i];
        if (limit.parent != element || limit.tag != "limit")
            continue;
        const bool lower = limit.attribute("lower"), upper = limit.attribute("upper");
        if (!lower || !upper)
            notes.say(joint.line, "joint " + quoted(joint.name) + " has no " +
                                      (lower   ? "upper limit: it is 0"
                                       : upper ? "lower limit: it is 0"
                                               : "lower and upper limit: they are 0"));
    }
}

void Builder::limits(const urdf::Joint &from, size_t element, Joint *joint)
{
    const std::string owner = "joint " + quoted(joint->name);
    if (from.limits) {
        joint->lower = bounded(from.limits->lower, joint->line, owner, "its lower limit");
        joint->upper = bounded(from.limits->upper, joint->line, owner, "its upper limit");
        joint->velocity = positive(from.limits->velocity, joint->line, owner, "its velocity limit");
        joint->effort = positive(from.limits->effort, joint->line, owner, "its effort limit");
    }
    if (joint->lower > joint->upper)
        refuse(DPT_E_SYNTAX, joint->line, "%s: its lower limit is above its upper one",
               owner.c_str());
    if (joint->kind == Joint::CONTINUOUS && (joint->lower < 0.0 || joint->upper > 0.0))
        notes.say(joint->line, owner + " is continuous: its lower and upper limit are left out");
    if (joint->kind == Joint::CONTINUOUS)
        joint->lower = joint->upper = 0.0;
    else
        missing_limits(*joint, element);
    if (from.dynamics) {
        joint->damping = positive(from.dynamics->damping, joint->line, owner, "its damping");
        joint->friction = positive(from.dynamics->friction, joint->line, owner, "its friction");
    }
}

void Builder::axis(const urdf::Joint &from, Joint *joint)
{
    const std::string owner = "joint " + quoted(joint->name);
    Vec axis = { from.axis.x, from.axis.y, from.axis.z };
    double most = std::max({ std::fabs(axis.x), std::fabs(axis.y), std::fabs(axis.z) });
    if (!(most > 0.0))
        refuse(DPT_E_SYNTAX, joint->line, "%s: its axis is 0 0 0: give it a direction",
               owner.c_str());
    axis = (1.0 / most) * axis;
    joint->axis = (1.0 / std::sqrt(dot(axis, axis))) * axis;
    if (!(std::fabs(most * std::sqrt(dot(axis, axis)) - 1.0) < 1e-6))
        notes.say(joint->line, owner + ": its axis is made one of unit length");
}

void Builder::joint(size_t index)
{
    const Element &element = outline.elements[outline.joints[index]];
    Joint joint = {};
    joint.name = *element.attribute("name");
    joint.line = element.line;
    joint.mimics = none;
    const std::string owner = "joint " + quoted(joint.name);
    urdf::JointConstSharedPtr from = model.getJoint(hidden(joint.name));
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
    joint.place = frame_of(from->parent_to_joint_origin_transform, joint.line, owner);
    joint.parent = outline.link_named.at(plain(from->parent_link_name));
    joint.child = outline.link_named.at(plain(from->child_link_name));
    joint.axis = { 0.0, 0.0, 0.0 };
    if (joint.kind == Joint::REVOLUTE || joint.kind == Joint::CONTINUOUS ||
        joint.kind == Joint::PRISMATIC) {
        axis(*from, &joint);
        limits(*from, outline.joints[index], &joint);
    }
    if (from->mimic) {
        joint.mimics = joint_index(from->mimic->joint_name);
        joint.factor = bounded(from->mimic->multiplier, joint.line, owner, "its multiplier");
        joint.offset = bounded(from->mimic->offset, joint.line, owner, "its offset");
        if (joint.mimics == none)
            refuse(DPT_E_SYNTAX, joint.line, "%s mimics %s, and there is no such joint",
                   owner.c_str(), quoted(plain(from->mimic->joint_name)).c_str());
    }
    robot.joints.push_back(joint);
}

void Builder::tree()
{
    for (size_t j = 0; j < robot.joints.size(); j++) {
        robot.links[robot.joints[j].child].joint = j;
        robot.links[robot.joints[j].parent].children.push_back(robot.joints[j].child);
    }
    robot.root = outline.link_named.at(plain(model.getRoot()->name));
}

} // namespace

Robot read_robot(const std::string &xml, Notes &notes)
{
    Outline outline = outline_of(xml);
    outline_check(&outline, Capsules<urdf::Capsule>::are_known(), notes);
    outline_tree(outline);
    urdf::ModelInterfaceSharedPtr model;
    {
        Log log;
        model = urdf::parseURDF(hidden(outline_text(outline)));
        if (!log.lines.empty())
            complain(log.lines, outline);
    }
    if (!model)
        refuse(DPT_E_SYNTAX, 0, "urdfdom refuses it, and does not say why");
    Builder builder = { outline, *model, notes, Robot() };
    builder.robot.name = plain(model->getName());
    for (size_t i = 0; i < outline.links.size(); i++)
        builder.link(i);
    for (size_t i = 0; i < outline.joints.size(); i++)
        builder.joint(i);
    builder.tree();
    return builder.robot;
}
