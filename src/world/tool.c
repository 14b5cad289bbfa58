/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/tool.h"

#include "base/return_if_error.h"
#include "base/sized.h"
#include "world/body_search.h"
#include "world/distance_bounds.h"
#include "world/motion_backlog.h"
#include "world/persistent_contacts.h"
#include "world/proxy_step.h"
#include "world/tool_force.h"
#include "world/tool_results.h"
#include "world/tool_strips.h"
#include "world/world_def.h"

/* Forget what earlier ticks left of a segment. */
static void forget_segment(struct dpt_world *world, uint32_t segment)
{
    dpti_bodies_forget(world, segment);
    dpti_near_forget(world, segment);
    dpti_bounds_forget(world, segment, DPT_NONE);
    dpti_backlog_forget(world, segment);
    dpti_contacts_forget(world, segment, segment + 1, DPT_NONE);
    dpti_strips_forget(world, segment, segment + 1);
    dpti_force_forget(&world->segments[segment]);
}

void dpti_tool_forget(struct dpt_world *world, struct tool *tool)
{
    for (uint32_t i = 0; i < tool->count; i++)
        forget_segment(world, tool->first + i);
    dpti_proxy_forget(world, tool);
    dpti_tool_clear(world, tool);
}

dpt_result dpti_tool_check_segments(const dpt_segment *segments, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
        if (!vec3_within(segments[i].a, DPT_COORDINATE_MAX) ||
            !vec3_within(segments[i].b, DPT_COORDINATE_MAX) ||
            !(segments[i].radius >= 0.0 && segments[i].radius <= DPT_COORDINATE_MAX))
            return DPT_E_FINITE;
    return DPT_OK;
}

static void put_segments(struct dpt_world *world, const struct tool *tool,
                         const dpt_segment *segments)
{
    uint32_t index = (uint32_t)(tool - world->tools);
    for (uint32_t i = 0; i < tool->count; i++) {
        struct segment *to = &world->segments[tool->first + i];
        to->a = vec3_of(segments[i].a);
        to->b = vec3_of(segments[i].b);
        to->radius = segments[i].radius;
        to->tool = index;
    }
}

dpt_result dpt_tool_add(dpt_world *world, const dpt_segment *segments, uint32_t count,
                        dpt_tool *tool)
{
    if (!world || !segments || !tool || count == 0)
        return DPT_E_ARGUMENT;
    DPT_TRY(dpti_tool_check_segments(segments, count));
    uint32_t index =
        slot_to_use(&world->tools->slot, sizeof *world->tools, world->tool_end, world->freed[1]);
    if (index == world->def.max_tools || count > world->def.max_segments - world->segment_count)
        return DPT_E_FULL;
    struct tool *made = &world->tools[index];
    if (index == world->tool_end) {
        world->tool_end++;
        made->slot.generation = 1;
    }
    made->slot.used = 1;
    const dpt_pose identity = DPT_POSE_IDENTITY;
    made->frame = frame_identity;
    made->pose = identity;
    made->slot.valid = 1;
    made->user = 0;
    made->stiffness = world->def.stiffness;
    made->rotational_stiffness = 0.0;
    made->law = world->def.law;
    made->free = 0;
    made->first = world->segment_count;
    made->count = count;
    world->segment_count += count;
    put_segments(world, made, segments);
    world_note_max(&world->usage.tools, ++world->tool_count);
    world_note_max(&world->usage.segments, world->segment_count);
    dpti_tool_forget(world, made);
    *tool = handle_make(HANDLE_TOOL, &made->slot, index);
    return DPT_OK;
}

/* The segments of all tools lie close together: those behind the removed ones move up. */
dpt_result dpt_tool_remove(dpt_world *world, dpt_tool tool)
{
    struct tool *old = world ? world_find_tool(world, tool) : NULL;
    if (!old)
        return world ? DPT_E_HANDLE : DPT_E_ARGUMENT;
    uint32_t behind = old->first + old->count;
    memmove(&world->segments[old->first], &world->segments[behind],
            (world->segment_count - behind) * sizeof *world->segments);
    dpti_bodies_remove(world, old->first, behind);
    dpti_near_remove(world, old->first, behind);
    dpti_bounds_remove(world, old->first, behind);
    dpti_backlog_remove(world, old->first, behind);
    dpti_contacts_remove(world, old->first, behind);
    dpti_strips_remove(world, old->first, behind);
    world->turn = 0;
    for (uint32_t t = 0; t < world->tool_end; t++)
        if (world->tools[t].slot.used && world->tools[t].first >= behind)
            world->tools[t].first -= old->count;
    world->segment_count -= old->count;
    slot_release(&old->slot, &world->freed[1]);
    world->tool_count--;
    return DPT_OK;
}

/* A wrench about another origin is another one: what was felt does not fade then. */
static void set_free(struct dpt_world *world, struct tool *tool, uint32_t is_free)
{
    for (uint32_t i = 0; i < tool->count && tool->free != is_free; i++)
        dpti_force_forget(&world->segments[tool->first + i]);
    if (tool->free != is_free)
        dpti_proxy_set_free(world, tool, is_free);
    tool->free = is_free;
}

dpt_result dpt_tool_set_pose(dpt_world *world, dpt_tool tool, const dpt_pose *pose)
{
    struct tool *moved = world ? world_find_tool(world, tool) : NULL;
    if (!moved)
        return world ? DPT_E_HANDLE : DPT_E_ARGUMENT;
    struct frame frame;
    dpt_result result = pose ? frame_of_pose(pose, &frame) : DPT_E_ARGUMENT;
    moved->slot.valid = result == DPT_OK;
    if (moved->slot.valid) {
        moved->frame = frame;
        moved->pose = *pose;
    }
    set_free(world, moved, 0);
    return result;
}

dpt_result dpt_tool_teleport(dpt_world *world, dpt_tool tool, const dpt_pose *pose)
{
    dpt_result result = dpt_tool_set_pose(world, tool, pose);
    if (result == DPT_OK)
        dpti_tool_forget(world, world_find_tool(world, tool));
    return result;
}

dpt_result dpt_tool_set_segments(dpt_world *world, dpt_tool tool, const dpt_segment *segments,
                                 uint32_t count)
{
    struct tool *moved = world ? world_find_tool(world, tool) : NULL;
    if (!moved)
        return world ? DPT_E_HANDLE : DPT_E_ARGUMENT;
    dpt_result result = segments && count == moved->count
                            ? dpti_tool_check_segments(segments, count)
                            : DPT_E_ARGUMENT;
    if (result == DPT_OK && count > 1 && dpti_proxy_is_used(world, moved))
        result = DPT_E_UNSUPPORTED;
    moved->slot.valid = result == DPT_OK;
    if (result != DPT_OK)
        return result;
    set_free(world, moved, 1);
    if (dpti_proxy_is_used(world, moved)) {
        dpti_proxy_set_segment(world, moved, segments);
        return DPT_OK;
    }
    const dpt_pose identity = DPT_POSE_IDENTITY;
    moved->frame = frame_identity;
    moved->pose = identity;
    put_segments(world, moved, segments);
    return DPT_OK;
}

int dpt_tool_is_valid(const dpt_world *world, dpt_tool tool)
{
    return world && world_find_tool(world, tool) != NULL;
}

dpt_result dpt_tool_get_pose(const dpt_world *world, dpt_tool tool, dpt_pose *pose)
{
    const dpt_pose identity = DPT_POSE_IDENTITY;
    if (!world || !pose)
        return DPT_E_ARGUMENT;
    const struct tool *asked = world_find_tool(world, tool);
    *pose = asked && !asked->free ? asked->pose : identity;
    return asked ? DPT_OK : DPT_E_HANDLE;
}

dpt_result dpt_tool_set_user(dpt_world *world, dpt_tool tool, uint64_t user)
{
    struct tool *asked = world ? world_find_tool(world, tool) : NULL;
    if (!asked)
        return world ? DPT_E_HANDLE : DPT_E_ARGUMENT;
    asked->user = user;
    return DPT_OK;
}

dpt_result dpt_tool_get_user(const dpt_world *world, dpt_tool tool, uint64_t *user)
{
    if (!world || !user)
        return DPT_E_ARGUMENT;
    const struct tool *asked = world_find_tool(world, tool);
    *user = asked ? asked->user : 0;
    return asked ? DPT_OK : DPT_E_HANDLE;
}

/* The segment of a free tool is kept in the world or, with a proxy, in a frame of its own. */
static void set_law(struct dpt_world *world, struct tool *tool, uint32_t law)
{
    const struct segment *segment = &world->segments[tool->first];
    struct frame device;
    dpt_segment given = { .radius = segment->radius };
    frame_of_pose(&tool->pose, &device);
    vec3_store(frame_to_world(&device, segment->a), given.a);
    vec3_store(frame_to_world(&device, segment->b), given.b);
    const int had_proxy = dpti_proxy_is_used(world, tool);
    tool->law = law;
    const int has_proxy = dpti_proxy_is_used(world, tool);
    if (!tool->free || had_proxy == has_proxy)
        return;
    const dpt_pose identity = DPT_POSE_IDENTITY;
    tool->pose = identity;
    tool->frame = frame_identity;
    if (has_proxy) {
        dpti_proxy_forget(world, tool);
        dpti_proxy_set_segment(world, tool, &given);
    } else {
        put_segments(world, tool, &given);
    }
}

dpt_result dpt_tool_set_settings(dpt_world *world, dpt_tool tool, const dpt_tool_settings *given)
{
    if (!world || !given)
        return DPT_E_ARGUMENT;
    struct tool *asked = world_find_tool(world, tool);
    if (!asked)
        return DPT_E_HANDLE;
    dpt_tool_settings settings = { .size = sizeof settings,
                                   .law = asked->law,
                                   .stiffness = asked->stiffness,
                                   .rotational_stiffness = asked->rotational_stiffness };
    DPT_TRY(sized_read(given, sizeof settings, &settings, sizeof settings));
    if (asked->free && asked->count > 1 && settings.law == DPT_LAW_PROXY)
        return DPT_E_UNSUPPORTED;
    if (!dpti_law_is_valid(settings.law) || !dpti_stiffness_is_valid(settings.stiffness) ||
        !dpti_stiffness_is_valid(settings.rotational_stiffness))
        return DPT_E_ARGUMENT;
    asked->stiffness = settings.stiffness;
    asked->rotational_stiffness = settings.rotational_stiffness;
    if (asked->law != settings.law) {
        set_law(world, asked, settings.law);
        dpti_tool_forget(world, asked);
    }
    return DPT_OK;
}

dpt_result dpt_tool_get_settings(const dpt_world *world, dpt_tool tool, dpt_tool_settings *settings)
{
    if (!world || !settings)
        return DPT_E_ARGUMENT;
    dpt_tool_settings now = { .size = sizeof now };
    DPT_TRY(sized_check(settings, sizeof now, 0));
    const struct tool *asked = world_find_tool(world, tool);
    if (asked) {
        now.law = asked->law;
        now.stiffness = asked->stiffness;
        now.rotational_stiffness = asked->rotational_stiffness;
    }
    sized_write(settings, settings->size, &now, sizeof now);
    return asked ? DPT_OK : DPT_E_HANDLE;
}
