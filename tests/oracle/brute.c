/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The brute force of brute.h. See there for what it may be trusted with.
 */
#include "oracle/brute.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/*
 * In its frame a triangle is (0, 0, 0), (length, 0, 0), (foot, height, 0) with 0 <= foot <= length.
 * The sphere holds it; `number` is UINT32_MAX for one that is left out.
 */
struct face {
    double centre[3], radius;
    double origin[3], axis[3][3];
    double length, foot, height;
    uint32_t number;
};

struct oracle_mesh {
    uint32_t count;
    double extent; /* the largest |coordinate| */
    struct face face[];
};

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void cross(double out[3], const double a[3], const double b[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static inline double clamp(double t)
{
    return t < 0 ? 0 : t > 1 ? 1 : t;
}

/* fmin is a call into libm, which costs more than the rest of an edge. */
static double lesser(double a, double b)
{
    return a < b ? a : b;
}

/* out = from + t along */
static inline void walk(double out[3], const double from[3], double t, const double along[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = from[k] + t * along[k];
}

/* Makes x a unit vector that is perpendicular to `unit`, also where it nearly lies along it. */
static double straighten(double x[3], const double unit[3])
{
    for (int pass = 0; pass < 3; pass++)
        walk(x, x, -dot(x, unit), unit);
    const double length = sqrt(dot(x, x));
    for (int k = 0; k < 3 && length > 0; k++)
        x[k] /= length;
    return length;
}

/* Any unit vector that is perpendicular to `unit`. */
static void any_across(double out[3], const double unit[3])
{
    int least = 0;
    for (int k = 1; k < 3; k++)
        if (fabs(unit[k]) < fabs(unit[least]))
            least = k;
    memset(out, 0, 3 * sizeof *out);
    out[least] = 1;
    straighten(out, unit);
}

static void face_of(struct face *face, double corner[3][3])
{
    double along[3] = { 0, 0, 0 }, up[3];
    int base = 0;
    for (int i = 0; i < 3; i++) {
        double edge[3];
        walk(edge, corner[(i + 1) % 3], -1, corner[i]);
        if (dot(edge, edge) > dot(along, along)) {
            memcpy(along, edge, sizeof along);
            base = i;
        }
    }
    memcpy(face->origin, corner[base], sizeof face->origin);
    walk(up, corner[(base + 2) % 3], -1, face->origin);
    for (int k = 0; k < 3; k++)
        face->centre[k] = face->origin[k] + along[k] / 2;
    /* No corner is farther from the longest edge's middle than sqrt(3)/2 of its length. */
    face->length = sqrt(dot(along, along));
    face->radius = 0.87 * face->length;

    double *axis = face->axis[0], *across = face->axis[1];
    memcpy(axis, (const double[3]){ 1, 0, 0 }, sizeof face->axis[0]);
    for (int k = 0; k < 3 && face->length > 0; k++)
        axis[k] = along[k] / face->length;
    const double foot = dot(up, axis);
    face->foot = foot < 0 ? 0 : foot > face->length ? face->length : foot;
    memcpy(across, up, sizeof face->axis[1]);
    face->height = straighten(across, axis);
    if (face->height <= 0x1p-50 * face->length) {
        face->height = 0;
        any_across(across, axis);
    } else {
        straighten(across, axis);
    }
    cross(face->axis[2], axis, across);
}

oracle_mesh *oracle_brute_open(const float *vertices, uint32_t vertex_count, const uint32_t *corners,
                               uint32_t triangle_count)
{
    oracle_mesh *mesh = calloc(1, sizeof *mesh + triangle_count * sizeof mesh->face[0]);
    if (!mesh)
        return NULL;
    mesh->count = triangle_count;
    for (uint32_t i = 0; i < triangle_count; i++) {
        double corner[3][3];
        mesh->face[i].number = i;
        for (int j = 0; j < 3; j++) {
            const uint32_t vertex = corners[3 * (size_t)i + (size_t)j];
            if (vertex >= vertex_count) {
                mesh->face[i].number = UINT32_MAX;
                break;
            }
            for (int k = 0; k < 3; k++) {
                corner[j][k] = (double)vertices[3 * (size_t)vertex + (size_t)k];
                mesh->extent = fmax(mesh->extent, fabs(corner[j][k]));
            }
        }
        if (mesh->face[i].number == i)
            face_of(&mesh->face[i], corner);
    }
    return mesh;
}

void oracle_brute_close(oracle_mesh *mesh)
{
    free(mesh);
}

/* The squared distance of p to the segment from `from` to from + along. */
static inline double point_line(const double p[3], const double from[3], const double along[3])
{
    double away[3];
    const double square = dot(along, along);
    walk(away, p, -1, from);
    walk(away, away, square > 0 ? -clamp(dot(away, along) / square) : 0, along);
    return dot(away, away);
}

/*
 * The squared distance of two segments if both their nearest points are inner ones; else something
 * that is not less. The cross product keeps its digits where the lines are nearly parallel, which
 * the usual determinant of dot products does not.
 */
static inline double line_line(const double a[3], const double d[3], const double from[3], const double along[3])
{
    double normal[3], away[3], turned[3], p[3];
    cross(normal, d, along);
    const double square = dot(normal, normal);
    if (!(square > 0))
        return INFINITY;
    walk(away, from, -1, a);
    cross(turned, away, along);
    walk(p, a, clamp(dot(turned, normal) / square), d);
    return point_line(p, from, along);
}

/* The squared distance of p to the face; all in the face's frame. */
static double point_face(const struct face *face, const double p[3], double edge[3][3], double corner[3][3])
{
    const double u = p[0], v = p[1];
    if (face->height > 0 && v >= 0 && u >= 0 && u <= face->length) {
        const int within = u <= face->foot ? v * face->foot <= u * face->height
                                           : v * (face->length - face->foot) <= (face->length - u) * face->height;
        if (within)
            return p[2] * p[2];
    }
    return lesser(point_line(p, corner[0], edge[0]),
                  lesser(point_line(p, corner[1], edge[1]), point_line(p, corner[2], edge[2])));
}

/* Infinity where the whole segment is farther than `limit` to one side of the face's plane. */
static double segment_face(const struct face *face, const double segment[6], double limit)
{
    double end[2][3], d[3];
    for (int i = 0; i < 2; i++) {
        double away[3];
        walk(away, segment + 3 * i, -1, face->origin);
        for (int k = 0; k < 3; k++)
            end[i][k] = dot(away, face->axis[k]);
    }
    if (lesser(end[0][2], end[1][2]) > limit || lesser(-end[0][2], -end[1][2]) > limit)
        return INFINITY;
    walk(d, end[1], -1, end[0]);
    double corner[3][3] = { { 0, 0, 0 }, { face->length, 0, 0 }, { face->foot, face->height, 0 } };
    double edge[3][3] = { { face->length, 0, 0 },
                          { face->foot - face->length, face->height, 0 },
                          { -face->foot, -face->height, 0 } };

    double least = lesser(point_face(face, end[0], edge, corner), point_face(face, end[1], edge, corner));
    if ((end[0][2] < 0) != (end[1][2] < 0)) {
        double p[3];
        walk(p, end[0], clamp(end[0][2] / (end[0][2] - end[1][2])), d);
        least = lesser(least, point_face(face, p, edge, corner));
    }
    for (int i = 0; i < 3; i++) {
        least = lesser(least, point_line(corner[i], end[0], d));
        least = lesser(least, line_line(end[0], d, corner[i], edge[i]));
    }
    return sqrt(least);
}

double oracle_brute_triangle(const oracle_mesh *mesh, uint32_t triangle, const double segment[6])
{
    if (triangle >= mesh->count || mesh->face[triangle].number != triangle)
        return INFINITY;
    return segment_face(&mesh->face[triangle], segment, INFINITY);
}

double oracle_brute(const oracle_mesh *mesh, const double segment[6], uint32_t *triangle)
{
    double d[3], extent = mesh->extent, least = INFINITY;
    uint32_t winner = UINT32_MAX;
    walk(d, segment + 3, -1, segment);
    for (int k = 0; k < 6; k++)
        extent = fmax(extent, fabs(segment[k]));
    for (uint32_t i = 0; i < mesh->count; i++) {
        const struct face *face = &mesh->face[i];
        if (face->number != i)
            continue;
        /* The margin is far above the rounding of both sides: no nearer triangle is passed over. */
        const double limit = least * (1 + 1e-13) + 1e-13 * extent;
        const double reach = limit + face->radius * (1 + 1e-13);
        if (point_line(face->centre, segment, d) > reach * reach)
            continue;
        const double distance = segment_face(face, segment, limit);
        if (distance < least) {
            least = distance;
            winner = i;
        }
    }
    if (triangle)
        *triangle = winner;
    return least;
}
