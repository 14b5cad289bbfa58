/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The peer Bullet: distance from a moving segment to a btBvhTriangleMeshShape. A program of its
 * own, never installed; it needs neither our headers nor our library.
 *
 *     peer_bullet MESH.tri TRACE.csv -o OUT.csv [--repeat N] [--narrow exact|gjk] [--cold] [--json]
 *
 * The files' formats are in peer.h. Bullet has no distance to a mesh, only the triangles that meet
 * a box or a box swept along a line. So each tick takes the distance to the last tick's nearest
 * triangle, and asks for all triangles that meet the box of that half-width swept from A to B
 * (performConvexcast); that passes far fewer triangles than the box of the whole segment
 * (processAllTriangles). The box cannot shrink during the walk.
 *
 * Each triangle passed is measured by segment_triangle of peer.h, in double and exact, or with
 * --narrow gjk by Bullet's own btGjkPairDetector: the segment as a hull of two points, the triangle
 * as a btTriangleShape, margins 0, no solver for depth. That is slower and stops short: about one
 * tick in twenty is off, by some micrometres.
 */
#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btConvexHullShape.h>
#include <BulletCollision/CollisionShapes/btTriangleIndexVertexArray.h>
#include <BulletCollision/CollisionShapes/btTriangleShape.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkPairDetector.h>
#include <BulletCollision/NarrowPhaseCollision/btPointCollector.h>
#include <BulletCollision/NarrowPhaseCollision/btVoronoiSimplexSolver.h>

#include <memory>

#include "peer_motion.h"

namespace
{

using namespace peer;

btVector3 to_bullet(const Vec &p)
{
    return btVector3((btScalar)p.x, (btScalar)p.y, (btScalar)p.z);
}

template <bool GJK> class Peer : private btTriangleCallback
{
  public:
    Peer(const Mesh &mesh, bool moves) : moves_(moves), corners_(corners_of(mesh))
    {
        for (const auto &t : mesh.triangles)
            for (uint32_t corner : t)
                indices_.push_back((int)corner);
        for (const Point &p : mesh.vertices)
            vertices_.push_back(to_bullet(vec(p.data())));
        arrays_.reset(new btTriangleIndexVertexArray((int)corners_.size(), indices_.data(),
                                                     3 * sizeof(int), (int)vertices_.size(),
                                                     &vertices_[0][0], (int)sizeof(btVector3)));
        shape_.reset(new btBvhTriangleMeshShape(arrays_.get(), true));
        segment_.addPoint(btVector3(0, 0, 0));
        segment_.addPoint(btVector3(1, 0, 0));
        segment_.setMargin(0);
        triangle_.setMargin(0);
    }

    /* All of the tree: what its root holds changes too. */
    void move(const struct vertex_motion &motion)
    {
        const float *p = motion.positions;
        btVector3 low(p[0], p[1], p[2]), high = low;
        for (btVector3 &at : vertices_) {
            at = btVector3((btScalar)p[0], (btScalar)p[1], (btScalar)p[2]);
            low.setMin(at);
            high.setMax(at);
            p += 3;
        }
        shape_->refitTree(low, high);
    }

    void reset()
    {
        nearest_ = 0;
    }

    void count(bool)
    {
    }

    Answer ask(const Tick &tick, bool cold)
    {
        a_ = vec(tick.a);
        b_ = vec(tick.b);
        if (GJK) {
            segment_.getUnscaledPoints()[0] = to_bullet(a_);
            segment_.getUnscaledPoints()[1] = to_bullet(b_);
        }
        if (cold)
            nearest_ = 0;
        leaves_ = 0;
        start_ = nearest_;
        best_ = std::numeric_limits<double>::infinity();
        try_triangle(nearest_);
        if (best_ > 0) {
            btScalar reach = (btScalar)(best_ * (1 + 1e-6) + 1e-12);
            btVector3 half(reach, reach, reach);
            shape_->performConvexcast(this, to_bullet(a_), to_bullet(b_), -half, half);
        }
        return Answer{ best_, nearest_ };
    }

    double bv_tests() const
    {
        return std::numeric_limits<double>::quiet_NaN();
    }

    double leaf_tests() const
    {
        return (double)leaves_;
    }

  private:
    Peer(const Peer &) = delete;

    void processTriangle(btVector3 *, int, int triangle) override
    {
        if (best_ > 0 && triangle != start_)
            try_triangle(triangle);
    }

    void try_triangle(long id)
    {
        Corners t = moves_ ? corners(3 * (size_t)id) : corners_[(size_t)id];
        double d = GJK ? gjk(t) : std::sqrt(segment_triangle(a_, b_, t));

        leaves_++;
        if (d < best_) {
            best_ = d;
            nearest_ = id;
        }
    }

    Vec vertex(size_t index) const
    {
        const btVector3 &p = vertices_[(size_t)indices_[index]];
        return Vec{ p.x(), p.y(), p.z() };
    }

    Corners corners(size_t first) const
    {
        return Corners{ vertex(first), vertex(first + 1), vertex(first + 2) };
    }

    double gjk(const Corners &t)
    {
        btGjkPairDetector detector(&segment_, &triangle_, &simplex_, nullptr);
        btGjkPairDetector::ClosestPointInput input;
        btPointCollector found;

        triangle_.m_vertices1[0] = to_bullet(t.p);
        triangle_.m_vertices1[1] = to_bullet(t.q);
        triangle_.m_vertices1[2] = to_bullet(t.r);
        input.m_transformA.setIdentity();
        input.m_transformB.setIdentity();
        detector.getClosestPoints(input, found, nullptr);
        if (!found.m_hasResult) /* they overlap; the depth would need a solver of its own */
            return 0;
        return std::max(0.0, (double)found.m_distance);
    }

    bool moves_;
    std::vector<Corners> corners_;
    std::vector<int> indices_;
    std::vector<btVector3> vertices_;
    std::unique_ptr<btTriangleIndexVertexArray> arrays_;
    std::unique_ptr<btBvhTriangleMeshShape> shape_;
    btConvexHullShape segment_;
    btTriangleShape triangle_;
    btVoronoiSimplexSolver simplex_;
    Vec a_, b_;
    double best_ = 0;
    long nearest_ = 0, start_ = 0, leaves_ = 0;
};

template <bool GJK>
Measured measure_bullet(const Mesh &mesh, const std::vector<Tick> &trace, const Options &options)
{
    double begin = now_ns();
    Peer<GJK> peer(mesh, !options.motion.empty());
    double build_ns = now_ns() - begin;
    Measured measured = measure_any(peer, mesh, trace, options);
    measured.build_ns = build_ns;
    return measured;
}

Measured ask_bullet(const Mesh &mesh, const std::vector<Tick> &trace, const Options &options,
                    std::string &name)
{
    if (options.choice.empty() || options.choice == "exact") {
        name = "bullet swept box, exact triangles";
        return measure_bullet<false>(mesh, trace, options);
    }
    if (options.choice != "gjk")
        fail("--narrow takes exact or gjk");
    name = "bullet swept box, GJK triangles";
    return measure_bullet<true>(mesh, trace, options);
}

std::string version()
{
    return std::to_string(btGetVersion() / 100) + "." + std::to_string(btGetVersion() % 100);
}

} // namespace

int main(int argc, char **argv)
{
    std::string bullet = version();
    About about = { "peer_bullet",
                    "Bullet",
                    bullet.c_str(),
                    "Distance from the segment of each tick to the mesh",
                    "--narrow",
                    "HOW",
                    "distance to a triangle: exact (default), or gjk, which is Bullet's",
                    true };

    return peer_main(argc, argv, about, ask_bullet);
}
