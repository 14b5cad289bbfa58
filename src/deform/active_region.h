/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Which slices are stepped: docs/algorithms/springs.md. A slice falls asleep when it has been slow for some steps. It
 * wakes when its load changes, when a neighbour is fast, and when a neighbour may have crept a little way since.
 */
#ifndef DPT_ACTIVE_REGION_H
#define DPT_ACTIVE_REGION_H

#include "deform/spring_state.h"

/* Wake all slices. */
void dpti_region_wake_all(struct dpt_springs *springs);

/* Wake a slice that was moved, and its neighbours. Calls on some are followed by one of dpti_region_list. */
void dpti_region_disturb(struct dpt_springs *springs, uint32_t slice);
void dpti_region_list(struct dpt_springs *springs);

/* Before a step: wake the slices whose loads have changed since the last step. */
void dpti_region_wake_loaded(struct dpt_springs *springs);

/* After a step of dt seconds: wake the neighbours of what moves, and let fall asleep what has been slow. */
void dpti_region_settle(struct dpt_springs *springs, double dt);

#endif
