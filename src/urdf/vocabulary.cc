/* SPDX-License-Identifier: BSD-3-Clause */
/* The elements and attributes of a URDF that an arm needs, and the checks of them. */
#include <cmath>
#include <cstring>
#include <locale>
#include <sstream>

#include "urdf/outline.h"

namespace
{

/*
 * Which attributes an element may have, and whether its parent may have several of them. If is_strict, an unknown
 * attribute is a fault while a known one is missing: a misspelt attribute there would move the arm.
 */
struct ElementRule {
    const char *path;
    bool may_repeat;
    bool is_strict;
    /* known ones; "*": neither its attributes nor its content are checked */
    const char *attributes;
};

const ElementRule rules[] = {
    { "robot", false, false, "name version xmlns" },
    { "robot/material", true, false, "*" },
    { "robot/link", true, false, "name" },
    { "robot/link/visual", true, false, "*" },
    { "robot/link/inertial", false, false, "" },
    { "robot/link/inertial/origin", false, true, "xyz rpy" },
    { "robot/link/inertial/mass", false, true, "value" },
    { "robot/link/inertial/inertia", false, false, "*" },
    { "robot/link/collision", true, false, "name group" },
    { "robot/link/collision/origin", false, true, "xyz rpy" },
    { "robot/link/collision/geometry", false, false, "" },
    { "robot/link/collision/geometry/box", false, true, "size" },
    { "robot/link/collision/geometry/sphere", false, true, "radius" },
    { "robot/link/collision/geometry/cylinder", false, true, "radius length" },
    { "robot/link/collision/geometry/capsule", false, true, "radius length" },
    { "robot/link/collision/geometry/mesh", false, true, "filename scale" },
    { "robot/joint", true, false, "name type" },
    { "robot/joint/origin", false, true, "xyz rpy" },
    { "robot/joint/parent", false, true, "link" },
    { "robot/joint/child", false, true, "link" },
    { "robot/joint/axis", false, true, "xyz" },
    { "robot/joint/limit", false, false, "lower upper effort velocity" },
    { "robot/joint/mimic", false, true, "joint multiplier offset" },
    { "robot/joint/dynamics", false, true, "damping friction" },
};

const ElementRule *rule_for(const std::string &path)
{
    for (const ElementRule &rule : rules)
        if (path == rule.path)
            return &rule;
    return NULL;
}

bool has_word(const char *attributes, const std::string &name)
{
    for (const char *at = attributes; *at;) {
        size_t length = std::strcspn(at, " ");
        if (name.size() == length && name.compare(0, length, at, length) == 0)
            return true;
        at += length + (at[length] == ' ');
    }
    return false;
}

bool has_all(const Element &element, const char *attributes)
{
    size_t found = 0, count = 1;
    for (const char *at = attributes; *at; at++)
        count += *at == ' ';
    for (const Attribute &a : element.attributes)
        found += has_word(attributes, a.name);
    return found == count;
}

void check_name(const Element &element)
{
    const std::string *name = element.attribute("name");
    for (size_t i = 0; name && i < name->size(); i++)
        if (static_cast<unsigned char>((*name)[i]) < 0x20)
            refuse(DPT_E_SYNTAX, element.line, "%s %s: a line break or tab in its name", element.tag.c_str(),
                   quoted(*name).c_str());
}

struct Ignored {
    size_t line;
    size_t count;
};

struct Checker {
    Outline *outline;
    Notes *notes;
    bool knows_capsules; /* urdfdom does */
    bool is_version_1_1; /* it does, and the file is of such a version */
    /* of each element; empty: not checked, or within such an element */
    std::vector<std::string> paths;
    std::map<std::string, Ignored> ignored; /* by "<tag> in <parent>" */
    std::vector<std::string> ignored_order;

    /* The link or joint that an element belongs to, such as "joint 'elbow'"; else the element's tag. */
    std::string owner(size_t element) const
    {
        for (size_t i = element; i; i = outline->elements[i].parent) {
            const Element &e = outline->elements[i];
            const std::string *name = e.attribute("name");
            if ((paths[i] == "robot/link" || paths[i] == "robot/joint") && name)
                return e.tag + " " + quoted(*name);
        }
        return "<" + outline->elements[element].tag + ">";
    }

    void ignore(size_t line, const std::string &what)
    {
        if (!ignored.count(what)) {
            ignored[what].line = line;
            ignored_order.push_back(what);
        }
        ignored[what].count++;
    }

    void check_quaternion(size_t index, const std::string &value);
    void check_attributes(size_t index, const ElementRule &rule);
    void register_name(size_t index, std::vector<size_t> *list, std::map<std::string, size_t> *by_name);
    void refuse_repeated(size_t index);
    void refuse_capsule(size_t index);
    void check_element(size_t index);
};

/*
 * Check a quaternion. Some libraries write w first; then the identity 1 0 0 0 would be half a turn about x: note that.
 */
void Checker::check_quaternion(size_t index, const std::string &value)
{
    const size_t line = outline->elements[index].line;
    std::istringstream in(value);
    in.imbue(std::locale::classic());
    double q[4] = { 0.0, 0.0, 0.0, 0.0 };
    for (double &number : q)
        in >> number;
    if (!in || !(in >> std::ws).eof())
        refuse(DPT_E_SYNTAX, line, "%s: quat_xyzw %s is not four numbers, x y z w", owner(index).c_str(),
               quoted(value).c_str());
    if (std::fabs(q[0]) > 0.0 && q[1] == 0.0 && q[2] == 0.0 && q[3] == 0.0)
        notes->add(line, owner(index) + ": quat_xyzw " + quoted(value) +
                             " is half a turn about x: the order is x y z w, no turn is 0 0 0 1");
}

void Checker::check_attributes(size_t index, const ElementRule &rule)
{
    const Element &e = outline->elements[index];
    for (const Attribute &a : e.attributes) {
        if (a.value.find("${") != std::string::npos || a.value.find("$(") != std::string::npos)
            refuse(DPT_E_FORMAT, e.line,
                   "%s: %s is for xacro: run `xacro FILE` and compile what it "
                   "prints",
                   owner(index).c_str(), quoted(a.value).c_str());
        if (has_word(rule.attributes, a.name) || a.name.compare(0, 6, "xmlns:") == 0)
            continue;
        if (is_version_1_1 && a.name == "quat_xyzw" && e.tag == "origin") {
            check_quaternion(index, a.value);
            continue;
        }
        if (rule.is_strict && !has_all(e, rule.attributes))
            refuse(DPT_E_SYNTAX, e.line, "%s: <%s> has no attribute %s, only: %s", owner(index).c_str(), e.tag.c_str(),
                   quoted(a.name).c_str(), rule.attributes);
        ignore(e.line, "attribute " + a.name + " of <" + e.tag + ">");
    }
}

void Checker::register_name(size_t index, std::vector<size_t> *list, std::map<std::string, size_t> *by_name)
{
    const Element &e = outline->elements[index];
    const std::string *name = e.attribute("name");
    if (!name || name->empty())
        refuse(DPT_E_SYNTAX, e.line, "a <%s> has no name", e.tag.c_str());
    check_name(e);
    if (by_name->count(*name))
        refuse(DPT_E_SYNTAX, e.line, "%s %s is there twice, first in line %zu", e.tag.c_str(), quoted(*name).c_str(),
               outline->elements[(*list)[(*by_name)[*name]]].line);
    (*by_name)[*name] = list->size();
    list->push_back(index);
}

void Checker::refuse_repeated(size_t index)
{
    const Element &e = outline->elements[index];
    for (size_t i = index - 1; i > e.parent; i--) {
        const Element &other = outline->elements[i];
        if (other.parent != e.parent)
            continue;
        if (other.tag == e.tag)
            refuse(DPT_E_SYNTAX, e.line, "%s: a second <%s>, the first is in line %zu", owner(index).c_str(),
                   e.tag.c_str(), other.line);
        if (outline->elements[e.parent].tag == "geometry")
            refuse(DPT_E_SYNTAX, e.line,
                   "%s: <%s> and <%s> in one <geometry>: each needs its own "
                   "<collision>",
                   owner(index).c_str(), other.tag.c_str(), e.tag.c_str());
    }
}

/* Refuse a capsule that urdfdom cannot read, also in <visual>: urdfdom would drop the whole link. */
void Checker::refuse_capsule(size_t index)
{
    const Element &e = outline->elements[index], &geometry = outline->elements[e.parent],
                  &shape = outline->elements[geometry.parent];
    if (!is_version_1_1 && e.tag == "capsule" && geometry.tag == "geometry" &&
        (shape.tag == "collision" || shape.tag == "visual") && paths[shape.parent] == "robot/link")
        refuse(knows_capsules ? DPT_E_UNSUPPORTED : DPT_E_ABSENT, e.line, "%s: %s", owner(index).c_str(),
               knows_capsules ? "<capsule> is of URDF 1.1: write <robot version=\"1.1\">"
                              : "this build's urdfdom knows no <capsule>: make it a <cylinder>, or build "
                                "with urdfdom 5.1 or later");
}

void Checker::check_element(size_t index)
{
    const Element &e = outline->elements[index];
    const std::string &parent = paths[e.parent];
    refuse_capsule(index);
    if (index && parent.empty())
        return;
    std::string path = index ? parent + "/" + e.tag : e.tag;
    const ElementRule *rule = rule_for(path);
    if (e.tag.compare(0, 6, "xacro:") == 0)
        refuse(DPT_E_FORMAT, e.line, "<%s> is xacro: run `xacro FILE` and compile what it prints", e.tag.c_str());
    if (!rule) {
        /* urdfdom itself refuses a shape that it does not know. */
        if (outline->elements[e.parent].tag != "geometry")
            ignore(e.line, "<" + e.tag + "> in <" + outline->elements[e.parent].tag + ">");
        return;
    }
    if (index && !rule->may_repeat)
        refuse_repeated(index);
    if (std::strcmp(rule->attributes, "*") != 0) {
        paths[index] = path;
        check_attributes(index, *rule);
    }
    if (path == "robot/link")
        register_name(index, &outline->links, &outline->link_named);
    if (path == "robot/joint")
        register_name(index, &outline->joints, &outline->joint_named);
}

} // namespace

void outline_check(Outline *outline, bool knows_capsules, Notes &notes)
{
    const size_t links_max = 4000;
    const Element &root = outline->elements[0];
    if (root.tag != "robot")
        refuse(DPT_E_FORMAT, root.line, "not a URDF: <%.40s> where <robot> should be", root.tag.c_str());
    check_name(root);
    const std::string *version = root.attribute("version");
    const bool is_version_1_1 = knows_capsules && version && *version != "1.0";
    Checker checker = {
        outline, &notes, knows_capsules, is_version_1_1, std::vector<std::string>(outline->elements.size()), {}, {}
    };
    for (size_t i = 0; i < outline->elements.size(); i++) {
        checker.check_element(i);
        if (outline->links.size() > links_max)
            refuse(DPT_E_LIMIT, outline->elements[i].line, "more than %zu links", links_max);
    }
    for (const std::string &what : checker.ignored_order) {
        const Ignored &ignored = checker.ignored[what];
        notes.add(ignored.line, ignored.count == 1
                                    ? what + " is left out"
                                    : line_of_text("%s is left out, %zu times", what.c_str(), ignored.count));
    }
}
