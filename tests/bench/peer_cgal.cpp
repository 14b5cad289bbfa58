/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The peer CGAL: distance from a moving segment to a triangle mesh by its AABB_tree. A program of
 * its own, never installed; it needs neither our headers nor our library.
 *
 *     peer_cgal MESH.tri TRACE.csv -o OUT.csv [--repeat N] [--cold] [--json]
 *
 * The files' formats are in peer.h. CGAL's tree asks for the distance of points alone, so the
 * walk's traits are ours, over Simple_cartesian<double>: the best distance so far prunes boxes,
 * and each tick starts from the distance to the last tick's nearest triangle. CGAL 5 has no
 * distance of segment and triangle either; segment_triangle of peer.h is exact, and does at once
 * what a composition of CGAL's distances does in six steps. The walk keeps the tree's own order:
 * with the nearer child first (traversal_with_priority) it was not faster.
 */
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/version.h>

#include "peer.h"

namespace
{

using namespace peer;

typedef CGAL::Simple_cartesian<double> Kernel;

/* A triangle as the tree keeps it, corners and all, so that they lie in the tree's order. */
class Primitive
{
  public:
    typedef uint32_t Id;
    typedef Kernel::Point_3 Point;
    typedef Kernel::Triangle_3 Datum;

    Primitive()
    {
    }

    Primitive(const Corners &corners, uint32_t id) : corners_(corners), id_(id)
    {
    }

    /* How the tree takes in what it is given. */
    Primitive(std::vector<Primitive>::const_iterator other) : Primitive(*other)
    {
    }

    Id id() const
    {
        return id_;
    }

    Point reference_point() const
    {
        return Point(corners_.p.x, corners_.p.y, corners_.p.z);
    }

    Datum datum() const
    {
        return Datum(reference_point(), Point(corners_.q.x, corners_.q.y, corners_.q.z),
                     Point(corners_.r.x, corners_.r.y, corners_.r.z));
    }

    const Corners &corners() const
    {
        return corners_;
    }

  private:
    Corners corners_;
    uint32_t id_;
};

typedef CGAL::AABB_traits<Kernel, Primitive> Traits;
typedef CGAL::AABB_tree<Traits> Tree;
typedef CGAL::AABB_node<Traits> Node;

struct Segment {
    Vec a, b, u;
    double inverse; /* of u.u, 0 for a point */
};

/* The walk: what is nearest so far, and whether a box can hold something nearer. */
class Walk
{
  public:
    double squared = std::numeric_limits<double>::infinity();
    long nearest = 0, boxes = 0, leaves = 0;

    void try_triangle(const Segment &query, const Corners &corners, long id)
    {
        double d = segment_triangle(query.a, query.b, corners);
        leaves++;
        if (d < squared) {
            squared = d;
            nearest = id;
        }
    }

    void intersection(const Segment &query, const Primitive &primitive)
    {
        try_triangle(query, primitive.corners(), primitive.id());
    }

    bool go_further() const
    {
        return squared > 0;
    }

    bool do_intersect(const Segment &query, const Node &node)
    {
        return bound(query, node) < squared;
    }

  private:
    /*
     * A lower bound of the squared distance, from the plane across the line from the box's centre
     * to its nearest point p of the segment: the whole segment is on p's side of it.
     */
    double bound(const Segment &query, const Node &node)
    {
        const auto &box = node.bbox();
        Vec low{ box.xmin(), box.ymin(), box.zmin() }, high{ box.xmax(), box.ymax(), box.zmax() };
        Vec centre = 0.5 * (low + high), half = 0.5 * (high - low);
        Vec to = centre - query.a;
        Vec v = to - clamp01(dot(to, query.u) * query.inverse) * query.u;
        double vv = dot(v, v);
        double gap =
            vv - half.x * std::fabs(v.x) - half.y * std::fabs(v.y) - half.z * std::fabs(v.z);

        boxes++;
        return gap > 0 ? gap * gap / vv * (1 - 1e-12) : 0;
    }
};

class Peer
{
  public:
    Peer(const Mesh &mesh) : corners_(corners_of(mesh))
    {
        std::vector<Primitive> primitives;

        for (size_t t = 0; t < corners_.size(); t++)
            primitives.push_back(Primitive(corners_[t], (uint32_t)t));
        tree_.insert(primitives.cbegin(), primitives.cend());
        tree_.build();
    }

    void reset()
    {
        start_ = 0;
    }

    void count(bool)
    {
    }

    Answer ask(const Tick &tick, bool cold)
    {
        Segment query;
        Walk walk;

        query.a = vec(tick.a);
        query.b = vec(tick.b);
        query.u = query.b - query.a;
        double uu = dot(query.u, query.u);
        query.inverse = uu > 0 ? 1 / uu : 0;
        if (cold)
            start_ = 0;
        walk.try_triangle(query, corners_[(size_t)start_], start_);
        if (walk.go_further())
            tree_.traversal(query, walk);
        start_ = walk.nearest;
        boxes_ = (double)walk.boxes;
        leaves_ = (double)walk.leaves;
        return Answer{ std::sqrt(walk.squared), start_ };
    }

    double bv_tests() const
    {
        return boxes_;
    }

    double leaf_tests() const
    {
        return leaves_;
    }

  private:
    std::vector<Corners> corners_;
    Tree tree_;
    long start_ = 0;
    double boxes_ = 0, leaves_ = 0;
};

Measured ask_cgal(const Mesh &mesh, const std::vector<Tick> &trace, const Options &options,
                  std::string &name)
{
    name = "cgal AABB_tree";
    return measure<Peer>(mesh, trace, options);
}

} // namespace

int main(int argc, char **argv)
{
    About about = { "peer_cgal",
                    "CGAL",
                    CGAL_VERSION_STR,
                    "Distance from the segment of each tick to the mesh",
                    "",
                    "",
                    "" };

    return peer_main(argc, argv, about, ask_cgal);
}
