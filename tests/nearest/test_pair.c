/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * dpt_segment_triangle against the oracles of oracle/pair.h, on families of pairs that have gone
 * wrong in someone's code: slivers, parallels, touches, degenerate shapes, far and tiny and mixed
 * scales. Errors are in units of 2^-53 of the largest |coordinate|; the documented bound is 32. The
 * table names the worst of each family. On every hundredth pair the long double oracle is itself
 * held to a bracket in 113 bits, and the brute-force oracle of oracle/brute.h is held to it on
 * small meshes.
 *
 * Usage: test_pair [pairs = 1000000] [seed = 1]. Links oracle/pair.c and oracle/brute.c.
 */
#include "dynpoint/query.h"
#include "lib/check.h"
#include "oracle/brute.h"
#include "oracle/pair.h"

#include <math.h>

#define UNIT  0x1p-53
#define BOUND 32.0

static uint64_t rng;
static unsigned long pair_count = 1000000;

/* One question, also as one list of numbers. */
union scene {
    struct {
        double seg[6], tri[9];
    };
    double all[15];
};

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))
#define NUMBERS      15

static double largest(const union scene *scene)
{
    double most = 0;
    for (int i = 0; i < NUMBERS; i++)
        most = fmax(most, fabs(scene->all[i]));
    return most;
}

/* The scene as exact numbers, to paste into a new closed form. */
static const char *text_of(const union scene *scene)
{
    static char text[1024];
    size_t length = 0;
    for (int i = 0; i < NUMBERS; i++)
        length += (size_t)snprintf(text + length, sizeof text - length, "%s%a", i ? ", " : "", scene->all[i]);
    return text;
}

static int chance(int one_in)
{
    return random_bits(&rng) % (unsigned)one_in == 0;
}

static int whole(int low, int high)
{
    return low + (int)(random_bits(&rng) % (unsigned)(high - low + 1));
}

/* 10 to a uniform power, either sign. */
static double power(double low, double high)
{
    const double size = pow(10, random_in(&rng, low, high));
    return chance(2) ? size : -size;
}

static void any(double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = random_in(&rng, -1, 1);
}

static void lattice(double out[3], int size)
{
    for (int k = 0; k < 3; k++)
        out[k] = whole(-size, size);
}

static void walk(double out[3], const double from[3], double t, const double along[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = from[k] + t * along[k];
}

static void cross(double out[3], const double a[3], const double b[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

/* A vector of about the length of `along`, perpendicular to it up to rounding. */
static void any_across(double out[3], const double along[3])
{
    double other[3];
    any(other);
    cross(out, along, other);
}

/* Families. Each fills a scene whose numbers are about 1, or small whole numbers. */

enum { POINT_SEGMENT = 1, POINT_TRIANGLE, EQUAL_CORNERS, FLOAT, ALONG };
enum { EDGE = 1, VERTEX, END, PARALLEL, GRAZING, CROSSING };

static void make_random(union scene *scene, int kind)
{
    for (int i = 0; i < NUMBERS; i++)
        scene->all[i] = random_in(&rng, -1, 1);
    const int from = whole(0, 2), over = whole(1, 2);
    if (kind == POINT_SEGMENT)
        memcpy(scene->seg + 3, scene->seg, 3 * sizeof(double));
    if (kind == POINT_TRIANGLE && chance(3))
        walk(scene->tri + 3 * from, scene->seg, random_in(&rng, 0, 1), scene->seg + 3);
    for (int i = 1; i < 3; i++)
        if (kind == POINT_TRIANGLE || (kind == EQUAL_CORNERS && i == over))
            memcpy(scene->tri + 3 * ((from + i) % 3), scene->tri + 3 * from, 3 * sizeof(double));
}

/* Exactly on a line: every number is a small multiple of 1/8. */
static void make_collinear(union scene *scene, int kind)
{
    double along[3];
    make_random(scene, kind);
    lattice(scene->tri, 8);
    lattice(along, 8);
    walk(scene->tri + 3, scene->tri, whole(-16, 16) / 8.0, along);
    walk(scene->tri + 6, scene->tri, whole(-16, 16) / 8.0, along);
    if (chance(2))
        lattice(scene->seg, 8);
}

/* A segment in this direction through a point about `off` away from some point of the triangle. */
static void aim(union scene *scene, double off, const double along[3])
{
    double shift[3], point[3], u = random_in(&rng, 0, 1), v = random_in(&rng, 0, 1 - u);
    if (chance(4))
        v = 0;
    any(shift);
    for (int k = 0; k < 3; k++)
        point[k] = (1 - u - v) * scene->tri[k] + u * scene->tri[3 + k] + v * scene->tri[6 + k];
    walk(point, point, off, shift);
    walk(scene->seg, point, chance(6) ? 0 : -random_in(&rng, -0.2, 1), along);
    walk(scene->seg + 3, point, random_in(&rng, 0, 1), along);
}

/* Thin, or with one short edge; ALONG: and the segment along it, by two small angles. */
static void make_sliver(union scene *scene, int kind)
{
    double edge[3], across[3], along[3];
    any(scene->tri);
    any(edge);
    any_across(across, edge);
    walk(scene->tri + 3, scene->tri, 1, edge);
    walk(scene->tri + 6, scene->tri, chance(3) ? whole(0, 1) : random_in(&rng, -0.2, 1.2), edge);
    walk(scene->tri + 6, scene->tri + 6, power(-15, -2), across);
    any(along);
    if (kind == ALONG) {
        any_across(across, edge);
        walk(along, edge, power(-16, -1), across);
        walk(across, scene->tri + 6, -1, scene->tri);
        walk(along, along, power(-16, 0), across);
    }
    aim(scene, power(-17, 0), along);
    if (kind == FLOAT || (kind == ALONG && chance(2)))
        for (int i = 0; i < 9; i++)
            scene->tri[i] = (double)(float)scene->tri[i];
}

static void make_parallel_edge(union scene *scene, int kind)
{
    double edge[3], across[3];
    make_random(scene, kind);
    walk(edge, scene->tri + 3, -1, scene->tri);
    any_across(across, edge);
    walk(edge, edge, chance(4) ? 0 : power(-16, -1), across);
    walk(scene->seg, scene->tri, power(-17, 0), across);
    walk(scene->seg, scene->seg, random_in(&rng, -1, 1), edge);
    walk(scene->seg + 3, scene->seg, random_in(&rng, -2, 2), edge);
}

/*
 * PARALLEL: at a height above the plane and an angle to it, both down to nothing. GRAZING: through
 * the face or past it, at an angle down to 1e-16, near to an edge or not. CROSSING: at any angle.
 */
static void make_to_plane(union scene *scene, int kind)
{
    double e[3], f[3], along[3], normal[3];
    make_random(scene, kind);
    walk(e, scene->tri + 3, -1, scene->tri);
    walk(f, scene->tri + 6, -1, scene->tri);
    cross(normal, e, f);
    any_across(along, normal);
    walk(along, along, kind == PARALLEL && chance(4) ? 0 : power(-16, -1), normal);
    if (kind == CROSSING)
        any(along);
    aim(scene, kind != GRAZING || chance(2) ? 0 : power(-17, -3), along);
    const double height = kind == PARALLEL ? power(-17, 0) : 0;
    walk(scene->seg, scene->seg, height, normal);
    walk(scene->seg + 3, scene->seg + 3, height, normal);
}

/* All in one plane exactly, of small whole numbers; the segment shifted by `shift` or more. */
static void make_coplanar(union scene *scene, int shift)
{
    double e[3], f[3];
    const double by = shift + shift * whole(1, 64) / 64.0;
    lattice(e, 4);
    lattice(f, 4);
    if (chance(2))
        e[0] = f[0] = 0;
    for (int i = 0; i < 5; i++) {
        double *point = scene->all + 3 * i;
        walk(point, (const double[3]){ 1, 2, 3 }, whole(-64, 64) / 32.0 + (i < 2 ? by : 0), e);
        walk(point, point, whole(-64, 64) / 32.0, f);
    }
}

/* A triangle of whole numbers, and A and B on a line through V0 + (i e + j f)/16, all exact. */
static void make_exact(union scene *scene, int kind)
{
    double e[3], f[3], along[3], point[3];
    const int i = kind == VERTEX ? 0 : whole(0, 16), j = kind == END ? whole(0, 16 - i) : 0;
    lattice(along, 32);
    for (int c = 0; c < 3; c++)
        lattice(scene->tri + 3 * c, 32);
    walk(e, scene->tri + 3, -1, scene->tri);
    walk(f, scene->tri + 6, -1, scene->tri);
    walk(point, scene->tri, i / 16.0, e);
    walk(point, point, j / 16.0, f);
    walk(scene->seg, point, kind == END ? 0 : -whole(1, 32) / 16.0, along);
    walk(scene->seg + 3, point, whole(1, 32) / 16.0, along);
}

/* An end close to, or exactly on, a corner or an edge, or the segment passing it closely. */
static void make_near_touch(union scene *scene, int kind)
{
    double edge[3], away[3];
    make_random(scene, kind);
    walk(edge, scene->tri + 3, -1, scene->tri);
    any_across(away, edge);
    if (chance(2))
        any(away);
    walk(scene->seg, scene->tri, chance(3) ? 0 : random_in(&rng, 0, 1), edge);
    walk(scene->seg, scene->seg, chance(4) ? 0 : power(-17, -1), away);
    if (chance(3))
        walk(scene->seg, scene->seg, random_in(&rng, -1, 0), scene->seg + 3);
}

static void make_mixed(union scene *scene, int kind)
{
    const int one_size = chance(2);
    double size = 1;
    make_random(scene, kind);
    for (int i = 0; i < NUMBERS; i++) {
        if (!one_size || i % 3 == 0)
            size = power(-6, 0);
        scene->all[i] *= size;
    }
}

/* Which corner is named first must not matter, so it is turned at random. */
static void turn_corners(union scene *scene)
{
    const union scene made = *scene;
    const int by = whole(0, 2);
    for (int i = 0; i < 9; i++)
        scene->tri[i] = made.tri[(i + 3 * by) % 9];
}

/* What a family measured. */
struct row {
    const char *name;
    void (*make)(union scene *, int kind);
    int kind;
    unsigned long pairs, zeros;
    double worst;
};

static struct row families[] = {
    { "random", make_random, 0, 0, 0, 0 },
    { "point-like segment", make_random, POINT_SEGMENT, 0, 0, 0 },
    { "point-like triangle", make_random, POINT_TRIANGLE, 0, 0, 0 },
    { "two equal corners", make_random, EQUAL_CORNERS, 0, 0, 0 },
    { "collinear corners", make_collinear, 0, 0, 0, 0 },
    { "sliver, doubles", make_sliver, 0, 0, 0, 0 },
    { "sliver, floats", make_sliver, FLOAT, 0, 0, 0 },
    { "along a sliver", make_sliver, ALONG, 0, 0, 0 },
    { "parallel to an edge", make_parallel_edge, 0, 0, 0, 0 },
    { "parallel to the plane", make_to_plane, PARALLEL, 0, 0, 0 },
    { "coplanar, overlapping", make_coplanar, 0, 0, 0, 0 },
    { "coplanar, apart", make_coplanar, 4, 0, 0, 0 },
    { "through the face", make_to_plane, CROSSING, 0, 0, 0 },
    { "exactly through an edge", make_exact, EDGE, 0, 0, 0 },
    { "exactly through a vertex", make_exact, VERTEX, 0, 0, 0 },
    { "ends exactly on the face", make_exact, END, 0, 0, 0 },
    { "grazing", make_to_plane, GRAZING, 0, 0, 0 },
    { "near touch", make_near_touch, 0, 0, 0, 0 },
    { "mixed magnitudes", make_mixed, 0, 0, 0, 0 },
};

static struct row placings[] = {
    { .name = "as made" }, { .name = "far from the origin" }, { .name = "small" }, { .name = "large" }
};

/* Half the scenes stay as they are made, since an offset hides what is small in them. */
static struct row *place(union scene *scene)
{
    const int which = whole(0, 5);
    if (which == 3) {
        double offset[3] = { power(0, 5.9), power(0, 5.9), power(0, 5.9) };
        for (int i = 0; i < NUMBERS; i++)
            scene->all[i] += offset[i % 3];
    } else if (which > 3) {
        const double factor = which == 4 ? power(-6, -3) : power(3, 6) / fmax(largest(scene), 1);
        for (int i = 0; i < NUMBERS; i++)
            scene->all[i] *= factor;
    }
    return &placings[which < 3 ? 0 : which - 2];
}

static void record(struct row *row, double distance, double error)
{
    row->pairs++;
    row->zeros += distance == 0;
    if (!(error <= row->worst))
        row->worst = error;
}

static double ask(const union scene *scene)
{
    return dpt_segment_triangle(scene->seg, scene->tri, NULL, NULL, NULL);
}

static void swap_points(double *a, double *b)
{
    double keep[3];
    memcpy(keep, a, sizeof keep);
    memcpy(a, b, sizeof keep);
    memcpy(b, keep, sizeof keep);
}

static double apart(const double a[3], const double b[3])
{
    return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

/* The answer's parts agree with each other and with the question. Returns the distance. */
static double check_answer(const union scene *scene, double bound)
{
    double s = -1, p[3], q[3];
    const double distance = dpt_segment_triangle(scene->seg, scene->tri, &s, p, q);
    CHECK(s >= 0 && s <= 1, "s = %a for %s", s, text_of(scene));
    const double most = largest(scene), ulp = nextafter(most, INFINITY) - most;
    long double off = 0;
    for (int k = 0; k < 3; k++) {
        const long double a = scene->seg[k], b = scene->seg[3 + k];
        off = fmaxl(off, fabsl(a + (long double)s * (b - a) - p[k]));
    }
    CHECK(off <= 4 * (long double)ulp, "p is %Lg ulp off A + s(B - A) for %s", off / ulp, text_of(scene));
    const long double outside = oracle_point(q, scene->tri);
    CHECK(outside <= bound, "q is %Lg units off the triangle for %s", outside / (most * UNIT), text_of(scene));
    CHECK(fabs(apart(p, q) - distance) <= bound, "|p - q| = %a, distance %a for %s", apart(p, q), distance,
          text_of(scene));
    CHECK(distance != 0 || !memcmp(p, q, sizeof p), "distance 0 and p != q for %s", text_of(scene));
    CHECK(ask(scene) == distance, "another distance without outputs for %s", text_of(scene));
    return distance;
}

static void check_symmetry(const union scene *scene, double distance, double bound)
{
    union scene other = *scene;
    swap_points(other.seg, other.seg + 3);
    CHECK(fabs(ask(&other) - distance) <= bound, "A and B swapped: %a, not %a, for %s", ask(&other), distance,
          text_of(scene));
    other = *scene;
    for (int turn = 0; turn < 5; turn++) {
        swap_points(other.tri, other.tri + 3 * (1 + turn % 2));
        CHECK(fabs(ask(&other) - distance) <= bound, "corners permuted: %a, not %a, for %s", ask(&other), distance,
              text_of(scene));
    }
}

/* No point of either shape moves farther than the ends and corners do. */
static void check_continuity(const union scene *scene, double distance, double most)
{
    union scene moved = *scene;
    double farthest[2] = { 0, 0 };
    const double step = most * power(-16, -1);
    for (int i = 0; i < NUMBERS; i++)
        moved.all[i] += step * random_in(&rng, -1, 1);
    for (int i = 0; i < 5; i++)
        farthest[i >= 2] = fmax(farthest[i >= 2], apart(moved.all + 3 * i, scene->all + 3 * i));
    const double allowed = (farthest[0] + farthest[1]) * (1 + 1e-12) + BOUND * UNIT * (most + largest(&moved));
    CHECK(fabs(ask(&moved) - distance) <= allowed, "moved: %a, not %a within %g, for %s", ask(&moved), distance,
          allowed, text_of(scene));
}

static double widest_bracket, worst_oracle;

/* The long double oracle lies within the bracket, and the bracket is narrow. */
static void check_oracle(const union scene *scene, long double truth, double most)
{
    oracle_wide lower, upper;
    oracle_bracket(scene->seg, scene->tri, &lower, &upper);
    const double width = (double)(upper - lower) / most;
    const oracle_wide below = lower - truth, above = truth - upper;
    const double off = (double)(below > above ? below : above) / (most * UNIT);
    CHECK(width >= -0x1p-100 && width < 1e-16, "bracket %g wide for %s", width, text_of(scene));
    CHECK(off < 0.02, "oracle off by %g units for %s", off, text_of(scene));
    widest_bracket = fmax(widest_bracket, width);
    worst_oracle = fmax(worst_oracle, off);
}

static void print_rows(const char *title, const struct row *row, size_t count)
{
    printf("    %-26s %9s %9s %8s\n", title, "pairs", "at 0", "worst");
    for (; count-- > 0; row++)
        printf("    %-26s %9lu %9lu %8.2f\n", row->name, row->pairs, row->zeros, row->worst);
}

static void agrees_with_the_oracle(void)
{
    for (unsigned long i = 0; i < pair_count; i++) {
        struct row *family = &families[i % COUNT(families)];
        union scene scene;
        family->make(&scene, family->kind);
        turn_corners(&scene);
        struct row *placing = place(&scene);
        const double most = largest(&scene), bound = BOUND * UNIT * most;
        const long double truth = oracle_pair(scene.seg, scene.tri);
        const double distance = check_answer(&scene, bound);
        const double error = (double)(fabsl(distance - truth) / fmax(most, DBL_MIN) / UNIT);
        CHECK(error <= BOUND, "%s: %a, not %La: %.3g units, for %s", family->name, distance, truth, error,
              text_of(&scene));
        record(family, distance, error);
        record(placing, distance, error);
        check_symmetry(&scene, distance, bound);
        check_continuity(&scene, distance, most);
        if (ORACLE_BRACKET_JUDGES && i % 100 == i / 100 % 100 && most > 0)
            check_oracle(&scene, truth, most);
    }
    print_rows("family", families, COUNT(families));
    print_rows("placing", placings, COUNT(placings));
    printf("    oracle: at worst %.2g units outside the bracket, which is at most %.2g wide\n", worst_oracle,
           widest_bracket);
}

/* Cases that can be worked out by hand. */
#define RIGHT 0, 0, 0, 4, 0, 0, 0, 4, 0
static void gives_closed_forms(void)
{
    static const struct {
        const char *what;
        double distance;
        union scene scene;
    } cases[] = {
        { "end above the face", 2, { { { 1, 1, 2, 1, 1, 5 }, { RIGHT } } } },
        { "through the face", 0, { { { 1, 1, -2, 1, 1, 5 }, { RIGHT } } } },
        { "parallel above", 3, { { { -9, 1, 3, 9, 1, 3 }, { RIGHT } } } },
        { "end before an edge", 5, { { { 1, -3, 4, 1, -9, 9 }, { RIGHT } } } },
        { "end before a vertex", 7, { { { -2, -3, 6, -4, -9, 9 }, { RIGHT } } } },
        { "skew to an edge", 3, { { { 1, -3, -1, 1, -3, 1 }, { RIGHT } } } },
        { "skew to the long edge", 3 * M_SQRT1_2, { { { 3, 4, -5, 3, 4, 5 }, { RIGHT } } } },
        { "coplanar, inside", 0, { { { 1, 1, 0, 1.5, 1, 0 }, { RIGHT } } } },
        { "coplanar, beside", 1, { { { -1, 1, 0, -3, 2, 0 }, { RIGHT } } } },
        { "ends on a vertex", 0, { { { 4, 0, 0, 5, 6, 7 }, { RIGHT } } } },
        { "tilted", 2 / 1.7320508075688772, { { { 1, 1, 1, 2, 2, 2 }, { 1, 0, 0, 0, 1, 0, 0, 0, 1 } } } },
        { "two points", 3, { { { 1, 2, 3, 1, 2, 3 }, { 2, 4, 5, 2, 4, 5, 2, 4, 5 } } } },
        { "two lines", 1, { { { 0, 0, 1, 2, 2, 1 }, { 0, 2, 0, 1, 1, 0, 2, 0, 0 } } } },
        { "end to end", 2, { { { 0, 0, 0, 1, 0, 0 }, { 3, 0, 0, 4, 0, 0, 9, 0, 0 } } } },
        { "all at the origin", 0, { { { 0 }, { 0 } } } },
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        const union scene *scene = &cases[i].scene;
        const double bound = BOUND * UNIT * largest(scene);
        const double distance = check_answer(scene, bound);
        const long double oracle = oracle_pair(scene->seg, scene->tri);
        CHECK(fabs(distance - cases[i].distance) <= bound, "%s: %a, not %a", cases[i].what, distance,
              cases[i].distance);
        CHECK(fabsl(oracle - cases[i].distance) <= 4 * UNIT, "oracle, %s: %La, not %a", cases[i].what, oracle,
              cases[i].distance);
        check_symmetry(scene, distance, bound);
    }
}

/* Infinity, and nothing that a caller could mistake for a point that is not a number. */
static void check_refused(const double *segment, const double *triangle)
{
    double out[7] = { 1, 2, 3, 4, 5, 6, 7 };
    const double distance = dpt_segment_triangle(segment, triangle, out, out + 1, out + 4);
    CHECK(distance == INFINITY, "%a", distance);
    CHECK(out[0] >= 0 && out[0] <= 1, "s = %a", out[0]);
    for (int i = 1; i < 7; i++)
        CHECK(isfinite(out[i]), "output %d is %a", i, out[i]);
    CHECK(dpt_segment_triangle(segment, triangle, NULL, NULL, NULL) == INFINITY, "no outputs");
}

static void refuses_bad_input(void)
{
    const double bad[] = { NAN, -NAN, INFINITY, -INFINITY };
    union scene scene;
    make_random(&scene, 0);
    check_refused(NULL, scene.tri);
    check_refused(scene.seg, NULL);
    check_refused(NULL, NULL);
    for (size_t i = 0; i < COUNT(bad); i++)
        for (int j = 0; j < NUMBERS; j++) {
            make_random(&scene, 0);
            scene.all[j] = bad[i];
            check_refused(scene.seg, scene.tri);
        }
}

/* Squares of these overflow or vanish. The bound is not claimed there, but no NaN may leave. */
static void stays_a_number_at_any_scale(void)
{
    for (int i = 0; i < 20000; i++) {
        union scene scene;
        double out[7] = { 0 };
        const struct row *family = &families[(size_t)i % COUNT(families)];
        family->make(&scene, family->kind);
        const double factor = chance(2) ? power(100, 306) : power(-320, -100);
        for (int j = 0; j < NUMBERS; j++)
            scene.all[j] *= factor;
        const double distance = dpt_segment_triangle(scene.seg, scene.tri, out, out + 1, out + 4);
        CHECK(distance >= 0, "%a for %s", distance, text_of(&scene));
        for (int j = 0; j < 7; j++)
            CHECK(!isnan(out[j]), "output %d for %s", j, text_of(&scene));
    }
}

/* On each triangle of small soups; and their least is that of a search without rejections. */
static void brute_force_agrees_with_the_oracle(void)
{
    enum { TRIANGLES = 64 };
    double worst = 0;
    for (unsigned long round = 0; round < pair_count / 2000; round++) {
        union scene scene;
        float vertices[9 * TRIANGLES];
        uint32_t corners[3 * TRIANGLES], winner = 0;
        for (uint32_t i = 0; i < TRIANGLES; i++) {
            const struct row *family = &families[(round + i) % COUNT(families)];
            family->make(&scene, family->kind);
            for (uint32_t j = 0; j < 9; j++)
                vertices[9 * i + j] = (float)(scene.tri[j] + 4 * (i % 4));
            for (uint32_t j = 0; j < 3; j++)
                corners[3 * i + j] = i % 16 == 15 ? UINT32_MAX : 3 * i + j;
        }
        oracle_mesh *mesh = oracle_brute_open(vertices, 3 * TRIANGLES, corners, TRIANGLES);
        if (!mesh)
            abort();
        const double least = oracle_brute(mesh, scene.seg, &winner);
        double nearest = INFINITY;
        for (uint32_t i = 0; i < TRIANGLES; i++) {
            const double distance = oracle_brute_triangle(mesh, i, scene.seg);
            CHECK(distance > least || (distance == least && i >= winner), "%u is nearer", i);
            nearest = fmin(nearest, distance);
            if (corners[3 * i] == UINT32_MAX)
                continue;
            for (int j = 0; j < 9; j++)
                scene.tri[j] = (double)vertices[9 * i + (uint32_t)j];
            const long double truth = oracle_pair(scene.seg, scene.tri);
            const double error = (double)fabsl(distance - truth) / largest(&scene);
            CHECK(error < 1e-14, "off by %g for %s", error, text_of(&scene));
            worst = fmax(worst, error);
        }
        CHECK(nearest == least, "%a, not %a", least, nearest);
        oracle_brute_close(mesh);
    }
    printf("    brute force: off by %.2g of the largest coordinate at worst\n", worst);
}

int main(int argc, char **argv)
{
    if (argc > 1)
        pair_count = strtoul(argv[1], NULL, 0);
    rng = argc > 2 ? strtoull(argv[2], NULL, 0) : 1;
    TEST(gives_closed_forms);
    TEST(refuses_bad_input);
    TEST(stays_a_number_at_any_scale);
    if (ORACLE_PAIR_JUDGES) {
        TEST(brute_force_agrees_with_the_oracle);
        TEST(agrees_with_the_oracle);
    } else {
        SKIP("pairs against the oracle", "long double is no wider than double here");
    }
    return check_report();
}
