/* SPDX-License-Identifier: BSD-3-Clause */
/* One axis against all bodies of a world: methods exact, tree and brute. */
#ifndef DPT_BODY_SEARCH_H
#define DPT_BODY_SEARCH_H

#include "nearest/dynamic_point.h"
#include "world/world_state.h"

/* `exact`: what is kept helps, only near bodies are asked, and the world's budget ends it. */
void bodies_find(struct dpt_world *world, uint32_t segment, const vec3 *a, const vec3 *b,
                 struct found *best);

/*
 * The slots of the bodies whose boxes may be within reach of a segment, after bodies_find: `*list`, or where that is
 * NULL all of so many.
 */
uint32_t bodies_within(struct dpt_world *world, uint32_t segment, double reach,
                       const uint32_t **list);

/* A body is there, or its pose has changed: its box, and who has it on its list. */
void bodies_place(struct dpt_world *world, uint32_t index);

/* Write the answer: exact, or bounded with what is proven. best->body is there. */
void bodies_hit(const struct found *best, dpt_hit *hit);

#endif
