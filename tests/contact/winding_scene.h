/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Meshes put together from balls, shapes and loose triangles, their winding numbers and the flags of their parts, and by the
 * arctangent of the C library what the numbers should be.
 */
#ifndef DPT_TESTS_WINDING_SCENE_H
#define DPT_TESTS_WINDING_SCENE_H

#include "contact/winding_number.h"

#include "dynpoint/compile.h"
#include "dynpoint/kernel.h"
#include "lib/check.h"
#include "shape.h"

#define PI 3.14159265358979323846

/* A mesh that is put together from shapes. */
struct scene {
    double *vertices;
    uint32_t *corners;
    size_t vertex_count, triangle_count;
    dpt_compiled compiled;
    const dpt_mesh *mesh;
    dpt_mesh_info info;
    struct surface surface;
    struct kernel kernel;
};

static inline void scene_room(struct scene *scene, size_t vertices, size_t triangles)
{
    scene->vertices =
        realloc(scene->vertices, (scene->vertex_count + vertices) * 3 * sizeof *scene->vertices);
    scene->corners =
        realloc(scene->corners, (scene->triangle_count + triangles) * 3 * sizeof *scene->corners);
}

static inline void add_vertex(struct scene *scene, double x, double y, double z)
{
    double *v = scene->vertices + 3 * scene->vertex_count++;
    v[0] = x;
    v[1] = y;
    v[2] = z;
}

static inline void add_triangle(struct scene *scene, size_t a, size_t b, size_t c, int inward)
{
    uint32_t *corner = scene->corners + 3 * scene->triangle_count++;
    corner[0] = (uint32_t)a;
    corner[1] = (uint32_t)(inward ? c : b);
    corner[2] = (uint32_t)(inward ? b : c);
}

/* A shape of `dynpoint make` at a place, its last triangles missing. */
static inline void add_shape(struct scene *scene, const char *name, uint64_t count, vec3 at,
                             double size, int inward, size_t missing)
{
    struct shape shape;
    shape_reason reason;
    if (shape_make(name, count, 0, &shape, reason)) {
        CHECK(0, "%s", reason);
        return;
    }
    scene_room(scene, shape.vertex_count, shape.triangle_count);
    size_t base = scene->vertex_count;
    for (size_t v = 0; v < shape.vertex_count; v++)
        add_vertex(scene, at.x + size * shape.vertices[3 * v],
                   at.y + size * shape.vertices[3 * v + 1],
                   at.z + size * shape.vertices[3 * v + 2]);
    for (size_t t = 0; t + missing < shape.triangle_count; t++)
        add_triangle(scene, base + shape.corners[3 * t], base + shape.corners[3 * t + 1],
                     base + shape.corners[3 * t + 2], inward);
    shape_free(&shape);
}

/* A ball of rings, without what lies above `open` of its area, 0 for a closed one. */
static inline void add_ball(struct scene *scene, vec3 at, double radius, double open, int inward)
{
    enum { ROUND = 32, RINGS = 24 };
    const double first = acos(1.0 - 2.0 * open);
    scene_room(scene, ROUND * RINGS + 2, 2 * ROUND * RINGS);
    size_t base = scene->vertex_count;
    for (int ring = 0; ring < RINGS; ring++)
        for (int k = 0; k < ROUND; k++) {
            double down =
                open > 0.0 ? first + (PI - first) * ring / RINGS : PI * (ring + 1) / (RINGS + 1);
            double turn = 2.0 * PI * k / ROUND;
            add_vertex(scene, at.x + radius * sin(down) * cos(turn),
                       at.y + radius * sin(down) * sin(turn), at.z + radius * cos(down));
        }
    add_vertex(scene, at.x, at.y, at.z - radius);
    add_vertex(scene, at.x, at.y, at.z + radius);
    for (size_t ring = 0; ring < RINGS; ring++)
        for (size_t k = 0; k < ROUND; k++) {
            size_t a = base + ROUND * ring + k, b = base + ROUND * ring + (k + 1) % ROUND;
            if (ring + 1 < RINGS) {
                add_triangle(scene, a, a + ROUND, b, inward);
                add_triangle(scene, b, a + ROUND, b + ROUND, inward);
            } else {
                add_triangle(scene, a, base + ROUND * RINGS, b, inward);
            }
            if (ring == 0 && !(open > 0.0))
                add_triangle(scene, a, b, base + ROUND * RINGS + 1, inward);
        }
}

/* Far away, small and with a hole: makes the compiler write moments, and adds nothing near the origin. */
static inline void add_beacon(struct scene *scene)
{
    add_shape(scene, "sphere", 40, (vec3){ 100.0, 0.0, 0.0 }, 0.1, 0, 1);
}

static inline int scene_open(struct scene *scene)
{
    uint32_t chosen;
    dpt_diag diag = { .size = sizeof diag };
    scene->info.size = sizeof scene->info;
    dpt_result result = dpt_compile_arrays(scene->vertices, scene->vertex_count, scene->corners,
                                           scene->triangle_count, NULL, &scene->compiled, &diag);
    if (result == DPT_OK)
        result = dpt_mesh_convert(scene->compiled.bytes, scene->compiled.size, NULL);
    if (result == DPT_OK)
        result = dpt_mesh_open(scene->compiled.bytes, scene->compiled.size, &scene->mesh);
    CHECK(result == DPT_OK, "%s %s", dpt_result_name(result), diag.text);
    if (result != DPT_OK)
        return 0;
    dpt_mesh_get_info(scene->mesh, &scene->info);
    dpti_surface_of_mesh(scene->mesh, &scene->surface);
    dpti_kernel_get(DPT_KERNEL_AUTO, &scene->kernel, &chosen);
    return 1;
}

static inline void scene_close(struct scene *scene)
{
    dpt_compiled_free(&scene->compiled);
    free(scene->vertices);
    free(scene->corners);
}

static inline double winding_at(const struct scene *scene, double x, double y, double z)
{
    struct work work = work_of(WORK_UNLIMITED);
    return dpti_winding_number(&scene->surface, &scene->kernel, (vec3){ x, y, z }, &work);
}

/* The flags of the part of a source triangle. */
static inline uint32_t flags_of(const struct scene *scene, uint32_t source)
{
    uint32_t place = mesh_words(scene->mesh, MESH_PLACES)[source];
    return mesh_part_flags(scene->mesh, mesh_words(scene->mesh, MESH_PARTS)[place]);
}

/* The definition: all triangles of solid parts, as the file has them wound. */
static inline double brute_at(const struct scene *scene, vec3 x)
{
    double sum = 0.0, at[3] = { x.x, x.y, x.z };
    for (uint32_t t = 0; t < scene->info.source_triangles; t++) {
        double c[9], r[3], product[3];
        if (dpt_mesh_get_triangle(scene->mesh, t, c) != DPT_OK ||
            !(flags_of(scene, t) & MESH_PART_SOLID))
            continue;
        for (int k = 0; k < 9; k++)
            c[k] -= at[k % 3];
        for (int i = 0; i < 3; i++) {
            const double *a = c + 3 * i, *b = c + (3 * i + 3) % 9;
            r[i] = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
            product[i] = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        }
        double volume = c[0] * (c[4] * c[8] - c[5] * c[7]) + c[1] * (c[5] * c[6] - c[3] * c[8]) +
                        c[2] * (c[3] * c[7] - c[4] * c[6]);
        sum += 2.0 * atan2(volume, r[0] * r[1] * r[2] + product[0] * r[2] + product[1] * r[0] +
                                       product[2] * r[1]);
    }
    return sum / (4.0 * PI);
}

static inline vec3 point_in_box(const struct scene *scene, uint64_t *random)
{
    const double *low = scene->info.box_min, *high = scene->info.box_max;
    return (vec3){ random_in(random, low[0], high[0]), random_in(random, low[1], high[1]),
                   random_in(random, low[2], high[2]) };
}

/* Off the middle of a triangle by a share of the diagonal, along its normal. */
static inline vec3 point_off(const struct scene *scene, uint32_t place, double share)
{
    const struct surface *tree = &scene->surface;
    const double *low = scene->info.box_min, *high = scene->info.box_max;
    vec3 c[3];
    for (uint32_t k = 0; k < 3; k++)
        c[k] = vec3_of_float(tree->positions + 3 * (size_t)tree->corners[3 * (size_t)place + k]);
    vec3 middle = scaled(add(add(c[0], c[1]), c[2]), 1.0 / 3.0);
    vec3 normal = cross(sub(c[1], c[0]), sub(c[2], c[0]));
    return along(middle, share * length(sub(vec3_of(high), vec3_of(low))) / length(normal), normal);
}

#endif
