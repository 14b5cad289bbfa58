/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/return_if_error.h"
#include "base/sincos.h"
#include "convex/convex_body.h"

#include <string.h>

enum { CORNERS_MAX = DPT_HULL_CORNERS_MAX, EDGES_MAX = 3 * DPT_HULL_CORNERS_MAX, CUT_MAX = CORNERS_MAX + EDGES_MAX };

/* A polyhedron around a shape, in the shape's frame. */
struct around {
    vec3 corner[CUT_MAX];
    uint32_t count, edges;
    uint8_t edge[EDGES_MAX][2];
    double error; /* m */
};

static const struct {
    uint32_t min, max, usual;
} sides_of[] = { { 3, 63, 16 }, { 3, 32, 16 }, { 3, 12, 12 }, { 3, 15, 10 }, { 0, 0, 0 } };

static void put(struct around *around, double x, double y, double z)
{
    around->corner[around->count++] = (vec3){ x, y, z };
}

static void join(struct around *around, uint32_t a, uint32_t b)
{
    around->edge[around->edges][0] = (uint8_t)a;
    around->edge[around->edges++][1] = (uint8_t)b;
}

/* A ring of corners at z, and its edges; it is joined to the ring that is before it, if one is. */
static void put_ring(struct around *around, uint32_t sides, double radius_x, double radius_y, double z, int is_joined)
{
    const uint32_t first = around->count;
    for (uint32_t i = 0; i < sides; i++) {
        double sine, cosine;
        turn_sincos((i + 0.5) / sides, &sine, &cosine);
        put(around, radius_x * cosine, radius_y * sine, z);
        join(around, first + i, first + (i + 1) % sides);
        if (is_joined)
            join(around, first + i - sides, first + i);
    }
}

/* A point on the axis, joined to a ring. */
static void put_pole(struct around *around, uint32_t sides, double z, uint32_t ring)
{
    for (uint32_t i = 0; i < sides; i++)
        join(around, around->count, ring + i);
    put(around, 0.0, 0.0, z);
}

/* One over the cosine of half a side's angle, and a bit. */
static double widening(uint32_t sides)
{
    double sine, cosine;
    turn_sincos(0.5 / sides, &sine, &cosine);
    return (1.0 + 0x1p-50) / cosine;
}

/*
 * How much larger than the unit ball's corners those around it are. Their latitudes, in turns, are `from` to a quarter,
 * in `steps` equal steps. A face's middle line lies in the half plane of a side's middle; the least distance of these
 * lines from the centre is what the corners must make up for.
 */
static double ball_widening(uint32_t sides, double from, uint32_t steps)
{
    const double narrow = 1.0 / widening(sides);
    double nearest = narrow;
    for (uint32_t j = 0; j < steps; j++) {
        double s0, c0, s1, c1;
        turn_sincos(from + (0.25 - from) * j / steps, &s0, &c0);
        turn_sincos(from + (0.25 - from) * (j + 1) / steps, &s1, &c1);
        if (j + 1 == steps)
            c1 = 0.0;
        c0 *= narrow;
        c1 *= narrow;
        const double dx = c1 - c0, dy = s1 - s0;
        nearest = min_of(nearest, fabs(c0 * dy - s0 * dx) / sqrt(dx * dx + dy * dy));
    }
    return (1.0 + 0x1p-50) / nearest;
}

static void around_cone(const struct convex_body *body, uint32_t sides, struct around *around)
{
    const double wide = widening(sides);
    put_ring(around, sides, wide * body->x, wide * body->x, body->z, 0);
    put_pole(around, sides, -body->z, 0);
    around->error = (wide - 1.0) * body->x;
}

static void around_cylinder(const struct convex_body *body, uint32_t sides, struct around *around)
{
    const double wide = widening(sides);
    put_ring(around, sides, wide * body->x, wide * body->x, -body->z, 0);
    put_ring(around, sides, wide * body->x, wide * body->x, body->z, 1);
    around->error = (wide - 1.0) * body->x;
}

static void around_ellipsoid(const struct convex_body *body, uint32_t sides, struct around *around)
{
    const uint32_t rings = sides < 4 ? 1 : sides / 2 - 1;
    const double wide = ball_widening(sides, -0.25, rings + 1);
    for (uint32_t j = 1; j <= rings; j++) {
        double sine, cosine;
        turn_sincos(-0.25 + 0.5 * j / (rings + 1), &sine, &cosine);
        put_ring(around, sides, wide * cosine * body->x, wide * cosine * body->y, wide * sine * body->z, j > 1);
    }
    put_pole(around, sides, -wide * body->z, 0);
    put_pole(around, sides, wide * body->z, (rings - 1) * sides);
    around->error = (wide - 1.0) * max_of(body->x, max_of(body->y, body->z));
}

/* ---- capsules ---- */

static double distance_from_axis(const struct convex_body *body, vec3 p)
{
    const double z = max_of(-body->z, min_of(body->z, p.z));
    return length(sub(p, (vec3){ 0.0, 0.0, z }));
}

/* How far w, in the plane of the bevel, is from the disc in which the ball at z meets it. */
static double from_disc(const struct convex_body *body, vec3 w, double z)
{
    const double s = body->cut.z * z - body->cut_at;
    const vec3 middle = along((vec3){ 0.0, 0.0, z }, -s, body->cut);
    const double radius = sqrt(max_of(0.0, body->x * body->x - s * s));
    return max_of(0.0, length(sub(w, middle)) - radius);
}

/* How far a point that the bevel leaves is from what it leaves of the capsule. */
static double from_bevelled(const struct convex_body *body, vec3 p)
{
    const vec3 axis = { 0.0, 0.0, max_of(-body->z, min_of(body->z, p.z)) };
    const double off = length(sub(p, axis)) - body->x;
    if (off <= 0.0)
        return 0.0;
    if (!body->is_cut || dot(along(axis, body->x, unit_of(sub(p, axis))), body->cut) <= body->cut_at)
        return off;
    /* Then its nearest point is in the plane: the discs there are looked at by thirds, as the distance has one dip. */
    const double level = body->cut_at - dot(p, body->cut);
    const vec3 w = along(p, level, body->cut);
    double low = -body->z, high = body->z;
    if (fabs(body->cut.z) > 1e-12) {
        const double a = (body->cut_at - body->x) / body->cut.z;
        const double b = (body->cut_at + body->x) / body->cut.z;
        low = max_of(low, min_of(a, b));
        high = min_of(high, max_of(a, b));
    }
    for (int i = 0; i < 100; i++) {
        const double one = low + (high - low) / 3.0, other = high - (high - low) / 3.0;
        if (from_disc(body, w, one) < from_disc(body, w, other))
            high = other;
        else
            low = one;
    }
    const double across = from_disc(body, w, 0.5 * (low + high));
    return sqrt(level * level + across * across);
}

/* Cut off what lies beyond the bevel: a corner is new where an edge crosses its plane. */
static void cut(const struct convex_body *body, struct around *around)
{
    vec3 kept[CUT_MAX];
    uint32_t count = 0;
    for (uint32_t i = 0; i < around->count; i++)
        if (dot(around->corner[i], body->cut) <= body->cut_at)
            kept[count++] = around->corner[i];
    for (uint32_t i = 0; i < around->edges; i++) {
        const vec3 a = around->corner[around->edge[i][0]], b = around->corner[around->edge[i][1]];
        const double over_a = dot(a, body->cut) - body->cut_at;
        const double over_b = dot(b, body->cut) - body->cut_at;
        if ((over_a > 0.0) != (over_b > 0.0))
            kept[count++] = along(a, over_a / (over_a - over_b), sub(b, a));
    }
    memcpy(around->corner, kept, count * sizeof *kept);
    around->count = count;
}

static void around_capsule(const struct convex_body *body, uint32_t sides, struct around *around)
{
    const uint32_t rings = (CORNERS_MAX - 2) / 2 / sides;
    const double wide = body->x * ball_widening(sides, 0.0, rings);
    for (uint32_t j = 0; j < 2 * rings; j++) {
        const uint32_t step = j < rings ? rings - 1 - j : j - rings;
        double sine, cosine;
        turn_sincos(0.25 * step / rings, &sine, &cosine);
        put_ring(around, sides, wide * cosine, wide * cosine,
                 j < rings ? -body->z - wide * sine : body->z + wide * sine, j > 0);
    }
    put_pole(around, sides, -body->z - wide, 0);
    put_pole(around, sides, body->z + wide, (2 * rings - 1) * sides);
    if (body->is_cut)
        cut(body, around);
    for (uint32_t i = 0; i < around->count; i++)
        around->error = max_of(around->error, body->is_cut ? from_bevelled(body, around->corner[i])
                                                           : distance_from_axis(body, around->corner[i]) - body->x);
}

/* The distance from a convex set is greatest at a corner, so that the error need not be asked elsewhere. */
static void make(const struct convex_body *body, uint32_t sides, struct around *around)
{
    memset(around, 0, sizeof *around);
    switch (body->kind) {
    case DPT_CONVEX_KIND_CONE:
        around_cone(body, sides, around);
        break;
    case DPT_CONVEX_KIND_CYLINDER:
        around_cylinder(body, sides, around);
        break;
    case DPT_CONVEX_KIND_ELLIPSOID:
        around_ellipsoid(body, sides, around);
        break;
    case DPT_CONVEX_KIND_CAPSULE:
        around_capsule(body, sides, around);
        break;
    default:
        around->count = body->corner_count;
        memcpy(around->corner, body->corner, body->corner_count * sizeof *body->corner);
    }
}

dpt_result dpt_convex_corners(const dpt_convex_shape *shape, uint32_t sides, double *corners, uint32_t capacity,
                              uint32_t *count, double *error)
{
    struct convex_body body;
    struct around around;
    if (count)
        *count = 0;
    if (error)
        *error = 0.0;
    if (!shape || !count || (!corners && capacity))
        return DPT_E_ARGUMENT;
    DPT_TRY(dpti_convex_body_of(shape, &body));
    const uint32_t given = sides, min = sides_of[body.kind].min;
    sides = sides ? sides : sides_of[body.kind].usual;
    if (sides < min || sides > sides_of[body.kind].max)
        return DPT_E_ARGUMENT;
    make(&body, sides, &around);
    /* The default has fewer sides where a bevel needs the corners. */
    while (!given && around.count > CORNERS_MAX && sides > min)
        make(&body, --sides, &around);
    if (around.count > CORNERS_MAX)
        return DPT_E_LIMIT;
    for (uint32_t i = 0; i < around.count && i < capacity; i++)
        vec3_store(frame_to_world(&body.frame, around.corner[i]), corners + 3 * (size_t)i);
    *count = around.count;
    if (error)
        *error = around.error;
    return around.count > capacity ? DPT_E_FULL : DPT_OK;
}
