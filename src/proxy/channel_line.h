/* SPDX-License-Identifier: BSD-3-Clause */
/* Where a tool that pierces is on the line of a channel, and what else is beside it: docs/algorithms/insertion.md. */
#ifndef DPT_CHANNEL_LINE_H
#define DPT_CHANNEL_LINE_H

#include "insertion/world_channels.h"
#include "proxy/proxy_tick.h"

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

/* What is nearest beside a tool. */
struct beside {
    double gap;        /* m; -HUGE_VAL where a budget ended the search */
    uint32_t body_id;  /* 0: none is within the limit */
    uint32_t triangle; /* its place */
};

/* Between the tool, its frame at `frame`, and all bodies in whose channels it is not. The gap is at most `limit`. */
struct beside dpti_beside(struct dpt_world *world, const struct tool *tool, const struct frame *frame, double limit);

/* Whether no point of a body is within `radius` of an axis from a to b, in the world. 0 where a budget ended the search. */
int dpti_is_clear_of(struct dpt_world *world, const struct body *body, vec3 a, vec3 b, double radius);

/*
 * Whether a channel's line is one with the host's as far as the tool is long, but for what its tissue may be dented, in
 * which bodies that move against each other may have left it.
 */
int dpti_is_on_line(const struct proxy_tick *tick, const struct channel_line *host, const struct channel_line *line);

/*
 * What is added to a place to be the place in another channel, of which the line is one with the host's but for
 * rounding.
 */
double dpti_channel_offset(const struct channel_line *host, const struct channel_line *line);

/* The place from which a tip goes into a hole, and the one at which it is out. */
double dpti_channel_mouth_place(const struct proxy_tick *tick, const struct channel *channel);
double dpti_channel_way_out(const struct proxy_tick *tick, const struct channel *channel);

/* Whether the tip is at the mouth of a hole, and points along it. */
int dpti_is_at_mouth(const struct proxy_tick *tick, const struct channel *channel, const struct channel_line *line);

/* Whether a tool that is in channels has its tip at the mouth of another hole of its own on their line. */
int dpti_is_at_own_hole(const struct proxy_tick *tick, const struct channel *channel);

#endif
