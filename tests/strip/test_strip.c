/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Shadows of tools: the triangles of a strip against those that the oracle finds by cutting every triangle and edge by
 * the shadow in long double, over generated shapes and public meshes; folds, holes, edges of many triangles, hubs; a
 * strip that is full; arguments.
 *
 *     test_strip           what make check runs
 *     test_strip FACTOR    so many times as many shadows
 *
 * Real meshes from DPT_DATA.
 */
#include "strip/strip_sheet.h"

static const char *data;

static void check_capacity(const struct scene *scene, const dpt_shadow *shadow, const dpt_strip *whole)
{
    uint32_t n = 0;
    const uint32_t *all_of_it = dpt_strip_get_triangles(whole, &n, NULL);
    const uint32_t tries[] = { 1, 2, n / 3, n - 1, n, n + 1 };
    for (size_t i = 0; n && i < sizeof tries / sizeof *tries; i++) {
        struct guarded_strip guarded;
        const uint32_t capacity = tries[i] ? tries[i] : 1;
        uint32_t count = 0, flags = 0, inside = 0, first = 0;
        dpt_strip *strip = guarded_strip_open(&guarded, capacity, 0);
        fill_strip(scene, shadow, strip);
        const uint32_t *triangles = dpt_strip_get_triangles(strip, &count, &flags);
        for (uint32_t k = 0; k < n; k++)
            scene->mark[all_of_it[k]] = 1;
        for (uint32_t k = 0; k < count; k++) {
            inside += scene->mark[triangles[k]];
            scene->mark[triangles[k]] = 0;
            first |= triangles[k] == shadow->triangle;
        }
        for (uint32_t k = 0; k < n; k++)
            scene->mark[all_of_it[k]] = 0;
        CHECK(count == (capacity < n ? capacity : n) && inside == count && first &&
                  ((flags & DPT_STRIP_FLAG_FULL) != 0) == (capacity < n),
              "of %u in room for %u: %u, %u of it, flags %u: %s", n, capacity, count, inside, flags,
              shadow_text(scene, shadow));
        totals.full += capacity < n;
        guarded_strip_close(&guarded);
    }
}

/* One strip object for all of them, and now and then a fresh one. */
static void try_shadows(const struct subject *subject, uint64_t shadows, uint64_t seed)
{
    struct scene scene;
    struct guarded_strip guarded;
    const struct tally before = totals;
    scene_open(&scene, subject);
    dpt_strip *strip = guarded_strip_open(&guarded, room_for(subject), 0);
    for (uint64_t i = 0; i < part_of(shadows); i++) {
        dpt_shadow shadow;
        if (i % 16 == 8) {
            dpt_pose pose;
            random_pose(&scene, &seed, &pose);
            scene_place(&scene, &pose);
        } else if (i % 16 == 0) {
            scene_place(&scene, NULL);
        }
        random_shadow(&scene, &seed, &shadow);
        ask_oracle(&scene, &shadow);
        fill_strip(&scene, &shadow, strip);
        check_sheet(&scene, &shadow, strip);
        if (i % 8 == 5) {
            struct guarded_strip fresh;
            fill_strip(&scene, &shadow, guarded_strip_open(&fresh, room_for(subject), 0));
            CHECK(are_alike(&scene, strip, fresh.strip), "a fresh strip has others: %s", shadow_text(&scene, &shadow));
            guarded_strip_close(&fresh);
        }
        if (i % 8 == 6)
            check_capacity(&scene, &shadow, strip);
    }
    printf("    %-30s %6u triangles, %5zu shadows of %7.1f, in doubt %zu\n", subject->name, subject->info.triangles,
           totals.shadows - before.shadows,
           (double)(totals.triangles - before.triangles) / (double)(totals.shadows - before.shadows),
           totals.doubts - before.doubts);
    totals.meshes++;
    guarded_strip_close(&guarded);
    scene_close(&scene);
}

/* The oracle held to two plainer ones. */

static long double dot_long(const long double a[3], const long double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* How far the corners and the shadow are apart along a direction; less than 0 where they overlap. */
static long double apart_along(const struct oracle_shadow *s, const long double (*corners)[3], int count,
                               const long double n[3])
{
    long double low = INFINITY, high = -INFINITY;
    const long double square = dot_long(n, n), from = dot_long(n, s->a), way = dot_long(n, s->u);
    if (!(square > 0))
        return -INFINITY;
    for (int i = 0; i < count; i++) {
        const long double at = dot_long(n, corners[i]) - from;
        low = fminl(low, at);
        high = fmaxl(high, at);
    }
    const long double half =
        s->maybe_reach * (fabsl(dot_long(n, s->e)) + fabsl(dot_long(n, s->w))) + s->depth * fabsl(dot_long(n, s->d));
    return fmaxl(low - (fmaxl(0, way) + half), fminl(0, way) - half - high) / sqrtl(square);
}

/*
 * The most that a plane parallel to two of the edges there are, or to one and the triangle's normal, holds them apart.
 */
static long double separation(const struct oracle_shadow *s, const long double (*corners)[3], int count)
{
    long double way[11][3], most = -INFINITY;
    int ways = 0;
    const long double *axes[4] = { s->e, s->w, s->d, s->u };
    for (int i = 0; i < 4; i++, ways++)
        memcpy(way[ways], axes[i], sizeof way[0]);
    for (int i = 0; i < count; i++, ways++)
        for (int k = 0; k < 3; k++)
            way[ways][k] = corners[(i + 1) % count][k] - corners[i][k];
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        way[ways][k] = way[4][i] * way[5][j] - way[4][j] * way[5][i];
    }
    ways++;
    for (int p = 0; p < ways; p++) {
        most = fmaxl(most, apart_along(s, corners, count, way[p]));
        for (int q = 0; q < p; q++) {
            long double n[3];
            for (int k = 0; k < 3; k++) {
                const int i = (k + 1) % 3, j = (k + 2) % 3;
                n[k] = way[p][i] * way[q][j] - way[p][j] * way[q][i];
            }
            most = fmaxl(most, apart_along(s, corners, count, n));
        }
    }
    return most;
}

/* A verdict's proof: a point of both, or a plane between them. */
static void check_verdict(const struct oracle_shadow *s, const long double (*corners)[3], int count, size_t found[3])
{
    long double witness[3];
    const int verdict = oracle_shadow_meets(s, corners, count, witness);
    found[verdict]++;
    CHECK(oracle_shadow_meets(s, corners, count, NULL) == verdict, "by corners alone another");
    if (verdict == ORACLE_OUT) {
        CHECK(separation(s, corners, count) > 0, "out, and no plane between: %Lg", separation(s, corners, count));
    } else {
        const long double excess = oracle_shadow_excess(s, (const long double *)witness);
        CHECK(excess <= (verdict == ORACLE_SURE ? 2 : 100) * s->eps, "verdict %d, witness %Lg out", verdict, excess);
    }
    if (verdict == ORACLE_SURE)
        CHECK(separation(s, corners, count) <= 0, "surely in, and %Lg apart", separation(s, corners, count));
    for (int i = 0; i <= 4; i++)
        for (int j = 0; j <= 4 - i; j++) {
            const long double weight[3] = { i / 4.0L, j / 4.0L, (4 - i - j) / 4.0L };
            long double x[3] = { 0, 0, 0 };
            for (int c = 0; c < 3; c++)
                for (int k = 0; k < 3; k++)
                    x[k] += weight[c] * corners[c < count ? c : 0][k];
            CHECK(verdict != ORACLE_OUT || oracle_shadow_excess(s, (const long double *)x) > 0,
                  "out, and a point of it is not");
        }
}

static void verdicts_have_proofs(void)
{
    uint64_t seed = 1;
    size_t found[2][3] = { { 0 } };
    for (int i = 0; i < (int)part_of(16000); i++) {
        struct oracle_shadow s;
        double ends[6], direction[3];
        long double corners[3][3];
        const double size = ONE_OF(&seed, 0.05, 0.3, 1);
        for (int k = 0; k < 6; k++)
            ends[k] = random_in(&seed, -1, 1);
        if (i % 16 == 0)
            memcpy(ends + 3, ends, 3 * sizeof *ends);
        random_unit(&seed, direction);
        if (i % 16 == 1)
            for (int k = 0; k < 3; k++)
                direction[k] = ends[3 + k] - ends[k] + ONE_OF(&seed, 0, 1e-7, 1e-3) * direction[k];
        oracle_shadow_make(&s, ends, ONE_OF(&seed, 0, 0.01, 0.2, 1), direction, ONE_OF(&seed, 0, 0.01, 0.2, 1), 2, 2);
        const double middle[3] = { random_in(&seed, -1, 1), random_in(&seed, -1, 1), random_in(&seed, -1, 1) };
        for (int c = 0; c < 9; c++)
            corners[c / 3][c % 3] = middle[c % 3] + size * random_in(&seed, -1, 1);
        check_verdict(&s, (const long double(*)[3])corners, 3, found[0]);
        check_verdict(&s, (const long double(*)[3])corners, 2, found[1]);
    }
    printf("    triangles: %zu out, %zu maybe, %zu surely in; edges: %zu, %zu, %zu\n", found[0][0], found[0][1],
           found[0][2], found[1][0], found[1][1], found[1][2]);
    CHECK(found[0][2] > part_of(2000) && found[1][2] > part_of(1500) && found[0][0] > part_of(8000), "one kind alone");
}

/* A tool above the middle of a flat sheet: what it shades can be counted. */
static void a_flat_sheet_by_hand(void)
{
    struct subject subject;
    struct scene scene;
    struct guarded_strip guarded;
    if (!subject_from_shape(&subject, "membrane", 800))
        return;
    scene_open(&scene, &subject);
    dpt_strip *strip = guarded_strip_open(&guarded, 800, 0);
    /* Cells of 0.01 m; from x = -0.025 to 0.025 and y = 0.005 -+ 0.012. */
    const double ends[6] = { -0.023, 0.005, 0.01, 0.023, 0.005, 0.01 };
    dpt_shadow shadow;
    shadow_below(&scene, ends, 0.002, &shadow);
    shadow.depth = 0.02;
    for (int wide = 0; wide < 2; wide++) {
        shadow.width = wide ? 0.01 : 0;
        uint32_t count = 0, flags = 0, wanted = 0;
        fill_strip(&scene, &shadow, strip);
        dpt_strip_get_triangles(strip, &count, &flags);
        /* The rectangle against each triangle: both lie in a plane, so by the sides of each. */
        const double x = 0.023 + 0.002 + shadow.width, y = 0.002 + shadow.width;
        for (uint32_t t = 0; t < 800; t++) {
            double c[9], box[4] = { 1, -1, 1, -1 };
            int out = 0;
            dpt_mesh_get_triangle(subject.mesh, t, c);
            for (int i = 0; i < 3; i++) {
                box[0] = fmin(box[0], c[3 * i]);
                box[1] = fmax(box[1], c[3 * i]);
                box[2] = fmin(box[2], c[3 * i + 1] - 0.005);
                box[3] = fmax(box[3], c[3 * i + 1] - 0.005);
            }
            out |= box[0] > x || box[1] < -x || box[2] > y || box[3] < -y;
            for (int i = 0; i < 3; i++) {
                const double *p = c + 3 * i, *q = c + 3 * ((i + 1) % 3);
                const double n[2] = { q[1] - p[1], p[0] - q[0] };
                const double from = n[0] * p[0] + n[1] * (p[1] - 0.005);
                out |= -fabs(n[0]) * x - fabs(n[1]) * y > from;
            }
            wanted += !out;
        }
        CHECK(count == wanted && flags == 0 && wanted > 10, "%u triangles, not %u, flags %u", count, wanted, flags);
        ask_oracle(&scene, &shadow);
        CHECK(scene.sheet.sure == wanted && scene.sheet.maybe == wanted, "the oracle: %u to %u", scene.sheet.sure,
              scene.sheet.maybe);
    }
    guarded_strip_close(&guarded);
    scene_close(&scene);
    subject_close(&subject);
}

/* Shadows without a volume, or with next to none: an axis through a triangle meets it, whatever the direction. */
static void mere_lines(void)
{
    static const uint32_t corners[3] = { 0, 1, 2 };
    static const char *const kinds[] = { "along", "nearly along", "across", "any way" };
    struct guarded_strip guarded;
    uint64_t seed = 8;
    size_t missed[4] = { 0, 0, 0, 0 };
    dpt_strip *strip = guarded_strip_open(&guarded, 4, 0);
    for (int i = 0; i < 4000; i++) {
        struct subject subject;
        double vertices[9], way[3], tilt[3];
        dpt_shadow shadow = { .size = sizeof shadow };
        for (int k = 0; k < 9; k++)
            vertices[k] = (float)random_in(&seed, -1, 1);
        random_unit(&seed, way);
        random_unit(&seed, tilt);
        for (int k = 0; k < 3; k++) {
            const double x = 0.3 * vertices[k] + 0.45 * vertices[3 + k] + 0.25 * vertices[6 + k];
            shadow.segment.a[k] = x - 0.4 * way[k];
            shadow.segment.b[k] = x + 0.6 * way[k];
        }
        const double off[4] = { 0, ONE_OF(&seed, 1e-13, 1e-10, 2e-9, 1e-7, 1e-4), -dot3(way, tilt), 1 };
        for (int k = 0; k < 3; k++)
            shadow.direction[k] = i % 4 == 2   ? tilt[k] + off[2] * way[k]
                                  : i % 4 == 3 ? tilt[k]
                                               : shadow.segment.b[k] - shadow.segment.a[k] + off[i % 4] * tilt[k];
        shadow.depth = i % 8 < 4 ? 0 : 0.1;
        if (subject_from_arrays(&subject, "triangle", vertices, 3, corners, 1)) {
            uint32_t count = 0;
            const dpt_result result = dpt_strip_shadow(strip, subject.mesh, NULL, &shadow);
            dpt_strip_get_triangles(strip, &count, NULL);
            CHECK(result == DPT_OK, "%s", dpt_result_name(result));
            missed[i % 4] += count != 1;
        }
        subject_close(&subject);
    }
    for (int kind = 0; kind < 4; kind++)
        CHECK(missed[kind] == 0, "%zu of 1000 missed, %s the direction", missed[kind], kinds[kind]);
    guarded_strip_close(&guarded);
}

static void generated_shapes(void)
{
    static const struct {
        const char *name;
        uint64_t count, shadows;
    } shapes[] = { { "torus", 32, 400 },   { "torus", 5568, 800 },    { "liver", 50332, 300 }, { "membrane", 512, 800 },
                   { "cloth", 2048, 800 }, { "star", 20480, 400 },    { "sphere", 20, 200 },   { "box", 12, 400 },
                   { "box", 1200, 400 },   { "stomach", 20001, 300 }, { "hub", 500, 400 },     { "hub", 50000, 60 } };
    struct subject subject;
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        if (subject_from_shape(&subject, shapes[i].name, shapes[i].count))
            try_shadows(&subject, shapes[i].shadows, i);
        subject_close(&subject);
    }
}

/* Triangles at random: edges of one, two and many triangles everywhere. */
static void random_lattices(void)
{
    struct subject subject;
    const struct tally before = totals;
    for (uint64_t seed = 0; seed < 12; seed++) {
        const uint32_t size = 3 + (uint32_t)seed % 4;
        if (subject_from_lattice(&subject, size, 20 + 60 * (uint32_t)seed, seed))
            try_shadows(&subject, 200, seed);
        subject_close(&subject);
    }
    CHECK(totals.borders - before.borders > least_seen(200) &&
              totals.nonmanifold - before.nonmanifold > least_seen(200),
          "%zu borders, %zu nonmanifold", totals.borders - before.borders, totals.nonmanifold - before.nonmanifold);
}

static void try_public(const struct subject *subject)
{
    uint64_t seed = 5381;
    for (const char *c = subject->name; *c; c++)
        seed = 33 * seed + (unsigned char)*c;
    try_shadows(subject, subject->info.triangles > 20000 ? 40 : 60, seed);
}

static void public_meshes(void)
{
    const size_t before = totals.meshes;
    for_public_meshes(data, try_public);
    CHECK(totals.meshes - before >= 60, "%zu meshes", totals.meshes - before);
}

static void shadows_of_all_kinds(void)
{
    printf("    %zu meshes, %zu shadows: %zu empty, %zu at borders, %zu over edges of many, %zu full; "
           "%zu of %zu triangles in doubt\n",
           totals.meshes, totals.shadows, totals.empty, totals.borders, totals.nonmanifold, totals.full, totals.doubts,
           totals.triangles);
    CHECK(totals.empty * 50 > totals.shadows && totals.empty * 2 < totals.shadows, "%zu of %zu empty", totals.empty,
          totals.shadows);
    CHECK(totals.borders > least_seen(300) && totals.nonmanifold > least_seen(150) && totals.full > least_seen(1000),
          "%zu, %zu, %zu", totals.borders, totals.nonmanifold, totals.full);
    CHECK(totals.doubts * 200 < totals.clear, "%zu of %zu in doubt", totals.doubts, totals.clear);
}

static void folds(void)
{
    struct subject subject;
    struct scene scene;
    struct guarded_strip guarded;
    const double between = 0.002;
    if (!subject_with_folds(&subject, between))
        return;
    scene_open(&scene, &subject);
    dpt_strip *strip = guarded_strip_open(&guarded, subject.info.triangles, 0);
    for (int layer = 0; layer < 2; layer++)
        for (int i = 0; i < 40; i++) {
            /* Lies above the upper layer; in the middle, or out to the fold at x = 0.2 between layers 0 and 1. */
            const double x = 0.05 + 0.0011 * i, far = layer ? 0.205 : x + 0.06;
            const double ends[6] = { x, 0.0503, 0.0015, far, 0.0903 + 0.001 * i, 0.0015 };
            dpt_shadow shadow;
            uint32_t count = 0, below = 0, third = 0;
            shadow_below(&scene, ends, 0.001, &shadow);
            shadow.width = 0.001 * (i % 5);
            shadow.depth = 0.02;
            fill_strip(&scene, &shadow, strip);
            ask_oracle(&scene, &shadow);
            check_sheet(&scene, &shadow, strip);
            const uint32_t *triangles = dpt_strip_get_triangles(strip, &count, NULL);
            for (uint32_t k = 0; k < count; k++) {
                double c[9];
                dpt_mesh_get_triangle(subject.mesh, triangles[k], c);
                below += fmin(c[2], fmin(c[5], c[8])) < -0.5 * between;
                third += fmin(c[2], fmin(c[5], c[8])) < -1.5 * between;
            }
            CHECK(count > 8 && (below > 0) == layer && third == 0, "%u triangles, %u below, %u of the third layer: %s",
                  count, below, third, shadow_text(&scene, &shadow));
        }
    try_shadows(&subject, 400, 5);
    guarded_strip_close(&guarded);
    scene_close(&scene);
    subject_close(&subject);
}

enum { BAD = 19 };

/* Shadows that are wrong in one thing each, and the code that is due. Triangle 2 has no area. */
static void make_bad_shadows(const dpt_shadow *good, dpt_shadow bad[BAD], dpt_result due[BAD])
{
    for (int i = 0; i < BAD; i++) {
        bad[i] = *good;
        due[i] = i < 10 ? DPT_E_FINITE : DPT_E_ARGUMENT;
    }
    bad[0].segment.a[1] = NAN;
    bad[1].segment.b[2] = INFINITY;
    bad[2].segment.b[0] = -1.1e6;
    bad[3].segment.radius = NAN;
    bad[4].direction[0] = NAN;
    bad[5].direction[2] = -INFINITY;
    bad[6].width = NAN;
    bad[7].depth = NAN;
    bad[8].width = INFINITY;
    bad[9].depth = INFINITY;
    bad[10].segment.radius = -1e-3;
    bad[11].width = -1e-3;
    bad[12].depth = -1e-3;
    bad[13].direction[2] = 0;
    bad[14].triangle = 3;
    bad[15].triangle = DPT_NONE;
    bad[16].triangle = 2;
    due[16] = DPT_E_DROPPED;
    bad[17].size = 0;
    due[17] = DPT_E_SIZE;
    bad[18].size = 8;
    due[18] = DPT_E_SIZE;
}

static void bad_arguments(void)
{
    /* 3 has no area. */
    static const double vertices[] = { 0, 0, 0, 0.1, 0, 0, 0, 0.1, 0, 0.1, 0.1, 0 };
    static const uint32_t corners[] = { 0, 1, 2, 1, 3, 2, 0, 0, 1 };
    const dpt_shadow good = { .size = sizeof good,
                              .segment = { { 0.02, 0.02, 0.01 }, { 0.05, 0.03, 0.01 }, 0.001 },
                              .direction = { 0, 0, -1 },
                              .depth = 0.05 };
    struct subject subject;
    struct guarded_strip guarded;
    if (!subject_from_arrays(&subject, "square", vertices, 4, corners, 3))
        return;
    dpt_strip *strip = guarded_strip_open(&guarded, 8, 0);
    dpt_shadow bad[BAD];
    dpt_result due[BAD];
    make_bad_shadows(&good, bad, due);
    for (int i = 0; i < BAD + 4; i++) {
        const dpt_pose bent = { { 0, 0, 0 }, { 1, 1, 0, 0 } };
        const dpt_pose far = { { NAN, 0, 0 }, { 1, 0, 0, 0 } };
        uint32_t count = 0, flags = 0;
        dpt_strip_get_triangles(strip, &count, NULL);
        CHECK(dpt_strip_shadow(strip, subject.mesh, NULL, &good) == DPT_OK, "%d", i);
        dpt_strip_get_triangles(strip, &count, &flags);
        CHECK(count == 1 && flags == 0, "%u triangles, flags %u", count, flags);
        const dpt_result result = i < BAD        ? dpt_strip_shadow(strip, subject.mesh, NULL, &bad[i])
                                  : i == BAD     ? dpt_strip_shadow(strip, NULL, NULL, &good)
                                  : i == BAD + 1 ? dpt_strip_shadow(strip, subject.mesh, NULL, NULL)
                                  : i == BAD + 2 ? dpt_strip_shadow(strip, subject.mesh, &bent, &good)
                                                 : dpt_strip_shadow(strip, subject.mesh, &far, &good);
        const dpt_result wanted = i < BAD        ? due[i]
                                  : i < BAD + 2  ? DPT_E_ARGUMENT
                                  : i == BAD + 2 ? DPT_E_POSE
                                                 : DPT_E_FINITE;
        dpt_strip_get_triangles(strip, &count, &flags);
        /* Of a radius below 0 the header does not say which. */
        CHECK((result == wanted || (i == 10 && result == DPT_E_FINITE)) && count == 0 && flags == 0,
              "%d: %s, not %s; %u triangles", i, dpt_result_name(result), dpt_result_name(wanted), count);
    }
    CHECK(dpt_strip_shadow(NULL, subject.mesh, NULL, &good) == DPT_E_ARGUMENT, "no strip");
    guarded_strip_close(&guarded);
    subject_close(&subject);
}

int main(int argc, char **argv)
{
    setvbuf(stdout, NULL, _IOLBF, 0);
    data = getenv("DPT_DATA");
    take_percent(argc, argv);
    TEST(verdicts_have_proofs);
    TEST(a_flat_sheet_by_hand);
    TEST(mere_lines);
    TEST(generated_shapes);
    TEST(random_lattices);
    if (data)
        TEST(public_meshes);
    else
        SKIP("shadows on public meshes", "DPT_DATA does not name the data folder");
    TEST(folds);
    TEST(shadows_of_all_kinds);
    TEST(bad_arguments);
    return check_report();
}
