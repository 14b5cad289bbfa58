/* SPDX-License-Identifier: BSD-3-Clause */
/* The strip of each segment of a world. docs/algorithms/strip.md. */
#ifndef DPT_TOOL_STRIPS_H
#define DPT_TOOL_STRIPS_H

#include "track/world_state.h"

/* The def of each strip of a world. */
dpt_strip_def dpti_strips_def(const dpt_world_def *def);

/* Its share of dpt_world_bytes. */
uint64_t dpti_strips_bytes(const dpt_world_def *def);

/* Place its memory at `at`; returns where it ends. */
char *dpti_strips_place(struct dpt_world *world, char *at);

/* Find a segment's strip, from its nearest pair and its penetration; empty if it is not within the margin. */
void dpti_strips_find(struct dpt_world *world, uint32_t segment_index);

/*
 * Empty the strips of the segments from `first` up to, not including, `end`, and forget what they keep between ticks.
 */
void dpti_strips_forget(struct dpt_world *world, uint32_t first, uint32_t end);

/* Do the same for the strips that lie on the body in `slot`. */
void dpti_strips_forget_body(struct dpt_world *world, uint32_t slot);

/* Call after vertices of the body in a slot have moved: no strip on it is taken over from the last tick. */
void dpti_strips_note_vertices(struct dpt_world *world, uint32_t slot);

/* Remove the strips of the segments from `first` up to, not including, `end`; those of later segments move up. */
void dpti_strips_remove(struct dpt_world *world, uint32_t first, uint32_t end);

#endif
