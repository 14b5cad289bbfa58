/* SPDX-License-Identifier: BSD-3-Clause */
/* Tools of a world. Their public functions are in dynpoint/tool.h. */
#ifndef DPT_TOOL_H
#define DPT_TOOL_H

#include "track/world_state.h"

/* Forget what earlier ticks know of a tool, and its answers. */
void dpti_tool_forget(struct dpt_world *world, struct tool *tool);

/* DPT_OK if segments are finite and in range (dynpoint/world.h), else DPT_E_FINITE. */
dpt_result dpti_tool_check_segments(const dpt_segment *segments, uint32_t count);

#endif
