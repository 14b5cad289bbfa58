/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * With a budget: how far bodies are proven to be from a segment, by searches that ended and by those that a budget
 * stopped. What was proven stays proven, less what the axis moved: docs/algorithms/budget.md.
 */
#ifndef DPT_DISTANCE_BOUNDS_H
#define DPT_DISTANCE_BOUNDS_H

#include "world/world_state.h"

/* Its share of dpt_world_bytes. */
uint64_t dpti_bounds_bytes(const dpt_world_def *def);

/* Place its memory at `at`; returns where it ends. */
char *dpti_bounds_place(struct dpt_world *world, char *at);

/* Forget what is proven of a segment and a body or, with DPT_NONE, all bodies, and the searches that wait. */
void dpti_bounds_forget(struct dpt_world *world, uint32_t segment_index, uint32_t slot);

/* Remove the segments from `first` up to, not including, `end`: those behind them move up. */
void dpti_bounds_remove(struct dpt_world *world, uint32_t first, uint32_t end);

/* A search is given up: what it has proven stays. */
void dpti_bounds_give_up(struct dpt_world *world, uint32_t segment_index,
                         struct suspended_search *suspended);

/*
 * Bring what is proven of a body up to date; returns how far the ends moved. A search that was stopped stays valid
 * when the axis moves, but its answer will only be bounded. One at rest ends with the rest; that of the motion before
 * waits for the motion after, which may come with the next tick: of a device that is slower than the loop.
 */
double dpti_bounds_update(struct dpt_world *world, uint32_t segment_index, uint32_t slot,
                          const struct axis *axis);

/* All that is proven of a body. */
double dpti_bounds_proven(const struct dpt_world *world, uint32_t segment_index, uint32_t slot);

#endif
