/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Stateless queries: the tree against brute force bit for bit, batches against single questions, poses,
 * sign against closed forms, and input that cannot be answered.
 */
#include "lib/fixture.h"
#include "lib/pose.h"

#define COUNT 400

static void random_axis(uint64_t *random, double reach, double size, double ends[6])
{
    for (int k = 0; k < 3; k++) {
        ends[k] = random_in(random, -reach, reach);
        ends[3 + k] = ends[k] + random_in(random, -size, size);
    }
}

/* Tools of all sizes, near and far, points among them. */
static void random_axes(uint64_t seed, double ends[6 * COUNT])
{
    for (int i = 0; i < COUNT; i++) {
        double size = i % 10 == 0 ? 0.0 : pow(10.0, random_in(&seed, -3.0, 0.5));
        random_axis(&seed, i % 7 == 0 ? 5.0 : 0.18, size, ends + 6 * i);
    }
}

static void ask(const dpt_mesh *mesh, const double *ends, size_t n, uint32_t method, dpt_hit *hits)
{
    const dpt_query_def def = { .size = sizeof def, .method = method };
    hits[0].size = sizeof *hits;
    dpt_result result = dpt_query_segments(mesh, NULL, ends, NULL, n, hits, &def);
    CHECK(result == DPT_OK, "%s", dpt_result_name(result));
}

static void tree_gives_the_bits_of_brute_force(void)
{
    const struct {
        const char *name;
        uint32_t count;
    } shapes[] = { { "torus", 5568 }, { "star", 0 },      { "membrane", 0 }, { "cloth", 0 },
                   { "hub", 500 },    { "sphere", 2000 }, { "box", 0 },      { "liver", 8000 } };
    double ends[6 * COUNT];
    const size_t count = (size_t)part_of(COUNT);
    static dpt_hit tree[COUNT], brute[COUNT];
    for (size_t s = 0; s < sizeof shapes / sizeof *shapes; s++) {
        struct fixture fixture;
        if (!fixture_from_shape(&fixture, shapes[s].name, shapes[s].count))
            continue;
        int crossing = 0;
        random_axes(s + 1, ends);
        ask(fixture.mesh, ends, count, DPT_METHOD_TREE, tree);
        ask(fixture.mesh, ends, count, DPT_METHOD_BRUTE, brute);
        for (size_t i = 0; i < count; i++) {
            CHECK(tree[i].distance == brute[i].distance, "%s: %a, not %a", shapes[s].name, tree[i].distance,
                  brute[i].distance);
            CHECK(tree[i].distance == 0.0 || tree[i].triangle == brute[i].triangle, "%s: triangle %u, not %u at %a",
                  shapes[s].name, tree[i].triangle, brute[i].triangle, tree[i].distance);
            CHECK(tree[i].status == DPT_STATUS_EXACT, "status %u", tree[i].status);
            crossing += tree[i].distance == 0.0;
        }
        printf("    %-10s %d of %zu cross\n", shapes[s].name, crossing, count);
        fixture_free(&fixture);
    }
}

/* Points on the mesh, each asked after one on the same triangle, whose distance to it is 0 already. */
static void points_on_the_mesh(void)
{
    struct fixture fixture;
    double ends[6 * COUNT];
    static dpt_hit batch[COUNT];
    if (!fixture_from_shape(&fixture, "box", 0))
        return;
    for (int i = 0; i < COUNT; i++) {
        double corners[9];
        dpt_mesh_get_triangle(fixture.mesh, (uint32_t)i / 3 % 12, corners);
        for (int k = 0; k < 3; k++)
            ends[6 * i + k] = ends[6 * i + 3 + k] = corners[3 * (i % 3) + k];
    }
    ask(fixture.mesh, ends, COUNT, DPT_METHOD_TREE, batch);
    for (int i = 0; i < COUNT; i++) {
        dpt_hit alone = DPT_HIT_INIT;
        dpt_query_segments(fixture.mesh, NULL, ends + 6 * i, NULL, 1, &alone, NULL);
        CHECK(!signbit(batch[i].depth), "%d: depth %g", i, batch[i].depth);
        CHECK(batch[i].distance == 0.0 && batch[i].contact == DPT_CONTACT_TOUCHING &&
                  batch[i].triangle == alone.triangle && alone.triangle < 12,
              "%d: %a from %u, contact %u; alone %a from %u", i, batch[i].distance, batch[i].triangle, batch[i].contact,
              alone.distance, alone.triangle);
    }
    fixture_free(&fixture);
}

static void a_batch_is_its_single_questions(void)
{
    struct fixture fixture;
    double ends[6 * COUNT];
    static dpt_hit batch[COUNT];
    if (!fixture_from_shape(&fixture, "torus", 5568))
        return;
    random_axes(5, ends);
    ask(fixture.mesh, ends, COUNT, DPT_METHOD_EXACT, batch);
    for (int i = 0; i < COUNT; i++) {
        dpt_hit one = DPT_HIT_INIT;
        ask(fixture.mesh, ends + 6 * i, 1, DPT_METHOD_EXACT, &one);
        one.work = batch[i].work; /* the neighbour's answer only saves work */
        CHECK(!memcmp(&one, &batch[i], sizeof one), "answer %d depends on its neighbours", i);
    }
    fixture_free(&fixture);
}

static void a_pose_moves_the_mesh(void)
{
    struct fixture fixture;
    double ends[6 * COUNT], moved[6 * COUNT];
    static dpt_hit plain[COUNT], posed[COUNT];
    const dpt_pose pose = { { 0.3, -0.2, 0.7 }, { 0.5, 0.5, -0.5, 0.5 } };
    if (!fixture_from_shape(&fixture, "liver", 4000))
        return;
    random_axes(6, ends);
    for (int i = 0; i < 2 * COUNT; i++)
        pose_point(&pose, ends + 3 * i, moved + 3 * i);
    ask(fixture.mesh, ends, COUNT, DPT_METHOD_TREE, plain);
    posed[0].size = sizeof *posed;
    dpt_result result = dpt_query_segments(fixture.mesh, &pose, moved, NULL, COUNT, posed, NULL);
    CHECK(result == DPT_OK, "%s", dpt_result_name(result));
    for (int i = 0; i < COUNT; i++) {
        double off = fabs(posed[i].distance - plain[i].distance);
        CHECK(off <= posed[i].error_bound + plain[i].error_bound, "distance off by %g", off);
        double apart = 0.0;
        for (int k = 0; k < 3; k++)
            apart += pow(posed[i].p[k] - posed[i].q[k], 2.0);
        CHECK(fabs(sqrt(apart) - posed[i].distance) <= posed[i].error_bound, "p and q off by %g",
              sqrt(apart) - posed[i].distance);
    }
    fixture_free(&fixture);
}

static double height_over_box(const double *half, const double *a, const double *b, double s)
{
    double outside = 0.0, depth = INFINITY;
    for (int k = 0; k < 3; k++) {
        double beyond = fabs(a[k] + s * (b[k] - a[k])) - half[k];
        outside += beyond > 0.0 ? beyond * beyond : 0.0;
        depth = fmin(depth, -beyond);
    }
    return outside > 0.0 ? sqrt(outside) : -depth;
}

/* The height over a box is convex along a line: thirds lead to the least one. */
static double least_height(const double *half, const double *a, const double *b)
{
    double from = 0.0, to = 1.0;
    for (int i = 0; i < 120; i++) {
        double third = (to - from) / 3.0;
        if (height_over_box(half, a, b, from + third) < height_over_box(half, a, b, to - third))
            to -= third;
        else
            from += third;
    }
    return height_over_box(half, a, b, 0.5 * (from + to));
}

/* A box: where the tool is, and how far its surface. */
static void sign_and_gap_of_a_box(void)
{
    struct fixture fixture;
    dpt_mesh_info info = { .size = sizeof info };
    if (!fixture_from_shape(&fixture, "box", 12))
        return;
    dpt_mesh_get_info(fixture.mesh, &info);
    const double *half = info.box_max;
    CHECK(half[0] == -info.box_min[0] && half[1] == -info.box_min[1], "not centred");
    uint64_t random = 9;
    int inside = 0, crossing = 0;
    for (int i = 0; i < 10000; i++) {
        double ends[6], radius = i % 2 ? 0.01 : 0.0;
        dpt_hit hit = DPT_HIT_INIT;
        random_axis(&random, 2.0 * half[0], i % 3 ? 0.0 : 0.3 * half[0], ends);
        dpt_query_segments(fixture.mesh, NULL, ends, &radius, 1, &hit, NULL);
        double gap = least_height(half, ends, ends + 3) - radius;
        double allowed =
            gap + radius > 0.0 ? 1e-12 : 2e-5 * sqrt(half[0] * half[0] + half[1] * half[1] + half[2] * half[2]);
        inside += hit.distance > 0.0 && gap + radius < 0.0;
        crossing += hit.distance == 0.0;
        CHECK(hit.flags == (DPT_HIT_FLAG_GAP | (hit.distance == 0.0 ? DPT_HIT_FLAG_CROSSING : 0)), "flags %u",
              hit.flags);
        CHECK(fabs(hit.gap - gap) <= allowed, "gap %.17g, not %.17g", hit.gap, gap);
        CHECK(hit.depth == fmax(0.0, -hit.gap), "depth %.17g", hit.depth);
        if (fabs(gap) < allowed + hit.error_bound)
            continue;
        CHECK(hit.contact == (gap > hit.error_bound    ? DPT_CONTACT_SEPARATED
                              : gap < -hit.error_bound ? DPT_CONTACT_PENETRATING
                                                       : DPT_CONTACT_TOUCHING),
              "contact %u at gap %g", hit.contact, gap);
    }
    CHECK(inside > 100 && crossing > 100, "only %d inside, %d crossing", inside, crossing);
    fixture_free(&fixture);
}

/* Over the common edge of two triangles both are as near: the least source number wins. */
static void ties_go_to_the_least_number(void)
{
    const double vertices[] = { 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 5, 5, 5, 6, 5, 5, 5, 6, 5 };
    const uint32_t orders[2][9] = { { 4, 5, 6, 0, 1, 2, 0, 2, 3 }, { 0, 2, 3, 4, 5, 6, 0, 1, 2 } };
    const double ends[6] = { 0.5, 0.5, 0.25, 0.5, 0.5, 0.75 };
    for (uint32_t i = 0; i < 2; i++) {
        struct fixture fixture;
        if (!fixture_from_arrays(&fixture, vertices, 7, orders[i], 3))
            continue;
        for (uint32_t method = DPT_METHOD_TREE; method <= DPT_METHOD_BRUTE; method++) {
            dpt_hit hit = DPT_HIT_INIT;
            ask(fixture.mesh, ends, 1, method, &hit);
            CHECK(hit.triangle == 1 - i && hit.distance == 0.25, "method %u: triangle %u at %g", method, hit.triangle,
                  hit.distance);
        }
        fixture_free(&fixture);
    }
}

/* Solid angles over 4 pi (Van Oosterom and Strackee 1983): 1 inside, 0 outside. */
static double winding_number(const dpt_mesh *mesh, uint32_t triangles, const double x[3])
{
    double sum = 0.0;
    for (uint32_t t = 0; t < triangles; t++) {
        double c[9], size[3], d[3];
        dpt_mesh_get_triangle(mesh, t, c);
        for (int k = 0; k < 9; k++)
            c[k] -= x[k % 3];
        for (int k = 0; k < 3; k++) {
            const double *a = c + 3 * k, *b = c + 3 * ((k + 1) % 3);
            size[k] = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
            d[k] = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        }
        double six = c[0] * (c[4] * c[8] - c[5] * c[7]) + c[1] * (c[5] * c[6] - c[3] * c[8]) +
                     c[2] * (c[3] * c[7] - c[4] * c[6]);
        sum += 2.0 * atan2(six, size[0] * size[1] * size[2] + d[0] * size[2] + d[1] * size[0] + d[2] * size[1]);
    }
    return sum / (4.0 * 3.14159265358979323846);
}

/* Points around edges and vertices of a spiky body, where a face's own normal would mislead. */
static void sign_is_the_winding_number(void)
{
    struct fixture fixture;
    dpt_mesh_info info = { .size = sizeof info };
    uint64_t random = 31;
    int inside = 0, count = 3000;
    if (!fixture_from_shape(&fixture, "star", 2000))
        return;
    dpt_mesh_get_info(fixture.mesh, &info);
    for (int i = 0; i < count; i++) {
        double corners[9], ends[6], share = i % 2 ? 0.0 : random_in(&random, 0.0, 1.0);
        dpt_hit hit = DPT_HIT_INIT;
        dpt_mesh_get_triangle(fixture.mesh, (uint32_t)(random_bits(&random) % info.triangles), corners);
        for (int k = 0; k < 3; k++)
            ends[k] = ends[3 + k] =
                corners[k] + share * (corners[3 + k] - corners[k]) + random_in(&random, -0.004, 0.004);
        ask(fixture.mesh, ends, 1, DPT_METHOD_EXACT, &hit);
        int in = winding_number(fixture.mesh, info.triangles, ends) > 0.5;
        inside += in;
        CHECK((hit.gap < 0.0) == in, "gap %g, but %s", hit.gap, in ? "inside" : "outside");
    }
    CHECK(inside > count / 5 && inside < 4 * count / 5, "%d of %d inside", inside, count);
    fixture_free(&fixture);
}

/* Through an open sheet there is no side yet; through a soup the axis is at gap -radius. */
static void crossing_without_an_inside(void)
{
    struct fixture fixture;
    double radius = 0.002;
    const double ends[6] = { 0.011, 0.013, -0.1, 0.012, 0.017, 0.1 };
    dpt_hit hit = DPT_HIT_INIT;
    if (fixture_from_shape(&fixture, "membrane", 0)) {
        dpt_query_segments(fixture.mesh, NULL, ends, &radius, 1, &hit, NULL);
        CHECK(hit.distance == 0.0 && hit.contact == DPT_CONTACT_UNKNOWN, "contact %u", hit.contact);
        CHECK(hit.flags == (DPT_HIT_FLAG_CROSSING | DPT_HIT_FLAG_NO_SIDE) && hit.gap == 0.0, "flags %u", hit.flags);
        fixture_free(&fixture);
    }
    /* Three triangles on one edge: not a manifold. */
    const double vertices[] = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1 };
    const uint32_t corners[] = { 0, 1, 2, 0, 1, 3, 0, 1, 4 };
    const double through[6] = { 0.2, 0.2, -1.0, 0.2, 0.2, 0.1 };
    if (fixture_from_arrays(&fixture, vertices, 5, corners, 3)) {
        dpt_query_segments(fixture.mesh, NULL, through, &radius, 1, &hit, NULL);
        CHECK(hit.distance == 0.0 && hit.contact == DPT_CONTACT_PENETRATING, "contact %u", hit.contact);
        CHECK(hit.flags == (DPT_HIT_FLAG_CROSSING | DPT_HIT_FLAG_GAP) && hit.gap == -radius, "gap %g", hit.gap);
        fixture_free(&fixture);
    }
}

/* 40 sheets: more crossings than there is room for. */
static void more_crossings_than_there_is_room_for(void)
{
    enum { SHEETS = 40 };
    struct fixture fixture;
    double vertices[9 * SHEETS];
    uint32_t corners[3 * SHEETS];
    const double through[6] = { 0.2, 0.2, -1.0, 0.2, 0.2, SHEETS }, radius = 0.0;
    dpt_hit hit = DPT_HIT_INIT;
    for (uint32_t i = 0; i < SHEETS; i++) {
        const double triangle[9] = { 0, 0, i, 1, 0, i, 0, 1, i };
        memcpy(vertices + 9 * i, triangle, sizeof triangle);
        for (uint32_t k = 0; k < 3; k++)
            corners[3 * i + k] = 3 * i + k;
    }
    if (!fixture_from_arrays(&fixture, vertices, 3 * SHEETS, corners, SHEETS))
        return;
    dpt_query_segments(fixture.mesh, NULL, through, &radius, 1, &hit, NULL);
    CHECK(hit.contact == DPT_CONTACT_UNKNOWN && (hit.flags & DPT_HIT_FLAG_CROSSINGS_FULL) &&
              !(hit.flags & (DPT_HIT_FLAG_GAP | DPT_HIT_FLAG_BUDGET)),
          "contact %u, flags %u", hit.contact, hit.flags);
    fixture_free(&fixture);
}

static void answers_all_it_can(void)
{
    struct fixture fixture;
    dpt_hit hits[3] = { DPT_HIT_INIT };
    double ends[18] = { 0 };
    if (!fixture_from_shape(&fixture, "box", 12))
        return;
    ends[7] = NAN;
    dpt_result result = dpt_query_segments(fixture.mesh, NULL, ends, NULL, 3, hits, NULL);
    CHECK(result == DPT_E_FINITE, "%s", dpt_result_name(result));
    CHECK(hits[0].status == DPT_STATUS_EXACT && hits[2].status == DPT_STATUS_EXACT, "others");
    CHECK(hits[1].status == DPT_STATUS_STALE && hits[1].triangle == DPT_NONE, "stale");
    CHECK(hits[1].distance == 0.0 && hits[1].p[0] == 0.0, "a stale answer has numbers");
    ends[7] = 2e6;
    CHECK(dpt_query_segments(fixture.mesh, NULL, ends, NULL, 3, hits, NULL) == DPT_E_FINITE, "far");
    ends[7] = 0.0;
    const double bad_radius[3] = { 0.0, -1.0, 0.0 };
    CHECK(dpt_query_segments(fixture.mesh, NULL, ends, bad_radius, 3, hits, NULL) == DPT_E_FINITE, "radius");
    fixture_free(&fixture);
}

/* A caller from the future has longer hits: their stride is its own, what it knows more is zero. */
static void longer_hits_are_zero_behind(void)
{
    struct fixture fixture;
    struct {
        dpt_hit hit;
        double newer[3];
    } hits[2];
    const double ends[12] = { 1, 0, 0, 2, 0, 0, 0, 1, 0, 0, 2, 0 };
    dpt_hit plain[2] = { DPT_HIT_INIT };
    if (!fixture_from_shape(&fixture, "box", 12))
        return;
    memset(hits, 0x5a, sizeof hits);
    hits[0].hit.size = sizeof hits[0];
    dpt_query_segments(fixture.mesh, NULL, ends, NULL, 2, &hits[0].hit, NULL);
    dpt_query_segments(fixture.mesh, NULL, ends, NULL, 2, plain, NULL);
    for (int i = 0; i < 2; i++) {
        CHECK(hits[i].hit.size == sizeof hits[0] && hits[i].hit.distance == plain[i].distance, "hit %d", i);
        const unsigned char *tail = (const unsigned char *)hits[i].newer;
        for (size_t k = 0; k < sizeof hits[i].newer; k++)
            CHECK(tail[k] == 0, "byte %zu of the tail", k);
    }
    fixture_free(&fixture);
}

static void refuses_what_it_cannot(void)
{
    struct fixture fixture;
    dpt_hit hit = DPT_HIT_INIT;
    const double ends[6] = { 0 };
    if (!fixture_from_shape(&fixture, "box", 12))
        return;
    const dpt_mesh *mesh = fixture.mesh;
    CHECK(dpt_query_segments(NULL, NULL, ends, NULL, 1, &hit, NULL) == DPT_E_ARGUMENT, "mesh");
    CHECK(dpt_query_segments(mesh, NULL, NULL, NULL, 1, &hit, NULL) == DPT_E_ARGUMENT, "ends");
    CHECK(dpt_query_segments(mesh, NULL, ends, NULL, 1, NULL, NULL) == DPT_E_ARGUMENT, "hits");
    CHECK(dpt_query_segments(mesh, NULL, ends, NULL, 0, NULL, NULL) == DPT_OK, "none asked");
    const size_t counts[] = { UINT32_MAX, UINT32_MAX - 1, (size_t)INT32_MAX + 1, SIZE_MAX };
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        CHECK(dpt_query_segments(mesh, NULL, ends, NULL, counts[i], &hit, NULL) == DPT_E_LIMIT, "%zu", counts[i]);
    hit.size = 8;
    CHECK(dpt_query_segments(mesh, NULL, ends, NULL, 1, &hit, NULL) == DPT_E_SIZE, "size");
    hit.size = sizeof hit;
    dpt_query_def def = { .size = sizeof def, .method = 77 };
    CHECK(dpt_query_segments(mesh, NULL, ends, NULL, 1, &hit, &def) == DPT_E_ARGUMENT, "method");
    def = (dpt_query_def){ .size = sizeof def, .kernel = 77 };
    CHECK(dpt_query_segments(mesh, NULL, ends, NULL, 1, &hit, &def) == DPT_E_UNSUPPORTED, "kernel");
    def = (dpt_query_def){ .size = sizeof def, .pair = 2 };
    CHECK(dpt_query_segments(mesh, NULL, ends, NULL, 1, &hit, &def) == DPT_E_ARGUMENT, "pair");
    def = (dpt_query_def){ .size = 4 };
    CHECK(dpt_query_segments(mesh, NULL, ends, NULL, 1, &hit, &def) == DPT_E_SIZE, "def size");
    dpt_pose pose = DPT_POSE_IDENTITY;
    pose.orientation[0] = 1.1;
    CHECK(dpt_query_segments(mesh, &pose, ends, NULL, 1, &hit, NULL) == DPT_E_POSE, "quaternion");
    pose.orientation[0] = NAN;
    CHECK(dpt_query_segments(mesh, &pose, ends, NULL, 1, &hit, NULL) == DPT_E_POSE, "nan");
    pose = (dpt_pose)DPT_POSE_IDENTITY;
    pose.position[1] = INFINITY;
    CHECK(dpt_query_segments(mesh, &pose, ends, NULL, 1, &hit, NULL) == DPT_E_FINITE, "position");
    fixture_free(&fixture);
}

/* The pair distance at the ends of its range: sixth powers must not be formed. */
static void pair_keeps_its_range(void)
{
    for (int e = -58; e <= 59; e++) {
        double k = pow(10.0, e), p[3], q[3];
        const double triangle[9] = { 0, 0, 0, k, 0, 0, 0, k, 0 };
        const double segment[6] = { 0.2 * k, 0.2 * k, k, 0.2 * k, 0.2 * k, 0.9 * k };
        double distance = dpt_segment_triangle(segment, triangle, NULL, p, q);
        CHECK(fabs(distance - 0.9 * k) <= 1e-14 * k, "%g at 1e%d", distance, e);
    }
}

/*
 * A sliver so thin that the square of its float face normal is subnormal: a direction made from that is not of unit
 * length, and its bound would put the nearest triangle behind another.
 */
static void no_sliver_is_too_thin(void)
{
    for (double thin = 1e-24; thin < 1e-17; thin *= 1.05) {
        const double vertices[] = {
            -1e-2, -thin, 0.0,  1e-2,  -thin, 0.0,   0.0,  2.0 * thin, 0.0,   -1.0, -1.0, 0.5,
            -0.9,  -1.0,  0.5,  -1.0,  -0.9,  0.5,   1.0,  1.0,        -0.5,  0.9,  1.0,  -0.5,
            1.0,   0.9,   -0.5, -0.05, -0.05, -6e-3, 0.05, -0.05,      -6e-3, 0.05, 0.3,  -6e-3
        };
        const uint32_t corners[] = { 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11 };
        const double point[6] = { 0.0, 0.0, 0.1, 0.0, 0.0, 0.1 };
        struct fixture fixture;
        if (!fixture_from_arrays(&fixture, vertices, 12, corners, 4))
            return;
        dpt_hit hit = DPT_HIT_INIT;
        CHECK(dpt_query_segments(fixture.mesh, NULL, point, NULL, 1, &hit, NULL) == DPT_OK, "query");
        CHECK(fabs(hit.distance - 0.1) < 1e-15, "%g m thin: %.17g", thin, hit.distance);
        fixture_free(&fixture);
    }
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(tree_gives_the_bits_of_brute_force);
    TEST(points_on_the_mesh);
    TEST(a_batch_is_its_single_questions);
    TEST(a_pose_moves_the_mesh);
    TEST(sign_and_gap_of_a_box);
    TEST(sign_is_the_winding_number);
    TEST(ties_go_to_the_least_number);
    TEST(crossing_without_an_inside);
    TEST(more_crossings_than_there_is_room_for);
    TEST(answers_all_it_can);
    TEST(pair_keeps_its_range);
    TEST(longer_hits_are_zero_behind);
    TEST(refuses_what_it_cannot);
    TEST(no_sliver_is_too_thin);
    return check_report();
}
