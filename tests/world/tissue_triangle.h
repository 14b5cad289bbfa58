/* SPDX-License-Identifier: BSD-3-Clause */
/* Triangles and segments of tissue: areas, weights, nearest points. */
#ifndef DPT_TESTS_TISSUE_TRIANGLE_H
#define DPT_TESTS_TISSUE_TRIANGLE_H

#include "lib/vector.h"

/* The vector area of a triangle, twice. */
static inline void area_of(const double *a, const double *b, const double *c, double area[3])
{
    double e[3], f[3];
    for (int k = 0; k < 3; k++) {
        e[k] = b[k] - a[k];
        f[k] = c[k] - a[k];
    }
    cross3(e, f, area);
}

/* Corners' weights at q, which is in the plane of the triangle, by areas. */
static inline void weights_at(const double q[3], double v[3][3], double weight[3])
{
    double normal[3], part[3];
    area_of(v[0], v[1], v[2], normal);
    for (int i = 0; i < 3; i++) {
        area_of(q, v[(i + 1) % 3], v[(i + 2) % 3], part);
        weight[i] = dot3(part, normal) / dot3(normal, normal);
    }
}

static inline void nearest_on_triangle(const double p[3], double v[3][3], double q[3])
{
    double e[3], f[3], w[3], best = HUGE_VAL;
    for (int k = 0; k < 3; k++) {
        e[k] = v[1][k] - v[0][k];
        f[k] = v[2][k] - v[0][k];
        w[k] = p[k] - v[0][k];
    }
    const double ee = dot3(e, e), ef = dot3(e, f), ff = dot3(f, f), we = dot3(w, e), wf = dot3(w, f);
    const double area = ee * ff - ef * ef, s = (ff * we - ef * wf) / area, t = (ee * wf - ef * we) / area;
    if (s >= 0.0 && t >= 0.0 && s + t <= 1.0) {
        for (int k = 0; k < 3; k++)
            q[k] = v[0][k] + s * e[k] + t * f[k];
        return;
    }
    for (int i = 0; i < 3; i++) {
        const double *a = v[i], *b = v[(i + 1) % 3];
        const double d[3] = { b[0] - a[0], b[1] - a[1], b[2] - a[2] },
                     to[3] = { p[0] - a[0], p[1] - a[1], p[2] - a[2] };
        const double along = fmin(fmax(dot3(to, d) / dot3(d, d), 0.0), 1.0);
        const double at[3] = { a[0] + along * d[0], a[1] + along * d[1], a[2] + along * d[2] };
        if (apart(at, p) < best) {
            best = apart(at, p);
            memcpy(q, at, sizeof at);
        }
    }
}

/* The nearest points of two segments, by leading one and the other there in turn. Returns whether both are inside theirs. */
static inline int nearest_of_segments(const double *a, const double *b, const double *c, const double *d, double p[3],
                                      double q[3])
{
    const double u[3] = { b[0] - a[0], b[1] - a[1], b[2] - a[2] }, v[3] = { d[0] - c[0], d[1] - c[1], d[2] - c[2] };
    const double w[3] = { a[0] - c[0], a[1] - c[1], a[2] - c[2] };
    const double uu = dot3(u, u), uv = dot3(u, v), vv = dot3(v, v), uw = dot3(u, w), vw = dot3(v, w);
    const double across = uu * vv - uv * uv;
    double s = across > 1e-14 * uu * vv ? (uv * vw - vv * uw) / across : 0.5;
    double t = fmin(fmax((vw + s * uv) / vv, 0.0), 1.0);
    s = (t * uv - uw) / uu;
    for (int k = 0; k < 3; k++) {
        p[k] = a[k] + s * u[k];
        q[k] = c[k] + t * v[k];
    }
    return s > 0.0 && s < 1.0;
}

#endif
