/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * With a budget: proven lower bounds of the distance between a segment and each body, by finished and by suspended
 * searches. A bound stays valid in later ticks, less the motion of the axis: docs/algorithms/budget.md.
 */
#ifndef DPT_DISTANCE_BOUNDS_H
#define DPT_DISTANCE_BOUNDS_H

#include "track/world_state.h"

/* Its share of dpt_world_bytes. */
uint64_t dpti_bounds_bytes(const dpt_world_def *def);

/* Place its memory at `at`; returns where it ends. */
char *dpti_bounds_place(struct dpt_world *world, char *at);

/* Forget a segment's bounds and suspended searches, of the body in `slot` or, with DPT_NONE, of all. */
void dpti_bounds_forget(struct dpt_world *world, uint32_t segment_index, uint32_t slot);

/* Remove the data of the segments from `first` up to, not including, `end`; that of later segments moves up. */
void dpti_bounds_remove(struct dpt_world *world, uint32_t first, uint32_t end);

/* Vertices of the body in `slot` have moved, by at most `moved`, m: the next update counts it. */
void dpti_bounds_note_motion(struct dpt_world *world, uint32_t segment_index, uint32_t slot, double moved);

/* End a suspended search for good. What it has proven goes into the bound of its body. */
void dpti_bounds_give_up(struct dpt_world *world, uint32_t segment_index, struct suspended_search *suspended);

/*
 * Update a segment's bound of the body in `slot` to this tick's axis. Returns how far the axis' ends have moved in
 * the body's frame since the last update, vertices that moved included (m), exactly 0 at rest.
 *
 * A suspended search of a motion stays valid when the axis moves, but can then only give a bound. A suspended search
 * of a rest is given up when the axis moves. During a rest the search of the motion waits: a device that is slower
 * than the loop moves again in the next tick.
 */
double dpti_bounds_update(struct dpt_world *world, uint32_t segment_index, uint32_t slot, const struct axis *axis);

/*
 * The largest proven lower bound of the distance (m) between a segment and the body in `slot`, as of its last update.
 */
double dpti_bounds_proven(const struct dpt_world *world, uint32_t segment_index, uint32_t slot);

#endif
