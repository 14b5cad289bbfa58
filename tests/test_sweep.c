/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The sweep: closed forms; one triangle against a bracket of the least distance over time, with a radius or
 * without; whole meshes against the sweep of every triangle, with every kernel, hint and budget; sheets
 * crossed from all sides at up to 20 m/s. Without a radius tests/exact/sweep.c decides more.
 *
 * Usage: test_sweep [cases of a family = 20000] [seed = 1].
 */
#include "dynpoint/query.h"
#include "fixture.h"
#include "oracle/pair.h"
#include "sweep_scene.h"

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

static unsigned long case_count = 20000;
static uint64_t rng = 1;

static int sweep_scene(const struct scene *scene, double radius, double tolerance, double *time,
                       uint32_t *asked)
{
    struct sweep sweep;
    sweep_begin(&sweep, &scene->motion, radius, tolerance, scene_extent(scene));
    *asked = 0;
    return sweep_pair(&sweep, scene->corner, 1.0, UINT32_MAX, time, asked);
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
    return slow ? (double)oracle_pair(segment, v)
                : dpt_segment_triangle(segment, v, NULL, NULL, NULL);
}

/*
 * Whether the distance falls to the radius or below, by more than `unsure`, at a time before `until`. No end is faster
 * than `speed`, and so the distance changes no faster: what is far enough at the middle of an interval is far
 * all along. `unsure` counts what remains when intervals are too short or too many. Returns such a time, or -1.
 */
static double touch_before(const struct scene *scene, double radius, double until, double unsure,
                           int slow, unsigned long *open)
{
    enum { DEPTH = 64, MOST = 4000 };
    double from[DEPTH], to[DEPTH];
    int depth = 1, asked = 0;
    double speed = larger(length(scene->motion.da), length(scene->motion.db)) * (1.0 + 1e-12);
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
    double radius = larger(any_radius(scene), 0.0), tolerance = 1e-6 * scene_size(scene);
    double time = -1.0, unsure = 64.0 * 0x1p-53 * scene_extent(scene) + 0.01 * tolerance;
    uint32_t asked;
    int slow = i % 100 == 0;
    int hit = sweep_scene(scene, radius, tolerance, &time, &asked) == SWEEP_HIT;
    tally->hits += (unsigned)hit;
    tally->asked += asked;
    tally->most = asked > tally->most ? asked : tally->most;
    double off = hit ? distance_at(scene, time, slow) - radius : 0.0;
    tally->invented += off > tolerance;
    CHECK(off <= tolerance, "%s: %g off at %a, radius %a: %s", name, off, time, radius,
          scene_text(scene));
    if (i % 10 || (hit && time == 0.0))
        return;
    double sooner = touch_before(scene, radius, hit ? time : 1.0, unsure, slow, &tally->open);
    tally->missed += sooner >= 0.0;
    CHECK(sooner < 0.0, "%s: missed at %a, told %a, radius %a: %s", name, sooner, hit ? time : 1.0,
          radius, scene_text(scene));
}

static void one_triangle_is_met_in_time(void)
{
    printf("    %-24s %8s %8s %8s %8s %8s %8s\n", "family", "hits", "missed", "invented",
           "too many", "asked", "most");
    for (size_t f = 0; f < COUNT(families); f++) {
        struct tally tally = { 0, 0, 0, 0, 0, 0 };
        for (unsigned long i = 0; i < case_count; i++) {
            struct scene scene;
            families[f].make(&rng, families[f].kind, &scene);
            judge(families[f].name, &scene, i, &tally);
        }
        printf("    %-24s %8lu %8lu %8lu %8lu %8.2f %8u\n", families[f].name, tally.hits,
               tally.missed, tally.invented, tally.open, (double)tally.asked / (double)case_count,
               tally.most);
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
        CHECK(result != SWEEP_HIT || (time <= expected && time > expected - 1e-3),
              "case %zu: at %.17g, not %.17g", i, time, expected);
        CHECK(asked <= 60, "case %zu: %u distances", i, asked);
    }
}

/* A mesh that is swept, and what its bounds and numbers are. */
struct body {
    struct fixture fixture;
    struct tree tree;
    double diagonal;
};

static int body_of(struct body *body)
{
    const struct dpt_mesh *mesh = body->fixture.mesh;
    if (!mesh)
        return 0;
    tree_of_mesh(mesh, &body->tree);
    body->diagonal = length(sub(vec3_of(mesh->box_max), vec3_of(mesh->box_min)));
    return 1;
}

/* Triangles of all kinds about the origin: large, small, slivers, doubled in part. */
static int soup_of(struct body *body)
{
    enum { TRIANGLES = 700 };
    static double vertices[9 * TRIANGLES];
    static uint32_t corners[3 * TRIANGLES];
    for (uint32_t t = 0; t < TRIANGLES; t++) {
        struct scene scene;
        make_any(&rng, t % 3 ? SMALL : t % 2 ? SLIVER : ANY, &scene);
        vec3 off = any_in(&rng, 0.5);
        for (uint32_t k = 0; k < 3; k++) {
            vec3_store(add(scaled(scene.corner[k], 0.3), off), vertices + 9 * t + 3 * k);
            corners[3 * t + k] = 3 * t + k;
        }
    }
    return fixture_from_arrays(&body->fixture, vertices, 3 * TRIANGLES, corners, TRIANGLES) &&
           body_of(body);
}

/* About the body; of a third, fast, slow, or not at all; from a length of 0 to the diagonal. */
static void motion_near(const struct body *body, struct motion *m)
{
    const struct tree *tree = &body->tree;
    uint32_t v = tree->corners[random_bits(&rng) % (3 * (uint64_t)tree->mesh->triangles)];
    double size = body->diagonal, far = power_in(&rng, -5.0, -0.5);
    vec3 at = vec3_of_float(tree->positions + 3 * (size_t)v), u = scaled(any_in(&rng, 1.0), size);
    if (one_in(&rng, 4))
        u = scaled(u, one_in(&rng, 2) ? 0.0 : 1e-3);
    if (one_in(&rng, 4))
        u.z = 0.0;
    at = add(at, scaled(any_in(&rng, size), far));
    m->a = along(at, -random_in(&rng, 0.0, 1.0), u);
    m->b = add(m->a, u);
    double fast = one_in(&rng, 8) ? 0.0 : power_in(&rng, -4.0, -0.3);
    m->da = scaled(any_in(&rng, size), fast);
    m->db = one_in(&rng, 3) ? m->da : scaled(any_in(&rng, size), fast);
}

/* Every triangle, one after the other. */
static struct strike brute_sweep(const struct tree *tree, const struct sweep *sweep)
{
    struct strike first = { .time = 1.0, .triangle = DPT_NONE };
    for (uint32_t t = 0; t < tree->mesh->triangles; t++) {
        const uint32_t *of = tree->corners + 3 * (size_t)t;
        const vec3 corner[3] = { vec3_of_float(tree->positions + 3 * (size_t)of[0]),
                                 vec3_of_float(tree->positions + 3 * (size_t)of[1]),
                                 vec3_of_float(tree->positions + 3 * (size_t)of[2]) };
        uint32_t asked = 0;
        double time;
        if (sweep_pair(sweep, corner, first.time, UINT32_MAX, &time, &asked) != SWEEP_HIT)
            continue;
        if (time < first.time || first.triangle == DPT_NONE ||
            tree->sources[t] < tree->sources[first.triangle]) {
            first.time = time;
            first.triangle = t;
        }
    }
    return first;
}

static void check_strike(const char *what, const struct strike *found, const struct strike *truth,
                         int result)
{
    CHECK(result == (truth->triangle == DPT_NONE ? SWEEP_FREE : SWEEP_HIT), "%s: result %d", what,
          result);
    CHECK(found->time == truth->time && found->triangle == truth->triangle,
          "%s: %u at %.17g, not %u at %.17g", what, found->triangle, found->time, truth->triangle,
          truth->time);
}

/* With little work: no more than allowed, no wrong answer, and what is said to be free is free. */
static double check_budget(const struct body *body, const struct kernel *kernel,
                           const struct sweep *sweep, const struct strike *truth, uint32_t full)
{
    uint32_t most = 1 + (uint32_t)(random_bits(&rng) % (full + full / 2)), work = 5;
    struct strike found;
    int result = sweep_mesh(&body->tree, kernel, sweep, DPT_NONE, most, &found, &work);
    CHECK(work - 5 <= most, "%u of %u units", work - 5, most);
    if (result != SWEEP_UNFINISHED) {
        check_strike("budget", &found, truth, result);
        return 1.0;
    }
    CHECK((uint64_t)most * 7 < (uint64_t)full * 8 + 8, "%u units, %u suffice", most, full);
    CHECK(found.triangle == DPT_NONE && found.time >= 0.0 && found.time < 1.0, "%g", found.time);
    CHECK(found.time < truth->time || found.time == 0.0 || truth->triangle == DPT_NONE,
          "free up to %.17g, but hit at %.17g", found.time, truth->time);
    return found.time;
}

static void check_pair_of(const struct body *body, const struct sweep *sweep,
                          const struct strike *found, double tolerance)
{
    vec3 a, u;
    sweep_axis(sweep, found->time, &a, &u);
    pair expected = tree_pair(&body->tree, found->triangle, a, u);
    CHECK(expected.distance2 == found->pair.distance2 && expected.s == found->pair.s, "pair");
    CHECK(sqrt(expected.distance2) <= sweep->radius + tolerance, "off");
    vec3 off = sub(sub(along(a, found->pair.s, u), found->q), found->pair.gap);
    CHECK(length(off) <= 1e-14, "q is %g off", length(off));
}

static void sweep_body(const char *name, struct body *body, int motions)
{
    struct kernel kernel[8];
    uint32_t kernels = 0, chosen, hits = 0, unfinished = 0, most = 0;
    double progress = 0.0;
    for (uint32_t id = DPT_KERNEL_SCALAR; id <= DPT_KERNEL_NEON; id++)
        kernels += (uint32_t)kernel_get(id, &kernel[kernels], &chosen);
    for (int i = 0; i < motions; i++) {
        struct motion motion;
        struct sweep sweep;
        struct strike found;
        double tolerance = 1e-6 * body->diagonal;
        double radius = one_in(&rng, 2) ? 0.0 : body->diagonal * power_in(&rng, -5.0, -1.0);
        uint32_t work = 0, full = 0;
        motion_near(body, &motion);
        sweep_begin(&sweep, &motion, radius, tolerance, tree_extent(&body->tree));
        struct strike truth = brute_sweep(&body->tree, &sweep);
        for (uint32_t k = 0; k < kernels; k++) {
            uint32_t before = full;
            full = 0;
            int result = sweep_mesh(&body->tree, &kernel[k], &sweep, DPT_NONE, 0, &found, &full);
            check_strike(name, &found, &truth, result);
            CHECK(k == 0 || full == before, "%s: %u units, not %u", name, full, before);
        }
        uint32_t hint = (uint32_t)(random_bits(&rng) % body->tree.mesh->triangles);
        hint = one_in(&rng, 2) ? truth.triangle : hint;
        int result = sweep_mesh(&body->tree, &kernel[0], &sweep, hint, 0, &found, &work);
        check_strike("hint", &found, &truth, result);
        if (result == SWEEP_HIT)
            check_pair_of(body, &sweep, &found, tolerance);
        hits += truth.triangle != DPT_NONE;
        most = full > most ? full : most;
        double done = check_budget(body, &kernel[0], &sweep, &truth, full);
        unfinished += done < 1.0;
        progress += done < 1.0 ? done : 0.0;
    }
    printf("    %-10s %5d motions, %4u hits, work at most %5u; %4u unfinished, free up to %.2f\n",
           name, motions, hits, most, unfinished, progress / larger(unfinished, 1.0));
    CHECK(hits > (uint32_t)motions / 10, "%u hits", hits);
}

static void meshes_are_met_as_their_triangles_are(void)
{
    static const struct {
        const char *shape;
        uint32_t count;
        int motions;
    } c[] = { { "membrane", 512, 1500 },
              { "cloth", 3200, 400 },
              { "liver", 5000, 300 },
              { "star", 2400, 300 },
              { NULL, 0, 1500 } };
    for (size_t i = 0; i < COUNT(c); i++) {
        struct body body;
        if (c[i].shape ? fixture_from_shape(&body.fixture, c[i].shape, c[i].count) && body_of(&body)
                       : soup_of(&body))
            sweep_body(c[i].shape ? c[i].shape : "soup", &body, c[i].motions);
        fixture_free(&body.fixture);
    }
}

/* The swept bounds of a block: what lies beyond the limit is farther, at any time, and all kernels agree. */
static void swept_bounds_are_sound(void)
{
    struct body body;
    if (!soup_of(&body))
        return;
    struct kernel kernel[8];
    uint32_t kernels = 0, chosen, closed = 0;
    double worst = -HUGE_VAL;
    for (uint32_t id = DPT_KERNEL_SCALAR; id <= DPT_KERNEL_NEON; id++)
        kernels += (uint32_t)kernel_get(id, &kernel[kernels], &chosen);
    for (int i = 0; i < 4000; i++) {
        struct swath swath = { .limit = (float)power_in(&rng, -4.0, 0.0) };
        vec3 end[4], frame[3] = { any_in(&rng, 1.0) };
        double far = 0.0, reach = one_in(&rng, 8) ? 50.0 : 1.5, span = power_in(&rng, -3.0, 0.0);
        vec3 about = any_in(&rng, reach);
        for (int e = 0; e < 4; e++) {
            end[e] = add(about, any_in(&rng, span));
            far = larger(far, length(end[e]));
            swath.end[e][0] = (float)end[e].x;
            swath.end[e][1] = (float)end[e].y;
            swath.end[e][2] = (float)end[e].z;
        }
        frame[0] = scaled(frame[0], 1.0 / length(frame[0]));
        frame[1] = across_in(&rng, frame[0]);
        frame[2] = cross(frame[0], frame[1]);
        for (int k = 0; k < 3; k++) {
            const double axis[3] = { frame[k].x, frame[k].y, frame[k].z };
            const double centre[3] = { about.x, about.y, about.z };
            for (int x = 0; x < 3; x++)
                swath.axis[k][x] = (float)axis[x];
            swath.centre[k] = (float)centre[k];
            swath.half[k] = (float)(0.3 * span);
        }
        uint32_t leaf = (uint32_t)(random_bits(&rng) % body.tree.mesh->leaves);
        const float *rows = body.tree.leaves + (size_t)leaf * MESH_LEAF_WORDS;
        float bound[8][LANES], box[8][LANES];
        uint32_t open[8] = { 0 }, open_box[8] = { 0 };
        for (uint32_t k = 0; k < kernels; k++) {
            open[k] = kernel[k].swept_triangles(rows, &swath, bound[k]);
            open_box[k] = kernel[k].swept_boxes(body.tree.level[1], &swath, box[k]);
            CHECK(open[k] == open[0] && open_box[k] == open_box[0], "lanes of kernel %u", k);
            CHECK(!memcmp(bound[k], bound[0], sizeof *bound), "bounds of kernel %u", k);
            CHECK(!memcmp(box[k], box[0], sizeof *box), "bounds of boxes of kernel %u", k);
        }
        closed += (~open[0] & 0xffff) != 0;
        double s = random_in(&rng, 0.0, 1.0), t = random_in(&rng, 0.0, 1.0);
        vec3 a = along(end[0], t, sub(end[2], end[0])), b = along(end[1], t, sub(end[3], end[1]));
        if (i % 3 == 0)
            a = end[i % 4], b = end[i / 4 % 4];
        a = along(a, i % 3 == 1 ? s : 0.0, sub(b, a));
        for (int lane = 0; lane < LANES; lane++) {
            vec3 v[3];
            for (int k = 0; k < 3; k++)
                v[k] = (vec3){ rows[3 * k * LANES + lane], rows[(3 * k + 1) * LANES + lane],
                               rows[(3 * k + 2) * LANES + lane] };
            double distance = sqrt(segment_triangle(a, sub(b, a), v[0], v[1], v[2]).distance2);
            double over = ((double)bound[0][lane] - distance) / kernel_margin(far, far);
            worst = larger(over, worst);
            CHECK(over <= 1.0, "%g margins above the distance", over);
            over = ((double)box[0][leaf % LANES] - distance) / kernel_margin(far, far);
            if (leaf < LANES) {
                worst = larger(over, worst);
                CHECK(over <= 1.0, "box: %g margins above the distance", over);
            }
        }
    }
    printf("    above the distance by at most %.3f margins\n", worst);
    CHECK(closed > 400, "%u closed", closed);
    fixture_free(&body.fixture);
}

/*
 * An end goes from one side of a flat sheet to the other, through its inside, in one of any tick of 20 mm at most:
 * it is met no later than the end is in the sheet's plane. Invented would be a hit where the axis is not at it.
 */
static void sheets_are_crossed_at_any_speed(void)
{
    struct body body;
    struct kernel kernel;
    uint32_t chosen;
    unsigned long missed = 0, invented = 0, free = 0;
    if (!fixture_from_shape(&body.fixture, "membrane", 512) || !body_of(&body))
        return;
    kernel_get(DPT_KERNEL_AUTO, &kernel, &chosen);
    for (unsigned long i = 0; i < 10 * case_count; i++) {
        vec3 through = any_in(&rng, 0.0999), way = any_in(&rng, 1.0), u = any_in(&rng, 1.0);
        through.z = 0.0;
        if (one_in(&rng, 3))
            way.z *= power_in(&rng, -6.0, 0.0);
        if (one_in(&rng, 3))
            u.z *= power_in(&rng, -9.0, 0.0);
        if (one_in(&rng, 3)) { /* over a vertex or an edge of the grid */
            through.x = 0.0125 * whole_in(&rng, -7, 7);
            through.y = one_in(&rng, 2) ? through.x : through.y;
        }
        way = scaled(way, 0.02 * power_in(&rng, -3.0, 0.0) / length(way));
        u = scaled(u, one_in(&rng, 8) ? 0.0 : power_in(&rng, -3.0, -0.5) / length(u));
        u.z = way.z > 0.0 ? -fabs(u.z) : fabs(u.z); /* the other end stays behind */
        double t = one_in(&rng, 4) ? whole_in(&rng, 0, 1) : random_in(&rng, 0.0, 1.0);
        struct motion m;
        m.a = along(through, -t, way);
        m.b = add(m.a, u);
        m.da = way;
        m.db = add(way, scaled(u, random_in(&rng, 0.0, 1e-2)));
        int at_a = one_in(&rng, 2);
        if (at_a) {
            m = (struct motion){ m.b, m.a, m.db, m.da };
        }
        int cross = i % 4 != 0;
        if (!cross) { /* and as much beside it */
            m.a.z += way.z > 0.0 ? -0.5 : 0.5;
            m.b.z += way.z > 0.0 ? -0.5 : 0.5;
        }
        struct sweep sweep;
        struct strike found;
        uint32_t work = 0;
        double tolerance = 1e-6 * body.diagonal;
        sweep_begin(&sweep, &m, 0.0, tolerance, tree_extent(&body.tree));
        int hit = sweep_mesh(&body.tree, &kernel, &sweep, DPT_NONE, 0, &found, &work) == SWEEP_HIT;
        missed += cross && !(hit && found.time <= t + 1e-12);
        CHECK(!cross || (hit && found.time <= t + 1e-12), "missed: result %d at %.17g, not %.17g",
              hit, found.time, t);
        vec3 a, axis;
        sweep_axis(&sweep, found.time, &a, &axis);
        int is = hit && sqrt(tree_pair(&body.tree, found.triangle, a, axis).distance2) > tolerance;
        invented += (unsigned)is + (!cross && hit);
        CHECK(!is && !(hit && !cross), "invented at %.17g", found.time);
        free += !hit;
    }
    printf("    %lu motions, %lu missed, %lu invented, %lu free\n", 10 * case_count, missed,
           invented, free);
    fixture_free(&body.fixture);
}

int main(int argc, char **argv)
{
    if (argc > 1)
        case_count = strtoul(argv[1], NULL, 10);
    if (argc > 2)
        rng = strtoull(argv[2], NULL, 10);
    TEST(gives_closed_forms);
    TEST(one_triangle_is_met_in_time);
    TEST(swept_bounds_are_sound);
    TEST(meshes_are_met_as_their_triangles_are);
    TEST(sheets_are_crossed_at_any_speed);
    return check_report();
}
