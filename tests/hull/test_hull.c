/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Hulls of points against the oracle, which knows a convex polyhedron from its definition: clouds of all kinds, large,
 * small and far away, exactly flat, nearly flat, and such that are none. What shapes are made of test_hull_shape asks.
 *
 *     test_hull [PER CENT]   of the clouds
 */
#include "hull/hull_maker.h"
#include "lib/size_checks.h"

static uint64_t rng = 11;

/*
 * What points may lie off a face that they belong to, as a part of the size: rounding, more of it where faces are long
 * or nearly flat sets are taken for polygons. Beside that, 64 roundings of the largest coordinate.
 */
static const double CLOUD_OFF = 1e-12, FLAT_OFF = 1e-11;

/* How far a point lies from a segment. */
static double off_segment(vec3 x, const double axis[2][3])
{
    const vec3 a = vec3_of(axis[0]), u = sub(vec3_of(axis[1]), a);
    return length(sub(x, along(a, nearest_on(a, u, x), u)));
}

/* All corners are within reach of the axis, and some corner is as far: the reach is no larger than it must be. */
static void check_info(const struct made_hull *made, double radius)
{
    dpt_hull_info info = { .size = sizeof info };
    double far = 0.0;
    CHECK(dpt_hull_get_info(made->hull, &info) == DPT_OK, "info");
    CHECK(info.radius == radius, "%g", info.radius);
    for (uint32_t i = 0; i < made->as.corner_count; i++)
        far = max_of(far, off_segment(vec3_of(made->as.corner[i]), info.axis));
    const double rounding = 0x1p-50 * (made->size + made->extent);
    CHECK(far <= info.reach + rounding, "%.17g, a corner is %.17g off", info.reach, far);
    CHECK(info.reach <= far + 1e-9 * made->size + rounding, "%.17g, no corner is more than %.17g", info.reach, far);
    CHECK(info.reach <= 0.87 * made->size, "%g of %g", info.reach, made->size);
}

/* How many of a hull's pairs of neighbouring faces lie in one plane: those are one face. */
static uint32_t split_faces(const struct made_hull *made)
{
    const struct dpt_hull *hull = made->hull;
    uint32_t split = 0;
    for (uint32_t f = 0; f < hull->face_count; f++)
        for (uint32_t g = 0; g < f; g++)
            split += length(sub(hull->face[f].normal, hull->face[g].normal)) < 1e-9;
    return split;
}

/* The points are small whole numbers times a power of 2: it is known which jut out. */
static void check_exact_corners(const struct made_hull *made)
{
    uint32_t juts = 0;
    for (uint32_t i = 0; i < made->count; i++) {
        int is_first = 1;
        for (uint32_t j = 0; j < i; j++)
            is_first &= memcmp(made->point + 3 * i, made->point + 3 * j, 3 * sizeof(double)) != 0;
        juts += is_first && oracle_hull_juts(made->point, made->count, i) > 1e-6 * made->size;
    }
    CHECK(made->as.corner_count == juts, "%u corners, %u points jut out: %s", made->as.corner_count, juts,
          points_text(made->point, made->count));
    CHECK(split_faces(made) == 0, "%u faces in one plane with others: %s", split_faces(made),
          points_text(made->point, made->count));
}

/* What the library keeps for itself is what it tells: unit normals, out of the faces. */
static void check_normals(const struct made_hull *made, double allowed)
{
    const struct dpt_hull *hull = made->hull;
    CHECK(hull->is_flat == (hull->face_count == 2), "flat %u, %u faces", hull->is_flat, hull->face_count);
    for (uint32_t f = 0; f < hull->face_count; f++) {
        const vec3 n = hull->face[f].normal;
        const vec3 at = vec3_of(made->as.corner[made->as.side[f][0]]);
        CHECK(fabs(length(n) - 1.0) < 1e-14, "%.17g", length(n));
        for (uint32_t i = 0; i < made->as.corner_count; i++) {
            const double height = dot(n, sub(vec3_of(made->as.corner[i]), at));
            CHECK(height <= allowed, "corner %u is %g of %g beyond face %u", i, height, made->size, f);
        }
    }
}

static void check_made(const struct made_hull *made, const char *name, double off)
{
    const double allowed = off * made->size + 0x1p-47 * made->extent;
    const char *fault = oracle_hull_fault(&made->as, made->point, made->count, allowed);
    CHECK(!fault, "%s: %s: %s", name, fault, points_text(made->point, made->count));
    check_info(made, made->hull->radius);
    check_normals(made, allowed);
}

static void clouds_have_their_convex_hull(void)
{
    for (int kind = 0; kind < CLOUDS; kind++) {
        uint32_t corners = 0, faces = 0;
        const uint64_t count = part_of(600);
        for (uint64_t i = 0; i < count; i++) {
            struct made_hull made;
            const double factor = one_in(&rng, 3) ? 1.0 : ldexp(1.0, (int)whole_in(&rng, 0, 20) - 10);
            double offset[3] = { 0.0, 0.0, 0.0 };
            if (kind != CLOUD_LATTICE && one_in(&rng, 4))
                vec3_store(any_in(&rng, factor * power_in(&rng, 0.0, 3.0)), offset);
            if (kind == CLOUD_POLYGON)
                memset(offset, 0, sizeof offset);
            cloud_points(&rng, kind, 0, &made);
            cloud_place(&made, factor, offset);
            const double radius = one_in(&rng, 2) ? 0.0 : random_in(&rng, 0.0, 1.0);
            const dpt_result result = make_hull(&made, radius);
            CHECK(result == DPT_OK, "%s: %s: %s", cloud_names[kind], dpt_result_name(result),
                  points_text(made.point, made.count));
            if (result != DPT_OK)
                continue;
            check_made(&made, cloud_names[kind], CLOUD_OFF);
            if (kind == CLOUD_LATTICE)
                check_exact_corners(&made);
            CHECK(kind != CLOUD_SPHERE || made.as.corner_count == made.count, "%u of %u on a sphere",
                  made.as.corner_count, made.count);
            CHECK(kind != CLOUD_POLYGON || made.as.face_count == 2, "%u faces", made.as.face_count);
            corners += made.as.corner_count;
            faces += made.as.face_count;
        }
        printf("    %-10s %5.1f corners, %5.1f faces\n", cloud_names[kind], (double)corners / (double)count,
               (double)faces / (double)count);
    }
}

/* Lattices in a plane that is no axes' plane are flat exactly as well. */
static void flat_lattices_are_polygons(void)
{
    for (uint64_t i = 0; i < part_of(600); i++) {
        struct made_hull made = { .count = whole_in(&rng, 3, DPT_HULL_CORNERS_MAX) };
        const vec3 e = { 1.0, (double)whole_in(&rng, 0, 2), (double)whole_in(&rng, 0, 2) };
        const vec3 f = { 0.0, 1.0, whole_in(&rng, 0, 3) - 1.0 };
        for (uint32_t k = 0; k < made.count; k++) {
            const double u = k < 3 ? k == 1 : whole_in(&rng, 0, 8) - 4.0;
            const double v = k < 3 ? k == 2 : whole_in(&rng, 0, 8) - 4.0;
            vec3_store(along(scaled(e, u), v, f), made.point + 3 * k);
        }
        cloud_place(&made, ldexp(1.0, (int)whole_in(&rng, 0, 20) - 10), (double[3]){ 0.0 });
        const dpt_result result = make_hull(&made, 0.0);
        CHECK(result == DPT_OK, "%s", dpt_result_name(result));
        if (result != DPT_OK)
            continue;
        check_made(&made, "flat lattice", CLOUD_OFF);
        check_exact_corners(&made);
        CHECK(made.as.face_count == 2, "%u faces: %s", made.as.face_count, points_text(made.point, made.count));
        CHECK(made.as.edge_count == made.as.corner_count, "%u edges", made.as.edge_count);
    }
}

static vec3 turned(const dpt_pose *pose, vec3 x)
{
    struct frame frame;
    frame_of_pose(pose, &frame);
    return frame_turn(&frame, x);
}

/* Thinner and thinner, in any direction: refused, or what it says it is. */
static void nearly_flat_clouds_are_refused_or_right(void)
{
    for (int power = 0; power >= -20; power -= 2) {
        const uint64_t count = part_of(100);
        uint64_t refused = 0, flat = 0;
        for (uint64_t i = 0; i < count; i++) {
            struct made_hull made;
            const dpt_pose pose = any_pose(&rng, 0.0);
            cloud_points(&rng, one_in(&rng, 2) ? CLOUD_CUBE : CLOUD_BOX, 0, &made);
            for (uint32_t k = 0; k < made.count; k++) {
                const vec3 x = vec3_of(made.point + 3 * k);
                const double thin = power > -20 ? pow(10.0, power) : 0.0;
                vec3_store(turned(&pose, (vec3){ x.x, x.y, thin * x.z }), made.point + 3 * k);
            }
            cloud_place(&made, 1.0, (double[3]){ 0.0 });
            const dpt_result result = make_hull(&made, 0.0);
            CHECK(result == DPT_OK || result == DPT_E_ARGUMENT, "%s", dpt_result_name(result));
            if (result == DPT_OK)
                check_made(&made, "nearly flat", FLAT_OFF);
            refused += result != DPT_OK;
            flat += result == DPT_OK && made.as.face_count == 2;
            CHECK(power < -3 || (result == DPT_OK && made.as.face_count > 2), "1e%d: %s, %u faces", power,
                  dpt_result_name(result), made.as.face_count);
        }
        printf("    thickness 1e%-3d of %3u: %3u refused, %3u polygons\n", power, (unsigned)count, (unsigned)refused,
               (unsigned)flat);
    }
}

/* Points on one line: exactly, and in any direction; fewer than three places. */
static void lines_and_points_are_refused(void)
{
    for (uint64_t i = 0; i < part_of(1000); i++) {
        struct made_hull made = { .count = whole_in(&rng, 3, DPT_HULL_CORNERS_MAX) };
        const vec3 a = any_in(&rng, 1.0);
        const int kind = (int)whole_in(&rng, 0, 3);
        vec3 u = any_in(&rng, 1.0);
        if (kind == 0)
            u = (vec3){ 0.0, 0.0, 0.0 };
        if (kind == 1)
            u = (vec3){ whole_in(&rng, 0, 2) - 1.0, whole_in(&rng, 0, 2) - 1.0, 1.0 };
        for (uint32_t k = 0; k < made.count; k++) {
            const double at = kind < 2 ? (double)whole_in(&rng, 0, 8) : random_in(&rng, 0.0, 1.0);
            vec3_store(kind == 1   ? scaled(u, at)
                       : kind == 3 ? (k % 2 ? add(a, u) : a)
                                   : along(a, at, u),
                       made.point + 3 * k);
        }
        const dpt_result result = make_hull(&made, 0.1);
        CHECK(result == DPT_E_ARGUMENT, "%s: %s", dpt_result_name(result), points_text(made.point, made.count));
        CHECK(made.hull == NULL, "a hull of a line");
    }
}

static const double four[12] = { 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0 };

static dpt_result create_from(const dpt_hull_def *def)
{
    static uint64_t block[2048];
    const dpt_hull *hull = NULL;
    const dpt_result result = dpt_hull_create(block, sizeof block, def, &hull);
    CHECK((result == DPT_OK) == (hull != NULL), "%s", dpt_result_name(result));
    return result;
}

static void defs_that_are_none_are_refused(void)
{
    static const double wrong[] = { NAN, INFINITY, -INFINITY, 1.001e6, -1.001e6 };
    double corners[3 * (DPT_HULL_CORNERS_MAX + 1)];
    for (uint32_t i = 0; i < 3 * (DPT_HULL_CORNERS_MAX + 1); i++)
        corners[i] = random_in(&rng, -1.0, 1.0);
    const dpt_hull_def good = { .size = sizeof good, .corner_count = 4, .corners = corners };
    dpt_hull_def def = good;
    CHECK(create_from(&def) == DPT_OK, "the good one");
    static const uint32_t counts[] = { 0, 1, 2, DPT_HULL_CORNERS_MAX + 1, UINT32_MAX };
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        def.corner_count = counts[i];
        CHECK(create_from(&def) == DPT_E_ARGUMENT && dpt_hull_bytes(&def) == 0, "%u: %s", counts[i],
              dpt_result_name(create_from(&def)));
    }
    def = good;
    def.corners = NULL;
    CHECK(create_from(&def) == DPT_E_ARGUMENT && dpt_hull_bytes(&def) == 0, "no corners");
    def = good;
    def.reserved_pointer = corners;
    CHECK(create_from(&def) == DPT_E_ARGUMENT && dpt_hull_bytes(&def) == 0, "a reserved pointer");
    CHECK(create_from(NULL) == DPT_E_ARGUMENT && dpt_hull_bytes(NULL) == 0, "no def");
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        for (uint32_t k = 0; k < 12; k++) {
            const double was = corners[k];
            def = good;
            corners[k] = wrong[i];
            CHECK(create_from(&def) == DPT_E_FINITE && dpt_hull_bytes(&def) == 0, "%g: %s", wrong[i],
                  dpt_result_name(create_from(&def)));
            corners[k] = was;
        }
    static const double radii[] = { NAN, INFINITY, -1e-300, -1.0, 1.001e6 };
    for (size_t i = 0; i < sizeof radii / sizeof *radii; i++) {
        def = good;
        def.radius = radii[i];
        CHECK(create_from(&def) == DPT_E_FINITE && dpt_hull_bytes(&def) == 0, "%g: %s", radii[i],
              dpt_result_name(create_from(&def)));
    }
    def = good;
    def.radius = 1e6;
    CHECK(create_from(&def) == DPT_OK, "the largest radius");
    for (uint32_t i = 0; i < 12; i++)
        corners[i] = 1e6 * (2.0 * four[i] - 1.0);
    CHECK(create_from(&def) == DPT_OK, "the largest corners");
}

static void blocks_that_do_not_do_are_refused(void)
{
    static uint64_t block[2048];
    const dpt_hull_def def = { .size = sizeof def, .corner_count = 4, .corners = four };
    const size_t bytes = dpt_hull_bytes(&def);
    const dpt_hull *hull = NULL;
    char *const at = (char *)block;
    CHECK(dpt_hull_create(block, bytes - 1, &def, &hull) == DPT_E_MEMORY && !hull, "a byte less");
    CHECK(dpt_hull_create(block, 0, &def, &hull) == DPT_E_MEMORY && !hull, "no byte");
    for (size_t off = 1; off < 8; off++)
        CHECK(dpt_hull_create(at + off, sizeof block - 8, &def, &hull) == DPT_E_ALIGN && !hull, "off by %zu", off);
    CHECK(dpt_hull_create(NULL, bytes, &def, &hull) == DPT_E_ARGUMENT && !hull, "no block");
    CHECK(dpt_hull_create(block, bytes, &def, NULL) == DPT_E_ARGUMENT, "no hull to set");
    CHECK(dpt_hull_create(at + 8, bytes, &def, &hull) == DPT_OK && hull, "as many as needed");
}

static void getters_refuse_what_is_not_there(void)
{
    struct made_hull made = { .count = 4 };
    memcpy(made.point, four, sizeof four);
    cloud_place(&made, 1.0, (double[3]){ 0.0 });
    CHECK(make_hull(&made, 0.0) == DPT_OK, "a tetrahedron");
    uint32_t two[2] = { 7, 7 }, three[4] = { 7, 7, 7, 7 }, count = 7;
    double at[3] = { 7.0, 7.0, 7.0 };
    dpt_hull_info info = { .size = sizeof info };
    const dpt_hull *hull = made.hull;
    CHECK(dpt_hull_get_info(NULL, &info) == DPT_E_ARGUMENT, "no hull");
    CHECK(dpt_hull_get_info(hull, NULL) == DPT_E_ARGUMENT, "no info");
    CHECK(dpt_hull_get_corner(hull, 4, at) == DPT_E_ARGUMENT && at[0] == 7.0, "corner 4");
    CHECK(dpt_hull_get_corner(hull, UINT32_MAX, at) == DPT_E_ARGUMENT, "corner -1");
    CHECK(dpt_hull_get_corner(NULL, 0, at) == DPT_E_ARGUMENT, "no hull");
    CHECK(dpt_hull_get_corner(hull, 0, NULL) == DPT_E_ARGUMENT, "no place");
    CHECK(dpt_hull_get_edge(hull, 6, two) == DPT_E_ARGUMENT && two[0] == 7, "edge 6");
    CHECK(dpt_hull_get_edge(NULL, 0, two) == DPT_E_ARGUMENT, "no hull");
    CHECK(dpt_hull_get_edge(hull, 0, NULL) == DPT_E_ARGUMENT, "no edge");
    CHECK(dpt_hull_get_face(hull, 4, three, 3, &count) == DPT_E_ARGUMENT && count % 7 == 0, "face 4");
    CHECK(dpt_hull_get_face(NULL, 0, three, 3, &count) == DPT_E_ARGUMENT, "no hull");
    CHECK(dpt_hull_get_face(hull, 0, NULL, 3, &count) == DPT_E_ARGUMENT, "no corners");
    CHECK(dpt_hull_get_face(hull, 0, three, 3, NULL) == DPT_E_ARGUMENT, "no count");
    CHECK(dpt_hull_get_face(hull, 0, NULL, 0, &count) == DPT_OK && count == 3, "%u", count);
    CHECK(dpt_hull_get_face(hull, 0, three, 2, &count) == DPT_OK && count == 3 && three[2] == 7, "%u, %u", count,
          three[2]);
    CHECK(dpt_hull_get_face(hull, 0, three, 4, &count) == DPT_OK && count == 3 && three[3] == 7, "%u, %u", count,
          three[3]);
}

static const dpt_hull *a_hull;

static dpt_result info_of(void *out)
{
    return dpt_hull_get_info(a_hull, out);
}

static dpt_result def_of(void *given)
{
    const dpt_result result = create_from(given);
    CHECK((dpt_hull_bytes(given) > 0) == (result == DPT_OK), "%zu bytes, %s", dpt_hull_bytes(given),
          dpt_result_name(result));
    return result;
}

static void structs_of_other_sizes_are_taken_by_the_rule(void)
{
    static uint64_t block[2048];
    const dpt_hull_def def = { .size = sizeof def, .corner_count = 4, .corners = four };
    const struct sized of_def = { "dpt_hull_def", sizeof def, sizeof def, def_of };
    const struct sized of_info = { "dpt_hull_info", sizeof(dpt_hull_info), sizeof(dpt_hull_info), info_of };
    CHECK(dpt_hull_create(block, sizeof block, &def, &a_hull) == DPT_OK, "a tetrahedron");
    check_input(&of_def, &def);
    check_output(&of_info);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(clouds_have_their_convex_hull);
    TEST(flat_lattices_are_polygons);
    TEST(nearly_flat_clouds_are_refused_or_right);
    TEST(lines_and_points_are_refused);
    TEST(defs_that_are_none_are_refused);
    TEST(blocks_that_do_not_do_are_refused);
    TEST(getters_refuse_what_is_not_there);
    TEST(structs_of_other_sizes_are_taken_by_the_rule);
    return check_report();
}
