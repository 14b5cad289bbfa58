/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Gap and depth, of stateless queries and of worlds with a history, against closed forms: boxes, a sphere, a torus, a
 * sphere within a sphere.
 *
 *     test_depth_forms           what make check runs
 *     test_depth_forms TICKS     80 times so many axes a box, 40 a sphere, 10 a torus or two spheres; 150 if not told
 */
#include "contact/depth_checks.h"

static uint64_t ticks = 150;

/* A box in closed form: convex along a line, so thirds lead to the least height. */
static double height_over_box(const double half[3], const double ends[6], double s)
{
    double outside = 0, deep = INFINITY;
    for (int k = 0; k < 3; k++) {
        const double beyond = fabs(ends[k] + s * (ends[3 + k] - ends[k])) - half[k];
        outside += beyond > 0 ? beyond * beyond : 0;
        deep = fmin(deep, -beyond);
    }
    return outside > 0 ? sqrt(outside) : -deep;
}

static double least_over_box(const double half[3], const double ends[6])
{
    double from = 0, to = 1;
    for (int i = 0; i < 100; i++) {
        const double third = (to - from) / 3;
        if (height_over_box(half, ends, from + third) < height_over_box(half, ends, to - third))
            to -= third;
        else
            from += third;
    }
    return height_over_box(half, ends, 0.5 * (from + to));
}

/* A coordinate that is outside, on a face, inside, in the middle, or anything. */
static double delicate(uint64_t *seed, double half)
{
    static const double shares[6] = { -1, 0, 1, -0.5, 0.5, 1.5 };
    const uint64_t i = random_bits(seed) % 8;
    return i < 6 ? shares[i] * half : random_in(seed, -1.5, 1.5) * half;
}

static void box_in_closed_form(const double half[3])
{
    struct solid solid;
    struct rig rig;
    uint64_t seed = 11;
    double worst = 0, worst_free = 0;
    if (!box_of(&solid, half) || !depth_rig_open(&rig, solid.mesh, 0.001, 32))
        return;
    for (uint64_t i = 0; i < 80 * ticks; i++) {
        double ends[6], radius = radius_of(&solid, i);
        const int kind = (int)(random_bits(&seed) % 4);
        dpt_hit hit = DPT_HIT_INIT;
        for (int k = 0; k < 6; k++)
            ends[k] = delicate(&seed, half[k % 3]);
        if (kind == 0) /* a point */
            memcpy(ends + 3, ends, 3 * sizeof *ends);
        if (kind == 1) /* along an axis: in the plane of a face, along an edge */
            for (uint64_t k = 0, keep = random_bits(&seed) % 3; k < 3; k++)
                if (k != keep)
                    ends[3 + k] = ends[k];
        dpt_query_segments(solid.mesh, NULL, ends, &radius, 1, &hit, NULL);
        const dpt_hit moved = rig_step_ends(&rig, ends, radius);
        const double truth = least_over_box(half, ends) - radius;
        for (int w = 0; w < 2; w++) {
            const dpt_hit *h = w ? &moved : &hit;
            const char *text = answer_text(&solid, w ? "world" : "query", ends, radius, h);
            const double error = fabs(h->gap - truth);
            check_form(text, h);
            if (truth + radius > 1e-12) {
                CHECK(error <= h->error_bound + 1e-15, "not %.12g: %s", truth, text);
                worst_free = fmax(worst_free, error);
            }
            CHECK(error <= 1e-5 * solid.diagonal, "not %.9g: %s", truth, text);
            worst = fmax(worst, error / solid.diagonal);
        }
        if (i % 7 == 0)
            check_way_out(&solid, &rig, 0.001, ends, radius, &moved);
        memcpy(ends_before, ends, sizeof ends);
    }
    printf("    %g x %g x %g m: %.1e of the diagonal, %.1e m free\n", 2 * half[0], 2 * half[1], 2 * half[2], worst,
           worst_free);
    rig_close(&rig);
    solid_close(&solid);
}

static void boxes(void)
{
    /* Floats, so that the mesh is the very box. */
    box_in_closed_form((const double[3]){ 0.0625, 0.046875, 0.03125 });
    box_in_closed_form((const double[3]){ 0.5, 0.5, 0.5 });
    box_in_closed_form((const double[3]){ 0.0625, 0.0625, 0x1p-12 });
    box_in_closed_form((const double[3]){ 1, 0x1p-10, 0x1p-7 });
}

/* From the ends of one tick to those of the next, far away: what was nearest there is of no use, and must not harm. */
static void jumps_without_a_word(void)
{
    static const struct {
        double half[3], ends[2][6], radius[2];
    } cases[] = {
        { { 0.0625, 0.046875, 0.03125 },
          { { -0x1p-5, -0x1.8p-6, 0x0p+0, -0x1p-5, -0x1.8p-6, -0x1p-6 },
            { 0x1.8p-4, -0x1.8p-6, -0x1p-6, 0x1p-5, 0x1.e4f962c1f9722p-5, -0x1p-6 } },
          { 0x1.4add518f4046ep-8, 0 } },
        { { 0.5, 0.5, 0.5 },
          { { 0.75, -0.5, 0.5, 0, 0, 0.25 }, { -0.5, 0.25, 0.25, -0x1.d2a0767a24becp-3, 0.75, 0x1.63c2c1196f86p-2 } },
          { 0.05, 0 } },
        { { 0.5, 0.5, 0.5 }, /* the middle of a face to that of another */
          { { 0, 0, 0.75, 0, 0, 0.25 }, { 0.75, 0, 0, 0.25, 0, 0 } },
          { 0, 0 } },
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct solid solid;
        struct rig rig;
        if (!box_of(&solid, cases[i].half) || !depth_rig_open(&rig, solid.mesh, 0.001, 32))
            continue;
        for (int t = 0; t < 2; t++) {
            const double *ends = cases[i].ends[t], radius = cases[i].radius[t];
            const dpt_hit hit = rig_step_ends(&rig, ends, radius);
            const double gap = least_over_box(cases[i].half, ends) - radius;
            CHECK(fabs(hit.gap - gap) <= 1e-5 * solid.diagonal, "case %d, tick %d: %.9g, not %.9g", (int)i, t, hit.gap,
                  gap);
        }
        rig_close(&rig);
        solid_close(&solid);
    }
}

/* The mesh is within the ball and holds the ball that touches its faces from within. */
static void sphere(void)
{
    struct solid solid;
    uint64_t seed = 3;
    double inner, outer, tilt;
    if (!solid_from_shape(&solid, "sphere", 5120))
        return;
    solid_balls(&solid, &inner, &outer, &tilt);
    for (uint64_t i = 0; i < 40 * ticks; i++) {
        double ends[6], d[3], x[3];
        const double radius = radius_of(&solid, i / 5);
        dpt_hit hit = DPT_HIT_INIT;
        ends_about(&seed, outer, i, ends);
        for (int k = 0; k < 3; k++)
            d[k] = ends[3 + k] - ends[k];
        const double square = dot3(d, d);
        const double s = square > 0 ? fmax(0, fmin(1, -dot3(ends, d) / square)) : 0;
        point_at(ends, s, x);
        const double least = sqrt(dot3(x, x)) - radius, bound = 1e-5 * solid.diagonal;
        dpt_query_segments(solid.mesh, NULL, ends, &radius, 1, &hit, NULL);
        check_form(answer_text(&solid, "query", ends, radius, &hit), &hit);
        CHECK(hit.gap >= least - outer - bound && hit.gap <= least - inner + bound, "%.9g to %.9g: %s", least - outer,
              least - inner, answer_text(&solid, "query", ends, radius, &hit));
    }
    solid_close(&solid);
}

enum { DENSE = 2000 };

/* A ring of radius 0.1 m and a tube of 0.04 m, as `dynpoint make torus` says. */
static double height_over_torus(const double x[3])
{
    return hypot(hypot(x[0], x[1]) - 0.1, x[2]) - 0.04;
}

/*
 * The height over the torus has a second derivative of at most 1 / 0.9 tube near the surface: where it is 0 in the
 * corners it is within L^2 / (6 * 0.9 tube) in a triangle of edges of at most L.
 */
static void torus(void)
{
    struct solid solid;
    uint64_t seed = 5;
    double edge = 0;
    if (!solid_from_shape(&solid, "torus", 61358))
        return;
    for (uint32_t t = 0; t < solid.place.triangles; t++)
        for (int i = 0; i < 3; i++) {
            double e[3];
            for (int k = 0; k < 3; k++)
                e[k] = (double)solid.corners[9 * (size_t)t + (size_t)(3 * i + k)] -
                       (double)solid.corners[9 * (size_t)t + (size_t)(3 * ((i + 1) % 3) + k)];
            edge = fmax(edge, sqrt(dot3(e, e)));
        }
    const double off = edge * edge / (6 * 0.9 * 0.04) + 1e-8;
    for (uint64_t i = 0; i < 10 * ticks; i++) {
        double ends[6], high = INFINITY, at = 0, x[3];
        const double radius = radius_of(&solid, i / 5), bound = off + 1e-5 * solid.diagonal;
        dpt_hit hit = DPT_HIT_INIT;
        ends_about(&seed, 0.1, i, ends);
        for (int k = 0; k <= DENSE; k++) {
            point_at(ends, (double)k / DENSE, x);
            if (height_over_torus(x) < high) {
                high = height_over_torus(x);
                at = (double)k / DENSE;
            }
        }
        double from = fmax(0, at - 1.0 / DENSE), to = fmin(1, at + 1.0 / DENSE);
        for (int k = 0; k < 60; k++) {
            double y[3];
            point_at(ends, from + 0.382 * (to - from), x);
            point_at(ends, from + 0.618 * (to - from), y);
            if (height_over_torus(x) < height_over_torus(y))
                to = from + 0.618 * (to - from);
            else
                from = from + 0.382 * (to - from);
            high = fmin(high, fmin(height_over_torus(x), height_over_torus(y)));
        }
        dpt_query_segments(solid.mesh, NULL, ends, &radius, 1, &hit, NULL);
        CHECK(fabs(hit.gap + radius - high) <= bound, "not %.9g +- %.2g: %s", high - radius, bound,
              answer_text(&solid, "query", ends, radius, &hit));
    }
    solid_close(&solid);
}

/* Of a quarter of the size, off the middle, and wound outward too: wholly in the other one's material. */
static const double buried_at[3] = { 0.02, 0.01, 0.0 };

/* Inside of the outer sphere both sides of the inner one are material: the nearer of the two tells the depth. */
static double height_over_buried(const double x[3], double radius)
{
    const double d[3] = { x[0] - buried_at[0], x[1] - buried_at[1], x[2] - buried_at[2] };
    const double outside = sqrt(dot3(x, x)) - radius;
    return outside > 0 ? outside : -fmin(-outside, fabs(sqrt(dot3(d, d)) - 0.25 * radius));
}

static int open_buried(struct solid *solid)
{
    struct shape shape;
    shape_reason reason;
    if (shape_make("sphere", 5120, 0, &shape, reason))
        return 0;
    const size_t v = shape.vertex_count, t = shape.triangle_count;
    double *vertices = malloc(6 * v * sizeof *vertices);
    uint32_t *corners = malloc(6 * t * sizeof *corners);
    for (size_t i = 0; i < 3 * v; i++) {
        vertices[i] = shape.vertices[i];
        vertices[3 * v + i] = 0.25 * shape.vertices[i] + buried_at[i % 3];
    }
    for (size_t i = 0; i < 3 * t; i++) {
        corners[i] = shape.corners[i];
        corners[3 * t + i] = shape.corners[i] + (uint32_t)v;
    }
    const int opened = solid_from_arrays(solid, "buried sphere", vertices, 2 * v, corners, 2 * t);
    free(vertices);
    free(corners);
    shape_free(&shape);
    return opened;
}

static void a_sphere_within_a_sphere(void)
{
    struct solid plain, solid;
    uint64_t seed = 7;
    double inner, outer, tilt;
    uint64_t from_material = 0;
    if (!solid_from_shape(&plain, "sphere", 5120))
        return;
    solid_balls(&plain, &inner, &outer, &tilt);
    solid_close(&plain);
    if (!open_buried(&solid))
        return;
    CHECK(solid.info.buried_components == 1, "%u buried", solid.info.buried_components);
    for (uint64_t i = 0; i < 10 * ticks; i++) {
        double ends[6], x[3], d[3], least = INFINITY;
        dpt_hit hit = DPT_HIT_INIT;
        ends_about(&seed, outer, i, ends);
        for (int k = 0; k < 3 && i % 2; k++)
            ends[3 + k] = buried_at[k]; /* half of them end in the inner one */
        for (int k = 0; k < 3; k++)
            d[k] = ends[3 + k] - ends[k];
        for (int k = 0; k <= DENSE; k++) {
            point_at(ends, (double)k / DENSE, x);
            least = fmin(least, height_over_buried(x, outer));
        }
        from_material += i % 2 && height_over_buried(ends, outer) < -0.3 * outer;
        const double bound = outer - inner + sqrt(dot3(d, d)) / DENSE + 1e-5 * solid.diagonal;
        dpt_query_segments(solid.mesh, NULL, ends, NULL, 1, &hit, NULL);
        CHECK(fabs(hit.gap - least) <= bound, "not %.9g +- %.2g: %s", least, bound,
              answer_text(&solid, "query", ends, 0.0, &hit));
    }
    CHECK(from_material > 0, "none began deep in the outer one alone");
    solid_close(&solid);
}

int main(int argc, char **argv)
{
    setvbuf(stdout, NULL, _IOLBF, 0);
    if (argc > 1)
        ticks = strtoull(argv[1], NULL, 10);
    if (ticks < 20 || ticks > 100000000) {
        printf("test_depth_forms: from 20 ticks a mesh to 100000000\n");
        return 2;
    }
    TEST(boxes);
    TEST(jumps_without_a_word);
    TEST(sphere);
    TEST(torus);
    TEST(a_sphere_within_a_sphere);
    return check_report();
}
