/* SPDX-License-Identifier: BSD-3-Clause */
#include "lib/mesh_builder.h"

void builder_add_shape(struct mesh_builder *builder, const char *name, uint64_t count, vec3 at, double size, int inward,
                       size_t missing)
{
    struct shape shape;
    shape_reason reason;
    if (shape_make(name, count, 0, &shape, reason)) {
        CHECK(0, "%s", reason);
        return;
    }
    builder_reserve(builder, shape.vertex_count, shape.triangle_count);
    size_t base = builder->vertex_count;
    for (size_t v = 0; v < shape.vertex_count; v++)
        builder_add_vertex(builder, at.x + size * shape.vertices[3 * v], at.y + size * shape.vertices[3 * v + 1],
                           at.z + size * shape.vertices[3 * v + 2]);
    for (size_t t = 0; t + missing < shape.triangle_count; t++)
        builder_add_triangle(builder, base + shape.corners[3 * t], base + shape.corners[3 * t + 1],
                             base + shape.corners[3 * t + 2], inward);
    shape_free(&shape);
}

void builder_add_ball(struct mesh_builder *builder, vec3 at, double radius, double open, int inward)
{
    enum { ROUND = 32, RINGS = 24 };
    const double first = acos(1.0 - 2.0 * open);
    builder_reserve(builder, ROUND * RINGS + 2, 2 * ROUND * RINGS);
    size_t base = builder->vertex_count;
    for (int ring = 0; ring < RINGS; ring++)
        for (int k = 0; k < ROUND; k++) {
            double down = open > 0.0 ? first + (PI - first) * ring / RINGS : PI * (ring + 1) / (RINGS + 1);
            double turn = 2.0 * PI * k / ROUND;
            builder_add_vertex(builder, at.x + radius * sin(down) * cos(turn), at.y + radius * sin(down) * sin(turn),
                               at.z + radius * cos(down));
        }
    builder_add_vertex(builder, at.x, at.y, at.z - radius);
    builder_add_vertex(builder, at.x, at.y, at.z + radius);
    for (size_t ring = 0; ring < RINGS; ring++)
        for (size_t k = 0; k < ROUND; k++) {
            size_t a = base + ROUND * ring + k, b = base + ROUND * ring + (k + 1) % ROUND;
            if (ring + 1 < RINGS) {
                builder_add_triangle(builder, a, a + ROUND, b, inward);
                builder_add_triangle(builder, b, a + ROUND, b + ROUND, inward);
            } else {
                builder_add_triangle(builder, a, base + ROUND * RINGS, b, inward);
            }
            if (ring == 0 && !(open > 0.0))
                builder_add_triangle(builder, a, b, base + ROUND * RINGS + 1, inward);
        }
}

/* Open what was compiled. */
static int take_compiled(struct mesh_builder *builder, dpt_result result, const char *text)
{
    uint32_t chosen;
    builder->info.size = sizeof builder->info;
    if (result == DPT_OK)
        result = dpt_mesh_convert(builder->compiled.bytes, builder->compiled.size, NULL);
    if (result == DPT_OK)
        result = dpt_mesh_open(builder->compiled.bytes, builder->compiled.size, &builder->mesh);
    CHECK(result == DPT_OK, "%s %s", dpt_result_name(result), text);
    if (result != DPT_OK)
        return 0;
    dpt_mesh_get_info(builder->mesh, &builder->info);
    dpti_surface_of_mesh(builder->mesh, &builder->surface);
    dpti_kernel_get(DPT_KERNEL_AUTO, &builder->kernel, &chosen);
    return 1;
}

int builder_compile(struct mesh_builder *builder)
{
    dpt_diag diag = { .size = sizeof diag };
    const dpt_result result = dpt_compile_arrays(builder->vertices, builder->vertex_count, builder->corners,
                                                 builder->triangle_count, NULL, &builder->compiled, &diag);
    return take_compiled(builder, result, diag.text);
}

int builder_compile_file(struct mesh_builder *builder, const char *path)
{
    dpt_diag diag = { .size = sizeof diag };
    *builder = (struct mesh_builder){ .mesh = NULL };
    const dpt_result result = dpt_compile_file(path, NULL, &builder->compiled, &diag);
    return take_compiled(builder, result, diag.text);
}

double brute_winding_at(const struct mesh_builder *builder, vec3 x)
{
    double sum = 0.0, at[3] = { x.x, x.y, x.z };
    for (uint32_t t = 0; t < builder->info.source_triangles; t++) {
        double c[9], r[3], product[3];
        if (dpt_mesh_get_triangle(builder->mesh, t, c) != DPT_OK || !(part_flags_of(builder, t) & MESH_PART_SOLID))
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
        sum += 2.0 * atan2(volume, r[0] * r[1] * r[2] + product[0] * r[2] + product[1] * r[0] + product[2] * r[1]);
    }
    return sum / (4.0 * PI);
}

vec3 point_off(const struct mesh_builder *builder, uint32_t place, double share)
{
    const struct surface *tree = &builder->surface;
    const double *low = builder->info.box_min, *high = builder->info.box_max;
    vec3 c[3];
    for (uint32_t k = 0; k < 3; k++)
        c[k] = vec3_of_float(tree->positions + 3 * (size_t)tree->corners[3 * (size_t)place + k]);
    vec3 middle = scaled(add(add(c[0], c[1]), c[2]), 1.0 / 3.0);
    vec3 normal = cross(sub(c[1], c[0]), sub(c[2], c[0]));
    return along(middle, share * length(sub(vec3_of(high), vec3_of(low))) / length(normal), normal);
}
