/* SPDX-License-Identifier: BSD-3-Clause */
/* One tick of the paper's method for one segment: a dynamic point per part and body. */
#ifndef DPT_BASELINE_METHOD_H
#define DPT_BASELINE_METHOD_H

#include "track/world_state.h"

/*
 * Find the dynamic points of a segment on all bodies. The nearest of them becomes the segment's answer; its result also
 * has the smallest gap of all parts, and the part with that gap is the segment's penetration.
 */
void dpti_baseline_track(struct dpt_world *world, uint32_t segment_index);

#endif
