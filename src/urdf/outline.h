/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What stands where in the XML: urdfdom knows no lines, crashes on some text, and says nothing of what it passes over.
 */
#ifndef DPT_URDF_OUTLINE_H
#define DPT_URDF_OUTLINE_H

#include <map>
#include <string>
#include <vector>

#include "urdf/fault.h"

struct Attribute {
    std::string name;
    std::string value;
};

struct Element {
    std::string tag;
    size_t line;
    size_t parent; /* the root is its own */
    std::vector<Attribute> attributes;

    const std::string *attribute(const char *name) const;
};

struct Outline {
    std::vector<Element> elements; /* in the file's order; the first is the root */
    std::vector<size_t> links; /* elements that are <link> of the robot, by name all different */
    std::vector<size_t> joints;
    std::map<std::string, size_t> link_named; /* indices of `links` */
    std::map<std::string, size_t> joint_named;

    size_t link_line(size_t link) const
    {
        return elements[links[link]].line;
    }
    size_t joint_line(size_t joint) const
    {
        return elements[joints[joint]].line;
    }
};

/* By expat. Throws a fault for what is not well-formed, or beyond reason in depth and number. */
Outline outline_of(const std::string &xml);

/* Elements and attributes alone, in UTF-8: TinyXML, by which urdfdom reads, takes much that is no XML, and in its own way. */
std::string outline_text(const Outline &outline);

/*
 * Faults for what would be passed over to a wrong end: a name or a part given twice, an attribute that is not one.
 * Notes on what is no part of a URDF. `capsules`: this urdfdom knows them, and quaternions, in files of version 1.1.
 */
void outline_check(Outline *outline, bool knows_capsules, Notes &notes);

/* Faults for joints that do not hang all links on one root, each once: with names and lines, which urdfdom has not. */
void outline_check_tree(const Outline &outline);

#endif
