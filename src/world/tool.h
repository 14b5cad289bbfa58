/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef DPT_TOOL_H
#define DPT_TOOL_H

#include "world/world_state.h"

/* What the last ticks left of a tool, and its answers. */
void dpti_tool_forget(struct dpt_world *world, struct tool *tool);

#endif
