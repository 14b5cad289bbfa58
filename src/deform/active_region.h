/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Which slices are stepped: docs/algorithms/springs.md, "What sleeps". A slice falls asleep when it has been slow for
 * some steps. It wakes when its load changes or a neighbour moves.
 */
#ifndef DPT_ACTIVE_REGION_H
#define DPT_ACTIVE_REGION_H

#include "deform/spring_state.h"
#include "mesh/spring_net.h"

/* Call once, after the rest of the springs is set: find the neighbours of each slice. All slices are awake. */
void dpti_region_begin(struct dpt_springs *springs);

/* Wake a slice that was moved, and its neighbours. After such calls, call dpti_region_list once. */
void dpti_region_disturb(struct dpt_springs *springs, uint32_t slice);
void dpti_region_list(struct dpt_springs *springs);

/* Before a step: wake the slices whose loads have changed. */
void dpti_region_wake_loaded(struct dpt_springs *springs);

/* After a step of dt seconds: wake the neighbours of slices that moved, and put slow slices to sleep. */
void dpti_region_settle(struct dpt_springs *springs, double dt);

/* ---- neighbours ---- */

/*
 * The slices that springs lead to from `slice`, without itself. A slice may occur twice. Returns their number; `list`
 * may be NULL.
 */
uint32_t dpti_slice_neighbours(const struct spring_net *net, uint32_t slice, uint32_t *list);

/* The sum of these numbers over all slices. */
uint64_t dpti_slice_neighbours_count(const struct spring_net *net);

#endif
