/* SPDX-License-Identifier: BSD-3-Clause */
/* A world's def: its defaults, its versions by size, and whether it is valid. */
#ifndef DPT_WORLD_DEF_H
#define DPT_WORLD_DEF_H

#include "world/world_state.h"

/* A caller's def and what it points to, by the rule of base/sized.h; `def` points to `baseline` then. */
dpt_result dpti_world_def_read(const dpt_world_def *given, dpt_world_def *def,
                               dpt_baseline_def *baseline);

int dpti_world_def_is_valid(const dpt_world_def *def);

/* What the settings of tools and bodies allow, too. */
int dpti_stiffness_is_valid(double stiffness);
int dpti_side_limit_is_valid(double limit);

#endif
