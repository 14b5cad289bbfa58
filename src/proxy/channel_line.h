/* SPDX-License-Identifier: BSD-3-Clause */
/* Where a tool that pierces is on the line of a channel, and what else is beside it: docs/algorithms/insertion.md. */
#ifndef DPT_CHANNEL_LINE_H
#define DPT_CHANNEL_LINE_H

#include "insertion/world_channels.h"
#include "proxy/proxy_pose.h"

/* A channel's line in the world. */
struct channel_line {
    vec3 mouth, axis; /* the axis of unit length */
};

struct channel_line dpti_channel_line(const struct dpt_world *world, const struct channel *channel);

/* The end of the tool's axis that pierces, and the unit vector from the other end to it, in the tool's frame. */
vec3 dpti_tip_point(const struct dpt_world *world, const struct tool *tool);
vec3 dpti_tip_direction(const struct dpt_world *world, const struct tool *tool);

/* m: of the tool's axis. */
double dpti_shaft_length(const struct dpt_world *world, const struct tool *tool);

/* The turn that is nearest to `turn` and has the tool's axis along the line. */
struct quaternion dpti_turn_along(const struct dpt_world *world, const struct tool *tool,
                                  const struct channel_line *line, struct quaternion turn);

/* The tool with its tip at a place of the line, turned along it. */
struct proxy_pose dpti_pose_on_line(const struct dpt_world *world, const struct tool *tool,
                                    const struct channel_line *line, double place, struct quaternion turn);

/* The place where the device would have the tip: its centre's, and from there to the tip. */
double dpti_device_place(const struct dpt_world *world, const struct tool *tool, const struct channel_line *line,
                         vec3 device_centre);

/* N/m: a tool's spring, in series with the stiffness of a body's surface. */
double dpti_stiffness_on(const struct tool *tool, const struct body *body);

/*
 * m: the gap between the tool, its frame at `frame`, and all bodies in whose channels it is not; at most `limit`, and
 * -HUGE_VAL where a budget ended the search.
 */
double dpti_gap_beside(struct dpt_world *world, const struct tool *tool, const struct frame *frame, double limit);

#endif
