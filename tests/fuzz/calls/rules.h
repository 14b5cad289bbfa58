/* SPDX-License-Identifier: BSD-3-Clause */
/* What must hold of every answer of a world: rules.c, and the one of the wrench in wrench_rule.c. */
#ifndef DPT_TESTS_CALLS_RULES_H
#define DPT_TESTS_CALLS_RULES_H

#include "fuzz/calls/world_model.h"

/* Of one segment, or of the tool: then `segment` is what the hit says. */
void hit_must_hold(const struct scene *scene, const struct model_tool *tool, uint32_t segment, const dpt_hit *hit);

/* The same against every triangle of every body. */
void hit_must_be_true(const struct scene *scene, const struct model_tool *tool, const dpt_hit *hit);

/* Where all bodies are solid: the gap's sign is that of a sum of solid angles. */
void gap_must_be_true(const struct scene *scene, const struct model_tool *tool, const dpt_hit *hit);

/* Every body at the last step was closed. */
int all_are_solid(const struct scene *scene);

/* Of `count` of them. */
void contacts_must_hold(const struct scene *scene, const struct model_tool *tool, const dpt_contact *contacts,
                        uint32_t count);

void sweep_must_hold(const struct scene *scene, const struct model_tool *tool, uint32_t segment,
                     const dpt_sweep *sweep);

/* Of a strip on a mesh: of a segment of that radius. */
void overlaps_must_hold(const dpt_overlap *overlaps, uint32_t count, double radius);

/* Of a segment's strip on the body that it is nearest to: distances are those of the triangles in the last step. */
void strip_must_be_true(const struct scene *scene, const struct body_then *body, const dpt_segment *at,
                        const dpt_overlap *overlaps, uint32_t count);

/* `hits` are those of all of the tool's segments, `report` tells of that wrench. */
void wrench_must_hold(const struct scene *scene, const struct model_tool *tool, const dpt_hit *hits,
                      const dpt_wrench *wrench, const dpt_force_info *report);

/*
 * Where the proxy is: at the device unless it is held, and never in a body; `report` tells of it. Every world of the
 * scene says the same.
 */
void proxy_must_hold(const struct scene *scene, const struct model_tool *tool, const dpt_force_info *report);

/* What every report must be, of a tool whose answers are so. */
void report_must_hold(const struct scene *scene, const struct model_tool *tool, const dpt_force_info *report);

/* An answer without input. */
void hit_must_be_stale(const dpt_hit *hit);

/* The triangle counts: it is in the mesh, and was not dropped. */
void triangle_must_be_there(const struct subject *subject, uint32_t triangle);

/* What sums over this segment and all bodies may be off by. */
double slack_of(const struct scene *scene, const dpt_segment *segment);

/* The least distance of a segment to all that was there at the last step. */
double true_distance(const struct scene *scene, const dpt_segment *at);

/* How often a point is within a body: 0 or 1, but for rounding. */
double times_inside(const struct body_then *body, const double x[3]);

double apart(const double a[3], const double b[3]);

/* Hits are found when they are read first: after a getter of the true world, in the twin too. */
void twin_finds_hits(const struct scene *scene, uint32_t tool_id);

#endif
