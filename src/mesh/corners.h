/* SPDX-License-Identifier: BSD-3-Clause */
/* Comparing triangles by their three vertices. */
#ifndef DPT_CORNERS_H
#define DPT_CORNERS_H

#include <stdint.h>

/* 1 if a vertex is one of a triangle's three corners. */
static inline int has_corner(const uint32_t *corners, uint32_t vertex)
{
    return corners[0] == vertex || corners[1] == vertex || corners[2] == vertex;
}

/* How many of the first `count` vertices in `of` are corners of a triangle. */
static inline int shared_corners(const uint32_t *of, int count, const uint32_t *triangle)
{
    int shared = 0;
    for (int k = 0; k < count; k++)
        shared += has_corner(triangle, of[k]);
    return shared;
}

#endif
