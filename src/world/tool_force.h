/* SPDX-License-Identifier: BSD-3-Clause */
/* The wrench of a tool without a proxy, the reason when it is zero, and its fade: docs/algorithms/penalty.md. */
#ifndef DPT_TOOL_FORCE_H
#define DPT_TOOL_FORCE_H

#include "track/world_state.h"

/*
 * A law that pushes by depth: adds what it gives for a segment that penetrates to `sum`, the torque about `origin`, in
 * the world. Returns the energy that it stores, J.
 */
typedef double depth_law(const struct dpt_world *world, const struct tool *tool, uint32_t segment_index, vec3 origin,
                         dpt_wrench *sum);

/* DPT_LAW_POINT: a force in proportion to the depth of the deepest point: penalty_law.c. It states no energy: 0. */
double dpti_penalty_push(const struct dpt_world *world, const struct tool *tool, uint32_t segment_index, vec3 origin,
                         dpt_wrench *sum);

/* DPT_LAW_BED: an energy along the tool and at its free ends: bed_law.c. */
double dpti_bed_push(const struct dpt_world *world, const struct tool *tool, uint32_t segment_index, vec3 origin,
                     dpt_wrench *sum);

/*
 * Update a segment's share of its tool's wrench from its penetration in this tick. dt: s. Ends the tick of the
 * segment's force: its pushing part becomes the previous one.
 */
void dpti_force_respond(struct dpt_world *world, uint32_t segment_index, double dt, depth_law *push);

/* After its segments have responded: sum their shares into the tool's wrench, and set its DPT_FORCE_... and flags. */
void dpti_force_sum(const struct dpt_world *world, struct tool *tool);

/* Set the segment's force to zero at once, and forget what pushed it: nothing is left to fade. */
void dpti_force_forget(struct segment *segment);

/* The same, if this body pushed it, or its push fades. Also forget the view of a border if it is this body's. */
void dpti_force_forget_body(struct segment *segment, uint32_t body_id);

#endif
