/* SPDX-License-Identifier: BSD-3-Clause */
/* What is felt of a proxy: docs/algorithms/force.md. */
#ifndef DPT_PROXY_FORCE_H
#define DPT_PROXY_FORCE_H

#include "proxy/proxy_tick.h"

/* The proxy has moved: how far the surfaces that hold it yield to the force. */
void dpti_proxy_yield(struct proxy_tick *tick);

/*
 * After that: a proxy that waits for a budget is felt as if it had gone the way that is left to it, as far as the surfaces
 * that hold it tell. So it does not pull back what nothing holds.
 */
void dpti_proxy_wait(struct proxy_tick *tick);

/* The wrench and the report of a tool with a proxy. */
void dpti_proxy_respond(struct dpt_world *world, struct tool *tool, double dt);

/* Nothing was felt before: no fade and no damper goes on from there. */
void dpti_proxy_end_force(struct proxy *proxy);

#endif
