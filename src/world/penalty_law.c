/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/tool_force.h"

double dpti_penalty_push(const struct dpt_world *world, const struct tool *tool, uint32_t segment_index, vec3 origin,
                         dpt_wrench *sum)
{
    const struct penetration *penetration = &world->segments[segment_index].felt_penetration;
    const vec3 force = scaled(penetration->direction, tool->stiffness * penetration->depth);
    const vec3 torque = cross(sub(penetration->at, origin), force);
    vec3_store(add(vec3_of(sum->force), force), sum->force);
    vec3_store(add(vec3_of(sum->torque), torque), sum->torque);
    return 0.0;
}
