/* SPDX-License-Identifier: BSD-3-Clause */
/* What users get about a tool: nearest pairs, contacts, sweeps, the wrench. */
#ifndef DPT_TOOL_RESULTS_H
#define DPT_TOOL_RESULTS_H

#include "track/world_state.h"

/* Write the hit of a segment that has an answer; the hit of another one stays as it is. */
void dpti_tool_write_hit(struct segment *segment);

/* What dpt_tool_get_force_info tells. */
dpt_force_info dpti_tool_force_info(const struct dpt_world *world, const struct tool *tool);

/* Make all answers of a tool stale, and its wrench zero. */
void dpti_tool_clear(struct dpt_world *world, struct tool *tool);

/*
 * The same, without its segments' contacts, sweeps and strips and without its wrench: for a world that only tracks.
 */
void dpti_tool_clear_hits(struct dpt_world *world, struct tool *tool);

#endif
