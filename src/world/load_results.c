/* SPDX-License-Identifier: BSD-3-Clause */
/* What users get about the points at which tools push bodies. */
#include "base/return_if_error.h"
#include "base/sized.h"
#include "proxy/tool_loads.h"
#include "track/persistent_contacts.h"

/* How far the point is beyond a contact's stretch, in shares of the segment's axis. */
static double beyond_stretch(const dpt_contact *contact, double s)
{
    return max_of(0.0, max_of(contact->s0 - s, s - contact->s1));
}

/* The contact in which a load is: its law's own, or the one of its segment and body that is nearest to it; 0: none. */
static uint32_t contact_of(const struct dpt_world *world, const struct tool *tool, const struct load_note *note)
{
    const struct persistent_contacts *contacts = &world->contacts[world->contacts_index];
    uint32_t id = note->contact;
    double min = HUGE_VAL;
    if (note->segment >= tool->segment_count) {
        const dpt_contact *contact = &tool_tip(world, tool, note->segment - tool->segment_count)->contact;
        return contact->body == note->body_id ? contact->id : 0;
    }
    const struct axis *axis = &world->segments[tool->first_segment + note->segment].answer.track.axis;
    const vec3 u = sub(axis->b, axis->a);
    const double square = dot(u, u), s = square > 0.0 ? dot(sub(note->at, axis->a), u) / square : 0.0;
    for (uint32_t i = 0; i < contacts->count && !note->contact; i++) {
        const struct persistent_contact *item = &contacts->items[i];
        const double beyond = beyond_stretch(&item->contact, s);
        if (item->segment_index != tool->first_segment + note->segment || item->contact.body != note->body_id ||
            item->is_unseen || !(beyond < min))
            continue;
        id = item->contact.id;
        min = beyond;
    }
    return id;
}

static int is_of(const struct dpt_world *world, const struct load_note *note, const struct tool *tool)
{
    return note->tool_slot == (uint32_t)(tool - world->tools);
}

dpt_result dpt_tool_get_loads(const dpt_world *world, dpt_tool tool, dpt_tool_load *loads, uint32_t capacity,
                              uint32_t *count)
{
    if (count)
        *count = 0;
    if (!world || !count || (!loads && capacity))
        return DPT_E_ARGUMENT;
    if (capacity)
        DPT_TRY(sized_check(loads, sizeof *loads, 1));
    const uint32_t size = capacity ? loads[0].size : 0;
    const struct tool *owner = world_find_tool(world, tool);
    if (!owner)
        return DPT_E_HANDLE;
    const struct load_settlement settled = dpti_loads_settlement(world, owner);
    for (uint32_t i = 0; i < world->load_count && *count < settled.count; i++) {
        const struct load_note *note = &world->loads[i];
        if (!is_of(world, note, owner))
            continue;
        if (*count < capacity) {
            const dpt_wrench on_body = dpti_loads_of_note(world, owner, &settled, note);
            dpt_tool_load load = { .body = note->body_id,
                                   .segment = note->segment,
                                   .contact = contact_of(world, owner, note),
                                   .triangle = note->triangle };
            vec3_store(note->at, load.point);
            vec3_store(scaled(vec3_of(on_body.force), -1.0), load.force);
            vec3_store(scaled(vec3_of(on_body.torque), -1.0), load.torque);
            sized_write((char *)loads + (size_t)*count * size, size, &load, sizeof load);
        }
        ++*count;
    }
    return DPT_OK;
}

/* Add what a tool does to a body, about the origin that the body's frame had in the step. */
static void add_tool(const struct dpt_world *world, const struct tool *tool, dpt_body body, dpt_wrench *sum)
{
    const struct load_settlement settled = dpti_loads_settlement(world, tool);
    vec3 force = vec3_of(sum->force), torque = vec3_of(sum->torque);
    for (uint32_t i = 0; i < world->load_count && settled.count; i++) {
        const struct load_note *note = &world->loads[i];
        if (!is_of(world, note, tool) || note->body_id != body)
            continue;
        const dpt_wrench on_body = dpti_loads_of_note(world, tool, &settled, note);
        const vec3 push = vec3_of(on_body.force);
        force = add(force, push);
        torque = add(torque, add(vec3_of(on_body.torque), cross(sub(note->at, note->about_body), push)));
    }
    vec3_store(force, sum->force);
    vec3_store(torque, sum->torque);
}

dpt_result dpt_tool_get_body_wrench(const dpt_world *world, dpt_tool tool, dpt_body body, dpt_wrench *wrench)
{
    if (!wrench)
        return DPT_E_ARGUMENT;
    memset(wrench, 0, sizeof *wrench);
    if (!world)
        return DPT_E_ARGUMENT;
    const struct tool *owner = world_find_tool(world, tool);
    if (!owner || !world_find_body(world, body))
        return DPT_E_HANDLE;
    add_tool(world, owner, body, wrench);
    return DPT_OK;
}

dpt_result dpt_body_get_wrench(const dpt_world *world, dpt_body body, dpt_wrench *wrench)
{
    if (!wrench)
        return DPT_E_ARGUMENT;
    memset(wrench, 0, sizeof *wrench);
    if (!world)
        return DPT_E_ARGUMENT;
    if (!world_find_body(world, body))
        return DPT_E_HANDLE;
    for (uint32_t t = 0; t < world->tool_slot_end; t++)
        if (world->tools[t].slot.used)
            add_tool(world, &world->tools[t], body, wrench);
    return DPT_OK;
}
