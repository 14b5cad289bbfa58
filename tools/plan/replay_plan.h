/* SPDX-License-Identifier: BSD-3-Clause */
/* dynpoint replay --plan: a plan's scene over a trace, and whether what the plan promises holds. */
#ifndef DPT_TOOLS_REPLAY_PLAN_H
#define DPT_TOOLS_REPLAY_PLAN_H

int replay_plan(int argc, char **argv);

/* 1 if the options of replay name a plan. */
int replay_has_plan(int argc, char **argv);

#endif
