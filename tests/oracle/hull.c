/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The polyhedron of hull.h. See there for what it may be trusted with.
 */
#include "oracle/hull.h"

#include <string.h>

#include "oracle/hull_distance.h"
#include "oracle/polygon.h"

const char *oracle_hull_read(const dpt_hull *hull, struct oracle_hull *out)
{
    dpt_hull_info info = { .size = sizeof info };
    memset(out, 0, sizeof *out);
    if (dpt_hull_get_info(hull, &info) != DPT_OK)
        return "no info";
    if (info.corners > ORACLE_CORNERS || info.edges > ORACLE_EDGES || info.faces > ORACLE_FACES)
        return "more than a hull has";
    out->corner_count = info.corners;
    out->edge_count = info.edges;
    out->face_count = info.faces;
    for (uint32_t i = 0; i < info.corners; i++)
        if (dpt_hull_get_corner(hull, i, out->corner[i]) != DPT_OK)
            return "no corner";
    for (uint32_t i = 0; i < info.edges; i++)
        if (dpt_hull_get_edge(hull, i, out->edge[i]) != DPT_OK)
            return "no edge";
    for (uint32_t i = 0; i < info.faces; i++)
        if (dpt_hull_get_face(hull, i, out->side[i], ORACLE_CORNERS, &out->side_count[i]) != DPT_OK)
            return "no face";
    return NULL;
}

void oracle_hull_at(const struct oracle_hull *hull, const double *corners, struct oracle_hull *out)
{
    *out = *hull;
    memcpy(out->corner, corners, 3 * sizeof *corners * hull->corner_count);
}

static void polygon_of_face(const struct oracle_hull *hull, uint32_t face, struct polygon *out)
{
    out->count = hull->side_count[face];
    for (uint32_t i = 0; i < out->count; i++)
        widen(out->corner[i], hull->corner[hull->side[face][i]]);
    polygon_set_normal(out);
}

/* ---- feature against feature ---- */

double oracle_hull_by_features(const struct oracle_hull *hull, const double triangle[9])
{
    struct polygon flat = { .count = 3 }, face;
    wide least = INFINITY;
    int is_inside = hull->face_count > 2;
    for (int i = 0; i < 3; i++)
        widen(flat.corner[i], triangle + 3 * i);
    polygon_set_normal(&flat);
    for (uint32_t i = 0; i < hull->corner_count; i++) {
        wide x[3];
        widen(x, hull->corner[i]);
        least = fminl(least, point_polygon(x, &flat));
    }
    for (uint32_t i = 0; i < hull->edge_count; i++) {
        wide a[3], b[3];
        widen(a, hull->corner[hull->edge[i][0]]);
        widen(b, hull->corner[hull->edge[i][1]]);
        for (int k = 0; k < 3; k++)
            least = fminl(least, segment_segment(a, b, flat.corner[k], flat.corner[(k + 1) % 3]));
        if (passes(a, b, &flat))
            return 0;
    }
    for (uint32_t f = 0; f < hull->face_count; f++) {
        polygon_of_face(hull, f, &face);
        for (int k = 0; k < 3; k++) {
            least = fminl(least, point_polygon(flat.corner[k], &face));
            if (passes(flat.corner[k], flat.corner[(k + 1) % 3], &face))
                return 0;
        }
        is_inside &= height_over(&face, flat.corner[0]) <= 0;
    }
    return is_inside ? 0 : (double)least;
}

/* ---- whether it is a convex hull ---- */

double oracle_hull_juts(const double *points, uint32_t count, uint32_t which)
{
    double others[3 * 256], self[9];
    uint32_t kept = 0;
    for (int k = 0; k < 9; k++)
        self[k] = points[3 * which + (uint32_t)k % 3];
    for (uint32_t i = 0; i < count && kept < 256; i++)
        if (memcmp(points + 3 * i, points + 3 * which, 3 * sizeof *points) != 0)
            memcpy(others + 3 * kept++, points + 3 * i, 3 * sizeof *points);
    return kept ? oracle_hull_triangle(others, kept, self, NULL).lower : INFINITY;
}

static int is_same(const double a[3], const double b[3])
{
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

static const char *corners_fault(const struct oracle_hull *hull, const double *points, uint32_t count, double tolerance)
{
    for (uint32_t i = 0; i < hull->corner_count; i++) {
        int is_given = 0;
        for (uint32_t j = 0; j < count; j++)
            is_given |= is_same(hull->corner[i], points + 3 * j);
        if (!is_given)
            return "a corner that was not given";
        for (uint32_t j = 0; j < i; j++)
            if (is_same(hull->corner[i], hull->corner[j]))
                return "two corners in one place";
    }
    for (uint32_t j = 0; j < count; j++) {
        int is_corner = 0;
        for (uint32_t i = 0; i < hull->corner_count; i++)
            is_corner |= is_same(hull->corner[i], points + 3 * j);
        if (!is_corner && oracle_hull_juts(points, count, j) > tolerance)
            return "a point juts out and is no corner";
    }
    return NULL;
}

/* Every side of a face is an edge, and every edge a side of two faces, once each way. */
static const char *edges_fault(const struct oracle_hull *hull)
{
    uint32_t sides = 0;
    for (uint32_t i = 0; i < hull->edge_count; i++) {
        const uint32_t a = hull->edge[i][0], b = hull->edge[i][1];
        int there = 0, back = 0;
        if (a >= hull->corner_count || b >= hull->corner_count || a == b)
            return "an edge between no two corners";
        for (uint32_t j = 0; j < i; j++)
            if ((hull->edge[j][0] == a && hull->edge[j][1] == b) || (hull->edge[j][0] == b && hull->edge[j][1] == a))
                return "an edge twice";
        for (uint32_t f = 0; f < hull->face_count; f++)
            for (uint32_t s = 0; s < hull->side_count[f]; s++) {
                const uint32_t from = hull->side[f][s], to = hull->side[f][(s + 1) % hull->side_count[f]];
                there += from == a && to == b;
                back += from == b && to == a;
            }
        if (there != 1 || back != 1)
            return "an edge that is not a side of two faces";
    }
    for (uint32_t f = 0; f < hull->face_count; f++)
        sides += hull->side_count[f];
    if (sides != 2 * hull->edge_count)
        return "a face has a side that is no edge";
    if (hull->corner_count + hull->face_count != hull->edge_count + 2)
        return "Euler's formula";
    return NULL;
}

static const char *face_fault(const struct oracle_hull *hull, uint32_t f, const double *points, uint32_t count,
                              double tolerance)
{
    struct polygon face;
    const wide allowed = tolerance;
    if (hull->side_count[f] < 3 || hull->side_count[f] > hull->corner_count)
        return "a face of too few corners, or too many";
    for (uint32_t i = 0; i < hull->side_count[f]; i++) {
        if (hull->side[f][i] >= hull->corner_count)
            return "a face has a corner that is none";
        for (uint32_t j = 0; j < i; j++)
            if (hull->side[f][i] == hull->side[f][j])
                return "a face has a corner twice";
    }
    polygon_of_face(hull, f, &face);
    if (!(size_of(face.normal) > 0))
        return "a face without area";
    for (uint32_t i = 0; i < face.count; i++) {
        if (fabsl(height_over(&face, face.corner[i])) > allowed)
            return "a face that is not flat";
        for (uint32_t j = 0; j < face.count; j++)
            if (inside_side(&face, i, face.corner[j]) < -allowed)
                return "a face that is not convex, or not counter-clockwise";
    }
    for (uint32_t j = 0; j < count; j++) {
        wide x[3];
        widen(x, points + 3 * j);
        if (height_over(&face, x) > allowed)
            return "a point beyond a face";
    }
    return NULL;
}

const char *oracle_hull_fault(const struct oracle_hull *hull, const double *points, uint32_t count, double tolerance)
{
    const char *fault = corners_fault(hull, points, count, tolerance);
    if (!fault)
        fault = edges_fault(hull);
    for (uint32_t f = 0; f < hull->face_count && !fault; f++)
        fault = face_fault(hull, f, points, count, tolerance);
    return fault;
}
