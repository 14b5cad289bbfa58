/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Vertex normals, and flags for border, non-manifold and crease edges. Stored in the file, they spare a tick the walk
 * over a vertex's triangles. Time is linear in the triangles.
 */
#include <stdlib.h>

#include "base/angle.h"
#include "compile/cluster.h"
#include "compile/compile_context.h"
#include "mesh/mesh_format.h"

/* A sum of angle-weighted normals has no usable direction if it is shorter than this times the sum of the angles. */
#define NORMAL_MIN 0x1p-20

struct normals {
    struct model *model;
    vec3 *face_normals;    /* of each triangle, unit */
    double *corner_angles; /* 3 per triangle, rad */
    uint8_t *vertex_edges; /* of each vertex: DPT_EDGE_... of all edges there */
    double cosine;         /* of the crease angle */
};

static void measure_faces(void *context, size_t first, size_t end)
{
    const struct normals *work = context;
    for (size_t t = first; t < end; t++) {
        vec3 c[3], edge[3];
        model_corners(work->model, (uint32_t)t, c);
        work->face_normals[t] = unit_of(cross(sub(c[1], c[0]), sub(c[2], c[0])));
        for (int k = 0; k < 3; k++)
            edge[k] = unit_of(sub(c[(k + 1) % 3], c[k]));
        for (size_t k = 0; k < 3; k++)
            work->corner_angles[3 * t + k] = angle_between(edge[k], scaled(edge[(k + 2) % 3], -1.0));
    }
}

/*
 * The cosine of 0..pi rad, with the same bits on every machine: the series at an eighth of the angle, doubled three
 * times.
 */
static double cosine_of(double angle)
{
    double x = angle / 8.0, x2 = x * x, cosine = 1.0;
    for (int k = 14; k > 0; k -= 2)
        cosine = 1.0 - x2 / ((k - 1) * k) * cosine;
    for (int i = 0; i < 3; i++)
        cosine = 2.0 * cosine * cosine - 1.0;
    return cosine;
}

/*
 * Do the normals of a half-edge's triangle and its neighbour differ by more than the crease angle? If the two are wound
 * against each other, one of them counts as turned.
 */
static int is_crease(const struct normals *work, uint32_t half)
{
    uint32_t n = work->model->neighbours[half];
    double cosine = dot(work->face_normals[half / 3], work->face_normals[n]);
    return (model_is_wound_against(work->model, half, n) ? -cosine : cosine) < work->cosine;
}

static void flag_edges(void *context, size_t first, size_t end)
{
    const struct normals *work = context;
    for (size_t t = first; t < end; t++) {
        uint32_t flags = 0;
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t half = 3 * (uint32_t)t + k, n = work->model->neighbours[half], edge = 0;
            if (n == MESH_EDGE_OPEN)
                edge = DPT_EDGE_BORDER;
            else if (n == MESH_EDGE_MANY)
                edge = DPT_EDGE_NONMANIFOLD;
            else if (is_crease(work, half))
                edge = DPT_EDGE_CREASE;
            flags |= edge << k;
        }
        work->model->flags[t] = flags;
    }
}

/* Sum up the normal of each vertex over its triangles, in the order of the fan. It is 0 where several parts meet. */
static void add_normals(void *context, size_t first, size_t end)
{
    const uint32_t edge_bits = DPT_EDGE_BORDER | DPT_EDGE_NONMANIFOLD | DPT_EDGE_CREASE;
    const struct normals *work = context;
    const struct model *model = work->model;
    for (size_t v = first; v < end; v++) {
        const uint32_t *fan = model->fans + model->fan_first[v];
        const uint32_t *fan_end = model->fans + model->fan_first[v + 1];
        const uint32_t part = model->part_of[*fan];
        vec3 sum = { 0.0, 0.0, 0.0 };
        double angles = 0.0;
        uint32_t edges = 0;
        int is_shared = 0;
        for (; fan < fan_end; fan++) {
            const uint32_t *corner = model->corners + 3 * (size_t)*fan;
            uint32_t k = corner[0] == v ? 0 : corner[1] == v ? 1 : 2;
            double angle = work->corner_angles[3 * (size_t)*fan + k];
            sum = along(sum, angle, work->face_normals[*fan]);
            angles += angle;
            edges |= model->flags[*fan] >> k | model->flags[*fan] >> (k + 2) % 3;
            is_shared |= model->part_of[*fan] != part;
        }
        int has_no_normal = is_shared || !(length(sum) > NORMAL_MIN * angles);
        vec3 n = has_no_normal ? (vec3){ 0.0, 0.0, 0.0 } : unit_of(sum);
        work->vertex_edges[v] = (uint8_t)(edges & edge_bits);
        model->normals[3 * v] = (float)n.x;
        model->normals[3 * v + 1] = (float)n.y;
        model->normals[3 * v + 2] = (float)n.z;
    }
}

/* The bit of a corner is that of an edge times DPT_CORNER_BORDER / DPT_EDGE_BORDER, for all three kinds. */
static void flag_corners(void *context, size_t first, size_t end)
{
    const uint32_t corner = DPT_CORNER_BORDER / DPT_EDGE_BORDER;
    const struct normals *work = context;
    for (size_t t = first; t < end; t++)
        for (uint32_t k = 0; k < 3; k++)
            work->model->flags[t] |= work->vertex_edges[work->model->corners[3 * t + k]] * corner << k;
}

/* Count creases, once for each pair of triangles, and vertices without a normal. */
static void count_results(struct model *model)
{
    for (uint32_t half = 0; half < 3 * model->triangle_count; half++)
        model->crease_edges +=
            (model->flags[half / 3] >> half % 3 & DPT_EDGE_CREASE) != 0 && half / 3 < model->neighbours[half];
    for (uint32_t v = 0; v < model->vertex_count; v++) {
        const float *n = model->normals + 3 * (size_t)v;
        model->normalless_vertices += n[0] == 0.0f && n[1] == 0.0f && n[2] == 0.0f;
    }
}

dpt_result model_normals(struct model *model, const struct compile_context *context, double crease)
{
    const uint32_t threads = context->threads, triangles = model->triangle_count;
    struct normals work = { .model = model };
    work.face_normals = compile_alloc(context, triangles, sizeof *work.face_normals);
    work.corner_angles = compile_alloc(context, triangles, 3 * sizeof *work.corner_angles);
    work.vertex_edges = compile_alloc(context, model->vertex_count, sizeof *work.vertex_edges);
    work.cosine = crease < 0.5 * ANGLE_TURN ? cosine_of(crease) : -2.0;
    model->flags = compile_alloc(context, triangles, sizeof *model->flags);
    model->normals = compile_alloc(context, model->vertex_count, 3 * sizeof *model->normals);
    dpt_result result = DPT_E_MEMORY;
    model->crease = crease;
    if (work.face_normals && work.corner_angles && work.vertex_edges && model->flags && model->normals) {
        parallel_for(threads, triangles, PARALLEL_MIN, measure_faces, &work);
        parallel_for(threads, triangles, PARALLEL_MIN, flag_edges, &work);
        parallel_for(threads, model->vertex_count, PARALLEL_MIN, add_normals, &work);
        parallel_for(threads, triangles, PARALLEL_MIN, flag_corners, &work);
        count_results(model);
        result = DPT_OK;
    }
    free(work.face_normals);
    free(work.corner_angles);
    free(work.vertex_edges);
    return result;
}
