/* SPDX-License-Identifier: BSD-3-Clause */
/* A segment's nearest pair over all bodies, where its tool's frame is now. */
#ifndef DPT_SEGMENT_TRACK_H
#define DPT_SEGMENT_TRACK_H

#include "world/world_state.h"

/* Into segment->answer and segment->result; by the paper's method also its contact. */
void dpti_track_segment(struct dpt_world *world, uint32_t segment_index);

#endif
