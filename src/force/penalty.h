/* SPDX-License-Identifier: BSD-3-Clause */
/* The penalty law: a force in proportion to depth. */
#ifndef DPT_PENALTY_H
#define DPT_PENALTY_H

#include "base/penetration.h"
#include "dynpoint/types.h"

/*
 * Add the wrench of one penetration to `sum`, its torque about `origin`. stiffness: N/m. docs/algorithms/penalty.md.
 */
static inline void respond_penalty(const struct penetration *penetration, double stiffness, vec3 origin,
                                   dpt_wrench *sum)
{
    vec3 force = scaled(penetration->direction, stiffness * penetration->depth);
    vec3 torque = cross(sub(penetration->at, origin), force);
    vec3_store(add(vec3_of(sum->force), force), sum->force);
    vec3_store(add(vec3_of(sum->torque), torque), sum->torque);
}

#endif
