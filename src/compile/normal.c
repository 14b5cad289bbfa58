/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a tick would have to walk a vertex's triangles for: its normal, and which of its edges are borders or creases.
 * Linear in the triangles.
 */
#include <stdlib.h>
#include <string.h>

#include "../angle.h"
#include "../mesh_format.h"
#include "cluster.h"

/* A sum of normals that is shorter than this, per angle of its triangles, tells no direction. */
#define NORMAL_LEAST 0x1p-20

/* All of a vertex's triangles added up. */
struct around {
    vec3 normal;
    double angle;
    uint32_t part; /* DPT_NONE: of none yet */
    uint32_t edges;
    int shared; /* by several parts */
};

/* Unit normals of the triangles, and what they add to those of their vertices, in the order of the fans. */
static void add_normals(const struct model *model, vec3 *faces, struct around *around)
{
    for (uint32_t t = 0; t < model->triangle_count; t++) {
        vec3 c[3], edge[3];
        model_corners(model, t, c);
        faces[t] = unit_of(cross(sub(c[1], c[0]), sub(c[2], c[0])));
        for (int k = 0; k < 3; k++)
            edge[k] = unit_of(sub(c[(k + 1) % 3], c[k]));
        for (int k = 0; k < 3; k++) {
            struct around *here = &around[model->corners[3 * (size_t)t + (size_t)k]];
            double angle = angle_between(edge[k], scaled(edge[(k + 2) % 3], -1.0));
            here->normal = along(here->normal, angle, faces[t]);
            here->angle += angle;
            here->shared |= here->part != DPT_NONE && here->part != model->part_of[t];
            here->part = model->part_of[t];
        }
    }
}

/* Of 0..pi, by the series of an eighth of it: the same bits on every machine. */
static double cosine_of(double angle)
{
    double x = angle / 8.0, x2 = x * x, cosine = 1.0;
    for (int k = 14; k > 0; k -= 2)
        cosine = 1.0 - x2 / ((k - 1) * k) * cosine;
    for (int i = 0; i < 3; i++)
        cosine = 2.0 * cosine * cosine - 1.0;
    return cosine;
}

/* Do they meet at more than the limit? Of two that are wound against each other the one counts as turned. */
static int is_crease(const struct model *model, const vec3 *faces, uint32_t half, double cosine)
{
    uint32_t n = model->neighbours[half];
    double both = dot(faces[half / 3], faces[n]);
    return (model_wound_against(model, half, n) ? -both : both) < cosine;
}

static void flag_edges(struct model *model, const vec3 *faces, struct around *around, double crease)
{
    const double cosine = crease < 0.5 * ANGLE_TURN ? cosine_of(crease) : -2.0;
    for (uint32_t half = 0; half < 3 * model->triangle_count; half++) {
        uint32_t n = model->neighbours[half], edge = 0;
        if (n == MESH_EDGE_OPEN)
            edge = DPT_EDGE_BORDER;
        else if (n == MESH_EDGE_MANY)
            edge = DPT_EDGE_NONMANIFOLD;
        else if (is_crease(model, faces, half, cosine))
            edge = DPT_EDGE_CREASE;
        model->flags[half / 3] |= edge << half % 3;
        model->crease_edges += edge == DPT_EDGE_CREASE && half / 3 < n;
        around[model->corners[half]].edges |= edge;
        around[model->corners[half % 3 == 2 ? half - 2 : half + 1]].edges |= edge;
    }
}

/* A corner's bit is as far from its edge's as DPT_CORNER_BORDER from DPT_EDGE_BORDER. */
static void flag_corners(struct model *model, const struct around *around)
{
    const uint32_t corner = DPT_CORNER_BORDER / DPT_EDGE_BORDER;
    for (uint32_t c = 0; c < 3 * model->triangle_count; c++)
        model->flags[c / 3] |= around[model->corners[c]].edges * corner << c % 3;
}

static void put_normals(struct model *model, const struct around *around)
{
    for (uint32_t v = 0; v < model->vertex_count; v++) {
        float *out = model->normals + 3 * (size_t)v;
        double size = length(around[v].normal);
        int none = around[v].shared || !(size > NORMAL_LEAST * around[v].angle);
        vec3 n = none ? (vec3){ 0.0, 0.0, 0.0 } : unit_of(around[v].normal);
        model->normalless_vertices += (uint32_t)none;
        out[0] = (float)n.x;
        out[1] = (float)n.y;
        out[2] = (float)n.z;
    }
}

dpt_result model_normals(struct model *model, soup *source, double crease)
{
    vec3 *faces = model_array(source, model->triangle_count, sizeof *faces);
    struct around *around = model_array(source, model->vertex_count, sizeof *around);
    model->flags = model_array(source, model->triangle_count, sizeof *model->flags);
    model->normals = model_array(source, model->vertex_count, 3 * sizeof *model->normals);
    dpt_result result = DPT_E_MEMORY;
    model->crease = crease;
    if (faces && around && model->flags && model->normals) {
        memset(model->flags, 0, model->triangle_count * sizeof *model->flags);
        for (uint32_t v = 0; v < model->vertex_count; v++)
            around[v] = (struct around){ .part = DPT_NONE };
        add_normals(model, faces, around);
        flag_edges(model, faces, around, crease);
        flag_corners(model, around);
        put_normals(model, around);
        result = DPT_OK;
    }
    free(faces);
    free(around);
    return result;
}
