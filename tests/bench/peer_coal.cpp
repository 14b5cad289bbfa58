/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The peer Coal, which was hpp-fcl: distance from a moving segment to a triangle mesh. A program of
 * its own, never installed; it needs neither our headers nor our library. Its packages come from
 * PyPI: the wheel brings headers and libraries.
 *
 *     peer_coal MESH.tri TRACE.csv -o OUT.csv [--repeat N] [--bv obbrss|rss] [--cold] [--json]
 *
 * The files' formats are in peer.h. Coal is asked as FCL is in peer_fcl.cpp, which it descends
 * from: both models in world coordinates, the segment as one triangle (A, B, B) whose vertices and
 * volume are written in place, started from the triangle that was nearest at the last tick. Its
 * request allows no error (rel_err and abs_err are 0), so that its answer is exact.
 */
#include <coal/BV/OBBRSS.h>
#include <coal/BV/RSS.h>
#include <coal/BVH/BVH_model.h>
#include <coal/config.hh>
#include <coal/internal/intersect.h>
#include <coal/internal/traversal_node_bvhs.h>
#include <coal/internal/traversal_recurse.h>

#include "peer.h"

namespace
{

using namespace peer;

typedef coal::Vec3s Vector;
typedef coal::Matrix3s Matrix;

/* A rectangle of width 0 and no margin: the segment itself. */
void place(coal::RSS &bv, const Vector &a, const Vector &b)
{
    bv.axes = frame_of<Matrix>(a, b, bv.length[0]);
    bv.Tr = a;
    bv.length[1] = 0;
    bv.radius = 0;
}

/* The distance reads the rss alone; the obb is kept true all the same, since it is part of it. */
void place(coal::OBBRSS &bv, const Vector &a, const Vector &b)
{
    place(bv.rss, a, b);
    bv.obb.axes = bv.rss.axes;
    bv.obb.To = (a + b) * 0.5;
    bv.obb.extent = Vector(0.5 * bv.rss.length[0], 0, 0);
}

/* Coal's node for two meshes in one frame, started from a triangle that it does not test again. */
template <typename BV> class WarmNode : public coal::MeshDistanceTraversalNode<BV>
{
  public:
    long start = 0;

    void begin()
    {
        const coal::Triangle &t = this->tri_indices1[start];
        const Vector *p = this->vertices1, *q = this->vertices2;
        Vector on_mesh, on_segment;

        double d = std::sqrt(coal::TriangleDistance::sqrTriDistance(
            p[t[0]], p[t[1]], p[t[2]], q[0], q[1], q[2], on_mesh, on_segment));
        this->result->update(d, this->model1, this->model2, (int)start, 0);
    }

    void leafComputeDistance(unsigned mesh_node, unsigned segment_node) const
    {
        if (this->model1->getBV(mesh_node).primitiveId() != start)
            coal::MeshDistanceTraversalNode<BV>::leafComputeDistance(mesh_node, segment_node);
    }
};

template <typename BV> class Peer
{
  public:
    Peer(const Mesh &mesh)
    {
        std::vector<Vector> vertices;
        std::vector<coal::Triangle> triangles;

        for (const Point &p : mesh.vertices)
            vertices.push_back(Vector(p[0], p[1], p[2]));
        for (const auto &t : mesh.triangles)
            triangles.push_back(coal::Triangle(t[0], t[1], t[2]));
        mesh_.beginModel((unsigned)triangles.size(), (unsigned)vertices.size());
        mesh_.addSubModel(vertices, triangles);
        segment_.beginModel(1, 3);
        segment_.addTriangle(Vector(0, 0, 0), Vector(1, 0, 0), Vector(1, 0, 0));
        if (mesh_.endModel() != coal::BVH_OK || segment_.endModel() != coal::BVH_OK)
            fail("Coal cannot build its model");

        node_.model1 = &mesh_;
        node_.model2 = &segment_;
        node_.vertices1 = mesh_.vertices->data();
        node_.vertices2 = segment_.vertices->data();
        node_.tri_indices1 = mesh_.tri_indices->data();
        node_.tri_indices2 = segment_.tri_indices->data();
        node_.rel_err = node_.abs_err = 0;
        node_.result = &result_;
    }

    void reset()
    {
        node_.start = 0;
    }

    void count(bool on)
    {
        node_.enableStatistics(on);
    }

    Answer ask(const Tick &tick, bool cold)
    {
        Vector a(tick.a[0], tick.a[1], tick.a[2]), b(tick.b[0], tick.b[1], tick.b[2]);

        node_.vertices2[0] = a;
        node_.vertices2[1] = b;
        node_.vertices2[2] = b;
        place(segment_.getBV(0).bv, a, b);
        if (cold)
            node_.start = 0;
        result_.clear();
        node_.num_bv_tests = node_.num_leaf_tests = 0;
        node_.begin();
        if (result_.min_distance > 0)
            coal::distanceRecurse(&node_, 0, 0, nullptr);
        if (result_.b1 < 0) /* every distance was NaN: Coal's error, shown as it is */
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

    coal::BVHModel<BV> mesh_, segment_;
    coal::DistanceResult result_;
    WarmNode<BV> node_;
};

Measured ask_coal(const Mesh &mesh, const std::vector<Tick> &trace, const Options &options,
                  std::string &name)
{
    if (options.choice.empty() || options.choice == "obbrss") {
        name = "coal OBBRSS";
        return measure<Peer<coal::OBBRSS>>(mesh, trace, options);
    }
    if (options.choice != "rss")
        fail("--bv takes obbrss or rss");
    name = "coal RSS";
    return measure<Peer<coal::RSS>>(mesh, trace, options);
}

} // namespace

int main(int argc, char **argv)
{
    About about = { "peer_coal",
                    "Coal",
                    COAL_VERSION,
                    "Distance from the segment of each tick to the mesh",
                    "--bv",
                    "BV",
                    "bounding volume: obbrss (default) or rss" };

    return peer_main(argc, argv, about, ask_coal);
}
