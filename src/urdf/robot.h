/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A URDF as plain data, in the file's order: what urdfdom made of it, checked. The only file beside it that knows
 * urdfdom is robot.cc.
 */
#ifndef DPT_URDF_ROBOT_H
#define DPT_URDF_ROBOT_H

#include <string>
#include <vector>

#include "urdf/fault.h"
#include "urdf/urdf_frame.h"

static const size_t none = static_cast<size_t>(-1);

struct Shape {
    enum Kind { SPHERE, BOX, CYLINDER, CAPSULE, MESH } kind;
    Frame origin; /* in the link */
    double radius;
    double length; /* of a cylinder all, of a capsule without its ends */
    Vec size;      /* of a box; scale of a mesh */
    std::string file;
};

struct Link {
    std::string name;
    size_t line;
    size_t joint; /* that it hangs on; none: the root */
    std::vector<size_t> children;
    double mass;
    Vec centre;
    std::vector<Shape> shapes;
};

struct Joint {
    enum Kind { FIXED, REVOLUTE, CONTINUOUS, PRISMATIC, FLOATING, PLANAR } kind;
    std::string name;
    size_t line;
    size_t parent, child; /* links */
    Frame origin;         /* in the parent */
    Vec axis;             /* unit */
    double lower, upper, velocity, effort, damping, friction;
    size_t mimics; /* joint; none: nothing */
    double factor, offset;
};

struct Robot {
    std::string name;
    std::vector<Link> links;
    std::vector<Joint> joints;
    size_t root;
};

/* Throws a fault; gives the notes. */
Robot read_robot(const std::string &xml, Notes &notes);

#endif
