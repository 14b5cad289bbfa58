/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Make a struct filter_segment, the float axis of the 16-lane loops, from an axis in double. The order of calls is
 * set_axis, then set_frame (only for loops that use y and z), then set_limit.
 */
#ifndef DPT_FILTER_SEGMENT_H
#define DPT_FILTER_SEGMENT_H

#include "kernel/kernel_ops.h"
#include "mesh/surface.h"

static inline void put_float(vec3 v, float out[3])
{
    out[0] = (float)v.x;
    out[1] = (float)v.y;
    out[2] = (float)v.z;
}

/*
 * Set ends, length, direction x and margin from the axis a + s u, in the mesh's frame, in m. y, z and limit stay unset.
 * Returns the unit vector along u; (1, 0, 0) where u is 0.
 */
static inline vec3 filter_segment_set_axis(struct filter_segment *segment, const struct surface *surface, vec3 a,
                                           vec3 u)
{
    double scale = surface->filter_scale, size = length(u);
    vec3 from = scaled(sub(a, surface->filter_centre), scale);
    vec3 to = along(from, scale, u);
    vec3 x = size > 0.0 ? scaled(u, 1.0 / size) : (vec3){ 1.0, 0.0, 0.0 };
    put_float(from, segment->a);
    put_float(to, segment->b);
    put_float(x, segment->x);
    segment->length = (float)(size * scale);
    segment->margin = (float)(kernel_margin(length(from), length(to)) + surface_margin(surface));
    return x;
}

/* Set y and z to unit vectors that make a right-handed frame with the unit vector x. */
static inline void filter_segment_set_frame(struct filter_segment *segment, vec3 x)
{
    double ax = fabs(x.x), ay = fabs(x.y), az = fabs(x.z);
    vec3 thin_axis = { ax <= ay && ax <= az, ay < ax && ay <= az, az < ax && az < ay };
    vec3 y = cross(thin_axis, x);
    y = scaled(y, 1.0 / length(y));
    put_float(y, segment->y);
    put_float(cross(x, y), segment->z);
}

/* Set the limit for a distance in m: a lane whose bound exceeds the limit is farther than that, and not as far. */
static inline void filter_segment_set_limit(struct filter_segment *segment, const struct surface *surface,
                                            double distance)
{
    double stretched = distance * surface->filter_scale * (1.0 + KERNEL_STRETCH);
    segment->limit = (float)stretched + segment->margin;
}

/* The larger of n.A and n.B over the ends of the axis, in the filter's frame. */
static inline float filter_segment_support(const struct filter_segment *segment, const float n[3])
{
    float at_a = n[0] * segment->a[0] + n[1] * segment->a[1] + n[2] * segment->a[2];
    float at_b = n[0] * segment->b[0] + n[1] * segment->b[1] + n[2] * segment->b[2];
    return at_a > at_b ? at_a : at_b;
}

#endif
