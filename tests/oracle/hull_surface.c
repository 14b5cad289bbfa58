/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The search and the motions of hull_surface.h. See there for what they may be trusted with.
 */
#include "oracle/hull_surface.h"

#include <math.h>
#include <string.h>

typedef long double wide;

void oracle_triangle_at(const struct oracle_triangles *triangles, uint32_t which, double time, double out[9])
{
    for (uint32_t k = 0; k < 9; k++) {
        out[k] = triangles->corners[9 * (size_t)which + k];
        if (triangles->shift)
            out[k] += time * triangles->shift[9 * (size_t)which + k];
    }
}

static double size_of(const double a[3])
{
    return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

/* Where a triangle's corners are in the mean; returns how far the farthest is from there. */
static double ball_of(const double triangle[9], double centre[3])
{
    double radius = 0.0;
    for (int k = 0; k < 3; k++)
        centre[k] = (triangle[k] + triangle[3 + k] + triangle[6 + k]) / 3.0;
    for (int i = 0; i < 9; i += 3) {
        const double off[3] = { triangle[i] - centre[0], triangle[i + 1] - centre[1], triangle[i + 2] - centre[2] };
        radius = fmax(radius, size_of(off));
    }
    return radius;
}

/* A lower bound of the distance: to the ball around the triangle, along the way there from the hull's middle. */
static double ball_bound(const double *corners, uint32_t count, const double middle[3], const double triangle[9])
{
    double centre[3], way[3], extent = 0.0, most = -INFINITY;
    const double radius = ball_of(triangle, centre);
    for (int k = 0; k < 3; k++) {
        way[k] = centre[k] - middle[k];
        extent = fmax(extent, fmax(fabs(centre[k]), fabs(middle[k])));
    }
    const double size = size_of(way);
    if (!(size > 0.0))
        return 0.0;
    for (uint32_t i = 0; i < count; i++)
        most = fmax(most, way[0] * (corners[3 * i] - centre[0]) + way[1] * (corners[3 * i + 1] - centre[1]) +
                              way[2] * (corners[3 * i + 2] - centre[2]));
    return -most / size - radius - 1e-12 * (extent + size + radius);
}

/* The triangle whose middle is nearest to a point: not the answer, but something to begin with. */
static uint32_t likely(const struct oracle_triangles *triangles, double time, const double x[3])
{
    uint32_t nearest = 0;
    double least = INFINITY;
    for (uint32_t t = 0; t < triangles->count; t++) {
        double triangle[9], off[3];
        oracle_triangle_at(triangles, t, time, triangle);
        for (int k = 0; k < 3; k++)
            off[k] = (triangle[k] + triangle[3 + k] + triangle[6 + k]) / 3.0 - x[k];
        if (size_of(off) < least) {
            least = size_of(off);
            nearest = t;
        }
    }
    return nearest;
}

struct oracle_interval oracle_hull_surface(const double *corners, uint32_t count,
                                           const struct oracle_triangles *triangles, double time, double limit,
                                           uint32_t *nearest)
{
    struct oracle_interval best = { INFINITY, INFINITY };
    uint32_t found = UINT32_MAX;
    double middle[3] = { 0.0, 0.0, 0.0 };
    for (uint32_t i = 0; i < 3 * count; i++)
        middle[i % 3] += corners[i] / count;
    const uint32_t first = likely(triangles, time, middle);
    for (uint32_t i = 0; i <= triangles->count && triangles->count; i++) {
        const uint32_t t = i ? i - 1 : first;
        double triangle[9];
        oracle_triangle_at(triangles, t, time, triangle);
        if ((i && t == first) || ball_bound(corners, count, middle, triangle) > fmin(limit, best.upper))
            continue;
        const struct oracle_interval one = oracle_hull_triangle(corners, count, triangle, NULL);
        best.lower = fmin(best.lower, one.lower);
        if (one.upper < best.upper) {
            best.upper = one.upper;
            found = t;
        }
    }
    /* What was passed over is farther than the limit. */
    if (!(best.upper < limit))
        best.lower = fmin(best.lower, limit);
    if (nearest)
        *nearest = found;
    return best;
}

/* ---- motions ---- */

static wide quaternion_dot(const double *a, const double *b)
{
    wide sum = 0;
    for (int k = 0; k < 4; k++)
        sum += (wide)a[k] * b[k];
    return sum;
}

/* The angle of the shorter arc between two orientations, as quaternions: half that of the turn. */
static wide arc_of(const double *from, const double *to)
{
    const wide sign = quaternion_dot(from, to) < 0 ? -1 : 1;
    wide apart = 0, together = 0;
    for (int k = 0; k < 4; k++) {
        const wide d = sign * to[k] - from[k], s = sign * to[k] + from[k];
        apart += d * d;
        together += s * s;
    }
    return 2 * atan2l(sqrtl(apart), sqrtl(together));
}

static void orientation_at(const double *from, const double *to, wide time, wide out[4])
{
    const wide sign = quaternion_dot(from, to) < 0 ? -1 : 1, arc = arc_of(from, to);
    wide square = 0;
    for (int k = 0; k < 4; k++) {
        const wide a = from[k], b = sign * to[k];
        out[k] = arc > 1e-9L ? (sinl((1 - time) * arc) * a + sinl(time * arc) * b) / sinl(arc) : a + time * (b - a);
        square += out[k] * out[k];
    }
    for (int k = 0; k < 4; k++)
        out[k] /= sqrtl(square);
}

/* x turned by q: x + 2 w (v x) + 2 v (v x), products across. */
static void turn(const wide q[4], wide x[3])
{
    wide c[3], d[3];
    for (int k = 0; k < 3; k++)
        c[k] = q[1 + (k + 1) % 3] * x[(k + 2) % 3] - q[1 + (k + 2) % 3] * x[(k + 1) % 3];
    for (int k = 0; k < 3; k++)
        d[k] = q[1 + (k + 1) % 3] * c[(k + 2) % 3] - q[1 + (k + 2) % 3] * c[(k + 1) % 3];
    for (int k = 0; k < 3; k++)
        x[k] += 2 * (q[0] * c[k] + d[k]);
}

static wide position_at(const dpt_pose *from, const dpt_pose *to, wide time, int k)
{
    return from->position[k] + time * ((wide)to->position[k] - from->position[k]);
}

void oracle_motion_at(const struct oracle_motion *motion, double time, const double *points, uint32_t count,
                      double *out)
{
    wide tool[4], body[4], back[4];
    orientation_at(motion->tool_from.orientation, motion->tool_to.orientation, time, tool);
    orientation_at(motion->body_from.orientation, motion->body_to.orientation, time, body);
    for (int k = 0; k < 4; k++)
        back[k] = k ? -body[k] : body[k];
    for (uint32_t i = 0; i < count; i++) {
        wide x[3] = { points[3 * i], points[3 * i + 1], points[3 * i + 2] };
        turn(tool, x);
        for (int k = 0; k < 3; k++)
            x[k] += position_at(&motion->tool_from, &motion->tool_to, time, k) -
                    position_at(&motion->body_from, &motion->body_to, time, k);
        turn(back, x);
        for (int k = 0; k < 3; k++)
            out[3 * i + (uint32_t)k] = (double)x[k];
    }
}

double oracle_motion_speed(const struct oracle_motion *motion, const double *points, uint32_t count)
{
    const double tool_turn = 2.0 * (double)arc_of(motion->tool_from.orientation, motion->tool_to.orientation);
    const double body_turn = 2.0 * (double)arc_of(motion->body_from.orientation, motion->body_to.orientation);
    double from[3], to[3], way[3], reach = 0.0;
    for (int k = 0; k < 3; k++) {
        from[k] = motion->tool_from.position[k] - motion->body_from.position[k];
        to[k] = motion->tool_to.position[k] - motion->body_to.position[k];
        way[k] = to[k] - from[k];
    }
    for (uint32_t i = 0; i < count; i++)
        reach = fmax(reach, size_of(points + 3 * i));
    /* Of a point on a line between two, the distance from a third is greatest at an end. */
    const double arm = fmax(size_of(from), size_of(to)) + reach;
    return (size_of(way) + tool_turn * reach + body_turn * arm) * (1.0 + 1e-12);
}

static double fastest(const struct oracle_triangles *triangles)
{
    double most = 0.0;
    for (size_t i = 0; i < 3 * (size_t)triangles->count && triangles->shift; i++)
        most = fmax(most, size_of(triangles->shift + 3 * i));
    return most;
}

struct oracle_meeting oracle_first_meeting(const struct oracle_motion *motion, const double *points, uint32_t count,
                                           const struct oracle_triangles *triangles, double within, double slack,
                                           uint32_t steps)
{
    const double speed = oracle_motion_speed(motion, points, count) + fastest(triangles);
    struct oracle_meeting meeting = { 0.0, 2.0 };
    double corners[3 * ORACLE_CORNERS];
    for (uint32_t i = 0; i < steps; i++) {
        oracle_motion_at(motion, meeting.free_until, points, count, corners);
        const struct oracle_interval apart = oracle_hull_surface(
            corners, count, triangles, meeting.free_until, within + speed * (1.0 - meeting.free_until) + slack, NULL);
        if (apart.upper < within + slack) {
            meeting.met_at = meeting.free_until;
            break;
        }
        if (!(apart.lower > within))
            break;
        const double next = meeting.free_until + (apart.lower - within) / speed;
        if (!(next < 1.0)) {
            meeting.free_until = 1.0;
            break;
        }
        meeting.free_until = next;
    }
    return meeting;
}
