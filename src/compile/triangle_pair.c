/* SPDX-License-Identifier: BSD-3-Clause */
/* The side of a plane is the sign of a determinant (exact_sign.h). */
#include "compile/triangle_pair.h"

#include "compile/exact_sign.h"

/*
 * Units of work: about how many pairs on one side of each other's plane take as long as a test within a plane, or as an
 * exact sign.
 */
#define PLANE_WORK 4u
#define EXACT_WORK 16u

/*
 * Add a * b * c exactly; all three hold floats' values. a * b has 48 bits and is exact. It is split into two halves,
 * and each half times c is exact again.
 */
static void add_product(struct exact_sum *sum, double a, double b, double c)
{
    const double product = a * b, split = 0x1.0000002p27 * product, upper = split - (split - product);
    exact_sum_add(sum, upper * c);
    exact_sum_add(sum, (product - upper) * c);
}

static void add_volume(struct exact_sum *sum, double sign, vec3 a, vec3 b, vec3 c)
{
    add_product(sum, sign * a.x, b.y, c.z);
    add_product(sum, -sign * a.x, b.z, c.y);
    add_product(sum, sign * a.y, b.z, c.x);
    add_product(sum, -sign * a.y, b.x, c.z);
    add_product(sum, sign * a.z, b.x, c.y);
    add_product(sum, -sign * a.z, b.y, c.x);
}

static int exact_volume_sign(vec3 p, vec3 q, vec3 r, vec3 x)
{
    struct exact_sum sum = { .count = 0 };
    add_volume(&sum, 1.0, q, r, x);
    add_volume(&sum, -1.0, p, r, x);
    add_volume(&sum, 1.0, p, q, x);
    add_volume(&sum, -1.0, p, q, r);
    return exact_sum_sign(&sum);
}

void facet_finish(struct facet *facet)
{
    const vec3 p = facet->corner[0].position;
    const vec3 u = sub(facet->corner[1].position, p), v = sub(facet->corner[2].position, p);
    facet->normal = cross(u, v);
    facet->normal_magnitude = cross_magnitude(u, v);
}

/*
 * For each corner of `other`, the side of the facet's plane: 1 in front, -1 behind, 0 in the plane, or SIGN_UNSURE. A common
 * vertex lies in the plane.
 */
static void find_sides(const struct facet *facet, const struct facet *other, int side[3])
{
    const struct corner *own = facet->corner;
    for (int k = 0; k < 3; k++) {
        const uint32_t vertex = other->corner[k].vertex;
        const vec3 w = sub(other->corner[k].position, own[0].position);
        side[k] =
            vertex == own[0].vertex || vertex == own[1].vertex || vertex == own[2].vertex
                ? 0
                : sign_or_unsure(dot(facet->normal, w), SIGN_ROUNDING * dot(facet->normal_magnitude, magnitude_of(w)));
    }
}

static void resolve_sides(const struct facet *facet, const struct facet *other, int side[3], uint64_t *work)
{
    const struct corner *own = facet->corner;
    for (int k = 0; k < 3; k++)
        if (side[k] == SIGN_UNSURE) {
            side[k] = exact_volume_sign(own[0].position, own[1].position, own[2].position, other->corner[k].position);
            *work += EXACT_WORK;
        }
}

static int any_is(const int side[3], int value)
{
    return side[0] == value || side[1] == value || side[2] == value;
}

/* Given the sides of a triangle's corners: does its interior surely have no point in the plane? */
static int is_beside(const int side[3])
{
    return !any_is(side, SIGN_UNSURE) && any_is(side, 1) != any_is(side, -1);
}

/* Do all corners of `other` lie beyond an edge of the facet, for certain? */
static int edge_separates(const struct facet *facet, int edge, const struct facet *other)
{
    const vec3 from = facet->corner[edge].position;
    const vec3 out = cross(sub(facet->corner[(edge + 1) % 3].position, from), facet->normal);
    const vec3 size = magnitude_of(out);
    double max_own = -HUGE_VAL, min_other = HUGE_VAL;
    for (int k = 0; k < 3; k++) {
        const vec3 w = sub(facet->corner[k].position, from), x = sub(other->corner[k].position, from);
        max_own = max_of(max_own, dot(out, w) + SIGN_ROUNDING * dot(size, magnitude_of(w)));
        min_other = min_of(min_other, dot(out, x) - SIGN_ROUNDING * dot(size, magnitude_of(x)));
    }
    return min_other > max_own;
}

static int are_separate(const struct facet *a, const struct facet *b)
{
    for (int edge = 0; edge < 3; edge++)
        if (edge_separates(a, edge, b) || edge_separates(b, edge, a))
            return 1;
    return 0;
}

static double coordinate(vec3 v, int axis)
{
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

/* How three points turn, seen along an axis: 1 counterclockwise, -1 clockwise, 0 in line. Exact. */
static int area_sign(vec3 p, vec3 q, vec3 r, int axis, uint64_t *work)
{
    const vec3 points[3] = { p, q, r };
    double x[3][2];
    for (int k = 0; k < 3; k++) {
        x[k][0] = coordinate(points[k], (axis + 1) % 3);
        x[k][1] = coordinate(points[k], (axis + 2) % 3);
    }
    const int sign = turn_or_unsure(x[0], x[1], x[2]);
    if (sign != SIGN_UNSURE)
        return sign;
    *work += EXACT_WORK;
    return exact_turn(x[0], x[1], x[2]);
}

/* For two triangles in one plane: does no corner of `other` lie on the inner side of this edge? */
static int edge_excludes(const struct facet *facet, int edge, const struct facet *other, int axis, int winding,
                         uint64_t *work)
{
    for (int k = 0; k < 3; k++)
        if (area_sign(facet->corner[edge].position, facet->corner[(edge + 1) % 3].position, other->corner[k].position,
                      axis, work) == winding)
            return 0;
    return 1;
}

static int overlap_in_plane(const struct facet *a, const struct facet *b, uint64_t *work)
{
    int axis = 0, winding_a = 0, winding_b = 0;
    *work += PLANE_WORK;
    for (; axis < 3 && !winding_a; axis++)
        winding_a = area_sign(a->corner[0].position, a->corner[1].position, a->corner[2].position, axis, work);
    axis--;
    if (winding_a)
        winding_b = area_sign(b->corner[0].position, b->corner[1].position, b->corner[2].position, axis, work);
    if (!winding_b)
        return 0;
    for (int edge = 0; edge < 3; edge++)
        if (edge_excludes(a, edge, b, axis, winding_a, work) || edge_excludes(b, edge, a, axis, winding_b, work))
            return 0;
    return 1;
}

static int volume_sign(const struct corner *p, const struct corner *q, const struct corner *r, const struct corner *x,
                       uint64_t *work)
{
    if (p->vertex == r->vertex || p->vertex == x->vertex || q->vertex == r->vertex || q->vertex == x->vertex)
        return 0;
    const vec3 u = sub(q->position, p->position), v = sub(r->position, p->position), w = sub(x->position, p->position);
    const int sign = sign_or_unsure(dot(cross(u, v), w), SIGN_ROUNDING * dot(cross_magnitude(u, v), magnitude_of(w)));
    if (sign != SIGN_UNSURE)
        return sign;
    *work += EXACT_WORK;
    return exact_volume_sign(p->position, q->position, r->position, x->position);
}

/* Of a triangle that crosses a plane: the corner that is alone on its side. */
static int lone_corner(const int side[3])
{
    const int above = (side[0] > 0) + (side[1] > 0) + (side[2] > 0);
    const int sign = above == 1 ? 1 : -1;
    return side[0] == sign ? 0 : side[1] == sign ? 1 : 2;
}

/*
 * Each triangle crosses the plane of the other, along a stretch of the line in which the planes meet. Do the two
 * stretches overlap? Order the corners of both so that the first one is alone, and in front of the other's plane. Then
 * the stretches overlap if each begins before the other one ends (Guigue and Devillers 2003).
 */
static int stretches_overlap(const struct facet *a, const struct facet *b, const int side_a[3], const int side_b[3],
                             uint64_t *work)
{
    const int i = lone_corner(side_a), j = lone_corner(side_b);
    const int swaps_a = side_b[j] < 0, swaps_b = side_a[i] < 0;
    const struct corner *p = &a->corner[i], *x = &b->corner[j];
    const struct corner *q = &a->corner[(i + 1 + swaps_a) % 3], *r = &a->corner[(i + 2 - swaps_a) % 3];
    const struct corner *y = &b->corner[(j + 1 + swaps_b) % 3], *z = &b->corner[(j + 2 - swaps_b) % 3];
    return volume_sign(p, q, x, y, work) < 0 && volume_sign(p, r, x, z, work) > 0;
}

int facets_cut(const struct facet *a, const struct facet *b, uint64_t *work)
{
    int side_a[3], side_b[3];
    ++*work;
    find_sides(a, b, side_b);
    if (is_beside(side_b))
        return 0;
    find_sides(b, a, side_a);
    if (is_beside(side_a))
        return 0;
    if (any_is(side_a, SIGN_UNSURE) || any_is(side_b, SIGN_UNSURE)) {
        *work += PLANE_WORK;
        if (are_separate(a, b))
            return 0;
        resolve_sides(a, b, side_b, work);
        resolve_sides(b, a, side_a, work);
        if (is_beside(side_a) || is_beside(side_b))
            return 0;
    }
    if (!any_is(side_a, 1) || !any_is(side_b, 1))
        return !any_is(side_a, 1) && !any_is(side_b, 1) && overlap_in_plane(a, b, work);
    return stretches_overlap(a, b, side_a, side_b, work);
}
