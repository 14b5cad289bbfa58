/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Which parts have an inside, and which way they are wound: balls that nest, cut, touch, are torn or have holes;
 * sheets; thousands of parts.
 */
#include "dynpoint/query.h"
#include "lib/mesh_builder.h"

/* At the middle a ball goes round once, less its hole's share of the area. */
static void balls_with_holes(void)
{
    static const double open[] = { 0.01, 0.03, 0.05, 0.1, 0.2, 0.3, 0.5, 0.7 };
    for (size_t i = 0; i < 2 * (sizeof open / sizeof *open); i++) {
        const double hole = open[i / 2];
        const int inward = i % 2;
        struct mesh_builder builder = { .vertices = NULL };
        builder_add_ball(&builder, (vec3){ 0.0, 0.0, 0.0 }, 1.0, hole, inward);
        if (builder_compile(&builder)) {
            const uint32_t flags = part_flags_of(&builder, 0), wanted = hole < 0.12 ? 24u : 0u;
            CHECK((flags & ~7u) == wanted, "hole of %g: flags %u", hole, flags);
            CHECK(builder.info.solid_components == (wanted != 0) && !builder.info.cavities &&
                      !builder.info.closed_components && !builder.info.inward_components,
                  "hole of %g: %u solid", hole, builder.info.solid_components);
            CHECK(builder.info.turned_triangles == (wanted && inward ? builder.info.triangles : 0),
                  "hole of %g: %u turned", hole, builder.info.turned_triangles);
            double middle = winding_at(&builder, 0.0, 0.0, 0.0);
            CHECK(fabs(middle - (wanted ? 1.0 - hole : 0.0)) < 0.01, "hole of %g: %g", hole, middle);
            CHECK(fabs(winding_at(&builder, 0.0, 0.0, -1.5)) < 0.1, "outside");
        }
        builder_free(&builder);
    }
}

/* A hundredth of the triangles is gone, others are wound the wrong way: still solid, and wound one way. */
static void torn_balls_are_solid(void)
{
    uint64_t random = 43;
    for (int inward = 0; inward < 2; inward++) {
        struct mesh_builder builder = { .vertices = NULL };
        builder_add_ball(&builder, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0.0, inward);
        size_t kept = 0;
        for (size_t t = 0; t < builder.triangle_count; t++) {
            if (random_bits(&random) % 100 == 0)
                continue;
            uint32_t *to = builder.corners + 3 * kept++;
            const uint32_t *from = builder.corners + 3 * t;
            const int swap = random_bits(&random) % 10 == 0;
            const uint32_t a = from[0], b = from[swap ? 2 : 1], c = from[swap ? 1 : 2];
            to[0] = a;
            to[1] = b;
            to[2] = c;
        }
        builder.triangle_count = kept;
        if (builder_compile(&builder)) {
            CHECK(part_flags_of(&builder, 0) ==
                      (MESH_PART_MANIFOLD | MESH_PART_WOUND | MESH_PART_SOLID | MESH_PART_WINDING),
                  "flags %u", part_flags_of(&builder, 0));
            CHECK(winding_at(&builder, 0.0, 0.0, 0.0) > 0.9, "%g", winding_at(&builder, 0, 0, 0));
            CHECK(winding_at(&builder, 0.3, 0.2, 0.4) > 0.9, "%g", winding_at(&builder, 0.3, 0.2, 0.4));
            CHECK(fabs(winding_at(&builder, 0.0, 1.1, 0.0)) < 0.1, "outside");
            CHECK(inward == (builder.info.turned_triangles > builder.info.triangles / 2), "%u turned",
                  builder.info.turned_triangles);
        }
        builder_free(&builder);
    }
}

static void sheets_have_no_inside(void)
{
    static const char *const names[] = { "cloth", "membrane" };
    struct mesh_builder builder;
    for (int i = 0; i < 2; i++) {
        builder = (struct mesh_builder){ .vertices = NULL };
        builder_add_shape(&builder, names[i], 512, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0, 0);
        if (builder_compile(&builder))
            CHECK(builder.info.solid_components == 0 && !(part_flags_of(&builder, 0) & ~7u), "%s: %u solid", names[i],
                  builder.info.solid_components);
        builder_free(&builder);
    }
    /* Beside a part that has moments a sheet adds nothing. */
    builder = (struct mesh_builder){ .vertices = NULL };
    builder_add_shape(&builder, "membrane", 512, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0, 0);
    const size_t count = builder.triangle_count;
    builder_add_beacon(&builder);
    if (builder_compile(&builder)) {
        double worst = 0.0;
        for (uint32_t t = 0; t < count; t++) {
            const uint32_t place = mesh_words(builder.mesh, MESH_PLACES)[t];
            const vec3 x = point_off(&builder, place, 1e-5);
            worst = max_of(worst, fabs(winding_at(&builder, x.x, x.y, x.z)));
        }
        CHECK(builder.info.winding_components == 1 && worst < 1e-3, "%u, %g", builder.info.winding_components, worst);
    }
    builder_free(&builder);
    /* Twelve loose triangles, and a flat square that is there twice, as a bag without a volume. */
    builder = (struct mesh_builder){ .vertices = NULL };
    builder_reserve(&builder, 41, 16);
    uint64_t random = 47;
    for (int v = 0; v < 36; v++)
        builder_add_vertex(&builder, random_in(&random, -1, 1), random_in(&random, -1, 1), random_in(&random, -1, 1));
    for (size_t t = 0; t < 12; t++)
        builder_add_triangle(&builder, 3 * t, 3 * t + 1, 3 * t + 2, 0);
    for (int v = 0; v < 4; v++)
        builder_add_vertex(&builder, 5.0 + (v & 1), 5.0 + v / 2, 5.0);
    builder_add_vertex(&builder, 5.25, 5.5, 5.0);
    for (size_t k = 0; k < 4; k++) {
        static const size_t round[] = { 36, 37, 39, 38 };
        builder_add_triangle(&builder, round[k], round[(k + 1) % 4], 40, 0);
    }
    if (builder_compile(&builder))
        CHECK(builder.info.solid_components == 0, "%u solid", builder.info.solid_components);
    builder_free(&builder);
}

/* What has no part that needs it carries nothing for it. */
static void closed_meshes_carry_no_moments(void)
{
    struct mesh_builder builder = { .vertices = NULL };
    dpt_mesh_section section = { .size = sizeof section };
    struct work work = work_of(WORK_UNLIMITED);
    builder_add_ball(&builder, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0.0, 0);
    builder_add_ball(&builder, (vec3){ 0.0, 0.0, 3.0 }, 1.0, 0.0, 1);
    if (builder_compile(&builder)) {
        CHECK(dpt_mesh_get_section(builder.mesh, 11, &section) == DPT_OK && section.bytes == 0 &&
                  !strcmp(section.name, "moments"),
              "%s of %u bytes", section.name, (unsigned)section.bytes);
        CHECK(builder.info.solid_components == 2 && builder.info.inward_components == 1, "%u solid",
              builder.info.solid_components);
        CHECK(dpti_winding_number(&builder.surface, &builder.kernel, (vec3){ 0.0, 0.0, 0.0 }, &work) == 0.0 &&
                  work.done == 0,
              "work %u", work.done);
    }
    builder_free(&builder);
}

/* One ball in another, each wound either way: what is a void in the source stays one. */
static void nested_balls_keep_their_voids(void)
{
    for (int ways = 0; ways < 4; ways++) {
        const int outer = ways & 1, inner = ways >> 1, hollow = outer != inner;
        struct mesh_builder builder = { .vertices = NULL };
        builder_add_ball(&builder, (vec3){ 0.1, 0.0, 0.0 }, 0.5, 0.0, inner);
        const uint32_t second = (uint32_t)builder.triangle_count;
        builder_add_ball(&builder, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0.0, outer);
        builder_add_beacon(&builder);
        if (builder_compile(&builder)) {
            CHECK(fabs(winding_at(&builder, 0.1, 0.0, 0.0) - (hollow ? 0.0 : 2.0)) < 0.01, "ways %d: %g", ways,
                  winding_at(&builder, 0.1, 0.0, 0.0));
            CHECK(fabs(winding_at(&builder, 0.8, 0.0, 0.0) - 1.0) < 0.01, "ways %d, wall: %g", ways,
                  winding_at(&builder, 0.8, 0.0, 0.0));
            CHECK(fabs(winding_at(&builder, 1.2, 0.0, 0.0)) < 0.01, "ways %d, outside", ways);
            CHECK(builder.info.cavities == (uint32_t)hollow && builder.info.buried_components == (uint32_t)!hollow &&
                      builder.info.winding_components == 1 && builder.info.solid_components == 3,
                  "ways %d: %u cavities, %u buried", ways, builder.info.cavities, builder.info.buried_components);
            CHECK(builder.info.inward_components == (uint32_t)(outer + (outer && inner)), "ways %d: %u inward", ways,
                  builder.info.inward_components);
            CHECK(part_flags_of(&builder, 0) == (hollow ? 15u : 47u) && part_flags_of(&builder, second) == 15u,
                  "ways %d: flags %u, %u", ways, part_flags_of(&builder, 0), part_flags_of(&builder, second));
        }
        builder_free(&builder);
    }
}

/* A stone within the void of a shell is outward whatever its source says; so is what lies beside. */
static void what_lies_in_a_void_is_in_the_open(void)
{
    for (int stone = 0; stone < 2; stone++) {
        struct mesh_builder builder = { .vertices = NULL };
        builder_add_ball(&builder, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0.0, 0);
        builder_add_ball(&builder, (vec3){ 0.0, 0.0, 0.0 }, 0.8, 0.0, 1);
        const uint32_t first = (uint32_t)builder.triangle_count;
        builder_add_ball(&builder, (vec3){ 0.1, 0.0, 0.0 }, 0.4, 0.0, stone);
        builder_add_ball(&builder, (vec3){ 0.1, 0.0, 0.0 }, 0.1, 0.0, stone);
        builder_add_beacon(&builder);
        if (builder_compile(&builder)) {
            CHECK(builder.info.cavities == 1 && builder.info.buried_components == 1 &&
                      builder.info.inward_components == 2u * (uint32_t)stone,
                  "stone %d: %u cavities, %u inward", stone, builder.info.cavities, builder.info.inward_components);
            CHECK(part_flags_of(&builder, first) == 15u, "flags %u", part_flags_of(&builder, first));
            CHECK(fabs(winding_at(&builder, 0.4, 0.0, 0.0) - 1.0) < 0.01, "in the stone");
            CHECK(fabs(winding_at(&builder, 0.1, 0.0, 0.0) - 2.0) < 0.01, "in its core");
            CHECK(fabs(winding_at(&builder, 0.7, 0.0, 0.0)) < 0.01, "in the void");
            CHECK(fabs(winding_at(&builder, 0.9, 0.0, 0.0) - 1.0) < 0.01, "in the shell");
        }
        builder_free(&builder);
    }
}

/* Loose triangles and a sheet: in material, in a void, through a wall, beside; and in a ball with a hole. */
static void sheets_within_solids_are_buried(void)
{
    static const struct {
        vec3 at;
        double size;
        int buried;
    } sheets[] = { { { 0.0, 0.0, 0.85 }, 0.1, 1 }, { { 0.0, 0.0, 0.0 }, 0.1, 0 }, { { 0.0, 0.0, 1.0 }, 0.1, 0 },
                   { { 0.0, 0.0, 0.7 }, 0.1, 0 },  { { 0.8, 0.8, 0.8 }, 0.1, 0 }, { { 0.0, -0.85, 0.0 }, 0.02, 1 },
                   { { 5.0, 0.0, 0.0 }, 0.3, 1 },  { { 5.0, 0.0, 0.9 }, 0.3, 0 } };
    const size_t count = sizeof sheets / sizeof *sheets;
    struct mesh_builder builder = { .vertices = NULL };
    for (size_t i = 0; i < count; i++) {
        const vec3 at = sheets[i].at;
        const double size = sheets[i].size;
        const size_t first = builder.vertex_count;
        builder_reserve(&builder, 3, 1);
        builder_add_vertex(&builder, at.x - size, at.y, at.z - 0.5 * size);
        builder_add_vertex(&builder, at.x + size, at.y, at.z - 0.5 * size);
        builder_add_vertex(&builder, at.x, at.y + 0.2 * size, at.z + 0.5 * size);
        builder_add_triangle(&builder, first, first + 1, first + 2, 0);
    }
    builder_add_ball(&builder, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0.0, 0);
    builder_add_ball(&builder, (vec3){ 0.0, 0.0, 0.0 }, 0.7, 0.0, 1);
    builder_add_ball(&builder, (vec3){ 5.0, 0.0, 0.0 }, 1.0, 0.02, 0);
    if (builder_compile(&builder)) {
        for (size_t i = 0; i < count; i++)
            CHECK((part_flags_of(&builder, (uint32_t)i) & ~7u) == (sheets[i].buried ? (uint32_t)MESH_PART_BURIED : 0u),
                  "%zu: flags %u", i, part_flags_of(&builder, (uint32_t)i));
        CHECK(builder.info.solid_components == 3 && builder.info.buried_components == 0, "%u, %u",
              builder.info.solid_components, builder.info.buried_components);
        /* Both sides of the first one are inside. */
        for (int side = -1; side < 2; side += 2) {
            const double y = side * 0.02;
            const double ends[6] = { 0.0, y, 0.85, 0.01, y, 0.85 };
            dpt_hit hit = DPT_HIT_INIT;
            dpt_query_segments(builder.mesh, NULL, ends, NULL, 1, &hit, NULL);
            CHECK(hit.triangle == 0 && hit.contact == DPT_CONTACT_PENETRATING && fabs(hit.gap + hit.distance) < 1e-4,
                  "%d: triangle %u, contact %u, gap %g, distance %g", side, hit.triangle, hit.contact, hit.gap,
                  hit.distance);
        }
    }
    builder_free(&builder);
}

/* Balls that cut each other, and one that only looks so to its box. */
static void cut_parts_need_a_winding_number(void)
{
    struct mesh_builder builder = { .vertices = NULL };
    uint64_t random = 53;
    const vec3 b = { 1.2, 0.1, 0.0 }, c = { -1.5, -1.5, 0.0 };
    builder_add_ball(&builder, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0.0, 1);
    const uint32_t second = (uint32_t)builder.triangle_count;
    builder_add_ball(&builder, b, 0.7, 0.0, 0);
    const uint32_t third = (uint32_t)builder.triangle_count;
    builder_add_ball(&builder, c, 1.0, 0.0, 0);
    if (builder_compile(&builder)) {
        CHECK(part_flags_of(&builder, 0) == 31u && part_flags_of(&builder, second) == 31u &&
                  part_flags_of(&builder, third) == 15u,
              "flags %u, %u, %u", part_flags_of(&builder, 0), part_flags_of(&builder, second),
              part_flags_of(&builder, third));
        int inside = 0;
        for (int i = 0; i < 4000; i++) {
            vec3 x = point_in_box(&builder, &random);
            const double off[] = { length(x) - 1.0, length(sub(x, b)) - 0.7, length(sub(x, c)) - 1.0 };
            int in = 0, near = 0;
            for (int k = 0; k < 3; k++) {
                in += off[k] < 0.0;
                near |= fabs(off[k]) < 0.03; /* balls have faces */
            }
            double winding = winding_at(&builder, x.x, x.y, x.z);
            CHECK(near || fabs(winding - in) < 0.01, "%g, in %d balls", winding, in);
            inside += in > 0;
        }
        CHECK(inside > 1000, "%d inside", inside);
    }
    builder_free(&builder);
}

/* A ball comes out of a large face, off its edges; a box stands on that face; another hovers above it. */
static void contact_is_found_within_faces(void)
{
    static const double heights[] = { 0.0, 1.05, 0.05 };
    static const int cuts[] = { 1, 1, 0 };
    for (int i = 0; i < 3; i++) {
        struct mesh_builder builder = { .vertices = NULL };
        builder_add_shape(&builder, "box", 12, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0, 0);
        builder_compile(&builder);
        const double *low = builder.info.box_min, *high = builder.info.box_max;
        const double top = high[2], size = 0.1 * (high[0] - low[0]);
        const vec3 above = { 0.5 * (low[0] + high[0]) + size, 0.85 * low[1] + 0.15 * high[1],
                             top + (i == 2   ? 1.0 + heights[i]
                                    : i == 0 ? heights[i]
                                             : 0.0) *
                                       size };
        dpt_compiled_free(&builder.compiled);
        if (i == 1) { /* stands on it */
            builder_reserve(&builder, 8, 12);
            size_t base = builder.vertex_count;
            static const uint8_t faces[12][3] = { { 0, 2, 1 }, { 1, 2, 3 }, { 4, 5, 6 }, { 5, 7, 6 },
                                                  { 0, 1, 4 }, { 1, 5, 4 }, { 2, 6, 3 }, { 3, 6, 7 },
                                                  { 0, 4, 2 }, { 2, 4, 6 }, { 1, 3, 5 }, { 3, 7, 5 } };
            for (int k = 0; k < 8; k++)
                builder_add_vertex(&builder, above.x + (k & 1 ? size : 0.0), above.y + (k & 2 ? size : 0.0),
                                   top + (k & 4 ? size : 0.0));
            for (int t = 0; t < 12; t++)
                builder_add_triangle(&builder, base + faces[t][0], base + faces[t][1], base + faces[t][2], 0);
        } else {
            builder_add_ball(&builder, above, size, 0.0, 0);
        }
        if (builder_compile(&builder))
            CHECK(builder.info.winding_components == 2u * (uint32_t)cuts[i] && builder.info.components == 2 &&
                      builder.info.buried_components == 0,
                  "%d: %u by winding of %u", i, builder.info.winding_components, builder.info.components);
        builder_free(&builder);
    }
}

/*
 * A box in a box in a box, so many that their pairs are not all looked at: what is left is decided by winding numbers,
 * and told right all the same.
 */
static void endless_pairs_are_cut_short(void)
{
    enum { BOXES = 2000 };
    struct mesh_builder builder = { .vertices = NULL };
    for (int i = 0; i < BOXES; i++)
        builder_add_shape(&builder, "box", 12, (vec3){ 0.0, 0.0, 0.0 }, 1.0 + 1e-3 * i, 0, 0);
    if (builder_compile(&builder)) {
        CHECK(builder.info.solid_components == BOXES && builder.info.winding_components > BOXES / 10 &&
                  builder.info.winding_components < BOXES,
              "%u solid, %u by winding", builder.info.solid_components, builder.info.winding_components);
        const double depths[] = { 0.0599, 0.0900, 0.1799 };
        for (int i = 0; i < 3; i++) {
            const double inside[6] = { depths[i], 0.0, 0.0, depths[i], 1e-4, 0.0 };
            dpt_hit hit = DPT_HIT_INIT;
            dpt_query_segments(builder.mesh, NULL, inside, NULL, 1, &hit, NULL);
            CHECK(hit.gap < 0.0, "at %g: gap %g", depths[i], hit.gap);
        }
        const double outside[6] = { 0.19, 0.0, 0.0, 0.2, 0.0, 0.0 };
        dpt_hit hit = DPT_HIT_INIT;
        dpt_query_segments(builder.mesh, NULL, outside, NULL, 1, &hit, NULL);
        CHECK(hit.gap > 0.0, "outside: gap %g", hit.gap);
    }
    builder_free(&builder);
}

int main(void)
{
    TEST(balls_with_holes);
    TEST(torn_balls_are_solid);
    TEST(sheets_have_no_inside);
    TEST(closed_meshes_carry_no_moments);
    TEST(nested_balls_keep_their_voids);
    TEST(what_lies_in_a_void_is_in_the_open);
    TEST(sheets_within_solids_are_buried);
    TEST(cut_parts_need_a_winding_number);
    TEST(contact_is_found_within_faces);
    TEST(endless_pairs_are_cut_short);
    return check_report();
}
