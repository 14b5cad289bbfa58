/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The judge of crossings: which ticks of a trace cross the mesh is told by looking at every triangle, in double
 * (tests/oracle/brute.h), and the answers of any number of methods are held against it.
 *
 *     crossings MESH.tri TRACE.csv [--motion NAME:STEP|recorded:FILE] OUT.csv...
 *
 * The files' formats are in peer.h. An answer says that its tick crosses if its distance is 0; an empty distance, or
 * any other, says that it does not. Prints CSV, a row a file; a file may have a part of the trace's ticks:
 *
 *     ticks      that the file has
 *     crossing   of them: the axis meets a triangle, within NEAR of the largest coordinate
 *     missed     crossing, but the answer says that it is not
 *     invented   not crossing, but the answer says that it is
 *     misnamed   both say that it is crossing, but the axis does not meet the triangle that the answer names
 *     later      it does, but from end a on it meets another one before: no error of a method that does not ask for the
 *                first one
 *     off        the distance is off by more than OFF of the largest coordinate; empty where no answer of the file has
 *                a distance above 0
 *     error      the largest error of a distance, m; empty likewise
 */
#include <map>
#include <memory>

#include "peer_motion.h"
extern "C" {
#include "../oracle/brute.h"
}

namespace
{

using namespace peer;

const double NEAR = 1e-12, OFF = 1e-9;

/* A distance of NaN is one that was not told. */
struct Named {
    long long tick;
    double distance;
    uint32_t triangle;
};

struct Counts {
    long ticks = 0, crossing = 0, missed = 0, invented = 0, misnamed = 0, later = 0, off = 0;
    double error = 0;
    bool tells_distances = false;
};

/* The file's rows: tick, distance, triangle. */
std::vector<Named> read_answers(const std::string &path)
{
    std::vector<Named> answers;
    std::string text = read_file(path);
    size_t line = 0;

    for (size_t at = 0; at < text.size(); line++) {
        size_t end = std::min(text.find('\n', at), text.size());
        std::string row = text.substr(at, end - at);
        size_t comma = row.find(','), second = row.find(',', comma + 1);
        at = end + 1;
        if (!line && row != "tick,distance,triangle")
            fail(path + ": line 1: the header tick,distance,triangle expected");
        if (!line)
            continue;
        if (second == std::string::npos)
            fail(path + ": line " + std::to_string(line + 1) + ": three columns expected");
        double distance = second > comma + 1 ? std::atof(row.c_str() + comma + 1)
                                             : std::numeric_limits<double>::quiet_NaN();
        answers.push_back(Named{ std::atoll(row.c_str()), distance,
                                 (uint32_t)std::atol(row.c_str() + second + 1) });
    }
    return answers;
}

class Judge
{
  public:
    Judge(const Mesh &mesh) : mesh_(mesh)
    {
        for (const Point &p : mesh.vertices)
            for (double x : p)
                positions_.push_back((float)x);
    }

    ~Judge()
    {
        oracle_brute_close(brute_);
    }

    /* A tick's tool, and the mesh's positions where they are new. */
    void set(const float *positions, const Tick &tick)
    {
        if (positions)
            positions_.assign(positions, positions + positions_.size());
        if (positions || !brute_) {
            oracle_brute_close(brute_);
            brute_ = oracle_brute_open(positions_.data(), (uint32_t)mesh_.vertices.size(),
                                       mesh_.triangles[0].data(), (uint32_t)mesh_.triangles.size());
            if (!brute_)
                fail("no memory");
            largest_ = 0;
            for (float x : positions_)
                largest_ = std::max(largest_, (double)std::fabs(x));
        }
        near_ = largest_;
        for (int k = 0; k < 3; k++) {
            segment_[k] = tick.a[k];
            segment_[3 + k] = tick.b[k];
            near_ = std::max(near_, std::max(std::fabs(tick.a[k]), std::fabs(tick.b[k])));
        }
        near_ *= NEAR;
        distance_ = oracle_brute(brute_, segment_, nullptr);
        crosses_ = distance_ <= near_;
    }

    void count(const Named &answer, Counts &counts) const
    {
        bool says_so = answer.distance == 0;
        double error = std::fabs(answer.distance - distance_); /* NaN is never off */

        counts.ticks++;
        counts.crossing += crosses_;
        counts.missed += crosses_ && !says_so;
        counts.invented += !crosses_ && says_so;
        counts.tells_distances |= answer.distance > 0;
        counts.off += error * NEAR > near_ * OFF;
        counts.error = error > counts.error ? error : counts.error;
        if (!crosses_ || !says_so)
            return;
        if (!(oracle_brute_triangle(brute_, answer.triangle, segment_) <= near_))
            counts.misnamed++;
        else
            counts.later += meets_before(answer.triangle);
    }

  private:
    Judge(const Judge &) = delete;

    Vec vertex(uint32_t triangle, size_t k) const
    {
        const float *p = &positions_[3 * (size_t)mesh_.triangles[triangle][k]];
        return Vec{ p[0], p[1], p[2] };
    }

    /* The tool up to a millionth of its length before the triangle's plane: does it meet another one? */
    bool meets_before(uint32_t triangle) const
    {
        Vec a = vec(segment_), u = vec(segment_ + 3) - a, p = vertex(triangle, 0);
        Vec n = cross(vertex(triangle, 1) - p, vertex(triangle, 2) - p);
        double along = dot(n, u), s = along != 0 ? dot(n, p - a) / along - 1e-6 : 0;

        if (!(s > 0))
            return false;
        Vec b = a + s * u;
        const double part[6] = { a.x, a.y, a.z, b.x, b.y, b.z };
        return oracle_brute(brute_, part, nullptr) <= near_;
    }

    const Mesh &mesh_;
    std::vector<float> positions_;
    oracle_mesh *brute_ = nullptr;
    double segment_[6], near_ = 0, largest_ = 0, distance_ = 0;
    bool crosses_ = false;
};

void judge(const Options &options, const std::vector<std::string> &files)
{
    Mesh mesh = read_mesh(options.mesh, "the judge");
    std::vector<Tick> trace = read_trace(options.trace);
    std::vector<std::map<long long, Named>> answers;
    std::vector<Counts> counts(files.size());
    std::unique_ptr<Motion> motion;
    Judge judge(mesh);

    for (const std::string &file : files) {
        answers.emplace_back();
        for (const Named &answer : read_answers(file))
            answers.back()[answer.tick] = answer;
    }
    if (!options.motion.empty())
        motion.reset(new Motion(mesh, trace, options));
    for (size_t i = 0; i < trace.size(); i++) {
        if (motion)
            vertex_motion_at(&motion->now, i);
        bool asked = false;
        for (size_t f = 0; f < files.size(); f++) {
            auto found = answers[f].find(trace[i].number);
            if (found == answers[f].end())
                continue;
            if (!asked)
                judge.set(motion ? motion->now.positions : nullptr, trace[i]);
            asked = true;
            judge.count(found->second, counts[f]);
        }
    }
    std::printf("file,ticks,crossing,missed,invented,misnamed,later,off,error\n");
    for (size_t f = 0; f < files.size(); f++) {
        const Counts &c = counts[f];
        std::printf("%s,%ld,%ld,%ld,%ld,%ld,%ld,", files[f].c_str(), c.ticks, c.crossing, c.missed,
                    c.invented, c.misnamed, c.later);
        if (c.tells_distances)
            std::printf("%ld,%.2g\n", c.off, c.error);
        else
            std::printf(",\n");
    }
}

} // namespace

int main(int argc, char **argv)
{
    std::vector<std::string> files;
    Options options;

    try {
        for (int i = 1; i < argc; i++) {
            if (std::string(argv[i]) == "--motion" && i + 1 < argc)
                options.motion = argv[++i];
            else
                files.push_back(argv[i]);
        }
        if (files.size() < 3)
            fail("MESH.tri, TRACE.csv and OUT.csv are needed");
        options.mesh = files[0];
        options.trace = files[1];
        files.erase(files.begin(), files.begin() + 2);
        judge(options, files);
    } catch (const std::exception &error) {
        std::fprintf(stderr, "crossings: %s\n", error.what());
        return 2;
    }
    return 0;
}
