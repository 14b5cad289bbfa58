/* SPDX-License-Identifier: BSD-3-Clause */
/* How often the proxy of a scene was put at the device, why, and how long it had no force for that: docs/algorithms/force.md. */
#ifndef DPT_HOST_SCENE_PUTS_H
#define DPT_HOST_SCENE_PUTS_H

#include "host/scene.h"

struct scene_puts {
    uint64_t squeezed, turned; /* ticks in which it was put */
    uint64_t inside;           /* ticks without force: where it was put, or began, may be inside or behind something */
};

static inline void scene_puts_tick(struct scene_puts *puts, const struct scene *scene)
{
    dpt_force_info force = { .size = sizeof force };
    if (scene->force.law != DPT_LAW_PROXY || dpt_tool_get_force_info(scene->world, scene->tool, &force) != DPT_OK)
        return;
    puts->squeezed += force.reason == DPT_FORCE_INSIDE && (force.flags & DPT_FORCE_FLAG_SQUEEZED);
    puts->turned += (force.flags & DPT_FORCE_FLAG_REPLACED) != 0;
    puts->inside += force.reason == DPT_FORCE_INSIDE || force.reason == DPT_FORCE_UNDECIDED;
}

#endif
