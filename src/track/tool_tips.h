/* SPDX-License-Identifier: BSD-3-Clause */
/* The tips of tools: their nearest pairs, hits and contacts, and what is kept of them: docs/algorithms/tips.md. */
#ifndef DPT_TOOL_TIPS_H
#define DPT_TOOL_TIPS_H

#include "track/world_state.h"

/* A tool's tip, from 0. */
static inline struct tip *tool_tip(const struct dpt_world *world, const struct tool *tool, uint32_t number)
{
    return &world->tips[tool->first_tip + number];
}

/* m: the radius of a segment, or of a tip by its number after the segments. */
static inline double tool_part_radius(const struct dpt_world *world, const struct tool *tool, uint32_t number)
{
    return number < tool->segment_count ? world->segments[tool->first_segment + number].radius
                                        : tool_tip(world, tool, number - tool->segment_count)->hull->radius;
}

/* A box in the world of a tip's polyhedron, where the tool's frame is. */
struct box dpti_tip_box(const struct dpt_hull *hull, const struct frame *tool);

/*
 * The nearest pair of a tip and all bodies, with the tool's frame at `frame`. One body or triangle that was near is tried
 * first; the answer does not change what is remembered.
 */
void dpti_tip_find(struct dpt_world *world, const struct tip *tip, const struct frame *frame,
                   struct tip_answer *answer);

/* Let a tip have an answer, with the tool's frame at `frame`, in this tick. */
void dpti_tip_know(const struct dpt_world *world, struct tip *tip, const struct frame *frame,
                   const struct tip_answer *answer);

/* Find the nearest pairs of all tips of a tool where it is, into their answers. */
void dpti_tips_track(struct dpt_world *world, struct tool *tool);

/*
 * Whether a tip is outside of the part that it is nearest to, where that part has an inside and no defects. Elsewhere the
 * tool's segments tell.
 */
int dpti_tip_is_outside(const struct tip *tip);

/* Hits of the tips, from their answers; of a tool that is held away from its device with `device`, the device's frame. */
void dpti_tips_write_hits(struct dpt_world *world, struct tool *tool, const struct frame *device);

/* Contacts of the tips, from their answers. */
void dpti_tips_find_contacts(struct dpt_world *world, struct tool *tool);

/* How many contacts a tool's tips have; the first `capacity` of them into `contacts`, `stride` bytes apart. */
uint32_t dpti_tips_get_contacts(const struct dpt_world *world, const struct tool *tool, void *contacts,
                                uint32_t capacity, uint32_t stride);

/* Make the hits stale; of a step that answers anew. */
void dpti_tips_clear(struct dpt_world *world, struct tool *tool);

/* Forget what earlier steps know. */
void dpti_tips_forget(struct dpt_world *world, struct tool *tool);

/* The same of a body, by its id, for all tools. */
void dpti_tips_forget_body(struct dpt_world *world, uint32_t body_id);

/* Room for so many tips of a tool that has none, behind those of all others; the world has it. */
struct tip *dpti_tips_add(struct dpt_world *world, struct tool *tool, uint32_t count);

/* Remove the tool's tips; those of other tools move up. */
void dpti_tips_remove(struct dpt_world *world, struct tool *tool);

#endif
