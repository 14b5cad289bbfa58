/* SPDX-License-Identifier: BSD-3-Clause */
/* Triangles by the three vertices at their corners. */
#ifndef DPT_CORNERS_H
#define DPT_CORNERS_H

#include <stdint.h>

static inline int has_corner(const uint32_t *corners, uint32_t vertex)
{
    return corners[0] == vertex || corners[1] == vertex || corners[2] == vertex;
}

/* How many of the first `count` corners of `of` a triangle has. */
static inline int shared_corners(const uint32_t *of, int count, const uint32_t *triangle)
{
    int shared = 0;
    for (int k = 0; k < count; k++)
        shared += has_corner(triangle, of[k]);
    return shared;
}

#endif
