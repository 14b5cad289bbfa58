/* SPDX-License-Identifier: BSD-3-Clause */
/* One tick of the paper's method for one segment: a dynamic point per part and body. */
#ifndef DPT_BASELINE_METHOD_H
#define DPT_BASELINE_METHOD_H

#include "track/world_state.h"

/* Its share of dpt_world_bytes: a last triangle for each part of each segment on each body. None for other methods. */
uint64_t dpti_baseline_bytes(const dpt_world_def *def);

/* Place its memory at `at`; returns where it ends. */
char *dpti_baseline_place(struct dpt_world *world, char *at);

/*
 * Forget the last triangles of the segments from `first` up to, not including, `end` on the body in `slot` or, with
 * DPT_NONE, on all.
 */
void dpti_baseline_forget(struct dpt_world *world, uint32_t first, uint32_t end, uint32_t slot);

/* Remove the data of the segments from `first` up to, not including, `end`; that of later segments moves up. */
void dpti_baseline_remove(struct dpt_world *world, uint32_t first, uint32_t end);

/*
 * Find the dynamic points of a segment on all bodies. The nearest of them becomes the segment's answer; its result also
 * has the smallest gap of all parts, and the part with that gap is the segment's penetration.
 */
void dpti_baseline_track(struct dpt_world *world, uint32_t segment_index);

#endif
