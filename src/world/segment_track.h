/* SPDX-License-Identifier: BSD-3-Clause */
/* The nearest pairs of segments over all bodies, where their tool's frame is now. */
#ifndef DPT_SEGMENT_TRACK_H
#define DPT_SEGMENT_TRACK_H

#include "world/world_state.h"

/* Into segment->answer and segment->result; by the paper's method also its contact. */
void dpti_track_segment(struct dpt_world *world, uint32_t segment_index);

/*
 * The same of all segments of a tool with `near_only`, the one first that was nearest before. Those that are far are not
 * searched for (far_segment.h). `all_outside`: the whole tool is known to be outside of everything; else what is known
 * of each segment counts.
 */
void dpti_track_near(struct dpt_world *world, struct tool *tool, int all_outside);

/* Search after all for the pair of a segment that was left as far, where it is. */
void dpti_track_far(struct dpt_world *world, uint32_t segment_index);

#endif
