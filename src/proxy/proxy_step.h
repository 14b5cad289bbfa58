/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The proxy of a tool: the pose that has gone through nothing, led by the device's and coupled to it by a spring:
 * docs/algorithms/force.md.
 */
#ifndef DPT_PROXY_STEP_H
#define DPT_PROXY_STEP_H

#include "proxy/proxy.h"

/* One tick of `dt`: the proxy follows the device; nearest pairs of the tool's segments are those at the proxy then. */
void dpti_proxy_step(struct dpt_world *world, struct tool *tool, double dt);

#endif
