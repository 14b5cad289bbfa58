/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/world_members.h"

#include "base/return_if_error.h"
#include "base/sized.h"
#include "dynpoint/tip.h"
#include "insertion/world_channels.h"
#include "proxy/proxy.h"
#include "proxy/tip_pose.h"
#include "track/body_search.h"
#include "track/persistent_contacts.h"
#include "track/swept_motion.h"
#include "track/tool_parts.h"
#include "world/baseline_method.h"
#include "world/tool_force.h"
#include "world/tool_results.h"
#include "world/tool_strips.h"
#include "world/world_def.h"

/* Forget what earlier ticks know of a segment. */
static void forget_segment(struct dpt_world *world, uint32_t segment)
{
    dpti_body_search_forget(world, segment);
    dpti_baseline_forget(world, segment, segment + 1, DPT_NONE);
    dpti_far_forget(&world->segments[segment]);
    dpti_broad_phase_forget(world, segment);
    dpti_backlog_forget(world, segment);
    dpti_persistent_contacts_forget(world, segment, segment + 1, DPT_NONE);
    dpti_strips_forget(world, segment, segment + 1);
    dpti_force_forget(&world->segments[segment]);
}

void dpti_tool_forget(struct dpt_world *world, struct tool *tool)
{
    for (uint32_t i = 0; i < tool->segment_count; i++)
        forget_segment(world, tool->first_segment + i);
    dpti_tips_forget(world, tool);
    dpti_proxy_forget(world, tool);
    dpti_tool_clear(world, tool);
    tool->has_changed = 1;
}

dpt_result dpti_tool_check_segments(const dpt_segment *segments, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
        if (!vec3_within(segments[i].a, DPT_COORDINATE_MAX) || !vec3_within(segments[i].b, DPT_COORDINATE_MAX) ||
            !(segments[i].radius >= 0.0 && segments[i].radius <= DPT_COORDINATE_MAX))
            return DPT_E_FINITE;
    return DPT_OK;
}

/* Copy given segments into the world's. */
static void put_segments(struct dpt_world *world, struct tool *tool, const dpt_segment *segments)
{
    uint32_t slot = (uint32_t)(tool - world->tools);
    for (uint32_t i = 0; i < tool->segment_count; i++) {
        struct segment *to = &world->segments[tool->first_segment + i];
        const dpt_segment *given = &segments[i];
        tool->has_changed = tool->has_changed || !vec3_is_same(to->a, given->a) || !vec3_is_same(to->b, given->b) ||
                            to->radius != given->radius;
        to->a = vec3_of(segments[i].a);
        to->b = vec3_of(segments[i].b);
        to->radius = segments[i].radius;
        to->tool_slot = slot;
    }
}

dpt_result dpt_tool_add(dpt_world *world, const dpt_segment *segments, uint32_t count, dpt_tool *tool)
{
    if (!world || !segments || !tool || count == 0)
        return DPT_E_ARGUMENT;
    DPT_TRY(dpti_tool_check_segments(segments, count));
    uint32_t slot = slot_to_use(&world->tools->slot, sizeof *world->tools, world->tool_slot_end, world->freed_count[1]);
    if (slot == world->def.max_tools || count > world->def.max_segments - world->segment_count)
        return DPT_E_FULL;
    struct tool *made = &world->tools[slot];
    if (slot == world->tool_slot_end) {
        world->tool_slot_end++;
        made->slot.generation = 1;
    }
    made->slot.used = 1;
    const dpt_pose identity = DPT_POSE_IDENTITY;
    made->felt_frame = frame_identity;
    made->pose = identity;
    made->slot.valid = 1;
    made->user = 0;
    made->stiffness = world->def.stiffness;
    made->rotational_stiffness = made->damping = 0.0;
    made->lock_rotation = made->near_only = 0;
    made->closest = 0;
    made->piercing = DPT_PIERCING_NONE;
    made->shape = NULL;
    made->shape_user = NULL;
    made->law = world->def.law;
    made->is_free = 0;
    made->has_changed = 1;
    made->still_ticks = 0;
    made->first_segment = world->segment_count;
    made->segment_count = count;
    made->first_tip = world->tip_count;
    made->tip_count = 0;
    world->segment_count += count;
    put_segments(world, made, segments);
    world_note_max(&world->usage.tools, ++world->tool_count);
    world_note_max(&world->usage.segments, world->segment_count);
    dpti_tool_forget(world, made);
    *tool = handle_make(HANDLE_TOOL, &made->slot, slot);
    return DPT_OK;
}

/* The segments of all tools lie without gaps: later ones move up. */
dpt_result dpt_tool_remove(dpt_world *world, dpt_tool tool)
{
    struct tool *removed = world ? world_find_tool(world, tool) : NULL;
    if (!removed)
        return world ? DPT_E_HANDLE : DPT_E_ARGUMENT;
    uint32_t end = removed->first_segment + removed->segment_count;
    dpti_channels_forget_tool(world, removed);
    memmove(&world->segments[removed->first_segment], &world->segments[end],
            (world->segment_count - end) * sizeof *world->segments);
    dpti_body_search_remove(world, removed->first_segment, end);
    dpti_baseline_remove(world, removed->first_segment, end);
    dpti_broad_phase_remove(world, removed->first_segment, end);
    dpti_backlog_remove(world, removed->first_segment, end);
    dpti_persistent_contacts_remove(world, removed->first_segment, end);
    dpti_strips_remove(world, removed->first_segment, end);
    dpti_tips_remove(world, removed);
    world->undone_segment = 0;
    for (uint32_t t = 0; t < world->tool_slot_end; t++)
        if (world->tools[t].slot.used && world->tools[t].first_segment >= end)
            world->tools[t].first_segment -= removed->segment_count;
    world->segment_count -= removed->segment_count;
    /* Its channels are free again: a tool that rests before a wall for want of one looks again. */
    world->has_changed |= world->channels != NULL;
    slot_release(&removed->slot, &world->freed_count[1]);
    world->tool_count--;
    return DPT_OK;
}

/*
 * Mark a tool as free or rigid. The torque then has another origin, so a change ends all forces without a fade. A free one
 * does not pierce, and its size changes: it fits no hole.
 */
static void set_free(struct dpt_world *world, struct tool *tool, uint32_t is_free)
{
    for (uint32_t i = 0; i < tool->segment_count && tool->is_free != is_free; i++)
        dpti_force_forget(&world->segments[tool->first_segment + i]);
    if (tool->is_free != is_free)
        dpti_proxy_set_free(world, tool, is_free);
    if (is_free && tool->piercing) {
        dpti_channels_forget_tool(world, tool);
        tool->piercing = DPT_PIERCING_NONE;
    }
    tool->has_changed |= tool->is_free != is_free;
    tool->is_free = is_free;
}

dpt_result dpt_tool_set_pose(dpt_world *world, dpt_tool tool, const dpt_pose *pose)
{
    struct tool *moved = world ? world_find_tool(world, tool) : NULL;
    if (!moved)
        return world ? DPT_E_HANDLE : DPT_E_ARGUMENT;
    struct frame frame;
    dpt_result result = pose ? frame_of_pose(pose, &frame) : DPT_E_ARGUMENT;
    moved->slot.valid = result == DPT_OK;
    if (result != DPT_OK)
        return result;
    set_free(world, moved, 0);
    moved->has_changed |= !pose_is_same(&moved->pose, pose);
    if (!dpti_proxy_is_used(world, moved))
        moved->felt_frame = frame;
    moved->pose = *pose;
    return DPT_OK;
}

dpt_result dpt_tool_teleport(dpt_world *world, dpt_tool tool, const dpt_pose *pose)
{
    dpt_result result = dpt_tool_set_pose(world, tool, pose);
    if (result == DPT_OK)
        dpti_tool_forget(world, world_find_tool(world, tool));
    return result;
}

dpt_result dpt_tool_set_segments(dpt_world *world, dpt_tool tool, const dpt_segment *segments, uint32_t count)
{
    struct tool *moved = world ? world_find_tool(world, tool) : NULL;
    if (!moved)
        return world ? DPT_E_HANDLE : DPT_E_ARGUMENT;
    dpt_result result =
        segments && count == moved->segment_count ? dpti_tool_check_segments(segments, count) : DPT_E_ARGUMENT;
    if (result == DPT_OK && ((count > 1 && dpti_proxy_is_used(world, moved)) || moved->tip_count))
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
    moved->felt_frame = frame_identity;
    moved->pose = identity;
    put_segments(world, moved, segments);
    return DPT_OK;
}

/* A caller's tip, from an array. */
static dpt_result read_tip(const dpt_tip *tips, uint32_t i, dpt_tip *tip)
{
    *tip = (dpt_tip){ .size = sizeof *tip };
    DPT_TRY(sized_take(sized_item(tips, i), sized_of(tips), sizeof *tip, tip, sizeof *tip));
    if (!tip->hull || tip->reserved)
        return DPT_E_ARGUMENT;
    struct frame frame;
    return frame_of_pose(tip->pose, &frame);
}

dpt_result dpt_tool_set_tips(dpt_world *world, dpt_tool tool, const dpt_tip *tips, uint32_t count)
{
    const dpt_pose identity = DPT_POSE_IDENTITY;
    dpt_tip tip;
    if (!world || (!tips && count))
        return DPT_E_ARGUMENT;
    struct tool *found = world_find_tool(world, tool);
    if (!found)
        return DPT_E_HANDLE;
    for (uint32_t i = 0; i < count; i++)
        DPT_TRY(read_tip(tips, i, &tip));
    if (count && (found->is_free || found->piercing ||
                  (world->def.until == DPT_UNTIL_RESPOND && !dpti_proxy_is_used(world, found))))
        return DPT_E_UNSUPPORTED;
    if (count > world->def.max_tips - (world->tip_count - found->tip_count))
        return DPT_E_FULL;
    dpti_tips_remove(world, found);
    struct tip *added = dpti_tips_add(world, found, count);
    for (uint32_t i = 0; i < count; i++) {
        read_tip(tips, i, &tip);
        added[i] = (struct tip){ .given = tip.hull, .wanted = tip.pose ? *tip.pose : identity, .trust = HUGE_VAL };
        dpti_tip_put(world, &added[i], &added[i].wanted);
        added[i].home_a = added[i].hull->axis_a;
        added[i].home_b = added[i].hull->axis_b;
    }
    dpti_tool_forget(world, found);
    return DPT_OK;
}

/* A tool's tip, or NULL with the error of a call. */
static struct tip *find_tip(const dpt_world *world, dpt_tool tool, uint32_t tip, dpt_result *result)
{
    const struct tool *found = world ? world_find_tool(world, tool) : NULL;
    *result = DPT_OK;
    if (found && tip < found->tip_count)
        return tool_tip(world, found, tip);
    *result = world && !found ? DPT_E_HANDLE : DPT_E_ARGUMENT;
    return NULL;
}

dpt_result dpt_tool_set_tip_pose(dpt_world *world, dpt_tool tool, uint32_t tip, const dpt_pose *pose)
{
    dpt_result result;
    struct frame frame;
    struct tip *moved = find_tip(world, tool, tip, &result);
    if (!moved)
        return result;
    DPT_TRY(pose ? frame_of_pose(pose, &frame) : DPT_E_ARGUMENT);
    struct tool *owner = world_find_tool(world, tool);
    owner->has_changed |= !pose_is_same(&moved->wanted, pose);
    moved->wanted = *pose;
    if (!dpti_proxy_is_used(world, owner))
        dpti_tips_put_all(world, owner);
    return DPT_OK;
}

dpt_result dpt_tool_get_tip_pose(const dpt_world *world, dpt_tool tool, uint32_t tip, dpt_pose *pose)
{
    dpt_result result;
    const struct tip *found = find_tip(world, tool, tip, &result);
    const dpt_pose identity = DPT_POSE_IDENTITY;
    if (!pose)
        return DPT_E_ARGUMENT;
    *pose = found ? found->pose : identity;
    return result;
}

int dpt_tool_is_valid(const dpt_world *world, dpt_tool tool)
{
    return world && world_find_tool(world, tool);
}

dpt_result dpt_tool_get_pose(const dpt_world *world, dpt_tool tool, dpt_pose *pose)
{
    const dpt_pose identity = DPT_POSE_IDENTITY;
    if (!world || !pose)
        return DPT_E_ARGUMENT;
    const struct tool *found = world_find_tool(world, tool);
    *pose = found && !found->is_free ? found->pose : identity;
    return found ? DPT_OK : DPT_E_HANDLE;
}

dpt_result dpt_tool_set_user(dpt_world *world, dpt_tool tool, uint64_t user)
{
    struct tool *found = world ? world_find_tool(world, tool) : NULL;
    if (!found)
        return world ? DPT_E_HANDLE : DPT_E_ARGUMENT;
    found->user = user;
    return DPT_OK;
}

dpt_result dpt_tool_get_user(const dpt_world *world, dpt_tool tool, uint64_t *user)
{
    if (!world || !user)
        return DPT_E_ARGUMENT;
    const struct tool *found = world_find_tool(world, tool);
    *user = found ? found->user : 0;
    return found ? DPT_OK : DPT_E_HANDLE;
}

dpt_result dpt_tool_set_shaper(dpt_world *world, dpt_tool tool, dpt_force_fn shape, void *user)
{
    struct tool *found = world ? world_find_tool(world, tool) : NULL;
    if (!found)
        return world ? DPT_E_HANDLE : DPT_E_ARGUMENT;
    found->shape = shape;
    found->shape_user = user;
    return DPT_OK;
}

/* Change the law. The segment of a free tool is kept in the world or, with a proxy, in a frame of its own. */
static void set_law(struct dpt_world *world, struct tool *tool, uint32_t law)
{
    const struct segment *segment = &world->segments[tool->first_segment];
    dpt_segment given = { .radius = segment->radius };
    vec3_store(segment->a, given.a);
    vec3_store(segment->b, given.b);
    const int had_proxy = dpti_proxy_is_used(world, tool);
    if (tool->is_free)
        dpti_proxy_set_free(world, tool, 0);
    tool->law = law;
    if (tool->is_free && !had_proxy && dpti_proxy_is_used(world, tool))
        dpti_proxy_set_segment(world, tool, &given);
    tool->felt_frame = tool_device_frame(tool);
    dpti_tool_forget(world, tool);
}

/* Whether a tool with that law can pierce: one thin straight part, led by a proxy. */
static int can_pierce(const struct dpt_world *world, const struct tool *tool, uint32_t law)
{
    const struct segment *segment = &world->segments[tool->first_segment];
    return world->channels && dpti_proxy_is_of(world, law) && !tool->is_free && tool->segment_count == 1 &&
           !tool->tip_count && segment->radius > 0.0 && length(sub(segment->b, segment->a)) > 0.0;
}

static void set_piercing(struct dpt_world *world, struct tool *tool, uint32_t piercing)
{
    if (tool->piercing == piercing)
        return;
    tool->piercing = piercing;
    dpti_tool_forget(world, tool);
}

dpt_result dpt_tool_set_settings(dpt_world *world, dpt_tool tool, const dpt_tool_settings *given)
{
    if (!world || !given)
        return DPT_E_ARGUMENT;
    struct tool *found = world_find_tool(world, tool);
    if (!found)
        return DPT_E_HANDLE;
    dpt_tool_settings settings = { .size = sizeof settings,
                                   .law = found->law,
                                   .stiffness = found->stiffness,
                                   .rotational_stiffness = found->rotational_stiffness,
                                   .damping = found->damping,
                                   .lock_rotation = found->lock_rotation,
                                   .near_only = found->near_only,
                                   .piercing = found->piercing };
    DPT_TRY(sized_read(given, SIZED_FIRST(dpt_tool_settings, piercing), &settings, sizeof settings));
    if (!dpti_law_is_valid(settings.law) || !dpti_stiffness_is_valid(settings.stiffness) ||
        !dpti_stiffness_is_valid(settings.rotational_stiffness) || !dpti_stiffness_is_valid(settings.damping) ||
        settings.lock_rotation > 1 || settings.near_only > 1 || settings.piercing > DPT_PIERCING_B || settings.reserved)
        return DPT_E_ARGUMENT;
    if (settings.piercing && !can_pierce(world, found, settings.law))
        return DPT_E_UNSUPPORTED;
    if ((found->is_free && found->segment_count > 1 && dpti_proxy_is_of(world, settings.law)) ||
        (found->tip_count && settings.law != found->law))
        return DPT_E_UNSUPPORTED;
    found->stiffness = settings.stiffness;
    found->rotational_stiffness = settings.rotational_stiffness;
    found->damping = settings.damping;
    found->lock_rotation = settings.lock_rotation;
    for (uint32_t i = 0; i < found->segment_count && found->near_only != settings.near_only; i++)
        dpti_far_forget(&world->segments[found->first_segment + i]);
    found->near_only = settings.near_only;
    found->has_changed = 1;
    if (found->law != settings.law)
        set_law(world, found, settings.law);
    set_piercing(world, found, settings.piercing);
    return DPT_OK;
}

dpt_result dpt_tool_get_settings(const dpt_world *world, dpt_tool tool, dpt_tool_settings *settings)
{
    if (!world || !settings)
        return DPT_E_ARGUMENT;
    dpt_tool_settings now = { .size = sizeof now };
    DPT_TRY(sized_check(settings, SIZED_FIRST(dpt_tool_settings, piercing), 0));
    const struct tool *found = world_find_tool(world, tool);
    if (found) {
        now.law = found->law;
        now.stiffness = found->stiffness;
        now.rotational_stiffness = found->rotational_stiffness;
        now.damping = found->damping;
        now.lock_rotation = found->lock_rotation;
        now.near_only = found->near_only;
        now.piercing = found->piercing;
    }
    sized_write(settings, settings->size, &now, sizeof now);
    return found ? DPT_OK : DPT_E_HANDLE;
}
