/* SPDX-License-Identifier: BSD-3-Clause */
#include "track/persistent_contacts.h"

/* Bytes of dpt_world_bytes for each of max_contacts: one contact of this tick, one of the last. */
enum { BYTES_CONTACT = 1408 };
typedef char contact_fits[2 * sizeof(struct persistent_contact) <= BYTES_CONTACT ? 1 : -1];

uint64_t dpti_persistent_contacts_bytes(const dpt_world_def *def)
{
    return BYTES_CONTACT * (uint64_t)def->max_contacts;
}

char *dpti_persistent_contacts_place(struct dpt_world *world, char *at)
{
    for (int i = 0; i < 2; i++, at += BYTES_CONTACT / 2 * (size_t)world->def.max_contacts)
        world->contacts[i].items = (void *)at;
    return at;
}

void dpti_persistent_contacts_begin_tick(struct dpt_world *world)
{
    world->contacts_index = 1 - world->contacts_index;
    contacts_this_tick(world)->count = 0;
    world->contacts_overflowed = 0;
    world->contacts_wanted = 0;
}

void dpti_persistent_contacts_set_unseen(struct dpt_world *world)
{
    struct persistent_contacts *current = contacts_this_tick(world);
    for (uint32_t i = 0; i < current->count; i++)
        current->items[i].is_unseen = 1;
    world->contacts_overflowed = 0;
}

void dpti_persistent_contacts_reset(struct dpt_world *world)
{
    world->contacts[0].count = world->contacts[1].count = 0;
    world->last_contact_id = 0;
    world->contacts_overflowed = 0;
}

void dpti_persistent_contacts_forget(struct dpt_world *world, uint32_t first, uint32_t end, uint32_t slot)
{
    struct persistent_contacts *current = contacts_this_tick(world);
    uint32_t kept_count = 0;
    for (uint32_t i = 0; i < current->count; i++) {
        const struct persistent_contact *persistent = &current->items[i];
        int is_removed = persistent->segment_index >= first && persistent->segment_index < end &&
                         (slot == DPT_NONE || handle_index(persistent->contact.body) == slot);
        if (!is_removed)
            current->items[kept_count++] = *persistent;
    }
    current->count = kept_count;
    for (uint32_t s = first; s < end; s++) {
        struct depth_samples *samples = &world->segments[s].depth_samples;
        if (slot == DPT_NONE || handle_index(samples->body_id) == slot)
            samples->body_id = 0;
        world->segments[s].contact_work = 0;
    }
}

void dpti_persistent_contacts_remove(struct dpt_world *world, uint32_t first, uint32_t end)
{
    struct persistent_contacts *current = contacts_this_tick(world);
    dpti_persistent_contacts_forget(world, first, end, DPT_NONE);
    for (uint32_t i = 0; i < current->count; i++)
        if (current->items[i].segment_index >= end)
            current->items[i].segment_index -= end - first;
}

struct persistent_contact *dpti_persistent_contacts_add(struct dpt_world *world)
{
    struct persistent_contacts *this_tick = contacts_this_tick(world);
    world->contacts_wanted++;
    if (this_tick->count == world->def.max_contacts) {
        world->contacts_overflowed = 1;
        return NULL;
    }
    return &this_tick->items[this_tick->count++];
}

uint32_t dpti_persistent_contacts_new_id(struct dpt_world *world)
{
    world->last_contact_id += world->last_contact_id == UINT32_MAX ? 2u : 1u;
    return world->last_contact_id;
}

void dpti_persistent_contacts_note_motion(struct dpt_world *world, uint32_t segment_index)
{
    const struct segment *segment = &world->segments[segment_index];
    const struct persistent_contacts *last_tick = contacts_last_tick(world);
    int may_have_crossed = segment->sweep.status != DPT_SWEEP_UNFINISHED &&
                           (segment->sweep.status == DPT_SWEEP_NONE || segment->may_have_crossed);
    for (uint32_t i = 0; may_have_crossed && i < last_tick->count; i++)
        if (last_tick->items[i].segment_index == segment_index)
            last_tick->items[i].is_in_front = 0;
}

void dpti_persistent_contacts_carry_over_one(struct dpt_world *world, const struct persistent_contact *previous)
{
    struct persistent_contact *persistent = dpti_persistent_contacts_add(world);
    if (!persistent)
        return;
    *persistent = *previous;
    persistent->is_unseen = 1;
}

void dpti_persistent_contacts_carry_over_body(struct dpt_world *world, uint32_t segment_index, const struct body *body)
{
    const struct persistent_contacts *last_tick = contacts_last_tick(world);
    for (uint32_t i = 0; i < last_tick->count; i++)
        if (persistent_contact_is_of(&last_tick->items[i], segment_index, body))
            dpti_persistent_contacts_carry_over_one(world, &last_tick->items[i]);
}

void dpti_persistent_contacts_carry_over(struct dpt_world *world, uint32_t segment_index)
{
    dpti_persistent_contacts_note_motion(world, segment_index);
    dpti_persistent_contacts_carry_over_body(world, segment_index, NULL);
}

void dpti_persistent_contact_put_warm_start(struct persistent_contact *persistent, const struct warm_start *warm_start)
{
    uint32_t position = 0;
    while (position < persistent->warm_start_count && persistent->warm_starts[position].s != warm_start->s)
        position++;
    persistent->warm_start_count += position == persistent->warm_start_count && position < WARM_STARTS_MAX;
    position = position < WARM_STARTS_MAX ? position : WARM_STARTS_MAX - 1;
    memmove(persistent->warm_starts + 1, persistent->warm_starts, position * sizeof *warm_start);
    persistent->warm_starts[0] = *warm_start;
}

/*
 * The point that went through is behind the sheet, while the axis around it may be in front, beyond a border. So the
 * point becomes a sample.
 */
void dpti_persistent_contacts_put_side(struct dpt_world *world, uint32_t segment_index, const struct body *body,
                                       uint32_t part, int side, const struct warm_start *warm_start)
{
    struct persistent_contacts *last_tick = contacts_last_tick(world);
    uint32_t i = 0;
    while (i < last_tick->count && !(last_tick->items[i].segment_index == segment_index && last_tick->items[i].side &&
                                     last_tick->items[i].contact.body == body->id && last_tick->items[i].part == part))
        i++;
    if (i == world->def.max_contacts) {
        world->contacts_overflowed |= i > 0;
        if (i > 0)
            world_note_max(&world->usage.contacts, i + 1);
        return;
    }
    struct persistent_contact *persistent = &last_tick->items[i];
    if (i == last_tick->count) {
        last_tick->count++;
        *persistent = (struct persistent_contact){ .segment_index = segment_index, .part = part, .side = side };
        persistent->contact.id = dpti_persistent_contacts_new_id(world);
        persistent->contact.body = body->id;
        persistent->contact.s0 = persistent->contact.s1 = warm_start->s;
    }
    dpti_persistent_contact_put_warm_start(persistent, warm_start);
}

void dpti_persistent_contacts_forget_sides(struct dpt_world *world, uint32_t segment_index)
{
    struct persistent_contacts *last_tick = contacts_last_tick(world);
    for (uint32_t i = 0; i < last_tick->count; i++)
        if (last_tick->items[i].segment_index == segment_index)
            last_tick->items[i].side = 0;
}

/* m: a tool that is deeper behind a sheet loses its side. */
static double side_limit(const struct contact_pair *contact_pair)
{
    double limit = contact_pair->body->side_limit;
    return limit > 0.0 ? limit : 0.25 * surface_diagonal(&contact_pair->body->surface);
}

int32_t dpti_sheet_side_to_keep(const struct contact_pair *contact_pair, const struct region *region, double gap)
{
    const struct surface *surface = &contact_pair->body->surface;
    const struct profile_sample *deepest = &contact_pair->profile->sample[region->deepest];
    if (!dpti_side_is_sheet(surface, region->part) || -gap > side_limit(contact_pair) ||
        dpti_side_is_border(surface, deepest->triangle, deepest->weight))
        return 0;
    int32_t kept_side = dpti_sides_get(&contact_pair->sides, region->part);
    if (kept_side || deepest->height == 0.0)
        return kept_side;
    const pair deepest_pair = { .weight = { deepest->weight[0], deepest->weight[1], deepest->weight[2] },
                                .gap = deepest->gap };
    return dpti_side_of_pair(surface, deepest->triangle, &deepest_pair);
}

void dpti_sheet_update_side(const struct contact_pair *contact_pair, struct persistent_contact *persistent)
{
    const struct surface *surface = &contact_pair->body->surface;
    const struct pair_search *nearest = &contact_pair->nearest;
    const double *weight = nearest->pair.weight;
    if (!persistent->side || nearest->pair.distance2 == 0.0 ||
        surface_part(surface, nearest->triangle) != persistent->part)
        return;
    int is_border = dpti_side_is_border(surface, nearest->triangle, weight);
    int is_in_front = persistent->side * dpti_side_of_pair(surface, nearest->triangle, &nearest->pair) > 0;
    if (is_border ? !dpti_profile_lowest_on(contact_pair->profile, persistent->part)
                  : persistent->is_in_front && !is_in_front)
        persistent->side = 0;
    else if (!is_border)
        persistent->is_in_front = (uint32_t)is_in_front;
}

int dpti_sheet_drop_sides(struct contact_pair *contact_pair, const struct region *regions, uint32_t count)
{
    struct sides *sides = &contact_pair->sides, kept_sides = { .count = 0 };
    double limit = side_limit(contact_pair) - contact_pair->radius;
    for (uint32_t k = 0; k < sides->count; k++) {
        int is_too_deep = 0;
        for (uint32_t i = 0; i < count; i++)
            is_too_deep |=
                regions[i].part == sides->part[k] && -contact_pair->profile->sample[regions[i].deepest].height > limit;
        if (!is_too_deep)
            dpti_sides_put(&kept_sides, sides->part[k], sides->side[k]);
    }
    int has_dropped = kept_sides.count < sides->count;
    *sides = kept_sides;
    return has_dropped;
}

int dpti_sheet_still_pushes(const struct contact_pair *contact_pair, uint32_t part)
{
    const struct distance_profile *profile = contact_pair->profile;
    const struct profile_sample *deepest = &profile->sample[profile->deepest];
    return dpti_sides_get(&contact_pair->sides, part) &&
           (deepest->height <= 0.0 || !dpti_side_is_border(profile->surface, deepest->triangle, deepest->weight));
}
