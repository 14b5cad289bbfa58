/* SPDX-License-Identifier: BSD-3-Clause */
#include "strip/shadow_volume.h"

static void put_slab(struct shadow_volume *volume, int slab, vec3 normal, double low, double high)
{
    volume->normal[0][slab] = normal.x;
    volume->normal[1][slab] = normal.y;
    volume->normal[2][slab] = normal.z;
    volume->low[slab] = low;
    volume->high[slab] = high;
}

void dpti_shadow_volume_of(vec3 a, vec3 u, vec3 direction, double half_width, double depth,
                           struct shadow_volume *volume)
{
    vec3 d = unit_of(direction), side = cross(d, u), across[2];
    int is_aslant = length(side) > 1e-9 * length(u);
    unit_across(d, across);
    vec3 w = is_aslant ? unit_of(side) : across[0], e = cross(w, d);
    double ue = dot(u, e), ud = dot(u, d);
    double projected_length = sqrt(ue * ue + ud * ud);
    /* A shadow that is a mere line or plane might be empty by rounding: the slabs get a little slack. */
    double slack = 64.0 * 0x1p-53 * (extent_of(a) + projected_length + half_width + depth);
    *volume =
        (struct shadow_volume){ .a = a, .u = u, .d = d, .e = e, .w = w, .half_width = half_width, .depth = depth };
    put_slab(volume, 0, w, -half_width - slack, half_width + slack);
    put_slab(volume, 1, e, min_of(0.0, ue) - half_width - slack, max_of(0.0, ue) + half_width + slack);
    put_slab(volume, 2, d, min_of(0.0, ud) - depth - slack, max_of(0.0, ud) + depth + slack);
    if (projected_length > 0.0) {
        double ne = ud / projected_length, nd = -ue / projected_length;
        double half_extent = half_width * fabs(ne) + depth * fabs(nd) + slack;
        put_slab(volume, 3, along(scaled(e, ne), nd, d), -half_extent, half_extent);
    }
}
