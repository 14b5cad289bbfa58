/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Meshes put together from balls, shapes and loose triangles, their winding numbers and the flags of their parts, and
 * by the arctangent of the C library what the numbers should be.
 */
#ifndef DPT_TESTS_MESH_BUILDER_H
#define DPT_TESTS_MESH_BUILDER_H

#include "contact/winding_number.h"

#include "dynpoint/compile.h"
#include "dynpoint/kernel.h"
#include "lib/check.h"
#include "scene/shape.h"

#define PI 3.14159265358979323846

/* A mesh that is put together from shapes. */
struct mesh_builder {
    double *vertices;
    uint32_t *corners;
    size_t vertex_count, triangle_count;
    dpt_compiled compiled;
    const dpt_mesh *mesh;
    dpt_mesh_info info;
    struct surface surface;
    struct kernel kernel;
};

static inline void builder_reserve(struct mesh_builder *builder, size_t vertices, size_t triangles)
{
    builder->vertices = realloc(builder->vertices, (builder->vertex_count + vertices) * 3 * sizeof *builder->vertices);
    builder->corners = realloc(builder->corners, (builder->triangle_count + triangles) * 3 * sizeof *builder->corners);
}

static inline void builder_add_vertex(struct mesh_builder *builder, double x, double y, double z)
{
    double *v = builder->vertices + 3 * builder->vertex_count++;
    v[0] = x;
    v[1] = y;
    v[2] = z;
}

static inline void builder_add_triangle(struct mesh_builder *builder, size_t a, size_t b, size_t c, int inward)
{
    uint32_t *corner = builder->corners + 3 * builder->triangle_count++;
    corner[0] = (uint32_t)a;
    corner[1] = (uint32_t)(inward ? c : b);
    corner[2] = (uint32_t)(inward ? b : c);
}

/* A shape of `dynpoint make` at a place, its last triangles missing. */
void builder_add_shape(struct mesh_builder *builder, const char *name, uint64_t count, vec3 at, double size, int inward,
                       size_t missing);

/* A ball of rings, without what lies above `open` of its area, 0 for a closed one. */
void builder_add_ball(struct mesh_builder *builder, vec3 at, double radius, double open, int inward);

/* Far away, small and with a hole: makes the compiler write moments, and adds nothing near the origin. */
static inline void builder_add_beacon(struct mesh_builder *builder)
{
    builder_add_shape(builder, "sphere", 40, (vec3){ 100.0, 0.0, 0.0 }, 0.1, 0, 1);
}

int builder_compile(struct mesh_builder *builder);

/* A mesh file in place of shapes. */
int builder_compile_file(struct mesh_builder *builder, const char *path);

static inline void builder_free(struct mesh_builder *builder)
{
    dpt_compiled_free(&builder->compiled);
    free(builder->vertices);
    free(builder->corners);
}

static inline double winding_at(const struct mesh_builder *builder, double x, double y, double z)
{
    struct work work = work_of(WORK_UNLIMITED);
    return dpti_winding_number(&builder->surface, &builder->kernel, (vec3){ x, y, z }, &work);
}

/* The flags of the part of a source triangle. */
static inline uint32_t part_flags_of(const struct mesh_builder *builder, uint32_t source)
{
    uint32_t place = mesh_words(builder->mesh, MESH_PLACES)[source];
    return mesh_part_flags(builder->mesh, mesh_words(builder->mesh, MESH_PARTS)[place]);
}

/* The definition: all triangles of solid parts, as the file has them wound. */
double brute_winding_at(const struct mesh_builder *builder, vec3 x);

static inline vec3 point_in_box(const struct mesh_builder *builder, uint64_t *random)
{
    const double *low = builder->info.box_min, *high = builder->info.box_max;
    return (vec3){ random_in(random, low[0], high[0]), random_in(random, low[1], high[1]),
                   random_in(random, low[2], high[2]) };
}

/* Off the middle of a triangle by a share of the diagonal, along its normal. */
vec3 point_off(const struct mesh_builder *builder, uint32_t place, double share);

#endif
