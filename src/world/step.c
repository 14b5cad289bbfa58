/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * One tick:
 *
 *     for each tool with a proxy
 *         follow     lead the proxy towards the device
 *     for each segment of the others
 *         track      find the nearest pair over all bodies
 *     for each of them
 *         sweep      find what it met in its motion since the last tick
 *         contact    find contacts, sides, gap and exit direction
 *         strip      find the triangles under it
 *         respond    update its share of the wrench
 *     for each tool
 *         sum its segments, and say why the wrench is zero
 */
#include "base/return_if_error.h"
#include "base/sized.h"
#include "base/wrench_limit.h"
#include "proxy/proxy_force.h"
#include "proxy/proxy_step.h"
#include "proxy/tool_loads.h"
#include "track/contacts.h"
#include "track/far_segment.h"
#include "track/motion_backlog.h"
#include "track/persistent_contacts.h"
#include "track/segment_track.h"
#include "track/tool_tips.h"
#include "track/world_state.h"
#include "world/baseline_method.h"
#include "world/deform_body.h"
#include "world/rest.h"
#include "world/tool_force.h"
#include "world/tool_results.h"
#include "world/tool_strips.h"

/* Where a budget has ended the search or the sweep before contacts: they stay as they were. */
static void leave_contacts(struct dpt_world *world, uint32_t segment_index)
{
    struct segment *segment = &world->segments[segment_index];
    dpti_persistent_contacts_carry_over(world, segment_index);
    if (segment->answer.body)
        segment->result.unknown = DPT_HIT_FLAG_BUDGET;
}

/* Sweep a segment and find its contacts. */
static void contact_segment(struct dpt_world *world, uint32_t segment_index)
{
    struct segment *segment = &world->segments[segment_index];
    const uint32_t work_before = world->work.done;
    world->near_bodies.reach = -1.0;
    int is_swept = segment->answer.body && dpti_backlog_sweep(world, segment_index);
    const int is_free = is_swept && segment->sweep.status == DPT_SWEEP_FREE;
    if (segment->answer.is_far && !is_free)
        dpti_track_far(world, segment_index);
    if (segment->answer.is_far)
        dpti_contacts_set_none(segment);
    else if (is_swept && segment->answer.is_exact)
        dpti_contacts_find(world, segment_index, &segment->answer, &segment->result, &segment->penetration);
    else
        leave_contacts(world, segment_index);
    segment->result.work += world->work.done - work_before;
    segment->proven.is_outside = segment->result.contact == DPT_CONTACT_SEPARATED;
    dpti_backlog_end_tick(world, segment_index);
}

/* Find the contacts of a proxy's segment. It has come here by free motion: nothing is swept. */
static void contact_proxy_segment(struct dpt_world *world, uint32_t segment_index)
{
    struct segment *segment = &world->segments[segment_index];
    const uint32_t work_before = world->work.done;
    world->near_bodies.reach = -1.0;
    if (segment->answer.is_far)
        dpti_contacts_set_none(segment);
    else if (segment->answer.body && segment->answer.is_exact)
        dpti_contacts_find(world, segment_index, &segment->answer, &segment->result, &segment->penetration);
    else
        leave_contacts(world, segment_index);
    segment->result.work += world->work.done - work_before;
}

static int has_proxy(const struct dpt_world *world, const struct tool *tool)
{
    return tool_is_active(world, tool) && dpti_proxy_is_used(world, tool);
}

/*
 * Tools with a proxy take turns to begin: none leaves the others nothing for ever. They do not share a tick evenly,
 * as a motion that is not proven to its end is not made; and they keep their turn for some ticks, as what was searched
 * is lost where the next tick cannot go on.
 */
enum { TURN_TICKS = 8 };

static void step_proxies(struct dpt_world *world, double dt)
{
    const uint32_t slots = world->tool_slot_end;
    for (uint32_t i = 0; i < slots; i++) {
        struct tool *tool = &world->tools[(world->ticks / TURN_TICKS + i) % slots];
        if (has_proxy(world, tool) && !tool->is_resting)
            dpti_proxy_step(world, tool, dt);
    }
}

/* A tool whose far segments are left out is searched for as a whole, in the turn of its first segment. */
static void track(struct dpt_world *world, uint32_t segment_index)
{
    struct tool *tool = &world->tools[world->segments[segment_index].tool_slot];
    if (tool->is_resting || has_proxy(world, tool))
        return;
    if (world->def.method == DPT_METHOD_PAPER)
        dpti_baseline_track(world, segment_index);
    else if (!far_is_used(world, tool) || !tool_is_active(world, tool))
        dpti_track_segment(world, segment_index);
    else if (segment_index == tool->first_segment)
        dpti_track_near(world, tool, world->def.until == DPT_UNTIL_TRACK);
}

/*
 * All segments share the budget: first for their nearest pairs, then what is left for their contacts. Every other
 * tick begins with the first segment that the tick before left undone. The ticks between begin with each segment in
 * turn: a segment that moves and is never done would otherwise leave nothing to the others.
 */
static void step_segments(struct dpt_world *world, double dt)
{
    uint32_t count = world->segment_count, tick = world->ticks++;
    uint32_t first = tick % 2 && count > 1 ? tick / 2 % count : world->undone_segment;
    first = first < count ? first : 0;
    int has_undone = 0;
    world->work = work_of(world->def.budget ? world->def.budget : WORK_UNLIMITED);
    world->sweep_work_left = world->def.sweep_budget ? world->def.sweep_budget : WORK_UNLIMITED;
    world->point_cache.tick = tick;
    dpti_persistent_contacts_begin_tick(world);
    step_proxies(world, dt);
    for (uint32_t i = 0; i < count; i++)
        track(world, (first + i) % count);
    for (uint32_t t = 0; t < world->tool_slot_end; t++) {
        struct tool *tool = &world->tools[t];
        if (tool->tip_count && tool_is_active(world, tool) && !tool->is_resting && !has_proxy(world, tool))
            dpti_tips_track(world, tool);
    }
    for (uint32_t i = 0; i < count; i++) {
        uint32_t segment_index = (first + i) % count;
        const struct tool *tool = &world->tools[world->segments[segment_index].tool_slot];
        const int is_of_proxy = has_proxy(world, tool);
        if (tool->is_resting)
            dpti_rest_keep_contacts(world, segment_index);
        else if (is_of_proxy)
            contact_proxy_segment(world, segment_index);
        else if (world->def.until != DPT_UNTIL_TRACK && world->def.method != DPT_METHOD_PAPER)
            contact_segment(world, segment_index);
        if (world->def.strip && world->def.until != DPT_UNTIL_TRACK && !tool->is_resting)
            dpti_strips_find(world, segment_index);
        if (world->def.until == DPT_UNTIL_RESPOND && !is_of_proxy)
            dpti_force_respond(world, segment_index, dt);
        if (!tool->is_resting)
            dpti_tool_write_hit(&world->segments[segment_index]);
        const struct segment_result *result = &world->segments[segment_index].result;
        const int is_unknown =
            (result->status == DPT_STATUS_BOUNDED && !world->segments[segment_index].answer.is_far) ||
            (result->status == DPT_STATUS_EXACT && result->contact == DPT_CONTACT_UNKNOWN);
        if (!has_undone && is_unknown && (world->def.budget || world->motion_backlogs[segment_index].count)) {
            world->undone_segment = segment_index;
            has_undone = 1;
        }
    }
}

static double surface_distance(const struct segment *segment)
{
    return segment->hit.distance - segment->radius;
}

/* Let the program's own function have the wrench. */
static void shape_wrench(const struct dpt_world *world, struct tool *tool, double dt)
{
    const dpt_force_info info = dpti_tool_force_info(world, tool);
    const dpt_wrench none = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.0 } };
    tool->shape(tool->shape_user, &info, dt, &tool->wrench);
    tool->force_flags |= DPT_FORCE_FLAG_SHAPED;
    if (wrench_is_finite(&tool->wrench))
        return;
    tool->wrench = none;
    tool->force_reason = DPT_FORCE_UNDECIDED;
}

/* Tips have their hits, and their contacts where the world has any. */
static void write_tips(struct dpt_world *world, struct tool *tool)
{
    struct frame device;
    frame_of_pose(&tool->pose, &device);
    dpti_tips_write_hits(world, tool, dpti_proxy_is_away(world, tool) ? &device : NULL);
    if (world->def.until != DPT_UNTIL_TRACK && world->def.max_contacts)
        dpti_tips_find_contacts(world, tool);
}

/* The segment, or tip, whose hit is the tool's. */
static void choose_nearest(const struct dpt_world *world, struct tool *tool)
{
    const struct segment *segments = &world->segments[tool->first_segment];
    double least = HUGE_VAL;
    for (uint32_t i = 0; i < tool->segment_count; i++)
        if (surface_distance(&segments[i]) < surface_distance(&segments[tool->nearest_segment]))
            tool->nearest_segment = i;
    if (tool->tip_count)
        least = surface_distance(&segments[tool->nearest_segment]);
    for (uint32_t i = 0; i < tool->tip_count; i++) {
        const struct tip *tip = tool_tip(world, tool, i);
        const double distance = tip->hit.distance - tip->hull->radius;
        if (tip->hit.status == DPT_STATUS_STALE || !(distance < least))
            continue;
        least = distance;
        tool->nearest_segment = tool->segment_count + i;
    }
}

/* Choose the segment whose hit is the tool's, and sum the wrench. */
static void sum_tool(struct dpt_world *world, struct tool *tool, double dt)
{
    const int is_of_proxy = has_proxy(world, tool);
    if (is_of_proxy && !tool->is_resting)
        dpti_proxy_settle(world, tool);
    if (is_of_proxy)
        dpti_proxy_respond(world, tool, dt);
    if (is_of_proxy && !tool->is_resting)
        dpti_proxy_write_hits(world, tool);
    if (tool->tip_count && tool_is_active(world, tool) && !tool->is_resting)
        write_tips(world, tool);
    if (!tool->is_resting)
        choose_nearest(world, tool);
    if (tool_is_active(world, tool) && !is_of_proxy) {
        dpti_force_sum(world, tool);
        dpti_loads_note_segments(world, tool);
    }
    dpti_loads_settle(world, tool);
    if (tool->shape && tool_is_active(world, tool) && world->def.until == DPT_UNTIL_RESPOND)
        shape_wrench(world, tool, dt);
}

/* A rank of DPT_CONTACT_... for the report of a step: the gravest counts. */
static int severity(uint32_t contact)
{
    switch (contact) {
    case DPT_CONTACT_PENETRATING:
        return 3;
    case DPT_CONTACT_TOUCHING:
        return 2;
    case DPT_CONTACT_UNKNOWN:
        return 1;
    default:
        return 0;
    }
}

/* A tip's part of the report. */
static void add_tip(const struct tip *tip, dpt_step *out, int *has_answer)
{
    const dpt_hit *hit = &tip->hit;
    out->contacts += tip->contact.id != 0;
    if (hit->status < out->status)
        out->status = hit->status;
    if (severity(hit->contact) > severity(out->contact))
        out->contact = hit->contact;
    if (hit->status == DPT_STATUS_STALE || (*has_answer && hit->distance >= out->distance))
        return;
    out->distance = hit->distance;
    *has_answer = 1;
}

/* Write what a step has found over all tools, for the caller. */
static void write_report(const struct dpt_world *world, dpt_step *to)
{
    int has_answer = 0;
    dpt_step step = { .work = 0 }, *out = &step;
    out->status = DPT_STATUS_EXACT;
    out->contact = DPT_CONTACT_SEPARATED;
    out->work = 0;
    out->distance = 0.0;
    out->contacts = 0;
    out->flags = world->contacts_overflowed ? DPT_STEP_FLAG_CONTACTS_FULL : 0;
    for (uint32_t i = 0; i < world->contacts[world->contacts_index].count; i++)
        out->contacts += !world->contacts[world->contacts_index].items[i].is_unseen;
    for (uint32_t t = 0; t < world->tool_slot_end; t++) {
        const struct tool *tool = &world->tools[t];
        for (uint32_t i = 0; tool->slot.used && i < tool->segment_count; i++) {
            const dpt_hit *hit = &world->segments[tool->first_segment + i].hit;
            out->work += hit->work;
            if (hit->status < out->status && !world->segments[tool->first_segment + i].answer.is_far)
                out->status = hit->status;
            if (severity(hit->contact) > severity(out->contact))
                out->contact = hit->contact;
            if (hit->status != DPT_STATUS_STALE && (!has_answer || hit->distance < out->distance)) {
                out->distance = hit->distance;
                has_answer = 1;
            }
        }
        for (uint32_t i = 0; tool->slot.used && i < tool->tip_count; i++)
            add_tip(tool_tip(world, tool, i), out, &has_answer);
    }
    if (!has_answer) {
        out->status = DPT_STATUS_STALE;
        out->contact = DPT_CONTACT_UNKNOWN;
    }
    sized_write(to, to->size, &step, sizeof step);
}

static void note_usage(struct dpt_world *world)
{
    dpt_world_info *usage = &world->usage;
    world_note_max(&usage->contacts, world->contacts_wanted);
    world_note_max(&usage->work, world->work.done);
    for (uint32_t i = 0; world->def.strip && i < world->segment_count; i++)
        world_note_max(&usage->strip, world->segment_strips[i].strip->count);
}

/* For a step that fails: no answer of the last tick counts as one of this tick. */
static void hide_answers(struct dpt_world *world)
{
    dpti_persistent_contacts_set_unseen(world);
    for (uint32_t s = 0; s < world->segment_count; s++)
        dpti_force_forget(&world->segments[s]);
}

/* Nothing of the last step counts as an answer of this one, but for a tool that rests. */
static void begin_tool(struct dpt_world *world, struct tool *tool, int tracks_only)
{
    if (tool->is_resting)
        dpti_rest_keep_answers(world, tool);
    else if (tracks_only)
        dpti_tool_clear_hits(world, tool);
    else
        dpti_tool_clear(world, tool);
}

dpt_result dpt_world_step(dpt_world *world, double dt, dpt_step *out)
{
    if (!world)
        return DPT_E_ARGUMENT;
    int tracks_only = world->def.until == DPT_UNTIL_TRACK && world->def.method != DPT_METHOD_PAPER;
    dpt_result result = out ? sized_check(out, SIZED_FIRST(dpt_step, contacts), 0) : DPT_OK;
    const int has_report = out && result == DPT_OK;
    if (result == DPT_OK && !(dt > 0.0 && within(dt, 1e6)))
        result = DPT_E_ARGUMENT;
    if (result == DPT_OK)
        dpti_rest_begin_step(world);
    else
        dpti_rest_forget(world);
    for (uint32_t t = 0; t < world->tool_slot_end; t++)
        if (world->tools[t].slot.used)
            begin_tool(world, &world->tools[t], tracks_only);
    dpti_loads_begin_step(world);
    dpti_deform_begin_step(world, result == DPT_OK ? dt : 0.0);
    if (result == DPT_OK) {
        step_segments(world, dt);
        dpti_rest_end_step(world);
    } else {
        hide_answers(world);
    }
    for (uint32_t t = 0; t < world->tool_slot_end; t++)
        if (world->tools[t].slot.used && result == DPT_OK && !world->invalid_body_count)
            sum_tool(world, &world->tools[t], dt);
    if (result == DPT_OK)
        dpti_deform_displace(world);
    if (result == DPT_OK) {
        note_usage(world);
        world->steps++;
        world->time += dt;
    }
    if (has_report)
        write_report(world, out);
    return result;
}
