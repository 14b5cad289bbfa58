/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/tool_results.h"

#include "base/return_if_error.h"

void dpti_tool_write_hit(struct segment *segment)
{
    const struct body *body = segment->found.body;
    if (body)
        dpti_segment_result_write(&segment->result, &body->surface, &body->frame, body->id,
                                  &segment->found.track.nearest, &segment->hit);
}

void dpti_tool_clear_hits(struct dpt_world *world, struct tool *tool)
{
    for (uint32_t i = 0; i < tool->count; i++)
        world->segments[tool->first + i].hit = (dpt_hit){
            .size = sizeof(dpt_hit), .status = DPT_STATUS_STALE, .triangle = DPT_NONE, .segment = i
        };
    tool->nearest = 0;
}

void dpti_tool_clear(struct dpt_world *world, struct tool *tool)
{
    dpti_tool_clear_hits(world, tool);
    for (uint32_t i = 0; i < tool->count; i++) {
        struct segment *segment = &world->segments[tool->first + i];
        memset(&segment->wrench, 0, sizeof segment->wrench);
        memset(&segment->push, 0, sizeof segment->push);
        segment->passed = 0;
        segment->sweep =
            (dpt_sweep){ .size = sizeof segment->sweep, .triangle = DPT_NONE, .segment = i };
        if (world->def.strip)
            dpti_strip_clear(world->laid[tool->first + i].strip, NULL);
    }
    memset(&tool->wrench, 0, sizeof tool->wrench);
}

static dpt_result find_segment(const dpt_world *world, dpt_tool tool, uint32_t segment,
                               const struct segment **found)
{
    const struct tool *asked = world_find_tool(world, tool);
    if (!asked)
        return DPT_E_HANDLE;
    if (segment >= asked->count)
        return DPT_E_ARGUMENT;
    *found = &world->segments[asked->first + segment];
    return DPT_OK;
}

dpt_result dpt_tool_get_segment_hit(const dpt_world *world, dpt_tool tool, uint32_t segment,
                                    dpt_hit *hit)
{
    const struct segment *found;
    if (!world || !hit)
        return DPT_E_ARGUMENT;
    uint32_t size = hit->size;
    if (size < sizeof *hit)
        return DPT_E_SIZE;
    *hit = (dpt_hit){ .size = size, .status = DPT_STATUS_STALE, .triangle = DPT_NONE };
    DPT_TRY(find_segment(world, tool, segment, &found));
    *hit = found->hit;
    hit->size = size;
    return DPT_OK;
}

dpt_result dpt_tool_get_hit(const dpt_world *world, dpt_tool tool, dpt_hit *hit)
{
    const struct tool *asked = world ? world_find_tool(world, tool) : NULL;
    return dpt_tool_get_segment_hit(world, tool, asked ? asked->nearest : 0, hit);
}

dpt_result dpt_tool_get_contacts(const dpt_world *world, dpt_tool tool, dpt_contact *contacts,
                                 uint32_t capacity, uint32_t *count)
{
    if (count)
        *count = 0;
    if (!world || !count || (!contacts && capacity))
        return DPT_E_ARGUMENT;
    uint32_t size = capacity ? contacts[0].size : 0, found = 0;
    if (capacity && (size < sizeof *contacts || size % 8))
        return DPT_E_SIZE;
    const struct tool *asked = world_find_tool(world, tool);
    if (!asked)
        return DPT_E_HANDLE;
    const struct holds *holds = &world->holds[world->holds_at];
    for (uint32_t s = asked->first; s < asked->first + asked->count; s++)
        for (uint32_t i = 0; i < holds->count; i++) {
            if (holds->hold[i].segment != s || holds->hold[i].unseen)
                continue;
            if (found < capacity) {
                dpt_contact *contact = (void *)((char *)contacts + (size_t)found * size);
                *contact = holds->hold[i].contact;
                contact->size = size;
            }
            found++;
        }
    *count = found;
    return DPT_OK;
}

dpt_result dpt_tool_get_sweep(const dpt_world *world, dpt_tool tool, uint32_t segment,
                              dpt_sweep *sweep)
{
    const struct segment *found;
    if (!world || !sweep)
        return DPT_E_ARGUMENT;
    uint32_t size = sweep->size;
    if (size < sizeof *sweep)
        return DPT_E_SIZE;
    *sweep = (dpt_sweep){ .size = size, .triangle = DPT_NONE };
    DPT_TRY(find_segment(world, tool, segment, &found));
    *sweep = found->sweep;
    sweep->size = size;
    return DPT_OK;
}

dpt_result dpt_tool_get_wrench(const dpt_world *world, dpt_tool tool, dpt_wrench *wrench)
{
    if (!wrench)
        return DPT_E_ARGUMENT;
    memset(wrench, 0, sizeof *wrench);
    const struct tool *asked = world ? world_find_tool(world, tool) : NULL;
    if (!asked)
        return world ? DPT_E_HANDLE : DPT_E_ARGUMENT;
    *wrench = asked->wrench;
    return DPT_OK;
}
