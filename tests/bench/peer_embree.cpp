/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The peer Embree: distance from a moving segment to a triangle mesh by point queries. A program
 * of its own, never installed; it needs neither our headers nor our library.
 *
 *     peer_embree MESH.tri TRACE.csv -o OUT.csv [--repeat N] [--parts N|ray] [--cold] [--json]
 *
 * The files' formats are in peer.h. Embree asks for what lies within a radius of a point, so the
 * segment is cut into 64 parts, and each asks about its middle with half its length and the best
 * distance so far as the radius, which the callback shrinks. The callback has the exact distance
 * of the whole segment and a triangle, in double, and does not take a triangle twice in a tick.
 * Each tick starts from the distance to the last tick's nearest triangle. Embree walks in float;
 * the radius is widened by more than its rounding, so that no triangle is missed.
 *
 * With --parts ray it is asked for one ray along the segment instead, as one would who wants crossings alone: the first
 * triangle from end a on, with distance 0, or none, with no distance.
 *
 * With --motion, vertices move and Embree refits: a scene of low quality, which keeps a tree for each geometry, and a
 * geometry of quality REFIT.
 */
#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include "peer_motion.h"

namespace
{

using namespace peer;

#define TEXT_OF(x) #x
#define TEXT(x)    TEXT_OF(x)

class Peer
{
  public:
    Peer(const Mesh &mesh, bool moves)
        : moves_(moves), corners_(corners_of(mesh)), triangles_(mesh.triangles),
          seen_(corners_.size(), 0)
    {
        device_ = rtcNewDevice("threads=1");
        if (!device_)
            fail("Embree has no device");
        scene_ = rtcNewScene(device_);
        rtcSetSceneBuildQuality(scene_, moves ? RTC_BUILD_QUALITY_LOW : RTC_BUILD_QUALITY_HIGH);
        rtcSetSceneFlags(scene_,
                         moves ? (RTCSceneFlags)(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC)
                               : RTC_SCENE_FLAG_ROBUST);

        geometry_ = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        if (moves)
            rtcSetGeometryBuildQuality(geometry_, RTC_BUILD_QUALITY_REFIT);
        float *vertex = vertices_ = (float *)rtcSetNewGeometryBuffer(
            geometry_, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float),
            mesh.vertices.size());
        uint32_t *corner = (uint32_t *)rtcSetNewGeometryBuffer(
            geometry_, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(uint32_t),
            mesh.triangles.size());
        if (!vertex || !corner)
            fail("Embree cannot hold the mesh");
        for (const Point &p : mesh.vertices)
            for (double x : p) {
                *vertex++ = (float)x;
                extent_ = std::max(extent_, std::fabs(x));
            }
        for (const auto &t : mesh.triangles)
            corner = std::copy(t.begin(), t.end(), corner);
        rtcCommitGeometry(geometry_);
        rtcAttachGeometry(scene_, geometry_);
        rtcCommitScene(scene_);
        if (rtcGetDeviceError(device_) != RTC_ERROR_NONE)
            fail("Embree cannot build its scene");
    }

    ~Peer()
    {
        rtcReleaseGeometry(geometry_);
        rtcReleaseScene(scene_);
        rtcReleaseDevice(device_);
    }

    /* 0: one ray. */
    void set_parts(int parts)
    {
        parts_ = parts;
    }

    void move(const struct vertex_motion &motion)
    {
        std::memcpy(vertices_, motion.positions, 3 * sizeof(float) * motion.vertices);
        rtcUpdateGeometryBuffer(geometry_, RTC_BUFFER_TYPE_VERTEX, 0);
        rtcCommitGeometry(geometry_);
        rtcCommitScene(scene_);
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
        RTCPointQueryContext context;

        if (!parts_)
            return ask_ray(tick);
        a_ = vec(tick.a);
        b_ = vec(tick.b);
        Vec u = b_ - a_;
        half_ = 0.5 * std::sqrt(dot(u, u)) / parts_;
        if (cold)
            nearest_ = 0;
        if (++now_ == 0) {
            std::fill(seen_.begin(), seen_.end(), 0u);
            now_ = 1;
        }
        leaves_ = 0;
        squared_ = std::numeric_limits<double>::infinity();
        try_triangle((uint32_t)nearest_);
        /* Rounding of the middle and of Embree's boxes and distances, with much to spare. */
        margin_ = 1e-6 * (extent_ + std::fabs(a_.x) + std::fabs(a_.y) + std::fabs(a_.z) + half_);

        rtcInitPointQueryContext(&context);
        for (int i = 0; i < parts_ && squared_ > 0; i++) {
            Vec middle = a_ + ((i + 0.5) / parts_) * u;
            RTCPointQuery query;
            query.x = (float)middle.x;
            query.y = (float)middle.y;
            query.z = (float)middle.z;
            query.time = 0;
            query.radius = radius();
            rtcPointQuery(scene_, &query, &context, visit, this);
        }
        return Answer{ std::sqrt(squared_), nearest_ };
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

    Answer ask_ray(const Tick &tick)
    {
        RTCRayHit ray;
        Vec u = vec(tick.b) - vec(tick.a);

        leaves_ = 0;
        ray.ray.org_x = (float)tick.a[0];
        ray.ray.org_y = (float)tick.a[1];
        ray.ray.org_z = (float)tick.a[2];
        ray.ray.dir_x = (float)u.x;
        ray.ray.dir_y = (float)u.y;
        ray.ray.dir_z = (float)u.z;
        ray.ray.tnear = 0;
        ray.ray.tfar = 1;
        ray.ray.time = 0;
        ray.ray.mask = ~0u;
        ray.ray.flags = 0;
        ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
#if RTC_VERSION_MAJOR >= 4
        rtcIntersect1(scene_, &ray);
#else
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        rtcIntersect1(scene_, &context, &ray);
#endif
        if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID)
            return Answer{ std::numeric_limits<double>::quiet_NaN(), -1 };
        return Answer{ 0, (long)ray.hit.primID };
    }

    static bool visit(RTCPointQueryFunctionArguments *found)
    {
        Peer *peer = (Peer *)found->userPtr;

        if (!peer->try_triangle(found->primID))
            return false;
        found->query->radius = peer->radius();
        return true;
    }

    Vec vertex(uint32_t number) const
    {
        const float *p = vertices_ + 3 * (size_t)number;
        return Vec{ p[0], p[1], p[2] };
    }

    Corners corners(uint32_t id) const
    {
        const std::array<uint32_t, 3> &t = triangles_[id];
        return moves_ ? Corners{ vertex(t[0]), vertex(t[1]), vertex(t[2]) } : corners_[id];
    }

    bool try_triangle(uint32_t id)
    {
        if (seen_[id] == now_)
            return false;
        seen_[id] = now_;
        leaves_++;
        double d = segment_triangle(a_, b_, corners(id));
        if (d >= squared_)
            return false;
        squared_ = d;
        nearest_ = (long)id;
        return true;
    }

    /* Around the middle of a part lies all that is nearer to the part than the best so far. */
    float radius() const
    {
        return (float)(half_ + std::sqrt(squared_) + margin_);
    }

    bool moves_;
    std::vector<Corners> corners_;
    std::vector<std::array<uint32_t, 3>> triangles_;
    std::vector<uint32_t> seen_;
    float *vertices_;
    RTCGeometry geometry_;
    uint32_t now_ = 0;
    RTCDevice device_;
    RTCScene scene_;
    Vec a_, b_;
    double extent_ = 0, half_ = 0, margin_ = 0, squared_ = 0;
    int parts_ = 64;
    long nearest_ = 0, leaves_ = 0;
};

Measured ask_embree(const Mesh &mesh, const std::vector<Tick> &trace, const Options &options,
                    std::string &name)
{
    bool is_ray = options.choice == "ray";
    int parts = is_ray ? 0 : options.choice.empty() ? 64 : std::atoi(options.choice.c_str());

    if (!is_ray && (parts < 1 || parts > 1000))
        fail("--parts takes a number from 1 to 1000, or ray");
    name = is_ray ? "embree ray" : "embree point queries, " + std::to_string(parts) + " parts";
    double begin = now_ns();
    Peer peer(mesh, !options.motion.empty());
    double build_ns = now_ns() - begin;
    peer.set_parts(parts);
    Measured measured = measure_any(peer, mesh, trace, options);
    measured.build_ns = build_ns;
    return measured;
}

} // namespace

int main(int argc, char **argv)
{
    About about = { "peer_embree",
                    "Embree",
                    TEXT(RTC_VERSION_MAJOR) "." TEXT(RTC_VERSION_MINOR) "." TEXT(RTC_VERSION_PATCH),
                    "Distance from the segment of each tick to the mesh",
                    "--parts",
                    "N",
                    "that the segment is cut into (64); ray: one ray, for crossings alone",
                    true };

    return peer_main(argc, argv, about, ask_embree);
}
