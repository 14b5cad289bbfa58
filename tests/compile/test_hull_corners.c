/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Corners for many points. Oracle: the support of both sets in many directions; a hull with a radius holds points if it
 * reaches as far in each. It cannot judge what lies between the directions.
 *
 *     test_hull_corners [PER CENT of the random cases = 100]
 */
#include "dynpoint/compile.h"
#include "lib/check.h"
#include "lib/pose.h"
#include "lib/public_meshes.h"
#include "lib/solid.h"

enum { CAPACITY = DPT_HULL_CORNERS_MAX, DIRECTIONS = 3000 };

static double support(const double *points, size_t count, const double n[3])
{
    double most = -1e300;
    for (size_t i = 0; i < count; i++)
        most = fmax(most, points[3 * i] * n[0] + points[3 * i + 1] * n[1] + points[3 * i + 2] * n[2]);
    return most;
}

struct made {
    double corners[3 * CAPACITY], radius;
    uint32_t count;
};

/*
 * It holds the points; what it is larger by is reached where its radius says; and a hull can be made of it.
 *   thick   how far a corner may be from all points
 */
static struct made expect_hull(const char *name, const double *points, size_t count, uint32_t capacity, double size,
                               double thick)
{
    struct made made = { .count = 0 };
    uint64_t seed = 5, block[2048];
    double beyond = -1e300;
    const dpt_result result = dpt_compile_hull(points, count, made.corners, capacity, &made.count, &made.radius);
    CHECK(result == DPT_OK && made.count >= 3 && made.count <= capacity, "%s: %s, %u corners", name,
          dpt_result_name(result), made.count);
    for (int i = 0; i < DIRECTIONS; i++) {
        double n[3] = { random_in(&seed, -1, 1), random_in(&seed, -1, 1), random_in(&seed, -1, 1) };
        if (unit3(n) > 0)
            beyond = fmax(beyond, support(points, count, n) - support(made.corners, made.count, n));
    }
    CHECK(beyond <= made.radius + 2e-8 * size, "%s: a point is %g beyond, more than %g", name, beyond, made.radius);
    CHECK(made.radius == 0 || beyond > 0.2 * made.radius, "%s: %g beyond, and a radius of %g", name, beyond,
          made.radius);
    for (uint32_t c = 0; c < made.count; c++) {
        double least = 1e300;
        for (size_t i = 0; i < count; i++)
            least = fmin(least, apart(points + 3 * i, made.corners + 3 * c));
        CHECK(least == 0 || least <= thick, "%s: corner %u is %g from all points", name, c, least);
    }
    const dpt_hull_def def = {
        .size = sizeof def, .corner_count = made.count, .corners = made.corners, .radius = made.radius
    };
    const dpt_hull *hull;
    dpt_hull_info info = { .size = sizeof info };
    CHECK(dpt_hull_create(block, sizeof block, &def, &hull) == DPT_OK && dpt_hull_get_info(hull, &info) == DPT_OK &&
              info.corners == made.count,
          "%s: no hull of it, or one of %u corners", name, info.corners);
    return made;
}

/* A box's corners among many points inside and on it: these eight, and no radius. */
static void a_box_has_eight_corners(void)
{
    uint64_t seed = 3;
    enum { POINTS = 3000 };
    static double points[3 * POINTS];
    for (uint64_t round = 0; round < part_of(20); round++) {
        double turn[4], x[3];
        random_turn(&seed, turn);
        for (int i = 0; i < POINTS; i++) {
            for (int k = 0; k < 3; k++)
                x[k] = i % 97 == 0 && i / 97 < 8 ? ((i / 97) >> k & 1 ? 0.02 : -0.01) * (k + 1)
                                                 : random_in(&seed, -0.01, 0.02) * (k + 1);
            if (i % 5 == 1 && i % 97)
                x[i % 3] = -0.01 * (i % 3 + 1); /* on a face */
            turn3(turn, x, points + 3 * i);
        }
        const struct made made = expect_hull("box", points, POINTS, CAPACITY, 0.1, 0);
        CHECK(made.count == 8 && made.radius == 0, "%u corners, radius %g", made.count, made.radius);
    }
}

static void round_things_get_a_radius(void)
{
    uint64_t seed = 8;
    enum { POINTS = 5000 };
    static double points[3 * POINTS];
    for (int i = 0; i < POINTS; i++) {
        double n[3] = { random_in(&seed, -1, 1), random_in(&seed, -1, 1), random_in(&seed, -1, 1) };
        unit3(n);
        for (int k = 0; k < 3; k++)
            points[3 * i + k] = 0.05 * n[k];
    }
    double last = 1;
    for (uint32_t capacity = 4; capacity <= CAPACITY; capacity *= 2) {
        const struct made made = expect_hull("ball", points, POINTS, capacity, 0.1, 0);
        CHECK(made.count == capacity && made.radius > 0 && made.radius < last, "%u corners: a radius of %g, before %g",
              made.count, made.radius, last);
        last = made.radius;
    }
    CHECK(last < 0.1 * 0.05, "64 corners of a ball leave %g", last);
}

static void flat_and_thin_ones(void)
{
    uint64_t seed = 4;
    enum { POINTS = 400 };
    static double points[3 * POINTS];
    static const double heights[] = { 0, 1e-12, 1e-9, 1e-7, 1e-6, 1e-5, 1e-4, 2e-4, 1e-3 };
    for (size_t h = 0; h < sizeof heights / sizeof *heights; h++)
        for (uint64_t round = 0; round < part_of(10); round++) {
            double turn[4], x[3];
            random_turn(&seed, turn);
            for (int i = 0; i < POINTS; i++) {
                for (int k = 0; k < 3; k++)
                    x[k] = random_in(&seed, -0.1, 0.1) * (k == 2 ? heights[h] / 0.1 : 1);
                turn3(turn, x, points + 3 * i);
            }
            expect_hull("flat", points, POINTS, CAPACITY, 0.3, 6 * heights[h] + 1e-15);
        }
}

static void meshes(void)
{
    static const char *const names[] = { "liver", "torus", "star", "stomach" };
    for (size_t s = 0; s < sizeof names / sizeof *names; s++) {
        struct solid solid;
        if (!solid_from_shape(&solid, names[s], 5000))
            continue;
        const size_t count = 3 * (size_t)solid.info.triangles;
        double *points = malloc(3 * count * sizeof *points);
        for (size_t i = 0; i < 3 * count; i++)
            points[i] = solid.corners[i];
        const struct made made = expect_hull(names[s], points, count, CAPACITY, 0.4, 0);
        CHECK(made.radius < 0.02, "%s: a radius of %g", names[s], made.radius);
        free(points);
        solid_close(&solid);
    }
}

static void what_is_none_is_refused(void)
{
    double line[30], corners[3 * CAPACITY], radius;
    uint32_t count;
    for (int i = 0; i < 10; i++)
        for (int k = 0; k < 3; k++)
            line[3 * i + k] = 0.1 * i * (k + 1);
    CHECK(dpt_compile_hull(line, 10, corners, CAPACITY, &count, &radius) == DPT_E_ARGUMENT, "a line");
    for (int i = 0; i < 30; i++)
        line[i] = 0.25;
    CHECK(dpt_compile_hull(line, 10, corners, CAPACITY, &count, &radius) == DPT_E_ARGUMENT, "a point");
    for (int i = 0; i < 30; i++)
        line[i] = i * i % 7;
    CHECK(dpt_compile_hull(line, 10, corners, CAPACITY, &count, &radius) == DPT_OK, "ten points");
    CHECK(dpt_compile_hull(NULL, 10, corners, CAPACITY, &count, &radius) == DPT_E_ARGUMENT &&
              dpt_compile_hull(line, UINT32_MAX - 1, corners, CAPACITY, &count, &radius) == DPT_E_ARGUMENT &&
              dpt_compile_hull(line, SIZE_MAX, corners, CAPACITY, &count, &radius) == DPT_E_ARGUMENT &&
              dpt_compile_hull(line, 2, corners, CAPACITY, &count, &radius) == DPT_E_ARGUMENT &&
              dpt_compile_hull(line, 10, NULL, CAPACITY, &count, &radius) == DPT_E_ARGUMENT &&
              dpt_compile_hull(line, 10, corners, 3, &count, &radius) == DPT_E_ARGUMENT &&
              dpt_compile_hull(line, 10, corners, 65, &count, &radius) == DPT_E_ARGUMENT &&
              dpt_compile_hull(line, 10, corners, CAPACITY, NULL, &radius) == DPT_E_ARGUMENT &&
              dpt_compile_hull(line, 10, corners, CAPACITY, &count, NULL) == DPT_E_ARGUMENT,
          "arguments");
    line[7] = NAN;
    CHECK(dpt_compile_hull(line, 10, corners, CAPACITY, &count, &radius) == DPT_E_FINITE, "no number");
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(a_box_has_eight_corners);
    TEST(round_things_get_a_radius);
    TEST(flat_and_thin_ones);
    TEST(meshes);
    TEST(what_is_none_is_refused);
    return check_report();
}
