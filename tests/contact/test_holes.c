/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Meshes with holes: a world, which asks for winding numbers near the holes alone, against stateless queries, which ask
 * for one at each sample; what is told of holes, by definition; and what they cost.
 *
 *     test_holes [AXES = 400]
 */
#include "contact/holes.h"
#include "dynpoint.h"
#include "lib/mesh_builder.h"
#include "nearest/side.h"

static int axes = 400;

/* Leave out what lies within `radius` of a vertex. */
static void cut_hole(struct mesh_builder *builder, uint32_t vertex, double radius)
{
    const vec3 centre = vec3_of(builder->vertices + 3 * (size_t)vertex);
    size_t kept = 0;
    for (size_t t = 0; t < builder->triangle_count; t++) {
        const uint32_t *corner = builder->corners + 3 * t;
        double farthest = 0.0;
        for (int k = 0; k < 3; k++)
            farthest = max_of(
                farthest, length(sub(vec3_of(builder->vertices + 3 * (size_t)corner[k]), centre)));
        if (farthest > radius)
            memmove(builder->corners + 3 * kept++, corner, 3 * sizeof *corner);
    }
    builder->triangle_count = kept;
}

/* A shape with so many holes, each of that share of its size; compiled. */
static int holed_shape(struct mesh_builder *builder, const char *name, uint64_t count, int holes,
                       double share)
{
    uint64_t random = 7;
    *builder = (struct mesh_builder){ .mesh = NULL };
    builder_add_shape(builder, name, count, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0, 0);
    for (int i = 0; i < holes; i++)
        cut_hole(builder, (uint32_t)(random_bits(&random) % builder->vertex_count), share);
    return builder_compile(builder);
}

/*
 * A ball with a hole at its top, pushed in from below so far that a thin finger comes out of the hole: seen from the
 * finger's end, what closes the hole is crossed.
 */
static int finger(struct mesh_builder *builder)
{
    enum { TURN = 24, ROWS = 60, TIP = TURN * ROWS };
    *builder = (struct mesh_builder){ .mesh = NULL };
    builder_reserve(builder, TIP + 1, 2 * TURN * ROWS);
    for (int row = 0; row < ROWS; row++) {
        const double along = (double)row / (ROWS - 1);
        const double angle = 0.3 + 2.72 * min_of(1.0, along / 0.6);
        const double rise = max_of(0.0, (along - 0.6) / 0.4);
        for (int i = 0; i < TURN; i++) {
            const double turn = 2.0 * PI * i / TURN, r = sin(angle) * (1.0 - 0.2 * rise);
            builder_add_vertex(builder, r * cos(turn), r * sin(turn), cos(angle) + 2.8 * rise);
        }
    }
    builder_add_vertex(builder, 0.0, 0.0, 1.9);
    for (int row = 0; row < ROWS; row++)
        for (int i = 0; i < TURN; i++) {
            const size_t here = (size_t)(row * TURN + i);
            const size_t next = (size_t)(row * TURN + (i + 1) % TURN);
            if (row == ROWS - 1) {
                builder_add_triangle(builder, here, TIP, next, 0);
                continue;
            }
            builder_add_triangle(builder, here, here + TURN, next, 0);
            builder_add_triangle(builder, next, here + TURN, next + TURN, 0);
        }
    return builder_compile(builder);
}

/* A segment that ends anywhere in the box, or half of the time beside a hole's rim. */
static void any_axis(const struct mesh_builder *builder, uint64_t *random, double ends[6])
{
    vec3 a = point_in_box(builder, random), b = point_in_box(builder, random);
    if (random_bits(random) % 4 == 0)
        b = along(a, 0.05, sub(b, a));
    if (builder->info.open_edges && random_bits(random) % 3 == 0) {
        const uint32_t *neighbours = surface_neighbours(&builder->surface);
        uint32_t i = (uint32_t)(random_bits(random) % (3 * builder->info.triangles));
        while (neighbours[i] != MESH_EDGE_OPEN)
            i = (i + 1) % (3 * builder->info.triangles);
        vec3 v[3];
        surface_corners(&builder->surface, i / 3, v);
        a = along(v[i % 3], 0.1, sub(a, v[i % 3]));
    }
    vec3_store(a, ends);
    vec3_store(b, ends + 3);
}

struct stage {
    dpt_world *world;
    dpt_tool tool;
    void *block;
};

/* `mesh` may be NULL. */
static int stage_open(struct stage *stage, const dpt_mesh *mesh, uint32_t max_contacts)
{
    const dpt_segment none = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.0 }, 0.0 };
    dpt_world_def def;
    dpt_body body;
    dpt_world_def_init(&def);
    def.until = DPT_UNTIL_CONTACT;
    def.max_contacts = max_contacts;
    stage->block = malloc(dpt_world_bytes(&def));
    const int is_made =
        dpt_world_create(stage->block, dpt_world_bytes(&def), &def, &stage->world) == DPT_OK &&
        (!mesh || dpt_body_add(stage->world, mesh, NULL, &body) == DPT_OK) &&
        dpt_tool_add(stage->world, &none, 1, &stage->tool) == DPT_OK;
    CHECK(is_made, "no world");
    return is_made;
}

static dpt_hit stage_tick(const struct stage *stage, const double ends[6])
{
    dpt_hit hit = { .size = sizeof hit };
    dpt_segment segment = { .radius = 0.0 };
    memcpy(segment.a, ends, sizeof segment.a);
    memcpy(segment.b, ends + 3, sizeof segment.b);
    CHECK(dpt_tool_set_segments(stage->world, stage->tool, &segment, 1) == DPT_OK &&
              dpt_world_step(stage->world, 1e-3, NULL) == DPT_OK &&
              dpt_tool_get_hit(stage->world, stage->tool, &hit) == DPT_OK,
          "no step");
    return hit;
}

/* Random axes: a world and a query say the same. */
static void compare(const char *name, const struct mesh_builder *builder, uint32_t max_contacts)
{
    uint64_t random = 3;
    int inside = 0, far = 0;
    struct stage stage;
    struct holes holes;
    if (!stage_open(&stage, builder->mesh, max_contacts))
        return;
    const double diagonal = surface_diagonal(&builder->surface);
    dpti_holes_find(&builder->surface, &builder->kernel, &holes);
    for (int i = 0; i < axes; i++) {
        const double no_radius = 0.0;
        double ends[6];
        dpt_hit query = { .size = sizeof query };
        any_axis(builder, &random, ends);
        const dpt_hit hit = stage_tick(&stage, ends);
        dpt_query_segments(builder->mesh, NULL, ends, &no_radius, 1, &query, NULL);
        const vec3 a = vec3_of(ends);
        if (dpti_holes_are_far_from(&holes, a, sub(vec3_of(ends + 3), a))) {
            CHECK(fabs(hit.gap - query.gap) <= 2e-5 * diagonal,
                  "%s: gap %.9g, not %.9g: %.9g %.9g %.9g to %.9g %.9g %.9g", name, hit.gap,
                  query.gap, ends[0], ends[1], ends[2], ends[3], ends[4], ends[5]);
            far++;
        }
        inside += query.gap < 0.0;
    }
    printf("    %-10s %u balls; of %d axes %d inside, %d far from holes\n", name, holes.count, axes,
           inside, far);
    CHECK(inside > axes / 8, "%d inside", inside);
    CHECK(!holes.count || far > axes / 8, "%d far", far);
    free(stage.block);
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

/* All rims lie within the balls; away from them the rounded winding number is that of the nearest triangle's side. */
static void balls_hold_the_holes(void)
{
    struct mesh_builder builder;
    uint64_t random = 5;
    if (!holed_shape(&builder, "liver", 4000, 3, 0.015))
        return;
    struct holes holes;
    dpti_holes_find(&builder.surface, &builder.kernel, &holes);
    CHECK(holes.count > 1, "%u", holes.count);
    const uint32_t *neighbours = surface_neighbours(&builder.surface);
    for (uint32_t i = 0; i < 3 * builder.info.triangles; i++) {
        vec3 v[3];
        int is_held = 0;
        surface_corners(&builder.surface, i / 3, v);
        for (uint32_t k = 0; k < holes.count; k++)
            is_held |=
                length(sub(v[i % 3], holes.ball[k].centre)) <= holes.ball[k].radius * 1.0000001;
        CHECK(neighbours[i] != MESH_EDGE_OPEN || is_held, "a rim outside of the balls");
    }
    int told = 0;
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
        if (!dpti_holes_are_far_from(&holes, x, none) ||
            !dpti_holes_are_beyond(&holes, x, sqrt(best.distance2)))
            continue;
        told++;
        const int side = dpti_side_of_pair(&builder.surface, nearest, &best);
        CHECK((brute_winding_at(&builder, x) > 0.5) == (side < 0), "side %d at %g %g %g", side, x.x,
              x.y, x.z);
    }
    CHECK(told > 10 * axes, "%d of %d points told", told, 20 * axes);
    builder_free(&builder);
}

/* Nothing is told of holes that are not all that is wrong. */
static void other_defects_are_left_to_winding_numbers(void)
{
    struct mesh_builder builder;
    struct holes holes;
    if (finger(&builder)) {
        CHECK(part_flags_of(&builder, 0) & MESH_PART_WINDING, "the finger's ball is not solid");
        dpti_holes_find(&builder.surface, &builder.kernel, &holes);
        CHECK(holes.count == 0, "a finger through its hole: %u", holes.count);
        compare("finger", &builder, 32);
    }
    builder_free(&builder);
    builder = (struct mesh_builder){ .mesh = NULL };
    builder_add_shape(&builder, "sphere", 320, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0, 6);
    builder_add_shape(&builder, "sphere", 320, (vec3){ 1.0, 0.0, 0.0 }, 1.0, 0, 0);
    if (builder_compile(&builder)) {
        dpti_holes_find(&builder.surface, &builder.kernel, &holes);
        CHECK(holes.count == 0, "two parts: %u", holes.count);
    }
    builder_free(&builder);
    builder = (struct mesh_builder){ .mesh = NULL };
    builder_add_shape(&builder, "sphere", 320, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0, 6);
    for (int k = 0; k < 3; k++)
        builder.vertices[3 * 100 + k] *= -1.05;
    if (builder_compile(&builder) && (part_flags_of(&builder, 0) & MESH_PART_WINDING)) {
        CHECK(builder.info.self_intersections > 0, "it does not cut itself");
        dpti_holes_find(&builder.surface, &builder.kernel, &holes);
        CHECK(holes.count == 0, "a part that cuts itself: %u", holes.count);
    }
    builder_free(&builder);
}

/* A tool that goes through a liver with a hole does at most 1.2 times the work of one through the whole liver. */
static void a_hole_costs_little(void)
{
    struct mesh_builder builder;
    uint64_t work[2] = { 0, 0 };
    for (int holes = 0; holes < 2; holes++) {
        struct stage stage;
        if (!holed_shape(&builder, "liver", 20000, holes, 0.01) ||
            !stage_open(&stage, builder.mesh, 32))
            return;
        CHECK(!builder.info.open_edges == !holes, "%u open edges", builder.info.open_edges);
        for (int i = 0; i < axes; i++) {
            const double z = 0.03 * sin(0.01 * i), x = 0.05 * cos(0.007 * i);
            const double ends[6] = { x - 0.12, -0.02, z - 0.01, x + 0.12, 0.03, z + 0.02 };
            work[holes] += stage_tick(&stage, ends).work;
        }
        free(stage.block);
        builder_free(&builder);
    }
    printf("    %.3f of the work without the hole\n", (double)work[1] / (double)work[0]);
    CHECK(work[1] < work[0] + work[0] / 5, "%llu units, not %llu", (unsigned long long)work[1],
          (unsigned long long)work[0]);
}

static void exchange_axes(const double from[3], double to[3])
{
    for (int k = 0; k < 3; k++)
        to[k] = from[(k + 1) % 3];
}

/* A body that deforms takes its holes with it: turned to where they were not, it says what one at rest does. */
static void holes_that_move_are_not_taken_for_those_at_rest(void)
{
    struct mesh_builder builder;
    struct stage stage;
    dpt_deform_def def;
    dpt_body body;
    uint64_t random = 5;
    int inside = 0;
    if (!holed_shape(&builder, "sphere", 1280, 1, 0.06) || !stage_open(&stage, NULL, 0))
        return;
    const uint32_t count = builder.info.vertices;
    float *turned = malloc(3 * count * sizeof *turned);
    dpt_deform_def_init(&def);
    def.mesh = builder.mesh;
    for (int k = 0; k < 3; k++) {
        def.box_min[k] = -1.0;
        def.box_max[k] = 1.0;
    }
    void *block = malloc(dpt_deform_bytes(&def));
    CHECK(dpt_deform_add(stage.world, block, dpt_deform_bytes(&def), &def, &body) == DPT_OK,
          "added");
    const float *rest;
    uint32_t rest_count;
    dpt_deform_get_vertices(stage.world, body, &rest, &rest_count);
    for (uint32_t i = 0; i < 3 * count; i++)
        turned[i] = rest[i - i % 3 + (i + 1) % 3];
    CHECK(dpt_deform_set_vertices(stage.world, body, 0, count, turned, -1.0) == DPT_OK, "set");
    for (int i = 0; i < axes; i++) {
        const double no_radius = 0.0;
        double ends[6], ends_turned[6];
        dpt_hit query = { .size = sizeof query };
        any_axis(&builder, &random, ends);
        exchange_axes(ends, ends_turned);
        exchange_axes(ends + 3, ends_turned + 3);
        const dpt_hit hit = stage_tick(&stage, ends_turned);
        dpt_query_segments(builder.mesh, NULL, ends, &no_radius, 1, &query, NULL);
        CHECK(fabs(hit.gap - query.gap) <= 1e-5, "gap %.9g, not %.9g", hit.gap, query.gap);
        inside += query.gap < 0.0;
    }
    CHECK(inside > axes / 8, "%d inside", inside);
    free(stage.block);
    free(block);
    free(turned);
    builder_free(&builder);
}

int main(int argc, char **argv)
{
    if (argc > 1)
        axes = atoi(argv[1]);
    TEST(balls_hold_the_holes);
    TEST(worlds_say_what_queries_say);
    TEST(other_defects_are_left_to_winding_numbers);
    TEST(a_hole_costs_little);
    TEST(holes_that_move_are_not_taken_for_those_at_rest);
    return check_report();
}
