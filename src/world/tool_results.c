/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/tool_results.h"

#include "base/return_if_error.h"
#include "base/sized.h"
#include "proxy/proxy.h"
#include "proxy/proxy_pose.h"
#include "track/tool_parts.h"

void dpti_tool_write_hit(struct segment *segment)
{
    const struct body *body = segment->answer.body;
    if (body)
        dpti_segment_result_write(&segment->result, &body->surface, &body->frame, body->id,
                                  &segment->answer.track.nearest, &segment->hit);
}

static double surface_distance(struct part part)
{
    return part_hit(part)->distance - part_radius(part);
}

/* The part whose hit is the tool's. */
static void choose_nearest(const struct dpt_world *world, struct tool *tool)
{
    for (uint32_t i = 0; i < tool_part_count(tool); i++) {
        const struct part part = tool_part(world, tool, i), nearest = tool_part(world, tool, tool->nearest_segment);
        const int is_stale_tip = part.tip && part_hit(part)->status == DPT_STATUS_STALE;
        if (!is_stale_tip && surface_distance(part) < surface_distance(nearest))
            tool->nearest_segment = i;
    }
}

void dpti_tool_write_hits(struct dpt_world *world, struct tool *tool)
{
    if (tool->tip_count && tool_is_active(world, tool))
        dpti_tips_write_hits(world, tool, NULL, &world->work);
    choose_nearest(world, tool);
}

void dpti_tool_find_hits(const struct dpt_world *world, struct tool *tool, struct work *work)
{
    struct frame device;
    frame_of_pose(&proxy_of(world, tool)->device_pose, &device);
    dpti_proxy_write_hits(world, tool, work);
    dpti_tips_write_hits(world, tool, &device, work);
    choose_nearest(world, tool);
    tool->has_late_hits = 0;
}

void dpti_tool_read_hits(const struct dpt_world *world, struct tool *tool)
{
    const uint32_t coming = world_coming_tick(world);
    const int is_lost = world->bodies_put_tick == coming || (tool->tip_count && world->bodies_moved_tick == coming);
    struct work left = world->work;
    if (tool->has_late_hits && !is_lost)
        dpti_tool_find_hits(world, tool, &left);
}

void dpti_tool_clear_hits(struct dpt_world *world, struct tool *tool)
{
    for (uint32_t i = 0; i < tool->segment_count; i++)
        world->segments[tool->first_segment + i].hit =
            (dpt_hit){ .size = sizeof(dpt_hit), .status = DPT_STATUS_STALE, .triangle = DPT_NONE, .segment = i };
    dpti_tips_clear(world, tool);
    tool->nearest_segment = tool->has_late_hits = 0;
    tool->force_reason = DPT_FORCE_STALE;
    tool->force_flags = 0;
}

void dpti_tool_clear(struct dpt_world *world, struct tool *tool)
{
    dpti_tool_clear_hits(world, tool);
    for (uint32_t i = 0; i < tool->segment_count; i++) {
        struct segment *segment = &world->segments[tool->first_segment + i];
        memset(&segment->penetration, 0, sizeof segment->penetration);
        memset(&segment->felt_penetration, 0, sizeof segment->felt_penetration);
        segment->may_have_crossed = segment->has_given_up_push = 0;
        segment->sweep = (dpt_sweep){ .size = sizeof segment->sweep, .segment = i, .triangle = DPT_NONE };
        if (world->def.strip)
            dpti_strip_clear(world->segment_strips[tool->first_segment + i].strip, NULL);
    }
    memset(&tool->wrench, 0, sizeof tool->wrench);
    memset(&tool->law_wrench, 0, sizeof tool->law_wrench);
    tool->energy = tool->body_work = 0.0;
}

static dpt_result find_segment(const dpt_world *world, dpt_tool tool, uint32_t segment, const struct segment **found)
{
    const struct tool *owner = world_find_tool(world, tool);
    if (!owner)
        return DPT_E_HANDLE;
    if (segment >= owner->segment_count)
        return DPT_E_ARGUMENT;
    *found = &world->segments[owner->first_segment + segment];
    return DPT_OK;
}

dpt_result dpt_tool_get_segment_hit(const dpt_world *world, dpt_tool tool, uint32_t segment, dpt_hit *hit)
{
    const struct segment *found;
    if (!world || !hit)
        return DPT_E_ARGUMENT;
    const dpt_hit stale = { .status = DPT_STATUS_STALE, .triangle = DPT_NONE };
    DPT_TRY(sized_check(hit, sizeof *hit, 0));
    sized_write(hit, hit->size, &stale, sizeof stale);
    struct tool *owner = world_find_tool(world, tool);
    if (owner)
        dpti_tool_read_hits(world, owner);
    if (owner && segment >= owner->segment_count && segment - owner->segment_count < owner->tip_count) {
        const struct tip *tip = tool_tip(world, owner, segment - owner->segment_count);
        sized_write(hit, hit->size, &tip->hit, sizeof tip->hit);
        return DPT_OK;
    }
    DPT_TRY(find_segment(world, tool, segment, &found));
    sized_write(hit, hit->size, &found->hit, sizeof found->hit);
    return DPT_OK;
}

dpt_result dpt_tool_get_hit(const dpt_world *world, dpt_tool tool, dpt_hit *hit)
{
    struct tool *owner = world ? world_find_tool(world, tool) : NULL;
    if (owner)
        dpti_tool_read_hits(world, owner);
    return dpt_tool_get_segment_hit(world, tool, owner ? owner->nearest_segment : 0, hit);
}

dpt_result dpt_tool_get_contacts(const dpt_world *world, dpt_tool tool, dpt_contact *contacts, uint32_t capacity,
                                 uint32_t *count)
{
    if (count)
        *count = 0;
    if (!world || !count || (!contacts && capacity))
        return DPT_E_ARGUMENT;
    if (capacity)
        DPT_TRY(sized_check(contacts, sizeof *contacts, 1));
    const uint32_t size = capacity ? contacts[0].size : 0;
    uint32_t found = 0;
    const struct tool *owner = world_find_tool(world, tool);
    if (!owner)
        return DPT_E_HANDLE;
    if (!world->def.max_contacts)
        return DPT_E_FULL;
    const struct persistent_contacts *current = &world->contacts[world->contacts_index];
    for (uint32_t s = owner->first_segment; s < owner->first_segment + owner->segment_count; s++)
        for (uint32_t i = 0; i < current->count; i++) {
            if (current->items[i].segment_index != s || current->items[i].is_unseen)
                continue;
            if (found < capacity)
                sized_write((char *)contacts + (size_t)found * size, size, &current->items[i].contact,
                            sizeof(dpt_contact));
            found++;
        }
    const uint32_t written = found < capacity ? found : capacity;
    found += dpti_tips_get_contacts(world, owner, contacts ? (char *)contacts + (size_t)written * size : NULL,
                                    capacity - written, size);
    *count = found;
    return DPT_OK;
}

dpt_result dpt_tool_get_sweep(const dpt_world *world, dpt_tool tool, uint32_t segment, dpt_sweep *sweep)
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
    const struct tool *owner = world ? world_find_tool(world, tool) : NULL;
    if (!owner)
        return world ? DPT_E_HANDLE : DPT_E_ARGUMENT;
    *wrench = owner->wrench;
    return DPT_OK;
}

dpt_force_info dpti_tool_force_info(const struct dpt_world *world, const struct tool *tool)
{
    dpt_force_info info = { .size = sizeof info,
                            .reason = tool->force_reason,
                            .flags = tool->force_flags,
                            .law = tool->law,
                            .wrench = tool->wrench,
                            .energy = tool->energy,
                            .body_work = tool->body_work };
    if (dpti_proxy_is_used(world, tool)) {
        const struct proxy *proxy = &world->proxies[tool - world->tools];
        info.lag = proxy->lag;
        info.folds = proxy->folds;
        info.sticking = proxy->sticking;
        info.slipping = proxy->slipping;
    }
    return info;
}

dpt_result dpt_tool_get_force_info(const dpt_world *world, dpt_tool tool, dpt_force_info *info)
{
    if (!info)
        return DPT_E_ARGUMENT;
    dpt_force_info now = { .reason = DPT_FORCE_STALE };
    DPT_TRY(sized_check(info, sizeof now, 0));
    const struct tool *owner = world ? world_find_tool(world, tool) : NULL;
    if (owner)
        now = dpti_tool_force_info(world, owner);
    sized_write(info, info->size, &now, sizeof now);
    return owner ? DPT_OK : world ? DPT_E_HANDLE : DPT_E_ARGUMENT;
}

dpt_result dpt_tool_get_proxy(const dpt_world *world, dpt_tool tool, dpt_pose *pose)
{
    const dpt_pose identity = DPT_POSE_IDENTITY;
    if (!world || !pose)
        return DPT_E_ARGUMENT;
    const struct tool *owner = world_find_tool(world, tool);
    *pose = identity;
    if (!owner)
        return DPT_E_HANDLE;
    const struct proxy *proxy = dpti_proxy_is_used(world, owner) ? &world->proxies[owner - world->tools] : NULL;
    *pose = proxy && proxy->state != PROXY_NONE ? dpti_proxy_told_pose(proxy) : owner->pose;
    return DPT_OK;
}

dpt_result dpt_tool_get_end(const dpt_world *world, dpt_tool tool, dpt_pose *pose)
{
    DPT_TRY(dpt_tool_get_proxy(world, tool, pose));
    const struct tool *owner = world_find_tool(world, tool);
    const struct proxy *proxy = dpti_proxy_is_used(world, owner) ? &world->proxies[owner - world->tools] : NULL;
    if (proxy && proxy->state != PROXY_NONE && proxy->is_ended)
        *pose = proxy->end;
    return DPT_OK;
}
