/* SPDX-License-Identifier: BSD-3-Clause */
#include "contact/defective_meshes.h"

/* Leave out what lies within `radius` of a vertex. */
static void cut_hole(struct mesh_builder *builder, uint32_t vertex, double radius)
{
    const vec3 centre = vec3_of(builder->vertices + 3 * (size_t)vertex);
    size_t kept = 0;
    for (size_t t = 0; t < builder->triangle_count; t++) {
        const uint32_t *corner = builder->corners + 3 * t;
        double farthest = 0.0;
        for (int k = 0; k < 3; k++)
            farthest = max_of(farthest, length(sub(vec3_of(builder->vertices + 3 * (size_t)corner[k]), centre)));
        if (farthest > radius)
            memmove(builder->corners + 3 * kept++, corner, 3 * sizeof *corner);
    }
    builder->triangle_count = kept;
}

int holed_shape(struct mesh_builder *builder, const char *name, uint64_t count, int holes, double radius)
{
    uint64_t random = 7;
    *builder = (struct mesh_builder){ .mesh = NULL };
    builder_add_shape(builder, name, count, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0, 0);
    for (int i = 0; i < holes; i++)
        cut_hole(builder, (uint32_t)(random_bits(&random) % builder->vertex_count), radius);
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

/* Balls with so many triangles missing at each one's end, some of which overlap: as many parts with defects. */
static int many_balls(struct mesh_builder *builder, int count, size_t missing)
{
    uint64_t random = 11;
    *builder = (struct mesh_builder){ .mesh = NULL };
    for (int i = 0; i < count; i++) {
        const double w = 0.06 * cbrt(count);
        const vec3 at = { random_in(&random, -w, w), random_in(&random, -w, w), random_in(&random, -w, w) };
        builder_add_shape(builder, "sphere", 1280, at, random_in(&random, 0.6, 1.2), 0, missing);
    }
    return builder_compile(builder);
}

int sieve(struct mesh_builder *builder)
{
    *builder = (struct mesh_builder){ .mesh = NULL };
    builder_add_shape(builder, "sphere", 20000, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0, 0);
    for (size_t t = builder->triangle_count; t > 120; t -= 120)
        memmove(builder->corners + 3 * (t - 1), builder->corners + 3 * --builder->triangle_count,
                3 * sizeof *builder->corners);
    return builder_compile(builder);
}

int onion(struct mesh_builder *builder)
{
    *builder = (struct mesh_builder){ .mesh = NULL };
    for (int i = 0; i < 4; i++) {
        const double radius = 0.1 - 0.001 * i, open = 0.01;
        builder_add_ball(builder, (vec3){ 0.0, 0.0, -radius * (1.0 - 2.0 * open) }, radius, open, 0);
    }
    return builder_compile(builder);
}

/* Two balls that share some triangles, which are there twice, wound against each other: their edges have four. */
static int twins(struct mesh_builder *builder)
{
    *builder = (struct mesh_builder){ .mesh = NULL };
    builder_add_shape(builder, "box", 1200, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0, 0);
    for (size_t i = 0; i < 5; i++) {
        const uint32_t *corner = builder->corners + 3 * (100 * i + 7);
        const uint32_t a = corner[0], b = corner[1], c = corner[2];
        builder_reserve(builder, 1, 6);
        const double *v = builder->vertices;
        builder_add_vertex(builder, 1.3 * v[3 * a], 1.3 * v[3 * a + 1], 1.3 * v[3 * a + 2]);
        const size_t top = builder->vertex_count - 1;
        builder_add_triangle(builder, a, b, top, 0);
        builder_add_triangle(builder, b, c, top, 0);
        builder_add_triangle(builder, c, a, top, 0);
        builder_add_triangle(builder, a, c, b, 0);
    }
    return builder_compile(builder);
}

int cubes_with_an_edge_in_common(struct mesh_builder *builder)
{
    static const int faces[6][4] = { { 0, 2, 3, 1 }, { 4, 5, 7, 6 }, { 0, 1, 5, 4 },
                                     { 2, 6, 7, 3 }, { 0, 4, 6, 2 }, { 1, 3, 7, 5 } };
    *builder = (struct mesh_builder){ .mesh = NULL };
    builder_reserve(builder, 14, 24);
    for (int z = 0; z < 2; z++)
        for (int y = -1; y < 2; y++)
            for (int x = -1; x < 2; x++)
                if (x * y >= 0)
                    builder_add_vertex(builder, 0.1 * x, 0.1 * y, 0.1 * z);
    for (int cube = 0; cube < 2; cube++)
        for (int f = 0; f < 6; f++) {
            size_t corner[4];
            for (int k = 0; k < 4; k++)
                corner[k] = (size_t)(7 * (faces[f][k] >> 2) + 3 * cube + (faces[f][k] & 3));
            builder_add_triangle(builder, corner[0], corner[1], corner[2], 0);
            builder_add_triangle(builder, corner[0], corner[2], corner[3], 0);
        }
    return builder_compile(builder);
}

/*
 * A ball with a handle that is joined the wrong way round, as a Klein bottle's: it closes, but it cannot be wound one
 * way, so it has edges that two triangles run through in the same direction.
 */
static int klein_handle(struct mesh_builder *builder)
{
    uint32_t ends[2][3];
    *builder = (struct mesh_builder){ .mesh = NULL };
    builder_add_shape(builder, "sphere", 1280, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0, 0);
    memcpy(ends[0], builder->corners, sizeof ends[0]);
    for (size_t last = --builder->triangle_count; last > 1; last--) {
        const uint32_t *corner = builder->corners + 3 * last;
        const vec3 far = vec3_of(builder->vertices + 3 * (size_t)corner[0]);
        const double distance = length(sub(far, vec3_of(builder->vertices + 3 * (size_t)ends[0][0])));
        if (distance > 0.03 && distance < 0.05) {
            memcpy(ends[1], corner, sizeof ends[1]);
            memmove(builder->corners + 3 * last, builder->corners + 3 * builder->triangle_count, sizeof ends[1]);
            break;
        }
    }
    builder->triangle_count--;
    memmove(builder->corners, builder->corners + 3 * builder->triangle_count, sizeof ends[0]);
    builder_reserve(builder, 0, 6);
    for (int k = 0; k < 3; k++) {
        const uint32_t *a = ends[0], *b = ends[1];
        const int next = (k + 1) % 3;
        builder_add_triangle(builder, a[k], a[next], b[next], 0);
        builder_add_triangle(builder, a[k], b[next], b[k], 0);
    }
    return builder_compile(builder);
}

/* A ball that cuts itself: one vertex is drawn to the other side. */
static int cut_ball(struct mesh_builder *builder, size_t missing)
{
    *builder = (struct mesh_builder){ .mesh = NULL };
    builder_add_shape(builder, "sphere", 320, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0, missing);
    for (int k = 0; k < 3; k++)
        builder->vertices[3 * 100 + k] *= -1.05;
    return builder_compile(builder);
}

int balls_and_a_sheet(struct mesh_builder *builder, int has_sheet)
{
    *builder = (struct mesh_builder){ .mesh = NULL };
    builder_add_shape(builder, "sphere", 1280, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0, 6);
    builder_add_shape(builder, "sphere", 1280, (vec3){ 0.1, 0.0, 0.0 }, 0.9, 0, 0);
    builder_add_shape(builder, "sphere", 320, (vec3){ -0.04, 0.01, 0.0 }, 0.3, 0, 0);
    if (has_sheet)
        builder_add_shape(builder, "membrane", 512, (vec3){ 0.04, 0.03, 0.02 }, 2.5, 0, 0);
    return builder_compile(builder);
}

int defective(struct mesh_builder *builder, int kind, const char **name)
{
    static const char *const names[DEFECTS] = { "finger", "overlap", "and a sheet",  "cuts itself", "cut and torn",
                                                "twins",  "cubes",   "Klein handle", "9 balls",     "112 balls" };
    *name = names[kind];
    switch (kind) {
    case 0:
        return finger(builder);
    case 1:
    case 2:
        return balls_and_a_sheet(builder, kind == 2);
    case 3:
    case 4:
        return cut_ball(builder, kind == 4 ? 2 : 0);
    case 5:
        return twins(builder);
    case 6:
        return cubes_with_an_edge_in_common(builder);
    case 7:
        return klein_handle(builder);
    default:
        return many_balls(builder, kind == 8 ? 9 : 112, 1);
    }
}

void any_axis(const struct mesh_builder *builder, uint64_t *random, double ends[6])
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

int defective_file(struct mesh_builder *builder, const char *data, int i, const char **name)
{
    static const char *const files[DEFECTIVE_FILES] = { "organs/liver_dirty_low.stl",
                                                        "organs/liver_dirty_fine.stl",
                                                        "organs/openhelp_scene_low.stl",
                                                        "organs/skull_and_teeth_sofa.obj",
                                                        "hard/spider.stl",
                                                        "hard/offset1_nonmanifold.obj",
                                                        "hard/3dsmax_nonmanifold.stl",
                                                        "hard/chair_double_sided.obj",
                                                        "tools/pliers_sofa.stl",
                                                        "tools/laparoscope_30deg.stl" };
    char path[1024];
    *name = files[i];
    snprintf(path, sizeof path, "%s/meshes/%s", data, files[i]);
    return builder_compile_file(builder, path);
}
