/* SPDX-License-Identifier: BSD-3-Clause */
#include "lab/hand_place.h"

#include <math.h>
#include <string.h>

#include "base/vec3.h"

static int compile(struct hand_mesh *mesh, const dpt_spring_net_def *springs)
{
    dpt_compile_def def;
    dpt_compile_def_init(&def);
    def.springs = springs;
    if (dpt_compile_arrays(mesh->shape.vertices, mesh->shape.vertex_count, mesh->shape.corners,
                           mesh->shape.triangle_count, &def, &mesh->compiled, NULL) == DPT_OK &&
        dpt_mesh_open(mesh->compiled.bytes, mesh->compiled.size, &mesh->mesh) == DPT_OK)
        return 1;
    hand_mesh_close(mesh);
    return 0;
}

int hand_mesh_open(struct hand_mesh *mesh, const char *name, uint64_t triangles, double scale)
{
    shape_reason reason;
    memset(mesh, 0, sizeof *mesh);
    if (shape_make(name, triangles, 0, &mesh->shape, reason) != 0)
        return 0;
    for (size_t i = 0; i < 3 * mesh->shape.vertex_count; i++)
        mesh->shape.vertices[i] *= scale;
    return compile(mesh, NULL);
}

int hand_mesh_open_springs(struct hand_mesh *mesh, const char *name, uint64_t triangles,
                           const dpt_spring_net_def *springs)
{
    shape_reason reason;
    memset(mesh, 0, sizeof *mesh);
    return shape_make(name, triangles, 0, &mesh->shape, reason) == 0 && compile(mesh, springs);
}

int hand_mesh_warp(struct hand_mesh *mesh, void (*warp)(double x[3]))
{
    dpt_compiled_free(&mesh->compiled);
    for (size_t v = 0; v < mesh->shape.vertex_count; v++)
        warp(mesh->shape.vertices + 3 * v);
    return compile(mesh, NULL);
}

void hand_mesh_close(struct hand_mesh *mesh)
{
    dpt_compiled_free(&mesh->compiled);
    shape_free(&mesh->shape);
    mesh->mesh = NULL;
}

void hand_place_middle(const struct hand_mesh *mesh, struct hand_place *place)
{
    dpt_mesh_info info = { .size = sizeof info };
    *place = (struct hand_place){ .mesh = mesh, .along = { 1.0, 0.0, 0.0 } };
    dpt_mesh_get_info(mesh->mesh, &info);
    place->at[2] = info.box_max[2];
    place->out[2] = 1.0;
}

void hand_place_top(const struct hand_mesh *mesh, struct hand_place *place)
{
    const double *vertices = mesh->shape.vertices, beside[2] = { 0.0031, -0.0017 };
    size_t top = 0;
    double lowest = vertices[2];
    hand_place_middle(mesh, place);
    for (size_t v = 0; v < mesh->shape.vertex_count; v++) {
        lowest = fmin(lowest, vertices[3 * v + 2]);
        if (vertices[3 * v + 2] > vertices[3 * top + 2])
            top = v;
    }
    for (size_t k = 0; k < 2; k++)
        place->at[k] = beside[k] + (lowest < vertices[3 * top + 2] ? vertices[3 * top + k] : 0.0);
}

void hand_place_draw(const struct hand_mesh *mesh, uint64_t *seed, struct hand_place *place)
{
    const struct shape *shape = &mesh->shape;
    const size_t which = (size_t)(shape_random(seed) * (double)shape->triangle_count);
    const uint32_t *corners = shape->corners + 3 * which;
    double sides[2][3], drawn[3];
    *place = (struct hand_place){ .mesh = mesh };
    for (int k = 0; k < 3; k++) {
        const double first = shape->vertices[3 * (size_t)corners[0] + (size_t)k];
        sides[0][k] = shape->vertices[3 * (size_t)corners[1] + (size_t)k] - first;
        sides[1][k] = shape->vertices[3 * (size_t)corners[2] + (size_t)k] - first;
        place->at[k] = first + (sides[0][k] + sides[1][k]) / 3.0;
        drawn[k] = shape_random(seed) - 0.5;
    }
    vec3_cross(sides[0], sides[1], place->out);
    vec3_normalise(place->out);
    vec3_cross(place->out, drawn, place->along);
    vec3_normalise(place->along);
}
