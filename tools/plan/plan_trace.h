/* SPDX-License-Identifier: BSD-3-Clause */
/* The motions by which a plan is chosen and verified, in the scene's frame. */
#ifndef DPT_TOOLS_PLAN_TRACE_H
#define DPT_TOOLS_PLAN_TRACE_H

#include "csv.h"
#include "plan/plan_file.h"

/*
 * Let a hand (measure_trace.h) slide the tool over the scene: over each body in turn, and over each once more, so that both
 * halves meet all of them. Where it goes on to the next one, the motion jumps. Bodies count as they lie at first. A stylus
 * lies on the surface, and any other tool stands on its tip.
 *   ticks   at the rate, Hz; at least 4 a body
 *   speed   mean over the surface, m/s; 0: as it scales it
 *
 * Returns 0, or 2 after a message. Free the trace (csv_table_free) also then.
 */
int plan_trace_make(struct csv_table *trace, const struct scene *scene, uint64_t seed, uint64_t ticks, double rate,
                    double speed);

/* Rows `from` to `to` of a trace, as they lie in it: there is nothing to free. Its first row is a jump. */
struct csv_table plan_trace_part(const struct csv_table *trace, size_t from, size_t to);

/*
 * Play a trace at another pace: 1.5 is faster by half, below 0 is backwards. Between rows the ends go straight; a jump stays
 * one. Returns 0, or 2 after a message. Free `out` also then.
 */
int plan_trace_play(struct csv_table *out, const char *command, const struct csv_table *trace, double pace);

/*
 * One of a plan's traces, PLAN_FIRST_HALF and so on, of its whole trace, at its rate. plan_trace_leave frees it. Returns 0, or
 * 2 after a message.
 */
int plan_trace_of(struct csv_table *out, const struct scene *scene, const struct plan *plan,
                  const struct csv_table *whole, int which);
void plan_trace_leave(struct csv_table *trace, int which);

/* The fastest of an end, m/s, for ticks of dt, s; jumps do not count. */
double plan_trace_speed(const struct csv_table *trace, double dt);

/* The scene of a plan that was read. */

/*
 * What the plan says of its scene, where `def` has nothing: path, law, stylus, friction, damping. The plan must outlive the
 * def.
 */
void plan_scene_def(const struct plan *plan, struct scene_def *def);

/* Note what a scene's meshes are. */
void plan_meshes_of(struct plan *plan, const struct scene *scene);

/* Refuse a scene whose files are not those of the plan. Returns 0, or 2 after a message. */
int plan_scene_check(const struct plan *plan, const struct scene *scene, const char *path);

#endif
