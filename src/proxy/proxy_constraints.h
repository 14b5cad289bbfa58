/* SPDX-License-Identifier: BSD-3-Clause */
/* What a proxy must not pass, as linear constraints on a small motion: docs/algorithms/force.md. */
#ifndef DPT_PROXY_CONSTRAINTS_H
#define DPT_PROXY_CONSTRAINTS_H

#include "proxy/proxy_tick.h"

/*
 * The constraints of the nearest triangle of each segment and of those that are remembered, as far as their gap at
 * tick->at is within `reach`: into tick->spaces.
 */
void dpti_proxy_gather(struct proxy_tick *tick, double reach);

/*
 * A constraint of a ball: the plane across `plane`, from its point on a body at rest to the ball's centre at p, in the
 * body's frame, at that distance, m. triangle: in tick->triangles. There must be room for it.
 */
void dpti_proxy_add_plane(struct proxy_tick *tick, uint32_t triangle, const struct body *body, vec3 p,
                          const pair *plane, double distance);

/* The constraints of one of tick->triangles, as far as its pairs' gaps are within `reach`, m. */
void dpti_proxy_gather_triangle(struct proxy_tick *tick, uint32_t triangle, double reach);

/* As many are added for a triangle at most. */
enum { PROXY_GATHERED_MAX = 12 };

/* Remember the triangles that hold the proxy. */
void dpti_proxy_remember_active(struct proxy_tick *tick);

/* The gap of one constraint's pair at another pose, with bodies where they are now. */
double dpti_proxy_gap_of(const struct proxy_tick *tick, uint32_t space, const struct proxy_pose *pose);

/* The minimum gap of the remembered triangles at a pose, with bodies where they are now; at most `enough`. */
double dpti_proxy_gap_of_remembered(const struct proxy_tick *tick, const struct proxy_pose *pose, double enough);

/* Where a body is for `at`: at tick->time of its motion while tick->is_before. */
dpt_pose dpti_proxy_body_pose(const struct proxy_tick *tick, const struct body *body);

#endif
