/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The sweep of one triangle: closed forms, and a bracket of the least distance over time, with a
 * radius or without. Without one tests/sweep/test_sweep_exact.c decides more; meshes are test_sweep_mesh.c.
 *
 * Usage: test_sweep [cases of a family = 20000] [seed = 1].
 */
#include "dynpoint/query.h"
#include "oracle/pair.h"
#include "sweep/sweep_scene.h"

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

static unsigned long case_count = 20000;
static uint64_t rng = 1;

static int sweep_scene(const struct scene *scene, double radius, double tolerance, double *time, uint32_t *asked)
{
    struct sweep sweep;
    dpti_sweep_begin(&sweep, &scene->motion, radius, tolerance, scene_extent(scene));
    *asked = 0;
    const struct moving_triangle triangle = triangle_at_rest(scene->corner);
    return dpti_sweep_triangle(&sweep, &triangle, 1.0, time, asked);
}

/* The truth, or what test_pair.c holds against it, which is fifty times as fast. */
static double distance_at(const struct scene *scene, double time, int slow)
{
    vec3 a = along(scene->motion.a, time, scene->motion.da);
    vec3 b = along(scene->motion.b, time, scene->motion.db);
    double segment[6], v[9];
    vec3_store(a, segment);
    vec3_store(b, segment + 3);
    for (int k = 0; k < 3; k++)
        vec3_store(scene->corner[k], v + 3 * k);
    return slow ? (double)oracle_pair(segment, v) : dpt_segment_triangle(segment, v, NULL, NULL, NULL);
}

/*
 * Whether the distance falls to the radius or below, by more than `unsure`, at a time before
 * `until`. No end is faster than `speed`, and so the distance changes no faster: what is far enough
 * at the middle of an interval is far all along. `unsure` counts what remains when intervals are
 * too short or too many. Returns such a time, or -1.
 */
static double touch_before(const struct scene *scene, double radius, double until, double unsure, int slow,
                           unsigned long *open)
{
    enum { DEPTH = 64, MOST = 4000 };
    double from[DEPTH], to[DEPTH];
    int depth = 1, asked = 0;
    double speed = max_of(length(scene->motion.da), length(scene->motion.db)) * (1.0 + 1e-12);
    from[0] = 0.0;
    to[0] = until;
    while (depth && asked++ < MOST) {
        double low = from[--depth], high = to[depth], middle = 0.5 * (low + high);
        double distance = distance_at(scene, middle, slow);
        if (distance < radius - unsure)
            return middle;
        double reach = 0.5 * (high - low) * speed;
        if (distance - reach > radius || reach < unsure || depth + 2 > DEPTH)
            continue;
        from[depth] = low, to[depth++] = middle;
        from[depth] = middle, to[depth++] = high;
    }
    *open += depth != 0;
    return -1.0;
}

static const struct scene_family families[] = {
    { "lattice", make_lattice, LATTICE_ANY },
    { "lattice, in one plane", make_lattice, LATTICE_FLAT },
    { "lattice, needle", make_lattice, LATTICE_NEEDLE },
    SCENE_MEETINGS(make_meeting),
    SCENE_MEETINGS(make_grazing),
    { "any", make_any, ANY },
    { "any, shift", make_any, SHIFT },
    { "any, small", make_any, SMALL },
    { "any, spin", make_any, SPIN },
    { "any, sliver", make_any, SLIVER },
    { "any, slide", make_any, SLIDE },
    { "any, beside", make_any, BESIDE },
    { "any, point", make_any, DOT },
    { "any, far", make_any, FAR },
    { "any, tiny", make_any, TINY },
};

/* A radius that the motion about reaches at some time, so that it grazes. */
static double any_radius(const struct scene *scene)
{
    double size = scene_size(scene);
    if (one_in(&rng, 3))
        return 0.0;
    if (one_in(&rng, 2))
        return size * power_in(&rng, -6.0, -1.0);
    double radius = distance_at(scene, random_in(&rng, 0.0, 1.0), 0);
    return radius + size * power_in(&rng, -12.0, -5.0) * random_in(&rng, -1.0, 1.0);
}

struct tally {
    unsigned long hits, missed, invented, open, asked;
    uint32_t most;
};

static void judge(const char *name, const struct scene *scene, unsigned long i, struct tally *tally)
{
    double radius = max_of(any_radius(scene), 0.0), tolerance = any_tolerance(&rng, scene);
    double time = -1.0, unsure = 64.0 * 0x1p-53 * scene_extent(scene) + 0.01 * tolerance;
    uint32_t asked;
    int slow = i % 100 == 0;
    int hit = sweep_scene(scene, radius, tolerance, &time, &asked) == SWEEP_HIT;
    tally->hits += (unsigned)hit;
    tally->asked += asked;
    tally->most = asked > tally->most ? asked : tally->most;
    double off = hit ? distance_at(scene, time, slow) - radius : 0.0;
    tally->invented += off > tolerance;
    CHECK(off <= tolerance, "%s: %g off at %a, radius %a: %s", name, off, time, radius, scene_text(scene));
    if (i % 10 || (hit && time == 0.0))
        return;
    double sooner = touch_before(scene, radius, hit ? time : 1.0, unsure, slow, &tally->open);
    tally->missed += sooner >= 0.0;
    CHECK(sooner < 0.0, "%s: missed at %a, told %a, radius %a: %s", name, sooner, hit ? time : 1.0, radius,
          scene_text(scene));
}

static void one_triangle_is_met_in_time(void)
{
    printf("    %-24s %8s %8s %8s %8s %8s %8s\n", "family", "hits", "missed", "invented", "too many", "asked", "most");
    for (size_t f = 0; f < COUNT(families); f++) {
        struct tally tally = { 0, 0, 0, 0, 0, 0 };
        for (unsigned long i = 0; i < case_count; i++) {
            struct scene scene;
            families[f].make(&rng, families[f].kind, &scene);
            judge(families[f].name, &scene, i, &tally);
        }
        printf("    %-24s %8lu %8lu %8lu %8lu %8.2f %8u\n", families[f].name, tally.hits, tally.missed, tally.invented,
               tally.open, (double)tally.asked / (double)case_count, tally.most);
        CHECK(tally.most <= 600, "%s: %u distances for one triangle", families[f].name, tally.most);
    }
}

/* The triangle 0,0,0 4,0,0 0,4,0. */
static void gives_closed_forms(void)
{
    static const struct {
        struct motion m;
        double radius, time; /* -1: never */
    } c[] = {
        { { { 1, 1, 2 }, { 1, 1, 5 }, { 0, 0, -4 }, { 0, 0, -4 } }, 0.0, 0.5 },
        { { { 1, 1, 2 }, { 1, 1, 5 }, { 0, 0, -4 }, { 0, 0, -4 } }, 1.0, 0.25 },
        { { { 1, 1, 2 }, { 1, 1, 5 }, { 0, 0, -2 }, { 0, 0, -2 } }, 0.0, 1.0 },
        { { { 1, 1, 0 }, { 1, 1, 5 }, { 0, 0, 3 }, { 0, 0, 3 } }, 0.0, 0.0 },
        { { { 1, 1, 2 }, { 1, 1, 5 }, { 0, 0, -1.99 }, { 0, 0, -1.99 } }, 0.0, -1.0 },
        { { { 1, 1, 2 }, { 1, 1, 5 }, { 0, 0, 4 }, { 0, 0, 4 } }, 1.0, -1.0 },
        { { { 1, 1, 2 }, { 1, 1, 2 }, { 0, 0, -8 }, { 0, 0, -8 } }, 0.0, 0.25 },
        { { { 1, 1, 2 }, { 1, 1, 2 }, { 0, 0, 0 }, { 0, 0, 0 } }, 0.0, -1.0 },
        { { { 1, 1, 2 }, { 1, 1, 2 }, { 0, 0, 0 }, { 0, 0, 0 } }, 2.0, 0.0 },
        { { { -2, 1, 1 }, { -2, 1, -1 }, { 4, 0, 0 }, { 4, 0, 0 } }, 0.0, 0.5 }, /* over an edge */
        { { { -2, 1, 1 }, { -2, 1, -1 }, { 4, 0, 0 }, { 4, 0, 0 } }, 1.0, 0.25 },
        { { { -2, -1, 0 }, { -2, 9, 0 }, { 4, 0, 0 }, { 4, 0, 0 } }, 0.0, 0.5 }, /* in the plane */
        { { { -9, 1, 0 }, { -1, 1, 0 }, { 4, 0, 0 }, { 4, 0, 0 } }, 0.0, 0.25 },
        { { { -1, 1, 1 }, { 9, 1, 1 }, { 0, 0, -2 }, { 0, 0, 2 } }, 0.0, -2.0 },  /* turning */
        { { { -1, -1, 3 }, { 6, -1, 3 }, { 0, 4, 0 }, { 0, 4, 0 } }, 3.0, 0.25 }, /* rolls on */
        { { { -9, 1, 1 }, { 9, 1, 1 }, { 1e5, 0, 0 }, { 1e5, 0, 0 } }, 0.5, -1.0 },
        { { { -9, 1, 1 }, { 9, 1, 1 }, { 1e5, 0, 0 }, { 1e5, 0, 0 } }, 1.0, 0.0 },
    };
    const double tolerance = 1e-6;
    for (size_t i = 0; i < COUNT(c); i++) {
        struct scene scene = { c[i].m, { { 0, 0, 0 }, { 4, 0, 0 }, { 0, 4, 0 } } };
        double time = -1.0, expected = c[i].time;
        uint32_t asked;
        int result = sweep_scene(&scene, c[i].radius, tolerance, &time, &asked);
        if (expected == -2.0) /* at s: height 1 - 2 t + 4 t s, over the triangle for s from 0.1 */
            expected = 1.0 / (2.0 - 4.0 * 0.1);
        CHECK((result == SWEEP_HIT) == (expected >= 0.0), "case %zu: result %d", i, result);
        CHECK(result != SWEEP_HIT || (time <= expected && time > expected - 1e-3), "case %zu: at %.17g, not %.17g", i,
              time, expected);
        CHECK(asked <= 60, "case %zu: %u distances", i, asked);
    }
}

int main(int argc, char **argv)
{
    take_count(argc, argv, &case_count, &rng);
    TEST(gives_closed_forms);
    TEST(one_triangle_is_met_in_time);
    return check_report();
}
