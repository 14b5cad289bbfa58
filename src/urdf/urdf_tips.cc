/* SPDX-License-Identifier: BSD-3-Clause */
#include "urdf/urdf_tips.h"

#include <algorithm>

namespace
{

/* A ball is an octahedron of that share of its radius, with round edges: larger than the ball by at most 2 % of it. */
const double octahedron = 0.05;

/* And of a capsule's length at least, or its corners would be too near to a line. */
const double octahedron_of_length = 0.004;

struct TipBuilder {
    const Robot &robot;
    const Chain &chain;
    const std::string &file;
    const char *packages;
    const dpt_compile_def &mesh;
    Notes &notes;
    Tips *tips;

    void add_jaws();
    void add_shape(size_t link, const Shape &shape);
    void add_tip(size_t link, const Frame &frame, std::vector<double> corners, double radius);
    void add_kind(size_t link, const Shape &shape, uint32_t kind, Vec extent);
    void add_round(size_t link, const Shape &shape);
    void add_mesh(size_t link, const Shape &shape);
    std::string name_of(size_t link) const
    {
        return "link " + quoted(robot.links[link].name);
    }
};

void TipBuilder::add_jaws()
{
    for (const Jaw &jaw : chain.jaw_links) {
        const Joint &joint = robot.joints[jaw.joint];
        dpt_arm_link link = {};
        link.size = sizeof link;
        link.parent = jaw.parent == none ? DPT_NONE : static_cast<uint32_t>(jaw.parent);
        link.joint = static_cast<uint32_t>(jaw.coordinate);
        link.slides = joint.kind == Joint::PRISMATIC;
        link.pose = pose_of(jaw.pose);
        link.axis[0] = joint.axis.x;
        link.axis[1] = joint.axis.y;
        link.axis[2] = joint.axis.z;
        link.factor = jaw.factor;
        link.offset = jaw.offset;
        tips->jaw_links.push_back(link);
    }
    for (size_t i = 0; i < chain.jaws.size(); i++) {
        dpt_arm_joint joint = arm_joint(robot.joints[chain.jaws[i]]);
        bool slides = false, turns = false;
        for (const dpt_arm_link &link : tips->jaw_links)
            if (link.joint == i)
                (link.slides ? slides : turns) = true;
        /* Where only joints of the other kind mimic it and bear a shape, the coordinate is of their kind. */
        if (joint.kind == DPT_JOINT_PRISMATIC ? !slides : !turns)
            joint.kind = slides ? DPT_JOINT_PRISMATIC : DPT_JOINT_REVOLUTE;
        tips->jaws.push_back(joint);
    }
}

/* Corners in the frame of a shape, which is in that of the link. What is too thin for a hull is noted. */
void TipBuilder::add_tip(size_t link, const Frame &frame, std::vector<double> corners,
                         double radius)
{
    const ToolPart &part = chain.tool_parts[link];
    const Frame in_part = part.pose * frame;
    dpt_arm_tip tip = {};
    uint64_t block[2048];
    const dpt_hull *hull;
    for (size_t i = 0; i < corners.size(); i += 3) {
        const Vec at = in_part * Vec{ corners[i], corners[i + 1], corners[i + 2] };
        corners[i] = at.x;
        corners[i + 1] = at.y;
        corners[i + 2] = at.z;
    }
    dpt_hull_def def = {};
    def.size = sizeof def;
    def.corner_count = static_cast<uint32_t>(corners.size() / 3);
    def.corners = corners.data();
    def.radius = radius;
    if (dpt_hull_create(block, sizeof block, &def, &hull) != DPT_OK) {
        notes.add(robot.links[link].line,
                  name_of(link) + ": a shape of the tool is left out: it is too thin for a tip");
        return;
    }
    if (tips->tips.size() == DPT_ARM_TIPS_MAX)
        refuse(DPT_E_LIMIT, robot.links[link].line, "%s: the tool has more than %d tips",
               name_of(link).c_str(), DPT_ARM_TIPS_MAX);
    tips->corners.push_back(corners);
    tip.size = sizeof tip;
    tip.link = part.jaw_link == none ? DPT_NONE : static_cast<uint32_t>(part.jaw_link);
    tip.corner_count = def.corner_count;
    tip.corners = tips->corners.back().data();
    tip.radius = radius;
    put_name(tip.name, robot.links[link].name, "link", robot.links[link].line);
    tips->tips.push_back(tip);
}

/* A shape that the core has corners of. */
void TipBuilder::add_kind(size_t link, const Shape &shape, uint32_t kind, Vec extent)
{
    std::vector<double> corners(3 * DPT_HULL_CORNERS_MAX);
    uint32_t count = 0;
    dpt_hull_shape made = {};
    made.size = sizeof made;
    made.kind = kind;
    made.extent[0] = extent.x;
    made.extent[1] = extent.y;
    made.extent[2] = extent.z;
    dpt_hull_shape_corners(&made, corners.data(), DPT_HULL_CORNERS_MAX, &count);
    corners.resize(3 * static_cast<size_t>(count));
    add_tip(link, shape.origin, corners, 0.0);
    if (kind == DPT_HULL_KIND_CYLINDER && count)
        notes.add(robot.links[link].line,
                  name_of(link) + ": a cylinder is felt with 16 flat sides around it, by up to 2 % "
                                  "of its radius farther out");
}

/* A ball or a capsule that a jaw moves: segments of a tool do not. */
void TipBuilder::add_round(size_t link, const Shape &shape)
{
    const double half = shape.kind == Shape::CAPSULE ? 0.5 * shape.length : 0.0;
    const double size = std::max(octahedron * shape.radius, octahedron_of_length * half);
    std::vector<double> corners;
    for (int end = half > 0.0 ? -1 : 1; end <= 1; end += 2)
        for (int corner = 0; corner < 6; corner++)
            for (int k = 0; k < 3; k++)
                corners.push_back((k == corner / 2 ? (corner % 2 ? size : -size) : 0.0) +
                                  (k == 2 ? end * half : 0.0));
    /* The octahedron holds a ball of 0.577 of its size. */
    add_tip(link, shape.origin, corners, std::max(0.0, shape.radius - 0.577 * size));
}

void TipBuilder::add_mesh(size_t link, const Shape &shape)
{
    const size_t line = robot.links[link].line;
    CompiledMesh compiled;
    const dpt_mesh *opened;
    const float *vertices;
    uint32_t count, corner_count = 0;
    double radius = 0.0;
    try {
        compile_mesh(robot.links[link], shape, file, packages, mesh, notes, &compiled);
    } catch (const Fault &fault) {
        if (fault.code == DPT_E_MEMORY || fault.code == DPT_E_CANCELLED)
            throw;
        notes.add(line, fault.text + ": left out of the tool");
        return;
    }
    dpt_mesh_convert(compiled.file.bytes, compiled.file.size, NULL);
    dpt_mesh_open(compiled.file.bytes, compiled.file.size, &opened);
    dpt_mesh_get_vertices(opened, &vertices, &count);
    std::vector<double> points(vertices, vertices + 3 * static_cast<size_t>(count));
    std::vector<double> corners(3 * DPT_HULL_CORNERS_MAX);
    const dpt_result result = dpt_compile_hull(points.data(), count, corners.data(),
                                               DPT_HULL_CORNERS_MAX, &corner_count, &radius);
    if (result == DPT_E_MEMORY)
        throw std::bad_alloc();
    if (result != DPT_OK) {
        notes.add(line, name_of(link) + ": a mesh is left out of the tool: it is too thin");
        return;
    }
    corners.resize(3 * static_cast<size_t>(corner_count));
    add_tip(link, shape.origin, corners, radius);
    notes.add(line,
              name_of(link) +
                  (radius > 0.0 ? line_of_text(": a mesh is felt as the hull of %u of its corners, "
                                               "round by %.3g m, which holds it",
                                               static_cast<unsigned>(corner_count), radius)
                                : line_of_text(": a mesh is felt as its hull, of %u corners",
                                               static_cast<unsigned>(corner_count))));
}

void TipBuilder::add_shape(size_t link, const Shape &shape)
{
    switch (shape.kind) {
    case Shape::BOX:
        add_kind(link, shape, DPT_HULL_KIND_BOX, shape.size);
        break;
    case Shape::CYLINDER:
        add_kind(link, shape, DPT_HULL_KIND_CYLINDER,
                 Vec{ 2.0 * shape.radius, 2.0 * shape.radius, shape.length });
        break;
    case Shape::MESH:
        add_mesh(link, shape);
        break;
    default:
        add_round(link, shape);
    }
}

} // namespace

void read_tips(const Robot &robot, const Chain &chain, const std::string &file,
               const char *packages, const dpt_compile_def &mesh, Notes &notes, Tips *tips)
{
    TipBuilder builder = { robot, chain, file, packages, mesh, notes, tips };
    for (size_t i = 0; i < robot.links.size(); i++)
        for (const Shape &shape : robot.links[i].shapes)
            if (chain.tool_parts[i].is_part && !is_segment(shape, chain.tool_parts[i]))
                builder.add_shape(i, shape);
    if (!tips->tips.empty())
        builder.add_jaws();
    if (chain.segments.empty() && tips->tips.empty())
        notes.add(robot.links[chain.tool_link].line,
                  "link " + quoted(robot.links[chain.tool_link].name) +
                      ": the tool has no collision shape to touch with");
}
