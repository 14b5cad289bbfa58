/* SPDX-License-Identifier: BSD-3-Clause */
#include "urdf/outline.h"

namespace
{

const size_t none = static_cast<size_t>(-1);

struct Tree {
    const Outline &outline;
    std::vector<size_t> parent; /* joint of each link; none: it hangs on nothing */
    std::vector<std::vector<size_t>> children;

    std::string link_name(size_t link) const
    {
        return quoted(*outline.elements[outline.links[link]].attribute("name"));
    }

    std::string joint_name(size_t joint) const
    {
        return quoted(*outline.elements[outline.joints[joint]].attribute("name"));
    }

    void hang(size_t joint, size_t from, size_t to);
    void check_root() const;
};

void Tree::hang(size_t joint, size_t from, size_t to)
{
    size_t line = outline.joint_line(joint);
    if (from == none || to == none)
        refuse(DPT_E_SYNTAX, line, "joint %s has no %s", joint_name(joint).c_str(),
               from == none ? "parent" : "child");
    if (parent[to] != none)
        refuse(DPT_E_SYNTAX, line,
               "joint %s: its child %s is that of joint %s already: a URDF is a tree",
               joint_name(joint).c_str(), link_name(to).c_str(), joint_name(parent[to]).c_str());
    parent[to] = joint;
    children[from].push_back(to);
}

void Tree::check_root() const
{
    std::vector<size_t> next;
    for (size_t i = 0; i < parent.size(); i++) {
        if (parent[i] != none)
            continue;
        if (!next.empty())
            refuse(DPT_E_SYNTAX, outline.link_line(i),
                   "link %s hangs on no joint, as the root %s does: join them",
                   link_name(i).c_str(), link_name(next[0]).c_str());
        next.push_back(i);
    }
    std::vector<bool> reached(parent.size());
    while (!next.empty()) {
        size_t at = next.back();
        next.pop_back();
        reached[at] = true;
        next.insert(next.end(), children[at].begin(), children[at].end());
    }
    for (size_t i = 0; i < parent.size(); i++)
        if (!reached[i])
            refuse(DPT_E_SYNTAX, outline.link_line(i),
                   "link %s hangs on itself, by joint %s: a URDF is a tree", link_name(i).c_str(),
                   joint_name(parent[i]).c_str());
}

} // namespace

void outline_tree(const Outline &outline)
{
    const size_t links = outline.links.size(), joints = outline.joints.size();
    if (!links)
        refuse(DPT_E_SYNTAX, outline.elements[0].line, "the robot has no link");
    Tree tree = { outline, std::vector<size_t>(links, none),
                  std::vector<std::vector<size_t>>(links) };
    std::vector<size_t> joint_of(outline.elements.size(), none), from(joints, none),
        to(joints, none);
    for (size_t j = 0; j < joints; j++)
        joint_of[outline.joints[j]] = j;
    for (const Element &e : outline.elements) {
        const size_t joint = joint_of[e.parent];
        const std::string *link = e.attribute("link");
        if (joint == none || !link || (e.tag != "parent" && e.tag != "child"))
            continue;
        auto found = outline.link_named.find(*link);
        if (found == outline.link_named.end())
            refuse(DPT_E_SYNTAX, e.line, "joint %s: its %s %s is no link of this file",
                   tree.joint_name(joint).c_str(), e.tag.c_str(), quoted(*link).c_str());
        (e.tag == "parent" ? from : to)[joint] = found->second;
    }
    for (size_t j = 0; j < joints; j++)
        tree.hang(j, from[j], to[j]);
    tree.check_root();
}
