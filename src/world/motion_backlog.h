/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a segment met on its way from the last tick to this one, and, with a budget, the motions that are still to be
 * swept: docs/algorithms/swept_motion.md.
 */
#ifndef DPT_MOTION_BACKLOG_H
#define DPT_MOTION_BACKLOG_H

#include "world/world_state.h"

/* Its share of dpt_world_bytes. */
uint64_t dpti_backlog_bytes(const dpt_world_def *def);

/* Place its memory at `at`; returns where it ends. */
char *dpti_backlog_place(struct dpt_world *world, char *at);

/* Forget where a segment was, and its motions that wait. */
void dpti_backlog_forget(struct dpt_world *world, uint32_t segment_index);

/* A body was removed: the motion that is being swept starts again, of each segment. */
void dpti_backlog_restart(struct dpt_world *world);

/* Remove the segments from `first` up to, not including, `end`: those behind them move up. */
void dpti_backlog_remove(struct dpt_world *world, uint32_t first, uint32_t end);

/*
 * Sweep a segment whose nearest pair is known, this tick. Fills segment->sweep and segment->passed; the sides from
 * which open sheets were met go to the regions of the last tick. 0: a part of the way is still to be swept, in the
 * next tick.
 */
int dpti_backlog_sweep(struct dpt_world *world, uint32_t segment_index);

/* The tick ends: the next motion begins here, or nowhere if there is no valid answer. */
void dpti_backlog_end_tick(struct dpt_world *world, uint32_t segment_index);

#endif
