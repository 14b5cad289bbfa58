/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The sweep against exact arithmetic (oracle/exact.h): no touch of an axis and a triangle is
 * missed, none comes late, and where one is told that is none, the axis is within the tolerance at
 * that time. On whole numbers, so that touches in one point at one instant do occur, and on their
 * neighbours in double.
 *
 * Usage: test_sweep_exact [cases of a family = 1200] [seed = 1]. Built where g++ and gmpxx are.
 */
#include "oracle/exact.h"
#include "oracle/pair.h"
#include "sweep/sweep_scene.h"

static unsigned long case_count = 1200;
static uint64_t rng = 1;

static const struct scene_family families[] = {
    { "lattice", make_lattice, LATTICE_ANY },
    { "lattice, in one plane", make_lattice, LATTICE_FLAT },
    { "lattice, shift", make_lattice, LATTICE_SHIFT },
    { "lattice, point", make_lattice, LATTICE_POINT },
    { "lattice, rest", make_lattice, LATTICE_REST },
    { "lattice, needle", make_lattice, LATTICE_NEEDLE },
    SCENE_MEETINGS(make_meeting),
    SCENE_MEETINGS(make_grazing),
    { "any", make_any, ANY },
    { "any, sliver", make_any, SLIVER },
    { "any, slide", make_any, SLIDE },
    { "any, beside", make_any, BESIDE },
    { "any, far", make_any, FAR },
    { "any, tiny", make_any, TINY },
};

static int touches(const struct scene *scene, double until, int closed)
{
    const struct motion *m = &scene->motion;
    double v[9], p[4][3];
    for (int k = 0; k < 3; k++)
        vec3_store(scene->corner[k], v + 3 * k);
    vec3_store(m->a, p[0]);
    vec3_store(m->b, p[1]);
    vec3_store(m->da, p[2]);
    vec3_store(m->db, p[3]);
    return exact_touch(p[0], p[1], p[2], p[3], v, until, closed);
}

/* From ends that are rounded: off by less than a unit of the extent. */
static double distance_at(const struct scene *scene, double time)
{
    double segment[6], v[9];
    vec3_store(along(scene->motion.a, time, scene->motion.da), segment);
    vec3_store(along(scene->motion.b, time, scene->motion.db), segment + 3);
    for (int k = 0; k < 3; k++)
        vec3_store(scene->corner[k], v + 3 * k);
    return (double)oracle_pair(segment, v);
}

struct counts {
    unsigned long touch, missed, late, invented, wrong;
    uint32_t most;
};

static void judge(const struct scene *scene, const char *name, struct counts *counts)
{
    struct sweep sweep;
    double extent = scene_extent(scene), tolerance = any_tolerance(&rng, scene), time = -1.0;
    uint32_t asked = 0;
    dpti_sweep_begin(&sweep, &scene->motion, 0.0, tolerance, extent);
    const struct moving_triangle triangle = triangle_at_rest(scene->corner);
    int hit = dpti_sweep_triangle(&sweep, &triangle, 1.0, &time, &asked) == SWEEP_HIT;
    int truth = touches(scene, 1.0, 1);
    int missed = truth && !hit, late = hit && touches(scene, time, time > 0.0);
    double off = hit ? distance_at(scene, time) : 0.0;
    CHECK(!missed, "%s: missed: %s", name, scene_text(scene));
    CHECK(!late, "%s: at %a, late: %s", name, time, scene_text(scene));
    CHECK(off <= tolerance, "%s: %g off at %a: %s", name, off, time, scene_text(scene));
    counts->touch += truth != 0;
    counts->missed += missed != 0;
    counts->late += late != 0;
    counts->invented += hit && !truth;
    counts->wrong += off > tolerance;
    counts->most = asked > counts->most ? asked : counts->most;
}

static void agrees_with_exact_arithmetic(void)
{
    printf("    %-24s %8s %8s %8s %8s %8s %8s\n", "family", "touch", "not", "missed", "late", "invented", "asked");
    for (size_t f = 0; f < sizeof families / sizeof *families; f++) {
        struct counts counts = { 0, 0, 0, 0, 0, 0 };
        for (unsigned long i = 0; i < case_count; i++) {
            struct scene scene;
            families[f].make(&rng, families[f].kind, &scene);
            judge(&scene, families[f].name, &counts);
        }
        printf("    %-24s %8lu %8lu %8lu %8lu %8lu %8u\n", families[f].name, counts.touch, case_count - counts.touch,
               counts.missed, counts.late, counts.invented, counts.most);
    }
}

/* The oracle itself: what can be seen without arithmetic. */
static void the_oracle_knows_simple_cases(void)
{
    static const struct {
        double a[3], b[3], da[3], db[3];
        double until;
        int closed, answer;
    } c[] = {
        { { 1, 1, 2 }, { 1, 1, 3 }, { 0, 0, -2 }, { 0, 0, -2 }, 1.0, 1, 1 }, /* just arrives */
        { { 1, 1, 2 }, { 1, 1, 3 }, { 0, 0, -2 }, { 0, 0, -2 }, 1.0, 0, 0 },
        { { 5, 1, 2 }, { 5, 1, 3 }, { 0, 0, -9 }, { 0, 0, -9 }, 1.0, 1, 0 },  /* beside */
        { { -1, -1, 0 }, { -1, 5, 0 }, { 1, 0, 0 }, { 1, 0, 0 }, 1.0, 1, 1 }, /* in the plane */
        { { -1, -1, 0 }, { -1, 5, 0 }, { 1, 0, 0 }, { 1, 0, 0 }, 1.0, 0, 0 },
        { { 0, -1, 1 }, { 0, 1, -1 }, { 0, 0, 0 }, { 0, 0, 0 }, 1.0, 0, 1 },  /* at rest, at a corner */
        { { 1, -1, 1 }, { 1, -1, -1 }, { 0, 2, 0 }, { 0, 2, 0 }, 0.5, 1, 1 }, /* over an edge */
        { { 1, -1, 1 }, { 1, -1, -1 }, { 0, 2, 0 }, { 0, 2, 0 }, 0.5, 0, 0 },
        { { 4, 4, 1 }, { 4, 4, -1 }, { -2, -2, 0 }, { -2, -2, 0 }, 1.0, 1, 1 },
        { { 4, 4, 1 }, { 4, 4, -1 }, { -2, -2, 0 }, { -2, -2, 0 }, 0.99, 1, 0 },
    };
    const double triangle[9] = { 0, 0, 0, 4, 0, 0, 0, 4, 0 };
    for (size_t i = 0; i < sizeof c / sizeof *c; i++) {
        int answer = exact_touch(c[i].a, c[i].b, c[i].da, c[i].db, triangle, c[i].until, c[i].closed);
        CHECK(answer == c[i].answer, "case %zu: %d", i, answer);
    }
}

int main(int argc, char **argv)
{
    take_count(argc, argv, &case_count, &rng);
    TEST(the_oracle_knows_simple_cases);
    TEST(agrees_with_exact_arithmetic);
    return check_report();
}
