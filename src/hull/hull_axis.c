/* SPDX-License-Identifier: BSD-3-Clause */
/* Along an edge, or between two corners, a hull is thinner than it is across most other directions. */
#include "hull/hull_axis.h"

/* The middle of the corners' extent along a direction. */
static double middle_along(const struct dpt_hull *hull, vec3 n)
{
    const double most = support_of(hull->corner, hull->corner_count, n);
    const double least = -support_of(hull->corner, hull->corner_count, scaled(n, -1.0));
    return 0.5 * (most + least);
}

/* A segment along the unit vector x, and how far corners are from it. It ends where the farthest corners allow. */
static void try_direction(struct dpt_hull *hull, vec3 x)
{
    vec3 across[2], centre = { 0.0, 0.0, 0.0 };
    double farthest = 0.0, low = HUGE_VAL, high = -HUGE_VAL;
    unit_across(x, across);
    for (int k = 0; k < 2; k++)
        centre = along(centre, middle_along(hull, across[k]), across[k]);
    for (uint32_t i = 0; i < hull->corner_count; i++) {
        const vec3 offset = sub(hull->corner[i], centre);
        farthest = max_of(farthest, length(along(offset, -dot(offset, x), x)));
    }
    for (uint32_t i = 0; i < hull->corner_count; i++) {
        const vec3 offset = sub(hull->corner[i], centre);
        const double at = dot(offset, x), off = length(along(offset, -at, x));
        const double spare = sqrt(max_of(0.0, farthest * farthest - off * off));
        low = min_of(low, at + spare);
        high = max_of(high, at - spare);
    }
    if (low > high)
        low = high = 0.5 * (low + high);
    const vec3 a = along(centre, low, x), u = scaled(x, high - low);
    double reach = 0.0;
    for (uint32_t i = 0; i < hull->corner_count; i++) {
        const double s = nearest_on(a, u, hull->corner[i]);
        reach = max_of(reach, length(sub(hull->corner[i], along(a, s, u))));
    }
    if (reach >= hull->reach)
        return;
    hull->axis_a = a;
    hull->axis_b = add(a, u);
    hull->reach = reach;
}

void dpti_hull_set_axis(struct dpt_hull *hull)
{
    hull->reach = HUGE_VAL;
    for (uint32_t i = 0; i < hull->edge_count; i++)
        try_direction(hull, unit_of(sub(hull->corner[hull->edge[i][1]], hull->corner[hull->edge[i][0]])));
    for (uint32_t i = 0; i < hull->corner_count; i++)
        for (uint32_t k = i + 1; k < hull->corner_count; k++)
            try_direction(hull, unit_of(sub(hull->corner[k], hull->corner[i])));
    /* For rounding: frames keep lengths to a few units in the last place. */
    hull->reach *= 1.0 + 0x1p-40;
}
