/* SPDX-License-Identifier: BSD-3-Clause */
/* What motion is wanted, and that which was solved for as a pose to go to: docs/algorithms/force.md. */
#ifndef DPT_SOLVED_MOTION_H
#define DPT_SOLVED_MOTION_H

#include "proxy/proxy_tick.h"

/* The displacement to which the spring pulls, as unknowns; returns its length. */
double dpti_solved_wanted(const struct proxy_tick *tick, const struct displacement *left, double *wanted);

/*
 * A share of the motion in tick->solved. What corrections added to it, beside `straight`, grows with the square of the
 * share.
 */
struct proxy_pose dpti_solved_pose(const struct proxy_tick *tick, const double *straight, double share);

/*
 * Constraints are linear, and a turn is not. Where a pair would come too near, its bound is raised by what is missing,
 * and the motion is solved for again. Returns where it leads, with the share that is not longer than `longest`, m.
 */
struct proxy_pose dpti_solved_correct(struct proxy_tick *tick, const double *wanted, const double *straight,
                                      double longest, double *share);

/*
 * The share of a motion that comes nearest to the device: where a surface curves under the tool, a longer motion along
 * it gains less. A parabola tells, by what the spring stores at both ends, as a squared distance, and its slope at the
 * first. now: the displacement from there to the goal
 */
double dpti_solved_best_share(const struct proxy_tick *tick, const struct proxy_pose *to,
                              const struct displacement *now, const double *wanted, const double *straight, double left,
                              double share);

#endif
