/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Meshes with defects: a world, which asks for winding numbers at each sample near holes alone, against stateless
 * queries, which ask for one at each sample everywhere; what is told of holes, by definition; and what defects cost.
 *
 *     test_holes [AXES = 400]
 */
#include "contact/defective_meshes.h"
#include "lib/rig.h"
#include "nearest/nearest_pair.h"
#include "track/world_state.h"

enum { AXES = 400 };
static int axes = AXES;

/* `mesh` may be NULL. */
static int open_rig(struct rig *rig, const dpt_mesh *mesh, uint32_t max_contacts)
{
    dpt_world_def def = rig_def(DPT_LAW_PROXY);
    def.until = DPT_UNTIL_CONTACT;
    def.max_contacts = max_contacts;
    return rig_open(rig, &def, mesh, &rig_point, 1);
}

struct tally {
    int axes, inside, far, near_differ;
};

/*
 * Random axes: a world and a query say the same. Near holes an inside that begins and ends between two samples may be
 * missed by either.
 */
static struct tally compare_some(const char *name, const struct mesh_builder *builder, uint32_t max_contacts, int count)
{
    uint64_t random = 3;
    struct tally tally = { .axes = count };
    struct rig rig;
    struct holes holes;
    if (!open_rig(&rig, builder->mesh, max_contacts))
        return tally;
    const double diagonal = surface_diagonal(&builder->surface);
    dpti_holes_find(&builder->surface, &builder->kernel, &holes);
    for (int i = 0; i < count; i++) {
        const double no_radius = 0.0;
        double ends[6];
        dpt_hit query = { .size = sizeof query };
        any_axis(builder, &random, ends);
        if (holes.has_sheets) /* a query knows of no side that a tool came from */
            dpt_world_reset(rig.world);
        const dpt_hit hit = rig_step_ends(&rig, ends, 0.0);
        dpt_query_segments(builder->mesh, NULL, ends, &no_radius, 1, &query, NULL);
        const vec3 a = vec3_of(ends);
        const int is_far = dpti_holes_are_far_from(&holes, a, sub(vec3_of(ends + 3), a));
        const int is_same = hit.contact == query.contact && fabs(hit.gap - query.gap) <= 2e-5 * diagonal;
        CHECK(is_same || !is_far, "%s: gap %.9g, not %.9g: %.9g %.9g %.9g to %.9g %.9g %.9g", name, hit.gap, query.gap,
              ends[0], ends[1], ends[2], ends[3], ends[4], ends[5]);
        tally.near_differ += !is_same;
        tally.far += is_far;
        tally.inside += query.gap < 0.0;
    }
    printf("    %-28s %3u balls; of %d axes %d inside, %d far from holes; near them %d differ\n", name, holes.count,
           count, tally.inside, tally.far, tally.near_differ);
    rig_close(&rig);
    return tally;
}

static void compare(const char *name, const struct mesh_builder *builder, uint32_t max_contacts)
{
    const struct tally tally = compare_some(name, builder, max_contacts, axes);
    CHECK(tally.inside > axes / 8, "%s: %d inside", name, tally.inside);
    CHECK(tally.far > axes / 8, "%s: %d far", name, tally.far);
    CHECK(tally.near_differ <= axes / 50, "%s: %d differ", name, tally.near_differ);
}

static void worlds_say_what_queries_say(void)
{
    static const struct {
        const char *name;
        uint64_t count;
        int holes;
        double share;
    } cases[] = { { "sphere", 1280, 1, 0.03 },
                  { "torus", 3000, 2, 0.02 },
                  { "liver", 4000, 1, 0.02 },
                  { "liver", 4000, 3, 0.01 },
                  { "box", 4800, 10, 0.008 } };
    struct mesh_builder builder;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        if (holed_shape(&builder, cases[i].name, cases[i].count, cases[i].holes, cases[i].share)) {
            CHECK(part_flags_of(&builder, 0) & MESH_PART_WINDING, "%s: no hole", cases[i].name);
            compare(cases[i].name, &builder, i % 2 ? 32 : 0);
        }
        builder_free(&builder);
    }
}

/* All rims lie within balls that are as long around. */
static void rims_lie_in_balls(const struct mesh_builder *builder, const struct holes *holes)
{
    const uint32_t *neighbours = surface_neighbours(&builder->surface);
    double rims = 0.0, around = 0.0;
    for (uint32_t k = 0; k < holes->count; k++)
        around += 2.0 * PI * hole_radius(holes, k);
    for (uint32_t i = 0; i < 3 * builder->info.triangles; i++) {
        vec3 v[3];
        int is_held = 0;
        if (neighbours[i] != MESH_EDGE_OPEN)
            continue;
        surface_corners(&builder->surface, i / 3, v);
        for (uint32_t k = 0; k < holes->count; k++)
            is_held |= length(sub(v[i % 3], hole_centre(holes, k))) <= hole_radius(holes, k);
        CHECK(is_held, "a rim outside of the balls");
        rims += length(sub(v[(i + 1) % 3], v[i % 3]));
    }
    CHECK(rims > 0.0 && rims <= around, "rims of %g m, balls of %g around", rims, around);
}

static void balls_hold_the_holes(void)
{
    static const uint32_t least[3] = { 2, 1, HOLES_MAX / 4 }, most[3] = { 3, 1, HOLES_MAX };
    for (int kind = 0; kind < 3; kind++) {
        struct mesh_builder builder;
        struct holes holes;
        if (kind == 0   ? holed_shape(&builder, "liver", 4000, 3, 0.015)
            : kind == 1 ? onion(&builder)
                        : sieve(&builder)) {
            dpti_holes_find(&builder.surface, &builder.kernel, &holes);
            CHECK(holes.count >= least[kind] && holes.count <= most[kind], "%d: %u balls", kind, holes.count);
            rims_lie_in_balls(&builder, &holes);
        }
        builder_free(&builder);
    }
}

/* Where the nearest normal is said to tell the side, it says what the winding number does. */
static void normals_tell(void)
{
    struct mesh_builder builder;
    struct holes holes;
    uint64_t random = 5;
    int told = 0;
    if (!holed_shape(&builder, "liver", 4000, 3, 0.015))
        return;
    dpti_holes_find(&builder.surface, &builder.kernel, &holes);
    CHECK(holes.normals_tell, "a liver whose only defects are holes");
    for (int i = 0; i < 20 * axes; i++) {
        const vec3 x = point_in_box(&builder, &random), none = { 0.0, 0.0, 0.0 };
        pair best = { .distance2 = HUGE_VAL }, found;
        uint32_t nearest = 0;
        for (uint32_t t = 0; t < builder.info.triangles; t++) {
            dpti_triangle_point_pair(&builder.surface, t, x, &found);
            if (found.distance2 < best.distance2) {
                best = found;
                nearest = t;
            }
        }
        if (!dpti_holes_are_far_from(&holes, x, none) || !dpti_holes_are_beyond(&holes, x, sqrt(best.distance2)))
            continue;
        told++;
        const int side = dpti_side_of_pair(&builder.surface, nearest, &best);
        CHECK((brute_winding_at(&builder, x) > 0.5) == (side < 0), "side %d at %g %g %g", side, x.x, x.y, x.z);
    }
    CHECK(told > 8 * axes, "%d of %d points told", told, 20 * axes);
    builder_free(&builder);
}

/* Whatever is wrong: worlds say what queries say. */
static void other_defects_are_counted(void)
{
    static const uint32_t balls[DEFECTS] = { 1, 1, 1, 0, 1, 5, 0, 1, 9, 112 };
    for (int kind = 0; kind < DEFECTS; kind++) {
        const char *name;
        struct mesh_builder builder;
        struct holes holes;
        if (defective(&builder, kind, &name)) {
            CHECK(builder.surface.moments, "%s: no part needs a winding number", name);
            dpti_holes_find(&builder.surface, &builder.kernel, &holes);
            CHECK(holes.count == balls[kind], "%s: %u holes", name, holes.count);
            compare(name, &builder, kind % 2 ? 32 : 0);
        }
        builder_free(&builder);
    }
}

/* Through edges and vertices: where a crossing does not say what it counts. */
static void crossings_of_edges_are_asked_for(void)
{
    struct mesh_builder builder;
    struct rig rig;
    if (cubes_with_an_edge_in_common(&builder) && open_rig(&rig, builder.mesh, 32)) {
        for (int i = 0; i < 64; i++) {
            const double no_radius = 0.0, x = 0.0125 * (i % 8 + 1), y = 0.0125 * (i / 8 + 1);
            const double ends[6] = { x, y, -0.02, y, x, i % 3 ? 0.07 : 0.12 };
            dpt_hit query = { .size = sizeof query };
            const dpt_hit hit = rig_step_ends(&rig, ends, 0.0);
            dpt_query_segments(builder.mesh, NULL, ends, &no_radius, 1, &query, NULL);
            CHECK(fabs(hit.gap - query.gap) <= 1e-6, "gap %g, not %g, at %g %g", hit.gap, query.gap, x, y);
        }
        rig_close(&rig);
    }
    builder_free(&builder);
}

/* Beside a sheet whose side is known: as in a world that asks for a winding number at each sample. */
static void sheets_with_sides(void)
{
    struct mesh_builder builder;
    struct rig rig, asking;
    int sided = 0, inside = 0;
    if (!balls_and_a_sheet(&builder, 1) || !open_rig(&rig, builder.mesh, 32) || !open_rig(&asking, builder.mesh, 32))
        return;
    asking.world->bodies[0].surface.holes = NULL;
    for (int i = 0; i < axes; i++) {
        const double x = 0.04 * sin(0.05 * i), y = 0.03 + 0.05 * sin(0.013 * i), z = 0.03 * cos(0.02 * i);
        const double ends[6] = { x - 0.06, y, 0.02 + z, x + 0.09, y + 0.01, 0.025 + z };
        const dpt_hit hit = rig_step_ends(&rig, ends, 0.0), wanted = rig_step_ends(&asking, ends, 0.0);
        CHECK(hit.contact == wanted.contact && fabs(hit.gap - wanted.gap) <= 2e-5 * surface_diagonal(&builder.surface),
              "gap %.9g, not %.9g", hit.gap, wanted.gap);
        dpt_contact contact = { .size = sizeof contact };
        uint32_t count = 0;
        dpt_tool_get_contacts(rig.world, rig.tool, &contact, 1, &count);
        sided += count && (contact.flags & DPT_CONTACT_FLAG_SIDED);
        inside += wanted.gap < 0.0;
    }
    printf("    of %d axes %d inside, %d of them with a side\n", axes, inside, sided);
    CHECK(inside > axes / 8 && sided > axes / 40, "%d inside, %d with a side", inside, sided);
    rig_close(&rig);
    rig_close(&asking);
    builder_free(&builder);
}

/* Real ones, with edges that are wound against each other among their defects. */
static void public_meshes_with_defects(void)
{
    struct tally all = { .axes = 0 };
    for (int i = 0; i < DEFECTIVE_FILES; i++) {
        const char *name;
        struct mesh_builder builder;
        if (defective_file(&builder, getenv("DPT_DATA"), i, &name)) {
            const struct tally tally = compare_some(name, &builder, i % 2 ? 32 : 0, axes / 4);
            all.axes += tally.axes;
            all.inside += tally.inside;
            all.far += tally.far;
            all.near_differ += tally.near_differ;
        }
        builder_free(&builder);
    }
    CHECK(all.inside > all.axes / 8 && all.far > all.axes / 2 && all.near_differ <= all.axes / 50,
          "of %d axes %d inside, %d far, %d differ", all.axes, all.inside, all.far, all.near_differ);
}

/*
 * Units of work of a tool of 0.24 m that goes to and fro; 0 if there is no world. With `is_asking`, a winding number at
 * each sample.
 */
static uint64_t work_through(const struct mesh_builder *builder, int is_asking)
{
    struct rig rig;
    uint64_t work = 0;
    if (!open_rig(&rig, builder->mesh, 32))
        return 0;
    if (is_asking)
        rig.world->bodies[0].surface.holes = NULL;
    for (int i = 0; i < axes; i++) {
        const double z = 0.03 * sin(0.01 * i), x = 0.05 * cos(0.007 * i);
        const double ends[6] = { x - 0.12, -0.02, z - 0.01, x + 0.12, 0.03, z + 0.02 };
        work += rig_step_ends(&rig, ends, 0.0).work;
    }
    rig_close(&rig);
    return work;
}

/* A tool that goes through a liver with a hole does at most 1.2 times the work of one through the whole liver. */
static void a_hole_costs_little(void)
{
    struct mesh_builder builder;
    uint64_t work[2] = { 0, 0 };
    for (int holes = 0; holes < 2; holes++) {
        if (holed_shape(&builder, "liver", 20000, holes, 0.01)) {
            CHECK(!builder.info.open_edges == !holes, "%u open edges", builder.info.open_edges);
            work[holes] = work_through(&builder, 0);
        }
        builder_free(&builder);
    }
    printf("    %.3f of the work without the hole\n", (double)work[1] / (double)work[0]);
    CHECK(work[0] && work[1] < work[0] + work[0] / 5, "%llu units, not %llu", (unsigned long long)work[1],
          (unsigned long long)work[0]);
}

/* 27 balls beside each other, whole or with a hole each: 1.5 times the work at most. */
static void parts_with_holes_cost_little(void)
{
    uint64_t work[2] = { 0, 0 };
    for (int missing = 0; missing < 2; missing++) {
        struct mesh_builder builder = { .mesh = NULL };
        for (int i = 0; i < 27; i++)
            builder_add_shape(&builder, "sphere", 1280,
                              (vec3){ 0.07 * (i % 3 - 1), 0.07 * (i / 3 % 3 - 1), 0.07 * (i / 9 - 1) }, 0.3, 0,
                              (size_t)missing);
        if (builder_compile(&builder)) {
            CHECK(builder.info.winding_components == (missing ? 27u : 0u), "%u", builder.info.winding_components);
            work[missing] = work_through(&builder, 0);
        }
        builder_free(&builder);
    }
    printf("    %.3f of the work without holes\n", (double)work[1] / (double)work[0]);
    CHECK(work[0] && work[1] < work[0] + work[0] / 2, "%llu units, not %llu", (unsigned long long)work[1],
          (unsigned long long)work[0]);
}

/* 112 balls that overlap, each with a hole: less than a tenth of the work. */
static void many_bad_parts_cost_less(void)
{
    struct mesh_builder builder;
    const char *name;
    if (defective(&builder, DEFECTS - 1, &name)) {
        const uint64_t counted = work_through(&builder, 0), asked = work_through(&builder, 1);
        printf("    %s: %llu units a tick, %llu with a number at each sample\n", name,
               (unsigned long long)counted / (unsigned)axes, (unsigned long long)asked / (unsigned)axes);
        CHECK(counted && counted < asked / 10, "%llu of %llu", (unsigned long long)counted, (unsigned long long)asked);
    }
    builder_free(&builder);
}

static void exchange_axes(const double from[3], double to[3])
{
    for (int k = 0; k < 3; k++)
        to[k] = from[(k + 1) % 3];
}

/* A body that deforms, turned from its shape at rest, says what one at rest does. Returns units of work. */
static uint64_t deform_and_compare(const struct mesh_builder *builder)
{
    struct rig rig;
    dpt_deformable_def def;
    uint64_t random = 5, work = 0;
    int inside = 0;
    if (!open_rig(&rig, NULL, 0))
        return 0;
    const uint32_t count = builder->info.vertices;
    float *turned = malloc(3 * count * sizeof *turned);
    dpt_deformable_def_init(&def);
    def.mesh = builder->mesh;
    for (int k = 0; k < 3; k++) {
        def.box_min[k] = -1.0;
        def.box_max[k] = 1.0;
    }
    const dpt_body body = rig_add_deformable(&rig, &def);
    const float *rest;
    uint32_t rest_count;
    dpt_body_get_vertices(rig.world, body, &rest, &rest_count);
    for (uint32_t i = 0; i < 3 * count; i++)
        turned[i] = rest[i - i % 3 + (i + 1) % 3];
    CHECK(dpt_body_set_vertices(rig.world, body, 0, count, turned, -1.0) == DPT_OK, "set");
    for (int i = 0; i < axes; i++) {
        const double no_radius = 0.0;
        double ends[6], ends_turned[6];
        dpt_hit query = { .size = sizeof query };
        any_axis(builder, &random, ends);
        exchange_axes(ends, ends_turned);
        exchange_axes(ends + 3, ends_turned + 3);
        const dpt_hit hit = rig_step_ends(&rig, ends_turned, 0.0);
        dpt_query_segments(builder->mesh, NULL, ends, &no_radius, 1, &query, NULL);
        CHECK(fabs(hit.gap - query.gap) <= 1e-5, "gap %.9g, not %.9g", hit.gap, query.gap);
        inside += query.gap < 0.0;
        work += hit.work;
    }
    CHECK(inside > axes / 8, "%d inside", inside);
    rig_close(&rig);
    free(turned);
    return work;
}

/* Holes are not taken for where they were at rest. What has none stays without one: few winding numbers are summed. */
static void bodies_that_deform(void)
{
    struct mesh_builder builder;
    uint64_t torn = 0, whole = 0;
    if (holed_shape(&builder, "sphere", 1280, 1, 0.06))
        torn = deform_and_compare(&builder);
    builder_free(&builder);
    builder = (struct mesh_builder){ .mesh = NULL };
    builder_add_shape(&builder, "sphere", 640, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0, 0);
    builder_add_shape(&builder, "sphere", 640, (vec3){ 0.1, 0.0, 0.0 }, 0.9, 0, 0);
    if (builder_compile(&builder)) {
        CHECK(builder.surface.moments, "they do not overlap");
        whole = deform_and_compare(&builder);
    }
    builder_free(&builder);
    printf("    overlapping balls: %.3f of the work of one with a hole\n", (double)whole / (double)torn);
    CHECK(whole && whole < torn / 2, "%llu and %llu units", (unsigned long long)whole, (unsigned long long)torn);
}

int main(int argc, char **argv)
{
    if (argc > 1)
        axes = atoi(argv[1]);
    TEST(balls_hold_the_holes);
    TEST(normals_tell);
    TEST(worlds_say_what_queries_say);
    TEST(other_defects_are_counted);
    TEST(crossings_of_edges_are_asked_for);
    TEST(sheets_with_sides);
    if (getenv("DPT_DATA"))
        TEST(public_meshes_with_defects);
    else
        SKIP("public meshes with defects", "DPT_DATA does not name the data folder");
    TEST(a_hole_costs_little);
    TEST(parts_with_holes_cost_little);
    if (axes >= AXES) /* the units are the same with fewer, and in a sanitized build */
        TEST(many_bad_parts_cost_less);
    TEST(bodies_that_deform);
    return check_report();
}
