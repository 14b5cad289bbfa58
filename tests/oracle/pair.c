/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The two oracles of pair.h. Nothing here is fast or clever; each step is one that a reader can
 * check against the definition.
 */
#include "oracle/pair.h"

#include <math.h>
#include <string.h>

/* Search: long double, golden section. */

static long double dot(const long double a[3], const long double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* out = a - f b; out may be a. */
static void take(long double out[3], const long double a[3], long double f, const long double b[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = a[k] - f * b[k];
}

/*
 * A triangle in its own plane: base from (0, 0) to (length, 0), the longest edge, so that the foot
 * of the apex lies on it. All positions are relative to the base's first corner, where differences
 * of doubles are exact or nearly so, and an offset of the whole scene costs nothing.
 */
struct plane {
    double origin[3];
    long double corner[3][3]; /* base, base, apex */
    long double axis[3], across[3], normal[3];
    long double length;
    long double foot, height; /* of the apex; height 0: not wider than rounding, no inside */
};

static void relative(long double out[3], const double point[3], const double origin[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = (long double)point[k] - origin[k];
}

static void plane_of(struct plane *plane, const double triangle[9])
{
    int longest = 0;
    long double square = -1;
    for (int i = 0; i < 3; i++) {
        long double edge[3];
        relative(edge, triangle + 3 * ((i + 1) % 3), triangle + 3 * i);
        if (dot(edge, edge) > square) {
            square = dot(edge, edge);
            longest = i;
        }
    }
    memcpy(plane->origin, triangle + 3 * longest, sizeof plane->origin);
    for (int i = 0; i < 3; i++)
        relative(plane->corner[i], triangle + 3 * ((longest + i) % 3), plane->origin);

    plane->length = sqrtl(square);
    plane->foot = plane->height = 0;
    if (!(square > 0))
        return;
    for (int k = 0; k < 3; k++)
        plane->axis[k] = plane->corner[1][k] / plane->length;

    /* Once leaves what rounding put along the axis, which is all there is in a thin triangle. */
    long double up[3];
    memcpy(up, plane->corner[2], sizeof up);
    for (int pass = 0; pass < 3; pass++) {
        const long double along = dot(up, plane->axis);
        plane->foot += along;
        take(up, up, along, plane->axis);
    }
    const long double height = sqrtl(dot(up, up));
    if (!(height > 0x1p-62L * plane->length))
        return;
    plane->height = height;
    for (int k = 0; k < 3; k++)
        plane->across[k] = up[k] / height;
    /* Lengths of a thin triangle are small against its errors: the basis must not inherit them. */
    take(plane->across, plane->across, dot(plane->across, plane->axis), plane->axis);
    const long double unit = sqrtl(dot(plane->across, plane->across));
    for (int k = 0; k < 3; k++)
        plane->across[k] /= unit;
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        plane->normal[k] = plane->axis[i] * plane->across[j] - plane->axis[j] * plane->across[i];
    }
}

/* The squared distance of x to the segment from `from` to `to`. */
static long double edge_square(const long double x[3], const long double from[3], const long double to[3])
{
    long double edge[3], away[3];
    take(edge, to, 1, from);
    take(away, x, 1, from);
    const long double square = dot(edge, edge);
    long double t = square > 0 ? dot(away, edge) / square : 0;
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    take(away, away, t, edge);
    return dot(away, away);
}

/* Does the point (u, v) of the plane lie within the triangle? */
static int holds(const struct plane *plane, long double u, long double v)
{
    if (!(v >= 0 && u >= 0 && u <= plane->length))
        return 0;
    if (u <= plane->foot)
        return v * plane->foot <= u * plane->height;
    return v * (plane->length - plane->foot) <= (plane->length - u) * plane->height;
}

/* The squared distance of x, relative to the origin, to the triangle. */
static long double point_square(const struct plane *plane, const long double x[3])
{
    if (plane->height > 0 && holds(plane, dot(x, plane->axis), dot(x, plane->across))) {
        const long double w = dot(x, plane->normal);
        return w * w;
    }
    long double least = edge_square(x, plane->corner[0], plane->corner[1]);
    for (int i = 1; i < 3; i++) {
        const long double other = edge_square(x, plane->corner[i], plane->corner[(i + 1) % 3]);
        least = other < least ? other : least;
    }
    return least;
}

long double oracle_point(const double point[3], const double triangle[9])
{
    struct plane plane;
    long double x[3];
    plane_of(&plane, triangle);
    relative(x, point, plane.origin);
    return sqrtl(point_square(&plane, x));
}

/* The search's state: the best value that was seen anywhere is the answer. */
struct search {
    struct plane plane;
    long double a[3], along[3], least;
};

static long double square_at(struct search *search, long double s)
{
    long double x[3];
    take(x, search->a, -s, search->along);
    const long double square = point_square(&search->plane, x);
    if (square < search->least)
        search->least = square;
    return square;
}

long double oracle_pair(const double segment[6], const double triangle[9])
{
    const long double golden = 0.618033988749894848204586834365638118L;
    struct search search;
    plane_of(&search.plane, triangle);
    relative(search.a, segment, search.plane.origin);
    relative(search.along, segment + 3, segment);
    search.least = INFINITY;
    square_at(&search, 0);
    square_at(&search, 1);

    long double low = 0, high = 1;
    long double left = 1 - golden, right = golden;
    long double at_left = square_at(&search, left), at_right = square_at(&search, right);
    /* The order of the four breaks where the interval comes down to rounding. */
    while (high - low > 0x1p-70L && low < left && left < right && right < high && search.least > 0) {
        if (at_left <= at_right) {
            high = right;
            right = left;
            at_right = at_left;
            left = high - golden * (high - low);
            at_left = square_at(&search, left);
        } else {
            low = left;
            left = right;
            at_left = at_right;
            right = low + golden * (high - low);
            at_right = square_at(&search, right);
        }
    }
    return sqrtl(search.least);
}

/* Bracket: 113 bits, all subsets. */

static oracle_wide wide_dot(const oracle_wide a[3], const oracle_wide b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Two steps of Newton from 64 (or 53) bits; no library of wide functions is needed. */
static oracle_wide wide_sqrt(oracle_wide x)
{
    if (!(x > 0))
        return 0;
    oracle_wide root = sqrtl((long double)x);
    for (int step = 0; step < 2 && root > 0; step++)
        root = (root + x / root) / 2;
    return root;
}

/* Takes from x its part along each of the first n unit vectors; adds what was taken to part[]. */
static void project_out(oracle_wide x[3], oracle_wide unit[3][3], int n, oracle_wide part[3])
{
    /* Twice, since once leaves an error as large as the part that was taken. */
    for (int pass = 0; pass < 2; pass++)
        for (int i = 0; i < n; i++) {
            const oracle_wide f = wide_dot(x, unit[i]);
            part[i] += f;
            for (int k = 0; k < 3; k++)
                x[k] -= f * unit[i][k];
        }
}

struct bracket {
    oracle_wide point[6][3]; /* corner - end */
    oracle_wide scale;       /* the largest |component| of them */
    oracle_wide lower, upper;
};

/* Any direction bounds the distance from below. */
static void bound_below(struct bracket *bracket, const oracle_wide direction[3])
{
    const oracle_wide length = wide_sqrt(wide_dot(direction, direction));
    if (!(length > 0x1p-100 * bracket->scale))
        return;
    oracle_wide least = wide_dot(direction, bracket->point[0]);
    for (int i = 1; i < 6; i++) {
        const oracle_wide other = wide_dot(direction, bracket->point[i]);
        least = other < least ? other : least;
    }
    if (least / length > bracket->lower)
        bracket->lower = least / length;
}

/* Any convex combination bounds it from above; weights that came out negative are put to 0. */
static void bound_above(struct bracket *bracket, const int *subset, const oracle_wide *weight, int n)
{
    oracle_wide sum = 0, point[3] = { 0, 0, 0 };
    for (int i = 0; i < n; i++)
        if (weight[i] > 0) {
            sum += weight[i];
            for (int k = 0; k < 3; k++)
                point[k] += weight[i] * bracket->point[subset[i]][k];
        }
    if (!(sum > 0))
        return;
    const oracle_wide length = wide_sqrt(wide_dot(point, point)) / sum;
    if (length < bracket->upper)
        bracket->upper = length;
}

/* What the point of the subset's affine hull that is nearest to the origin has to say. */
static void try_subset(struct bracket *bracket, const int *subset, int n)
{
    oracle_wide unit[3][3], r[3][3] = { { 0 } }, weight[4] = { 0, 0, 0, 0 }, part[3] = { 0, 0, 0 };
    for (int i = 0; i < n - 1; i++) {
        oracle_wide x[3];
        for (int k = 0; k < 3; k++)
            x[k] = bracket->point[subset[i + 1]][k] - bracket->point[subset[0]][k];
        project_out(x, unit, i, r[i]);
        r[i][i] = wide_sqrt(wide_dot(x, x));
        /* Dependent points: a smaller subset has the same hull. */
        if (!(r[i][i] > 0x1p-104 * bracket->scale))
            return;
        for (int k = 0; k < 3; k++)
            unit[i][k] = x[k] / r[i][i];
    }
    oracle_wide nearest[3];
    memcpy(nearest, bracket->point[subset[0]], sizeof nearest);
    project_out(nearest, unit, n - 1, part);
    bound_below(bracket, nearest);

    weight[0] = 1;
    for (int i = n - 2; i >= 0; i--) {
        oracle_wide rest = -part[i];
        for (int j = i + 1; j < n - 1; j++)
            rest -= r[j][i] * weight[j + 1];
        weight[i + 1] = rest / r[i][i];
        weight[0] -= weight[i + 1];
    }
    bound_above(bracket, subset, weight, n);
}

void oracle_bracket(const double segment[6], const double triangle[9], oracle_wide *lower, oracle_wide *upper)
{
    struct bracket bracket = { .scale = 0, .lower = 0, .upper = INFINITY };
    for (int i = 0; i < 6; i++)
        for (int k = 0; k < 3; k++) {
            const oracle_wide x = (oracle_wide)triangle[3 * (i / 2) + k] - (oracle_wide)segment[3 * (i % 2) + k];
            bracket.point[i][k] = x;
            const oracle_wide size = x < 0 ? -x : x;
            bracket.scale = size > bracket.scale ? size : bracket.scale;
        }
    for (int mask = 1; mask < 64; mask++) {
        int subset[6], n = 0;
        for (int i = 0; i < 6; i++)
            if (mask >> i & 1)
                subset[n++] = i;
        if (n <= 4)
            try_subset(&bracket, subset, n);
    }
    *lower = bracket.lower;
    *upper = bracket.upper;
}
