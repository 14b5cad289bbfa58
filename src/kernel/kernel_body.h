/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The loops of kernel_ops.h, written once for all instruction sets. The file that includes this defines
 *     KERNEL(name)                 the function's name
 *     KERNEL_TARGET                its target attribute, or nothing
 *     KERNEL_OPEN(bound, limit)    the lanes whose bound does not exceed the limit, as bits; optional
 *     KERNEL_TAKE(points, at, x, y, z)   the points of 16 nodes, in lanes; optional
 *     KERNEL_CORNERS(pulls, at, i, to)   the sum of what eight cells pull at a node; optional
 *     KERNEL_PUT(points, x, y, z)        the other way round, for 16 nodes that follow each other; optional
 *
 * The loops are straight-line code without calls, so that the compiler turns 16 iterations into vectors. No operation
 * may be fused or reordered, or the bits would differ from machine to machine.
 */
#include <math.h>
#include <string.h>

#include "kernel/kernel_ops.h"

/* NaN gives the limit: 0 / 0 stands for "anywhere". */
#define AT_LEAST(value, limit) ((value) > (limit) ? (value) : (limit))
#define AT_MOST(value, limit)  ((value) < (limit) ? (value) : (limit))
#define CLAMP(value, high)     AT_MOST(AT_LEAST(value, 0.0f), high)

/*
 * 1 / root; no number for a square that is too small: its root is not accurate enough for a direction of unit length.
 */
#define PER_ROOT(square) ((square) > 0x1p-100f ? 1.0f / sqrtf(square) : NAN)

/* Declares n0, n1, n2, for a name n: the dot products of a triangle's three corners with (x, y, z). */
#define CORNERS_ALONG(n, x, y, z)                                                                                      \
    float n##0 = x * block[i] + y * block[LANES + i] + z * block[2 * LANES + i];                                       \
    float n##1 = x * block[3 * LANES + i] + y * block[4 * LANES + i] + z * block[5 * LANES + i];                       \
    float n##2 = x * block[6 * LANES + i] + y * block[7 * LANES + i] + z * block[8 * LANES + i];

/* Each lane's bit. It is a table because not every instruction set can shift lanes by different amounts. */
static const uint32_t KERNEL(bit)[LANES] = {
    1u << 0, 1u << 1, 1u << 2,  1u << 3,  1u << 4,  1u << 5,  1u << 6,  1u << 7,
    1u << 8, 1u << 9, 1u << 10, 1u << 11, 1u << 12, 1u << 13, 1u << 14, 1u << 15,
};

/* The portable form. Some instruction sets have one instruction for it, but compilers do not find it in this loop. */
#ifndef KERNEL_OPEN
#define KERNEL_OPEN(bound, limit) KERNEL(open)(bound, limit)
KERNEL_TARGET static inline uint32_t KERNEL(open)(const float *bound, float limit)
{
    uint32_t open = 0;
    for (int i = 0; i < LANES; i++)
        open |= KERNEL(bit)[i] & (0u - (uint32_t) !(bound[i] > limit));
    return open;
}
#endif

/*
 * The bound of a cached plane at another pose; declares it as `value`. The point of the axis nearest to a point v of
 * the piece is at x.(v - a) along the axis, clamped to its ends. So it lies in the piece's own range from..to, and only
 * there must the axis be in front of the plane. When a long tool turns by an angle, its ends swing across the plane by
 * half the length times the angle; the part beside the piece hardly moves.
 */
#define LOCAL_BOUND(from, to)                                                                                          \
    float nx = planes->x[i], ny = planes->y[i], nz = planes->z[i];                                                     \
    float at_a = nx * ax + ny * ay + nz * az;                                                                          \
    float rise = nx * ux + ny * uy + nz * uz;                                                                          \
    float rise_from = CLAMP(from, length) * rise, rise_to = CLAMP(to, length) * rise;                                  \
    float value = planes->support[i] - at_a - AT_LEAST(rise_from, rise_to);

KERNEL_TARGET uint32_t KERNEL(cached_boxes)(const float *restrict block, const struct filter_segment *restrict segment,
                                            const struct planes *restrict planes, float *restrict bound)
{
    const float ax = segment->a[0], ay = segment->a[1], az = segment->a[2];
    const float ux = segment->x[0], uy = segment->x[1], uz = segment->x[2];
    const float wx = fabsf(ux), wy = fabsf(uy), wz = fabsf(uz);
    const float length = segment->length, limit = segment->limit;

    for (int i = 0; i < LANES; i++) {
        float dx = block[i] - ax, dy = block[LANES + i] - ay, dz = block[2 * LANES + i] - az;
        float s = dx * ux + dy * uy + dz * uz;
        float half = wx * block[3 * LANES + i] + wy * block[4 * LANES + i] + wz * block[5 * LANES + i];
        float from = s - half, to = s + half;
        LOCAL_BOUND(from, to)
        bound[i] = value;
    }
    return KERNEL_OPEN(bound, limit);
}

/* For a triangle a second plane is tried: the cached one turned parallel to the axis, with a support of its own. */
KERNEL_TARGET uint32_t KERNEL(cached_triangles)(const float *restrict block,
                                                const struct filter_segment *restrict segment,
                                                const struct planes *restrict planes, float *restrict bound)
{
    const float ax = segment->a[0], ay = segment->a[1], az = segment->a[2];
    const float ux = segment->x[0], uy = segment->x[1], uz = segment->x[2];
    const float length = segment->length, limit = segment->limit;
    const float at_0 = ax * ux + ay * uy + az * uz;

    for (int i = 0; i < LANES; i++) {
        CORNERS_ALONG(s, ux, uy, uz)
        float from = AT_MOST(AT_MOST(s0, s1), s2) - at_0;
        float to = AT_LEAST(AT_LEAST(s0, s1), s2) - at_0;
        LOCAL_BOUND(from, to)
        float tx = nx - rise * ux, ty = ny - rise * uy, tz = nz - rise * uz;
        CORNERS_ALONG(n, tx, ty, tz)
        float turned = AT_MOST(AT_MOST(n0, n1), n2) - (tx * ax + ty * ay + tz * az);
        value = AT_LEAST(value, turned);
        bound[i] = value;
    }
    return KERNEL_OPEN(bound, limit);
}

/* Store the plane (nx, ny, nz) with support `low` in lane i, and its bound. */
#define PUT_PLANE                                                                                                      \
    {                                                                                                                  \
        float at_a = nx * ax + ny * ay + nz * az;                                                                      \
        float at_b = nx * bx + ny * by + nz * bz;                                                                      \
        float value = low - AT_LEAST(at_a, at_b);                                                                      \
        planes->x[i] = nx;                                                                                             \
        planes->y[i] = ny;                                                                                             \
        planes->z[i] = nz;                                                                                             \
        planes->support[i] = low;                                                                                      \
        bound[i] = value;                                                                                              \
    }

/* The direction leads from the axis' point nearest to the box's centre to that centre. */
KERNEL_TARGET uint32_t KERNEL(boxes)(const float *restrict block, const struct filter_segment *restrict segment,
                                     struct planes *restrict planes, float *restrict bound)
{
    const float ax = segment->a[0], ay = segment->a[1], az = segment->a[2];
    const float bx = segment->b[0], by = segment->b[1], bz = segment->b[2];
    const float ux = segment->x[0], uy = segment->x[1], uz = segment->x[2];
    const float length = segment->length, limit = segment->limit;

    for (int i = 0; i < LANES; i++) {
        float cx = block[i], cy = block[LANES + i], cz = block[2 * LANES + i];
        float dx = cx - ax, dy = cy - ay, dz = cz - az;
        float s = dx * ux + dy * uy + dz * uz;
        s = CLAMP(s, length);
        float nx = dx - s * ux, ny = dy - s * uy, nz = dz - s * uz;
        float unit = PER_ROOT(nx * nx + ny * ny + nz * nz);
        nx *= unit;
        ny *= unit;
        nz *= unit;
        float low =
            nx * cx + ny * cy + nz * cz -
            (fabsf(nx) * block[3 * LANES + i] + fabsf(ny) * block[4 * LANES + i] + fabsf(nz) * block[5 * LANES + i]);
        PUT_PLANE
    }
    return KERNEL_OPEN(bound, limit);
}

/*
 * Test one edge, from p along e, against the segment 0..length on the x axis. If it is nearer than the edges before,
 * set (nx, ny, nz) to the shortest connection and min_square to its square. Beside the segment the distance is that to
 * the segment's line, which is two-dimensional; beyond an end it is that to the end.
 */
#define TRY_EDGE(px, py, pz, ex, ey, ez)                                                                               \
    {                                                                                                                  \
        float flat = ey * ey + ez * ez;                                                                                \
        float lean = -(py * ey + pz * ez);                                                                             \
        float t = CLAMP(lean / flat, 1.0f);                                                                            \
        float x = px + t * ex;                                                                                         \
        float end = CLAMP(x, length);                                                                                  \
        float t_end = CLAMP((lean + (end - px) * ex) / (flat + ex * ex), 1.0f);                                        \
        t = x == end ? t : t_end;                                                                                      \
        float qx = px + t * ex, qy = py + t * ey, qz = pz + t * ez;                                                    \
        qx = qx - CLAMP(qx, length);                                                                                   \
        float square = qx * qx + qy * qy + qz * qz;                                                                    \
        int nearer = square < min_square;                                                                              \
        min_square = nearer ? square : min_square;                                                                     \
        nx = nearer ? qx : nx;                                                                                         \
        ny = nearer ? qy : ny;                                                                                         \
        nz = nearer ? qz : nz;                                                                                         \
    }

/* f . ((p - s) x (q - s)) for the point s on the x axis: the sign says on which side of edge pq s projects. */
#define SIDE(px, py, pz, qx, qy, qz)                                                                                   \
    (fx * (py * qz - pz * qy) + fy * (pz * (qx - s) - (px - s) * qz) + fz * ((px - s) * qy - py * (qx - s)))

/*
 * Test one edge, from (p, q) along (e, f) in the plane across the axis. If it is nearer to the axis' line than the
 * edges before, set (y, z) to the shortest connection and min_square to its square.
 */
#define TRY_EDGE_BESIDE(p, q, e, f)                                                                                    \
    {                                                                                                                  \
        float t = CLAMP(-(p * e + q * f) / (e * e + f * f), 1.0f);                                                     \
        float py = p + t * e, pz = q + t * f, square = py * py + pz * pz;                                              \
        int nearer = square < min_square;                                                                              \
        min_square = nearer ? square : min_square;                                                                     \
        y = nearer ? py : y;                                                                                           \
        z = nearer ? pz : z;                                                                                           \
    }

/*
 * The loop `triangles` for a block whose triangles all lie between the axis' ends. There the axis can be replaced by
 * its line: the problem is two-dimensional, and a face is nearest only if the line crosses it.
 */
KERNEL_TARGET static uint32_t KERNEL(triangles_beside)(const float *restrict block,
                                                       const struct filter_segment *restrict segment,
                                                       struct planes *restrict planes, float *restrict bound)
{
    const float ax = segment->a[0], ay = segment->a[1], az = segment->a[2];
    const float bx = segment->b[0], by = segment->b[1], bz = segment->b[2];
    const float yx = segment->y[0], yy = segment->y[1], yz = segment->y[2];
    const float zx = segment->z[0], zy = segment->z[1], zz = segment->z[2];
    const float at_y = yx * ax + yy * ay + yz * az, at_z = zx * ax + zy * ay + zz * az;
    const float limit = segment->limit;

    for (int i = 0; i < LANES; i++) {
        CORNERS_ALONG(y, yx, yy, yz)
        CORNERS_ALONG(z, zx, zy, zz)
        float y = 0.0f, z = 0.0f, min_square = HUGE_VALF;
        y0 -= at_y, y1 -= at_y, y2 -= at_y;
        z0 -= at_z, z1 -= at_z, z2 -= at_z;
        TRY_EDGE_BESIDE(y0, z0, (y1 - y0), (z1 - z0))
        TRY_EDGE_BESIDE(y1, z1, (y2 - y1), (z2 - z1))
        TRY_EDGE_BESIDE(y2, z2, (y0 - y2), (z0 - z2))
        float unit = PER_ROOT(min_square);
        y *= unit;
        z *= unit;
        float nx = y * yx + z * zx, ny = y * yy + z * zy, nz = y * yz + z * zz;
        CORNERS_ALONG(n, nx, ny, nz)
        float low = AT_MOST(AT_MOST(n0, n1), n2);
        PUT_PLANE
    }
    return KERNEL_OPEN(bound, limit);
}

/* 1: all triangles of a block lie between the axis' ends. */
KERNEL_TARGET static int KERNEL(all_beside)(const float *restrict block, const struct filter_segment *restrict segment)
{
    const float xx = segment->x[0], xy = segment->x[1], xz = segment->x[2];
    const float at_x = xx * segment->a[0] + xy * segment->a[1] + xz * segment->a[2], length = segment->length;
    float to_end[LANES];

    for (int i = 0; i < LANES; i++) {
        CORNERS_ALONG(s, xx, xy, xz)
        float before = AT_MOST(AT_MOST(s0, s1), s2) - at_x;
        float behind = length + at_x - AT_LEAST(AT_LEAST(s0, s1), s2);
        to_end[i] = AT_MOST(before, behind);
    }
    return !KERNEL_OPEN(to_end, 0.0f);
}

/* Corner k of triangle i in the axis' frame, from its end a: (axk, ayk, azk). */
#define CORNER_FROM_AXIS(k)                                                                                            \
    const float dx##k = block[3 * k * LANES + i] - ax, dy##k = block[(3 * k + 1) * LANES + i] - ay;                    \
    const float dz##k = block[(3 * k + 2) * LANES + i] - az;                                                           \
    const float ax##k = dx##k * xx + dy##k * xy + dz##k * xz;                                                          \
    const float ay##k = dx##k * yx + dy##k * yy + dz##k * yz;                                                          \
    const float az##k = dx##k * zx + dy##k * zy + dz##k * zz;

/* The loop `triangles` for any block. */
KERNEL_TARGET static uint32_t KERNEL(triangles_anywhere)(const float *restrict block,
                                                         const struct filter_segment *restrict segment,
                                                         struct planes *restrict planes, float *restrict bound)
{
    const float ax = segment->a[0], ay = segment->a[1], az = segment->a[2];
    const float bx = segment->b[0], by = segment->b[1], bz = segment->b[2];
    const float xx = segment->x[0], xy = segment->x[1], xz = segment->x[2];
    const float yx = segment->y[0], yy = segment->y[1], yz = segment->y[2];
    const float zx = segment->z[0], zy = segment->z[1], zz = segment->z[2];
    const float length = segment->length, limit = segment->limit;

    for (int i = 0; i < LANES; i++) {
        CORNER_FROM_AXIS(0)
        CORNER_FROM_AXIS(1)
        CORNER_FROM_AXIS(2)
        float ex0 = ax1 - ax0, ey0 = ay1 - ay0, ez0 = az1 - az0;
        float ex1 = ax2 - ax1, ey1 = ay2 - ay1, ez1 = az2 - az1;
        float ex2 = ax0 - ax2, ey2 = ay0 - ay2, ez2 = az0 - az2;
        float nx = 0.0f, ny = 0.0f, nz = 0.0f, min_square = HUGE_VALF;
        TRY_EDGE(ax0, ay0, az0, ex0, ey0, ez0)
        TRY_EDGE(ax1, ay1, az1, ex1, ey1, ez1)
        TRY_EDGE(ax2, ay2, az2, ex2, ey2, ez2)

        /* The face is nearest if the axis' point nearest to its plane projects into it. */
        float fx = ey2 * ez0 - ez2 * ey0, fy = ez2 * ex0 - ex2 * ez0, fz = ex2 * ey0 - ey2 * ex0;
        float height = fx * ax0 + fy * ay0 + fz * az0;
        float s = CLAMP(height / fx, length);
        float above = height - fx * s;
        int inside = (SIDE(ax0, ay0, az0, ax1, ay1, az1) > 0.0f) & (SIDE(ax1, ay1, az1, ax2, ay2, az2) > 0.0f) &
                     (SIDE(ax2, ay2, az2, ax0, ay0, az0) > 0.0f);
        float sign = above < 0.0f ? -1.0f : 1.0f;
        nx = inside ? sign * fx : nx;
        ny = inside ? sign * fy : ny;
        nz = inside ? sign * fz : nz;

        /* Back into the filter's frame, in which planes are cached. */
        float unit = PER_ROOT(nx * nx + ny * ny + nz * nz);
        float tx = nx * unit, ty = ny * unit, tz = nz * unit;
        nx = tx * xx + ty * yx + tz * zx;
        ny = tx * xy + ty * yy + tz * zy;
        nz = tx * xz + ty * yz + tz * zz;
        CORNERS_ALONG(n, nx, ny, nz)
        float low = AT_MOST(AT_MOST(n0, n1), n2);
        PUT_PLANE
    }
    return KERNEL_OPEN(bound, limit);
}

KERNEL_TARGET uint32_t KERNEL(triangles)(const float *restrict block, const struct filter_segment *restrict segment,
                                         struct planes *restrict planes, float *restrict bound)
{
    return KERNEL(all_beside)(block, segment) ? KERNEL(triangles_beside)(block, segment, planes, bound)
                                              : KERNEL(triangles_anywhere)(block, segment, planes, bound);
}

/* A plane with a greater bound lasts longer. */
KERNEL_TARGET void KERNEL(better)(const struct planes *restrict made, const float *restrict made_bound,
                                  struct planes *restrict planes, float *restrict bound)
{
    for (int i = 0; i < LANES; i++) {
        int better = (made_bound[i] > bound[i]) | (bound[i] != bound[i]);
        planes->x[i] = better ? made->x[i] : planes->x[i];
        planes->y[i] = better ? made->y[i] : planes->y[i];
        planes->z[i] = better ? made->z[i] : planes->z[i];
        planes->support[i] = better ? made->support[i] : planes->support[i];
        bound[i] = better ? made_bound[i] : bound[i];
    }
}

KERNEL_TARGET uint32_t KERNEL(point_boxes)(const float *restrict block, const float *restrict at, float limit,
                                           float *restrict bound)
{
    const float ax = at[0], ay = at[1], az = at[2];

    for (int i = 0; i < LANES; i++) {
        float dx = AT_LEAST(fabsf(block[i] - ax) - block[3 * LANES + i], 0.0f);
        float dy = AT_LEAST(fabsf(block[LANES + i] - ay) - block[4 * LANES + i], 0.0f);
        float dz = AT_LEAST(fabsf(block[2 * LANES + i] - az) - block[5 * LANES + i], 0.0f);
        bound[i] = dx * dx + dy * dy + dz * dz;
    }
    return KERNEL_OPEN(bound, limit);
}

/*
 * Test one edge, from p along e, seen from the point. If it is nearer than the edges before, set (nx, ny, nz) to the
 * shortest connection and min_square to its square.
 */
#define TRY_POINT_EDGE(px, py, pz, ex, ey, ez)                                                                         \
    {                                                                                                                  \
        float lean = -(px * ex + py * ey + pz * ez);                                                                   \
        float t = CLAMP(lean / (ex * ex + ey * ey + ez * ez), 1.0f);                                                   \
        float qx = px + t * ex, qy = py + t * ey, qz = pz + t * ez;                                                    \
        float square = qx * qx + qy * qy + qz * qz;                                                                    \
        int nearer = square < min_square;                                                                              \
        min_square = nearer ? square : min_square;                                                                     \
        nx = nearer ? qx : nx;                                                                                         \
        ny = nearer ? qy : ny;                                                                                         \
        nz = nearer ? qz : nz;                                                                                         \
    }

/* f . (p x q): the sign says on which side of edge pq the point lies, seen along f. */
#define POINT_SIDE(px, py, pz, qx, qy, qz)                                                                             \
    (fx * (py * qz - pz * qy) + fy * (pz * qx - px * qz) + fz * (px * qy - py * qx))

/* n need not be of unit length, only long enough to divide by. A first pass tries the direction to the centroid. */
KERNEL_TARGET uint32_t KERNEL(point_triangles)(const float *restrict block, const float *restrict at, float limit,
                                               float *restrict bound)
{
    const float ax = at[0], ay = at[1], az = at[2];

    for (int i = 0; i < LANES; i++) {
        float ax0 = block[i] - ax, ay0 = block[LANES + i] - ay, az0 = block[2 * LANES + i] - az;
        float ax1 = block[3 * LANES + i] - ax, ay1 = block[4 * LANES + i] - ay;
        float az1 = block[5 * LANES + i] - az;
        float ax2 = block[6 * LANES + i] - ax, ay2 = block[7 * LANES + i] - ay;
        float az2 = block[8 * LANES + i] - az;
        float nx = ax0 + ax1 + ax2, ny = ay0 + ay1 + ay2, nz = az0 + az1 + az2;
        float n0 = nx * ax0 + ny * ay0 + nz * az0, n1 = nx * ax1 + ny * ay1 + nz * az1;
        float n2 = nx * ax2 + ny * ay2 + nz * az2;
        float low = AT_MOST(AT_MOST(n0, n1), n2);
        low = AT_LEAST(low, 0.0f);
        float square = nx * nx + ny * ny + nz * nz;
        bound[i] = low * low / (square > 0x1p-100f ? square : NAN);
    }
    if (!KERNEL_OPEN(bound, limit))
        return 0;
    for (int i = 0; i < LANES; i++) {
        float ax0 = block[i] - ax, ay0 = block[LANES + i] - ay, az0 = block[2 * LANES + i] - az;
        float ax1 = block[3 * LANES + i] - ax, ay1 = block[4 * LANES + i] - ay;
        float az1 = block[5 * LANES + i] - az;
        float ax2 = block[6 * LANES + i] - ax, ay2 = block[7 * LANES + i] - ay;
        float az2 = block[8 * LANES + i] - az;
        float ex0 = ax1 - ax0, ey0 = ay1 - ay0, ez0 = az1 - az0;
        float ex1 = ax2 - ax1, ey1 = ay2 - ay1, ez1 = az2 - az1;
        float ex2 = ax0 - ax2, ey2 = ay0 - ay2, ez2 = az0 - az2;
        float nx = 0.0f, ny = 0.0f, nz = 0.0f, min_square = HUGE_VALF;
        TRY_POINT_EDGE(ax0, ay0, az0, ex0, ey0, ez0)
        TRY_POINT_EDGE(ax1, ay1, az1, ex1, ey1, ez1)
        TRY_POINT_EDGE(ax2, ay2, az2, ex2, ey2, ez2)

        float fx = ey2 * ez0 - ez2 * ey0, fy = ez2 * ex0 - ex2 * ez0, fz = ex2 * ey0 - ey2 * ex0;
        int inside = (POINT_SIDE(ax0, ay0, az0, ax1, ay1, az1) > 0.0f) &
                     (POINT_SIDE(ax1, ay1, az1, ax2, ay2, az2) > 0.0f) &
                     (POINT_SIDE(ax2, ay2, az2, ax0, ay0, az0) > 0.0f);
        nx = inside ? fx : nx;
        ny = inside ? fy : ny;
        nz = inside ? fz : nz;

        float n0 = nx * ax0 + ny * ay0 + nz * az0, n1 = nx * ax1 + ny * ay1 + nz * az1;
        float n2 = nx * ax2 + ny * ay2 + nz * az2;
        float front = AT_MOST(AT_MOST(n0, n1), n2), back = AT_MOST(AT_MOST(-n0, -n1), -n2);
        float low = AT_LEAST(front, back);
        low = AT_LEAST(low, 0.0f);
        float square = nx * nx + ny * ny + nz * nz;
        bound[i] = low * low / (square > 0x1p-100f ? square : NAN);
    }
    return KERNEL_OPEN(bound, limit);
}

KERNEL_TARGET uint32_t KERNEL(common_boxes)(const float *restrict block, const float normal[3], float limit,
                                            float *restrict support)
{
    const float nx = normal[0], ny = normal[1], nz = normal[2];
    const float wx = fabsf(nx), wy = fabsf(ny), wz = fabsf(nz);

    for (int i = 0; i < LANES; i++) {
        float value = nx * block[i] + ny * block[LANES + i] + nz * block[2 * LANES + i] -
                      (wx * block[3 * LANES + i] + wy * block[4 * LANES + i] + wz * block[5 * LANES + i]);
        support[i] = value;
    }
    return KERNEL_OPEN(support, limit);
}

KERNEL_TARGET uint32_t KERNEL(common_triangles)(const float *restrict block, const float normal[3], float limit,
                                                float *restrict support)
{
    const float nx = normal[0], ny = normal[1], nz = normal[2];

    for (int i = 0; i < LANES; i++) {
        CORNERS_ALONG(n, nx, ny, nz)
        float value = AT_MOST(AT_MOST(n0, n1), n2);
        support[i] = value;
    }
    return KERNEL_OPEN(support, limit);
}

/* The box around a hull, as local numbers that stay in registers. */
#define HULL                                                                                                           \
    const float ox = hull->centre[0], oy = hull->centre[1], oz = hull->centre[2];                                      \
    const float xx = hull->axis[0][0], xy = hull->axis[0][1], xz = hull->axis[0][2];                                   \
    const float yx = hull->axis[1][0], yy = hull->axis[1][1], yz = hull->axis[1][2];                                   \
    const float zx = hull->axis[2][0], zy = hull->axis[2][1], zz = hull->axis[2][2];                                   \
    const float wx = hull->half[0], wy = hull->half[1], wz = hull->half[2];                                            \
    const float reach_a = hull->reach[0], reach_b = hull->reach[1];                                                    \
    const float limit = hull->limit;

/* Declares n, the unit direction from the nearest point of that box to (cx, cy, cz); no number inside the box. */
#define AWAY_FROM_HULL(cx, cy, cz)                                                                                     \
    float dx = (cx)-ox, dy = (cy)-oy, dz = (cz)-oz;                                                                    \
    float px = dx * xx + dy * xy + dz * xz;                                                                            \
    float py = dx * yx + dy * yy + dz * yz;                                                                            \
    float pz = dx * zx + dy * zy + dz * zz;                                                                            \
    px -= AT_MOST(AT_LEAST(px, -wx), wx);                                                                              \
    py -= AT_MOST(AT_LEAST(py, -wy), wy);                                                                              \
    pz -= AT_MOST(AT_LEAST(pz, -wz), wz);                                                                              \
    float nx = px * xx + py * yx + pz * zx;                                                                            \
    float ny = px * xy + py * yy + pz * zy;                                                                            \
    float nz = px * xz + py * yz + pz * zz;                                                                            \
    float unit = PER_ROOT(nx * nx + ny * ny + nz * nz);                                                                \
    nx *= unit;                                                                                                        \
    ny *= unit;                                                                                                        \
    nz *= unit;

/* ENDS_ALONG declares n_0 to n_3, for a name n: the dot products of the hull's four ends with (x, y, z). */
#define END_ALONG(e, x, y, z) ((x)*hull->end[e][0] + (y)*hull->end[e][1] + (z)*hull->end[e][2])
#define ENDS_ALONG(n, x, y, z)                                                                                         \
    float n##_0 = END_ALONG(0, x, y, z), n##_1 = END_ALONG(1, x, y, z);                                                \
    float n##_2 = END_ALONG(2, x, y, z), n##_3 = END_ALONG(3, x, y, z);

/*
 * The part of the axis that can come near a lane, `from` and `to` in s. What stays before or behind the lane's range
 * along the tool at both times is left out. Where the axis is not along the tool at both times, nothing is.
 */
#define PIECES                                                                                                         \
    ENDS_ALONG(x, xx, xy, xz)                                                                                          \
    const float first_length = x_1 - x_0, last_length = x_3 - x_2;                                                     \
    const int has_pieces = first_length > PIECE_AXIS_MIN && last_length > PIECE_AXIS_MIN;                              \
    const float per_first = has_pieces ? 1.0f / first_length : 0.0f;                                                   \
    const float per_last = has_pieces ? 1.0f / last_length : 0.0f;                                                     \
    const float beside = hull->beside, whole = has_pieces ? 0.0f : 1.0f;                                               \
    const float reach_rise = reach_b - reach_a;
#define PIECE_BESIDE(low, high)                                                                                        \
    const float before = (low)-beside, behind = (high) + beside;                                                       \
    float from = AT_MOST((before - x_0) * per_first, (before - x_2) * per_last) - whole;                               \
    float to = AT_LEAST((behind - x_0) * per_first, (behind - x_2) * per_last) + whole;                                \
    from = CLAMP(from, 1.0f);                                                                                          \
    to = CLAMP(to, 1.0f);                                                                                              \
    const float reach_from = reach_a + from * reach_rise, reach_to = reach_a + to * reach_rise;

/* The least and the greatest height of that part, grown by its reach, along a direction of ENDS_ALONG. */
#define AT_S(n, s, a, b) (n##_##a + (s) * (n##_##b - n##_##a))
#define LOWEST_END(n)                                                                                                  \
    AT_MOST(AT_MOST(AT_S(n, from, 0, 1), AT_S(n, from, 2, 3)) - reach_from,                                            \
            AT_MOST(AT_S(n, to, 0, 1), AT_S(n, to, 2, 3)) - reach_to)
#define HIGHEST_END(n)                                                                                                 \
    AT_LEAST(AT_LEAST(AT_S(n, from, 0, 1), AT_S(n, from, 2, 3)) + reach_from,                                          \
             AT_LEAST(AT_S(n, to, 0, 1), AT_S(n, to, 2, 3)) + reach_to)

/* A second plane is tried: across tool and motion. Most of what a sliding tool passes lies beyond it. */
KERNEL_TARGET uint32_t KERNEL(swept_boxes)(const float *restrict block, const struct swept_hull *restrict hull,
                                           float *restrict bound)
{
    HULL PIECES ENDS_ALONG(z, zx, zy, zz)

        for (int i = 0; i < LANES; i++)
    {
        float cx = block[i], cy = block[LANES + i], cz = block[2 * LANES + i];
        float hx = block[3 * LANES + i], hy = block[4 * LANES + i], hz = block[5 * LANES + i];
        float along = xx * cx + xy * cy + xz * cz;
        float half_along = fabsf(xx) * hx + fabsf(xy) * hy + fabsf(xz) * hz;
        PIECE_BESIDE(along - half_along, along + half_along)
        AWAY_FROM_HULL(cx, cy, cz)
        ENDS_ALONG(n, nx, ny, nz)
        float value = nx * cx + ny * cy + nz * cz - (fabsf(nx) * hx + fabsf(ny) * hy + fabsf(nz) * hz) - HIGHEST_END(n);
        float at = zx * cx + zy * cy + zz * cz;
        float half = fabsf(zx) * hx + fabsf(zy) * hy + fabsf(zz) * hz;
        float above = at - half - HIGHEST_END(z), below = LOWEST_END(z) - (at + half);
        float across = AT_LEAST(above, below);
        value = AT_LEAST(value, across);
        bound[i] = value;
    }
    return KERNEL_OPEN(bound, limit);
}

/* A third plane is tried: the triangle's own. */
KERNEL_TARGET uint32_t KERNEL(swept_triangles)(const float *restrict block, const struct swept_hull *restrict hull,
                                               float *restrict bound)
{
    const float third = 1.0f / 3.0f;
    HULL PIECES ENDS_ALONG(z, zx, zy, zz)

        for (int i = 0; i < LANES; i++)
    {
        float ax = block[i], ay = block[LANES + i], az = block[2 * LANES + i];
        float bx = block[3 * LANES + i], by = block[4 * LANES + i], bz = block[5 * LANES + i];
        float cx = block[6 * LANES + i], cy = block[7 * LANES + i], cz = block[8 * LANES + i];
        CORNERS_ALONG(x, xx, xy, xz)
        PIECE_BESIDE(AT_MOST(AT_MOST(x0, x1), x2), AT_LEAST(AT_LEAST(x0, x1), x2))
        AWAY_FROM_HULL((ax + bx + cx) * third, (ay + by + cy) * third, (az + bz + cz) * third)
        CORNERS_ALONG(n, nx, ny, nz)
        ENDS_ALONG(n, nx, ny, nz)
        float value = AT_MOST(AT_MOST(n0, n1), n2) - HIGHEST_END(n);

        CORNERS_ALONG(z, zx, zy, zz)
        float above = AT_MOST(AT_MOST(z0, z1), z2) - HIGHEST_END(z);
        float below = LOWEST_END(z) - AT_LEAST(AT_LEAST(z0, z1), z2);
        float across = AT_LEAST(above, below);

        float ex = bx - ax, ey = by - ay, ez = bz - az;
        float gx = cx - ax, gy = cy - ay, gz = cz - az;
        float fx = ey * gz - ez * gy, fy = ez * gx - ex * gz, fz = ex * gy - ey * gx;
        float flat = PER_ROOT(fx * fx + fy * fy + fz * fz);
        fx *= flat;
        fy *= flat;
        fz *= flat;
        CORNERS_ALONG(f, fx, fy, fz)
        ENDS_ALONG(f, fx, fy, fz)
        float front = AT_MOST(AT_MOST(f0, f1), f2) - HIGHEST_END(f);
        float back = LOWEST_END(f) - AT_LEAST(AT_LEAST(f0, f1), f2);
        float face = AT_LEAST(front, back);
        value = AT_LEAST(value, across);
        face = AT_LEAST(face, across);
        value = AT_LEAST(value, face);
        bound[i] = value;
    }
    return KERNEL_OPEN(bound, limit);
}

#include "kernel/kernel_springs.h"
#include "kernel/kernel_cells.h"
#include "kernel/kernel_vertices.h"
#include "kernel/kernel_winding.h"
