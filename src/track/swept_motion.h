/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The sweep of a segment from the last tick to this one, and the motion steps that wait because the work of a tick is
 * limited: docs/algorithms/swept_motion.md.
 */
#ifndef DPT_SWEPT_MOTION_H
#define DPT_SWEPT_MOTION_H

#include "track/world_state.h"

/* Its share of dpt_world_bytes. */
uint64_t dpti_backlog_bytes(const dpt_world_def *def);

/* Place its memory at `at`; returns where it ends. */
char *dpti_backlog_place(struct dpt_world *world, char *at);

/* Forget where a segment was, and its motion steps. */
void dpti_backlog_forget(struct dpt_world *world, uint32_t segment_index);

/* After a body is removed or teleported: the sweep of each segment's first step starts again at its first body. */
void dpti_backlog_restart(struct dpt_world *world);

/* Remove the steps of the segments from `first` up to, not including, `end`; those of later segments move up. */
void dpti_backlog_remove(struct dpt_world *world, uint32_t first, uint32_t end);

/*
 * Sweep a segment's motion. Its nearest pair must be known in this tick. Sets the segment's `sweep` and
 * `may_have_crossed`, and stores the sides from which the axis came through open sheets with last tick's contacts.
 * Returns 0 if a part of the motion still has to be swept in later ticks, else 1.
 */
int dpti_backlog_sweep(struct dpt_world *world, uint32_t segment_index);

/* End a tick: the next motion begins at the segment's present place, unless steps are still waiting. Without a valid
 * answer no motion begins. */
void dpti_backlog_end_tick(struct dpt_world *world, uint32_t segment_index);

/* Write the hit of a sweep with `body` as users get it; `sweep` keeps its segment and age. */
void dpti_motion_write_sweep(const struct rigid_sweep *rigid, const struct body *body, dpt_sweep *sweep);

#endif
