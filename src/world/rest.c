/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/rest.h"

#include "proxy/proxy.h"
#include "track/persistent_contacts.h"
#include "track/tool_parts.h"

/* The first tick without a change may still end a motion; the second repeats it. */
enum { STILL_TICKS = 2 };

int dpti_rest_begins(const struct dpt_world *world, struct tool *tool)
{
    /* Its own contacts may be among those for which the last tick had no room. */
    if (world->contacts_overflowed)
        tool->still_ticks = 0;
    return tool_is_active(world, tool) && !tool_has_changed(world, tool) && tool->still_ticks >= STILL_TICKS;
}

void dpti_rest_keep_answers(struct dpt_world *world, struct tool *tool)
{
    for (uint32_t i = 0; i < tool->segment_count; i++) {
        struct segment *segment = &world->segments[tool->first_segment + i];
        segment->result.work = segment->hit.work = 0;
        segment->pushing_part = segment->previous_pushing_part;
    }
    tool->energy = tool->body_work = 0.0;
    if (dpti_proxy_is_used(world, tool))
        proxy_of(world, tool)->tick = world->ticks;
}

void dpti_rest_keep_contacts(struct dpt_world *world, uint32_t segment_index)
{
    const struct persistent_contacts *last = contacts_last_tick(world);
    for (uint32_t i = 0; i < last->count; i++) {
        struct persistent_contact *kept =
            last->items[i].segment_index == segment_index ? dpti_persistent_contacts_add(world) : NULL;
        if (kept)
            *kept = last->items[i];
    }
}

/*
 * Whether a segment has all answers that the world is asked for. Without a budget a contact that is unknown stays so,
 * once the motion is swept.
 */
static int is_known(const struct dpt_world *world, uint32_t segment_index)
{
    const struct segment *segment = &world->segments[segment_index];
    if (!segment->answer.body || !(segment->answer.is_exact || segment->answer.is_far))
        return 0;
    if (world->def.until == DPT_UNTIL_TRACK)
        return 1;
    if (world->motion_backlogs[segment_index].count)
        return 0;
    return !world->def.budget || (segment->result.contact != DPT_CONTACT_UNKNOWN && !work_is_spent(&world->work));
}

/* The contacts of a segment in one of the two lists, one after the other; NULL at the end. */
static const struct persistent_contact *next_of(const struct persistent_contacts *list, uint32_t *at,
                                                uint32_t segment_index)
{
    while (*at < list->count)
        if (list->items[(*at)++].segment_index == segment_index)
            return &list->items[*at - 1];
    return NULL;
}

static int has_same_contacts(const struct dpt_world *world, uint32_t segment_index)
{
    const struct persistent_contacts *now = &world->contacts[world->contacts_index];
    const struct persistent_contacts *last = &world->contacts[1 - world->contacts_index];
    uint32_t at = 0, at_last = 0;
    for (;;) {
        const struct persistent_contact *one = next_of(now, &at, segment_index);
        const struct persistent_contact *other = next_of(last, &at_last, segment_index);
        if (!one || !other)
            return !one && !other;
        if (!persistent_contact_is_same(one, other))
            return 0;
    }
}

/* Whether a search from where the last one ended found the same. Of triangles that are as near it names any. */
static int has_same_nearest(struct segment *segment)
{
    const struct pair_search *nearest = &segment->answer.track.nearest;
    const int is_same =
        segment->still_triangle == nearest->triangle && segment->still_distance2 == nearest->pair.distance2;
    segment->still_triangle = nearest->triangle;
    segment->still_distance2 = nearest->pair.distance2;
    return is_same;
}

/* Whether the tool ends the tick as it began it, and nothing is left to do. */
static int stood_still(const struct dpt_world *world, const struct tool *tool)
{
    if (!tool_is_active(world, tool) || tool_has_changed(world, tool) || world->deform_count ||
        world->def.method == DPT_METHOD_PAPER)
        return 0;
    if (dpti_proxy_is_used(world, tool) && (!proxy_of(world, tool)->is_still || !dpti_proxy_has_size(world, tool)))
        return 0;
    int is_same = 1;
    for (uint32_t s = tool->first_segment; s < tool->first_segment + tool->segment_count; s++)
        is_same &= is_known(world, s) && has_same_nearest(&world->segments[s]) && has_same_contacts(world, s);
    for (uint32_t i = 0; i < tool->tip_count; i++)
        is_same &= tool_tip(world, tool, i)->answer.body && tool_tip(world, tool, i)->answer.is_exact;
    return is_same;
}

void dpti_rest_note(struct dpt_world *world, struct tool *tool)
{
    tool->still_ticks = stood_still(world, tool) ? tool->still_ticks + 1 : 0;
    tool->has_changed = 0;
}

void dpti_rest_forget(struct dpt_world *world)
{
    for (uint32_t t = 0; t < world->tool_slot_end; t++)
        world->tools[t].still_ticks = 0;
}
