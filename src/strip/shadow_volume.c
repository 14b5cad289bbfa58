/* SPDX-License-Identifier: BSD-3-Clause */
#include "strip/shadow_volume.h"

static vec3 unit(vec3 v)
{
    return scaled(v, 1.0 / length(v));
}

/* Any unit vector across a unit one. */
static vec3 across(vec3 d)
{
    double x = fabs(d.x), y = fabs(d.y), z = fabs(d.z);
    vec3 axis = { x <= y && x <= z, y < x && y <= z, z < x && z < y };
    return unit(cross(d, axis));
}

static void put(struct shade *shade, int k, vec3 normal, double low, double high)
{
    shade->normal[0][k] = normal.x;
    shade->normal[1][k] = normal.y;
    shade->normal[2][k] = normal.z;
    shade->low[k] = low;
    shade->high[k] = high;
}

void dpti_shade_of(vec3 a, vec3 u, vec3 direction, double half, double depth, struct shade *shade)
{
    vec3 d = unit(direction), side = cross(d, u);
    int is_line = length(side) > 1e-9 * length(u);
    vec3 w = is_line ? unit(side) : across(d), e = cross(w, d);
    double ue = dot(u, e), ud = dot(u, d);
    double size = sqrt(ue * ue + ud * ud);
    /* Where it is a mere line or plane, two pairs of planes may have nothing in common but for rounding. */
    double slack = 64.0 * 0x1p-53 * (extent_of(a) + size + half + depth);
    *shade = (struct shade){ .a = a, .u = u, .d = d, .e = e, .w = w, .half = half, .depth = depth };
    put(shade, 0, w, -half - slack, half + slack);
    put(shade, 1, e, smaller(0.0, ue) - half - slack, larger(0.0, ue) + half + slack);
    put(shade, 2, d, smaller(0.0, ud) - depth - slack, larger(0.0, ud) + depth + slack);
    if (size > 0.0) {
        double ne = ud / size, nd = -ue / size;
        double limit = half * fabs(ne) + depth * fabs(nd) + slack;
        put(shade, 3, along(scaled(e, ne), nd, d), -limit, limit);
    }
}
