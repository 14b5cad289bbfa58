/* SPDX-License-Identifier: BSD-3-Clause */
/* From an axis in double to the probe that the 16-lane loops take, with the margin of their bounds. */
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

/* The axis a + s u, in the mesh's frame; returns the unit vector along it. Frame and limit are for later. */
static inline vec3 probe_axis(struct probe *probe, const struct surface *surface, vec3 a, vec3 u)
{
    double scale = surface->filter_scale, size = length(u);
    vec3 from = scaled(sub(a, surface->filter_centre), scale);
    vec3 to = along(from, scale, u);
    vec3 x = size > 0.0 ? scaled(u, 1.0 / size) : (vec3){ 1.0, 0.0, 0.0 };
    put_float(from, probe->a);
    put_float(to, probe->b);
    put_float(x, probe->x);
    probe->length = (float)(size * scale);
    probe->margin = (float)kernel_margin(length(from), length(to));
    return x;
}

/* Two unit vectors that make a right-handed frame with the unit vector x. */
static inline void probe_frame(struct probe *probe, vec3 x)
{
    double ax = fabs(x.x), ay = fabs(x.y), az = fabs(x.z);
    vec3 least = { ax <= ay && ax <= az, ay < ax && ay <= az, az < ax && az < ay };
    vec3 y = cross(least, x);
    y = scaled(y, 1.0 / length(y));
    put_float(y, probe->y);
    put_float(cross(x, y), probe->z);
}

/* A bound beyond the limit belongs to what is farther than the distance, not as far. */
static inline void probe_limit(struct probe *probe, const struct surface *surface, double distance)
{
    double stretched = distance * surface->filter_scale * (1.0 + KERNEL_STRETCH);
    probe->limit = (float)stretched + probe->margin;
}

/* How far along a normal the axis goes. */
static inline float probe_reach(const struct probe *probe, const float n[3])
{
    float at_a = n[0] * probe->a[0] + n[1] * probe->a[1] + n[2] * probe->a[2];
    float at_b = n[0] * probe->b[0] + n[1] * probe->b[1] + n[2] * probe->b[2];
    return at_a > at_b ? at_a : at_b;
}

#endif
