/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Exact distance between one segment and one triangle, in double (docs/algorithms/distance.md).
 *
 * All points are in one frame, that of the triangle's mesh, in metres. The axis is a + s u with s in 0..1. The triangle
 * has corners v[0..2]; edge[k] leads from corner k to corner k + 1 (mod 3), and from[k] from corner k to a.
 *
 * Against the face only one point of the axis matters: the one nearest to the triangle's plane. If it projects into the
 * triangle, it belongs to the nearest pair: the distance is convex, and no motion along the axis or the face shortens
 * it. Otherwise the nearest pair lies on one of the three edges.
 *
 * Each candidate is a real pair of points, so no answer is below the true distance by more than rounding. A candidate
 * that degenerates (0 / 0) can only lose; it never wins wrongly.
 */
#ifndef DPT_SEGMENT_TRIANGLE_H
#define DPT_SEGMENT_TRIANGLE_H

#include "base/vec3.h"

/* A nearest pair: p = a + s u on the axis, q = the corners weighted by `weight` on the triangle. */
typedef struct pair {
    double distance2; /* squared distance, m^2 */
    double s;         /* of p, 0..1 */
    double weight[3]; /* barycentric, of the corners; exactly 0 if q lies on the opposite edge */
    vec3 gap;         /* p - q */
} pair;

/*
 * The nearest points a + s u of the axis and v + t e of an edge, s and t in 0..1. from_v is a - v; per_uu is 1 / u.u.
 * The angle enters through the cross product. The determinant of the normal equations has an error that grows with the
 * square of the inverse angle (tests/nearest/test_pair.c, nearly parallel families).
 */
static inline void segment_edge(vec3 u, double per_uu, vec3 from_v, vec3 e, double *s, double *t)
{
    vec3 n = cross(u, e);
    *s = clamp01(dot(cross(e, from_v), n) / dot(n, n));
    *t = clamp01(dot(along(from_v, *s, u), e) / dot(e, e));
    *s = clamp01(dot(sub(scaled(e, *t), from_v), u) * per_uu);
}

/* Replace `best` if the edge e from `corner` is nearer. Returns s of the nearest point to the edge, nearer or not. */
static inline double pair_try_edge(pair *best, vec3 u, double per_uu, vec3 from_v, vec3 e, int corner)
{
    double s, t;
    segment_edge(u, per_uu, from_v, e, &s, &t);
    vec3 gap = sub(along(from_v, s, u), scaled(e, t));
    double distance2 = dot(gap, gap);
    if (distance2 < best->distance2) {
        best->distance2 = distance2;
        best->s = s;
        best->gap = gap;
        best->weight[corner] = 1.0 - t;
        best->weight[(corner + 1) % 3] = t;
        best->weight[(corner + 2) % 3] = 0.0;
    }
    return s;
}

/*
 * A triangle's own frame. x is the longer of two edges, from `corner`; so it is at least half as long as the longest
 * edge. y is orthogonal to x, and the third corner lies at apex x + y from `corner`. z = x cross y.
 *
 * Using these orthogonal axes amounts to moving the corners by a few roundings of the edge's length, however thin the
 * triangle is. A normal made from two edges is not that accurate (tests/nearest/test_pair.c, slivers).
 */
typedef struct triangle_frame {
    int corner;            /* the origin, 0..2 */
    vec3 x, y, z;          /* not of unit length */
    double per_xx, per_yy; /* 1 / x.x, 1 / y.y */
    double apex;
} triangle_frame;

/* Returns 0 if the triangle is thinner than rounding or than 1e-60 m: then it has edges but no face. */
static inline int triangle_frame_set(const vec3 edge[3], triangle_frame *frame)
{
    frame->corner = dot(edge[1], edge[1]) > dot(edge[0], edge[0]);
    frame->x = edge[frame->corner];
    double xx = dot(frame->x, frame->x);
    frame->per_xx = 1.0 / xx;
    vec3 to_apex = scaled(edge[(frame->corner + 2) % 3], -1.0);
    frame->apex = dot(to_apex, frame->x) * frame->per_xx;
    frame->y = along(to_apex, -frame->apex, frame->x);
    frame->y = along(frame->y, -dot(frame->y, frame->x) * frame->per_xx, frame->x);
    double yy = dot(frame->y, frame->y);
    frame->per_yy = 1.0 / yy;
    frame->z = cross(frame->x, frame->y);
    return yy > 0x1p-100 * xx && yy > 1e-120;
}

/*
 * If a point of the axis projects into the triangle, set `best` to its pair with the face and return 1; else return 0.
 * from_corner leads from the frame's corner to the point; height is its z.from_corner; s is its place on the axis.
 */
static inline int pair_above(pair *best, const triangle_frame *frame, vec3 from_corner, double height, double s)
{
    double x = dot(from_corner, frame->x) * frame->per_xx, y = dot(from_corner, frame->y) * frame->per_yy;
    const double weight[3] = { 1.0 - x - (1.0 - frame->apex) * y, x - frame->apex * y, y };
    if (!(weight[0] >= 0.0 && weight[1] >= 0.0 && weight[2] >= 0.0))
        return 0;
    double per_zz = frame->per_xx * frame->per_yy;
    best->distance2 = height * (height * per_zz);
    best->s = s;
    best->gap = scaled(frame->z, height * per_zz);
    for (int k = 0; k < 3; k++)
        best->weight[(frame->corner + k) % 3] = weight[k];
    return 1;
}

/* If the nearest point lies on the face, set `best` to its pair and return 1; else return 0. */
static inline int pair_on_face(pair *best, vec3 u, const vec3 from[3], const vec3 edge[3])
{
    triangle_frame frame;
    if (!triangle_frame_set(edge, &frame))
        return 0;
    vec3 a = from[frame.corner];
    double height_a = dot(a, frame.z);
    double height_b = height_a + dot(u, frame.z);
    double s = clamp01(height_a / (height_a - height_b));
    return pair_above(best, &frame, along(a, s, u), height_a + s * (height_b - height_a), s);
}

/*
 * How the line of the axis passes the triangle, by triple products (volumes, m^3): how high the axis' two ends are
 * above the triangle's plane, and how far inside each edge the line passes. Rounding is less than a fifth of the noise
 * (docs/algorithms/distance.md).
 */
struct pierce {
    double height_a, height_b;
    double side[3]; /* side[k]: the edge opposite to corner k; positive inside the triangle */
    double height_noise, side_noise;
    /* The line rises through the plane by more than noise, so that the sides have the right sign. */
    int is_steep;
    /* No sliver: twice the area is more than a quarter of the square of the size. */
    int is_well_shaped;
};

static inline struct pierce pierce_of(vec3 u, const vec3 from[3], const vec3 edge[3])
{
    struct pierce p;
    vec3 n = cross(edge[2], edge[0]), q = cross(from[0], u);
    double rise = dot(n, u), sign = rise < 0.0 ? -1.0 : 1.0;
    double edge_extent = max_of(extent_of(edge[0]), extent_of(edge[2]));
    double edge_extent2 = edge_extent * edge_extent;
    double from_extent = extent_of(from[0]), u_extent = extent_of(u);
    p.height_a = dot(n, from[0]);
    p.height_b = p.height_a + rise;
    p.side[1] = sign * dot(edge[2], q);
    p.side[2] = sign * dot(edge[0], q);
    p.side[0] = sign * rise - p.side[1] - p.side[2];
    p.height_noise = 0x1p-44 * edge_extent2 * (from_extent + u_extent);
    p.side_noise = 0x1p-44 * edge_extent * u_extent * (edge_extent + from_extent);
    p.is_steep = fabs(rise) > 0x1p-44 * edge_extent2 * u_extent;
    p.is_well_shaped = dot(n, n) > 0x1p-4 * (edge_extent2 * edge_extent2);
    return p;
}

/* 1 if the axis' ends are on different sides of the plane by more than noise. */
static inline int pierce_parts_ends(const struct pierce *p)
{
    double min_height = min_of(p->height_a, p->height_b);
    double max_height = max_of(p->height_a, p->height_b);
    return (min_height < -p->height_noise) & (max_height > p->height_noise);
}

/* 1 if the axis goes through the plane, outside the triangle, by more than noise. Then an edge is nearest. */
static inline int pierce_misses(const struct pierce *p)
{
    double min_side = min_of(p->side[0], min_of(p->side[1], p->side[2]));
    return (min_side < -p->side_noise) & pierce_parts_ends(p);
}

/*
 * If the line of the axis passes beside the triangle and the nearest pair is not at an end of the axis, set `best` and
 * return 1. On 0, `best` may hold the pair of an edge, and the caller goes on. Seen along the axis, its line is a point
 * outside the triangle. The nearest point to it lies on an edge that it is outside of.
 */
static inline int pair_beside(pair *best, const struct pierce *p, vec3 u, double per_uu, const vec3 from[3],
                              const vec3 edge[3])
{
    double min_side = min_of(p->side[0], min_of(p->side[1], p->side[2]));
    int is_interior = (min_side < -p->side_noise) & p->is_steep;
    for (int corner = 0; corner < 3 && is_interior; corner++)
        if (!(p->side[(corner + 2) % 3] > p->side_noise)) {
            double s = pair_try_edge(best, u, per_uu, from[corner], edge[corner], corner);
            is_interior = (s > 0.0) & (s < 1.0);
        }
    return is_interior;
}

/*
 * If the axis goes through the inside of a triangle that is no sliver, by more than noise, set `best` to a pair at
 * distance 0 and return 1; else return 0.
 */
static inline int pair_on_pierced(pair *best, const struct pierce *p)
{
    double min_side = min_of(p->side[0], min_of(p->side[1], p->side[2]));
    if (!((min_side > p->side_noise) & p->is_well_shaped & pierce_parts_ends(p)))
        return 0;
    double rise = p->height_b - p->height_a, per_rise = 1.0 / fabs(rise);
    best->distance2 = 0.0;
    best->s = clamp01(-p->height_a / rise);
    for (int k = 0; k < 3; k++)
        best->weight[k] = p->side[k] * per_rise;
    best->gap = (vec3){ 0.0, 0.0, 0.0 };
    return 1;
}

/* Set a distance to 0 if it may be nothing but rounding; extent_sum is the sum of the sizes that entered. */
static inline void pair_snap_to_zero(pair *best, double extent_sum)
{
    double rounding = 4.0 * 0x1p-53 * extent_sum;
    if (best->distance2 <= rounding * rounding) {
        best->distance2 = 0.0;
        best->gap = (vec3){ 0.0, 0.0, 0.0 };
    }
}

/*
 * The pair of a point with the nearest edge, the first of equally near ones. from[k] leads from corner k to the point.
 * All three edges are computed without branches: which one is nearest cannot be predicted.
 */
static inline void point_on_edges(pair *found, const vec3 from[3], const vec3 edge[3])
{
    double t[3], square[3];
    for (int k = 0; k < 3; k++) {
        t[k] = clamp01(dot(from[k], edge[k]) / dot(edge[k], edge[k]));
        vec3 gap = sub(from[k], scaled(edge[k], t[k]));
        square[k] = dot(gap, gap);
    }
    int k = square[1] < square[0];
    k = square[2] < square[k] ? 2 : k;
    found->distance2 = min_of(square[k], HUGE_VAL);
    found->s = 0.0;
    found->gap = sub(from[k], scaled(edge[k], t[k]));
    found->weight[k] = 1.0 - t[k];
    found->weight[(k + 1) % 3] = t[k];
    found->weight[(k + 2) % 3] = 0.0;
}

/* The pair of a point x, an axis without length. found->s is 1 if the face is nearest and x in front of it, else 0. */
static inline void point_triangle(vec3 x, const vec3 v[3], pair *found)
{
    triangle_frame frame;
    const vec3 edge[3] = { sub(v[1], v[0]), sub(v[2], v[1]), sub(v[0], v[2]) };
    const vec3 from[3] = { sub(x, v[0]), sub(x, v[1]), sub(x, v[2]) };
    int has_face = triangle_frame_set(edge, &frame);
    double height = dot(from[frame.corner], frame.z);
    if (!(has_face && pair_above(found, &frame, from[frame.corner], height, height > 0.0)))
        point_on_edges(found, from, edge);
    pair_snap_to_zero(found, extent_of(from[0]) + extent_of(edge[0]) + extent_of(edge[2]));
}

/*
 * An upper bound of the distance from x to a triangle: the distance to a point of the triangle that is the nearest one
 * but for rounding. Cheaper than point_triangle.
 */
static inline double point_distance_upper(vec3 x, vec3 v0, vec3 v1, vec3 v2)
{
    vec3 e = sub(v1, v0), f = sub(v2, v0), from_v0 = sub(x, v0);
    double ee = dot(e, e), ef = dot(e, f), ff = dot(f, f);
    double we = dot(from_v0, e), wf = dot(from_v0, f);
    double determinant = ee * ff - ef * ef, b = ff * we - ef * wf, c = ee * wf - ef * we;
    if ((b >= 0.0) & (c >= 0.0) & (b + c <= determinant) & (determinant > 0.0))
        return length(along(along(from_v0, -b / determinant, e), -c / determinant, f));
    vec3 g = sub(f, e), from_v1 = sub(from_v0, e);
    vec3 from_e = sub(from_v0, scaled(e, clamp01(we / ee)));
    vec3 from_f = sub(from_v0, scaled(f, clamp01(wf / ff)));
    vec3 from_g = sub(from_v1, scaled(g, clamp01(dot(from_v1, g) / dot(g, g))));
    return sqrt(min_of(dot(from_e, from_e), min_of(dot(from_f, from_f), dot(from_g, from_g))));
}

/*
 * The nearest pair of the axis a + s u, s in 0..1, and a triangle of any shape. u may be 0, but then point_triangle is
 * faster. docs/algorithms/distance.md states the error.
 */
static inline pair segment_triangle(vec3 a, vec3 u, vec3 v0, vec3 v1, vec3 v2)
{
    pair best = { .distance2 = HUGE_VAL };
    const vec3 edge[3] = { sub(v1, v0), sub(v2, v1), sub(v0, v2) };
    const vec3 from[3] = { sub(a, v0), sub(a, v1), sub(a, v2) };
    struct pierce pierce = pierce_of(u, from, edge);
    if (pair_on_pierced(&best, &pierce))
        return best;
    double per_uu = 1.0 / dot(u, u);
    if (!pair_beside(&best, &pierce, u, per_uu, from, edge) &&
        (pierce_misses(&pierce) || !pair_on_face(&best, u, from, edge))) {
        for (int corner = 0; corner < 3; corner++)
            pair_try_edge(&best, u, per_uu, from[corner], edge[corner], corner);
    }
    pair_snap_to_zero(&best, extent_of(from[0]) + extent_of(u) + extent_of(edge[0]) + extent_of(edge[2]));
    return best;
}

#endif
