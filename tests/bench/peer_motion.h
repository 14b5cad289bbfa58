/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Peers whose mesh moves: in each tick they take new positions for all vertices, `move`, and then answer, `ask`. Both are
 * timed, apart from each other; the least of the passes counts, as with meshes that do not move.
 */
#ifndef PEER_MOTION_H
#define PEER_MOTION_H

#include "peer.h"
#include "vertex_motion.h"

namespace peer
{

/* The vertices and the trace as plain arrays, and the motion that Options::motion names: NAME:STEP or recorded:FILE. */
class Motion
{
  public:
    Motion(const Mesh &mesh, const std::vector<Tick> &trace, const Options &options)
    {
        size_t colon = options.motion.find(':');
        if (colon == std::string::npos)
            fail("--motion takes NAME:STEP or recorded:FILE");
        for (const Point &p : mesh.vertices)
            for (double x : p)
                rest_.push_back((float)x);
        for (const Tick &tick : trace) {
            ends_.insert(ends_.end(), tick.a, tick.a + 3);
            ends_.insert(ends_.end(), tick.b, tick.b + 3);
        }
        std::string name = options.motion.substr(0, colon), value = options.motion.substr(colon + 1);
        uint32_t vertices = (uint32_t)mesh.vertices.size();
        if (!(name == "recorded" ? vertex_motion_open_recorded(&now, value.c_str(), rest_.data(), vertices)
                                 : vertex_motion_open(&now, name.c_str(), std::atof(value.c_str()), rest_.data(),
                                                      vertices, ends_.data())))
            fail("no such motion: " + options.motion);
    }

    ~Motion()
    {
        vertex_motion_close(&now);
    }

    struct vertex_motion now;

  private:
    Motion(const Motion &) = delete;

    std::vector<float> rest_;
    std::vector<double> ends_;
};

template <typename Peer>
Measured measure_moving(Peer &peer, const Mesh &mesh, const std::vector<Tick> &trace, const Options &options)
{
    Measured measured;
    Motion motion(mesh, trace, options);

    measured.bv_tests = measured.leaf_tests = std::numeric_limits<double>::quiet_NaN();
    measured.answers.resize(trace.size());
    measured.ns.assign(trace.size(), std::numeric_limits<double>::infinity());
    measured.move_ns = measured.ns;
    for (int pass = 0; pass < options.repeat; pass++) {
        peer.reset();
        for (size_t i = 0; i < trace.size(); i++) {
            vertex_motion_at(&motion.now, i);
            double start = now_ns();
            peer.move(motion.now);
            double moved = now_ns();
            measured.answers[i] = peer.ask(trace[i], options.cold);
            double end = now_ns();
            measured.move_ns[i] = std::min(measured.move_ns[i], moved - start);
            measured.ns[i] = std::min(measured.ns[i], end - moved);
        }
    }
    return measured;
}

template <typename Peer>
Measured measure_any(Peer &peer, const Mesh &mesh, const std::vector<Tick> &trace, const Options &options)
{
    return options.motion.empty() ? measure_peer(peer, trace, options) : measure_moving(peer, mesh, trace, options);
}

} // namespace peer

#endif
