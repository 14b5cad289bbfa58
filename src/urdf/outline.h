/* SPDX-License-Identifier: BSD-3-Clause */
/* The elements of a URDF with their lines, and the faults and notes that name these lines. */
#ifndef DPT_URDF_OUTLINE_H
#define DPT_URDF_OUTLINE_H

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "dynpoint/urdf.h"

/*
 * Faults end a compilation. They are thrown only inside this library, and caught at its one public function. Notes do
 * not end it.
 */
struct Fault {
    dpt_result code;
    size_t line; /* of the URDF, from 1; 0: no line */
    std::string text;
};

/* Format text as printf does. Control characters become '?', so that it stays one line. */
std::string line_of_text(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* Throw a fault with such a text. */
[[noreturn]] void refuse(dpt_result code, size_t line, const char *format, ...) __attribute__((format(printf, 3, 4)));

/* A name between quotes, for a message: control characters become '?', and a long name is cut. */
std::string quoted(const std::string &name);

/*
 * Throw a fault with the text "OWNER: 'PATH'REASON". If a dpt_diag cannot hold all of it, the middle of the path is cut
 * out, so that the end of the path and the reason stay. If the reason is long, the owner is left out: the line number
 * identifies it too.
 */
[[noreturn]] void refuse_path(dpt_result code, size_t line, const std::string &owner, const std::string &path,
                              const std::string &reason);

/* What was left out or held still. Notes are delivered at the end, when the arm is certain to compile. */
struct Note {
    size_t line;
    std::string text;
};

struct Notes {
    std::vector<Note> list;

    void add(size_t line, const std::string &text)
    {
        list.push_back({ line, text });
    }
};

/*
 * The elements of the XML with their lines. They are read before urdfdom reads them, because urdfdom knows no lines,
 * crashes on some text, and silently ignores what it does not know.
 */

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
