/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Vectors of three doubles, by value and inline. Only + - * / and sqrt, so that every machine gives the same bits.
 */
#ifndef DPT_VEC3_H
#define DPT_VEC3_H

#include <float.h>
#include <math.h>
#include <stdint.h>

/* 16: the same for float and double, on processors that compute in half precision too. */
#if FLT_EVAL_METHOD != 0 && FLT_EVAL_METHOD != 16
#error "dynpoint needs arithmetic without excess precision (FLT_EVAL_METHOD == 0)"
#endif

typedef struct vec3 {
    double x, y, z;
} vec3;

static inline vec3 vec3_of(const double *v)
{
    return (vec3){ v[0], v[1], v[2] };
}

static inline vec3 vec3_of_float(const float *v)
{
    return (vec3){ v[0], v[1], v[2] };
}

static inline void vec3_store(vec3 v, double *out)
{
    out[0] = v.x;
    out[1] = v.y;
    out[2] = v.z;
}

static inline vec3 add(vec3 a, vec3 b)
{
    return (vec3){ a.x + b.x, a.y + b.y, a.z + b.z };
}

static inline vec3 sub(vec3 a, vec3 b)
{
    return (vec3){ a.x - b.x, a.y - b.y, a.z - b.z };
}

static inline vec3 scaled(vec3 a, double k)
{
    return (vec3){ a.x * k, a.y * k, a.z * k };
}

/* a + k b */
static inline vec3 along(vec3 a, double k, vec3 b)
{
    return (vec3){ a.x + k * b.x, a.y + k * b.y, a.z + k * b.z };
}

static inline double dot(vec3 a, vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline vec3 cross(vec3 a, vec3 b)
{
    return (vec3){ a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}

static inline double length(vec3 a)
{
    return sqrt(dot(a, a));
}

/* The unit vector along `a`; zero stays zero. */
static inline vec3 unit_of(vec3 a)
{
    double size = length(a);
    return size > 0.0 ? scaled(a, 1.0 / size) : (vec3){ 0.0, 0.0, 0.0 };
}

/* out = a cross b */
static inline void vec3_cross(const double a[3], const double b[3], double out[3])
{
    vec3_store(cross(vec3_of(a), vec3_of(b)), out);
}

static inline double vec3_dot(const double a[3], const double b[3])
{
    return dot(vec3_of(a), vec3_of(b));
}

static inline double vec3_length(const double v[3])
{
    return length(vec3_of(v));
}

/* Divide a vector by its length; zero stays zero. unit_of multiplies by the inverse: the last bits may differ. */
static inline void vec3_normalise(double v[3])
{
    const double size = vec3_length(v);
    for (int k = 0; k < 3 && size > 0.0; k++)
        v[k] /= size;
}

static inline double max_of(double a, double b)
{
    return a > b ? a : b;
}

static inline double min_of(double a, double b)
{
    return a < b ? a : b;
}

/* Two unit vectors across the unit vector u, and each other. */
static inline void unit_across(vec3 u, vec3 across[2])
{
    const double x = fabs(u.x), y = fabs(u.y), z = fabs(u.z);
    const vec3 axis = { x <= y && x <= z, y < x && y <= z, z < x && z < y };
    across[0] = unit_of(cross(u, axis));
    across[1] = cross(u, across[0]);
}

/* The largest |coordinate|. */
static inline double extent_of(vec3 a)
{
    return max_of(fabs(a.x), max_of(fabs(a.y), fabs(a.z)));
}

/*
 * t limited to 0..1; 0 for NaN. NaN comes from 0 / 0, where any value would do. The two choices are independent, so
 * that compilers use no branch: where a nearest point lies cannot be predicted.
 */
static inline double clamp01(double t)
{
    double low = t < 1.0 ? t : 1.0;
    return t > 0.0 ? low : 0.0;
}

/* The place s, 0..1, of the point a + s u that is nearest to x; 0 where u is 0. */
static inline double nearest_on(vec3 a, vec3 u, vec3 x)
{
    double uu = dot(u, u);
    return uu > 0.0 ? clamp01(dot(sub(x, a), u) / uu) : 0.0;
}

/* 1 if |value| <= limit; 0 for NaN. */
static inline int within(double value, double limit)
{
    return fabs(value) <= limit;
}

/* 1 if all coordinates are equal. */
static inline int vec3_is_same(vec3 v, const double *other)
{
    return v.x == other[0] && v.y == other[1] && v.z == other[2];
}

static inline int vec3_within(const double *v, double limit)
{
    return within(v[0], limit) && within(v[1], limit) && within(v[2], limit);
}

#endif
