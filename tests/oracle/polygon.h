/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * For the oracles of convex polyhedra: points, segments and flat convex polygons in long double, each distance between
 * two points that exist.
 */
#ifndef DPT_TESTS_ORACLE_POLYGON_H
#define DPT_TESTS_ORACLE_POLYGON_H

#include <math.h>
#include <stdint.h>

#include "dynpoint/hull.h"

typedef long double wide;

static inline wide dot(const wide a[3], const wide b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline wide size_of(const wide a[3])
{
    return sqrtl(dot(a, a));
}

static inline void cross(wide out[3], const wide a[3], const wide b[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

/* out = a - b */
static inline void less(wide out[3], const wide a[3], const wide b[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = a[k] - b[k];
}

static inline void widen(wide out[3], const double a[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = a[k];
}

static inline wide clamp(wide t)
{
    return t > 1 ? 1 : t > 0 ? t : 0;
}

/* x - (a + t (b - a)), t for the nearest point of the segment. */
static inline wide point_segment(const wide x[3], const wide a[3], const wide b[3])
{
    wide e[3], r[3];
    less(e, b, a);
    less(r, x, a);
    const wide t = dot(e, e) > 0 ? clamp(dot(r, e) / dot(e, e)) : 0;
    for (int k = 0; k < 3; k++)
        r[k] -= t * e[k];
    return size_of(r);
}

/* Alternately nearest on the one and on the other, from both ends and from where the lines are nearest. */
static inline wide segment_segment(const wide a[3], const wide b[3], const wide c[3], const wide d[3])
{
    wide u[3], v[3], n[3], r[3], turned[3], p[3];
    less(u, b, a);
    less(v, d, c);
    less(r, c, a);
    cross(n, u, v);
    wide least = fminl(fminl(point_segment(a, c, d), point_segment(b, c, d)),
                       fminl(point_segment(c, a, b), point_segment(d, a, b)));
    if (!(dot(n, n) > 0))
        return least;
    cross(turned, r, v);
    const wide s = clamp(dot(turned, n) / dot(n, n));
    for (int k = 0; k < 3; k++)
        p[k] = a[k] + s * u[k];
    return fminl(least, point_segment(p, c, d));
}

/* A polygon, its corners in order. */
struct polygon {
    uint32_t count;
    wide corner[DPT_HULL_CORNERS_MAX][3];
    wide normal[3]; /* unit, or 0 */
};

/* The sum of all triangles from its first corner: right for any polygon that is flat. */
static inline void polygon_set_normal(struct polygon *polygon)
{
    wide n[3] = { 0, 0, 0 };
    for (uint32_t i = 1; i + 1 < polygon->count; i++) {
        wide e[3], f[3], part[3];
        less(e, polygon->corner[i], polygon->corner[0]);
        less(f, polygon->corner[i + 1], polygon->corner[0]);
        cross(part, e, f);
        for (int k = 0; k < 3; k++)
            n[k] += part[k];
    }
    const wide size = size_of(n);
    for (int k = 0; k < 3; k++)
        polygon->normal[k] = size > 0 ? n[k] / size : 0;
}

static inline wide height_over(const struct polygon *polygon, const wide x[3])
{
    wide r[3];
    less(r, x, polygon->corner[0]);
    return dot(r, polygon->normal);
}

/* How far x lies inside the side from corner i, seen along the normal. */
static inline wide inside_side(const struct polygon *polygon, uint32_t i, const wide x[3])
{
    wide e[3], r[3], in[3];
    less(e, polygon->corner[(i + 1) % polygon->count], polygon->corner[i]);
    less(r, x, polygon->corner[i]);
    cross(in, polygon->normal, e);
    const wide size = size_of(in);
    return size > 0 ? dot(in, r) / size : 0;
}

static inline int is_over(const struct polygon *polygon, const wide x[3])
{
    int over = size_of(polygon->normal) > 0;
    for (uint32_t i = 0; i < polygon->count; i++)
        over &= inside_side(polygon, i, x) >= 0;
    return over;
}

static inline wide point_polygon(const wide x[3], const struct polygon *polygon)
{
    wide least = INFINITY;
    for (uint32_t i = 0; i < polygon->count; i++)
        least = fminl(least, point_segment(x, polygon->corner[i], polygon->corner[(i + 1) % polygon->count]));
    return is_over(polygon, x) ? fminl(least, fabsl(height_over(polygon, x))) : least;
}

/* Whether a segment passes through a polygon, from one side to the other. */
static inline int passes(const wide a[3], const wide b[3], const struct polygon *polygon)
{
    const wide ha = height_over(polygon, a), hb = height_over(polygon, b);
    if (!((ha < 0 && hb > 0) || (ha > 0 && hb < 0)))
        return 0;
    wide x[3];
    for (int k = 0; k < 3; k++)
        x[k] = a[k] + ha / (ha - hb) * (b[k] - a[k]);
    return is_over(polygon, x);
}

#endif
