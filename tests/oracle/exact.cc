// SPDX-License-Identifier: BSD-3-Clause
#include "oracle/exact.h"

#include <array>
#include <gmpxx.h>
#include <vector>

namespace
{
typedef mpq_class rational;

// x + y sqrt(d); d belongs to a time, so that all numbers of one question have the same.
struct number {
    rational x, y, d;
    number(const rational &value = 0) : x(value), y(0), d(0)
    {
    }
    number(const rational &whole, const rational &part, const rational &square)
        : x(whole), y(part), d(square)
    {
    }
};

const rational &root_of(const number &a, const number &b)
{
    return sgn(a.d) ? a.d : b.d;
}

number operator+(const number &a, const number &b)
{
    return number(a.x + b.x, a.y + b.y, root_of(a, b));
}

number operator-(const number &a, const number &b)
{
    return number(a.x - b.x, a.y - b.y, root_of(a, b));
}

number operator*(const number &a, const number &b)
{
    const rational &d = root_of(a, b);
    return number(a.x * b.x + a.y * b.y * d, a.x * b.y + a.y * b.x, d);
}

int sign(const number &a)
{
    const int x = sgn(a.x), y = sgn(a.d) ? sgn(a.y) : 0;
    if (x == y || !y)
        return x;
    if (!x)
        return y;
    const rational xx = a.x * a.x, yy = a.y * a.y * a.d;
    return xx > yy ? x : xx < yy ? y : 0;
}

typedef std::array<number, 3> point;

point operator-(const point &a, const point &b)
{
    return { a[0] - b[0], a[1] - b[1], a[2] - b[2] };
}

number dot(const point &a, const point &b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

point cross(const point &a, const point &b)
{
    return { a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0] };
}

bool is_zero(const point &a)
{
    return !sign(a[0]) && !sign(a[1]) && !sign(a[2]);
}

bool between(const number &low, const number &value, const number &high)
{
    return sign(value - low) >= 0 && sign(high - value) >= 0;
}

bool point_on_segment(const point &x, const point &p, const point &q)
{
    const point e = q - p, way = x - p;
    if (is_zero(e))
        return is_zero(way);
    return is_zero(cross(way, e)) && between(number(0), dot(way, e), dot(e, e));
}

bool segments_meet(const point &a, const point &b, const point &p, const point &q)
{
    const point u = b - a, e = q - p, way = p - a, n = cross(u, e);
    if (is_zero(n))
        return point_on_segment(a, p, q) || point_on_segment(b, p, q) ||
               point_on_segment(p, a, b) || point_on_segment(q, a, b);
    const number nn = dot(n, n);
    return !sign(dot(n, way)) && between(number(0), dot(cross(way, e), n), nn) &&
           between(number(0), dot(cross(way, u), n), nn);
}

struct triangle {
    point corner[3], edge[3], normal, inward[3];
    bool flat; // it has no area
};

// The point weighted by wa and wb, which are not both 0 and of different signs or 0.
bool inside(const triangle &t, const point &a, const number &wa, const point &b, const number &wb)
{
    const int turn = sign(wa - wb);
    for (int k = 0; k < 3; k++) {
        const number side =
            dot(t.inward[k], a - t.corner[k]) * wa - dot(t.inward[k], b - t.corner[k]) * wb;
        if (sign(side) * turn < 0)
            return false;
    }
    return true;
}

bool segment_meets_triangle(const point &a, const point &b, const triangle &t)
{
    if (!t.flat) {
        const number ha = dot(t.normal, a - t.corner[0]), hb = dot(t.normal, b - t.corner[0]);
        const int sa = sign(ha), sb = sign(hb);
        if (sa * sb > 0)
            return false;
        if (sa || sb)
            return inside(t, a, hb, b, ha);
        if (inside(t, a, number(1), a, number(0)))
            return true;
    }
    for (int k = 0; k < 3; k++)
        if (segments_meet(a, b, t.corner[k], t.corner[(k + 1) % 3]))
            return true;
    return false;
}

// Polynomials in time, of at most the second degree.
typedef std::array<rational, 3> quadratic;

struct line {
    rational at[3], grows[3];
};

line from_point(const line &l, const point &p)
{
    line out = l;
    for (int k = 0; k < 3; k++)
        out.at[k] -= p[k].x;
    return out;
}

line between_lines(const line &a, const line &b)
{
    line out;
    for (int k = 0; k < 3; k++) {
        out.at[k] = b.at[k] - a.at[k];
        out.grows[k] = b.grows[k] - a.grows[k];
    }
    return out;
}

quadratic add_product(const quadratic &q, const line &a, int i, const line &b, int j, int sign)
{
    return { q[0] + sign * a.at[i] * b.at[j],
             q[1] + sign * (a.at[i] * b.grows[j] + a.grows[i] * b.at[j]),
             q[2] + sign * a.grows[i] * b.grows[j] };
}

quadratic dot_lines(const line &a, const line &b)
{
    quadratic q = { 0, 0, 0 };
    for (int k = 0; k < 3; k++)
        q = add_product(q, a, k, b, k, 1);
    return q;
}

quadratic cross_lines(const line &a, const line &b, int k)
{
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    return add_product(add_product({ 0, 0, 0 }, a, i, b, j, 1), a, j, b, i, -1);
}

line still(const point &v)
{
    return { { v[0].x, v[1].x, v[2].x }, { 0, 0, 0 } };
}

bool is_nothing(const quadratic &q)
{
    return !sgn(q[0]) && !sgn(q[1]) && !sgn(q[2]);
}

struct question {
    line a, b, u;
    triangle t;
    rational until;
    bool closed;
};

bool meets_at(const question &q, const number &time)
{
    const int late = sign(time - number(q.until));
    if (sign(time) < 0 || late > 0 || (late == 0 && !q.closed))
        return false;
    point a, b;
    for (int k = 0; k < 3; k++) {
        a[k] = number(q.a.at[k]) + time * number(q.a.grows[k]);
        b[k] = number(q.b.at[k]) + time * number(q.b.grows[k]);
    }
    return segment_meets_triangle(a, b, q.t);
}

bool meets_at_roots(const question &q, const quadratic &p)
{
    if (!sgn(p[2]))
        return sgn(p[1]) && meets_at(q, number(-p[0] / p[1]));
    const rational d = p[1] * p[1] - 4 * p[2] * p[0], middle = -p[1] / (2 * p[2]),
                   apart = 1 / (2 * p[2]);
    if (sgn(d) < 0)
        return false;
    if (!sgn(d))
        return meets_at(q, number(middle));
    return meets_at(q, number(middle, apart, d)) || meets_at(q, number(middle, -apart, d));
}

// Axis and edge always lie in one plane: what changes is where an end of one comes to lie on the
// other.
bool meets_coplanar_edge(const question &q, int k)
{
    const line e = still(q.t.edge[k]), ends[2] = { q.a, q.b };
    for (int i = 0; i < 2; i++) {
        const point &p = q.t.corner[(k + i) % 3];
        for (int j = 0; j < 2; j++) {
            const line way = from_point(ends[j], p);
            if (meets_at_roots(q, dot_lines(way, e)) || meets_at_roots(q, dot_lines(way, q.u)))
                return true;
            for (int m = 0; m < 3; m++)
                if (meets_at_roots(q, cross_lines(way, e, m)) ||
                    meets_at_roots(q, cross_lines(way, q.u, m)) ||
                    meets_at_roots(q, { way.at[m], way.grows[m], 0 }))
                    return true;
        }
    }
    return false;
}

bool meets_edge(const question &q, int k)
{
    const line way = from_point(q.a, q.t.corner[k]);
    quadratic volume = { 0, 0, 0 };
    for (int m = 0; m < 3; m++) {
        const quadratic c = cross_lines(q.u, way, m);
        for (int i = 0; i < 3; i++)
            volume[i] += q.t.edge[k][m].x * c[i];
    }
    return is_nothing(volume) ? meets_coplanar_edge(q, k) : meets_at_roots(q, volume);
}

// An end in the triangle's plane always can only come in over an edge.
bool meets_face(const question &q, const line &end)
{
    return !q.t.flat &&
           meets_at_roots(q, dot_lines(from_point(end, q.t.corner[0]), still(q.t.normal)));
}

point point_of(const double *v)
{
    return { number(rational(v[0])), number(rational(v[1])), number(rational(v[2])) };
}

line line_of(const double *at, const double *grows)
{
    return { { rational(at[0]), rational(at[1]), rational(at[2]) },
             { rational(grows[0]), rational(grows[1]), rational(grows[2]) } };
}
} // namespace

int exact_touch(const double a[3], const double b[3], const double da[3], const double db[3],
                const double corners[9], double until, int closed)
{
    question q;
    q.a = line_of(a, da);
    q.b = line_of(b, db);
    q.u = between_lines(q.a, q.b);
    for (int k = 0; k < 3; k++)
        q.t.corner[k] = point_of(corners + 3 * k);
    for (int k = 0; k < 3; k++)
        q.t.edge[k] = q.t.corner[(k + 1) % 3] - q.t.corner[k];
    q.t.normal = cross(q.t.edge[0], q.t.edge[1]);
    q.t.flat = is_zero(q.t.normal);
    for (int k = 0; k < 3; k++)
        q.t.inward[k] = cross(q.t.normal, q.t.edge[k]);
    q.until = until;
    q.closed = closed;
    if (meets_at(q, number(0)) || meets_face(q, q.a) || meets_face(q, q.b))
        return 1;
    for (int k = 0; k < 3; k++)
        if (meets_edge(q, k))
            return 1;
    return 0;
}
