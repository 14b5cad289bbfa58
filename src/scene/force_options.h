/* SPDX-License-Identifier: BSD-3-Clause */
/* How a force is felt: the law of a tool, its coupling, and the friction of all bodies. */
#ifndef DPT_SCENE_FORCE_OPTIONS_H
#define DPT_SCENE_FORCE_OPTIONS_H

#include "dynpoint/body.h"
#include "dynpoint/tool.h"
#include "dynpoint/world.h"

struct force_options {
    uint32_t law;                /* DPT_LAW_... */
    double stiffness;            /* N/m */
    double friction;             /* of all bodies, at rest and in motion; NAN: each has its own */
    double damping;              /* Ns/m */
    double rotational_stiffness; /* Nm/rad; 0: by the tool's shape */
};

static inline dpt_result force_options_set_body(const struct force_options *options, dpt_world *world, dpt_body body)
{
    dpt_body_settings settings = { .size = sizeof settings };
    dpt_result result = dpt_body_get_settings(world, body, &settings);
    settings.static_friction = settings.kinetic_friction = options->friction;
    return result == DPT_OK ? dpt_body_set_settings(world, body, &settings) : result;
}

/* `lock_rotation` for a device that gives no torque. Segments that are far are not searched for: nobody is shown them. */
static inline dpt_result force_options_set_tool(const struct force_options *options, dpt_world *world, dpt_tool tool,
                                                uint32_t lock_rotation)
{
    dpt_tool_settings settings = { .size = sizeof settings };
    dpt_result result = dpt_tool_get_settings(world, tool, &settings);
    settings.law = options->law;
    settings.stiffness = options->stiffness;
    settings.damping = options->damping;
    settings.rotational_stiffness = options->rotational_stiffness;
    settings.lock_rotation = lock_rotation;
    settings.near_only = 1;
    return result == DPT_OK ? dpt_tool_set_settings(world, tool, &settings) : result;
}

#endif
