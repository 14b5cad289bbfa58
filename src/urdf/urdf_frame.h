/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Poses of frames in other frames. A point x of the inner frame is at position + R x in the outer one, with R the
 * rotation by the quaternion (w, v).
 */
#ifndef DPT_URDF_FRAME_H
#define DPT_URDF_FRAME_H

#include <cmath>

struct Vec {
    double x, y, z;
};

struct Frame {
    Vec position;
    double w; /* w and v: a unit quaternion */
    Vec v;
};

static const Frame identity = { { 0.0, 0.0, 0.0 }, 1.0, { 0.0, 0.0, 0.0 } };

inline Vec operator+(Vec a, Vec b)
{
    return { a.x + b.x, a.y + b.y, a.z + b.z };
}

inline Vec operator*(double s, Vec a)
{
    return { s * a.x, s * a.y, s * a.z };
}

inline double dot(Vec a, Vec b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

inline Vec cross(Vec a, Vec b)
{
    return { a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}

inline Vec rotated(const Frame &f, Vec x)
{
    Vec t = 2.0 * cross(f.v, x);
    return x + f.w * t + cross(f.v, t);
}

inline Vec operator*(const Frame &f, Vec x)
{
    return f.position + rotated(f, x);
}

inline Frame operator*(const Frame &a, const Frame &b)
{
    double w = a.w * b.w - dot(a.v, b.v);
    Vec v = a.w * b.v + b.w * a.v + cross(a.v, b.v);
    double scale = 1.0 / std::sqrt(w * w + dot(v, v));
    return { a * b.position, scale * w, scale * v };
}

inline Frame inverse(const Frame &f)
{
    Frame back = { { 0.0, 0.0, 0.0 }, f.w, -1.0 * f.v };
    back.position = rotated(back, -1.0 * f.position);
    return back;
}

#endif
