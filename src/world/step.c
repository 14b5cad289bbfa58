/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * One tick. The search and the force of a tool are two rows of functions, with one function for each stage. Both rows
 * are chosen once a tick, so no stage asks for the tool's law, or whether it rests. `tick` calls the stages in order;
 * below it come the rows, first the default one, of a tool with a proxy.
 */
#include "base/return_if_error.h"
#include "base/sized.h"
#include "base/wrench_limit.h"
#include "proxy/proxy.h"
#include "proxy/proxy_force.h"
#include "proxy/tool_loads.h"
#include "track/contacts.h"
#include "track/persistent_contacts.h"
#include "track/swept_motion.h"
#include "track/tool_parts.h"
#include "track/world_state.h"
#include "world/baseline_method.h"
#include "world/deform_body.h"
#include "world/rest.h"
#include "world/tool_force.h"
#include "world/tool_results.h"
#include "world/tool_strips.h"

/* How a tool comes to its answers, stage by stage. NULL: nothing is done. */
struct search_stages {
    void (*begin)(struct dpt_world *world, struct tool *tool);           /* end the answers of the last tick */
    void (*lead)(struct dpt_world *world, struct tool *tool, double dt); /* lead the proxy towards the device */
    void (*track)(struct dpt_world *world, uint32_t segment_index);      /* find a segment's nearest pair */
    void (*track_tips)(struct dpt_world *world, struct tool *tool);      /* find the nearest pairs of tips */
    void (*contact)(struct dpt_world *world, uint32_t segment_index);    /* find contacts and strip, write the hit */
    void (*finish)(struct dpt_world *world, struct tool *tool);     /* conclude from the contacts of all segments */
    void (*write_hits)(struct dpt_world *world, struct tool *tool); /* write the hits of the whole tool */
};

/* What is felt of these answers. NULL: nothing is done. */
struct force_stages {
    void (*respond)(struct dpt_world *world, uint32_t segment_index, double dt); /* update a segment's share */
    void (*sum)(struct dpt_world *world, struct tool *tool, double dt);          /* the wrench, and why it is zero */
};

/* The rows, which are chosen at the end of this file. */
enum { SEARCH_WITH_PROXY, SEARCH_WITH_SWEEP, SEARCH_ONLY, SEARCH_OF_PAPER, SEARCH_OF_REST };
enum { FORCE_OF_PROXY, FORCE_OF_PENALTY, FORCE_OF_BED, FORCE_OF_NONE };
static const struct search_stages *search_of(const struct tool *tool);
static const struct force_stages *force_of(const struct tool *tool);
static void choose_rows(struct dpt_world *world, struct tool *tool);

/* A proxy that rests is pushed as before; the other laws note their loads in each tick. */
static int keeps_loads(const struct tool *tool)
{
    return tool->search == SEARCH_OF_REST && tool->force == FORCE_OF_PROXY;
}

/* Choose the rows of all tools for this tick, and end the answers of the last one. */
static void begin_tools(struct dpt_world *world)
{
    for (uint32_t t = 0; t < world->tool_slot_end; t++) {
        struct tool *tool = &world->tools[t];
        if (!tool->slot.used)
            continue;
        choose_rows(world, tool);
        search_of(tool)->begin(world, tool);
    }
    dpti_loads_begin_tick(world, keeps_loads);
}

static void begin_tick(struct dpt_world *world)
{
    const dpt_world_def *def = &world->def;
    world->ticks++;
    begin_tools(world);
    world->work = work_of(def->budget ? def->budget : WORK_UNLIMITED);
    world->sweep_work_left = def->sweep_budget ? def->sweep_budget : WORK_UNLIMITED;
    world->point_cache.tick = world->ticks;
    dpti_persistent_contacts_begin_tick(world);
}

/*
 * Tools with a proxy take turns to begin, so that each gets work in time. They do not share a tick evenly, as a motion
 * that is not proven to its end is not made. They keep their turn for some ticks, as a search that cannot go on in the
 * next tick is lost.
 */
enum { TURN_TICKS = 8 };

static void lead_proxies(struct dpt_world *world, double dt)
{
    const uint32_t slots = world->tool_slot_end;
    for (uint32_t i = 0; i < slots; i++) {
        struct tool *tool = &world->tools[(world->ticks / TURN_TICKS + i) % slots];
        if (tool->slot.used && search_of(tool)->lead)
            search_of(tool)->lead(world, tool, dt);
    }
}

/*
 * All segments share the budget: first for their nearest pairs, then what is left for their contacts. Every other
 * tick begins with the first segment that the tick before left undone. The ticks between begin with each segment in
 * turn: a segment that moves and is never done would otherwise leave nothing to the others.
 */
static uint32_t first_segment(const struct dpt_world *world)
{
    const uint32_t turn = world->ticks - 1;
    const uint32_t first =
        turn % 2 && world->segment_count > 1 ? turn / 2 % world->segment_count : world->undone_segment;
    return first < world->segment_count ? first : 0;
}

static struct tool *tool_of(const struct dpt_world *world, uint32_t segment_index)
{
    return &world->tools[world->segments[segment_index].tool_slot];
}

static void track_tools(struct dpt_world *world, uint32_t first)
{
    for (uint32_t i = 0; i < world->segment_count; i++) {
        const uint32_t segment_index = (first + i) % world->segment_count;
        const struct search_stages *search = search_of(tool_of(world, segment_index));
        if (search->track)
            search->track(world, segment_index);
    }
    for (uint32_t t = 0; t < world->tool_slot_end; t++) {
        struct tool *tool = &world->tools[t];
        if (tool->tip_count && tool_is_active(world, tool) && search_of(tool)->track_tips)
            search_of(tool)->track_tips(world, tool);
    }
}

/* Whether the tick left a segment with less than it was to find, where a later tick can find it. */
static int is_undone(const struct dpt_world *world, uint32_t segment_index)
{
    const struct segment *segment = &world->segments[segment_index];
    const struct segment_result *result = &segment->result;
    const int is_unknown = (result->status == DPT_STATUS_BOUNDED && !segment->answer.is_far) ||
                           (result->status == DPT_STATUS_EXACT && result->contact == DPT_CONTACT_UNKNOWN);
    return is_unknown && (world->def.budget || world->motion_backlogs[segment_index].count);
}

static void contact_tools(struct dpt_world *world, uint32_t first, double dt)
{
    int has_undone = 0;
    for (uint32_t i = 0; i < world->segment_count; i++) {
        const uint32_t segment_index = (first + i) % world->segment_count;
        const struct tool *tool = tool_of(world, segment_index);
        search_of(tool)->contact(world, segment_index);
        if (force_of(tool)->respond)
            force_of(tool)->respond(world, segment_index, dt);
        if (has_undone || !is_undone(world, segment_index))
            continue;
        world->undone_segment = segment_index;
        has_undone = 1;
    }
    for (uint32_t t = 0; t < world->tool_slot_end; t++) {
        struct tool *tool = &world->tools[t];
        if (tool->slot.used && search_of(tool)->finish)
            search_of(tool)->finish(world, tool);
    }
    world->has_changed = 0;
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

/* The wrenches and hits of whole tools, and what tools do to bodies. */
static void sum_tools(struct dpt_world *world, double dt)
{
    for (uint32_t t = 0; t < world->tool_slot_end && !world->invalid_body_count; t++) {
        struct tool *tool = &world->tools[t];
        if (!tool->slot.used)
            continue;
        if (tool->slot.valid)
            force_of(tool)->sum(world, tool, dt);
        if (search_of(tool)->write_hits)
            search_of(tool)->write_hits(world, tool);
        if (world->def.until != DPT_UNTIL_RESPOND)
            continue;
        dpti_loads_settle(world, tool);
        if (tool->shape && tool->slot.valid)
            shape_wrench(world, tool, dt);
    }
}

static void note_usage(struct dpt_world *world)
{
    dpt_world_info *usage = &world->usage;
    world_note_max(&usage->contacts, world->contacts_wanted);
    world_note_max(&usage->work, world->work.done);
    for (uint32_t i = 0; world->def.strip && i < world->segment_count; i++)
        world_note_max(&usage->strip, world->segment_strips[i].strip->count);
}

static void tick(struct dpt_world *world, double dt)
{
    begin_tick(world);
    const uint32_t first = first_segment(world);
    lead_proxies(world, dt);
    track_tools(world, first);
    contact_tools(world, first, dt);
    sum_tools(world, dt);
    dpti_deform_displace(world);
    note_usage(world);
    world->steps++;
    world->time += dt;
}

/* For a step that fails: no answer of the last tick counts as one of this tick. */
static void hide_answers(struct dpt_world *world)
{
    dpti_rest_forget(world);
    begin_tools(world);
    dpti_persistent_contacts_set_unseen(world);
    for (uint32_t s = 0; s < world->segment_count; s++)
        dpti_force_forget(&world->segments[s]);
}

/* The report of a step reads all hits, so they are part of its work. */
static void find_late_hits(struct dpt_world *world)
{
    for (uint32_t t = 0; t < world->tool_slot_end; t++)
        if (world->tools[t].slot.used && world->tools[t].has_late_hits)
            dpti_tool_find_hits(world, &world->tools[t], &world->work);
    world_note_max(&world->usage.work, world->work.done);
}

static void write_report(const struct dpt_world *world, dpt_step *to);

dpt_result dpt_world_step(dpt_world *world, double dt, dpt_step *out)
{
    if (!world)
        return DPT_E_ARGUMENT;
    dpt_result result = out ? sized_check(out, SIZED_FIRST(dpt_step, contacts), 0) : DPT_OK;
    const int has_report = out && result == DPT_OK;
    if (result == DPT_OK && !(dt > 0.0 && within(dt, 1e6)))
        result = DPT_E_ARGUMENT;
    dpti_deform_begin_step(world, result == DPT_OK ? dt : 0.0);
    if (result == DPT_OK)
        tick(world, dt);
    else
        hide_answers(world);
    if (has_report) {
        find_late_hits(world);
        write_report(world, out);
    }
    return result;
}

/* The default: a tool with a proxy. Its proxy has come where it is by free motion, so nothing is swept any more. */

/* Find the contacts of a segment. Where a budget has ended its search or sweep, those of the last tick stay. */
static void find_contacts(struct dpt_world *world, uint32_t segment_index, int is_swept)
{
    struct segment *segment = &world->segments[segment_index];
    const struct body_answer *answer = &segment->answer;
    if (answer->is_far) {
        dpti_contacts_set_none(segment);
    } else if (is_swept && answer->body && answer->is_exact) {
        dpti_contacts_find(world, segment_index, answer, &segment->result, &segment->penetration);
    } else {
        dpti_persistent_contacts_carry_over(world, segment_index);
        if (answer->body)
            segment->result.unknown = DPT_HIT_FLAG_BUDGET;
    }
}

/* A segment's strip, where strips are asked for, and its hit as users get it, unless that is of another pose. */
static void write_segment(struct dpt_world *world, uint32_t segment_index)
{
    if (world->def.strip && world->def.until != DPT_UNTIL_TRACK)
        dpti_strips_find(world, segment_index);
    if (!tool_of(world, segment_index)->has_late_hits)
        dpti_tool_write_hit(&world->segments[segment_index]);
}

static void contact_at_proxy(struct dpt_world *world, uint32_t segment_index)
{
    const uint32_t work_before = world->work.done;
    near_bodies_forget(&world->near_bodies);
    find_contacts(world, segment_index, 1);
    world->segments[segment_index].result.work += world->work.done - work_before;
    tool_of(world, segment_index)->has_late_hits = (uint32_t)dpti_proxy_is_away(world, tool_of(world, segment_index));
    write_segment(world, segment_index);
}

static void finish_proxy(struct dpt_world *world, struct tool *tool)
{
    dpti_rest_note(world, tool);
    dpti_proxy_settle(world, tool);
}

/* Tips have their contacts where the world has any. */
static void find_contacts_of_tips(struct dpt_world *world, struct tool *tool)
{
    if (tool->tip_count && world->def.until != DPT_UNTIL_TRACK && world->def.max_contacts)
        dpti_tips_find_contacts(world, tool);
}

/* Hits are those at the device's pose, from which the proxy may be held away: these are found when they are read. */
static void write_hits_at_device(struct dpt_world *world, struct tool *tool)
{
    if (tool->has_late_hits)
        dpti_proxy_note_device(world, tool);
    else
        dpti_tool_write_hits(world, tool);
    /* A search makes boxes of vertices that moved, and with near_only it tells the next tick what is far. */
    if (tool->has_late_hits && (world->deform_count || far_is_used(world, tool)))
        dpti_tool_find_hits(world, tool, &world->work);
    find_contacts_of_tips(world, tool);
}

static const struct search_stages search_with_proxy = {
    .begin = dpti_tool_clear,
    .lead = dpti_proxy_step,
    .contact = contact_at_proxy,
    .finish = finish_proxy,
    .write_hits = write_hits_at_device,
};

static const struct force_stages force_of_proxy = { .sum = dpti_proxy_respond };

/* The laws that push by depth: the tool is where its device is, and its motion is swept after the search. */

/* A tool whose far segments are left out is searched for as a whole, in the turn of its first segment. */
static void track_at_device(struct dpt_world *world, uint32_t segment_index)
{
    struct tool *tool = tool_of(world, segment_index);
    if (!far_is_used(world, tool) || !tool_is_active(world, tool))
        dpti_track_segment(world, segment_index);
    else if (segment_index == tool->first_segment)
        dpti_track_near(world, tool, world->def.until == DPT_UNTIL_TRACK);
}

/* Sweep a segment and find its contacts. */
static void contact_after_sweep(struct dpt_world *world, uint32_t segment_index)
{
    struct segment *segment = &world->segments[segment_index];
    const uint32_t work_before = world->work.done;
    near_bodies_forget(&world->near_bodies);
    int is_swept = segment->answer.body && dpti_backlog_sweep(world, segment_index);
    const int is_free = is_swept && segment->sweep.status == DPT_SWEEP_FREE;
    if (segment->answer.is_far && !is_free)
        dpti_track_far(world, segment_index);
    find_contacts(world, segment_index, is_swept);
    segment->result.work += world->work.done - work_before;
    segment->proven.is_outside = segment->result.contact == DPT_CONTACT_SEPARATED;
    dpti_backlog_end_tick(world, segment_index);
    write_segment(world, segment_index);
}

static void write_hits_of_tips(struct dpt_world *world, struct tool *tool)
{
    dpti_tool_write_hits(world, tool);
    if (tool_is_active(world, tool))
        find_contacts_of_tips(world, tool);
}

static const struct search_stages search_with_sweep = {
    .begin = dpti_tool_clear,
    .track = track_at_device,
    .track_tips = dpti_tips_track,
    .contact = contact_after_sweep,
    .finish = dpti_rest_note,
    .write_hits = write_hits_of_tips,
};

static void respond_by_penalty(struct dpt_world *world, uint32_t segment_index, double dt)
{
    dpti_force_respond(world, segment_index, dt, dpti_penalty_push);
}

static void respond_by_bed(struct dpt_world *world, uint32_t segment_index, double dt)
{
    dpti_force_respond(world, segment_index, dt, dpti_bed_push);
}

static void sum_segments(struct dpt_world *world, struct tool *tool, double dt)
{
    (void)dt;
    dpti_force_sum(world, tool);
    dpti_loads_note_segments(world, tool);
}

static const struct force_stages force_of_penalty = { .respond = respond_by_penalty, .sum = sum_segments };
static const struct force_stages force_of_bed = { .respond = respond_by_bed, .sum = sum_segments };

static void sum_none(struct dpt_world *world, struct tool *tool, double dt)
{
    (void)dt;
    dpti_force_sum(world, tool);
}

static const struct force_stages force_of_none = { .sum = sum_none };

/* A world that only tracks has no contacts, and no force. */

static const struct search_stages search_only = {
    .begin = dpti_tool_clear_hits,
    .track = track_at_device,
    .track_tips = dpti_tips_track,
    .contact = write_segment,
    .finish = dpti_rest_note,
    .write_hits = write_hits_of_tips,
};

/* The paper's method finds the penetration with the nearest pair. */
static const struct search_stages search_of_paper = {
    .begin = dpti_tool_clear,
    .track = dpti_baseline_track,
    .track_tips = dpti_tips_track,
    .contact = write_segment,
    .finish = dpti_rest_note,
    .write_hits = write_hits_of_tips,
};

/* A tool that rests keeps its answers and hits. Its force is computed in every tick, as it may fade. */
static const struct search_stages search_of_rest = {
    .begin = dpti_rest_keep_answers,
    .contact = dpti_rest_keep_contacts,
};

static const struct search_stages *search_of(const struct tool *tool)
{
    static const struct search_stages *const searches[] = { [SEARCH_WITH_PROXY] = &search_with_proxy,
                                                            [SEARCH_WITH_SWEEP] = &search_with_sweep,
                                                            [SEARCH_ONLY] = &search_only,
                                                            [SEARCH_OF_PAPER] = &search_of_paper,
                                                            [SEARCH_OF_REST] = &search_of_rest };
    return searches[tool->search];
}

static const struct force_stages *force_of(const struct tool *tool)
{
    static const struct force_stages *const forces[] = { [FORCE_OF_PROXY] = &force_of_proxy,
                                                         [FORCE_OF_PENALTY] = &force_of_penalty,
                                                         [FORCE_OF_BED] = &force_of_bed,
                                                         [FORCE_OF_NONE] = &force_of_none };
    return forces[tool->force];
}

/* What no other stage asks. */
static void choose_rows(struct dpt_world *world, struct tool *tool)
{
    const int has_proxy = tool_is_active(world, tool) && dpti_proxy_is_used(world, tool);
    tool->search = world->def.method == DPT_METHOD_PAPER ? SEARCH_OF_PAPER
                   : world->def.until == DPT_UNTIL_TRACK ? SEARCH_ONLY
                                                         : SEARCH_WITH_SWEEP;
    tool->force = tool->law == DPT_LAW_BED ? FORCE_OF_BED : FORCE_OF_PENALTY;
    if (world->def.until != DPT_UNTIL_RESPOND)
        tool->force = FORCE_OF_NONE;
    if (has_proxy) {
        tool->search = SEARCH_WITH_PROXY;
        tool->force = FORCE_OF_PROXY;
    }
    if (dpti_rest_begins(world, tool))
        tool->search = SEARCH_OF_REST;
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

/* A part's share of the report. */
static void add_part(struct part part, dpt_step *out, int *has_answer)
{
    const dpt_hit *hit = part_hit(part);
    out->work += hit->work;
    out->contacts += part.tip && part.tip->contact.id;
    if (hit->status < out->status && !(part.segment && part.segment->answer.is_far))
        out->status = hit->status;
    if (severity(hit->contact) > severity(out->contact))
        out->contact = hit->contact;
    if (hit->status == DPT_STATUS_STALE || (*has_answer && !(hit->distance < out->distance)))
        return;
    out->distance = hit->distance;
    *has_answer = 1;
}

/* Write what a step has found over all tools, for the caller. */
static void write_report(const struct dpt_world *world, dpt_step *to)
{
    const struct persistent_contacts *contacts = &world->contacts[world->contacts_index];
    int has_answer = 0;
    dpt_step step = { .status = DPT_STATUS_EXACT, .contact = DPT_CONTACT_SEPARATED }, *out = &step;
    out->flags = world->contacts_overflowed ? DPT_STEP_FLAG_CONTACTS_FULL : 0;
    for (uint32_t i = 0; world->deform_count && i < world->body_slot_end; i++)
        if (world->bodies[i].slot.used && world->bodies[i].held_tick == world->ticks)
            out->flags |= DPT_STEP_FLAG_BODY_HELD;
    for (uint32_t i = 0; i < contacts->count; i++)
        out->contacts += !contacts->items[i].is_unseen;
    for (uint32_t t = 0; t < world->tool_slot_end; t++) {
        const struct tool *tool = &world->tools[t];
        for (uint32_t i = 0; tool->slot.used && i < tool_part_count(tool); i++)
            add_part(tool_part(world, tool, i), out, &has_answer);
    }
    if (!has_answer) {
        out->status = DPT_STATUS_STALE;
        out->contact = DPT_CONTACT_UNKNOWN;
    }
    sized_write(to, to->size, &step, sizeof step);
}
