/* SPDX-License-Identifier: BSD-3-Clause */
/* A world's def: its defaults, its versions by size, and whether it is valid. */
#ifndef DPT_WORLD_DEF_H
#define DPT_WORLD_DEF_H

#include "world/world_state.h"

/* A caller's def, by the rule of base/sized.h. */
dpt_result dpti_world_def_take(const dpt_world_def *given, dpt_world_def *def);

int dpti_world_def_is_valid(const dpt_world_def *def);

#endif
