/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The proxy of a tool: the pose that has gone through nothing, led by the device's and coupled to it by a spring:
 * docs/algorithms/force.md.
 */
#ifndef DPT_PROXY_STEP_H
#define DPT_PROXY_STEP_H

#include "proxy/proxy_state.h"

/* A body was added or teleported: the proxies near which it is are not known to be outside of it. */
void dpti_proxy_note_body(struct dpt_world *world, uint32_t slot);

/* One tick of `dt`: the proxy follows the device; nearest pairs of the tool's segments are those at the proxy then. */
void dpti_proxy_step(struct dpt_world *world, struct tool *tool, double dt);

/* After contact: whether a proxy that was placed, or doubted, is outside of everything. */
void dpti_proxy_settle(struct dpt_world *world, struct tool *tool);

/* Whether a tool has a proxy that is not where its device is. */
int dpti_proxy_is_away(const struct dpt_world *world, const struct tool *tool);

/* Where the proxy is away: the hits of the segments, which are at the device's pose. */
void dpti_proxy_write_hits(struct dpt_world *world, struct tool *tool);

#endif
