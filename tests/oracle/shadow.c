/* SPDX-License-Identifier: BSD-3-Clause */
/* The shadows of shadow.h. */
#include "oracle/shadow.h"

#include <math.h>
#include <string.h>

static long double dot(const long double a[3], const long double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const long double a[3], const long double b[3], long double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static long double unit(long double v[3])
{
    const long double length = sqrtl(dot(v, v));
    for (int k = 0; k < 3; k++)
        v[k] /= length;
    return length;
}

/* Any vector across d: d with the axis in which it is shortest. */
static void any_across(const long double d[3], long double e[3])
{
    long double axis[3] = { 0, 0, 0 };
    int least = 0;
    for (int k = 1; k < 3; k++)
        least = fabsl(d[k]) < fabsl(d[least]) ? k : least;
    axis[least] = 1;
    cross(d, axis, e);
    unit(e);
}

void oracle_shadow_make(struct oracle_shadow *shadow, const double ends[6], double reach, const double direction[3],
                        double depth, double scene, double extent)
{
    struct oracle_shadow *s = shadow;
    for (int k = 0; k < 3; k++) {
        s->a[k] = ends[k];
        s->u[k] = (long double)ends[3 + k] - ends[k];
        s->d[k] = direction[k];
    }
    unit(s->d);
    const long double length = sqrtl(dot(s->u, s->u)), along = dot(s->u, s->d);
    for (int k = 0; k < 3; k++)
        s->e[k] = s->u[k] - along * s->d[k];
    const long double part = sqrtl(dot(s->e, s->e));
    s->eps = 1e-9L * scene;
    s->sure_reach = s->maybe_reach = reach;
    s->depth = depth;
    s->any = !(part > 2e-9L * length);
    if (s->any) {
        any_across(s->d, s->e);
        s->sure_reach /= sqrtl(2);
        s->maybe_reach *= sqrtl(2);
    } else {
        unit(s->e);
        s->eps += 1e-15L * extent / part * reach;
    }
    cross(s->d, s->e, s->w);
    memcpy(s->across, s->e, sizeof s->across);
    if (length > 0) {
        cross(s->w, s->u, s->across);
        unit(s->across);
    }
}

/* To the t of low..high where |offset - t slope| <= half. */
static void narrow(long double offset, long double slope, long double half, long double *low, long double *high)
{
    if (half < 0 || (slope == 0 && fabsl(offset) > half))
        *low = INFINITY;
    if (half < 0 || slope == 0)
        return;
    const long double one = (offset - half) / slope, other = (offset + half) / slope;
    *low = fmaxl(*low, fminl(one, other));
    *high = fminl(*high, fmaxl(one, other));
}

static int is_within(const struct oracle_shadow *s, const long double x[3], long double slack)
{
    long double v[3], low = 0, high = 1;
    for (int k = 0; k < 3; k++)
        v[k] = x[k] - s->a[k];
    narrow(dot(v, s->e), dot(s->u, s->e), s->maybe_reach + slack, &low, &high);
    narrow(dot(v, s->w), 0, s->maybe_reach + slack, &low, &high);
    narrow(dot(v, s->d), dot(s->u, s->d), s->depth + slack, &low, &high);
    return low <= high;
}

long double oracle_shadow_excess(const struct oracle_shadow *shadow, const long double x[3])
{
    long double low = -shadow->maybe_reach - shadow->depth, high = 1;
    while (!is_within(shadow, x, high))
        high *= 2;
    for (int i = 0; i < 80; i++) {
        const long double middle = (low + high) / 2;
        if (is_within(shadow, x, middle))
            high = middle;
        else
            low = middle;
    }
    return high;
}

enum { MOST = 32 }; /* a triangle that eight planes have cut has 11; an edge's cuts count twice */

struct polygon {
    int count;
    long double corner[MOST][3];
};

static void add(struct polygon *polygon, const long double x[3])
{
    if (polygon->count < MOST)
        memcpy(polygon->corner[polygon->count++], x, sizeof polygon->corner[0]);
}

/* What is left of it where n x <= most. */
static void cut(struct polygon *polygon, const long double n[3], long double most)
{
    struct polygon left = { .count = 0 };
    for (int i = 0; i < polygon->count; i++) {
        const long double *from = polygon->corner[i];
        const long double *to = polygon->corner[(i + 1) % polygon->count];
        const long double above = dot(n, from) - most, next = dot(n, to) - most;
        if (above <= 0)
            add(&left, from);
        if ((above < 0 && next > 0) || (above > 0 && next < 0)) {
            long double x[3];
            for (int k = 0; k < 3; k++)
                x[k] = from[k] + above / (above - next) * (to[k] - from[k]);
            add(&left, x);
        }
    }
    *polygon = left;
}

/* The slab i of a shadow, as offsets from A along its normal. */
static void slab(const struct oracle_shadow *s, int i, long double reach, const long double **normal, long double *low,
                 long double *high)
{
    const long double *normals[4] = { s->d, s->w, s->e, s->across };
    const long double *n = normals[i];
    const long double end = dot(n, s->u);
    const long double half = reach * (fabsl(dot(n, s->e)) + fabsl(dot(n, s->w))) + s->depth * fabsl(dot(n, s->d));
    *normal = n;
    *low = fminl(0, end) - half;
    *high = fmaxl(0, end) + half;
}

/* Cut by the four slabs, grown by so much, of a shadow moved by `by`; relative to A. */
static int cut_by_shadow(const struct oracle_shadow *s, struct polygon *polygon, long double reach, long double grow,
                         const long double by[3])
{
    for (int i = 0; i < 4 && polygon->count; i++) {
        const long double *n;
        long double low, high;
        slab(s, i, reach, &n, &low, &high);
        const long double other[3] = { -n[0], -n[1], -n[2] }, moved = dot(n, by);
        cut(polygon, n, high + moved + grow);
        cut(polygon, other, -(low + moved - grow));
    }
    return polygon->count;
}

/* Where the corners alone tell: one is well within all slabs, or all are well beyond one; -1 where they do not. */
static int by_corners(const struct oracle_shadow *s, const struct polygon *polygon)
{
    unsigned within = (1u << polygon->count) - 1;
    for (int i = 0; i < 4; i++) {
        const long double *n;
        long double low, high, sure_low, sure_high;
        unsigned below = 0, above = 0;
        slab(s, i, s->maybe_reach, &n, &low, &high);
        slab(s, i, s->sure_reach, &n, &sure_low, &sure_high);
        for (int c = 0; c < polygon->count; c++) {
            const long double at = dot(n, polygon->corner[c]);
            below += at < low - 2 * s->eps;
            above += at > high + 2 * s->eps;
            if (!(at > sure_low + 2 * s->eps && at < sure_high - 2 * s->eps))
                within &= ~(1u << c);
        }
        if (below == (unsigned)polygon->count || above == (unsigned)polygon->count)
            return ORACLE_OUT;
    }
    return within ? ORACLE_SURE : -1;
}

static void take_witness(const struct oracle_shadow *s, const struct polygon *polygon, long double witness[3])
{
    for (int k = 0; k < 3 && witness; k++) {
        witness[k] = s->a[k];
        for (int i = 0; i < polygon->count; i++)
            witness[k] += polygon->corner[i][k] / polygon->count;
    }
}

int oracle_shadow_meets(const struct oracle_shadow *shadow, const long double (*corners)[3], int count,
                        long double witness[3])
{
    static const long double nowhere[3] = { 0, 0, 0 };
    const long double *ways[3] = { shadow->e, shadow->w, shadow->d };
    struct polygon whole = { .count = count }, left;
    for (int i = 0; i < count; i++)
        for (int k = 0; k < 3; k++)
            whole.corner[i][k] = corners[i][k] - shadow->a[k];
    if (!witness && by_corners(shadow, &whole) >= 0)
        return by_corners(shadow, &whole);
    left = whole;
    if (!cut_by_shadow(shadow, &left, shadow->maybe_reach, shadow->eps, nowhere))
        return ORACLE_OUT;
    take_witness(shadow, &left, witness);
    for (int i = 0; i < 6; i++) {
        long double by[3];
        for (int k = 0; k < 3; k++)
            by[k] = (i % 2 ? -1 : 1) * shadow->eps * ways[i / 2][k];
        left = whole;
        if (!cut_by_shadow(shadow, &left, shadow->sure_reach, 1e-6L * shadow->eps, by))
            return ORACLE_MAYBE;
    }
    return ORACLE_SURE;
}

static int meets(const struct oracle_sheet *sheet, const struct oracle_shadow *shadow, const uint32_t *vertices,
                 int count)
{
    long double corners[3][3];
    for (int i = 0; i < count; i++)
        memcpy(corners[i], sheet->place[vertices[i]], sizeof corners[i]);
    return oracle_shadow_meets(shadow, (const long double(*)[3])corners, count, NULL);
}

/* Of verdict `least` at least: over edges of that verdict. Returns how many, and the flags. */
static uint32_t spread(struct oracle_sheet *sheet, const struct oracle_shadow *shadow, uint32_t first, int least,
                       uint32_t *flags)
{
    const struct oracle_surface *surface = sheet->surface;
    uint32_t count = 0;
    *flags = 0;
    if (meets(sheet, shadow, surface->corner[first], 3) < least)
        return 0;
    sheet->in[first] = (unsigned char)least;
    sheet->queue[count++] = first;
    for (uint32_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            const uint32_t *c = surface->corner[sheet->queue[i]];
            const uint32_t edge[2] = { c[k], c[(k + 1) % 3] };
            if (meets(sheet, shadow, edge, 2) < least)
                continue;
            /* All that have the edge go behind those that are there, and the new ones of them stay. */
            const uint32_t *others = sheet->queue + count;
            const uint32_t all =
                oracle_surface_edge(surface, edge[0], edge[1], sheet->queue + count, surface->triangles);
            *flags |= all == 1 ? 1u : all > 2 ? 2u : 0u;
            for (uint32_t o = 0; o < all; o++) {
                const uint32_t t = others[o];
                if (sheet->in[t] >= least)
                    continue;
                sheet->in[t] = (unsigned char)least;
                sheet->queue[count++] = t;
            }
        }
    return count;
}

void oracle_sheet_find(struct oracle_sheet *sheet, const struct oracle_shadow *shadow, uint32_t first)
{
    memset(sheet->in, ORACLE_OUT, sheet->surface->triangles);
    sheet->maybe = spread(sheet, shadow, first, ORACLE_MAYBE, &sheet->maybe_flags);
    sheet->sure = spread(sheet, shadow, first, ORACLE_SURE, &sheet->sure_flags);
}

void oracle_sheet_loose(struct oracle_sheet *sheet, const struct oracle_shadow *shadow, uint32_t first)
{
    const struct oracle_surface *surface = sheet->surface;
    uint32_t count = 0;
    memset(sheet->in, ORACLE_OUT, surface->triangles);
    sheet->sure_flags = sheet->maybe_flags = 0;
    if (meets(sheet, shadow, surface->corner[first], 3) == ORACLE_SURE) {
        sheet->in[first] = ORACLE_SURE;
        sheet->queue[count++] = first;
    }
    for (uint32_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            const uint32_t v = surface->corner[sheet->queue[i]][k];
            for (uint32_t f = surface->first[v]; f < surface->first[v + 1]; f++) {
                const uint32_t t = surface->fan[f];
                if (sheet->in[t] || meets(sheet, shadow, surface->corner[t], 3) != ORACLE_SURE)
                    continue;
                sheet->in[t] = ORACLE_SURE;
                sheet->queue[count++] = t;
            }
        }
    sheet->sure = sheet->maybe = count;
}
