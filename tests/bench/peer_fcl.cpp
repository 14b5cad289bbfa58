/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The peer FCL: distance from a moving segment to a triangle mesh, asked of the Flexible Collision
 * Library in the fastest way found that gives its exact answer, so that the comparison is fair.
 * A program of its own, never installed; it needs neither our headers nor our library.
 *
 *     peer_fcl MESH.tri TRACE.csv -o OUT.csv [--repeat N] [--bv obbrss|rss|kios] [--cold] [--json]
 *
 * MESH.tri, little-endian: uint32 vertex_count, uint32 triangle_count, float xyz[3 * vertex_count],
 * uint32 corners[3 * triangle_count]. TRACE.csv: tick,ax,ay,az,bx,by,bz. OUT.csv:
 * tick,distance,triangle.
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
 * The compiler flags from fcl.pc end in -std=c++11, so nothing here needs more than that.
 */
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/math/bv/RSS.h>
#include <fcl/math/bv/kIOS.h>
#include <fcl/narrowphase/detail/traversal/distance/mesh_distance_traversal_node.h>
#include <fcl/narrowphase/detail/traversal/traversal_recurse.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <time.h>

namespace {

typedef fcl::Vector3<double> Vector;
typedef fcl::Matrix3<double> Matrix;

struct Mesh {
    std::vector<Vector> vertices;
    std::vector<fcl::Triangle> triangles;
};

struct Tick {
    long long number;
    double a[3], b[3];
};

struct Answer {
    double distance;
    long triangle;
};

struct Options {
    std::string mesh, trace, out, bv = "obbrss";
    int repeat = 3;
    bool cold = false, json = false;
};

/* What a run gives: one entry a tick, and the means of what FCL had to do for a tick. */
struct Measured {
    std::vector<Answer> answers;
    std::vector<double> ns;
    double build_ns, bv_tests, leaf_tests;
};

/* An error that ends the program: one line for the user. */
void fail(const std::string &text)
{
    throw std::runtime_error(text);
}

double now_ns()
{
    struct timespec t;

    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

/* ---------------------------------------------------------------- files */

std::string read_file(const std::string &path)
{
    std::string bytes;
    char block[65536];
    size_t n;
    std::FILE *file = std::fopen(path.c_str(), "rb");

    if (!file)
        fail(path + ": " + std::strerror(errno));
    while ((n = std::fread(block, 1, sizeof block, file)) > 0)
        bytes.append(block, n);
    bool bad = std::ferror(file) != 0;
    std::fclose(file);
    if (bad)
        fail(path + ": cannot be read");
    return bytes;
}

uint32_t word(const std::string &bytes, size_t at)
{
    uint32_t value = 0;

    for (int i = 3; i >= 0; i--)
        value = value << 8 | (unsigned char)bytes[at + (size_t)i];
    return value;
}

Mesh read_mesh(const std::string &path)
{
    Mesh mesh;
    std::string bytes = read_file(path);

    if (bytes.size() < 8)
        fail(path + ": byte 0: no header of 8 bytes");
    uint64_t vertices = word(bytes, 0), triangles = word(bytes, 4);
    if (bytes.size() != 8 + 12 * vertices + 12 * triangles)
        fail(path + ": byte 0: the size does not agree with the counts");
    if (triangles == 0 || triangles > INT32_MAX / 2)
        fail(path + ": byte 4: a number of triangles that FCL cannot hold");

    size_t at = 8;
    for (uint64_t i = 0; i < vertices; i++) {
        Vector p;
        for (int k = 0; k < 3; k++, at += 4) {
            uint32_t bits = word(bytes, at);
            float value;
            std::memcpy(&value, &bits, sizeof value);
            if (!std::isfinite(value))
                fail(path + ": byte " + std::to_string(at) + ": not a finite number");
            p[k] = value;
        }
        mesh.vertices.push_back(p);
    }
    for (uint64_t i = 0; i < triangles; i++) {
        size_t corner[3];
        for (int k = 0; k < 3; k++, at += 4) {
            corner[k] = word(bytes, at);
            if (corner[k] >= vertices)
                fail(path + ": byte " + std::to_string(at) + ": no such vertex");
        }
        mesh.triangles.push_back(fcl::Triangle(corner[0], corner[1], corner[2]));
    }
    return mesh;
}

Tick read_row(const std::string &line, const std::string &where)
{
    Tick tick;
    double values[6];
    char *end;
    const char *at = line.c_str();

    errno = 0;
    tick.number = std::strtoll(at, &end, 10);
    if (end == at || errno)
        fail(where + "no tick");
    for (double &value : values) {
        if (*end != ',')
            fail(where + "seven columns expected");
        at = end + 1;
        value = std::strtod(at, &end);
        if (end == at || !std::isfinite(value))
            fail(where + "not a finite number");
    }
    if (*end != '\0')
        fail(where + "more than seven columns");
    for (int k = 0; k < 3; k++) {
        tick.a[k] = values[k];
        tick.b[k] = values[3 + k];
    }
    return tick;
}

std::vector<Tick> read_trace(const std::string &path)
{
    std::vector<Tick> trace;
    std::string text = read_file(path);
    size_t number = 0;
    bool header = false;

    for (size_t at = 0; at < text.size();) {
        size_t end = std::min(text.find('\n', at), text.size());
        std::string line = text.substr(at, end - at);
        at = end + 1;
        number++;
        if (!line.empty() && line.back() == '\r')
            line.pop_back();
        if (line.empty() || line[0] == '#')
            continue;
        std::string where = path + ": line " + std::to_string(number) + ": ";
        if (!header) {
            if (line != "tick,ax,ay,az,bx,by,bz")
                fail(where + "the header tick,ax,ay,az,bx,by,bz expected");
            header = true;
            continue;
        }
        trace.push_back(read_row(line, where));
        if (trace.size() > 1 && trace.back().number <= trace[trace.size() - 2].number)
            fail(where + "ticks must increase");
    }
    if (trace.empty())
        fail(path + ": no ticks");
    return trace;
}

/* Written beside and renamed, so that an error leaves no half of a file. */
void write_answers(const std::string &path, const std::vector<Tick> &trace,
                   const std::vector<Answer> &answers)
{
    bool to_stdout = path == "-";
    std::string beside = path + ".tmp";
    std::FILE *file = to_stdout ? stdout : std::fopen(beside.c_str(), "wb");

    if (!file)
        fail(beside + ": " + std::strerror(errno));
    std::fprintf(file, "tick,distance,triangle\n");
    for (size_t i = 0; i < trace.size(); i++)
        std::fprintf(file, "%lld,%.17g,%ld\n", trace[i].number, answers[i].distance,
                     answers[i].triangle);
    bool bad = std::fflush(file) != 0 || std::ferror(file);
    if (to_stdout) {
        if (bad)
            fail("standard output cannot be written");
        return;
    }
    bad |= std::fclose(file) != 0;
    if (!bad)
        bad = std::rename(beside.c_str(), path.c_str()) != 0;
    if (bad) {
        std::string reason = std::strerror(errno);
        std::remove(beside.c_str());
        fail(path + ": " + reason);
    }
}

/* ---------------------------------------------------------------- the segment in FCL's models */

/*
 * A right-handed frame whose x axis runs from a to b; any will do for a segment of length 0.
 * Divisions are few, as this is part of the time that is measured.
 */
Matrix frame_of(const Vector &a, const Vector &b, double &length)
{
    Vector x = b - a;
    Matrix frame;

    length = x.norm();
    if (length > 0)
        x *= 1 / length;
    else
        x = Vector(1, 0, 0);
    Vector y = x.cross(std::abs(x[0]) < 0.6 ? Vector(1, 0, 0) : Vector(0, 1, 0));
    y *= 1 / y.norm();
    frame.col(0) = x;
    frame.col(1) = y;
    frame.col(2) = x.cross(y);
    return frame;
}

/*
 * Writes the bounding volume of segment ab into `bv`. For rectangles it is the segment itself, with
 * no margin. `unit` is the volume that FCL fitted to the segment from (0, 0, 0) to (1, 0, 0).
 */
void place(fcl::RSS<double> &bv, const fcl::RSS<double> &, const Vector &a, const Vector &b)
{
    bv.axis = frame_of(a, b, bv.l[0]);
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
    Matrix frame = frame_of(a, b, length);

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
template <typename BV> class WarmNode : public fcl::detail::MeshDistanceTraversalNode<BV> {
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

template <typename BV> class Peer {
public:
    Peer(const Mesh &mesh)
    {
        mesh_.beginModel((int)mesh.triangles.size(), (int)mesh.vertices.size());
        mesh_.addSubModel(mesh.vertices, mesh.triangles);
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
            return Answer{result_.min_distance, -1};
        node_.start = (long)result_.b1;
        return Answer{result_.min_distance, node_.start};
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
    fcl::DistanceResult<double> result_;
    WarmNode<BV> node_;
};

template <typename BV>
Measured measure(const Mesh &mesh, const std::vector<Tick> &trace, const Options &options)
{
    Measured measured;
    double begin = now_ns();
    Peer<BV> peer(mesh);

    measured.build_ns = now_ns() - begin;
    measured.answers.resize(trace.size());
    measured.ns.assign(trace.size(), std::numeric_limits<double>::infinity());
    for (int pass = 0; pass < options.repeat; pass++) {
        peer.reset();
        for (size_t i = 0; i < trace.size(); i++) {
            double start = now_ns();
            Answer answer = peer.ask(trace[i], options.cold);
            double ns = now_ns() - start;
            measured.answers[i] = answer;
            measured.ns[i] = std::min(measured.ns[i], ns);
        }
    }

    measured.bv_tests = measured.leaf_tests = 0;
    peer.count(true);
    peer.reset();
    for (const Tick &tick : trace) {
        peer.ask(tick, options.cold);
        measured.bv_tests += peer.bv_tests() / (double)trace.size();
        measured.leaf_tests += peer.leaf_tests() / (double)trace.size();
    }
    return measured;
}

/* ---------------------------------------------------------------- the summary */

/* The smallest value that at least the part p of the sorted values does not exceed. */
double quantile(const std::vector<double> &sorted, double p)
{
    size_t rank = (size_t)std::ceil(p * (double)sorted.size());

    return sorted[std::min(std::max(rank, (size_t)1), sorted.size()) - 1];
}

void print_times(const char *key, std::vector<double> ns)
{
    std::sort(ns.begin(), ns.end());
    if (ns.empty())
        std::printf(",\"%s\":{\"median\":null,\"p99\":null,\"p999\":null,\"max\":null}", key);
    else
        std::printf(",\"%s\":{\"median\":%.0f,\"p99\":%.0f,\"p999\":%.0f,\"max\":%.0f}", key,
                    quantile(ns, 0.5), quantile(ns, 0.99), quantile(ns, 0.999), ns.back());
}

void print_json(const char *name, size_t triangles, const Measured &measured, bool cold)
{
    std::vector<double> all, crossing, other;

    /* The first tick has no tick before it to start from, so it is told apart. */
    for (size_t i = 1; i < measured.ns.size(); i++) {
        all.push_back(measured.ns[i]);
        (measured.answers[i].distance <= 0 ? crossing : other).push_back(measured.ns[i]);
    }
    std::printf("{\"peer\":\"fcl %s%s\",\"triangles\":%zu,\"ticks\":%zu,\"first_ns\":%.0f", name,
                cold ? " cold" : "", triangles, measured.ns.size(), measured.ns[0]);
    print_times("ns", all);
    print_times("ns_crossing", crossing);
    print_times("ns_other", other);
    std::printf(",\"crossing\":%zu,\"build_ns\":%.0f,\"bv_tests\":%.1f,\"leaf_tests\":%.1f}\n",
                crossing.size(), measured.build_ns, measured.bv_tests, measured.leaf_tests);
}

/* ---------------------------------------------------------------- the program */

const char usage[] =
    "usage: peer_fcl MESH.tri TRACE.csv -o OUT.csv [--repeat N] [--bv BV] [--cold] [--json]\n";

const char help[] =
    "\n"
    "Distance from the segment of each tick to the mesh, by FCL, and the time it takes.\n"
    "  -o OUT.csv    tick,distance,triangle; - is standard output\n"
    "  --repeat N    passes, of which the least time per tick counts (3)\n"
    "  --bv BV       bounding volume: obbrss (default), rss or kios\n"
    "  --cold        start each tick from triangle 0 and not from the last tick's nearest\n"
    "  --json        a summary on standard output\n"
    "Exit: 0 done, 2 usage, input or system error.\n";

/* True if the program has only to print `help` or its version, and has done so. */
bool read_options(int argc, char **argv, Options &options)
{
    std::vector<std::string> files;

    for (int i = 1; i < argc; i++) {
        std::string word = argv[i];
        if (word == "--help") {
            std::printf("%s%s", usage, help);
            return true;
        }
        if (word == "--version") {
            std::printf("peer_fcl with FCL %s\n", FCL_VERSION);
            return true;
        }
        if (word == "--cold") {
            options.cold = true;
        } else if (word == "--json") {
            options.json = true;
        } else if (word == "-o" || word == "--repeat" || word == "--bv") {
            if (++i == argc)
                fail(word + " needs a value; see --help");
            std::string value = argv[i];
            if (word == "-o") {
                options.out = value;
            } else if (word == "--bv") {
                options.bv = value;
            } else {
                char *end;
                long n = std::strtol(argv[i], &end, 10);
                if (end == argv[i] || *end != '\0' || n < 1 || n > 1000)
                    fail("--repeat takes a number from 1 to 1000");
                options.repeat = (int)n;
            }
        } else if (word.size() > 1 && word[0] == '-') {
            fail("unknown option " + word + "; see --help");
        } else {
            files.push_back(word);
        }
    }
    if (files.size() != 2 || options.out.empty())
        fail("MESH.tri, TRACE.csv and -o OUT.csv are needed; see --help");
    if (options.json && options.out == "-")
        fail("--json and -o - would both write to standard output");
    options.mesh = files[0];
    options.trace = files[1];
    return false;
}

void run(const Options &options)
{
    const char *name;
    Measured (*measure_with)(const Mesh &, const std::vector<Tick> &, const Options &);

    if (options.bv == "obbrss") {
        name = "OBBRSS";
        measure_with = measure<fcl::OBBRSS<double>>;
    } else if (options.bv == "rss") {
        name = "RSS";
        measure_with = measure<fcl::RSS<double>>;
    } else if (options.bv == "kios") {
        name = "kIOS";
        measure_with = measure<fcl::kIOS<double>>;
    } else {
        fail("--bv takes obbrss, rss or kios");
        return;
    }

    Mesh mesh = read_mesh(options.mesh);
    std::vector<Tick> trace = read_trace(options.trace);
    Measured measured = measure_with(mesh, trace, options);
    write_answers(options.out, trace, measured.answers);
    if (options.json)
        print_json(name, mesh.triangles.size(), measured, options.cold);
}

} // namespace

int main(int argc, char **argv)
{
    Options options;

    try {
        if (!read_options(argc, argv, options))
            run(options);
    } catch (const std::exception &error) {
        std::fprintf(stderr, "peer_fcl: %s\n", error.what());
        return 2;
    }
    return 0;
}
