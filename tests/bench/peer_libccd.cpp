/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The peer libccd: whether a moving segment meets a triangle mesh, yes or no, as libccd has no
 * distance. A program of its own, never installed; it needs neither our headers nor our library.
 *
 *     peer_libccd MESH.tri TRACE.csv -o OUT.csv [--repeat N] [--test mpr|gjk] [--cold] [--json]
 *
 * The files' formats are in peer.h. The distance in OUT.csv is 0 where libccd finds a triangle that
 * the segment meets, and empty otherwise. libccd has no tree: each triangle whose box the segment
 * passes is a pair, asked of ccdMPRIntersect or ccdGJKIntersect with the segment as a convex of two
 * points; the first that meets ends the tick, and last tick's is asked first. The boxes are tested
 * one after another by code of our own, which is most of a tick's time. So the summary also has
 * "pairs", the mean of pairs a tick, and "pair_ns", the median time of one pair alone.
 */
#include <ccd/ccd.h>

#include "peer.h"

namespace
{

using namespace peer;

/* A convex as libccd sees it: its corners, two or three. */
struct Convex {
    Vec corner[3];
    int count;
};

struct Box {
    Vec centre, half;
};

void support(const void *object, const ccd_vec3_t *direction, ccd_vec3_t *out)
{
    const Convex *convex = (const Convex *)object;
    Vec d{ direction->v[0], direction->v[1], direction->v[2] };
    const Vec *best = &convex->corner[0];
    double most = dot(*best, d);

    for (int i = 1; i < convex->count; i++) {
        double here = dot(convex->corner[i], d);
        if (here > most) {
            most = here;
            best = &convex->corner[i];
        }
    }
    ccdVec3Set(out, (ccd_real_t)best->x, (ccd_real_t)best->y, (ccd_real_t)best->z);
}

void middle(const void *object, ccd_vec3_t *out)
{
    const Convex *convex = (const Convex *)object;
    Vec sum{ 0, 0, 0 };

    for (int i = 0; i < convex->count; i++)
        sum = sum + convex->corner[i];
    sum = (1.0 / convex->count) * sum;
    ccdVec3Set(out, (ccd_real_t)sum.x, (ccd_real_t)sum.y, (ccd_real_t)sum.z);
}

class Peer
{
  public:
    typedef int (*Test)(const void *, const void *, const ccd_t *);

    Peer(const Mesh &mesh, Test test) : test_(test)
    {
        for (const Corners &t : corners_of(mesh)) {
            Vec low{ std::min(std::min(t.p.x, t.q.x), t.r.x),
                     std::min(std::min(t.p.y, t.q.y), t.r.y),
                     std::min(std::min(t.p.z, t.q.z), t.r.z) };
            Vec high{ std::max(std::max(t.p.x, t.q.x), t.r.x),
                      std::max(std::max(t.p.y, t.q.y), t.r.y),
                      std::max(std::max(t.p.z, t.q.z), t.r.z) };
            triangles_.push_back(Convex{ { t.p, t.q, t.r }, 3 });
            boxes_.push_back(Box{ 0.5 * (low + high), 0.5 * (high - low) });
        }
        CCD_INIT(&ccd_);
        ccd_.support1 = ccd_.support2 = support;
        ccd_.center1 = ccd_.center2 = middle;
        ccd_.max_iterations = 100;
    }

    void reset()
    {
        last_ = 0;
    }

    void count(bool on)
    {
        timed_ = on;
    }

    Answer ask(const Tick &tick, bool cold)
    {
        Convex segment{ { vec(tick.a), vec(tick.b), vec(tick.b) }, 2 };
        Vec centre = 0.5 * (segment.corner[0] + segment.corner[1]);
        Vec half = 0.5 * (segment.corner[1] - segment.corner[0]);
        Vec reach{ std::fabs(half.x), std::fabs(half.y), std::fabs(half.z) };

        pairs_ = 0;
        if (cold)
            last_ = 0;
        if (meets(segment, last_))
            return Answer{ 0, last_ };
        for (size_t t = 0; t < boxes_.size(); t++)
            if (passes(centre, half, reach, boxes_[t]) && meets(segment, (long)t)) {
                last_ = (long)t;
                return Answer{ 0, last_ };
            }
        return Answer{ std::numeric_limits<double>::quiet_NaN(), -1 };
    }

    double bv_tests() const
    {
        return std::numeric_limits<double>::quiet_NaN();
    }

    double leaf_tests() const
    {
        return (double)pairs_;
    }

    /* Median time of one pair, without the clock's own. */
    double pair_ns()
    {
        std::sort(pairs_ns_.begin(), pairs_ns_.end());
        return pairs_ns_.empty() ? 0 : quantile(pairs_ns_, 0.5);
    }

  private:
    /* Whether the segment passes the box, by the six axes that can part them. */
    static bool passes(const Vec &centre, const Vec &half, const Vec &reach, const Box &box)
    {
        Vec c = centre - box.centre;
        const Vec &h = box.half;

        if (std::fabs(c.x) > h.x + reach.x || std::fabs(c.y) > h.y + reach.y ||
            std::fabs(c.z) > h.z + reach.z)
            return false;
        Vec n = cross(half, c);
        double slack = 1e-12;
        return std::fabs(n.x) <= h.y * reach.z + h.z * reach.y + slack &&
               std::fabs(n.y) <= h.x * reach.z + h.z * reach.x + slack &&
               std::fabs(n.z) <= h.x * reach.y + h.y * reach.x + slack;
    }

    /* In the pass that counts, each pair is asked 16 times, so that the clock weighs little. */
    bool meets(const Convex &segment, long t)
    {
        const Convex *triangle = &triangles_[(size_t)t];

        pairs_++;
        if (timed_) {
            double begin = now_ns();
            for (int i = 0; i < 16; i++)
                test_(&segment, triangle, &ccd_);
            pairs_ns_.push_back((now_ns() - begin) / 16);
        }
        return test_(&segment, triangle, &ccd_) != 0;
    }

    Test test_;
    std::vector<Convex> triangles_;
    std::vector<Box> boxes_;
    ccd_t ccd_;
    long last_ = 0, pairs_ = 0;
    bool timed_ = false;
    std::vector<double> pairs_ns_;
};

Measured ask_libccd(const Mesh &mesh, const std::vector<Tick> &trace, const Options &options,
                    std::string &name)
{
    bool gjk = options.choice == "gjk";

    if (!gjk && !options.choice.empty() && options.choice != "mpr")
        fail("--test takes mpr or gjk");
    name = gjk ? "libccd GJK" : "libccd MPR";
    double begin = now_ns();
    Peer peer(mesh, gjk ? ccdGJKIntersect : ccdMPRIntersect);
    double build_ns = now_ns() - begin;
    Measured measured = measure_peer(peer, trace, options);
    char more[80];
    std::snprintf(more, sizeof more, ",\"pairs\":%.2f,\"pair_ns\":%.1f", measured.leaf_tests,
                  peer.pair_ns());
    measured.build_ns = build_ns;
    measured.more = more;
    return measured;
}

} // namespace

#ifndef CCD_VERSION
#define CCD_VERSION "2"
#endif

int main(int argc, char **argv)
{
    About about = { "peer_libccd",
                    "libccd",
                    CCD_VERSION,
                    "Whether the segment of each tick meets the mesh",
                    "--test",
                    "HOW",
                    "of one pair: mpr (default), or gjk, which misses some" };

    return peer_main(argc, argv, about, ask_libccd);
}
