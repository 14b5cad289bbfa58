/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The interval of hull_distance.h. See there for what it may be trusted with.
 */
#include "oracle/hull_distance.h"

#include <string.h>

#include "oracle/polygon.h"

enum { STEPS = 400, KEPT = 4, NEAR_MAX = 16 };

struct search {
    const double *corners;
    uint32_t count;
    const double *triangle;
    wide kept[KEPT][3]; /* differences corner - point of the triangle */
    int kept_count;
    wide nearest[3]; /* of their convex hull to the origin */
    wide lower, upper;
    wide direction[3]; /* unit, of `lower` */
};

/* The difference that lies farthest against `way`; how far along it, unless `way` is 0. */
static void farthest_against(const struct search *search, const wide way[3], wide out[3])
{
    wide low = INFINITY, high = -INFINITY, a[3], b[3];
    for (uint32_t i = 0; i < search->count; i++) {
        wide x[3];
        widen(x, search->corners + 3 * i);
        if (dot(x, way) < low) {
            low = dot(x, way);
            memcpy(a, x, sizeof a);
        }
    }
    for (int i = 0; i < 3; i++) {
        wide x[3];
        widen(x, search->triangle + 3 * i);
        if (dot(x, way) > high) {
            high = dot(x, way);
            memcpy(b, x, sizeof b);
        }
    }
    less(out, a, b);
}

/*
 * The point of a simplex's plane, line or place of up to 3 more points that is nearest to the origin, if it lies in the
 * simplex: 1. It is at right angles to all edges but for a rounding of itself, not of the edges: so it is a good
 * direction however near it is.
 */
static int nearest_of_simplex(wide (*const *point)[3], int count, wide out[3])
{
    wide unit[3][3], rest[3][3] = { { 0 } }, part[3] = { 0, 0, 0 }, weight[4];
    for (int i = 0; i + 1 < count; i++) {
        less(unit[i], *point[i + 1], *point[0]);
        const wide whole = size_of(unit[i]);
        for (int pass = 0; pass < 3; pass++)
            for (int j = 0; j < i; j++) {
                const wide f = dot(unit[i], unit[j]);
                rest[i][j] += f;
                for (int k = 0; k < 3; k++)
                    unit[i][k] -= f * unit[j][k];
            }
        rest[i][i] = size_of(unit[i]);
        if (!(rest[i][i] > 1e-17L * whole))
            return 0;
        for (int k = 0; k < 3; k++)
            unit[i][k] /= rest[i][i];
    }
    memcpy(out, *point[0], 3 * sizeof *out);
    for (int pass = 0; pass < 3; pass++)
        for (int j = 0; j + 1 < count; j++) {
            const wide f = dot(out, unit[j]);
            part[j] -= f;
            for (int k = 0; k < 3; k++)
                out[k] -= f * unit[j][k];
        }
    weight[0] = 1;
    for (int i = count - 2; i >= 0; i--) {
        weight[i + 1] = part[i];
        for (int j = i + 1; j + 1 < count; j++)
            weight[i + 1] -= rest[j][i] * weight[j + 1];
        weight[i + 1] /= rest[i][i];
        weight[0] -= weight[i + 1];
    }
    for (int i = 0; i < count; i++)
        if (!(weight[i] >= 0))
            return 0;
    return 1;
}

/* Of all simplices of what is kept, keep the nearest. 0 if none is nearer than before. */
static int keep_nearest(struct search *search)
{
    const int count = search->kept_count;
    wide best = search->upper, at[3];
    int best_set = 0;
    for (int set = 1; set < 1 << count; set++) {
        wide(*point[KEPT])[3] = { &search->kept[0] };
        int chosen = 0;
        for (int i = 0; i < count; i++)
            if (set >> i & 1)
                point[chosen++] = &search->kept[i];
        if (!nearest_of_simplex((wide(*const *)[3])point, chosen, at))
            continue;
        /* A tetrahedron that holds the origin: what is left is rounding. */
        const wide distance = chosen == 4 ? 0 : size_of(at);
        if (distance < best) {
            best = distance;
            best_set = set;
            memcpy(search->nearest, at, sizeof at);
        }
    }
    if (!best_set)
        return 0;
    search->upper = best;
    search->kept_count = 0;
    for (int i = 0; i < count; i++)
        if (best_set >> i & 1)
            memcpy(search->kept[search->kept_count++], search->kept[i], sizeof search->kept[0]);
    return 1;
}

/* Any direction bounds the distance from below, by how far the nearest difference lies along it. */
static void bound_below(struct search *search, const wide way[3])
{
    wide nearest[3];
    const wide size = size_of(way);
    if (!(size > 0))
        return;
    farthest_against(search, way, nearest);
    const wide lower = dot(nearest, way) / size;
    for (int k = 0; k < 3 && lower > search->lower; k++)
        search->direction[k] = way[k] / size;
    search->lower = fmaxl(search->lower, lower);
}

static void bound_both_ways(struct search *search, const wide way[3])
{
    const wide back[3] = { -way[0], -way[1], -way[2] };
    bound_below(search, way);
    bound_below(search, back);
}

/* What a vector leads to besides, at right angles to e, as good as its own rounding allows. */
static void bound_beside(struct search *search, const wide way[3], const wide e[3])
{
    wide across[3] = { way[0], way[1], way[2] };
    for (int pass = 0; pass < 3 && dot(e, e) > 0; pass++) {
        const wide f = dot(across, e) / dot(e, e);
        for (int k = 0; k < 3; k++)
            across[k] -= f * e[k];
    }
    bound_both_ways(search, across);
}

/* The corners of the hull that are about as near to the triangle as the nearest one. */
static int find_near(const struct search *search, wide near[NEAR_MAX][3])
{
    wide least[3];
    int count = 0;
    farthest_against(search, search->nearest, least);
    for (uint32_t i = 0; i < search->count && count < NEAR_MAX; i++) {
        wide x[3], off[3], high = -INFINITY;
        widen(x, search->corners + 3 * i);
        for (int k = 0; k < 3; k++) {
            wide v[3];
            widen(v, search->triangle + 3 * k);
            high = fmaxl(high, dot(v, search->nearest));
            less(off, x, v);
        }
        const wide beyond = dot(x, search->nearest) - high - dot(least, search->nearest);
        if (beyond <= 1e-4L * size_of(search->nearest) * size_of(off))
            memcpy(near[count++], x, sizeof x);
    }
    return count;
}

/*
 * Where faces or edges are parallel but for rounding, the steps end before the interval is closed. Then all is tried
 * that the corners nearby make: every two of them are ends of a segment that lies in the hull, every three corners of a
 * triangle, and across each of these, and between each and the triangle, there is a direction.
 */
static void try_all_nearby(struct search *search)
{
    struct polygon flat = { .count = 3 }, part = { .count = 3 };
    wide near[NEAR_MAX][3], edge[3][3], e[3], way[3];
    const int count = find_near(search, near);
    for (int k = 0; k < 3; k++)
        widen(flat.corner[k], search->triangle + 3 * k);
    for (int k = 0; k < 3; k++)
        less(edge[k], flat.corner[(k + 1) % 3], flat.corner[k]);
    polygon_set_normal(&flat);
    bound_both_ways(search, flat.normal);
    for (int i = 0; i < count; i++) {
        search->upper = fminl(search->upper, point_polygon(near[i], &flat));
        for (int k = 0; k < 3; k++) {
            less(way, near[i], flat.corner[k]);
            bound_both_ways(search, way);
            bound_beside(search, way, edge[k]);
        }
        for (int j = 0; j < i; j++) {
            less(e, near[i], near[j]);
            for (int k = 0; k < 3; k++) {
                search->upper =
                    fminl(search->upper, segment_segment(near[i], near[j], flat.corner[k], flat.corner[(k + 1) % 3]));
                less(way, near[i], flat.corner[k]);
                bound_beside(search, way, e);
                cross(way, e, edge[k]);
                bound_both_ways(search, way);
            }
            for (int k = 0; k < j; k++) {
                memcpy(part.corner[0], near[i], sizeof near[i]);
                memcpy(part.corner[1], near[j], sizeof near[j]);
                memcpy(part.corner[2], near[k], sizeof near[k]);
                polygon_set_normal(&part);
                bound_both_ways(search, part.normal);
                for (int c = 0; c < 3; c++)
                    search->upper = fminl(search->upper, point_polygon(flat.corner[c], &part));
            }
        }
    }
}

static struct oracle_interval rounded(const struct search *search)
{
    struct oracle_interval interval = { (double)search->lower, (double)search->upper };
    if (interval.lower > search->lower)
        interval.lower = nextafter(interval.lower, 0.0);
    if (interval.upper < search->upper)
        interval.upper = nextafter(interval.upper, INFINITY);
    return interval;
}

struct oracle_interval oracle_hull_triangle(const double *corners, uint32_t count, const double triangle[9],
                                            double direction[3])
{
    struct search search = { .corners = corners, .count = count, .triangle = triangle, .upper = INFINITY };
    wide first[3] = { 0, 0, 0 }, next[3];
    for (uint32_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++)
            first[k] += corners[3 * i + (uint32_t)k] / (wide)count;
    for (int k = 0; k < 3; k++)
        first[k] -= ((wide)triangle[k] + triangle[3 + k] + triangle[6 + k]) / 3;
    farthest_against(&search, first, search.kept[0]);
    search.kept_count = 1;
    keep_nearest(&search);
    for (int step = 0; step < STEPS && search.upper > 0; step++) {
        farthest_against(&search, search.nearest, next);
        bound_below(&search, search.nearest);
        if (!(search.lower < search.upper) || search.kept_count == KEPT)
            break;
        memcpy(search.kept[search.kept_count++], next, sizeof next);
        if (!keep_nearest(&search))
            break;
    }
    if (search.upper - search.lower > 0x1p-56L * (search.upper + size_of(search.kept[0])))
        try_all_nearby(&search);
    if (search.lower > search.upper)
        search.lower = search.upper;
    for (int k = 0; k < 3 && direction; k++)
        direction[k] = (double)search.direction[k];
    return rounded(&search);
}
