/* SPDX-License-Identifier: BSD-3-Clause */
#include "insertion/world_channels.h"

#include "insertion/channel_points.h"
#include "insertion/region_law.h"

enum { BYTES_CHANNEL = 3496, BYTES_TOOL = 5392, BYTES_REGIONS = 736 };
typedef char channel_fits[sizeof(struct channel) <= BYTES_CHANNEL ? 1 : -1];
typedef char tool_fits[sizeof(struct piercing_tool) <= BYTES_TOOL ? 1 : -1];
typedef char regions_fit[sizeof(struct body_regions) <= BYTES_REGIONS ? 1 : -1];

uint64_t dpti_channels_bytes(const dpt_world_def *def)
{
    return def->max_channels ? BYTES_CHANNEL * (uint64_t)def->max_channels + BYTES_TOOL * (uint64_t)def->max_tools +
                                   BYTES_REGIONS * (uint64_t)def->max_bodies
                             : 0;
}

char *dpti_channels_place(struct dpt_world *world, char *at)
{
    const dpt_world_def *def = &world->def;
    if (!def->max_channels)
        return at;
    world->channels = (void *)at;
    char *tools = at + BYTES_CHANNEL * (size_t)def->max_channels;
    world->piercing_tools = (void *)tools;
    world->body_regions = (void *)(tools + BYTES_TOOL * (size_t)def->max_tools);
    return at + dpti_channels_bytes(def);
}

int dpti_is_inserted_in(const struct dpt_world *world, const struct tool *tool, uint32_t body_id)
{
    const struct insertion *insertion = insertion_of(world, tool);
    for (uint32_t i = 0; i < insertion->count; i++)
        if (world->channels[insertion->in[i].channel].body_id == body_id)
            return 1;
    return 0;
}

int dpti_is_inserted_in_tissue(const struct dpt_world *world, const struct tool *tool)
{
    const struct insertion *insertion = insertion_of(world, tool);
    for (uint32_t i = 0; i < insertion->count; i++)
        if (dpti_channel_body(world, &world->channels[insertion->in[i].channel])->surface.motion)
            return 1;
    return 0;
}

const struct body *dpti_channel_body(const struct dpt_world *world, const struct channel *channel)
{
    return &world->bodies[handle_index(channel->body_id)];
}

struct channel *dpti_channel_free(const struct dpt_world *world)
{
    for (uint32_t i = 0; i < world->def.max_channels; i++)
        if (!world->channels[i].body_id)
            return &world->channels[i];
    return NULL;
}

static uint32_t tool_id(const struct dpt_world *world, const struct tool *tool)
{
    return handle_make(HANDLE_TOOL, &tool->slot, (uint32_t)(tool - world->tools));
}

void dpti_channel_open(struct dpt_world *world, struct channel *channel, const struct body *body,
                       const struct tool *tool)
{
    world->last_channel_id += world->last_channel_id == UINT32_MAX ? 2u : 1u;
    channel->id = world->last_channel_id;
    channel->body_id = body->id;
    channel->tool_id = tool_id(world, tool);
    channel->opened = channel->walls[channel->open_count - 1].to + channel->radius;
    if (world->deform_count)
        dpti_channel_add_entry(channel, &body->surface);
}

void dpti_insertion_add(struct dpt_world *world, const struct tool *tool, const struct channel *channel, double place)
{
    struct insertion *insertion = insertion_of(world, tool);
    insertion->in[insertion->count++] = (struct inserted){
        .channel = (uint32_t)(channel - world->channels), .anchor = place, .place = place, .last = place
    };
}

void dpti_insertion_drop(struct insertion *insertion, uint32_t number)
{
    insertion->count--;
    memmove(&insertion->in[number], &insertion->in[number + 1], (insertion->count - number) * sizeof *insertion->in);
    if (!insertion->count)
        memset(insertion, 0, sizeof *insertion);
}

static void end_search(struct channel_search *search)
{
    search->is_begun = 0;
    search->channel.near.margin = 0.0;
}

void dpti_insertion_forget(struct dpt_world *world, const struct tool *tool)
{
    if (!world->channels)
        return;
    memset(insertion_of(world, tool), 0, sizeof(struct insertion));
    end_search(channel_search_of(world, tool));
}

/* A tool is let go where it is: there it is beside all bodies that it was not in. */
static void let_go(struct dpt_world *world, const struct tool *tool, uint32_t channel)
{
    struct insertion *insertion = insertion_of(world, tool);
    struct proxy *proxy = &world->proxies[tool - world->tools];
    for (uint32_t i = 0; i < insertion->count; i++) {
        if (insertion->in[i].channel != channel)
            continue;
        dpti_insertion_drop(insertion, i);
        proxy->is_released = 1;
        proxy->gap = 0.0;
        return;
    }
}

static void close_hole(struct dpt_world *world, uint32_t channel)
{
    for (uint32_t t = 0; t < world->tool_slot_end; t++)
        let_go(world, &world->tools[t], channel);
    memset(&world->channels[channel], 0, sizeof *world->channels);
}

void dpti_channels_forget_body(struct dpt_world *world, uint32_t body_id)
{
    for (uint32_t i = 0; world->channels && i < world->def.max_channels; i++)
        if (world->channels[i].body_id == body_id)
            close_hole(world, i);
    for (uint32_t i = 0; world->channels && i < world->tool_slot_end; i++)
        if (world->piercing_tools[i].search.channel.body_id == body_id)
            end_search(&world->piercing_tools[i].search);
}

void dpti_channels_forget_tool(struct dpt_world *world, const struct tool *tool)
{
    const uint32_t id = tool_id(world, tool);
    for (uint32_t i = 0; world->channels && i < world->def.max_channels; i++)
        if (world->channels[i].body_id && world->channels[i].tool_id == id)
            close_hole(world, i);
    if (world->channels)
        end_search(channel_search_of(world, tool));
}
