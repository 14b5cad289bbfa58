/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a convex polyhedron is, from the definition alone: slow, obvious, in long double, sharing no code with the
 * library. It is read by public functions, and judged by the points that it was made of.
 *
 * It cannot judge which of two points that are equal but for rounding is the corner: hence the tolerance.
 */
#ifndef DPT_TESTS_ORACLE_HULL_H
#define DPT_TESTS_ORACLE_HULL_H

#include <stdint.h>

#include "dynpoint/hull.h"

enum { ORACLE_CORNERS = DPT_HULL_CORNERS_MAX, ORACLE_EDGES = 256, ORACLE_FACES = 160 };

/* A polyhedron as its public functions tell of it. */
struct oracle_hull {
    uint32_t corner_count, edge_count, face_count;
    double corner[ORACLE_CORNERS][3];
    uint32_t edge[ORACLE_EDGES][2];
    uint32_t side_count[ORACLE_FACES];
    uint32_t side[ORACLE_FACES][ORACLE_CORNERS];
};

/* Returns NULL, or what could not be read. */
const char *oracle_hull_read(const dpt_hull *hull, struct oracle_hull *out);

/* The same with its corners in other places. */
void oracle_hull_at(const struct oracle_hull *hull, const double *corners, struct oracle_hull *out);

/*
 * NULL if it is the convex hull of the points, or what it lacks. tolerance: m, by so much points may lie beyond a face,
 * a face's corners out of its plane, and a point that is no corner out of the hull of the others.
 */
const char *oracle_hull_fault(const struct oracle_hull *hull, const double *points, uint32_t count, double tolerance);

/* m: how far point `which` is from the convex hull of the others; points that are equal to it do not count. */
double oracle_hull_juts(const double *points, uint32_t count, uint32_t which);

/*
 * The least distance from a triangle over all pairs of features: corners against the triangle, the triangle's corners
 * against faces, edges against edges; 0 where an edge of one passes through a face of the other, or the triangle lies
 * inside. It trusts the faces to be flat; oracle_hull_triangle (hull_distance.h) needs none.
 */
double oracle_hull_by_features(const struct oracle_hull *hull, const double triangle[9]);

#endif
