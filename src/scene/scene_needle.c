/* SPDX-License-Identifier: BSD-3-Clause */
#include "scene/scene_needle.h"

#include <math.h>

#include "dynpoint/insertion.h"

struct scene_needle scene_get_needle(const struct scene *scene)
{
    struct scene_needle needle = { .depth = 0.0 };
    dpt_channel channels[SCENE_CHANNELS] = { { .size = sizeof *channels } };
    uint32_t count = 0;
    if (scene->piercing)
        dpt_tool_get_channels(scene->stage.world, scene->stage.tool, channels, SCENE_CHANNELS, &count);
    for (uint32_t i = 0; i < count; i++) {
        if (!(channels[i].flags & DPT_CHANNEL_FLAG_OCCUPIED))
            continue;
        needle.depth = fmax(needle.depth, channels[i].depth);
        needle.inside += channels[i].inside;
        needle.ruptures += channels[i].ruptures;
        needle.layers += channels[i].layers;
    }
    return needle;
}
