/* SPDX-License-Identifier: BSD-3-Clause */
/* One tick of the paper's method for one segment: a dynamic point per part and body. */
#ifndef DPT_BASELINE_METHOD_H
#define DPT_BASELINE_METHOD_H

#include "contact/gap.h"
#include "world/world_state.h"

/*
 * The nearest of all dynamic points becomes the segment's found and result, with the least gap of all; returns the
 * push of the part with that gap.
 */
struct penetration dpti_baseline_find(struct dpt_world *world, uint32_t segment_index, vec3 a,
                                      vec3 b);

#endif
