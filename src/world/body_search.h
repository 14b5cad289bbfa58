/* SPDX-License-Identifier: BSD-3-Clause */
/* One axis against all bodies of a world: methods exact, tree and brute. */
#ifndef DPT_BODY_SEARCH_H
#define DPT_BODY_SEARCH_H

#include "world/world_state.h"

/* The share of dpt_world_bytes of what a search keeps for the next one. */
uint64_t dpti_body_search_bytes(const dpt_world_def *def);

/* Place its memory at `at`; returns where it ends. */
char *dpti_body_search_place(struct dpt_world *world, char *at);

/* Forget a segment's last tick. */
void dpti_body_search_forget(struct dpt_world *world, uint32_t segment_index);

/* Forget the body in a slot. */
void dpti_body_search_forget_body(struct dpt_world *world, uint32_t slot);

/*
 * Empty the blocks of some segments, from `first` to before `end`, on one body or, with DPT_NONE, on all:
 * before a number of theirs means another.
 */
void dpti_body_search_forget_planes(struct dpt_world *world, uint32_t first, uint32_t end,
                                    uint32_t slot);

/* Remove the segments from `first` up to, not including, `end`: those behind them move up. */
void dpti_body_search_remove(struct dpt_world *world, uint32_t first, uint32_t end);

/* `exact`: what is kept helps, only near bodies are asked, and the world's budget ends it. */
void dpti_body_search_find(struct dpt_world *world, uint32_t segment_index, const vec3 *a,
                           const vec3 *b, struct body_answer *best);

/* The result so far: exact, or bounded with what is proven. best->body is there. */
void dpti_body_search_result(const struct body_answer *best, struct segment_result *result);

#endif
