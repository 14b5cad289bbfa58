/* SPDX-License-Identifier: BSD-3-Clause */
/* Tools of a world; dynpoint/world.h has what users call. */
#ifndef DPT_TOOL_H
#define DPT_TOOL_H

#include "world/world_state.h"

/* Forget what earlier ticks left of a tool, and its answers. */
void dpti_tool_forget(struct dpt_world *world, struct tool *tool);

/* May they be a tool's? */
dpt_result dpti_tool_check_segments(const dpt_segment *segments, uint32_t count);

#endif
