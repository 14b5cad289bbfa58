/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What the peers share: reading MESH.tri and TRACE.csv, asking tick by tick, taking the time,
 * writing OUT.csv and the summary. A peer is a class with
 *
 *     Peer(const Mesh &)                      builds its tree
 *     Answer ask(const Tick &, bool cold)     the answer for one tick, started from the last one
 *     void reset()                            no last tick, as after construction
 *     void count(bool)                        count tests, for libraries where that costs time
 *     double bv_tests(), leaf_tests()         of the last tick; NaN where the library hides them
 *     void move(const vertex_motion &)        takes new positions; only those that can (peer_motion.h)
 *
 * and a main that calls peer_main. C++11, as some libraries ask for no more; nothing but the
 * standard library and clock_gettime.
 *
 * MESH.tri, little-endian: uint32 vertex_count, uint32 triangle_count, float xyz[3 * vertex_count],
 * uint32 corners[3 * triangle_count]. TRACE.csv: tick,ax,ay,az,bx,by,bz. OUT.csv:
 * tick,distance,triangle; a distance that the library cannot tell is left empty.
 */
#ifndef PEER_H
#define PEER_H

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <time.h>

#include "peer_geometry.h"

namespace peer
{

typedef std::array<double, 3> Point;

struct Mesh {
    std::vector<Point> vertices;
    std::vector<std::array<uint32_t, 3>> triangles;
};

struct Tick {
    long long number;
    double a[3], b[3];
};

/* A distance of NaN is one that the library cannot tell. */
struct Answer {
    double distance;
    long triangle;
};

/* `choice` is the value of the one option that a peer may have for itself; `ticks` 0 stands for all. */
struct Options {
    std::string mesh, trace, out, choice, motion;
    int repeat = 3, ticks = 0;
    bool cold = false, json = false;
};

/* What a peer says of itself; `option` is empty or "--bv", and `option_help` its line. */
struct About {
    const char *program, *library, *version, *question, *option, *option_value, *option_help;
    bool moves; /* it takes --motion */
};

/* What a run gives: one entry a tick, and the means of what the library had to do for a tick. */
struct Measured {
    std::vector<Answer> answers;
    std::vector<double> ns;
    std::vector<double> move_ns; /* of new positions, where there are any */
    double build_ns, bv_tests, leaf_tests;
    std::string more; /* further keys of the summary, each with a comma before it */
};

/* An error that ends the program: one line for the user. */
inline void fail(const std::string &text)
{
    throw std::runtime_error(text);
}

inline double now_ns()
{
    struct timespec t;

    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

/* ---------------------------------------------------------------- files */

inline std::string read_file(const std::string &path)
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

inline uint32_t word(const std::string &bytes, size_t at)
{
    uint32_t value = 0;

    for (int i = 3; i >= 0; i--)
        value = value << 8 | (unsigned char)bytes[at + (size_t)i];
    return value;
}

inline Mesh read_mesh(const std::string &path, const char *library)
{
    Mesh mesh;
    std::string bytes = read_file(path);

    if (bytes.size() < 8)
        fail(path + ": byte 0: no header of 8 bytes");
    uint64_t vertices = word(bytes, 0), triangles = word(bytes, 4);
    if (bytes.size() != 8 + 12 * vertices + 12 * triangles)
        fail(path + ": byte 0: the size does not agree with the counts");
    if (triangles == 0 || triangles > INT32_MAX / 2)
        fail(path + ": byte 4: a number of triangles that " + library + " cannot hold");

    size_t at = 8;
    for (uint64_t i = 0; i < vertices; i++) {
        Point p;
        for (size_t k = 0; k < 3; k++, at += 4) {
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
        std::array<uint32_t, 3> corner;
        for (size_t k = 0; k < 3; k++, at += 4) {
            corner[k] = word(bytes, at);
            if (corner[k] >= vertices)
                fail(path + ": byte " + std::to_string(at) + ": no such vertex");
        }
        mesh.triangles.push_back(corner);
    }
    return mesh;
}

inline Tick read_row(const std::string &line, const std::string &where)
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

inline std::vector<Tick> read_trace(const std::string &path)
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
inline void write_answers(const std::string &path, const std::vector<Tick> &trace, const std::vector<Answer> &answers)
{
    bool to_stdout = path == "-";
    std::string beside = path + ".tmp";
    std::FILE *file = to_stdout ? stdout : std::fopen(beside.c_str(), "wb");

    if (!file)
        fail(beside + ": " + std::strerror(errno));
    std::fprintf(file, "tick,distance,triangle\n");
    for (size_t i = 0; i < trace.size(); i++) {
        if (std::isnan(answers[i].distance))
            std::fprintf(file, "%lld,,%ld\n", trace[i].number, answers[i].triangle);
        else
            std::fprintf(file, "%lld,%.17g,%ld\n", trace[i].number, answers[i].distance, answers[i].triangle);
    }
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

inline std::vector<Corners> corners_of(const Mesh &mesh)
{
    std::vector<Corners> corners;

    for (const auto &t : mesh.triangles)
        corners.push_back(Corners{ vec(mesh.vertices[t[0]].data()), vec(mesh.vertices[t[1]].data()),
                                   vec(mesh.vertices[t[2]].data()) });
    return corners;
}

/* ---------------------------------------------------------------- measuring */

/* The time is taken around the query alone; the tests are counted in a pass of their own. */
template <typename Peer> Measured measure_peer(Peer &peer, const std::vector<Tick> &trace, const Options &options)
{
    Measured measured;

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

template <typename Peer> Measured measure(const Mesh &mesh, const std::vector<Tick> &trace, const Options &options)
{
    double begin = now_ns();
    Peer peer(mesh);
    double build_ns = now_ns() - begin;

    Measured measured = measure_peer(peer, trace, options);
    measured.build_ns = build_ns;
    return measured;
}

/* ---------------------------------------------------------------- the summary */

/* The smallest value that at least the part p of the sorted values does not exceed. */
inline double quantile(const std::vector<double> &sorted, double p)
{
    size_t rank = (size_t)std::ceil(p * (double)sorted.size());

    return sorted[std::min(std::max(rank, (size_t)1), sorted.size()) - 1];
}

inline void print_times(const char *key, std::vector<double> ns)
{
    std::sort(ns.begin(), ns.end());
    if (ns.empty())
        std::printf(",\"%s\":{\"median\":null,\"p99\":null,\"p999\":null,\"max\":null}", key);
    else
        std::printf(",\"%s\":{\"median\":%.0f,\"p99\":%.0f,\"p999\":%.0f,\"max\":%.0f}", key, quantile(ns, 0.5),
                    quantile(ns, 0.99), quantile(ns, 0.999), ns.back());
}

/* In the bins of `dynpoint replay --json`: 8 to a doubling from 16 ns on, the first of all below. */
inline void print_histogram(const char *key, const std::vector<double> &ns)
{
    std::vector<long> edges, counts(1, 0);

    for (int i = 0; i <= 8 * 16; i++) {
        edges.push_back(std::lround(16 * std::pow(2.0, i / 8.0)));
        counts.push_back(0);
    }
    for (double t : ns)
        counts[std::upper_bound(edges.begin(), edges.end(), (long)t) - edges.begin()]++;
    std::printf(",\"%s\":{\"edges\":[", key);
    for (size_t i = 0; i < edges.size(); i++)
        std::printf(i ? ",%ld" : "%ld", edges[i]);
    std::printf("],\"counts\":[");
    for (size_t i = 0; i < counts.size(); i++)
        std::printf(i ? ",%ld" : "%ld", counts[i]);
    std::printf("]}");
}

inline void print_count(const char *key, double value)
{
    if (std::isnan(value))
        std::printf(",\"%s\":null", key);
    else
        std::printf(",\"%s\":%.1f", key, value);
}

inline void print_json(const std::string &name, size_t triangles, const Measured &measured, bool cold)
{
    std::vector<double> all, crossing, other;

    /* The first tick has no tick before it to start from, so it is told apart. */
    for (size_t i = 1; i < measured.ns.size(); i++) {
        all.push_back(measured.ns[i]);
        (measured.answers[i].distance <= 0 ? crossing : other).push_back(measured.ns[i]);
    }
    std::printf("{\"peer\":\"%s%s\",\"triangles\":%zu,\"ticks\":%zu,\"first_ns\":%.0f", name.c_str(),
                cold ? " cold" : "", triangles, measured.ns.size(), measured.ns[0]);
    print_times("ns", all);
    print_times("ns_crossing", crossing);
    print_times("ns_other", other);
    if (!measured.move_ns.empty())
        print_times("ns_move", std::vector<double>(measured.move_ns.begin() + 1, measured.move_ns.end()));
    print_histogram("ns_histogram", all);
    std::printf(",\"crossing\":%zu,\"build_ns\":%.0f", crossing.size(), measured.build_ns);
    print_count("bv_tests", measured.bv_tests);
    print_count("leaf_tests", measured.leaf_tests);
    std::printf("%s}\n", measured.more.c_str());
}

/* ---------------------------------------------------------------- the program */

inline void print_usage(const About &about, bool with_help)
{
    std::string option = *about.option ? std::string(" [") + about.option + " " + about.option_value + "]" : "";

    std::printf("usage: %s MESH.tri TRACE.csv -o OUT.csv [--repeat N] [--ticks N]%s%s [--cold] [--json]\n",
                about.program, option.c_str(), about.moves ? " [--motion NAME:STEP]" : "");
    if (!with_help)
        return;
    std::printf("\n%s, by %s, and the time it takes.\n"
                "  -o OUT.csv    tick,distance,triangle; - is standard output\n"
                "  --repeat N    passes, of which the least time per tick counts (3)\n"
                "  --ticks N     only the first N\n",
                about.question, about.library);
    if (*about.option)
        std::printf("  %-12s  %s\n", (std::string(about.option) + " " + about.option_value).c_str(), about.option_help);
    if (about.moves)
        std::printf("  --motion NAME:STEP  vertices move in each tick, as vertex_motion.h has it; or recorded:FILE\n");
    std::printf("  --cold        start each tick from triangle 0 and not from the last tick's nearest\n"
                "  --json        a summary on standard output\n"
                "Exit: 0 done, 2 usage, input or system error.\n");
}

/* True if the program has only to print its help or version, and has done so. */
inline bool read_options(int argc, char **argv, const About &about, Options &options)
{
    std::vector<std::string> files;

    for (int i = 1; i < argc; i++) {
        std::string word = argv[i];
        bool own = *about.option && word == about.option;
        if (word == "--help") {
            print_usage(about, true);
            return true;
        }
        if (word == "--version") {
            std::printf("%s with %s %s\n", about.program, about.library, about.version);
            return true;
        }
        if (word == "--cold") {
            options.cold = true;
        } else if (word == "--json") {
            options.json = true;
        } else if (word == "-o" || word == "--repeat" || word == "--ticks" || own ||
                   (about.moves && word == "--motion")) {
            if (++i == argc)
                fail(word + " needs a value; see --help");
            std::string value = argv[i];
            if (word == "-o") {
                options.out = value;
            } else if (own) {
                options.choice = value;
            } else if (word == "--motion") {
                options.motion = value;
            } else {
                char *end;
                long n = std::strtol(argv[i], &end, 10);
                if (end == argv[i] || *end != '\0' || n < 1 || n > 1000000)
                    fail(word + " takes a number from 1 to 1000000");
                (word == "--ticks" ? options.ticks : options.repeat) = (int)n;
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

/* Asks the whole trace; sets `name` to what the summary calls the peer. */
typedef std::function<Measured(const Mesh &, const std::vector<Tick> &, const Options &, std::string &name)> Asking;

inline int peer_main(int argc, char **argv, const About &about, const Asking &asking)
{
    Options options;
    std::string name;

    try {
        if (read_options(argc, argv, about, options))
            return 0;
        Mesh mesh = read_mesh(options.mesh, about.library);
        std::vector<Tick> trace = read_trace(options.trace);
        if (options.ticks && (size_t)options.ticks < trace.size())
            trace.resize((size_t)options.ticks);
        Measured measured = asking(mesh, trace, options, name);
        write_answers(options.out, trace, measured.answers);
        if (options.json)
            print_json(name, mesh.triangles.size(), measured, options.cold);
    } catch (const std::exception &error) {
        std::fprintf(stderr, "%s: %s\n", about.program, error.what());
        return 2;
    }
    return 0;
}

} // namespace peer

#endif
