/* SPDX-License-Identifier: BSD-3-Clause */
/* One tick of the paper's method for one segment: a dynamic point per part and body. */
#ifndef DPT_BASELINE_METHOD_H
#define DPT_BASELINE_METHOD_H

#include "contact/gap.h"
#include "world/world_state.h"

/*
 * Find the dynamic points of a segment, whose axis is from `a` to `b` in the world, on all bodies. The nearest of
 * them becomes the segment's answer; its result also has the smallest gap of all parts. Returns the penetration
 * (world) of the part with that gap; zero without a body.
 */
struct penetration dpti_baseline_find(struct dpt_world *world, uint32_t segment_index, vec3 a,
                                      vec3 b);

#endif
