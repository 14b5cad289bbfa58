/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The elements of the XML with their lines. They are read before urdfdom reads them, because urdfdom knows no lines,
 * crashes on some text, and silently ignores what it does not know.
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
    size_t parent; /* index of the parent element; the root is its own parent */
    std::vector<Attribute> attributes;

    const std::string *attribute(const char *name) const;
};

struct Outline {
    std::vector<Element> elements;             /* in the file's order; the first is the root */
    std::vector<size_t> links;                 /* elements that are a <link> of the robot; all names differ */
    std::vector<size_t> joints;                /* elements that are a <joint> of the robot; all names differ */
    std::map<std::string, size_t> link_named;  /* indices of `links` */
    std::map<std::string, size_t> joint_named; /* indices of `joints` */

    size_t link_line(size_t link) const
    {
        return elements[links[link]].line;
    }
    size_t joint_line(size_t joint) const
    {
        return elements[joints[joint]].line;
    }
};

/*
 * Parse the XML with expat. Throws a fault if it is not well-formed, too deep, or has too many elements or attributes.
 */
Outline outline_of(const std::string &xml);

/*
 * Write elements and attributes, and nothing else, as plain XML in UTF-8 for urdfdom. Its parser, TinyXML, accepts much
 * that is not XML and reads it in a way of its own.
 */
std::string outline_text(const Outline &outline);

/*
 * Check the elements against the vocabulary of a URDF, and fill in links and joints. Throws a fault for what urdfdom
 * would ignore and then misread: a name or an element given twice, an unknown attribute in place of a known one. Notes
 * what is not part of a URDF.
 *
 *   knows_capsules   this build's urdfdom knows capsules and quaternions, in files of version 1.1
 */
void outline_check(Outline *outline, bool knows_capsules, Notes &notes);

/*
 * Throw a fault unless the joints make one tree of all links, each a child once. urdfdom does not tell names and lines
 * of such errors.
 */
void outline_check_tree(const Outline &outline);

#endif
