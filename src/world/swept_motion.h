/* SPDX-License-Identifier: BSD-3-Clause */
/* What a segment met on its way from the last tick to this one: docs/algorithms/travel.md. */
#ifndef DPT_SWEPT_MOTION_H
#define DPT_SWEPT_MOTION_H

#include "world/world_state.h"

/*
 * Sweep a segment whose nearest pair is known, this tick. Fills segment->sweep and segment->passed; the sides from which open
 * sheets were met go to the regions of the last tick. 0: a part of the way is still to be swept, in the next tick.
 */
int travel_find(struct dpt_world *world, uint32_t segment);

/* The tick ends: the next motion begins here, or nowhere if there is no valid answer. */
void travel_end(struct dpt_world *world, uint32_t segment);

#endif
