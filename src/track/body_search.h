/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * One axis against all bodies of a world: methods exact, tree and brute. With a budget also what is proven of the
 * distance between a segment and each body, by finished and by suspended searches. A bound stays valid in later ticks,
 * less the motion of the axis: docs/algorithms/budget.md.
 */
#ifndef DPT_BODY_SEARCH_H
#define DPT_BODY_SEARCH_H

#include "track/world_state.h"

/* Its share of dpt_world_bytes: bounds, last triangles and the plane cache. */
uint64_t dpti_body_search_bytes(const dpt_world_def *def);

/* Place its memory at `at`; returns where it ends. */
char *dpti_body_search_place(struct dpt_world *world, char *at);

/* Forget a segment's bounds and suspended searches, its last triangles and its nearest body. */
void dpti_body_search_forget(struct dpt_world *world, uint32_t segment_index);

/* Forget all that searches know of the body in a slot. */
void dpti_body_search_forget_body(struct dpt_world *world, uint32_t slot);

/*
 * Empty the plane cache's blocks of the segments from `first` up to, not including, `end`, on the body in `slot` or,
 * with DPT_NONE, on all. Needed before an index or slot is given to another segment or body.
 */
void dpti_body_search_forget_planes(struct dpt_world *world, uint32_t first, uint32_t end, uint32_t slot);

/* Remove the data of the segments from `first` up to, not including, `end`; that of later segments moves up. */
void dpti_body_search_remove(struct dpt_world *world, uint32_t first, uint32_t end);

/*
 * Find the nearest pair of a segment, whose axis is from `a` to `b` in the world, and all bodies, into `best`.
 * best->body is NULL if the world has no body. The method `exact` uses what earlier ticks left, searches near bodies
 * only, and ends with the world's budget; best->is_exact says whether the pair is proven.
 */
void dpti_body_search_find(struct dpt_world *world, uint32_t segment_index, const vec3 *a, const vec3 *b,
                           struct body_answer *best);

/* Write an answer that has a body into `result`: exact, or bounded by what is proven. */
void dpti_body_search_result(const struct body_answer *best, struct segment_result *result);

/* Before the filter's frame of the body in `slot` changes: end what is held in that frame. What is proven stays. */
void dpti_body_search_leave_frame(struct dpt_world *world, uint32_t slot);

/* Vertices of the body in `slot` have moved, by at most `moved`, m: the next update counts it. */
void dpti_bounds_note_motion(struct dpt_world *world, uint32_t segment_index, uint32_t slot, double moved);

#endif
