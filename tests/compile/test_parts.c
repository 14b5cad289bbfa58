/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Which parts have an inside, and which way they are wound: balls that nest, cut, touch, are torn or have holes; sheets;
 * thousands of parts.
 */
#include "contact/winding_scene.h"
#include "dynpoint/query.h"

/* At the middle a ball goes round once, less its hole's share of the area. */
static void balls_with_holes(void)
{
    static const double open[] = { 0.01, 0.03, 0.05, 0.1, 0.2, 0.3, 0.5, 0.7 };
    for (size_t i = 0; i < 2 * (sizeof open / sizeof *open); i++) {
        const double hole = open[i / 2];
        const int inward = i % 2;
        struct scene scene = { .vertices = NULL };
        add_ball(&scene, (vec3){ 0.0, 0.0, 0.0 }, 1.0, hole, inward);
        if (scene_open(&scene)) {
            const uint32_t flags = flags_of(&scene, 0), wanted = hole < 0.12 ? 24u : 0u;
            CHECK((flags & ~7u) == wanted, "hole of %g: flags %u", hole, flags);
            CHECK(scene.info.solid_components == (wanted != 0) && !scene.info.cavities &&
                      !scene.info.closed_components && !scene.info.inward_components,
                  "hole of %g: %u solid", hole, scene.info.solid_components);
            CHECK(scene.info.turned_triangles == (wanted && inward ? scene.info.triangles : 0),
                  "hole of %g: %u turned", hole, scene.info.turned_triangles);
            double middle = winding_at(&scene, 0.0, 0.0, 0.0);
            CHECK(fabs(middle - (wanted ? 1.0 - hole : 0.0)) < 0.01, "hole of %g: %g", hole,
                  middle);
            CHECK(fabs(winding_at(&scene, 0.0, 0.0, -1.5)) < 0.1, "outside");
        }
        scene_close(&scene);
    }
}

/* A hundredth of the triangles is gone, others are wound the wrong way: still solid, and wound one way. */
static void torn_balls_are_solid(void)
{
    uint64_t random = 43;
    for (int inward = 0; inward < 2; inward++) {
        struct scene scene = { .vertices = NULL };
        add_ball(&scene, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0.0, inward);
        size_t kept = 0;
        for (size_t t = 0; t < scene.triangle_count; t++) {
            if (random_bits(&random) % 100 == 0)
                continue;
            uint32_t *to = scene.corners + 3 * kept++;
            const uint32_t *from = scene.corners + 3 * t;
            const int swap = random_bits(&random) % 10 == 0;
            const uint32_t a = from[0], b = from[swap ? 2 : 1], c = from[swap ? 1 : 2];
            to[0] = a;
            to[1] = b;
            to[2] = c;
        }
        scene.triangle_count = kept;
        if (scene_open(&scene)) {
            CHECK(flags_of(&scene, 0) ==
                      (MESH_PART_MANIFOLD | MESH_PART_WOUND | MESH_PART_SOLID | MESH_PART_WINDING),
                  "flags %u", flags_of(&scene, 0));
            CHECK(winding_at(&scene, 0.0, 0.0, 0.0) > 0.9, "%g", winding_at(&scene, 0, 0, 0));
            CHECK(winding_at(&scene, 0.3, 0.2, 0.4) > 0.9, "%g", winding_at(&scene, 0.3, 0.2, 0.4));
            CHECK(fabs(winding_at(&scene, 0.0, 1.1, 0.0)) < 0.1, "outside");
            CHECK(inward == (scene.info.turned_triangles > scene.info.triangles / 2), "%u turned",
                  scene.info.turned_triangles);
        }
        scene_close(&scene);
    }
}

static void sheets_have_no_inside(void)
{
    static const char *const names[] = { "cloth", "membrane" };
    struct scene scene;
    for (int i = 0; i < 2; i++) {
        scene = (struct scene){ .vertices = NULL };
        add_shape(&scene, names[i], 512, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0, 0);
        if (scene_open(&scene))
            CHECK(scene.info.solid_components == 0 && !(flags_of(&scene, 0) & ~7u), "%s: %u solid",
                  names[i], scene.info.solid_components);
        scene_close(&scene);
    }
    /* Beside a part that has moments a sheet adds nothing. */
    scene = (struct scene){ .vertices = NULL };
    add_shape(&scene, "membrane", 512, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0, 0);
    const size_t count = scene.triangle_count;
    add_beacon(&scene);
    if (scene_open(&scene)) {
        double worst = 0.0;
        for (uint32_t t = 0; t < count; t++) {
            const uint32_t place = mesh_words(scene.mesh, MESH_PLACES)[t];
            const vec3 x = point_off(&scene, place, 1e-5);
            worst = max_of(worst, fabs(winding_at(&scene, x.x, x.y, x.z)));
        }
        CHECK(scene.info.winding_components == 1 && worst < 1e-3, "%u, %g",
              scene.info.winding_components, worst);
    }
    scene_close(&scene);
    /* Twelve loose triangles, and a flat square that is there twice, as a bag without a volume. */
    scene = (struct scene){ .vertices = NULL };
    scene_room(&scene, 41, 16);
    uint64_t random = 47;
    for (int v = 0; v < 36; v++)
        add_vertex(&scene, random_in(&random, -1, 1), random_in(&random, -1, 1),
                   random_in(&random, -1, 1));
    for (size_t t = 0; t < 12; t++)
        add_triangle(&scene, 3 * t, 3 * t + 1, 3 * t + 2, 0);
    for (int v = 0; v < 4; v++)
        add_vertex(&scene, 5.0 + (v & 1), 5.0 + v / 2, 5.0);
    add_vertex(&scene, 5.25, 5.5, 5.0);
    for (size_t k = 0; k < 4; k++) {
        static const size_t round[] = { 36, 37, 39, 38 };
        add_triangle(&scene, round[k], round[(k + 1) % 4], 40, 0);
    }
    if (scene_open(&scene))
        CHECK(scene.info.solid_components == 0, "%u solid", scene.info.solid_components);
    scene_close(&scene);
}

/* What has no part that needs it carries nothing for it. */
static void closed_meshes_carry_no_moments(void)
{
    struct scene scene = { .vertices = NULL };
    dpt_mesh_section section = { .size = sizeof section };
    struct work work = work_of(WORK_UNLIMITED);
    add_ball(&scene, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0.0, 0);
    add_ball(&scene, (vec3){ 0.0, 0.0, 3.0 }, 1.0, 0.0, 1);
    if (scene_open(&scene)) {
        CHECK(dpt_mesh_get_section(scene.mesh, 11, &section) == DPT_OK && section.bytes == 0 &&
                  !strcmp(section.name, "moments"),
              "%s of %u bytes", section.name, (unsigned)section.bytes);
        CHECK(scene.info.solid_components == 2 && scene.info.inward_components == 1, "%u solid",
              scene.info.solid_components);
        CHECK(dpti_winding_number(&scene.surface, &scene.kernel, (vec3){ 0.0, 0.0, 0.0 }, &work) ==
                      0.0 &&
                  work.done == 0,
              "work %u", work.done);
    }
    scene_close(&scene);
}

/* One ball in another, each wound either way: what is a void in the source stays one. */
static void nested_balls_keep_their_voids(void)
{
    for (int ways = 0; ways < 4; ways++) {
        const int outer = ways & 1, inner = ways >> 1, hollow = outer != inner;
        struct scene scene = { .vertices = NULL };
        add_ball(&scene, (vec3){ 0.1, 0.0, 0.0 }, 0.5, 0.0, inner);
        const uint32_t second = (uint32_t)scene.triangle_count;
        add_ball(&scene, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0.0, outer);
        add_beacon(&scene);
        if (scene_open(&scene)) {
            CHECK(fabs(winding_at(&scene, 0.1, 0.0, 0.0) - (hollow ? 0.0 : 2.0)) < 0.01,
                  "ways %d: %g", ways, winding_at(&scene, 0.1, 0.0, 0.0));
            CHECK(fabs(winding_at(&scene, 0.8, 0.0, 0.0) - 1.0) < 0.01, "ways %d, wall: %g", ways,
                  winding_at(&scene, 0.8, 0.0, 0.0));
            CHECK(fabs(winding_at(&scene, 1.2, 0.0, 0.0)) < 0.01, "ways %d, outside", ways);
            CHECK(scene.info.cavities == (uint32_t)hollow &&
                      scene.info.buried_components == (uint32_t)!hollow &&
                      scene.info.winding_components == 1 && scene.info.solid_components == 3,
                  "ways %d: %u cavities, %u buried", ways, scene.info.cavities,
                  scene.info.buried_components);
            CHECK(scene.info.inward_components == (uint32_t)(outer + (outer && inner)),
                  "ways %d: %u inward", ways, scene.info.inward_components);
            CHECK(flags_of(&scene, 0) == (hollow ? 15u : 47u) && flags_of(&scene, second) == 15u,
                  "ways %d: flags %u, %u", ways, flags_of(&scene, 0), flags_of(&scene, second));
        }
        scene_close(&scene);
    }
}

/* A stone within the void of a shell is outward whatever its source says; so is what lies beside. */
static void what_lies_in_a_void_is_in_the_open(void)
{
    for (int stone = 0; stone < 2; stone++) {
        struct scene scene = { .vertices = NULL };
        add_ball(&scene, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0.0, 0);
        add_ball(&scene, (vec3){ 0.0, 0.0, 0.0 }, 0.8, 0.0, 1);
        const uint32_t first = (uint32_t)scene.triangle_count;
        add_ball(&scene, (vec3){ 0.1, 0.0, 0.0 }, 0.4, 0.0, stone);
        add_ball(&scene, (vec3){ 0.1, 0.0, 0.0 }, 0.1, 0.0, stone);
        add_beacon(&scene);
        if (scene_open(&scene)) {
            CHECK(scene.info.cavities == 1 && scene.info.buried_components == 1 &&
                      scene.info.inward_components == 2u * (uint32_t)stone,
                  "stone %d: %u cavities, %u inward", stone, scene.info.cavities,
                  scene.info.inward_components);
            CHECK(flags_of(&scene, first) == 15u, "flags %u", flags_of(&scene, first));
            CHECK(fabs(winding_at(&scene, 0.4, 0.0, 0.0) - 1.0) < 0.01, "in the stone");
            CHECK(fabs(winding_at(&scene, 0.1, 0.0, 0.0) - 2.0) < 0.01, "in its core");
            CHECK(fabs(winding_at(&scene, 0.7, 0.0, 0.0)) < 0.01, "in the void");
            CHECK(fabs(winding_at(&scene, 0.9, 0.0, 0.0) - 1.0) < 0.01, "in the shell");
        }
        scene_close(&scene);
    }
}

/* Loose triangles and a sheet: in material, in a void, through a wall, beside; and in a ball with a hole. */
static void sheets_within_solids_are_buried(void)
{
    static const struct {
        vec3 at;
        double size;
        int buried;
    } sheets[] = { { { 0.0, 0.0, 0.85 }, 0.1, 1 }, { { 0.0, 0.0, 0.0 }, 0.1, 0 },
                   { { 0.0, 0.0, 1.0 }, 0.1, 0 },  { { 0.0, 0.0, 0.7 }, 0.1, 0 },
                   { { 0.8, 0.8, 0.8 }, 0.1, 0 },  { { 0.0, -0.85, 0.0 }, 0.02, 1 },
                   { { 5.0, 0.0, 0.0 }, 0.3, 1 },  { { 5.0, 0.0, 0.9 }, 0.3, 0 } };
    const size_t count = sizeof sheets / sizeof *sheets;
    struct scene scene = { .vertices = NULL };
    for (size_t i = 0; i < count; i++) {
        const vec3 at = sheets[i].at;
        const double size = sheets[i].size;
        const size_t first = scene.vertex_count;
        scene_room(&scene, 3, 1);
        add_vertex(&scene, at.x - size, at.y, at.z - 0.5 * size);
        add_vertex(&scene, at.x + size, at.y, at.z - 0.5 * size);
        add_vertex(&scene, at.x, at.y + 0.2 * size, at.z + 0.5 * size);
        add_triangle(&scene, first, first + 1, first + 2, 0);
    }
    add_ball(&scene, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0.0, 0);
    add_ball(&scene, (vec3){ 0.0, 0.0, 0.0 }, 0.7, 0.0, 1);
    add_ball(&scene, (vec3){ 5.0, 0.0, 0.0 }, 1.0, 0.02, 0);
    if (scene_open(&scene)) {
        for (size_t i = 0; i < count; i++)
            CHECK((flags_of(&scene, (uint32_t)i) & ~7u) ==
                      (sheets[i].buried ? (uint32_t)MESH_PART_BURIED : 0u),
                  "%zu: flags %u", i, flags_of(&scene, (uint32_t)i));
        CHECK(scene.info.solid_components == 3 && scene.info.buried_components == 0, "%u, %u",
              scene.info.solid_components, scene.info.buried_components);
        /* Both sides of the first one are inside. */
        for (int side = -1; side < 2; side += 2) {
            const double y = side * 0.02;
            const double ends[6] = { 0.0, y, 0.85, 0.01, y, 0.85 };
            dpt_hit hit = DPT_HIT_INIT;
            dpt_query_segments(scene.mesh, NULL, ends, NULL, 1, &hit, NULL);
            CHECK(hit.triangle == 0 && hit.contact == DPT_CONTACT_PENETRATING &&
                      fabs(hit.gap + hit.distance) < 1e-4,
                  "%d: triangle %u, contact %u, gap %g, distance %g", side, hit.triangle,
                  hit.contact, hit.gap, hit.distance);
        }
    }
    scene_close(&scene);
}

/* Balls that cut each other, and one that only looks so to its box. */
static void cut_parts_need_a_winding_number(void)
{
    struct scene scene = { .vertices = NULL };
    uint64_t random = 53;
    const vec3 b = { 1.2, 0.1, 0.0 }, c = { -1.5, -1.5, 0.0 };
    add_ball(&scene, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0.0, 1);
    const uint32_t second = (uint32_t)scene.triangle_count;
    add_ball(&scene, b, 0.7, 0.0, 0);
    const uint32_t third = (uint32_t)scene.triangle_count;
    add_ball(&scene, c, 1.0, 0.0, 0);
    if (scene_open(&scene)) {
        CHECK(flags_of(&scene, 0) == 31u && flags_of(&scene, second) == 31u &&
                  flags_of(&scene, third) == 15u,
              "flags %u, %u, %u", flags_of(&scene, 0), flags_of(&scene, second),
              flags_of(&scene, third));
        int inside = 0;
        for (int i = 0; i < 4000; i++) {
            vec3 x = point_in_box(&scene, &random);
            const double off[] = { length(x) - 1.0, length(sub(x, b)) - 0.7,
                                   length(sub(x, c)) - 1.0 };
            int in = 0, near = 0;
            for (int k = 0; k < 3; k++) {
                in += off[k] < 0.0;
                near |= fabs(off[k]) < 0.03; /* balls have faces */
            }
            double winding = winding_at(&scene, x.x, x.y, x.z);
            CHECK(near || fabs(winding - in) < 0.01, "%g, in %d balls", winding, in);
            inside += in > 0;
        }
        CHECK(inside > 1000, "%d inside", inside);
    }
    scene_close(&scene);
}

/* A ball comes out of a large face, off its edges; a box stands on that face; another hovers above it. */
static void contact_is_found_within_faces(void)
{
    static const double heights[] = { 0.0, 1.05, 0.05 };
    static const int cuts[] = { 1, 1, 0 };
    for (int i = 0; i < 3; i++) {
        struct scene scene = { .vertices = NULL };
        add_shape(&scene, "box", 12, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0, 0);
        scene_open(&scene);
        const double *low = scene.info.box_min, *high = scene.info.box_max;
        const double top = high[2], size = 0.1 * (high[0] - low[0]);
        const vec3 above = { 0.5 * (low[0] + high[0]) + size, 0.85 * low[1] + 0.15 * high[1],
                             top + (i == 2   ? 1.0 + heights[i]
                                    : i == 0 ? heights[i]
                                             : 0.0) *
                                       size };
        dpt_compiled_free(&scene.compiled);
        if (i == 1) { /* stands on it */
            scene_room(&scene, 8, 12);
            size_t base = scene.vertex_count;
            static const uint8_t faces[12][3] = { { 0, 2, 1 }, { 1, 2, 3 }, { 4, 5, 6 },
                                                  { 5, 7, 6 }, { 0, 1, 4 }, { 1, 5, 4 },
                                                  { 2, 6, 3 }, { 3, 6, 7 }, { 0, 4, 2 },
                                                  { 2, 4, 6 }, { 1, 3, 5 }, { 3, 7, 5 } };
            for (int k = 0; k < 8; k++)
                add_vertex(&scene, above.x + (k & 1 ? size : 0.0), above.y + (k & 2 ? size : 0.0),
                           top + (k & 4 ? size : 0.0));
            for (int t = 0; t < 12; t++)
                add_triangle(&scene, base + faces[t][0], base + faces[t][1], base + faces[t][2], 0);
        } else {
            add_ball(&scene, above, size, 0.0, 0);
        }
        if (scene_open(&scene))
            CHECK(scene.info.winding_components == 2u * (uint32_t)cuts[i] &&
                      scene.info.components == 2 && scene.info.buried_components == 0,
                  "%d: %u by winding of %u", i, scene.info.winding_components,
                  scene.info.components);
        scene_close(&scene);
    }
}

/*
 * A box in a box in a box, so many that their pairs are not all looked at: what is left is decided by winding numbers,
 * and told right all the same.
 */
static void endless_pairs_are_cut_short(void)
{
    enum { BOXES = 2000 };
    struct scene scene = { .vertices = NULL };
    for (int i = 0; i < BOXES; i++)
        add_shape(&scene, "box", 12, (vec3){ 0.0, 0.0, 0.0 }, 1.0 + 1e-3 * i, 0, 0);
    if (scene_open(&scene)) {
        CHECK(scene.info.solid_components == BOXES && scene.info.winding_components > BOXES / 10 &&
                  scene.info.winding_components < BOXES,
              "%u solid, %u by winding", scene.info.solid_components,
              scene.info.winding_components);
        const double depths[] = { 0.0599, 0.0900, 0.1799 };
        for (int i = 0; i < 3; i++) {
            const double inside[6] = { depths[i], 0.0, 0.0, depths[i], 1e-4, 0.0 };
            dpt_hit hit = DPT_HIT_INIT;
            dpt_query_segments(scene.mesh, NULL, inside, NULL, 1, &hit, NULL);
            CHECK(hit.gap < 0.0, "at %g: gap %g", depths[i], hit.gap);
        }
        const double outside[6] = { 0.19, 0.0, 0.0, 0.2, 0.0, 0.0 };
        dpt_hit hit = DPT_HIT_INIT;
        dpt_query_segments(scene.mesh, NULL, outside, NULL, 1, &hit, NULL);
        CHECK(hit.gap > 0.0, "outside: gap %g", hit.gap);
    }
    scene_close(&scene);
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
