/* SPDX-License-Identifier: BSD-3-Clause */
/* A world's def: its defaults, its sizes in older and newer versions, and whether it is valid. */
#ifndef DPT_WORLD_DEF_H
#define DPT_WORLD_DEF_H

#include "track/world_state.h"

/*
 * Read a caller's def and the baseline that it points to, by the rule of base/sized.h. `def` then points to
 * `baseline`.
 */
dpt_result dpti_world_def_read(const dpt_world_def *given, dpt_world_def *def, dpt_baseline_def *baseline);

/* Whether all fields of a def are in their ranges. */
int dpti_world_def_is_valid(const dpt_world_def *def);

/* Whether a stiffness (N/m) or a side limit (m) is in its range, for a def or for settings. */
int dpti_stiffness_is_valid(double stiffness);
int dpti_law_is_valid(uint32_t law);
int dpti_friction_is_valid(double static_friction, double kinetic_friction);
int dpti_side_limit_is_valid(double limit);

#endif
