/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * How deep curved shapes are in triangles and meshes, against formulas and searches of the test's own. The argument is a
 * share of the random poses, in per cent.
 */
#include <time.h>

#include "convex/convex_shapes.h"
#include "lib/fixture.h"

static uint64_t seed = 11;

/* What was seen of the answers, over all tests. */
static struct {
    uint64_t touches, deep, met, asked, refused, own, bounded;
    double off, seconds;
} seen;

static double now(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

/* Asks, and checks what holds of every answer. */
static dpt_convex_contact touch(const struct curved *curved, const dpt_pose *tool, const dpt_mesh *mesh,
                                const dpt_pose *body)
{
    dpt_convex_contact contact = { .size = sizeof contact };
    const double begin = now();
    const dpt_result result = dpt_convex_touch(&curved->shape, tool, mesh, body, &contact);
    seen.seconds += now() - begin;
    seen.touches++;
    seen.deep += contact.contact == DPT_CONTACT_PENETRATING;
    seen.met += contact.met;
    seen.asked += contact.asked;
    seen.refused += contact.refused;
    seen.own += contact.own;
    CHECK(result == DPT_OK && contact.status == DPT_STATUS_BOUNDED, "%s", dpt_result_name(result));
    CHECK(contact.candidates >= contact.met && contact.asked >= contact.refused, "counts");
    CHECK(contact.depth >= 0.0 && contact.depth <= 4.0 * curved->size && contact.error_bound >= 0.0 &&
              contact.error_bound <= contact.depth + 1e-3 * curved->size,
          "depth %g, bound %g", contact.depth, contact.error_bound);
    if (contact.contact == DPT_CONTACT_SEPARATED) {
        CHECK(contact.triangle == DPT_NONE && contact.depth == 0.0 && !contact.met, "separated");
        return contact;
    }
    CHECK(contact.contact == DPT_CONTACT_PENETRATING && contact.triangle != DPT_NONE &&
              fabs(dot3(contact.direction, contact.direction) - 1.0) < 1e-12,
          "direction");
    for (int k = 0; k < 3; k++)
        CHECK(fabs(contact.point[k] - tool->position[k]) <= 8.0 * curved->size, "point");
    return contact;
}

/* 0 for one that the compiler drops, as a sliver that is no triangle in float. */
static int one_triangle(struct fixture *fixture, const double corners[9])
{
    static const uint32_t index[3] = { 0, 1, 2 };
    fixture->mesh = NULL;
    return dpt_compile_arrays(corners, 3, index, 1, NULL, &fixture->compiled, NULL) == DPT_OK &&
           dpt_mesh_open(fixture->compiled.bytes, fixture->compiled.size, &fixture->mesh) == DPT_OK;
}

static void triangle_of(const dpt_mesh *mesh, uint32_t number, double corners[9])
{
    CHECK(dpt_mesh_get_triangle(mesh, number, corners) == DPT_OK, "triangle %u", number);
}

/* The unit normal of a triangle towards a point; 0 if it has none. */
static void front_of(const double t[9], const double from[3], double n[3])
{
    const double u[3] = { t[3] - t[0], t[4] - t[1], t[5] - t[2] };
    const double v[3] = { t[6] - t[0], t[7] - t[1], t[8] - t[2] };
    const double to[3] = { from[0] - t[0], from[1] - t[1], from[2] - t[2] };
    n[0] = u[1] * v[2] - u[2] * v[1];
    n[1] = u[2] * v[0] - u[0] * v[2];
    n[2] = u[0] * v[1] - u[1] * v[0];
    unit3(n);
    const double sign = dot3(n, to) < 0.0 ? -1.0 : 1.0;
    for (int k = 0; k < 3; k++)
        n[k] *= sign;
}

/* A triangle that the shape is near to, `ratio` times as large. */
static void near_triangle(double ratio, int is_sliver, double corners[9])
{
    double at[3], middle[3] = { 0.0, 0.0, 0.0 }, weight[3];
    weight[0] = random_in(&seed, 0.0, 1.0);
    weight[1] = random_in(&seed, 0.0, 1.0 - weight[0]);
    weight[2] = 1.0 - weight[0] - weight[1];
    for (int k = 0; k < 9; k++)
        corners[k] = ratio * random_in(&seed, -1.0, 1.0);
    if (is_sliver)
        for (int k = 0; k < 3; k++)
            corners[6 + k] = 0.5 * (corners[k] + corners[3 + k]) + 1e-4 * corners[6 + k];
    random_unit(&seed, at);
    const double off = random_in(&seed, 0.0, 0.6);
    for (int k = 0; k < 9; k++)
        middle[k % 3] += weight[k / 3] * corners[k];
    for (int k = 0; k < 9; k++)
        corners[k] += off * at[k % 3] - middle[k % 3];
}

/*
 * One triangle, at most 1e4 times as large or as small as the shape: nothing is missed, what is found suffices, and is no
 * longer than a search finds, within the bound.
 */
static void single_triangles_are_left_by_the_shortest_way(void)
{
    const uint64_t cases = part_of(100000);
    uint64_t slivers = 0;
    for (uint64_t i = 0; i < cases; i++) {
        static struct curved curved;
        struct fixture fixture;
        double t[9], centre[3], front[3], n[3];
        dpt_pose tool;
        const uint32_t kind = (uint32_t)(i % 6) > 4 ? DPT_CONVEX_KIND_CAPSULE : (uint32_t)(i % 6);
        const double ratio = exp(random_in(&seed, -9.2, 9.2));
        const int is_sliver = random_bits(&seed) % 8 == 0;
        curved_random(&curved, kind, i % 6 == 5 && i % 12 < 6, 1.0, &seed);
        near_triangle(ratio, is_sliver, t);
        random_pose(&seed, 0.3, &tool);
        if (!one_triangle(&fixture, t))
            continue;
        if (fixture.mesh) {
            const dpt_pose identity = DPT_POSE_IDENTITY;
            const double size = curved.size;
            /* The shape's own pose is random within its size: bring its centre to where the tool is. */
            curved_centre(&curved, centre);
            for (int k = 0; k < 3; k++)
                curved.shape.pose.position[k] -= centre[k];
            triangle_of(fixture.mesh, 0, t);
            memset(centre, 0, sizeof centre);
            const dpt_convex_contact contact = touch(&curved, &tool, fixture.mesh, &identity);
            slivers += (uint64_t)is_sliver;
            const double none[3] = { 0.0, 0.0, 0.0 };
            double distance;
            const int parted = curved_parted(&curved, &tool, t, none, 2000, &distance);
            if (contact.contact == DPT_CONTACT_SEPARATED) {
                double least = 0.0;
                if (!parted && distance < 1e-3 * size)
                    least = curved_least(&curved, &tool, t, NULL, 3000, &seed, n);
                CHECK(least < 1e-3 * size, "case %llu, kind %u, %g times as large: missed by %g", (unsigned long long)i,
                      kind, ratio, least);
            } else {
                double from[3], by[3];
                CHECK(!parted || distance < 1e-3 * size, "case %llu, kind %u: apart by %g", (unsigned long long)i, kind,
                      distance);
                pose_point(&tool, centre, from);
                front_of(t, from, front);
                for (int k = 0; k < 3; k++)
                    by[k] = (contact.depth + 1e-3 * size) * contact.direction[k];
                CHECK(curved_parted(&curved, &tool, t, by, 4000, &distance) || distance > 2e-4 * size,
                      "case %llu, kind %u: %g does not suffice", (unsigned long long)i, kind, contact.depth);
                CHECK(is_sliver || kind == DPT_CONVEX_KIND_HULL ||
                          (kind == DPT_CONVEX_KIND_CAPSULE && curved.shape.flags) ||
                          dot3(front, contact.direction) >= -1e-6,
                      "case %llu, kind %u: the wrong side, %g", (unsigned long long)i, kind,
                      dot3(front, contact.direction));
                /* The proven part of the depth is not longer than any way. */
                const double sided = curved_least(&curved, &tool, t, front, 60, &seed, n);
                CHECK(is_sliver || kind == DPT_CONVEX_KIND_HULL || curved.shape.flags ||
                          contact.depth - contact.error_bound <= sided + 1e-5 * size,
                      "case %llu, kind %u: %g less %g is longer than %g", (unsigned long long)i, kind, contact.depth,
                      contact.error_bound, sided);
                seen.off = fmax(seen.off, contact.depth - contact.error_bound - sided);
                seen.bounded += contact.error_bound < 2e-3 * size;
            }
        }
        fixture_free(&fixture);
    }
    printf("    %llu slivers; %.2f %% of the contacts are bound to 0.2 %% of the size\n", (unsigned long long)slivers,
           100.0 * (double)seen.bounded / (double)(seen.deep + 1));
    CHECK(seen.deep >= least_seen(20000), "%llu met", (unsigned long long)seen.deep);
    CHECK(seen.bounded * 100 >= seen.deep * 90, "%llu of %llu bound", (unsigned long long)seen.bounded,
          (unsigned long long)seen.deep);
}

/* ---- meshes ---- */

static struct fixture liver, box;

/* A tool somewhere at a triangle of the mesh, its origin `off` from it along the triangle's outward normal. */
static void put_at(const dpt_mesh *mesh, const dpt_pose *body, double off, dpt_pose *tool, double outward[3])
{
    dpt_mesh_info info = { .size = sizeof info };
    double t[9], far[3], w[3], at[3] = { 0.0, 0.0, 0.0 };
    dpt_mesh_get_info(mesh, &info);
    random_pose(&seed, 0.0, tool);
    do
        dpt_mesh_get_triangle(mesh, (uint32_t)(random_bits(&seed) % info.triangles), t);
    while (0);
    w[0] = random_in(&seed, 0.0, 1.0);
    w[1] = random_in(&seed, 0.0, 1.0 - w[0]);
    w[2] = 1.0 - w[0] - w[1];
    /* Closed meshes are wound outward: a point on that side. */
    const double u[3] = { t[3] - t[0], t[4] - t[1], t[5] - t[2] };
    const double v[3] = { t[6] - t[0], t[7] - t[1], t[8] - t[2] };
    far[0] = t[0] + u[1] * v[2] - u[2] * v[1];
    far[1] = t[1] + u[2] * v[0] - u[0] * v[2];
    far[2] = t[2] + u[0] * v[1] - u[1] * v[0];
    front_of(t, far, outward);
    for (int k = 0; k < 9; k++)
        at[k % 3] += w[k / 3] * t[k];
    for (int k = 0; k < 3; k++)
        at[k] += off * outward[k];
    pose_point(body, at, tool->position);
    turn3(body->orientation, outward, outward);
}

static void centre_at_origin(struct curved *curved)
{
    double centre[3];
    curved_centre(curved, centre);
    for (int k = 0; k < 3; k++)
        curved->shape.pose.position[k] -= centre[k];
}

/* Hulls, which the core knows exactly: the two say alike whether they meet. */
static void hulls_meet_where_the_core_says_so(void)
{
    const uint64_t cases = part_of(20000);
    uint64_t met = 0, apart = 0, disputed = 0;
    for (uint64_t i = 0; i < cases; i++) {
        static struct curved curved;
        dpt_pose body, tool;
        double outward[3];
        dpt_hit hit = DPT_HIT_INIT;
        const dpt_mesh *mesh = i % 2 ? liver.mesh : box.mesh;
        const double size = i % 4 < 2 ? 0.002 : 0.02;
        curved_random(&curved, DPT_CONVEX_KIND_HULL, 0, size, &seed);
        centre_at_origin(&curved);
        random_pose(&seed, 0.5, &body);
        put_at(mesh, &body, random_in(&seed, -0.2, 0.9) * size, &tool, outward);
        const dpt_convex_contact contact = touch(&curved, &tool, mesh, &body);
        /* The pose of the hull is that of the shape in the tool's frame. */
        dpt_pose hull_pose = { .orientation = { 1.0, 0.0, 0.0, 0.0 } };
        const double *p = tool.orientation, *q = curved.shape.pose.orientation;
        pose_point(&tool, curved.shape.pose.position, hull_pose.position);
        hull_pose.orientation[0] = p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3];
        hull_pose.orientation[1] = p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2];
        hull_pose.orientation[2] = p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1];
        hull_pose.orientation[3] = p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0];
        CHECK(dpt_query_hull(mesh, &body, curved.shape.hull, &hull_pose, &hit) == DPT_OK, "query");
        const int meets = hit.contact == DPT_CONTACT_PENETRATING;
        met += (uint64_t)meets;
        apart += (uint64_t)!meets;
        if (meets == (contact.contact == DPT_CONTACT_PENETRATING))
            continue;
        disputed++;
        CHECK(contact.depth <= 1e-3 * size && (!meets || !(hit.distance > 0.0) || -hit.gap < 1e-3 * size),
              "the core says %d, gap %g; depth %g", meets, hit.gap, contact.depth);
    }
    printf("    %llu meet, %llu are apart, %llu are on the border\n", (unsigned long long)met,
           (unsigned long long)apart, (unsigned long long)disputed);
    CHECK(met >= least_seen(3000) && apart >= least_seen(2000) && disputed * 100 <= cases, "cases");
}

/* A polyhedron that holds the shape is apart: so is the shape. */
static void a_shape_is_apart_where_its_polyhedron_is(void)
{
    const uint64_t cases = part_of(20000);
    uint64_t apart = 0, held = 0;
    for (uint64_t i = 0; i < cases; i++) {
        static struct curved curved;
        static _Alignas(8) unsigned char block[65536];
        double corners[3 * DPT_HULL_CORNERS_MAX], outward[3], error;
        const uint32_t kind = (uint32_t)(i % 5) > 3 ? DPT_CONVEX_KIND_CAPSULE : (uint32_t)(i % 5);
        dpt_hull_def def = { .size = sizeof def, .corners = corners };
        const dpt_hull *hull;
        dpt_pose body, tool;
        dpt_hit hit = DPT_HIT_INIT;
        curved_random(&curved, kind, i % 5 == 4, 0.01, &seed);
        centre_at_origin(&curved);
        random_pose(&seed, 0.5, &body);
        put_at(liver.mesh, &body, random_in(&seed, 0.0, 0.01), &tool, outward);
        if (dpt_convex_corners(&curved.shape, 0, corners, DPT_HULL_CORNERS_MAX, &def.corner_count, &error) != DPT_OK ||
            dpt_hull_create(block, sizeof block, &def, &hull) != DPT_OK ||
            dpt_query_hull(liver.mesh, &body, hull, &tool, &hit) != DPT_OK) {
            CHECK(0, "kind %u: no hull", kind);
            continue;
        }
        const dpt_convex_contact contact = touch(&curved, &tool, liver.mesh, &body);
        const int meets = contact.contact == DPT_CONTACT_PENETRATING;
        apart += hit.distance > 0.0;
        held += (uint64_t)meets;
        CHECK(!(hit.distance > hit.error_bound && meets), "kind %u: apart by %g, and %g deep", kind, hit.distance,
              contact.depth);
        /* And where it is farther off than the polyhedron is beyond it, it is apart itself. */
        CHECK(!(hit.distance > 0.0) || contact.depth <= 0.0, "kind %u", kind);
    }
    CHECK(apart >= least_seen(2000) && held >= least_seen(2000), "%llu apart, %llu met", (unsigned long long)apart,
          (unsigned long long)held);
}

/* Balls: the depth is the radius less the distance of the centre, out along the nearest pair. */
static void balls_are_as_deep_as_their_centre_is_near(void)
{
    const uint64_t cases = part_of(20000);
    double worst = 0.0;
    uint64_t met = 0;
    for (uint64_t i = 0; i < cases; i++) {
        static struct curved curved;
        dpt_pose body, tool;
        double outward[3], ends[6];
        dpt_hit hit = DPT_HIT_INIT;
        const dpt_query_def def = { .size = sizeof def, .pair = 1 };
        const dpt_mesh *mesh = i % 2 ? liver.mesh : box.mesh;
        const double radius = 0.005;
        curved_random(&curved, i % 4 < 2 ? DPT_CONVEX_KIND_ELLIPSOID : DPT_CONVEX_KIND_CAPSULE, 0, 2.0 * radius, &seed);
        curved.shape.extent[0] = 2.0 * radius;
        curved.shape.extent[1] = i % 4 < 2 ? 2.0 * radius : 0.0;
        curved.shape.extent[2] = curved.shape.extent[1];
        centre_at_origin(&curved);
        random_pose(&seed, 0.5, &body);
        put_at(mesh, &body, random_in(&seed, 0.3, 1.1) * radius, &tool, outward);
        for (int k = 0; k < 6; k++)
            ends[k] = tool.position[k % 3];
        dpt_query_segments(mesh, &body, ends, NULL, 1, &hit, &def);
        const dpt_convex_contact contact = touch(&curved, &tool, mesh, &body);
        const double depth = radius - hit.distance;
        met += depth > 0.0;
        CHECK(contact.depth >= depth - 2e-4 * radius, "%g deep, and it says %g", depth, contact.depth);
        if (i % 2 || depth < 1e-3 * radius)
            continue;
        /* On a convex mesh nothing else is deeper. */
        worst = fmax(worst, contact.depth - fmax(0.0, depth));
        CHECK(contact.depth <= fmax(0.0, depth) + contact.error_bound + 2e-4 * radius,
              "%g deep, and it says %g within %g", depth, contact.depth, contact.error_bound);
        const double way[3] = { hit.p[0] - hit.q[0], hit.p[1] - hit.q[1], hit.p[2] - hit.q[2] };
        CHECK(dot3(way, contact.direction) >= 0.99 * hit.distance, "%g of the way",
              dot3(way, contact.direction) / hit.distance);
    }
    printf("    on a box, at most %.2g of the radius too deep\n", worst / 0.005);
    CHECK(met >= least_seen(5000), "%llu met", (unsigned long long)met);
}

/* Never pushed through: out of a closed mesh, with the centre outside, along the side of the triangle that it names. */
static void the_way_out_leads_to_the_side_that_the_shape_comes_from(void)
{
    const uint64_t cases = part_of(30000);
    uint64_t met = 0, deep = 0;
    for (uint64_t i = 0; i < cases; i++) {
        static struct curved curved;
        dpt_pose body, tool;
        double outward[3], t[9], world[9], front[3], from[3];
        const uint32_t kind = (uint32_t)(i % 6) > 4 ? DPT_CONVEX_KIND_CAPSULE : (uint32_t)(i % 6);
        const dpt_mesh *mesh = i % 3 ? liver.mesh : box.mesh;
        const double size = i % 2 ? 0.003 : 0.015;
        const int is_given = i % 4 < 2;
        curved_random(&curved, kind, i % 6 == 5, size, &seed);
        centre_at_origin(&curved);
        random_pose(&seed, 0.5, &body);
        put_at(mesh, &body, random_in(&seed, is_given ? -0.4 : 0.05, 0.3) * size, &tool, outward);
        if (is_given) {
            /* A point that is out of the plane of the triangle. */
            double far[3] = { 4.0 * size * outward[0], 4.0 * size * outward[1], 4.0 * size * outward[2] };
            turn_back3(tool.orientation, far, curved.shape.outside);
            curved.shape.flags |= DPT_CONVEX_FLAG_OUTSIDE;
        }
        const dpt_convex_contact contact = touch(&curved, &tool, mesh, &body);
        if (contact.contact != DPT_CONTACT_PENETRATING)
            continue;
        met++;
        triangle_of(mesh, contact.triangle, t);
        for (int k = 0; k < 3; k++)
            pose_point(&body, t + 3 * k, world + 3 * k);
        const double none[3] = { 0.0, 0.0, 0.0 };
        pose_point(&tool, is_given ? curved.shape.outside : none, from);
        if (!is_given && (kind == DPT_CONVEX_KIND_HULL || curved.shape.flags))
            continue; /* their centre is not at the origin */
        front_of(world, from, front);
        deep++;
        CHECK(dot3(front, contact.direction) >= -1e-6, "kind %u: %g", kind, dot3(front, contact.direction));
        double by[3], distance;
        for (int k = 0; k < 3; k++)
            by[k] = (contact.depth + 1e-3 * size) * contact.direction[k];
        CHECK(curved_parted(&curved, &tool, world, by, 4000, &distance) || distance > 2e-4 * size,
              "kind %u: %g does not suffice", kind, contact.depth);
    }
    CHECK(met >= least_seen(10000) && deep >= least_seen(8000), "%llu met, %llu looked at", (unsigned long long)met,
          (unsigned long long)deep);
}

/* A cone that is pressed on a flat face, over its inner edges too: as deep as its point, straight out. */
static void inner_edges_of_a_flat_face_are_not_felt(void)
{
    static struct curved curved;
    const double vertices[] = { -1, -1, 0, 0, -1, 0, 1, -1, 0, -1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 1, 0, 0, 1, 0, 1, 1, 0 };
    const uint32_t corners[] = { 0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4, 3, 4, 7, 3, 7, 6, 4, 5, 8, 4, 8, 7 };
    const dpt_pose body = DPT_POSE_IDENTITY;
    struct fixture plate;
    curved.size = 0.02;
    curved.shape = (dpt_convex_shape){ .size = sizeof curved.shape,
                                       .pose = { { 0.0, 0.0, 0.005 }, { 1.0, 0.0, 0.0, 0.0 } },
                                       .extent = { 0.01, 0.0, 0.01 } };
    if (!fixture_from_arrays(&plate, vertices, 9, corners, 8))
        return;
    for (uint64_t i = 0; i < part_of(5000); i++) {
        const double depth = random_in(&seed, 1e-5, 3e-3);
        dpt_pose tool = { { random_in(&seed, -0.01, 0.01), random_in(&seed, -0.01, 0.01), -depth },
                          { 1.0, 0.0, 0.0, 0.0 } };
        if (i % 2)
            tool.position[0] = random_in(&seed, -1e-5, 1e-5);
        const dpt_convex_contact contact = touch(&curved, &tool, plate.mesh, &body);
        CHECK(fabs(contact.depth - depth) <= 2e-6 && contact.direction[2] > 0.999,
              "%g deep, and it says %g along %g %g %g", depth, contact.depth, contact.direction[0],
              contact.direction[1], contact.direction[2]);
        CHECK(fabs(contact.point[0] - tool.position[0]) < 1e-4 && fabs(contact.point[2] + depth) < 1e-4, "its point");
    }
    fixture_free(&plate);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    if (!fixture_from_shape(&liver, "liver", 20000) || !fixture_from_shape(&box, "box", 0))
        return check_failed++, check_report();
    TEST(single_triangles_are_left_by_the_shortest_way);
    TEST(hulls_meet_where_the_core_says_so);
    TEST(a_shape_is_apart_where_its_polyhedron_is);
    TEST(balls_are_as_deep_as_their_centre_is_near);
    TEST(the_way_out_leads_to_the_side_that_the_shape_comes_from);
    TEST(inner_edges_of_a_flat_face_are_not_felt);
    SKIP("FCL's depths", "this program is not linked to it");
    printf("    of 10^5 answers of libccd %.0f are refused, %.0f triangles of 10^5 have our own; %.1f us a touch, %.1f "
           "where it meets\n",
           1e5 * (double)seen.refused / (double)seen.asked, 1e5 * (double)seen.own / (double)seen.met,
           1e6 * seen.seconds / (double)seen.touches, 1e6 * seen.seconds / (double)seen.deep);
    fixture_free(&liver);
    fixture_free(&box);
    return check_report();
}
