/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A URDF as plain data, in the order of the file: what urdfdom read from it, checked. Only robot.cc uses urdfdom.
 *
 * Links and joints are indices of Robot::links and Robot::joints; `none` stands for no such thing. Lengths are in m,
 * angles in rad, masses in kg.
 */
#ifndef DPT_URDF_ROBOT_H
#define DPT_URDF_ROBOT_H

#include <string>
#include <vector>

#include "urdf/outline.h"
#include "urdf/urdf_frame.h"

static const size_t none = static_cast<size_t>(-1);

struct Shape {
    enum Kind { SPHERE, BOX, CYLINDER, CAPSULE, MESH } kind;
    Frame origin; /* in the link's frame */
    double radius;
    double length; /* of a cylinder; of a capsule, without its round ends */
    Vec size;      /* of a box; of a mesh, its scale */
    std::string file;
};

struct Link {
    std::string name;
    size_t line;
    size_t joint; /* of which it is the child; none: it is the root */
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
    Frame origin;         /* in the parent link's frame, at value 0 */
    Vec axis;             /* unit, in the joint's own frame */
    double lower, upper, velocity, effort, damping, friction;
    size_t mimics; /* the joint that it mimics; none: it mimics no joint */
    double factor, offset;
};

struct Robot {
    std::string name;
    std::vector<Link> links;
    std::vector<Joint> joints;
    size_t root;
};

/* Read a URDF. Throws a fault if it is refused; adds notes. */
Robot read_robot(const std::string &xml, Notes &notes);

#endif
