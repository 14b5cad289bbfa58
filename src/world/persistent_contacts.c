/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/persistent_contacts.h"

/* A share of dpt_world_bytes: this tick's and the last one's. */
enum { BYTES_CONTACT = 1408 };
typedef char contact_fits[2 * sizeof(struct persistent_contact) <= BYTES_CONTACT ? 1 : -1];

uint64_t dpti_contacts_bytes(const dpt_world_def *def)
{
    return BYTES_CONTACT * (uint64_t)def->max_contacts;
}

char *dpti_contacts_place(struct dpt_world *world, char *at)
{
    for (int i = 0; i < 2; i++, at += BYTES_CONTACT / 2 * (size_t)world->def.max_contacts)
        world->contacts[i].at = (void *)at;
    return at;
}

void dpti_contacts_begin_tick(struct dpt_world *world)
{
    world->contacts_at = 1 - world->contacts_at;
    contacts_now(world)->count = 0;
    world->contacts_full = 0;
    world->contacts_wanted = 0;
}

void dpti_contacts_hide(struct dpt_world *world)
{
    struct persistent_contacts *holds = contacts_now(world);
    for (uint32_t i = 0; i < holds->count; i++)
        holds->at[i].unseen = 1;
    world->contacts_full = 0;
}

void dpti_contacts_reset(struct dpt_world *world)
{
    world->contacts[0].count = world->contacts[1].count = 0;
    world->contact_id = 0;
    world->contacts_full = 0;
}

void dpti_contacts_forget(struct dpt_world *world, uint32_t first, uint32_t end, uint32_t body)
{
    struct persistent_contacts *holds = contacts_now(world);
    uint32_t kept = 0;
    for (uint32_t i = 0; i < holds->count; i++) {
        const struct persistent_contact *persistent = &holds->at[i];
        int of = persistent->segment >= first && persistent->segment < end &&
                 (body == DPT_NONE || handle_index(persistent->contact.body) == body);
        if (!of)
            holds->at[kept++] = *persistent;
    }
    holds->count = kept;
}

void dpti_contacts_remove(struct dpt_world *world, uint32_t first, uint32_t end)
{
    struct persistent_contacts *holds = contacts_now(world);
    dpti_contacts_forget(world, first, end, DPT_NONE);
    for (uint32_t i = 0; i < holds->count; i++)
        if (holds->at[i].segment >= end)
            holds->at[i].segment -= end - first;
}

struct persistent_contact *dpti_contacts_put(struct dpt_world *world)
{
    struct persistent_contacts *now = contacts_now(world);
    world->contacts_wanted++;
    if (now->count == world->def.max_contacts) {
        world->contacts_full = 1;
        return NULL;
    }
    return &now->at[now->count++];
}

uint32_t dpti_contacts_new_id(struct dpt_world *world)
{
    world->contact_id += world->contact_id == UINT32_MAX ? 2u : 1u;
    return world->contact_id;
}

void dpti_contacts_note_motion(struct dpt_world *world, uint32_t index)
{
    const struct segment *segment = &world->segments[index];
    const struct persistent_contacts *before = contacts_before(world);
    int passed = segment->sweep.status != DPT_SWEEP_UNFINISHED &&
                 (segment->sweep.status == DPT_SWEEP_NONE || segment->passed);
    for (uint32_t i = 0; passed && i < before->count; i++)
        if (before->at[i].segment == index)
            before->at[i].front = 0;
}

void dpti_contacts_carry_over_one(struct dpt_world *world, const struct persistent_contact *before)
{
    struct persistent_contact *persistent = dpti_contacts_put(world);
    if (!persistent)
        return;
    *persistent = *before;
    persistent->unseen = 1;
}

void dpti_contacts_carry_over_body(struct dpt_world *world, uint32_t segment,
                                   const struct body *body)
{
    const struct persistent_contacts *before = contacts_before(world);
    for (uint32_t i = 0; i < before->count; i++)
        if (persistent_contact_is_of(&before->at[i], segment, body))
            dpti_contacts_carry_over_one(world, &before->at[i]);
}

void dpti_contacts_carry_over(struct dpt_world *world, uint32_t segment)
{
    dpti_contacts_note_motion(world, segment);
    dpti_contacts_carry_over_body(world, segment, NULL);
}

void dpti_persistent_contact_put_warm_start(struct persistent_contact *persistent,
                                            const struct warm_start *warm_start)
{
    uint32_t last = 0;
    while (last < persistent->warm_start_count && persistent->warm_start[last].s != warm_start->s)
        last++;
    persistent->warm_start_count += last == persistent->warm_start_count && last < WARM_STARTS_MAX;
    last = last < WARM_STARTS_MAX ? last : WARM_STARTS_MAX - 1;
    memmove(persistent->warm_start + 1, persistent->warm_start, last * sizeof *warm_start);
    persistent->warm_start[0] = *warm_start;
}

/* What went through is behind, though all around it may be in front, beyond a border: so it is a sample. */
void dpti_contacts_put_side(struct dpt_world *world, uint32_t segment, const struct body *body,
                            uint32_t part, int side, const struct warm_start *warm_start)
{
    struct persistent_contacts *before = contacts_before(world);
    uint32_t i = 0;
    while (i < before->count &&
           !(before->at[i].segment == segment && before->at[i].side &&
             before->at[i].contact.body == body->id && before->at[i].part == part))
        i++;
    if (i == world->def.max_contacts) {
        world->contacts_full |= i > 0;
        if (i > 0)
            world_note_max(&world->usage.contacts, i + 1);
        return;
    }
    struct persistent_contact *persistent = &before->at[i];
    if (i == before->count) {
        before->count++;
        *persistent = (struct persistent_contact){ .segment = segment, .part = part, .side = side };
        persistent->contact.id = dpti_contacts_new_id(world);
        persistent->contact.body = body->id;
        persistent->contact.s0 = persistent->contact.s1 = warm_start->s;
    }
    dpti_persistent_contact_put_warm_start(persistent, warm_start);
}

void dpti_contacts_forget_sides(struct dpt_world *world, uint32_t segment)
{
    struct persistent_contacts *before = contacts_before(world);
    for (uint32_t i = 0; i < before->count; i++)
        if (before->at[i].segment == segment)
            before->at[i].side = 0;
}
