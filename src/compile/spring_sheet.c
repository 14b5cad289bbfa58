/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Springs of a sheet (docs/algorithms/springs.md).
 *
 * A strain e gives a spring of length c in direction n the energy 1/2 k c^2 (n e n)^2. Directions that are spread
 * evenly give an isotropic sheet with Poisson's ratio 1/3 and E h A = 1/3 sum of k c^2. So a triangle of area A gives
 * its springs k c^2 = 3 E h A together, in equal parts.
 */
#include <math.h>

#include "base/return_if_error.h"
#include "base/vec3.h"
#include "compile/spring_build.h"
#include "mesh/mesh_format.h"

/* An edge is the longest if its square is that much above the others': not by rounding alone. */
#define LONGER (1.0 + 1e-5)

struct sheet {
    struct net *net;
    const struct model *model;
};

static vec3 vertex_at(const struct sheet *sheet, uint32_t v)
{
    return vec3_of_float(sheet->model->positions + 3 * (size_t)v);
}

static double length2(const struct sheet *sheet, uint32_t a, uint32_t b)
{
    const vec3 edge = sub(vertex_at(sheet, b), vertex_at(sheet, a));
    return dot(edge, edge);
}

/* Is edge k the longest of triangle t? */
static int is_longest(const struct sheet *sheet, uint32_t t, uint32_t k)
{
    const uint32_t *corner = sheet->model->corners + 3 * (size_t)t;
    double edge2[3];
    for (uint32_t i = 0; i < 3; i++)
        edge2[i] = length2(sheet, corner[i], corner[(i + 1) % 3]);
    return edge2[k] > LONGER * edge2[(k + 1) % 3] && edge2[k] > LONGER * edge2[(k + 2) % 3];
}

/* The triangle over edge k of triangle t, DPT_NONE: there is none; *back: the edge in it. */
static uint32_t neighbour_of(const struct sheet *sheet, uint32_t t, uint32_t k, uint32_t *back)
{
    const struct model *model = sheet->model;
    const uint32_t *corner = model->corners + 3 * (size_t)t, a = corner[k], b = corner[(k + 1) % 3];
    const uint32_t other = model->neighbours[3 * (size_t)t + k];
    if (other >= MESH_EDGE_MANY)
        return DPT_NONE;
    const uint32_t *of = model->corners + 3 * (size_t)other;
    for (*back = 0; *back < 2; ++*back) {
        const uint32_t c = of[*back], d = of[(*back + 1) % 3];
        if ((c == a && d == b) || (c == b && d == a))
            break;
    }
    return other;
}

/* Has the pair of triangles over edge k of t a shear spring, the other diagonal? */
static int is_sheared(const struct sheet *sheet, uint32_t t, uint32_t k)
{
    uint32_t back, other = neighbour_of(sheet, t, k, &back);
    return other != DPT_NONE && is_longest(sheet, t, k) && is_longest(sheet, other, back);
}

static double area_of(const struct sheet *sheet, uint32_t t)
{
    const uint32_t *corner = sheet->model->corners + 3 * (size_t)t;
    const vec3 a = vertex_at(sheet, corner[0]);
    const vec3 n = cross(sub(vertex_at(sheet, corner[1]), a), sub(vertex_at(sheet, corner[2]), a));
    return 0.5 * sqrt(dot(n, n));
}

static struct material material_of(const struct sheet *sheet, uint32_t t)
{
    const uint32_t *corner = sheet->model->corners + 3 * (size_t)t;
    double centroid[3];
    vec3_store(scaled(add(add(vertex_at(sheet, corner[0]), vertex_at(sheet, corner[1])), vertex_at(sheet, corner[2])),
                      1.0 / 3.0),
               centroid);
    return spring_material(sheet->net, centroid);
}

/* Between the corners opposite edge k of t and of its neighbour; `stiffness` times the length squared, N m. */
static dpt_result add_across(const struct sheet *sheet, uint32_t t, uint32_t k, double stiffness)
{
    uint32_t back, other = neighbour_of(sheet, t, k, &back);
    const uint32_t a = sheet->model->corners[3 * (size_t)t + (k + 2) % 3];
    const uint32_t b = sheet->model->corners[3 * (size_t)other + (back + 2) % 3];
    return a == b ? DPT_OK : spring_add(sheet->net, a, b, stiffness / length2(sheet, a, b));
}

static dpt_result add_triangle(const struct sheet *sheet, uint32_t t)
{
    const dpt_spring_net_def *def = sheet->net->def;
    const uint32_t *corner = sheet->model->corners + 3 * (size_t)t;
    const struct material material = material_of(sheet, t);
    const double area = area_of(sheet, t), volume = area * def->thickness;
    int sheared[3], springs = 3;
    for (uint32_t k = 0; k < 3; k++)
        springs += sheared[k] = is_sheared(sheet, t, k);
    const double each = 3.0 * material.young * volume / springs;
    for (uint32_t k = 0; k < 3; k++) {
        const uint32_t a = corner[k], b = corner[(k + 1) % 3];
        sheet->net->mass[a] += material.density * volume / 3.0;
        DPT_TRY(spring_add(sheet->net, a, b, each / length2(sheet, a, b)));
        if (sheared[k])
            DPT_TRY(add_across(sheet, t, k, each));
        else if (def->bending > 0.0 && sheet->model->neighbours[3 * (size_t)t + k] < MESH_EDGE_MANY)
            DPT_TRY(add_across(sheet, t, k, 0.75 * def->bending * volume));
    }
    return DPT_OK;
}

dpt_result sheet_springs(struct net *net, const struct model *model)
{
    const struct sheet sheet = { net, model };
    for (uint32_t t = 0; t < model->triangle_count; t++)
        DPT_TRY(add_triangle(&sheet, t));
    return DPT_OK;
}
