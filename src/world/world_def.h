/* SPDX-License-Identifier: BSD-3-Clause */
/* A world's def: its defaults, its versions by size, and whether it is valid. */
#ifndef DPT_WORLD_DEF_H
#define DPT_WORLD_DEF_H

#include "world/world_state.h"

/*
 * A caller's def, which may be older and shorter than ours (the rest gets defaults) or newer and longer
 * (then what we do not know must be 0).
 */
dpt_result dpti_world_def_take(const dpt_world_def *given, dpt_world_def *def);

int dpti_world_def_is_valid(const dpt_world_def *def);

#endif
