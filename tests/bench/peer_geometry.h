/* SPDX-License-Identifier: BSD-3-Clause */
/* Vectors, and an exact distance of segment and triangle for peers whose library has none. C++11. */
#ifndef PEER_GEOMETRY_H
#define PEER_GEOMETRY_H

#include <algorithm>
#include <cmath>

namespace peer
{

/*
 * A right-handed frame whose x axis runs from a to b; any will do for a segment of length 0.
 * Divisions are few, as this is part of the time that is measured. For libraries that stand on
 * Eigen.
 */
template <typename Matrix, typename Vector> Matrix frame_of(const Vector &a, const Vector &b, double &length)
{
    Vector x = b - a;
    Matrix frame;

    length = x.norm();
    if (length > 0)
        x *= 1 / length;
    else
        x = Vector(1, 0, 0);
    Vector y = x.cross(std::abs(x[0]) < 0.6 ? Vector(1, 0, 0) : Vector(0, 1, 0));
    y *= 1 / y.norm();
    frame.col(0) = x;
    frame.col(1) = y;
    frame.col(2) = x.cross(y);
    return frame;
}

struct Vec {
    double x, y, z;
};

inline Vec vec(const double *p)
{
    return Vec{ p[0], p[1], p[2] };
}

inline Vec operator-(const Vec &a, const Vec &b)
{
    return Vec{ a.x - b.x, a.y - b.y, a.z - b.z };
}

inline Vec operator+(const Vec &a, const Vec &b)
{
    return Vec{ a.x + b.x, a.y + b.y, a.z + b.z };
}

inline Vec operator*(double s, const Vec &a)
{
    return Vec{ s * a.x, s * a.y, s * a.z };
}

inline double dot(const Vec &a, const Vec &b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

inline Vec cross(const Vec &a, const Vec &b)
{
    return Vec{ a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}

inline double clamp01(double x)
{
    return x > 0 ? (x < 1 ? x : 1) : 0;
}

/* Squared distance of the segments a + s u and c + t v, s and t from 0 to 1. */
inline double segment_segment(const Vec &a, const Vec &u, double uu, const Vec &c, const Vec &v)
{
    Vec r = a - c;
    double vv = dot(v, v), uv = dot(u, v), ur = dot(u, r), vr = dot(v, r);
    double det = uu * vv - uv * uv;
    double s = det > 0 ? clamp01((uv * vr - ur * vv) / det) : 0;
    double t = vv > 0 ? clamp01((uv * s + vr) / vv) : 0;

    /* For that t the best s; where t was clamped, the one above no longer is. */
    s = uu > 0 ? clamp01((uv * t - ur) / uu) : 0;
    Vec w = r + s * u - t * v;
    return dot(w, w);
}

/* A triangle made ready for segment_triangle: corners, and nothing that costs memory. */
struct Corners {
    Vec p, q, r;
};

/*
 * Squared distance of the segment ab and a triangle, for libraries that bring a tree but no such
 * distance: 0 if it crosses; else from the end nearer to the plane if it projects into the
 * triangle, which then nothing beats; else the least of the three edges.
 */
inline double segment_triangle(const Vec &a, const Vec &b, const Corners &t)
{
    Vec e = t.q - t.p, f = t.r - t.q, g = t.p - t.r, n = cross(e, f), u = b - a;
    double nn = dot(n, n), at_a = dot(n, a - t.p), at_b = dot(n, b - t.p);

    if (nn > 0) {
        bool through = at_a * at_b <= 0 && at_a != at_b;
        Vec x = through ? a + (at_a / (at_a - at_b)) * u : std::fabs(at_a) <= std::fabs(at_b) ? a : b;
        if (dot(cross(n, e), x - t.p) >= 0 && dot(cross(n, f), x - t.q) >= 0 && dot(cross(n, g), x - t.r) >= 0) {
            double d = std::min(std::fabs(at_a), std::fabs(at_b));
            return through ? 0 : d * d / nn;
        }
    }
    double uu = dot(u, u);
    return std::min(std::min(segment_segment(a, u, uu, t.p, e), segment_segment(a, u, uu, t.q, f)),
                    segment_segment(a, u, uu, t.r, g));
}

} // namespace peer

#endif
