/* SPDX-License-Identifier: BSD-3-Clause */
/* The work that moving bodies do on tools: docs/algorithms/passivity.md. */
#ifndef DPT_BODY_WORK_H
#define DPT_BODY_WORK_H

#include "proxy/proxy_tick.h"

/*
 * m: how far a body moved its point on a triangle that is at `at` in the world now, before this tick, if it moved then.
 * triangle: its place.
 */
vec3 dpti_body_carried(const struct dpt_world *world, const struct body *body, uint32_t triangle, vec3 at);

/* J, in this tick, of what holds the proxy where it ended. Call it after dpti_proxy_yield, before `felt` changes. */
double dpti_proxy_body_work(struct proxy_tick *tick);

/*
 * J, in this tick, of the body that pushes a segment, by its wrench about `origin` in the last tick and in this one. Of a
 * bed over several bodies only the one in which the segment is deepest counts.
 */
double dpti_segment_body_work(const struct dpt_world *world, const struct segment *segment, vec3 origin,
                              const dpt_wrench *last, const dpt_wrench *now);

#endif
