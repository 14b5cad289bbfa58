/* SPDX-License-Identifier: BSD-3-Clause */
/* The bodies and tools of a world. Their public functions are in dynpoint/body.h and dynpoint/tool.h. */
#ifndef DPT_WORLD_MEMBERS_H
#define DPT_WORLD_MEMBERS_H

#include "track/world_state.h"

/* DPT_OK, or DPT_E_FULL if the world has as many bodies as it can hold. */
dpt_result dpti_body_can_add(const struct dpt_world *world);

/* Add a body, for which there is room, and return its id. pose: valid; NULL: the identity. */
uint32_t dpti_body_add(struct dpt_world *world, const struct surface *surface, const dpt_pose *pose);

/* To tools it is as if the body had just been added where it is. */
void dpti_body_begin_anew(struct dpt_world *world, struct body *body);

/* Whether needles may pierce it at all: if it deforms it has springs, or a compliance, and is pushed by loads. */
int dpti_body_can_be_pierced(const struct body *body);

/* Whether a body or a region may have this law: all numbers in their ranges (dynpoint/body.h). */
int dpti_pierce_law_is_valid(const struct pierce_law *law);

/*
 * Vertices of a deformable body have moved, by at most `moved` (m) since they were moved last. has_begun_anew: its
 * cached planes are invalid.
 */
void dpti_body_note_vertices(struct dpt_world *world, struct body *body, double moved, int has_begun_anew);

/* Forget what earlier ticks know of a tool, and its answers. */
void dpti_tool_forget(struct dpt_world *world, struct tool *tool);

/* DPT_OK if segments are finite and in range (dynpoint/tool.h), else DPT_E_FINITE. */
dpt_result dpti_tool_check_segments(const dpt_segment *segments, uint32_t count);

#endif
