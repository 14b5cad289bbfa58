/* SPDX-License-Identifier: BSD-3-Clause */
#include "convex/convex_clip.h"

#include <string.h>

static double along_axis(vec3 p, int axis)
{
    return axis == 0 ? p.x : axis == 1 ? p.y : p.z;
}

/* What of a polygon lies at sign * p[axis] <= limit (Sutherland and Hodgman, 1974). */
static uint32_t clip_by_plane(const vec3 *in, uint32_t count, int axis, double sign, double limit, vec3 *out)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; i++) {
        const vec3 p = in[i], q = in[(i + 1) % count];
        const double a = limit - sign * along_axis(p, axis);
        const double b = limit - sign * along_axis(q, axis);
        if (a >= 0.0)
            out[kept++] = p;
        if ((a >= 0.0) != (b >= 0.0))
            out[kept++] = along(p, a / (a - b), sub(q, p));
    }
    return kept;
}

uint32_t dpti_convex_clip(const vec3 corner[3], double limit, vec3 clipped[CLIPPED_MAX])
{
    /* Room for one corner more than a convex polygon can have: rounding may cross a plane once more. */
    vec3 from[CLIPPED_MAX + 6], to[CLIPPED_MAX + 6];
    uint32_t count = 3;
    memcpy(from, corner, 3 * sizeof *corner);
    for (int side = 0; side < 6 && count; side++) {
        count = clip_by_plane(from, count, side / 2, side % 2 ? 1.0 : -1.0, limit, to);
        count = count < CLIPPED_MAX ? count : CLIPPED_MAX;
        memcpy(from, to, count * sizeof *to);
    }
    memcpy(clipped, from, count * sizeof *from);
    return count;
}
