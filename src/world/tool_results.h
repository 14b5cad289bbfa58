/* SPDX-License-Identifier: BSD-3-Clause */
/* What users get about a tool: nearest pairs, contacts, sweeps, the wrench. */
#ifndef DPT_TOOL_RESULTS_H
#define DPT_TOOL_RESULTS_H

#include "dynpoint/insertion.h"
#include "insertion/channel.h"
#include "track/world_state.h"

/* Write the hit of a segment that has an answer; the hit of another one stays as it is. */
void dpti_tool_write_hit(struct segment *segment);

/* The hits of a tool that is where its device is: those of its tips, from their answers, and which is the tool's. */
void dpti_tool_write_hits(struct dpt_world *world, struct tool *tool);

/* Search for the hits of a tool that its proxy holds away from the device, where they are late. */
void dpti_tool_find_hits(const struct dpt_world *world, struct tool *tool, struct work *work);

/*
 * The same for someone who reads them after the step, with the work that it has left. They stay stale if a body was added,
 * removed or teleported since.
 */
void dpti_tool_read_hits(const struct dpt_world *world, struct tool *tool);

/* What dpt_tool_get_force_info tells. */
dpt_force_info dpti_tool_force_info(const struct dpt_world *world, const struct tool *tool);

/* What dpt_tool_get_channels tells of a channel that the tool has made. */
dpt_channel dpti_tool_channel(const struct dpt_world *world, const struct tool *tool, const struct channel *channel);

/* Make all answers of a tool stale, and its wrench zero. */
void dpti_tool_clear(struct dpt_world *world, struct tool *tool);

/*
 * The same, without its segments' contacts, sweeps and strips and without its wrench: for a world that only tracks.
 */
void dpti_tool_clear_hits(struct dpt_world *world, struct tool *tool);

#endif
