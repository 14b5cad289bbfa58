/* SPDX-License-Identifier: BSD-3-Clause */
/* What a tool feels, why that is zero, and how it ends: docs/algorithms/penalty.md. */
#ifndef DPT_TOOL_FORCE_H
#define DPT_TOOL_FORCE_H

#include "world/world_state.h"

/* The segment's share of its tool's wrench, from what the tick knows of its contact. */
void dpti_force_respond(struct dpt_world *world, uint32_t segment_index, double dt);

/* Of a tool that the tick has answered: its wrench, DPT_FORCE_... and flags. */
void dpti_force_sum(const struct dpt_world *world, struct tool *tool);

/* Nothing was felt: there is nothing to fade. */
void dpti_force_forget(struct segment *segment);

/* The same, if it was this body's push. */
void dpti_force_forget_body(struct segment *segment, uint32_t body_id);

#endif
