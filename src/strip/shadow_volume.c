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

static void put_slab(struct shadow_volume *volume, int k, vec3 normal, double low, double high)
{
    volume->normal[0][k] = normal.x;
    volume->normal[1][k] = normal.y;
    volume->normal[2][k] = normal.z;
    volume->low[k] = low;
    volume->high[k] = high;
}

void dpti_shadow_volume_of(vec3 a, vec3 u, vec3 direction, double half, double depth,
                           struct shadow_volume *volume)
{
    vec3 d = unit(direction), side = cross(d, u);
    int is_line = length(side) > 1e-9 * length(u);
    vec3 w = is_line ? unit(side) : across(d), e = cross(w, d);
    double ue = dot(u, e), ud = dot(u, d);
    double size = sqrt(ue * ue + ud * ud);
    /* Where it is a mere line or plane, two pairs of planes may have nothing in common but for rounding. */
    double slack = 64.0 * 0x1p-53 * (extent_of(a) + size + half + depth);
    *volume = (struct shadow_volume){
        .a = a, .u = u, .d = d, .e = e, .w = w, .half_width = half, .depth = depth
    };
    put_slab(volume, 0, w, -half - slack, half + slack);
    put_slab(volume, 1, e, min_of(0.0, ue) - half - slack, max_of(0.0, ue) + half + slack);
    put_slab(volume, 2, d, min_of(0.0, ud) - depth - slack, max_of(0.0, ud) + depth + slack);
    if (size > 0.0) {
        double ne = ud / size, nd = -ue / size;
        double limit = half * fabs(ne) + depth * fabs(nd) + slack;
        put_slab(volume, 3, along(scaled(e, ne), nd, d), -limit, limit);
    }
}
