/* SPDX-License-Identifier: BSD-3-Clause */
/* What is felt of a proxy, and the work that moving bodies do on it: docs/algorithms/force.md, passivity.md. */
#ifndef DPT_PROXY_FORCE_H
#define DPT_PROXY_FORCE_H

#include "proxy/proxy_tick.h"

/* After the motion of the tick: find how far the surfaces that hold the proxy yield to the force. */
void dpti_proxy_yield(struct proxy_tick *tick);

/*
 * After that: a proxy that waits for a budget is felt as if it had already gone as far as the surfaces that hold it
 * allow. Otherwise it would pull back a tool that nothing holds.
 */
void dpti_proxy_wait(struct proxy_tick *tick);

/* The wrench and the report of a tool with a proxy. */
void dpti_proxy_respond(struct dpt_world *world, struct tool *tool, double dt);

/* Forget the felt force, so that no fade and no damper continues from it. */
void dpti_proxy_end_force(struct proxy *proxy);

/*
 * m: how far a body moved its point on a triangle that is at `at` in the world now, before this tick, if it moved then.
 * triangle: its place.
 */
vec3 dpti_body_carried(const struct dpt_world *world, const struct body *body, uint32_t triangle, vec3 at);

/* The turn of a body before this tick, as a rotation vector, if it moved then. */
vec3 dpti_body_turned(const struct body *body);

/* J, in this tick, of what holds the proxy where it ended. Call it after dpti_proxy_yield, before `felt` changes. */
double dpti_proxy_body_work(struct proxy_tick *tick);

#endif
