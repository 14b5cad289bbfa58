/* SPDX-License-Identifier: BSD-3-Clause */
/* Tips that move in their tool, as jaws do: docs/algorithms/tips.md. */
#ifndef DPT_TIP_POSE_H
#define DPT_TIP_POSE_H

#include "proxy/proxy_tick.h"

/* Put a tip there in its tool's frame; its answers are of another place then. */
void dpti_tip_put(struct dpt_world *world, struct tip *tip, const dpt_pose *pose);

/* All tips of a tool where they are wanted, whatever is there. */
void dpti_tips_put_all(struct dpt_world *world, const struct tool *tool);

/*
 * At the end of a tick: move each tip from where it is in the tool's frame to where it is wanted, as far as it meets
 * nothing and its gap stays at least tick->min_gap. The tool's frame stays at tick->at, and bodies where they are.
 * Sets proxy->tip_motion; tick->gap becomes less by as much as tips came nearer. Returns 0 where the budget ended it.
 */
int dpti_tips_follow(struct proxy_tick *tick);

#endif
