/* SPDX-License-Identifier: BSD-3-Clause */
/* What users are told of a tool: nearest pairs, contacts, sweeps, the wrench. */
#ifndef DPT_TOOL_RESULTS_H
#define DPT_TOOL_RESULTS_H

#include "world/world_state.h"

/* Write the hit of a segment whose result is known; that of another stays as it is. */
void dpti_tool_write_hit(struct segment *segment);

/* Nothing is known: stale, no force. */
void dpti_tool_clear(struct dpt_world *world, struct tool *tool);

/* The same, for a tool whose contacts no step has computed. */
void dpti_tool_clear_hits(struct dpt_world *world, struct tool *tool);

#endif
