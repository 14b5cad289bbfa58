/* SPDX-License-Identifier: BSD-3-Clause */
/* The wrench of a tool with DPT_LAW_BED, segment by segment: docs/algorithms/force.md. */
#ifndef DPT_TOOL_BED_H
#define DPT_TOOL_BED_H

#include "track/world_state.h"

/* Add a segment's share to `sum`, its torque about `origin`, in the world. Returns its energy, J. */
double dpti_tool_bed_respond(const struct dpt_world *world, const struct tool *tool, uint32_t segment_index,
                             vec3 origin, dpt_wrench *sum);

#endif
