/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The sweep of a segment and a triangle that both move, against exact arithmetic (oracle/moving.h): no touch is missed,
 * none comes late, and where one is told the two are within radius + tolerance. And the oracle itself, against closed
 * forms, another oracle, and its own answers at single times.
 *
 * Usage: test_sweep_moving [cases of a family = 1000] [seed = 1]. Built where g++ and gmpxx are.
 */
#include "oracle/exact.h"
#include "oracle/moving.h"
#include "oracle/pair.h"
#include "sweep/moving_scene.h"

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

static unsigned long case_count = 1000;
static uint64_t rng = 1;

static const struct moving_family families[] = {
    { "lattice", make_moving_lattice, MOVING_ANY },
    { "lattice, in one plane", make_moving_lattice, MOVING_FLAT },
    { "lattice, point", make_moving_lattice, MOVING_POINT },
    { "lattice, needle", make_moving_lattice, MOVING_NEEDLE },
    { "lattice, together", make_moving_lattice, MOVING_TOGETHER },
    { "lattice, equal", make_moving_lattice, MOVING_EQUAL },
    SCENE_MEETINGS(make_moving_instant),
    SCENE_MEETINGS(make_moving_meeting),
    { "corner, tangent", make_moving_meeting, MEET_CORNER | MEET_TANGENT },
    { "corner, end, tangent", make_moving_meeting, MEET_CORNER | MEET_END | MEET_TANGENT },
    { "edge, end, tangent", make_moving_meeting, MEET_EDGE | MEET_END | MEET_TANGENT },
    { "turns about a corner", make_moving_any, TURN_CORNER },
    { "turns about an edge", make_moving_any, TURN_EDGE },
    { "inverts", make_moving_any, INVERT },
    { "shrinks", make_moving_any, SHRINK },
    { "needle", make_moving_any, NEEDLES },
    { "in one plane", make_moving_any, IN_PLANE },
    { "point", make_moving_any, SPECK },
    { "together", make_moving_any, TOGETHER },
    { "edge first", make_moving_any, EDGE_ON },
    { "far", make_moving_any, AWAY },
    { "any", make_moving_any, LOOSE },
};

/* Triangles at rest say so where there is no radius; then their shifts are not read. */
static int sweep_scene(const struct sweep *sweep, const struct moving_scene *scene, double until, double *time,
                       uint32_t *asked)
{
    static const vec3 rest[3];
    const vec3 nothing = { NAN, NAN, NAN };
    struct moving_triangle triangle = { .is_moving = 1 };
    memcpy(triangle.corner, scene->corner, sizeof triangle.corner);
    memcpy(triangle.shift, scene->shift, sizeof triangle.shift);
    if (!memcmp(scene->shift, rest, sizeof rest) && scene->radius == 0.0) {
        triangle.is_moving = 0;
        triangle.shift[0] = triangle.shift[1] = triangle.shift[2] = nothing;
    }
    return dpti_sweep_triangle(sweep, &triangle, until, time, asked);
}

static struct moving_pair pair_of(const struct moving_scene *scene)
{
    struct moving_pair both = { .radius = scene->radius };
    vec3_store(scene->motion.a, both.a);
    vec3_store(scene->motion.b, both.b);
    vec3_store(scene->motion.da, both.da);
    vec3_store(scene->motion.db, both.db);
    for (int k = 0; k < 3; k++) {
        vec3_store(scene->corner[k], both.corner + 3 * k);
        vec3_store(scene->shift[k], both.shift + 3 * k);
    }
    return both;
}

struct tally {
    unsigned long touches, at_once, missed, late, wrong, invented;
    uint64_t asked;
    uint32_t most;
};

/* The first touch is the first one up to any time. */
static void ends_where_it_is_told(const struct sweep *sweep, const struct moving_scene *scene, const char *name,
                                  double time)
{
    double again = -1.0;
    uint32_t asked = 0;
    int hit = time >= 0.0;
    double until = hit ? time : random_in(&rng, 0.0, 1.0);
    int result = sweep_scene(sweep, scene, until, &again, &asked);
    CHECK(result == (hit ? SWEEP_HIT : SWEEP_FREE) && (!hit || again == time), "%s: up to %a: %d at %a: %s", name,
          until, result, again, moving_text(scene));
    if (hit && time > 0.0) {
        result = sweep_scene(sweep, scene, nextafter(time, 0.0), &again, &asked);
        CHECK(result == SWEEP_FREE, "%s: before %a: %d at %a: %s", name, time, result, again, moving_text(scene));
    }
}

static void judge(const struct moving_scene *scene, const char *name, struct tally *tally)
{
    struct moving_pair both = pair_of(scene);
    struct sweep sweep;
    double extent = moving_extent(scene), least = 0x1p-42 * (scene->radius + extent);
    double share = one_in(&rng, 2) ? 1e-6 : power_in(&rng, -14.0, -6.0);
    double tolerance = share * moving_size(scene), time = -1.0, low, high;
    uint32_t asked = 0;
    dpti_sweep_begin(&sweep, &scene->motion, scene->radius, tolerance, extent);
    int hit = sweep_scene(&sweep, scene, 1.0, &time, &asked) == SWEEP_HIT;
    int truth = moving_first(&both, &low, &high);
    double limit = scene->radius + max_of(tolerance, least);
    int missed = truth && !hit, late = truth && hit && time > low;
    int wrong = hit && !(time >= 0.0 && time <= 1.0 && moving_within(&both, time, limit));
    CHECK(!missed, "%s: missed at %a: %s", name, low, moving_text(scene));
    CHECK(!late, "%s: at %a, not %a: %s", name, time, low, moving_text(scene));
    CHECK(!wrong, "%s: farther than %a at %a: %s", name, limit, time, moving_text(scene));
    ends_where_it_is_told(&sweep, scene, name, hit ? time : -1.0);
    tally->touches += truth != 0;
    tally->at_once += truth && high == 0.0;
    tally->missed += missed != 0;
    tally->late += late != 0;
    tally->wrong += wrong != 0;
    tally->invented += hit && !truth;
    tally->asked += asked;
    tally->most = asked > tally->most ? asked : tally->most;
}

static struct moving_scene any_scene(const struct moving_family *family)
{
    struct moving_scene scene;
    family->make(&rng, family->kind, &scene);
    return scene;
}

static void agrees_with_exact_arithmetic(void)
{
    printf("    %-24s %8s %8s %8s %8s %8s %8s %8s %8s\n", "family", "touch", "at once", "missed", "late", "wrong",
           "invented", "asked", "most");
    for (size_t f = 0; f < COUNT(families); f++) {
        struct tally tally = { 0 };
        for (unsigned long i = 0; i < case_count; i++) {
            struct moving_scene scene = any_scene(&families[f]);
            if (one_in(&rng, 8))
                memset(scene.shift, 0, sizeof scene.shift);
            judge(&scene, families[f].name, &tally);
        }
        printf("    %-24s %8lu %8lu %8lu %8lu %8lu %8lu %8.2f %8u\n", families[f].name, tally.touches, tally.at_once,
               tally.missed, tally.late, tally.wrong, tally.invented, (double)tally.asked / (double)case_count,
               tally.most);
    }
}

/* Its first time is the first of those that it calls touches, and is one if it is a double. */
static void the_oracle_agrees_with_single_times(void)
{
    unsigned long touches = 0, cases = case_count / 5 + 1;
    for (size_t f = 0; f < COUNT(families); f++)
        for (unsigned long i = 0; i < cases; i++) {
            struct moving_scene scene = any_scene(&families[f]);
            struct moving_pair both = pair_of(&scene);
            const char *name = families[f].name;
            double low = 1.0, high = 2.0;
            int touch = moving_first(&both, &low, &high);
            touches += touch != 0;
            CHECK(!touch || high == low || high == nextafter(low, 2.0), "%s: %a to %a", name, low, high);
            CHECK(moving_within(&both, low, both.radius) == (touch && low == high), "%s: at %a: %s", name, low,
                  moving_text(&scene));
            for (int k = 0; k < 16; k++) {
                double time = k < 8 ? k / 8.0 : k < 12 ? random_in(&rng, 0.0, low) : low - power_in(&rng, -15.0, -1.0);
                CHECK(time < 0.0 || time >= low || !moving_within(&both, time, both.radius), "%s: at %a, not %a: %s",
                      name, time, low, moving_text(&scene));
            }
        }
    CHECK(touches > cases, "only %lu touches", touches);
}

static const struct scene_family at_rest[] = {
    { "lattice", make_lattice, LATTICE_ANY },
    { "lattice, in one plane", make_lattice, LATTICE_FLAT },
    { "lattice, point", make_lattice, LATTICE_POINT },
    { "lattice, needle", make_lattice, LATTICE_NEEDLE },
    SCENE_MEETINGS(make_meeting),
};

/* A motion that both have changes nothing: the triangle is as good as at rest. The numbers are such that none rounds. */
static void the_oracle_agrees_with_triangles_at_rest(void)
{
    unsigned long touches = 0, cases = 6 * case_count + 1;
    for (unsigned long i = 0; i < cases; i++) {
        const struct scene_family *family = &at_rest[i % COUNT(at_rest)];
        struct scene scene;
        family->make(&rng, family->kind, &scene);
        struct moving_scene moved = { .motion = scene.motion };
        memcpy(moved.corner, scene.corner, sizeof moved.corner);
        struct moving_pair rest = pair_of(&moved);
        vec3 way = { whole_in(&rng, -9, 9), whole_in(&rng, -9, 9), whole_in(&rng, -9, 9) };
        moved.motion.da = add(scene.motion.da, way);
        moved.motion.db = add(scene.motion.db, way);
        for (int k = 0; k < 3; k++)
            moved.shift[k] = way;
        struct moving_pair both = pair_of(&moved);
        double low = 0.0, high = 0.0;
        int touch = moving_first(&both, &low, &high);
        touches += touch != 0;
        CHECK(touch == exact_touch(rest.a, rest.b, rest.da, rest.db, rest.corner, 1.0, 1), "%s: %d: %s", family->name,
              touch, moving_text(&moved));
        CHECK(!touch || (exact_touch(rest.a, rest.b, rest.da, rest.db, rest.corner, high, 1) &&
                         !exact_touch(rest.a, rest.b, rest.da, rest.db, rest.corner, low, 0)),
              "%s: not between %a and %a: %s", family->name, low, high, moving_text(&moved));
    }
    CHECK(touches > cases / 4, "only %lu touches", touches);
}

/* Distances at one time, against a bracket that shares no code: at time 0, where no place is rounded, and at others. */
static void the_oracle_knows_distances(void)
{
    for (size_t f = 0; f < COUNT(families) && ORACLE_BRACKET_JUDGES; f++)
        for (unsigned long i = 0; i < case_count / 50 + 2; i++) {
            struct moving_scene scene = any_scene(&families[f]);
            struct moving_pair both = pair_of(&scene);
            double time = i % 2 ? random_in(&rng, 0.0, 1.0) : 0.0, segment[6], v[9];
            double unsure = moving_extent(&scene) * (i % 2 ? 0x1p-49 : 0x1p-80);
            oracle_wide lower, upper;
            vec3_store(along(scene.motion.a, time, scene.motion.da), segment);
            vec3_store(along(scene.motion.b, time, scene.motion.db), segment + 3);
            for (int k = 0; k < 3; k++)
                vec3_store(along(scene.corner[k], time, scene.shift[k]), v + 3 * k);
            oracle_bracket(segment, v, &lower, &upper);
            double below = (double)lower * (1.0 - 1e-15), above = (double)upper * (1.0 + 1e-15);
            CHECK(moving_within(&both, time, above + unsure), "%s: more than %a at %a: %s", families[f].name, above,
                  time, moving_text(&scene));
            CHECK(below <= unsure || !moving_within(&both, time, below - unsure), "%s: %a or less at %a: %s",
                  families[f].name, below, time, moving_text(&scene));
        }
}

/* The triangle 0,0,0 4,0,0 0,4,0 and what its corners do; first touches that can be seen. */
static void the_oracle_knows_simple_cases(void)
{
    static const struct {
        double a[3], b[3], da[3], db[3], shift[9], radius;
        double first; /* -1: never */
    } c[] = {
        /* It comes up to an end, up to a radius, just arrives, and does not. */
        { { 1, 1, 2 }, { 1, 1, 3 }, { 0 }, { 0 }, { 0, 0, 4, 0, 0, 4, 0, 0, 4 }, 0.0, 0.5 },
        { { 1, 1, 2 }, { 1, 1, 3 }, { 0 }, { 0 }, { 0, 0, 4, 0, 0, 4, 0, 0, 4 }, 1.0, 0.25 },
        { { 1, 1, 2 }, { 1, 1, 3 }, { 0 }, { 0 }, { 0, 0, 2, 0, 0, 2, 0, 0, 2 }, 0.0, 1.0 },
        { { 1, 1, 2 }, { 1, 1, 3 }, { 0 }, { 0 }, { 0, 0, 1, 0, 0, 1, 0, 0, 1 }, 0.5, -1.0 },
        /* Both go together. */
        { { 1, 1, 2 }, { 1, 1, 3 }, { 0, 0, 9 }, { 0, 0, 9 }, { 0, 0, 9, 0, 0, 9, 0, 0, 9 }, 1.0, -1.0 },
        /* One corner rises, about the edge y = 0: at y = 1/2 the height is t / (2 - t). */
        { { 1, 0.5, 0.5 }, { 1, 0.5, 9 }, { 0 }, { 0 }, { 0, 0, 0, 0, 0, 0, 0, -2, 4 }, 0.0, 2.0 / 3.0 },
        /* It inverts: the corner 0,4 goes to 0,-4, away from an axis at y = 5 and over one at y = -2. */
        { { 0, 5, -1 }, { 0, 5, 1 }, { 0 }, { 0 }, { 0, 0, 0, 0, 0, 0, 0, -8, 0 }, 0.0, -1.0 },
        { { 0, -2, -1 }, { 0, -2, 1 }, { 0 }, { 0 }, { 0, 0, 0, 0, 0, 0, 0, -8, 0 }, 0.0, 0.75 },
        { { 0, -2, -1 }, { 0, -2, 1 }, { 0 }, { 0 }, { 0, 0, 0, 0, 0, 0, 0, -8, 0 }, 1.0, 0.625 },
        /* It shrinks to the corner 0,0 and grows on the other side. */
        { { -1, -1, -1 }, { -1, -1, 1 }, { 0 }, { 0 }, { 0, 0, 0, -8, 0, 0, 0, -8, 0 }, 0.0, 0.75 },
        /* Edge first, in its own plane, in the plane of the axis. */
        { { 5, -1, 0 }, { 5, 5, 0 }, { 0 }, { 0 }, { 4, 0, 0, 4, 0, 0, 4, 0, 0 }, 0.0, 0.25 },
        { { 5, -1, 0 }, { 5, 5, 0 }, { 0 }, { 0 }, { 4, 0, 0, 4, 0, 0, 4, 0, 0 }, 0.5, 0.125 },
        /* Beside the corner 0,4, by 1. */
        { { 1, 5, -1 }, { 1, 5, 1 }, { 0 }, { 0 }, { 4, 0, 0, 4, 0, 0, 4, 0, 0 }, 1.0, 0.25 },
        { { 1, 5, -1 }, { 1, 5, 1 }, { 0 }, { 0 }, { 4, 0, 0, 4, 0, 0, 4, 0, 0 }, 0.9375, -1.0 },
    };
    for (size_t i = 0; i < COUNT(c); i++) {
        struct moving_pair both = { .corner = { 0, 0, 0, 4, 0, 0, 0, 4, 0 }, .radius = c[i].radius };
        memcpy(both.a, c[i].a, sizeof both.a);
        memcpy(both.b, c[i].b, sizeof both.b);
        memcpy(both.da, c[i].da, sizeof both.da);
        memcpy(both.db, c[i].db, sizeof both.db);
        memcpy(both.shift, c[i].shift, sizeof both.shift);
        double low = -1.0, high = -1.0;
        int touch = moving_first(&both, &low, &high);
        CHECK(touch == (c[i].first >= 0.0), "case %zu: %d at %.17g", i, touch, low);
        CHECK(!touch || (low <= c[i].first && c[i].first <= high), "case %zu: at %.17g, not %.17g", i, low, c[i].first);
    }
}

int main(int argc, char **argv)
{
    take_count(argc, argv, &case_count, &rng);
    TEST(the_oracle_knows_simple_cases);
    TEST(the_oracle_knows_distances);
    TEST(the_oracle_agrees_with_triangles_at_rest);
    TEST(the_oracle_agrees_with_single_times);
    TEST(agrees_with_exact_arithmetic);
    return check_report();
}
