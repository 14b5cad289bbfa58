/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The proxy of a free tool of one segment: docs/algorithms/force.md. The segment is kept in a frame of its own, with
 * end a at the origin and end b on the x axis. That frame's pose is tool->pose.
 */
#ifndef DPT_PROXY_FREE_H
#define DPT_PROXY_FREE_H

#include "proxy/proxy_state.h"

/* What a free tool with a proxy was given last, in the world. The world's own segment may be smaller. */
dpt_segment dpti_proxy_given_segment(const struct dpt_world *world, const struct tool *tool);

/*
 * The tool becomes free, or rigid again: the proxy starts again where the device is. What was given last is what its
 * own frame holds from then on, at the identity pose.
 */
void dpti_proxy_set_free(struct dpt_world *world, struct tool *tool, uint32_t is_free);

/* The one segment of a free tool, in the world: its pose is end a, and the least turn from where it pointed. */
void dpti_proxy_set_segment(struct dpt_world *world, struct tool *tool, const dpt_segment *segment);

/* Length and radius of a free tool follow what was given, as far as the proxy's gap has room for them. */
void dpti_proxy_follow_size(struct dpt_world *world, const struct tool *tool, struct proxy *proxy);

/* 1 if they have come to what was given; also of a rigid tool. */
int dpti_proxy_has_size(const struct dpt_world *world, const struct tool *tool);

#endif
