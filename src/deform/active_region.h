/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Which slices are stepped: docs/algorithms/springs.md, "What sleeps". A slice falls asleep when it has been slow for
 * some steps. It wakes when its load is another than the one with which it fell asleep, and when a neighbour is
 * elsewhere than where it was then.
 */
#ifndef DPT_ACTIVE_REGION_H
#define DPT_ACTIVE_REGION_H

#include "deform/spring_state.h"
#include "mesh/spring_net.h"

/* Once, when all else of the springs is there: who is beside whom. All are awake. */
void dpti_region_begin(struct dpt_springs *springs);

/* Wake a slice that was moved, and its neighbours. Calls on some are followed by one of dpti_region_list. */
void dpti_region_disturb(struct dpt_springs *springs, uint32_t slice);
void dpti_region_list(struct dpt_springs *springs);

/* Before a step: wake the slices whose loads have changed. */
void dpti_region_wake_loaded(struct dpt_springs *springs);

/* After a step of dt seconds: wake the neighbours of what has moved, and let fall asleep what has been slow. */
void dpti_region_settle(struct dpt_springs *springs, double dt);

/* ---- neighbours ---- */

/*
 * The slices that springs lead to from `slice`, without itself. One of many may occur twice. Returns how many; `list`
 * may be NULL.
 */
uint32_t dpti_slice_neighbours(const struct spring_net *net, uint32_t slice, uint32_t *list);

/* The same, of all slices together. */
uint64_t dpti_slice_neighbours_count(const struct spring_net *net);

#endif
