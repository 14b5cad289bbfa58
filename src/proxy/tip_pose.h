/* SPDX-License-Identifier: BSD-3-Clause */
/* Tips that move in their tool, as jaws do: docs/algorithms/tips.md. */
#ifndef DPT_TIP_POSE_H
#define DPT_TIP_POSE_H

#include "proxy/proxy_tick.h"

/* Place a tip in its tool's frame. Its earlier answers are then out of date. */
void dpti_tip_put(struct dpt_world *world, struct tip *tip, const dpt_pose *pose);

/* Place all tips of a tool at their wanted poses, even inside a body. */
void dpti_tips_put_all(struct dpt_world *world, const struct tool *tool);

/*
 * At the end of a tick: move each tip from where it is in the tool's frame to where it is wanted, as far as it meets
 * nothing and its gap stays at least tick->min_gap. The tool's frame stays at tick->at, and bodies where they are.
 * Sets proxy->tip_motion; tick->gap becomes less by as much as tips came nearer. Returns 0 if the budget ended it.
 */
int dpti_tips_follow(struct proxy_tick *tick);

#endif
