/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef DPT_CONVEX_CLIP_H
#define DPT_CONVEX_CLIP_H

#include "base/vec3.h"

/* A triangle has at most so many corners within a box. */
enum { CLIPPED_MAX = 9 };

/*
 * The part of a triangle within `limit` of the origin along each axis: its corners, in order. Returns how many; 0 where
 * nothing is left. A triangle that lies within has its own corners, as they are.
 */
uint32_t dpti_convex_clip(const vec3 corner[3], double limit, vec3 clipped[CLIPPED_MAX]);

#endif
