// SPDX-License-Identifier: BSD-3-Clause
#include "oracle/moving.h"
#include "oracle/root.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace
{
typedef std::array<polynomial, 3> point;

point operator-(const point &a, const point &b)
{
    return { a[0] - b[0], a[1] - b[1], a[2] - b[2] };
}

polynomial dot(const point &a, const point &b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

point cross(const point &a, const point &b)
{
    return { a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0] };
}

// A pair of points that exists where `size` is more than 0 and all of `within` are 0 or more. Then the sum of the
// squares of `apart` is its distance^2 times size.
struct pair {
    std::vector<polynomial> within, apart;
    polynomial size;
};

pair two_points(const point &x, const point &y)
{
    const point way = x - y;
    return { {}, { way[0], way[1], way[2] }, { 1 } };
}

// A point and the line through p and q.
pair point_and_line(const point &x, const point &p, const point &q)
{
    const point e = q - p, way = x - p, across = cross(way, e);
    const polynomial ee = dot(e, e), along = dot(way, e);
    return { { along, ee - along }, { across[0], across[1], across[2] }, ee };
}

pair two_lines(const point &a, const point &b, const point &p, const point &q)
{
    const point u = b - a, e = q - p, way = p - a, n = cross(u, e);
    const polynomial nn = dot(n, n), s = dot(cross(way, e), n), r = dot(cross(way, u), n);
    return { { s, nn - s, r, nn - r }, { dot(n, way) }, nn };
}

struct triangle {
    point corner[3], normal, inward[3];
};

triangle triangle_of(const point *corner)
{
    triangle t;
    point edge[3];
    for (int k = 0; k < 3; k++) {
        t.corner[k] = corner[k];
        edge[k] = corner[(k + 1) % 3] - corner[k];
    }
    t.normal = cross(edge[0], edge[1]);
    for (int k = 0; k < 3; k++)
        t.inward[k] = cross(t.normal, edge[k]);
    return t;
}

pair point_and_plane(const point &x, const triangle &t)
{
    pair out = { {}, { dot(t.normal, x - t.corner[0]) }, dot(t.normal, t.normal) };
    for (int k = 0; k < 3; k++)
        out.within.push_back(dot(t.inward[k], x - t.corner[k]));
    return out;
}

// The point in which the segment goes through the plane, with itself.
pair through_plane(const point &a, const point &b, const triangle &t)
{
    const polynomial ha = dot(t.normal, a - t.corner[0]), hb = dot(t.normal, b - t.corner[0]);
    const polynomial turn = hb - ha;
    pair out = { { polynomial() - ha * hb }, {}, turn * turn };
    for (int k = 0; k < 3; k++)
        out.within.push_back(turn * (dot(t.inward[k], a - t.corner[k]) * hb -
                                     dot(t.inward[k], b - t.corner[k]) * ha));
    return out;
}

struct question {
    point end[2], corner[3];
    mpz_class radius;
};

// Every pair that may be the nearest one, but that in which the segment goes through.
std::vector<pair> pairs_of(const question &q, const triangle &t)
{
    std::vector<pair> pairs;
    for (int i = 0; i < 2; i++)
        pairs.push_back(point_and_plane(q.end[i], t));
    for (int k = 0; k < 3; k++) {
        const point &p = q.corner[k], &next = q.corner[(k + 1) % 3];
        pairs.push_back(two_lines(q.end[0], q.end[1], p, next));
        pairs.push_back(point_and_line(p, q.end[0], q.end[1]));
        for (int i = 0; i < 2; i++) {
            pairs.push_back(point_and_line(q.end[i], p, next));
            pairs.push_back(two_points(q.end[i], p));
        }
    }
    return pairs;
}

// With a radius it is 0 or more where the pair's distance is the radius or less; without, it is 0 there.
polynomial nearness(const pair &p, const mpz_class &radius)
{
    polynomial near;
    if (!sgn(radius)) {
        for (const polynomial &f : p.apart)
            near = common_divisor(near, f);
        return near;
    }
    near = polynomial(1, radius * radius) * p.size;
    for (const polynomial &f : p.apart)
        near = near - f * f;
    return near;
}

bool is_near(const pair &p, const polynomial &near, const mpz_class &radius, moment &when)
{
    const int sign = sign_at(near, when);
    if (sgn(radius) ? sign < 0 : sign != 0)
        return false;
    if (sign_at(p.size, when) <= 0)
        return false;
    for (const polynomial &f : p.within)
        if (sign_at(f, when) < 0)
            return false;
    return true;
}

// A double as a whole number times a power of 2.
struct binary {
    mpz_class whole;
    long exponent;
    explicit binary(double value) : whole(0), exponent(0)
    {
        int power;
        const double fraction = frexp(value, &power);
        if (value == 0.0)
            return;
        whole = ldexp(fraction, 53);
        exponent = power - 53;
        const mp_bitcnt_t zeros = mpz_scan1(whole.get_mpz_t(), 0);
        whole >>= zeros;
        exponent += (long)zeros;
    }
};

// All lengths times one power of 2, so that they are whole.
struct scale {
    long bits;
    explicit scale(const moving_pair &p, double limit) : bits(0)
    {
        take(p.a, 3), take(p.b, 3), take(p.da, 3), take(p.db, 3);
        take(p.corner, 9), take(p.shift, 9), take(&limit, 1);
    }
    void take(const double *v, int count)
    {
        for (int i = 0; i < count; i++)
            bits = std::max(bits, -binary(v[i]).exponent);
    }
    mpz_class operator()(double value) const
    {
        const binary b(value);
        return b.whole << (unsigned long)(b.exponent + bits);
    }
};

// In motion; or at a time, at rest.
polynomial coordinate(const scale &whole, double at, double grows, const double *time)
{
    polynomial out = { whole(at), whole(grows) };
    if (time) {
        const binary t(*time);
        const unsigned long down = t.exponent < 0 ? (unsigned long)-t.exponent : 0;
        const unsigned long up = t.exponent < 0 ? 0 : (unsigned long)t.exponent;
        out = { (out[0] << down) + ((out[1] * t.whole) << up) };
    }
    return out + polynomial();
}

question question_of(const moving_pair &p, double limit, const double *time)
{
    const scale whole(p, limit);
    question q;
    for (int k = 0; k < 3; k++) {
        q.end[0][k] = coordinate(whole, p.a[k], p.da[k], time);
        q.end[1][k] = coordinate(whole, p.b[k], p.db[k], time);
        for (int j = 0; j < 3; j++)
            q.corner[j][k] = coordinate(whole, p.corner[3 * j + k], p.shift[3 * j + k], time);
    }
    const polynomial r = coordinate(whole, limit, 0.0, time);
    q.radius = r.empty() ? mpz_class(0) : r[0];
    return q;
}

struct candidate {
    moment when;
    double from; // it is not earlier
};

double not_after(const moment &when)
{
    long exponent;
    const double fraction = mpz_get_d_2exp(&exponent, when.m.get_mpz_t());
    return ldexp(fraction, (int)(exponent - (long)when.k));
}
} // namespace

int moving_within(const moving_pair *pair_at, double time, double limit)
{
    const question q = question_of(*pair_at, limit, &time);
    const triangle t = triangle_of(q.corner);
    std::vector<pair> pairs = pairs_of(q, t);
    pairs.push_back(through_plane(q.end[0], q.end[1], t));
    moment any = { {}, 0, 0, 0 };
    for (const pair &p : pairs)
        if (is_near(p, nearness(p, q.radius), q.radius, any))
            return 1;
    return 0;
}

int moving_first(const moving_pair *moving, double *low, double *high)
{
    if (moving_within(moving, 0.0, moving->radius)) {
        *low = *high = 0.0;
        return 1;
    }
    const question q = question_of(*moving, moving->radius, nullptr);
    const std::vector<pair> pairs = pairs_of(q, triangle_of(q.corner));
    std::vector<polynomial> near;
    std::vector<candidate> all;
    for (const pair &p : pairs) {
        near.push_back(nearness(p, q.radius));
        for (const moment &when : roots_of(near.back()))
            all.push_back({ when, not_after(when) });
    }
    std::sort(all.begin(), all.end(),
              [](const candidate &x, const candidate &y) { return x.from < y.from; });
    bool found = false;
    for (candidate &c : all) {
        bool touches = false;
        if (found && c.from > *high)
            break;
        for (size_t i = 0; i < pairs.size() && !touches; i++)
            touches = is_near(pairs[i], near[i], q.radius, c.when);
        if (!touches)
            continue;
        double from, to;
        doubles_around(c.when, &from, &to);
        if (!found || from < *low || (from == *low && to < *high))
            *low = from, *high = to;
        found = true;
    }
    if (!found && moving_within(moving, 1.0, moving->radius)) {
        *low = *high = 1.0;
        found = true;
    }
    return found;
}
