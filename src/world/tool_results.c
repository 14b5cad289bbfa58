/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/tool_results.h"

#include "base/return_if_error.h"
#include "base/sized.h"
#include "world/proxy_step.h"

void dpti_tool_write_hit(struct segment *segment)
{
    const struct body *body = segment->answer.body;
    if (body)
        dpti_segment_result_write(&segment->result, &body->surface, &body->frame, body->id,
                                  &segment->answer.track.nearest, &segment->hit);
}

void dpti_tool_clear_hits(struct dpt_world *world, struct tool *tool)
{
    for (uint32_t i = 0; i < tool->count; i++)
        world->segments[tool->first + i].hit = (dpt_hit){
            .size = sizeof(dpt_hit), .status = DPT_STATUS_STALE, .triangle = DPT_NONE, .segment = i
        };
    tool->nearest = 0;
    tool->reason = DPT_FORCE_STALE;
    tool->flags = 0;
}

void dpti_tool_clear(struct dpt_world *world, struct tool *tool)
{
    dpti_tool_clear_hits(world, tool);
    for (uint32_t i = 0; i < tool->count; i++) {
        struct segment *segment = &world->segments[tool->first + i];
        memset(&segment->penetration, 0, sizeof segment->penetration);
        memset(&segment->felt_penetration, 0, sizeof segment->felt_penetration);
        segment->passed = segment->given_up = 0;
        segment->sweep =
            (dpt_sweep){ .size = sizeof segment->sweep, .triangle = DPT_NONE, .segment = i };
        if (world->def.strip)
            dpti_strip_clear(world->segment_strips[tool->first + i].strip, NULL);
    }
    memset(&tool->wrench, 0, sizeof tool->wrench);
    tool->energy = 0.0;
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
    const dpt_hit stale = { .status = DPT_STATUS_STALE, .triangle = DPT_NONE };
    DPT_TRY(sized_check(hit, sizeof *hit, 0));
    sized_write(hit, hit->size, &stale, sizeof stale);
    DPT_TRY(find_segment(world, tool, segment, &found));
    sized_write(hit, hit->size, &found->hit, sizeof found->hit);
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
    if (capacity)
        DPT_TRY(sized_check(contacts, sizeof *contacts, 1));
    const uint32_t size = capacity ? contacts[0].size : 0;
    uint32_t found = 0;
    const struct tool *asked = world_find_tool(world, tool);
    if (!asked)
        return DPT_E_HANDLE;
    const struct persistent_contacts *holds = &world->contacts[world->contacts_at];
    for (uint32_t s = asked->first; s < asked->first + asked->count; s++)
        for (uint32_t i = 0; i < holds->count; i++) {
            if (holds->at[i].segment != s || holds->at[i].unseen)
                continue;
            if (found < capacity)
                sized_write((char *)contacts + (size_t)found * size, size, &holds->at[i].contact,
                            sizeof(dpt_contact));
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
    const dpt_sweep none = { .triangle = DPT_NONE };
    DPT_TRY(sized_check(sweep, sizeof *sweep, 0));
    sized_write(sweep, sweep->size, &none, sizeof none);
    DPT_TRY(find_segment(world, tool, segment, &found));
    sized_write(sweep, sweep->size, &found->sweep, sizeof found->sweep);
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

dpt_result dpt_tool_get_force_report(const dpt_world *world, dpt_tool tool, dpt_force_report *force)
{
    if (!force)
        return DPT_E_ARGUMENT;
    dpt_force_report now = { .reason = DPT_FORCE_STALE };
    DPT_TRY(sized_check(force, sizeof now, 0));
    const struct tool *asked = world ? world_find_tool(world, tool) : NULL;
    if (asked) {
        now.reason = asked->reason;
        now.flags = asked->flags;
        now.wrench = asked->wrench;
        now.law = asked->law;
        now.energy = asked->energy;
        if (dpti_proxy_is_used(world, asked)) {
            now.lag = world->proxies[asked - world->tools].lag;
            now.folds = world->proxies[asked - world->tools].folds;
        }
    }
    sized_write(force, force->size, &now, sizeof now);
    return asked ? DPT_OK : world ? DPT_E_HANDLE : DPT_E_ARGUMENT;
}

dpt_result dpt_tool_get_proxy(const dpt_world *world, dpt_tool tool, dpt_pose *pose)
{
    const dpt_pose identity = DPT_POSE_IDENTITY;
    if (!world || !pose)
        return DPT_E_ARGUMENT;
    const struct tool *asked = world_find_tool(world, tool);
    *pose = identity;
    if (!asked)
        return DPT_E_HANDLE;
    const struct proxy *proxy =
        dpti_proxy_is_used(world, asked) ? &world->proxies[asked - world->tools] : NULL;
    *pose = proxy && proxy->state != PROXY_NONE ? proxy->pose : asked->pose;
    return DPT_OK;
}
