/* SPDX-License-Identifier: BSD-3-Clause */
/* Curved shapes as such: their support functions, the polyhedra around them, arguments and sizes. */
#include "convex/convex_body.h"
#include "convex/convex_shapes.h"
#include "lib/fixture.h"
#include "lib/size_checks.h"

static uint64_t seed = 7;

/* The support point is in the shape, and as far out as the other formula says. */
static void support_points_are_the_farthest(void)
{
    const uint64_t cases = part_of(20000);
    for (uint64_t i = 0; i < cases; i++) {
        static struct curved curved;
        struct convex_body body;
        const uint32_t kind = (uint32_t)(i % 6) > 4 ? DPT_CONVEX_KIND_CAPSULE : (uint32_t)(i % 6);
        curved_random(&curved, kind, i % 6 == 5, 1.0, &seed);
        CHECK(dpti_convex_body_of(&curved.shape, &body) == DPT_OK, "kind %u", kind);
        for (int k = 0; k < 20; k++) {
            double d[3], back[3], p[3], far;
            random_unit(&seed, d);
            if (k < 6)
                for (int j = 0; j < 3; j++)
                    d[j] = j == k / 2 ? (k % 2 ? 1.0 : -1.0) : 0.0;
            if (k == 6 && kind == DPT_CONVEX_KIND_CAPSULE && i % 6 == 5)
                memcpy(d, curved.shape.bevel, sizeof d);
            const vec3 at = dpti_convex_support(&body, vec3_of(d));
            vec3_store(at, p);
            turn3(curved.shape.pose.orientation, d, back);
            far = curved_reach(&curved, back) - dot3(curved.shape.pose.position, back);
            CHECK(fabs(dot3(p, d) - far) < 2e-7, "kind %u: %.12g, and it is %.12g", kind, dot3(p, d), far);
            CHECK(kind == DPT_CONVEX_KIND_HULL || curved_holds(&curved, p, 1e-9),
                  "kind %u: the point is not in the shape", kind);
            CHECK(length(sub(at, body.centre)) <= body.size + 1e-12, "kind %u: its size", kind);
            const double s = nearest_on(body.axis[0], sub(body.axis[1], body.axis[0]), at);
            CHECK(length(sub(at, along(body.axis[0], s, sub(body.axis[1], body.axis[0])))) <= body.reach + 1e-9,
                  "kind %u: its axis", kind);
        }
    }
}

/*
 * The polyhedron's reach is nowhere less than the shape's, nowhere more by more than the error, and somewhere near that.
 * The reach of two convex sets differs at most by their distance (Hausdorff's), and does so somewhere.
 */
static void a_polyhedron_holds_its_shape(void)
{
    const uint64_t cases = part_of(3000);
    double tightest = 0.0;
    uint32_t most = 0;
    for (uint64_t i = 0; i < cases; i++) {
        static struct curved curved;
        const uint32_t kind = (uint32_t)(i % 5) > 3 ? DPT_CONVEX_KIND_CAPSULE : (uint32_t)(i % 5);
        static const uint32_t sides_max[] = { 63, 32, 12, 15 };
        double corners[3 * DPT_HULL_CORNERS_MAX], error, nearest = HUGE_VAL, farthest = -HUGE_VAL;
        uint32_t count, sides = 0;
        curved_random(&curved, kind, i % 5 == 4, 1.0, &seed);
        if (random_bits(&seed) % 2)
            sides = 3 + (uint32_t)(random_bits(&seed) % (sides_max[kind] - 2));
        const dpt_result result =
            dpt_convex_corners(&curved.shape, sides, corners, DPT_HULL_CORNERS_MAX, &count, &error);
        CHECK(result == DPT_OK || (result == DPT_E_LIMIT && i % 5 == 4 && sides), "kind %u with %u sides: %s", kind,
              sides, dpt_result_name(result));
        if (result != DPT_OK)
            continue;
        most = count > most ? count : most;
        for (int k = 0; k < 400; k++) {
            double d[3], reach = -HUGE_VAL;
            random_unit(&seed, d);
            for (uint32_t c = 0; c < count; c++)
                reach = fmax(reach, dot3(corners + 3 * c, d));
            const double beyond = reach - curved_reach(&curved, d);
            nearest = fmin(nearest, beyond);
            farthest = fmax(farthest, beyond);
        }
        CHECK(nearest >= -1e-12, "kind %u, %u sides: short by %g", kind, sides, -nearest);
        CHECK(farthest <= error + 1e-9, "kind %u, %u sides: beyond by %g, and it says %g", kind, sides, farthest,
              error);
        CHECK(kind == DPT_CONVEX_KIND_ELLIPSOID || farthest >= 0.3 * error,
              "kind %u, %u sides: beyond by %g only, and it says %g", kind, sides, farthest, error);
        tightest = fmax(tightest, farthest / error);
        dpt_hull_def def = { .size = sizeof def, .corner_count = count, .corners = corners };
        static _Alignas(8) unsigned char block[65536];
        const dpt_hull *hull;
        CHECK(dpt_hull_create(block, sizeof block, &def, &hull) == DPT_OK, "kind %u: no hull", kind);
    }
    printf("    errors are used up to %.3f of what is said; at most %u corners\n", tightest, most);
}

static void hulls_give_their_own_corners(void)
{
    static struct curved curved;
    double corners[3 * DPT_HULL_CORNERS_MAX], error = 1.0;
    uint32_t count;
    dpt_hull_info info = { .size = sizeof info };
    curved_random(&curved, DPT_CONVEX_KIND_HULL, 0, 1.0, &seed);
    dpt_hull_get_info(curved.shape.hull, &info);
    CHECK(dpt_convex_corners(&curved.shape, 0, corners, DPT_HULL_CORNERS_MAX, &count, &error) == DPT_OK &&
              count == info.corners && error == 0.0,
          "%u corners", count);
    CHECK(dpt_convex_corners(&curved.shape, 3, corners, DPT_HULL_CORNERS_MAX, &count, &error) == DPT_E_ARGUMENT,
          "sides");
}

/* ---- arguments ---- */

static dpt_result corners_of(const void *shape)
{
    uint32_t count;
    const dpt_result result = dpt_convex_corners(shape, 0, NULL, 0, &count, NULL);
    return result == DPT_E_FULL ? DPT_OK : result;
}

static dpt_result take_shape(void *given)
{
    return corners_of(given);
}

static struct fixture plate;

static dpt_result fill_contact(void *out)
{
    const dpt_convex_shape shape = { .size = sizeof shape, .pose = DPT_POSE_IDENTITY, .extent = { 0.1, 0.0, 0.1 } };
    return dpt_convex_touch(&shape, NULL, plate.mesh, NULL, out);
}

static dpt_wrench added;

/* The function of a shaper has no result: one that is refused keeps its `body`. */
static dpt_result give_shaper(void *given)
{
    dpt_convex_shaper *shaper = given;
    memset(&added, 0, sizeof added);
    shaper->body = 5;
    dpt_convex_shape_wrench(shaper, NULL, 0.001, &added);
    if (shaper->body == DPT_NONE)
        return DPT_OK;
    return shaper->size < sizeof *shaper || shaper->size > 4096 ? DPT_E_SIZE : DPT_E_UNSUPPORTED;
}

static void structs_of_any_size(void)
{
    const struct sized shape = { "dpt_convex_shape", sizeof(dpt_convex_shape), sizeof(dpt_convex_shape), take_shape };
    const struct sized contact = { "dpt_convex_contact", sizeof(dpt_convex_contact), sizeof(dpt_convex_contact),
                                   fill_contact };
    const dpt_convex_shape good = { .size = sizeof good, .pose = DPT_POSE_IDENTITY, .extent = { 0.1, 0.0, 0.1 } };
    const struct sized shaper = { "dpt_convex_shaper", sizeof(dpt_convex_shaper), sizeof(dpt_convex_shaper),
                                  give_shaper };
    const dpt_convex_shaper one = { .size = sizeof one, .shape = &good, .stiffness = 1.0 };
    check_input(&shape, &good);
    check_output(&contact);
    check_input(&shaper, &one);
    dpt_convex_shape_wrench(NULL, NULL, 0.001, &added);
}

#define REFUSED(code, change)                                                                                          \
    do {                                                                                                               \
        dpt_convex_shape shape = { .size = sizeof shape,                                                               \
                                   .kind = DPT_CONVEX_KIND_CAPSULE,                                                    \
                                   .pose = DPT_POSE_IDENTITY,                                                          \
                                   .extent = { 0.1, 0.0, 0.1 } };                                                      \
        change;                                                                                                        \
        CHECK(corners_of(&shape) == (code), "%s: %s", #change, dpt_result_name(corners_of(&shape)));                   \
        dpt_convex_contact contact = { .size = sizeof contact, .depth = 3.0 };                                         \
        CHECK(dpt_convex_touch(&shape, NULL, plate.mesh, NULL, &contact) == (code) &&                                  \
                  contact.status == DPT_STATUS_STALE && contact.triangle == DPT_NONE && contact.depth == 0.0,          \
              "touch, %s", #change);                                                                                   \
    } while (0)

static void arguments_are_checked(void)
{
    REFUSED(DPT_E_ARGUMENT, shape.kind = 5);
    REFUSED(DPT_E_ARGUMENT, shape.flags = 4);
    REFUSED(DPT_E_ARGUMENT, shape.reserved = 1);
    REFUSED(DPT_E_ARGUMENT, shape.reserved_pointer = &shape);
    REFUSED(DPT_E_ARGUMENT, shape.kind = DPT_CONVEX_KIND_HULL);
    REFUSED(DPT_E_ARGUMENT, shape.extent[0] = 0.0);
    REFUSED(DPT_E_ARGUMENT, shape.extent[1] = 0.1);
    REFUSED(DPT_E_ARGUMENT, shape.extent[2] = -0.1);
    REFUSED(DPT_E_ARGUMENT, shape.extent[2] = 1e4);
    REFUSED(DPT_E_ARGUMENT, (shape.kind = DPT_CONVEX_KIND_CONE, shape.extent[2] = 0.0));
    REFUSED(DPT_E_ARGUMENT, shape.kind = DPT_CONVEX_KIND_ELLIPSOID);
    REFUSED(DPT_E_FINITE, shape.extent[0] = NAN);
    REFUSED(DPT_E_FINITE, shape.extent[2] = 2e6);
    REFUSED(DPT_E_POSE, shape.pose.orientation[0] = 0.9);
    REFUSED(DPT_E_FINITE, shape.pose.position[1] = INFINITY);
    REFUSED(DPT_E_POSE, shape.flags = DPT_CONVEX_FLAG_BEVEL);
    REFUSED(DPT_E_FINITE, (shape.flags = DPT_CONVEX_FLAG_BEVEL, shape.bevel[3] = NAN));
    REFUSED(DPT_E_ARGUMENT, (shape.flags = DPT_CONVEX_FLAG_BEVEL, shape.bevel[2] = 1.0, shape.bevel[3] = -0.0999));
    REFUSED(DPT_E_ARGUMENT,
            (shape.flags = DPT_CONVEX_FLAG_BEVEL, shape.bevel[2] = 1.0, shape.kind = DPT_CONVEX_KIND_CYLINDER));
    REFUSED(DPT_E_FINITE, (shape.flags = DPT_CONVEX_FLAG_OUTSIDE, shape.outside[0] = NAN));
    dpt_convex_shape ball = {
        .size = sizeof ball, .kind = DPT_CONVEX_KIND_CAPSULE, .pose = DPT_POSE_IDENTITY, .extent = { 0.1, 0.0, 0.0 }
    };
    CHECK(corners_of(&ball) == DPT_OK, "a capsule of no length");
    dpt_convex_contact contact = { .size = sizeof contact };
    const dpt_pose bad = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.0, 0.0 } };
    CHECK(dpt_convex_touch(NULL, NULL, plate.mesh, NULL, &contact) == DPT_E_ARGUMENT &&
              dpt_convex_touch(&ball, NULL, NULL, NULL, &contact) == DPT_E_ARGUMENT &&
              dpt_convex_touch(&ball, NULL, plate.mesh, NULL, NULL) == DPT_E_ARGUMENT,
          "NULL");
    CHECK(dpt_convex_touch(&ball, &bad, plate.mesh, NULL, &contact) == DPT_E_POSE &&
              dpt_convex_touch(&ball, NULL, plate.mesh, &bad, &contact) == DPT_E_POSE,
          "poses");
    uint32_t count;
    double corners[9], error;
    CHECK(dpt_convex_corners(&ball, 2, corners, 3, &count, NULL) == DPT_E_ARGUMENT &&
              dpt_convex_corners(&ball, 16, corners, 3, &count, NULL) == DPT_E_ARGUMENT &&
              dpt_convex_corners(&ball, 0, NULL, 3, &count, NULL) == DPT_E_ARGUMENT &&
              dpt_convex_corners(&ball, 0, corners, 3, NULL, NULL) == DPT_E_ARGUMENT,
          "arguments of corners");
    CHECK(dpt_convex_corners(&ball, 5, corners, 3, &count, &error) == DPT_E_FULL && count > 3 && error > 0.0,
          "room for three: %u", count);
}

int main(int argc, char **argv)
{
    const double vertices[9] = { -1, -1, 0, 1, -1, 0, 0, 1, 0 };
    const uint32_t triangle[3] = { 0, 1, 2 };
    take_percent(argc, argv);
    if (!fixture_from_arrays(&plate, vertices, 3, triangle, 1))
        return check_failed++, check_report();
    TEST(support_points_are_the_farthest);
    TEST(a_polyhedron_holds_its_shape);
    TEST(hulls_give_their_own_corners);
    TEST(structs_of_any_size);
    TEST(arguments_are_checked);
    fixture_free(&plate);
    return check_report();
}
