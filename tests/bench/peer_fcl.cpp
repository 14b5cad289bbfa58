/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The peer FCL: distance from a moving segment to a triangle mesh, asked of the Flexible Collision
 * Library in the fastest way found that gives its exact answer, so that the comparison is fair.
 * A program of its own, never installed; it needs neither our headers nor our library.
 *
 *     peer_fcl MESH.tri TRACE.csv -o OUT.csv [--repeat N] [--bv obbrss|rss|kios] [--cold] [--json]
 *
 * The files' formats are in peer.h.
 *
 * How FCL is asked:
 * - The mesh is one BVHModel, built once. The segment is a BVHModel of one triangle (A, B, B).
 * - Each tick starts from the distance to the triangle nearest at the last tick. It is put into
 *   DistanceResult::min_distance, which FCL's traversal prunes with. If it is 0, it is the answer.
 * - Both models are kept in world coordinates: the tick's ends and bounding volume are written
 *   into the segment's model, and MeshDistanceTraversalNode, which knows no transform, walks the
 *   trees. That is a fifth faster than FCL's nodes with a transform, which multiply it into every
 *   box test, and it does not need a segment of constant length.
 * - Not faster, so not here: its queue traversal, the median and box-centre splits, the segment as
 *   the first model, axis-aligned boxes with the segment in pieces, and FCL's templates compiled
 *   for the machine at hand (for which EIGEN_MAX_ALIGN_BYTES must be 16, as it was in libfcl).
 *
 * With --motion, vertices move and FCL refits its tree from the root down. From the leaves up takes a fifth less, but
 * then the distances are off by millimetres. The vertices replace the old ones: as an update, FCL's boxes would hold
 * both. Rectangles (--bv rss) are a fifth faster than the default, both to refit and to ask.
 *
 * The compiler flags from fcl.pc end in -std=c++11, so nothing here needs more than that.
 */
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/math/bv/RSS.h>
#include <fcl/math/bv/kIOS.h>
#include <fcl/math/bv/utility.h>
#include <fcl/narrowphase/detail/traversal/distance/mesh_distance_traversal_node.h>
#include <fcl/narrowphase/detail/traversal/traversal_recurse.h>

#include "peer_motion.h"

namespace
{

using namespace peer;

typedef fcl::Vector3<double> Vector;
typedef fcl::Matrix3<double> Matrix;

/*
 * Writes the bounding volume of segment ab into `bv`. For rectangles it is the segment itself, with
 * no margin. `unit` is the volume that FCL fitted to the segment from (0, 0, 0) to (1, 0, 0).
 */
void place(fcl::RSS<double> &bv, const fcl::RSS<double> &, const Vector &a, const Vector &b)
{
    bv.axis = frame_of<Matrix>(a, b, bv.l[0]);
    bv.To = a;
    bv.l[1] = 0;
    bv.r = 0;
}

/* The distance reads the rss alone; the obb is kept true all the same, since it is part of it. */
void place(fcl::OBBRSS<double> &bv, const fcl::OBBRSS<double> &unit, const Vector &a,
           const Vector &b)
{
    place(bv.rss, unit.rss, a, b);
    bv.obb.axis = bv.rss.axis;
    bv.obb.To = (a + b) * 0.5;
    bv.obb.extent = Vector(0.5 * bv.rss.l[0], 0, 0);
}

void place(fcl::kIOS<double> &bv, const fcl::kIOS<double> &unit, const Vector &a, const Vector &b)
{
    double length;
    Matrix frame = frame_of<Matrix>(a, b, length);

    for (unsigned i = 0; i < unit.num_spheres; i++) {
        bv.spheres[i].o = a + length * (frame * unit.spheres[i].o);
        bv.spheres[i].r = length * unit.spheres[i].r;
    }
    bv.obb.axis = frame;
    bv.obb.To = (a + b) * 0.5;
    bv.obb.extent = Vector(0.5 * length, 0, 0);
}

/*
 * FCL's node for two meshes in one frame, with two of its hooks used: the start from a given
 * triangle (FCL's oriented nodes start from triangle 0), and no second test of that triangle.
 */
template <typename BV> class WarmNode : public fcl::detail::MeshDistanceTraversalNode<BV>
{
  public:
    long start = 0;

    void preprocess() override
    {
        const fcl::Triangle &t = this->tri_indices1[start];
        const Vector *p = this->vertices1, *q = this->vertices2;
        Vector on_mesh, on_segment;

        double d = fcl::detail::TriangleDistance<double>::triDistance(
            p[t[0]], p[t[1]], p[t[2]], q[0], q[1], q[2], on_mesh, on_segment);
        this->result->update(d, this->model1, this->model2, (int)start, 0);
    }

    void leafTesting(int mesh_node, int segment_node) const override
    {
        if (this->model1->getBV(mesh_node).primitiveId() != start)
            fcl::detail::MeshDistanceTraversalNode<BV>::leafTesting(mesh_node, segment_node);
    }
};

template <typename BV> class Peer
{
  public:
    Peer(const Mesh &mesh)
    {
        std::vector<Vector> vertices;
        std::vector<fcl::Triangle> triangles;

        for (const Point &p : mesh.vertices)
            vertices.push_back(Vector(p[0], p[1], p[2]));
        for (const auto &t : mesh.triangles)
            triangles.push_back(fcl::Triangle(t[0], t[1], t[2]));
        mesh_.beginModel((int)triangles.size(), (int)vertices.size());
        mesh_.addSubModel(vertices, triangles);
        segment_.beginModel(1, 3);
        segment_.addTriangle(Vector(0, 0, 0), Vector(1, 0, 0), Vector(1, 0, 0));
        if (mesh_.endModel() != fcl::BVH_OK || segment_.endModel() != fcl::BVH_OK)
            fail("FCL cannot build its model");
        unit_ = segment_.getBV(0).bv;

        node_.model1 = &mesh_;
        node_.model2 = &segment_;
        node_.vertices1 = mesh_.vertices;
        node_.vertices2 = segment_.vertices;
        node_.tri_indices1 = mesh_.tri_indices;
        node_.tri_indices2 = segment_.tri_indices;
        node_.result = &result_;
    }

    void move(const struct vertex_motion &motion)
    {
        const float *p = motion.positions;
        moved_.resize(motion.vertices);
        for (Vector &at : moved_) {
            at = Vector(p[0], p[1], p[2]);
            p += 3;
        }
        mesh_.beginReplaceModel();
        mesh_.replaceSubModel(moved_);
        if (mesh_.endReplaceModel(true, false) != fcl::BVH_OK)
            fail("FCL cannot refit its model");
        node_.vertices1 = mesh_.vertices;
    }

    /* As after construction: no tick to start from. */
    void reset()
    {
        node_.start = 0;
    }

    /* FCL counts a tick's tests while `on`; that costs time, so not in the timed passes. */
    void count(bool on)
    {
        node_.enableStatistics(on);
    }

    Answer ask(const Tick &tick, bool cold)
    {
        Vector a(tick.a[0], tick.a[1], tick.a[2]), b(tick.b[0], tick.b[1], tick.b[2]);

        segment_.vertices[0] = a;
        segment_.vertices[1] = b;
        segment_.vertices[2] = b;
        place(segment_.getBV(0).bv, unit_, a, b);
        if (cold)
            node_.start = 0;
        result_.clear();
        node_.num_bv_tests = node_.num_leaf_tests = 0;
        node_.preprocess();
        if (result_.min_distance > 0)
            fcl::detail::distanceRecurse<double>(&node_, 0, 0, nullptr);
        if (result_.b1 < 0) /* every distance was NaN: FCL's error, shown as it is */
            return Answer{ result_.min_distance, -1 };
        node_.start = (long)result_.b1;
        return Answer{ result_.min_distance, node_.start };
    }

    double bv_tests() const
    {
        return node_.num_bv_tests;
    }

    double leaf_tests() const
    {
        return node_.num_leaf_tests;
    }

  private:
    Peer(const Peer &) = delete;

    fcl::BVHModel<BV> mesh_, segment_;
    BV unit_;
    std::vector<Vector> moved_;
    fcl::DistanceResult<double> result_;
    WarmNode<BV> node_;
};

template <typename BV>
Measured measure_fcl(const Mesh &mesh, const std::vector<Tick> &trace, const Options &options)
{
    if (options.motion.empty())
        return measure<Peer<BV>>(mesh, trace, options);
    double begin = now_ns();
    Peer<BV> peer(mesh);
    double build_ns = now_ns() - begin;
    Measured measured = measure_moving(peer, mesh, trace, options);
    measured.build_ns = build_ns;
    return measured;
}

Measured ask_fcl(const Mesh &mesh, const std::vector<Tick> &trace, const Options &options,
                 std::string &name)
{
    if (options.choice.empty() || options.choice == "obbrss") {
        name = "fcl OBBRSS";
        return measure_fcl<fcl::OBBRSS<double>>(mesh, trace, options);
    }
    if (options.choice == "rss") {
        name = "fcl RSS";
        return measure_fcl<fcl::RSS<double>>(mesh, trace, options);
    }
    if (options.choice != "kios")
        fail("--bv takes obbrss, rss or kios");
    name = "fcl kIOS";
    return measure_fcl<fcl::kIOS<double>>(mesh, trace, options);
}

} // namespace

int main(int argc, char **argv)
{
    About about = { "peer_fcl",
                    "FCL",
                    FCL_VERSION,
                    "Distance from the segment of each tick to the mesh",
                    "--bv",
                    "BV",
                    "bounding volume: obbrss (default), rss or kios",
                    true };

    return peer_main(argc, argv, about, ask_fcl);
}
