/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The shapes of 'dynpoint make': counts, topology, size, place, and the same bits everywhere.
 */
#include <math.h>

#include "base/sincos.h"
#include "lib/check.h"
#include "scene/shape.h"

static struct shape build(const char *name, uint64_t count, uint64_t seed)
{
    struct shape shape;
    shape_reason reason = "";
    int failed = shape_make(name, count, seed, &shape, reason);
    CHECK(!failed, "%s %llu: %s", name, (unsigned long long)count, reason);
    if (!failed && count != 0)
        CHECK(shape.triangle_count == count, "%s: %zu of %llu triangles", name, shape.triangle_count,
              (unsigned long long)count);
    return shape;
}

static const double *corner(const struct shape *shape, size_t half)
{
    return shape->vertices + 3 * (size_t)shape->corners[half];
}

static size_t next_half(size_t half)
{
    return half % 3 == 2 ? half - 2 : half + 1;
}

static void cross(const double a[3], const double b[3], const double c[3], double out[3])
{
    double u[3], v[3];
    for (int i = 0; i < 3; i++) {
        u[i] = b[i] - a[i];
        v[i] = c[i] - a[i];
    }
    for (int i = 0; i < 3; i++)
        out[i] = u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3];
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Topology, by sorting the half-edges. */
struct half_edge {
    uint32_t low, high;
    uint32_t half;
};

struct topology {
    size_t bad_edges; /* of three triangles or more, or of two that run the same way */
    size_t border_edges, border_loops;
    size_t fans; /* as many as vertices when each has one fan of triangles */
    size_t components;
    long euler;
};

static int compare_half_edges(const void *left, const void *right)
{
    const struct half_edge *a = left, *b = right;
    if (a->low != b->low)
        return a->low < b->low ? -1 : 1;
    if (a->high != b->high)
        return a->high < b->high ? -1 : 1;
    return a->half < b->half ? -1 : a->half > b->half;
}

static size_t root(uint32_t *parent, size_t i)
{
    while (parent[i] != i)
        i = parent[i] = parent[parent[i]];
    return i;
}

static void join(uint32_t *parent, size_t a, size_t b)
{
    parent[root(parent, a)] = (uint32_t)root(parent, b);
}

static uint32_t *singles(size_t count)
{
    uint32_t *parent = malloc(count * sizeof *parent);
    for (size_t i = 0; parent && i < count; i++)
        parent[i] = (uint32_t)i;
    return parent;
}

static size_t count_roots(const uint32_t *parent, size_t count)
{
    size_t roots = 0;
    for (size_t i = 0; i < count; i++)
        roots += parent[i] == i;
    return roots;
}

static struct half_edge *sorted_half_edges(const struct shape *shape)
{
    size_t halves = 3 * shape->triangle_count;
    struct half_edge *edges = malloc(halves * sizeof *edges);
    for (size_t h = 0; edges && h < halves; h++) {
        uint32_t a = shape->corners[h], b = shape->corners[next_half(h)];
        edges[h].low = a < b ? a : b;
        edges[h].high = a < b ? b : a;
        edges[h].half = (uint32_t)h;
    }
    if (edges)
        qsort(edges, halves, sizeof *edges, compare_half_edges);
    return edges;
}

static size_t count_loops(uint32_t *border_next, size_t vertices)
{
    size_t loops = 0;
    for (size_t v = 0; v < vertices; v++) {
        if (border_next[v] == UINT32_MAX)
            continue;
        loops++;
        for (size_t at = v, next; border_next[at] != UINT32_MAX; at = next) {
            next = border_next[at];
            border_next[at] = UINT32_MAX;
        }
    }
    return loops;
}

static struct topology topology_of(const struct shape *shape)
{
    struct topology t = { 0, 0, 0, 0, 0, 0 };
    size_t halves = 3 * shape->triangle_count, edge_count = 0, end;
    struct half_edge *edges = sorted_half_edges(shape);
    uint32_t *fans = singles(halves), *parts = singles(shape->triangle_count);
    uint32_t *border_next = malloc(shape->vertex_count * sizeof *border_next);
    if (!edges || !fans || !parts || !border_next)
        abort();
    memset(border_next, 0xff, shape->vertex_count * sizeof *border_next);
    for (size_t i = 0; i < halves; i = end, edge_count++) {
        size_t a = edges[i].half;
        for (end = i + 1; end < halves && edges[end].low == edges[i].low && edges[end].high == edges[i].high;)
            end++;
        if (end - i == 1) {
            t.border_edges++;
            border_next[shape->corners[a]] = shape->corners[next_half(a)];
        } else if (end - i == 2 && shape->corners[a] != shape->corners[edges[i + 1].half]) {
            size_t b = edges[i + 1].half;
            join(fans, a, next_half(b));
            join(fans, next_half(a), b);
            join(parts, a / 3, b / 3);
        } else {
            t.bad_edges++;
        }
    }
    t.fans = count_roots(fans, halves);
    t.components = count_roots(parts, shape->triangle_count);
    t.border_loops = count_loops(border_next, shape->vertex_count);
    t.euler = (long)shape->vertex_count - (long)edge_count + (long)shape->triangle_count;
    free(edges);
    free(fans);
    free(parts);
    free(border_next);
    return t;
}

static void check_topology(const struct shape *shape, const char *name, long euler, size_t loops)
{
    struct topology t = topology_of(shape);
    size_t count = shape->triangle_count;
    CHECK(t.bad_edges == 0, "%s %zu: %zu", name, count, t.bad_edges);
    CHECK(t.fans == shape->vertex_count, "%s %zu: %zu fans, %zu vertices", name, count, t.fans, shape->vertex_count);
    CHECK(t.components == 1, "%s %zu: %zu", name, count, t.components);
    CHECK(t.euler == euler, "%s %zu: %ld", name, count, t.euler);
    CHECK(t.border_loops == loops, "%s %zu: %zu", name, count, t.border_loops);
    CHECK((t.border_edges == 0) == (loops == 0), "%s %zu: %zu", name, count, t.border_edges);
}

/* Areas and angles as they are after rounding to float. */
static void check_triangles(const struct shape *shape, const char *name)
{
    size_t degenerate = 0;
    for (size_t t = 0; t < shape->triangle_count; t++) {
        double p[3][3], n[3];
        for (size_t i = 0; i < 9; i++)
            p[i / 3][i % 3] = (float)corner(shape, 3 * t + i / 3)[i % 3];
        cross(p[0], p[1], p[2], n);
        degenerate += dot(n, n) > 0.0 ? 0 : 1;
    }
    CHECK(degenerate == 0, "%s %zu: %zu", name, shape->triangle_count, degenerate);
}

static double volume(const struct shape *shape)
{
    const double origin[3] = { 0.0, 0.0, 0.0 };
    double sum = 0.0;
    for (size_t t = 0; t < shape->triangle_count; t++) {
        double n[3];
        cross(origin, corner(shape, 3 * t + 1), corner(shape, 3 * t + 2), n);
        sum += dot(corner(shape, 3 * t), n) / 6.0;
    }
    return sum;
}

static void bounds(const struct shape *shape, double low[3], double high[3])
{
    for (size_t i = 0; i < 3; i++) {
        low[i] = INFINITY;
        high[i] = -INFINITY;
    }
    for (size_t i = 0; i < 3 * shape->vertex_count; i++) {
        double x = shape->vertices[i];
        CHECK(isfinite(x), "coordinate %zu", i);
        low[i % 3] = fmin(low[i % 3], x);
        high[i % 3] = fmax(high[i % 3], x);
    }
}

static void closed_shapes_are_manifold_and_outward(void)
{
    static const struct {
        const char *name;
        uint32_t count;
    } cases[] = { { "torus", 32 },    { "torus", 34 },    { "torus", 62 },     { "torus", 5568 }, { "torus", 13580 },
                  { "torus", 20832 }, { "torus", 39648 }, { "torus", 61358 },  { "liver", 200 },  { "liver", 498 },
                  { "liver", 50332 }, { "stomach", 200 }, { "stomach", 9000 }, { "spleen", 202 }, { "spleen", 7000 },
                  { "star", 2000 },   { "star", 20480 },  { "star", 22000 },   { "sphere", 20 },  { "sphere", 22 },
                  { "sphere", 78 },   { "sphere", 5000 }, { "box", 12 },       { "box", 48 },     { "box", 1200 } };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const char *name = cases[i].name;
        struct shape shape = build(name, cases[i].count, 0);
        check_topology(&shape, name, strcmp(name, "torus") == 0 ? 0 : 2, 0);
        check_triangles(&shape, name);
        CHECK(volume(&shape) > 0.0, "%s %u: %g", name, cases[i].count, volume(&shape));
        shape_free(&shape);
    }
}

static void every_even_count_can_be_had(void)
{
    for (uint32_t count = 32; count <= 700; count += 2) {
        struct shape torus = build("torus", count, 0), sphere = build("sphere", count, 0);
        check_topology(&torus, "torus", 0, 0);
        check_topology(&sphere, "sphere", 2, 0);
        check_triangles(&torus, "torus");
        shape_free(&torus);
        shape_free(&sphere);
    }
}

static void open_shapes_have_one_border(void)
{
    static const struct {
        const char *name;
        uint32_t count;
    } cases[] = { { "membrane", 2 },  { "membrane", 512 }, { "cloth", 2 },      { "cloth", 2048 },
                  { "hub", 3 },       { "hub", 50000 },    { "stomach", 201 },  { "stomach", 203 },
                  { "stomach", 335 }, { "stomach", 1619 }, { "stomach", 9001 }, { "stomach", 20001 } };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct shape shape = build(cases[i].name, cases[i].count, 0);
        check_topology(&shape, cases[i].name, 1, 1);
        check_triangles(&shape, cases[i].name);
        shape_free(&shape);
    }
}

static double least_angle(const struct shape *shape)
{
    double least = INFINITY;
    for (size_t h = 0; h < 3 * shape->triangle_count; h++) {
        const double *a = corner(shape, h), *b = corner(shape, next_half(h));
        const double *c = corner(shape, next_half(next_half(h)));
        double n[3], along = 0.0;
        cross(a, b, c, n);
        for (int i = 0; i < 3; i++)
            along += (b[i] - a[i]) * (c[i] - a[i]);
        least = fmin(least, atan2(sqrt(dot(n, n)), along));
    }
    return least * 57.29577951308232;
}

static void torus_lies_on_its_surface(void)
{
    static const uint32_t counts[] = { 5568, 13580, 20832, 39648, 61358 };
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        struct shape shape = build("torus", counts[i], 0);
        double off = 0.0, exact = 2.0 * 9.869604401089358 * 0.1 * 0.04 * 0.04;
        for (const double *v = shape.vertices; v < shape.vertices + 3 * shape.vertex_count; v += 3) {
            double across = sqrt(v[0] * v[0] + v[1] * v[1]) - 0.1;
            off = fmax(off, fabs(sqrt(across * across + v[2] * v[2]) - 0.04));
        }
        CHECK(off < 1e-15, "torus %u: %g", counts[i], off);
        CHECK(fabs(volume(&shape) / exact - 1.0) < 0.01, "torus %u: %g", counts[i], volume(&shape));
        CHECK(least_angle(&shape) > 15.0, "torus %u: %g", counts[i], least_angle(&shape));
        shape_free(&shape);
    }
}

static void torus_goes_to_a_million(void)
{
    struct shape shape = build("torus", 1000000, 0);
    check_topology(&shape, "torus", 0, 0);
    check_triangles(&shape, "torus");
    shape_free(&shape);
}

static void shapes_have_their_size(void)
{
    static const struct {
        const char *name;
        uint32_t count;
        double size[3], within;
    } cases[] = {
        { "torus", 5568, { 0.28, 0.28, 0.08 }, 1e-3 },       { "liver", 50332, { 0.28, 0.18, 0.12 }, 6e-3 },
        { "stomach", 20000, { 0.168, 0.156, 0.080 }, 4e-3 }, { "spleen", 10000, { 0.070, 0.111, 0.045 }, 4e-3 },
        { "membrane", 512, { 0.2, 0.2, 0.0 }, 0.0 },         { "cloth", 2048, { 0.3, 0.3, 0.018 }, 3e-3 },
        { "star", 20480, { 0.29, 0.29, 0.29 }, 0.01 },       { "sphere", 2000, { 0.2, 0.2, 0.2 }, 2e-3 },
        { "box", 48, { 0.12, 0.10, 0.08 }, 1e-15 },          { "hub", 100, { 0.2, 0.2, 0.02 }, 1e-3 }
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct shape shape = build(cases[i].name, cases[i].count, 0);
        double low[3], high[3];
        bounds(&shape, low, high);
        for (int n = 0; n < 3; n++)
            CHECK(fabs(high[n] - low[n] - cases[i].size[n]) <= cases[i].within, "%s: axis %d: %g", cases[i].name, n,
                  high[n] - low[n]);
        shape_free(&shape);
    }
}

static void sheets_face_up(void)
{
    static const char *const names[] = { "membrane", "cloth", "hub" };
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        struct shape shape = build(names[i], 512, 0);
        for (size_t t = 0; t < shape.triangle_count; t++) {
            double n[3];
            cross(corner(&shape, 3 * t), corner(&shape, 3 * t + 1), corner(&shape, 3 * t + 2), n);
            CHECK(n[2] > 0.0, "%s: triangle %zu", names[i], t);
            CHECK(i > 0 || (n[0] == 0.0 && n[1] == 0.0), "membrane: triangle %zu", t);
        }
        shape_free(&shape);
    }
}

static void star_has_48_spikes(void)
{
    for (uint64_t seed = 0; seed < 4; seed++) {
        struct shape shape = build("star", 20480, seed);
        unsigned char *passed = calloc(shape.vertex_count, 1);
        size_t spikes = 0, low = 0;
        for (size_t h = 0; passed && h < 3 * shape.triangle_count; h++) {
            const double *a = corner(&shape, h), *b = corner(&shape, next_half(h));
            passed[shape.corners[dot(a, a) < dot(b, b) ? h : next_half(h)]] = 1;
        }
        for (size_t v = 0; passed && v < shape.vertex_count; v++) {
            double radius = sqrt(dot(shape.vertices + 3 * v, shape.vertices + 3 * v));
            spikes += !passed[v] && radius > 0.14 && radius <= 0.15;
            low += radius < 0.061;
            CHECK(radius > 0.06 - 1e-15, "vertex %zu: %g", v, radius);
            CHECK(passed[v] || radius < 0.061 || radius > 0.14, "a hill of %g", radius);
        }
        CHECK(spikes == 48, "seed %u: %zu", (unsigned)seed, spikes);
        CHECK(low * 3 > shape.vertex_count, "%zu vertices between the spikes", low);
        free(passed);
        shape_free(&shape);
    }
}

/* Whether the segment ab passes through a triangle. */
static int passes(const double a[3], const double b[3], const double *const t[3])
{
    double n[3], m[3], ends[2];
    cross(t[0], t[1], t[2], n);
    ends[0] = dot(n, a) - dot(n, t[0]);
    ends[1] = dot(n, b) - dot(n, t[0]);
    if ((ends[0] > 0.0) == (ends[1] > 0.0))
        return 0;
    int inside = 0, outside = 0;
    for (int i = 0; i < 3; i++) {
        cross(a, t[i], t[(i + 1) % 3], m);
        double side = dot(m, b) - dot(m, a);
        inside += side >= 0.0;
        outside += side <= 0.0;
    }
    return inside == 3 || outside == 3;
}

/* Two meshes meet when, and only when, an edge of one passes through a triangle of the other. */
static size_t count_passes(const struct shape *edges, const struct shape *triangles)
{
    size_t passing = 0;
    double low[3], high[3];
    bounds(triangles, low, high);
    for (size_t h = 0; h < 3 * edges->triangle_count; h++) {
        const double *a = corner(edges, h), *b = corner(edges, next_half(h));
        int apart = 0;
        for (int i = 0; i < 3; i++)
            apart |= fmax(a[i], b[i]) < low[i] || fmin(a[i], b[i]) > high[i];
        for (size_t t = 0; !apart && t < triangles->triangle_count; t++) {
            const double *const c[3] = { corner(triangles, 3 * t), corner(triangles, 3 * t + 1),
                                         corner(triangles, 3 * t + 2) };
            passing += (size_t)passes(a, b, c);
        }
    }
    return passing;
}

static int box_within(const struct shape *inner, const struct shape *outer)
{
    double low[2][3], high[2][3];
    int within = 1;
    bounds(inner, low[0], high[0]);
    bounds(outer, low[1], high[1]);
    for (int i = 0; i < 3; i++)
        within &= low[0][i] >= low[1][i] && high[0][i] <= high[1][i];
    return within;
}

static void laparoscopic_bodies_stand_apart(void)
{
    for (uint64_t seed = 0; seed < 3; seed++) {
        struct shape bodies[LAPAROSCOPIC_BODIES];
        shape_reason reason = "";
        size_t total = 0;
        CHECK(!shape_make_laparoscopic(LAPAROSCOPIC_TRIANGLES, seed, bodies, reason), "%s", reason);
        for (int i = 0; i < LAPAROSCOPIC_BODIES; i++) {
            int open = strcmp(laparoscopic_names[i], "stomach") == 0;
            total += bodies[i].triangle_count;
            check_topology(&bodies[i], laparoscopic_names[i], open ? 1 : 2, open ? 1 : 0);
            check_triangles(&bodies[i], laparoscopic_names[i]);
            for (int j = 0; j < LAPAROSCOPIC_BODIES; j++)
                if (i != j) {
                    CHECK(count_passes(&bodies[i], &bodies[j]) == 0, "%d meets %d", i, j);
                    CHECK(!box_within(&bodies[i], &bodies[j]), "%d in %d", i, j);
                }
        }
        CHECK(total == 5387, "%zu triangles", total);
        for (int i = 0; i < LAPAROSCOPIC_BODIES; i++)
            shape_free(&bodies[i]);
    }
}

static void passing_edges_are_seen(void)
{
    struct shape box = build("box", 48, 0), sphere = build("sphere", 500, 0);
    CHECK(count_passes(&sphere, &box) + count_passes(&box, &sphere) == 0, "box in a sphere");
    for (size_t v = 0; v < box.vertex_count; v++)
        box.vertices[3 * v] += 0.06;
    CHECK(count_passes(&sphere, &box) + count_passes(&box, &sphere) > 0, "box through a sphere");
    shape_free(&box);
    shape_free(&sphere);
}

/* FNV-1a over the bits of the numbers, lowest byte first on every machine. */
static uint64_t hash_bits(uint64_t hash, uint64_t bits, int bytes)
{
    for (int i = 0; i < bytes; i++)
        hash = (hash ^ ((bits >> (8 * i)) & 0xff)) * 0x100000001b3u;
    return hash;
}

static uint64_t hash_of(const struct shape *shape)
{
    uint64_t hash = 0xcbf29ce484222325u, bits;
    for (size_t i = 0; i < 3 * shape->vertex_count; i++) {
        memcpy(&bits, &shape->vertices[i], sizeof bits);
        hash = hash_bits(hash, bits, 8);
    }
    for (size_t i = 0; i < 3 * shape->triangle_count; i++)
        hash = hash_bits(hash, shape->corners[i], 4);
    return hash;
}

static void shapes_have_the_same_bits_everywhere(void)
{
    static const struct {
        const char *name;
        uint32_t count, seed;
        uint64_t hash;
    } golden[] = { { "torus", 32, 0, 0x329024bffa60a7a5 },    { "torus", 5568, 0, 0x0d182ff18b594f81 },
                   { "torus", 61358, 0, 0x610bb4aa31c665c6 }, { "liver", 50332, 0, 0xbfd12ca848658694 },
                   { "liver", 1000, 7, 0x67e3d558a1de045b },  { "stomach", 1619, 0, 0x8661e043e98661b3 },
                   { "spleen", 1076, 0, 0x46b4137f2133f692 }, { "membrane", 512, 0, 0xbeabc36fe680d125 },
                   { "cloth", 2048, 0, 0x963a63d6ea3cfb74 },  { "cloth", 2048, 7, 0x4f0b3fb76ff1cc5d },
                   { "star", 20480, 0, 0x7809cb561d9b5855 },  { "star", 20480, 7, 0x5469c87c207a0b6f },
                   { "sphere", 5000, 0, 0x9df55c8072c5683b }, { "box", 1200, 0, 0x3449541ffbbd4e90 },
                   { "hub", 50000, 0, 0x174ce5597f860aa2 },   { "wall", 1024, 0, 0xadccf9052efb3655 } };
    for (size_t i = 0; i < sizeof golden / sizeof *golden; i++) {
        struct shape shape = build(golden[i].name, golden[i].count, golden[i].seed);
        CHECK(hash_of(&shape) == golden[i].hash, "{ \"%s\", %u, %u, 0x%016llx },", golden[i].name, golden[i].count,
              golden[i].seed, (unsigned long long)hash_of(&shape));
        shape_free(&shape);
    }
}

static void sine_and_cosine_are_right(void)
{
    uint64_t state = 1;
    for (int i = 0; i < 100000; i++) {
        double turns = random_in(&state, -1.0, 1.0), sine, cosine;
        turn_sincos(turns, &sine, &cosine);
        CHECK(fabs(sine - sin(6.283185307179586 * turns)) < 1.5e-15, "%.17g", turns);
        CHECK(fabs(cosine - cos(6.283185307179586 * turns)) < 1.5e-15, "%.17g", turns);
        CHECK(fabs(sine * sine + cosine * cosine - 1.0) < 5e-16, "%.17g", turns);
    }
    for (int quarter = -8; quarter <= 8; quarter++) {
        double sine, cosine;
        turn_sincos(0.25 * quarter, &sine, &cosine);
        CHECK(fabs(sine) + fabs(cosine) == 1.0, "%d quarters: %g %g", quarter, sine, cosine);
    }
}

static void bad_usage_has_a_reason(void)
{
    static const struct {
        const char *name;
        uint64_t count;
        const char *says;
    } cases[] = { { "torus", 5569, "even" },
                  { "torus", 30, "from 32" },
                  { "torus", 0, "needs" },
                  { "sphere", 0, "needs" },
                  { "hub", 0, "needs" },
                  { "hub", 2, "from 3" },
                  { "liver", 50333, "even" },
                  { "liver", 100, "from 200" },
                  { "spleen", 10001, "even" },
                  { "star", 1999, "from 2000" },
                  { "membrane", 500, "2 k^2" },
                  { "cloth", 2047, "2 k^2" },
                  { "box", 14, "12 k^2" },
                  { "wall", 100, "64 k" },
                  { "torus", 10000002, "to 10000000" },
                  { "torus", UINT64_MAX - 1, "to " },
                  { "banana", 100, "no shape 'banana'" },
                  { "", 100, "no shape ''" },
                  { "laparoscopic", 5387, "no shape" } };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct shape shape;
        shape_reason reason = "";
        int failed = shape_make(cases[i].name, cases[i].count, 0, &shape, reason);
        CHECK(failed && strstr(reason, cases[i].says), "%s: '%s'", cases[i].name, reason);
        CHECK(!shape.vertices && !shape.corners && !shape.triangle_count, "%s", cases[i].name);
    }
    struct shape bodies[LAPAROSCOPIC_BODIES];
    shape_reason reason = "";
    CHECK(shape_make_laparoscopic(999, 0, bodies, reason) && strstr(reason, "from 1000"), "%s", reason);
}

int main(void)
{
    TEST(closed_shapes_are_manifold_and_outward);
    TEST(every_even_count_can_be_had);
    TEST(open_shapes_have_one_border);
    TEST(torus_lies_on_its_surface);
    TEST(torus_goes_to_a_million);
    TEST(shapes_have_their_size);
    TEST(sheets_face_up);
    TEST(star_has_48_spikes);
    TEST(passing_edges_are_seen);
    TEST(laparoscopic_bodies_stand_apart);
    TEST(shapes_have_the_same_bits_everywhere);
    TEST(sine_and_cosine_are_right);
    TEST(bad_usage_has_a_reason);
    return check_report();
}
