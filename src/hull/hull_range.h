/* SPDX-License-Identifier: BSD-3-Clause */
/* Planes for a range search about a hull: leaves that lie beyond one of them are passed over. */
#ifndef DPT_HULL_RANGE_H
#define DPT_HULL_RANGE_H

#include "nearest/bvh.h"
#include "nearest/filter_segment.h"

enum { HULL_RANGE_PLANES = 4 };

/*
 * One of the planes, 0..3, of a range search that has begun: what is farther along the unit vector n than `limit`, in m
 * and in the mesh's frame, is out of reach. `size` bounds what limit was made of, from the filter's centre.
 */
static inline void hull_range_set_plane(struct range *range, uint32_t number, vec3 n, double limit, double size)
{
    const struct surface *surface = range->surface;
    const double scale = surface->filter_scale, extent = size * scale;
    const double at = (limit - dot(n, surface->filter_centre)) * scale;
    put_float(n, range->directions[number]);
    range->limits[number] =
        (float)(at + KERNEL_STRETCH * fabs(at) + kernel_margin(extent, extent)) + range->segment.margin;
}

#endif
