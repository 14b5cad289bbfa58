/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What libccd gets wrong, on purpose: its answers are replaced by lies, its memory runs out, and it is given what it is
 * known to fail at. No NaN, no wrong side and no endless search reaches the caller.
 */
#include <ccd/ccd.h>
#include <time.h>

#include "convex/convex_shapes.h"
#include "lib/fixture.h"

static uint64_t seed = 5;

static double seconds(void)
{
    struct timespec time;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

/* ---- lies ---- */

enum lie {
    LIE_NONE,
    LIE_NO,       /* they do not meet */
    LIE_NAN,      /* depth 0 along NaN */
    LIE_UNSET,    /* "met", and nothing is written */
    LIE_MEMORY,   /* -2 */
    LIE_WRONG,    /* a random direction */
    LIE_BEHIND,   /* the way to the other side */
    LIE_SHALLOW,  /* half the depth */
    LIE_DEEP,     /* a thousand times the depth */
    LIE_NEGATIVE, /* less than none */
    LIE_LONG,     /* a direction of length 2 */
    LIE_ENDLESS,  /* it is told no tolerance at which to end */
    LIES
};
static const char *const lie_names[LIES] = { "none",   "no",      "NaN",  "unset",    "memory", "wrong",
                                             "behind", "shallow", "deep", "negative", "long",   "endless" };
static enum lie lie;
/* Which of the four are lied for. */
static int lies_of_gjk, lies_of_mpr;
static uint64_t asked;

typedef int penetration_fn(const void *, const void *, const ccd_t *, ccd_real_t *, ccd_vec3_t *, ccd_vec3_t *);
penetration_fn __real_ccdGJKPenetration, __real_ccdMPRPenetration;
penetration_fn __wrap_ccdGJKPenetration, __wrap_ccdMPRPenetration;
int __real_ccdGJKIntersect(const void *one, const void *other, const ccd_t *ccd);
int __real_ccdMPRIntersect(const void *one, const void *other, const ccd_t *ccd);
int __wrap_ccdGJKIntersect(const void *one, const void *other, const ccd_t *ccd);
int __wrap_ccdMPRIntersect(const void *one, const void *other, const ccd_t *ccd);

static int tell(int result, ccd_real_t *depth, ccd_vec3_t *d)
{
    double v[3];
    switch (lie) {
    case LIE_NO:
        return -1;
    case LIE_NAN:
        *depth = 0.0;
        ccdVec3Set(d, NAN, NAN, NAN);
        return 0;
    case LIE_UNSET:
        return 0;
    case LIE_MEMORY:
        return -2;
    case LIE_WRONG:
        random_unit(&seed, v);
        ccdVec3Set(d, v[0], v[1], v[2]);
        break;
    case LIE_BEHIND:
        ccdVec3Scale(d, -1.0);
        break;
    case LIE_SHALLOW:
        *depth *= 0.5;
        break;
    case LIE_DEEP:
        *depth *= 1000.0;
        break;
    case LIE_NEGATIVE:
        *depth *= -1.0;
        break;
    case LIE_LONG:
        ccdVec3Scale(d, 2.0);
        break;
    default:
        break;
    }
    return result;
}

int __wrap_ccdGJKPenetration(const void *one, const void *other, const ccd_t *ccd, ccd_real_t *depth,
                             ccd_vec3_t *direction, ccd_vec3_t *point)
{
    const ccd_real_t depth_before = *depth;
    const ccd_vec3_t before = *direction;
    ccd_t told = *ccd;
    if (lies_of_gjk && lie == LIE_ENDLESS)
        told.epa_tolerance = 0.0;
    const int result = __real_ccdGJKPenetration(one, other, &told, depth, direction, point);
    asked++;
    CHECK(ccd->max_iterations <= 1000, "no limit on iterations");
    if (lies_of_gjk && lie == LIE_UNSET) {
        *depth = depth_before;
        *direction = before;
    }
    return lies_of_gjk ? tell(result, depth, direction) : result;
}

int __wrap_ccdMPRPenetration(const void *one, const void *other, const ccd_t *ccd, ccd_real_t *depth,
                             ccd_vec3_t *direction, ccd_vec3_t *point)
{
    const ccd_real_t depth_before = *depth;
    const ccd_vec3_t before = *direction;
    const int result = __real_ccdMPRPenetration(one, other, ccd, depth, direction, point);
    asked++;
    if (lies_of_mpr && lie == LIE_UNSET) {
        *depth = depth_before;
        *direction = before;
    }
    return lies_of_mpr ? tell(result, depth, direction) : result;
}

int __wrap_ccdGJKIntersect(const void *one, const void *other, const ccd_t *ccd)
{
    const int result = __real_ccdGJKIntersect(one, other, ccd);
    return lies_of_gjk && lie == LIE_NO ? 0 : result;
}

int __wrap_ccdMPRIntersect(const void *one, const void *other, const ccd_t *ccd)
{
    const int result = __real_ccdMPRIntersect(one, other, ccd);
    return lies_of_mpr && lie == LIE_NO ? 0 : result;
}

static struct fixture plate, liver;

/* What every answer must hold: it is one, it leads to the side of z > 0, and it suffices. */
static void check_on_plate(const struct curved *curved, const dpt_pose *tool, const dpt_convex_contact *contact,
                           double depth, const char *of)
{
    static const double t[9] = { -1, -1, 0, 1, -1, 0, 0, 1, 0 };
    CHECK(contact->contact == DPT_CONTACT_PENETRATING, "%s: missed, %g deep", of, depth);
    if (contact->contact != DPT_CONTACT_PENETRATING)
        return;
    CHECK(fabs(dot3(contact->direction, contact->direction) - 1.0) < 1e-9 && contact->direction[2] >= -1e-9,
          "%s: along %g %g %g", of, contact->direction[0], contact->direction[1], contact->direction[2]);
    CHECK(contact->depth <= depth + 1e-3 * curved->size && contact->depth >= 0.0, "%s: %g deep, and it is %g", of,
          contact->depth, depth);
    CHECK(contact->depth - contact->error_bound <= depth + 1e-9, "%s: its bound", of);
    CHECK(curved_width(curved, tool, t, contact->direction) <= contact->depth + 1e-6 * curved->size,
          "%s: %g does not suffice", of, contact->depth);
}

static void lies_are_found_out(void)
{
    uint64_t lied[LIES][3] = { { 0 } }, own[LIES][3] = { { 0 } }, refused[LIES][3] = { { 0 } };
    for (uint64_t i = 0; i < part_of(LIES * 3 * 400); i++) {
        static struct curved curved;
        dpt_pose tool;
        double centre[3], depth;
        const double down[3] = { 0.0, 0.0, -1.0 };
        double back[3];
        const int who = (int)(i / LIES % 3);
        lie = (enum lie)(i % LIES);
        lies_of_gjk = who != 1;
        lies_of_mpr = who != 0;
        curved_random(&curved, (uint32_t)(random_bits(&seed) % 5), 0, 0.01, &seed);
        curved_centre(&curved, centre);
        for (int k = 0; k < 3; k++)
            curved.shape.pose.position[k] -= centre[k];
        random_pose(&seed, 0.05, &tool);
        /* By a random part of what lies below the centre. */
        turn_back3(tool.orientation, down, back);
        depth = random_in(&seed, 0.05, curved.shape.hull ? 0.4 : 0.9) * curved_reach(&curved, back);
        tool.position[2] = curved_reach(&curved, back) - depth;
        dpt_convex_contact contact = { .size = sizeof contact };
        const double begin = seconds();
        CHECK(dpt_convex_touch(&curved.shape, &tool, plate.mesh, NULL, &contact) == DPT_OK, "%s", lie_names[lie]);
        CHECK(seconds() - begin < 0.05, "%s: %g s", lie_names[lie], seconds() - begin);
        check_on_plate(&curved, &tool, &contact, depth, lie_names[lie]);
        lied[lie][who]++;
        own[lie][who] += contact.own;
        refused[lie][who] += contact.refused;
    }
    for (int l = 0; l < LIES; l++)
        printf("    %-8s of both: %llu touches, %llu refused, %llu of our own\n", lie_names[l],
               (unsigned long long)lied[l][2], (unsigned long long)refused[l][2], (unsigned long long)own[l][2]);
    for (int l = LIE_NO; l < LIES; l++)
        CHECK(l == LIE_SHALLOW || l == LIE_ENDLESS || refused[l][2] >= least_seen(lied[l][2] / 2), "%s: %llu refused",
              lie_names[l], (unsigned long long)refused[l][2]);
    lie = LIE_NONE;
    lies_of_gjk = lies_of_mpr = 0;
}

/* ---- memory ---- */

#ifndef __SANITIZE_ADDRESS__
/* malloc of this program and of libccd; of a sanitizer's there is but one. */
static long left = -1;
void *__libc_malloc(size_t size);
__attribute__((visibility("default"))) void *malloc(size_t size)
{
    if (left == 0)
        return NULL;
    left -= left > 0;
    return __libc_malloc(size);
}
#endif

static void memory_runs_out(void)
{
#ifdef __SANITIZE_ADDRESS__
    SKIP("memory that runs out", "malloc is the sanitizer's");
#else
    static struct curved curved;
    uint64_t refused = 0, failed = 0, done = 0;
    curved.size = 0.01;
    curved.shape = (dpt_convex_shape){ .size = sizeof curved.shape,
                                       .kind = DPT_CONVEX_KIND_ELLIPSOID,
                                       .pose = { { 0.001, 0.002, 0.003 }, { 1.0, 0.0, 0.0, 0.0 } },
                                       .extent = { 0.01, 0.006, 0.008 } };
    for (long n = 0; n < 6000; n += 1 + n / 60) {
        dpt_convex_contact contact = { .size = sizeof contact };
        left = n;
        const dpt_result result = dpt_convex_touch(&curved.shape, NULL, plate.mesh, NULL, &contact);
        left = -1;
        if (result == DPT_E_MEMORY) {
            failed++;
            CHECK(contact.status == DPT_STATUS_STALE && contact.depth == 0.0, "after %ld", n);
            continue;
        }
        CHECK(result == DPT_OK, "after %ld: %s", n, dpt_result_name(result));
        const dpt_pose identity = DPT_POSE_IDENTITY;
        check_on_plate(&curved, &identity, &contact, 0.001, "without memory");
        refused += contact.error_bound > 1e-5;
        done += contact.error_bound < 1e-6;
    }
    CHECK(failed == 2 && refused > 10 && done > 10, "%llu failed, %llu without EPA, %llu with it",
          (unsigned long long)failed, (unsigned long long)refused, (unsigned long long)done);
#endif
}

/* ---- what it is known to fail at ---- */

static dpt_convex_contact ask(const dpt_convex_shape *shape, const dpt_pose *tool, const dpt_mesh *mesh,
                              const dpt_pose *body, const char *of)
{
    dpt_convex_contact contact = { .size = sizeof contact };
    const double begin = seconds();
    const dpt_result result = dpt_convex_touch(shape, tool, mesh, body, &contact);
    CHECK(result == DPT_OK, "%s: %s", of, dpt_result_name(result));
    CHECK(seconds() - begin < 0.1, "%s: %g s", of, seconds() - begin);
    CHECK(contact.depth >= 0.0 && contact.depth < 1e7 && contact.error_bound >= 0.0, "%s: depth %g", of, contact.depth);
    const double size = dot3(contact.direction, contact.direction);
    CHECK(contact.contact == DPT_CONTACT_PENETRATING ? fabs(size - 1.0) < 1e-9 : size == 0.0, "%s: direction of %g", of,
          size);
    return contact;
}

/* Triangles of 1 m against tips of 1 mm and less. */
static void sizes_differ_by_a_thousand_times(void)
{
    for (uint64_t i = 0; i < part_of(4000); i++) {
        const double size = exp(random_in(&seed, log(1e-6), log(1e-3)));
        const double depth = random_in(&seed, 0.01, 0.4) * size;
        dpt_convex_shape shape = { .size = sizeof shape,
                                   .kind = DPT_CONVEX_KIND_CYLINDER,
                                   .pose = DPT_POSE_IDENTITY,
                                   .extent = { size, 0.0, size } };
        const dpt_pose tool = { { random_in(&seed, -0.2, 0.2), random_in(&seed, -0.5, 0.0), 0.5 * size - depth },
                                { 1.0, 0.0, 0.0, 0.0 } };
        const dpt_convex_contact contact = ask(&shape, &tool, plate.mesh, NULL, "1 mm on 1 m");
        CHECK(fabs(contact.depth - depth) <= 1e-4 * size && contact.direction[2] > 0.999,
              "%g of %g deep, and it says %g", depth, size, contact.depth);
    }
}

/* Flat on flat, edge in edge, a point on the surface: as deep as 0, or as that. */
static void what_just_touches(void)
{
    static const double tiny[] = { 0.0,   1e-18,  -1e-18, 1e-16, -1e-16, 1e-14, -1e-14,
                                   1e-12, -1e-12, 1e-9,   -1e-9, 1e-7,   -1e-7 };
    for (uint32_t kind = 0; kind < DPT_CONVEX_KIND_HULL; kind++)
        for (size_t i = 0; i < sizeof tiny / sizeof *tiny; i++)
            for (int turned = 0; turned < 3; turned++) {
                const double h = sqrt(0.5);
                dpt_convex_shape shape = {
                    .size = sizeof shape, .kind = kind, .pose = DPT_POSE_IDENTITY, .extent = { 0.01, 0.0, 0.01 }
                };
                dpt_pose tool = { { 0.0, 0.0, 0.005 - tiny[i] }, { 1.0, 0.0, 0.0, 0.0 } };
                if (kind == DPT_CONVEX_KIND_ELLIPSOID)
                    shape.extent[1] = 0.01;
                if (kind == DPT_CONVEX_KIND_CAPSULE)
                    shape.extent[2] = 0.0;
                if (turned) {
                    tool.orientation[0] = tool.orientation[turned] = h;
                    if (kind == DPT_CONVEX_KIND_CONE)
                        continue;
                }
                const dpt_convex_contact contact = ask(&shape, &tool, plate.mesh, NULL, "touching");
                CHECK(contact.depth <= fmax(0.0, tiny[i]) + 2e-6, "kind %u, %g: %g deep", kind, tiny[i], contact.depth);
                CHECK(contact.direction[2] >= -1e-9, "kind %u, %g: the wrong side", kind, tiny[i]);
            }
    /* A shape whose centre is in the plane: on one of its sides. */
    const dpt_convex_shape middle = { .size = sizeof middle,
                                      .kind = DPT_CONVEX_KIND_CYLINDER,
                                      .pose = DPT_POSE_IDENTITY,
                                      .extent = { 0.01, 0.0, 0.01 } };
    const dpt_convex_contact half = ask(&middle, NULL, plate.mesh, NULL, "half way");
    CHECK(fabs(half.depth - 0.005) < 1e-5 && fabs(half.direction[2]) > 0.999, "%g deep", half.depth);
}

/* Needles of triangles, of a width down to what a float holds. */
static void slivers(void)
{
    const uint32_t corners[3] = { 0, 1, 2 };
    for (int p = 2; p <= 12; p++)
        for (int k = 0; k < 20; k++) {
            const double width = pow(10.0, -p);
            const double t[9] = { -0.5, 0, 0, 0.5, 0, 0, random_in(&seed, -0.5, 0.5), width, 0 };
            struct fixture fixture;
            dpt_diag diag = { .size = sizeof diag };
            if (dpt_compile_arrays(t, 3, corners, 1, NULL, &fixture.compiled, &diag) != DPT_OK)
                continue;
            static struct curved curved;
            dpt_pose tool;
            curved_random(&curved, (uint32_t)(k % 5), 0, 0.02, &seed);
            random_pose(&seed, 0.005, &tool);
            memset(curved.shape.pose.position, 0, sizeof curved.shape.pose.position);
            if (dpt_mesh_open(fixture.compiled.bytes, fixture.compiled.size, &fixture.mesh) == DPT_OK)
                ask(&curved.shape, &tool, fixture.mesh, NULL, "a sliver");
            fixture_free(&fixture);
        }
}

/* Far from the origin, what is left of the coordinates says how deep; beyond their range it is an error. */
static void coordinates_are_huge(void)
{
    static const double far[] = { 1e2, 1e4, 1e6 };
    for (int f = 0; f < 3; f++)
        for (int k = 0; k < 200; k++) {
            const dpt_convex_shape shape = { .size = sizeof shape,
                                             .kind =
                                                 (uint32_t)(k % 2 ? DPT_CONVEX_KIND_CYLINDER : DPT_CONVEX_KIND_CONE),
                                             .pose = DPT_POSE_IDENTITY,
                                             .extent = { 0.01, 0.0, 0.01 } };
            const double depth = random_in(&seed, 1e-4, 2e-3);
            const dpt_pose body = { { far[f], -far[f], far[f] }, { 1.0, 0.0, 0.0, 0.0 } };
            dpt_pose tool = body;
            tool.position[0] += random_in(&seed, -0.01, 0.01) - (far[f] > 9e5 ? 0.02 : 0.0);
            tool.position[0] = fmin(tool.position[0], 1e6);
            tool.position[2] += 0.005 - depth;
            if (tool.position[2] > 1e6)
                continue;
            const dpt_convex_contact contact = ask(&shape, &tool, plate.mesh, &body, "far away");
            CHECK(fabs(contact.depth - depth) <= 2e-6 + 1e-15 * far[f] * 10.0 && contact.direction[2] > 0.99,
                  "%g away, %g deep, and it says %g", far[f], depth, contact.depth);
        }
    const dpt_convex_shape shape = { .size = sizeof shape, .pose = DPT_POSE_IDENTITY, .extent = { 0.01, 0.0, 0.01 } };
    const dpt_pose beyond = { { 2e6, 0.0, 0.0 }, { 1.0, 0.0, 0.0, 0.0 } };
    dpt_convex_contact contact = { .size = sizeof contact };
    CHECK(dpt_convex_touch(&shape, &beyond, plate.mesh, NULL, &contact) == DPT_E_FINITE &&
              contact.status == DPT_STATUS_STALE,
          "beyond");
}

/* A shape as large as the mesh meets thousands of triangles: an answer, or that there are too many. */
static void a_shape_swallows_a_mesh(void)
{
    dpt_convex_contact contact = { .size = sizeof contact };
    const dpt_convex_shape shape = {
        .size = sizeof shape, .kind = DPT_CONVEX_KIND_ELLIPSOID, .pose = DPT_POSE_IDENTITY, .extent = { 2.0, 2.0, 2.0 }
    };
    const dpt_result result = dpt_convex_touch(&shape, NULL, liver.mesh, NULL, &contact);
    CHECK(result == DPT_OK && contact.candidates > 500 && contact.contact == DPT_CONTACT_PENETRATING &&
              contact.depth > 0.5,
          "%s, %u near, %g deep", dpt_result_name(result), contact.candidates, contact.depth);
}

int main(int argc, char **argv)
{
    const double vertices[9] = { -1, -1, 0, 1, -1, 0, 0, 1, 0 };
    const uint32_t triangle[3] = { 0, 1, 2 };
    take_percent(argc, argv);
    if (!fixture_from_arrays(&plate, vertices, 3, triangle, 1) || !fixture_from_shape(&liver, "liver", 1000))
        return check_failed++, check_report();
    TEST(lies_are_found_out);
    TEST(memory_runs_out);
    TEST(sizes_differ_by_a_thousand_times);
    TEST(what_just_touches);
    TEST(slivers);
    TEST(coordinates_are_huge);
    TEST(a_shape_swallows_a_mesh);
    fixture_free(&plate);
    fixture_free(&liver);
    return check_report();
}
