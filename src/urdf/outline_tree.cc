/* SPDX-License-Identifier: BSD-3-Clause */
#include "urdf/outline.h"

namespace
{

const size_t none = static_cast<size_t>(-1);

struct LinkTree {
    const Outline &outline;
    std::vector<size_t> parent_joint; /* of each link; none: it is the child of no joint */
    std::vector<std::vector<size_t>> children;

    std::string link_name(size_t link) const
    {
        return quoted(*outline.elements[outline.links[link]].attribute("name"));
    }

    std::string joint_name(size_t joint) const
    {
        return quoted(*outline.elements[outline.joints[joint]].attribute("name"));
    }

    void attach(size_t joint, size_t parent_link, size_t child_link);
    void check_root() const;
};

void LinkTree::attach(size_t joint, size_t parent_link, size_t child_link)
{
    size_t line = outline.joint_line(joint);
    if (parent_link == none || child_link == none)
        refuse(DPT_E_SYNTAX, line, "joint %s has no %s", joint_name(joint).c_str(),
               parent_link == none ? "parent" : "child");
    if (parent_joint[child_link] != none)
        refuse(DPT_E_SYNTAX, line,
               "joint %s: its child %s is that of joint %s already: a URDF is a tree",
               joint_name(joint).c_str(), link_name(child_link).c_str(),
               joint_name(parent_joint[child_link]).c_str());
    parent_joint[child_link] = joint;
    children[parent_link].push_back(child_link);
}

void LinkTree::check_root() const
{
    std::vector<size_t> pending;
    for (size_t i = 0; i < parent_joint.size(); i++) {
        if (parent_joint[i] != none)
            continue;
        if (!pending.empty())
            refuse(DPT_E_SYNTAX, outline.link_line(i),
                   "link %s hangs on no joint, as the root %s does: join them",
                   link_name(i).c_str(), link_name(pending[0]).c_str());
        pending.push_back(i);
    }
    std::vector<bool> is_reached(parent_joint.size());
    while (!pending.empty()) {
        size_t at = pending.back();
        pending.pop_back();
        is_reached[at] = true;
        pending.insert(pending.end(), children[at].begin(), children[at].end());
    }
    for (size_t i = 0; i < parent_joint.size(); i++)
        if (!is_reached[i])
            refuse(DPT_E_SYNTAX, outline.link_line(i),
                   "link %s hangs on itself, by joint %s: a URDF is a tree", link_name(i).c_str(),
                   joint_name(parent_joint[i]).c_str());
}

} // namespace

void outline_check_tree(const Outline &outline)
{
    const size_t links = outline.links.size(), joints = outline.joints.size();
    if (!links)
        refuse(DPT_E_SYNTAX, outline.elements[0].line, "the robot has no link");
    LinkTree tree = { outline, std::vector<size_t>(links, none),
                      std::vector<std::vector<size_t>>(links) };
    std::vector<size_t> joint_of(outline.elements.size(), none), parent_link(joints, none),
        child_link(joints, none);
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
        (e.tag == "parent" ? parent_link : child_link)[joint] = found->second;
    }
    for (size_t j = 0; j < joints; j++)
        tree.attach(j, parent_link[j], child_link[j]);
    tree.check_root();
}
