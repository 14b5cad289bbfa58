/* SPDX-License-Identifier: BSD-3-Clause */
#include "dynpoint/insertion.h"

#include "base/return_if_error.h"
#include "base/sized.h"
#include "proxy/channel_line.h"
#include "proxy/proxy_channel.h"
#include "world/tool_results.h"
#include "world/world_members.h"

dpt_channel dpti_tool_channel(const struct dpt_world *world, const struct tool *tool, const struct channel *channel)
{
    const struct body *body = dpti_channel_body(world, channel);
    const struct channel_line line = dpti_channel_line(world, channel);
    const struct insertion *insertion = insertion_of(world, tool);
    dpt_channel made = { .size = sizeof made,
                         .id = channel->id,
                         .body = channel->body_id,
                         .triangle = body->surface.sources[channel->triangle],
                         .ruptures = channel->open_count,
                         .deepest = max_of(0.0, channel->deepest - channel->entry) };
    memcpy(made.weight, channel->weight, sizeof made.weight);
    vec3_store(along(line.mouth, channel->entry, line.axis), made.entry);
    vec3_store(line.axis, made.axis);
    for (uint32_t i = 0; i < insertion->count; i++) {
        const struct inserted *in = &insertion->in[i];
        if (&world->channels[in->channel] != channel)
            continue;
        made.flags = DPT_CHANNEL_FLAG_OCCUPIED;
        made.depth = in->place - channel->entry;
        made.layers = dpti_channel_layers(channel, in->place);
        made.inside = dpti_channel_inside(channel, in->place);
        made.friction = in->friction;
        made.tip = in->tip;
    }
    return made;
}

dpt_result dpt_tool_get_channels(const dpt_world *world, dpt_tool tool, dpt_channel *channels, uint32_t capacity,
                                 uint32_t *count)
{
    if (!world || !count || (!channels && capacity))
        return DPT_E_ARGUMENT;
    *count = 0;
    if (capacity)
        DPT_TRY(sized_check(channels, sizeof *channels, 1));
    const struct tool *found = world_find_tool(world, tool);
    if (!found)
        return DPT_E_HANDLE;
    if (!world->channels)
        return DPT_E_UNSUPPORTED;
    for (uint32_t i = 0; i < world->def.max_channels; i++) {
        const struct channel *channel = &world->channels[i];
        if (!channel->body_id || channel->tool_id != tool)
            continue;
        if (*count < capacity) {
            const dpt_channel made = dpti_tool_channel(world, found, channel);
            sized_write((char *)channels + (size_t)*count * channels->size, channels->size, &made, sizeof made);
        }
        ++*count;
    }
    return DPT_OK;
}

dpt_result dpt_tool_insert(dpt_world *world, dpt_tool tool)
{
    struct tool *found = world ? world_find_tool(world, tool) : NULL;
    if (!found)
        return world ? DPT_E_HANDLE : DPT_E_ARGUMENT;
    if (!found->piercing || found->is_free || !tool_is_active(world, found))
        return DPT_E_UNSUPPORTED;
    dpti_tool_forget(world, found);
    return dpti_proxy_insert(world, found);
}
