/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The shapes that hulls are made of: their corners, edges and faces by number and by the oracle; that each holds the
 * shape that it stands for, and is larger by no more than the header says.
 *
 *     test_hull_shape [PER CENT]   of the shapes
 */
#include "hull/hull_maker.h"
#include "lib/size_checks.h"

static uint64_t rng = 12;

static const double PI = 3.14159265358979323846;

struct shaped {
    dpt_hull_shape shape;
    uint32_t sides; /* as it comes to */
    struct made_hull made;
};

static int make_shape(struct shaped *shaped, uint32_t kind, uint32_t sides)
{
    const double size = power_in(&rng, -3.0, 3.0);
    struct made_hull *made = &shaped->made;
    shaped->shape = (dpt_hull_shape){ .size = sizeof shaped->shape, .kind = kind, .sides = sides };
    shaped->sides = sides ? sides : 16;
    for (int k = 0; k < 3; k++)
        shaped->shape.extent[k] = size * power_in(&rng, -2.0, 0.0);
    dpt_result result = dpt_hull_shape_corners(&shaped->shape, made->point, DPT_HULL_CORNERS_MAX, &made->count);
    CHECK(result == DPT_OK, "kind %u, %u sides: %s", kind, sides, dpt_result_name(result));
    cloud_place(made, 1.0, (double[3]){ 0.0 });
    if (result == DPT_OK)
        result = make_hull(made, 0.0);
    CHECK(result == DPT_OK, "kind %u, %u sides: %s", kind, sides, dpt_result_name(result));
    const char *fault =
        result == DPT_OK ? oracle_hull_fault(&made->as, made->point, made->count, 1e-14 * made->size) : NULL;
    CHECK(!fault, "kind %u, %u sides: %s", kind, sides, fault);
    return result == DPT_OK && !fault;
}

static void check_numbers(const struct shaped *shaped, uint32_t corners, uint32_t edges, uint32_t faces)
{
    const struct oracle_hull *as = &shaped->made.as;
    CHECK(as->corner_count == corners && as->edge_count == edges && as->face_count == faces,
          "kind %u, %u sides: %u corners, %u edges, %u faces", shaped->shape.kind, shaped->sides, as->corner_count,
          as->edge_count, as->face_count);
}

/* How far x is beyond the hull's faces, as a part of the size. */
static double beyond(const struct shaped *shaped, double x, double y, double z)
{
    const struct dpt_hull *hull = shaped->made.hull;
    double most = -HUGE_VAL;
    for (uint32_t f = 0; f < hull->face_count; f++) {
        const vec3 at = vec3_of(shaped->made.as.corner[shaped->made.as.side[f][0]]);
        most = max_of(most, dot(hull->face[f].normal, sub((vec3){ x, y, z }, at)));
    }
    return most / shaped->made.size;
}

/* The hull holds the point, and not one that is farther out by `more`, but for rounding. */
static void check_border(const struct shaped *shaped, double x, double y, double z, double more)
{
    const double from = length((vec3){ x, y, z }), out = 1.0 + (more + 1e-12 * from) / from;
    CHECK(beyond(shaped, x, y, z) <= 1e-14, "kind %u: %g of the size beyond", shaped->shape.kind,
          beyond(shaped, x, y, z));
    CHECK(beyond(shaped, out * x, out * y, out * z) > 0.0, "kind %u: larger", shaped->shape.kind);
}

static void boxes_and_wedges_are_what_they_say(void)
{
    for (uint64_t i = 0; i < part_of(300); i++) {
        struct shaped box, wedge;
        if (!make_shape(&box, DPT_HULL_KIND_BOX, 0) || !make_shape(&wedge, DPT_HULL_KIND_WEDGE, 0))
            continue;
        check_numbers(&box, 8, 12, 6);
        check_numbers(&wedge, 6, 9, 5);
        for (int k = 0; k < 8; k++) {
            const double *e = box.shape.extent, *w = wedge.shape.extent;
            const double x = k & 1 ? 0.5 : -0.5, y = k & 2 ? 0.5 : -0.5, z = k & 4 ? 0.5 : -0.5;
            check_border(&box, x * e[0], y * e[1], z * e[2], 0.0);
            check_border(&wedge, x * w[0], z < 0.0 ? 0.0 : y * w[1], z * w[2], 0.0);
        }
    }
}

/* No corner is farther from the axis than the polygon's, and the round shape is inside at every angle. */
static void check_round(const struct shaped *shaped)
{
    const int is_cone = shaped->shape.kind == DPT_HULL_KIND_CONE;
    const double r = 0.5 * shaped->shape.extent[0], half = 0.5 * shaped->shape.extent[2];
    const double allowed = r / cos(PI / shaped->sides) * (1.0 + 1e-14);
    for (uint32_t i = 0; i < shaped->made.as.corner_count; i++) {
        const double *c = shaped->made.as.corner[i];
        const int is_tip = is_cone && c[2] < 0.0;
        CHECK(fabs(c[2]) == half, "%g", c[2]);
        CHECK(hypot(c[0], c[1]) <= (is_tip ? 0.0 : allowed), "%u sides: %.17g of %.17g", shaped->sides,
              hypot(c[0], c[1]), allowed);
    }
    for (int i = 0; i < 360; i++) {
        const double x = r * cos(i * PI / 180.0), y = r * sin(i * PI / 180.0);
        CHECK(beyond(shaped, x, y, half) <= 1e-14, "%u sides, at %d degrees: %g beyond", shaped->sides, i,
              beyond(shaped, x, y, half));
        CHECK(beyond(shaped, is_cone ? 0.0 : x, is_cone ? 0.0 : y, -half) <= 1e-14, "below");
    }
}

static void cylinders_and_cones_hold_what_is_round(void)
{
    for (uint32_t sides = 0; sides <= 63; sides = sides ? sides + 1 : 3) {
        struct shaped shaped;
        if (sides <= 32 && make_shape(&shaped, DPT_HULL_KIND_CYLINDER, sides)) {
            const uint32_t n = shaped.sides;
            check_numbers(&shaped, 2 * n, 3 * n, n + 2);
            check_round(&shaped);
        }
        if (make_shape(&shaped, DPT_HULL_KIND_CONE, sides)) {
            const uint32_t n = shaped.sides;
            check_numbers(&shaped, n + 1, 2 * n, n + 1);
            check_round(&shaped);
        }
    }
}

/* Without an extent a shape is flat, or a line, which is no hull. */
static void shapes_without_an_extent(void)
{
    for (uint32_t kind = 0; kind < 4; kind++)
        for (int zero = 0; zero < 8; zero++) {
            struct made_hull made = { .count = 0 };
            const dpt_hull_shape shape = { .size = sizeof shape,
                                           .kind = kind,
                                           .extent = { zero & 1 ? 0.0 : 0.1, zero & 2 ? 0.0 : 0.2,
                                                       zero & 4 ? 0.0 : 0.3 } };
            const dpt_result result = dpt_hull_shape_corners(&shape, made.point, DPT_HULL_CORNERS_MAX, &made.count);
            const int is_round = kind >= DPT_HULL_KIND_CYLINDER;
            const int x = !(zero & 1), y = is_round ? x : !(zero & 2), z = !(zero & 4);
            CHECK(result == DPT_OK, "kind %u: %s", kind, dpt_result_name(result));
            cloud_place(&made, 1.0, (double[3]){ 0.0 });
            const dpt_result is = make_hull(&made, 0.01);
            CHECK(is == (x + y + z > 1 ? DPT_OK : DPT_E_ARGUMENT), "kind %u, zero %d: %s", kind, zero,
                  dpt_result_name(is));
            if (is == DPT_OK) {
                const char *fault = oracle_hull_fault(&made.as, made.point, made.count, 1e-15);
                CHECK(!fault, "kind %u, zero %d: %s", kind, zero, fault);
                CHECK((made.as.face_count == 2) == (x + y + z == 2), "kind %u, zero %d: %u faces", kind, zero,
                      made.as.face_count);
            }
        }
}

static dpt_result corners_of(const dpt_hull_shape *shape)
{
    double corners[3 * DPT_HULL_CORNERS_MAX];
    uint32_t count;
    return dpt_hull_shape_corners(shape, corners, DPT_HULL_CORNERS_MAX, &count);
}

static void shapes_that_are_none_are_refused(void)
{
    static const double wrong[] = { NAN, INFINITY, -INFINITY, 1.001e6, -1e-9 };
    for (uint32_t kind = 0; kind < 4; kind++) {
        const dpt_hull_shape good = { .size = sizeof good, .kind = kind, .extent = { 0.1, 0.1, 0.1 } };
        dpt_hull_shape shape = good;
        CHECK(corners_of(&shape) == DPT_OK, "kind %u", kind);
        for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
            for (int k = 0; k < 3; k++) {
                shape = good;
                shape.extent[k] = wrong[i];
                CHECK(corners_of(&shape) == DPT_E_FINITE, "kind %u, extent %d, %g: %s", kind, k, wrong[i],
                      dpt_result_name(corners_of(&shape)));
            }
        const uint32_t most = kind == DPT_HULL_KIND_CYLINDER ? 32 : kind == DPT_HULL_KIND_CONE ? 63 : 0;
        for (uint32_t sides = 0; sides < 70; sides++) {
            shape = good;
            shape.sides = sides;
            const int is_good = sides == 0 || (sides >= 3 && sides <= most);
            CHECK(corners_of(&shape) == (is_good ? DPT_OK : DPT_E_ARGUMENT), "kind %u, %u sides: %s", kind, sides,
                  dpt_result_name(corners_of(&shape)));
        }
        shape = good;
        shape.sides = UINT32_MAX;
        CHECK(corners_of(&shape) == DPT_E_ARGUMENT, "kind %u", kind);
        shape = good;
        shape.reserved = 1;
        CHECK(corners_of(&shape) == DPT_E_ARGUMENT, "kind %u", kind);
    }
    const dpt_hull_shape unknown = { .size = sizeof unknown, .kind = 4, .extent = { 1, 1, 1 } };
    CHECK(corners_of(&unknown) == DPT_E_ARGUMENT, "%s", dpt_result_name(corners_of(&unknown)));
    CHECK(corners_of(NULL) == DPT_E_ARGUMENT, "no shape");
}

static void as_many_corners_are_written_as_there_is_room_for(void)
{
    for (uint32_t kind = 0; kind < 4; kind++) {
        const dpt_hull_shape shape = { .size = sizeof shape, .kind = kind, .extent = { 0.1, 0.2, 0.3 } };
        double all[3 * DPT_HULL_CORNERS_MAX], some[3 * DPT_HULL_CORNERS_MAX];
        uint32_t count = 0, told = 0;
        CHECK(dpt_hull_shape_corners(&shape, all, DPT_HULL_CORNERS_MAX, &count) == DPT_OK, "all");
        for (uint32_t capacity = 0; capacity <= count; capacity++) {
            for (uint32_t i = 0; i < 3 * DPT_HULL_CORNERS_MAX; i++)
                some[i] = 7.0;
            const dpt_result result = dpt_hull_shape_corners(&shape, some, capacity, &told);
            CHECK(result == (capacity < count ? DPT_E_FULL : DPT_OK) && told == count, "%u of %u: %s, %u", capacity,
                  count, dpt_result_name(result), told);
            for (uint32_t i = 3 * capacity; i < 3 * DPT_HULL_CORNERS_MAX; i++)
                CHECK(some[i] == 7.0, "%u of %u: number %u was written", capacity, count, i);
            CHECK(capacity < count || !memcmp(some, all, 3 * count * sizeof *all), "other corners");
        }
        CHECK(dpt_hull_shape_corners(&shape, NULL, 64, &told) == DPT_E_ARGUMENT, "no corners");
        CHECK(dpt_hull_shape_corners(&shape, all, 64, NULL) == DPT_E_ARGUMENT, "no count");
    }
}

static dpt_result shape_of(void *given)
{
    return corners_of(given);
}

static void structs_of_other_sizes_are_taken_by_the_rule(void)
{
    const dpt_hull_shape shape = { .size = sizeof shape, .extent = { 1.0, 1.0, 1.0 } };
    const struct sized of = { "dpt_hull_shape", sizeof shape, sizeof shape, shape_of };
    check_input(&of, &shape);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(boxes_and_wedges_are_what_they_say);
    TEST(cylinders_and_cones_hold_what_is_round);
    TEST(shapes_without_an_extent);
    TEST(shapes_that_are_none_are_refused);
    TEST(as_many_corners_are_written_as_there_is_room_for);
    TEST(structs_of_other_sizes_are_taken_by_the_rule);
    return check_report();
}
