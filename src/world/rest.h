/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Answers of a tool that stands still, bit for bit, are not computed again. A tool rests when a tick would repeat the
 * last one: nothing that it depends on has changed, its answers are complete, and the last two ticks left contacts and
 * proxy as they found them. Its answers, contacts, sweep and strips then stay; forces are computed in every tick, as
 * they may fade.
 *
 * A tool depends on its own pose, segments and settings, and on all bodies. A function that changes one of these sets
 * `has_changed`, of the tool or of the world. In a world with a deformable body no tool rests.
 */
#ifndef DPT_REST_H
#define DPT_REST_H

#include "track/world_state.h"

/* Before a tick: 1 if a tool rests in it. */
int dpti_rest_begins(const struct dpt_world *world, struct tool *tool);

/* A tool that rests keeps its answers of the last tick: all but its contacts, which follow below. */
void dpti_rest_keep_answers(struct dpt_world *world, struct tool *tool);

/* In the tick, in the place of contact: a segment of a tool that rests keeps its contacts. */
void dpti_rest_keep_contacts(struct dpt_world *world, uint32_t segment_index);

/* After the contacts of all tools: note whether one that did not rest stood still. */
void dpti_rest_note(struct dpt_world *world, struct tool *tool);

/* Call after a step that failed. */
void dpti_rest_forget(struct dpt_world *world);

#endif
