/* SPDX-License-Identifier: BSD-3-Clause */
/* The nearest pairs of segments over all bodies, where their tool's frame is now. */
#ifndef DPT_SEGMENT_TRACK_H
#define DPT_SEGMENT_TRACK_H

#include "track/world_state.h"

/* A segment's answer of the last tick ends. 0: its tool, or a body, has no valid input, and it gets none in this tick. */
int dpti_track_begin(struct dpt_world *world, uint32_t segment_index);

/* Into segment->answer and segment->result. */
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
