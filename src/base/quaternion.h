/* SPDX-License-Identifier: BSD-3-Clause */
/* Unit quaternions (w, x, y, z) as turns of vectors. */
#ifndef DPT_QUATERNION_H
#define DPT_QUATERNION_H

#include "base/angle.h"

struct quaternion {
    double w;
    vec3 v;
};

static inline struct quaternion quaternion_of(const double *q)
{
    return (struct quaternion){ q[0], vec3_of(q + 1) };
}

static inline void quaternion_store(struct quaternion q, double *out)
{
    out[0] = q.w;
    vec3_store(q.v, out + 1);
}

/* First b, then a. */
static inline struct quaternion quaternion_product(struct quaternion a, struct quaternion b)
{
    return (struct quaternion){
        a.w * b.w - dot(a.v, b.v),
        add(along(scaled(b.v, a.w), b.w, a.v), cross(a.v, b.v)),
    };
}

static inline struct quaternion quaternion_inverse(struct quaternion q)
{
    return (struct quaternion){ q.w, scaled(q.v, -1.0) };
}

/* Normalised to length 1. */
static inline struct quaternion quaternion_unit(struct quaternion q)
{
    const double size = sqrt(q.w * q.w + dot(q.v, q.v));
    return (struct quaternion){ q.w / size, scaled(q.v, 1.0 / size) };
}

/* A vector, turned. */
static inline vec3 quaternion_turn(struct quaternion q, vec3 x)
{
    vec3 twice = scaled(cross(q.v, x), 2.0);
    return add(along(x, q.w, twice), cross(q.v, twice));
}

/*
 * A turn about an axis by 2 atan(|v| / 2), which is |v| but for |v|^3 / 12: for small turns, without a sine
 * (Cayley's map).
 */
static inline struct quaternion quaternion_of_small_turn(vec3 v)
{
    return quaternion_unit((struct quaternion){ 1.0, scaled(v, 0.5) });
}

/* The rotation vector, rad, of the shorter of the two turns that q stands for. */
static inline vec3 quaternion_rotation_vector(struct quaternion q)
{
    const double sine = length(q.v), cosine = fabs(q.w);
    if (!(sine > 0.0))
        return (vec3){ 0.0, 0.0, 0.0 };
    const double half = sine <= cosine ? arctangent(sine / cosine) : 0.25 * ANGLE_TURN - arctangent(cosine / sine);
    return scaled(q.v, (q.w < 0.0 ? -2.0 : 2.0) * half / sine);
}

/*
 * The least turn that takes the unit vector a to the unit vector b. Where they are opposite, within 1e-3 rad: half a
 * turn about any axis across, and then the least turn.
 */
static inline struct quaternion quaternion_of_turn(vec3 a, vec3 b)
{
    const double sum = 1.0 + dot(a, b);
    if (sum > 1e-6)
        return quaternion_unit((struct quaternion){ sum, cross(a, b) });
    const vec3 other = fabs(a.x) < 0.6 ? (vec3){ 1.0, 0.0, 0.0 } : (vec3){ 0.0, 1.0, 0.0 };
    const struct quaternion half = { 0.0, unit_of(cross(a, other)) };
    const vec3 back = scaled(a, -1.0);
    return quaternion_product(quaternion_unit((struct quaternion){ 1.0 + dot(back, b), cross(back, b) }), half);
}

/* The least turn that takes the unit vector a to the unit vector b; about any axis across a where they are opposite. */
static inline vec3 least_turn(vec3 a, vec3 b)
{
    const vec3 axis = cross(a, b);
    const double size = length(axis);
    if (size > 0.0)
        return scaled(axis, angle_between(a, b) / size);
    if (dot(a, b) > 0.0)
        return (vec3){ 0.0, 0.0, 0.0 };
    const vec3 other = fabs(a.x) < 0.6 ? (vec3){ 1.0, 0.0, 0.0 } : (vec3){ 0.0, 1.0, 0.0 };
    return scaled(unit_of(cross(a, other)), 0.5 * ANGLE_TURN);
}

/*
 * Arrays w, x, y, z. Sums run from left to right: the last bits may differ from those of quaternion_product and
 * quaternion_turn. `out` may be an argument.
 */

/* out = a b: first b, then a. */
static inline void quaternion_multiply(const double a[4], const double b[4], double out[4])
{
    const double w = a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3];
    const double x = a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2];
    const double y = a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1];
    const double z = a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0];
    out[0] = w;
    out[1] = x;
    out[2] = y;
    out[3] = z;
}

static inline double quaternion_length(const double q[4])
{
    return sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
}

/* Divide a quaternion that is not 0 by its length. */
static inline void quaternion_normalise(double q[4])
{
    const double size = quaternion_length(q);
    for (int k = 0; k < 4; k++)
        q[k] /= size;
}

/* A vector, turned by a unit quaternion. */
static inline void quaternion_rotate(const double q[4], const double v[3], double out[3])
{
    const vec3 t = scaled(cross(vec3_of(q + 1), vec3_of(v)), 2.0);
    const vec3 turned = { v[0] + q[0] * t.x + q[2] * t.z - q[3] * t.y, v[1] + q[0] * t.y + q[3] * t.x - q[1] * t.z,
                          v[2] + q[0] * t.z + q[1] * t.y - q[2] * t.x };
    vec3_store(turned, out);
}

/* The same, turned back. */
static inline void quaternion_rotate_back(const double q[4], const double v[3], double out[3])
{
    const double back[4] = { q[0], -q[1], -q[2], -q[3] };
    quaternion_rotate(back, v, out);
}

#endif
