/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/persistent_contacts.h"

/* A share of dpt_world_bytes: this tick's and the last one's. */
enum { BYTES_CONTACT = 1408 };
typedef char contact_fits[2 * sizeof(struct hold) <= BYTES_CONTACT ? 1 : -1];

uint64_t dpti_contacts_bytes(const dpt_world_def *def)
{
    return BYTES_CONTACT * (uint64_t)def->max_contacts;
}

char *dpti_contacts_place(struct dpt_world *world, char *at)
{
    for (int i = 0; i < 2; i++, at += BYTES_CONTACT / 2 * (size_t)world->def.max_contacts)
        world->holds[i].hold = (void *)at;
    return at;
}

void dpti_contacts_turn(struct dpt_world *world)
{
    world->holds_at = 1 - world->holds_at;
    holds_now(world)->count = 0;
    world->contacts_full = 0;
    world->contacts_wanted = 0;
}

void dpti_contacts_hide(struct dpt_world *world)
{
    struct holds *holds = holds_now(world);
    for (uint32_t i = 0; i < holds->count; i++)
        holds->hold[i].unseen = 1;
    world->contacts_full = 0;
}

void dpti_contacts_reset(struct dpt_world *world)
{
    world->holds[0].count = world->holds[1].count = 0;
    world->contact_id = 0;
    world->contacts_full = 0;
}

void dpti_contacts_forget(struct dpt_world *world, uint32_t first, uint32_t end, uint32_t body)
{
    struct holds *holds = holds_now(world);
    uint32_t kept = 0;
    for (uint32_t i = 0; i < holds->count; i++) {
        const struct hold *hold = &holds->hold[i];
        int of = hold->segment >= first && hold->segment < end &&
                 (body == DPT_NONE || handle_index(hold->contact.body) == body);
        if (!of)
            holds->hold[kept++] = *hold;
    }
    holds->count = kept;
}

void dpti_contacts_remove(struct dpt_world *world, uint32_t first, uint32_t end)
{
    struct holds *holds = holds_now(world);
    dpti_contacts_forget(world, first, end, DPT_NONE);
    for (uint32_t i = 0; i < holds->count; i++)
        if (holds->hold[i].segment >= end)
            holds->hold[i].segment -= end - first;
}

struct hold *dpti_contacts_put(struct dpt_world *world)
{
    struct holds *now = holds_now(world);
    world->contacts_wanted++;
    if (now->count == world->def.max_contacts) {
        world->contacts_full = 1;
        return NULL;
    }
    return &now->hold[now->count++];
}

uint32_t dpti_contacts_new_id(struct dpt_world *world)
{
    world->contact_id += world->contact_id == UINT32_MAX ? 2u : 1u;
    return world->contact_id;
}

void dpti_contacts_take_way(struct dpt_world *world, uint32_t index)
{
    const struct segment *segment = &world->segments[index];
    const struct holds *before = holds_before(world);
    int passed = segment->sweep.status != DPT_SWEEP_UNFINISHED &&
                 (segment->sweep.status == DPT_SWEEP_NONE || segment->passed);
    for (uint32_t i = 0; passed && i < before->count; i++)
        if (before->hold[i].segment == index)
            before->hold[i].front = 0;
}

void dpti_contacts_keep_one(struct dpt_world *world, const struct hold *before)
{
    struct hold *hold = dpti_contacts_put(world);
    if (!hold)
        return;
    *hold = *before;
    hold->unseen = 1;
}

void dpti_contacts_keep_body(struct dpt_world *world, uint32_t segment, const struct body *body)
{
    const struct holds *before = holds_before(world);
    for (uint32_t i = 0; i < before->count; i++)
        if (hold_is_of(&before->hold[i], segment, body))
            dpti_contacts_keep_one(world, &before->hold[i]);
}

void dpti_contacts_keep(struct dpt_world *world, uint32_t segment)
{
    dpti_contacts_take_way(world, segment);
    dpti_contacts_keep_body(world, segment, NULL);
}

void dpti_hold_put_seed(struct hold *hold, const struct seed *seed)
{
    uint32_t last = 0;
    while (last < hold->seed_count && hold->seed[last].s != seed->s)
        last++;
    hold->seed_count += last == hold->seed_count && last < HOLD_SEEDS;
    last = last < HOLD_SEEDS ? last : HOLD_SEEDS - 1;
    memmove(hold->seed + 1, hold->seed, last * sizeof *seed);
    hold->seed[0] = *seed;
}

/* What went through is behind, though all around it may be in front, beyond a border: so it is a sample. */
void dpti_contacts_meet(struct dpt_world *world, uint32_t segment, const struct body *body,
                        uint32_t part, int side, const struct seed *seed)
{
    struct holds *before = holds_before(world);
    uint32_t i = 0;
    while (i < before->count &&
           !(before->hold[i].segment == segment && before->hold[i].side &&
             before->hold[i].contact.body == body->id && before->hold[i].part == part))
        i++;
    if (i == world->def.max_contacts) {
        world->contacts_full |= i > 0;
        if (i > 0)
            world_note_max(&world->usage.contacts, i + 1);
        return;
    }
    struct hold *hold = &before->hold[i];
    if (i == before->count) {
        before->count++;
        *hold = (struct hold){ .segment = segment, .part = part, .side = side };
        hold->contact.id = dpti_contacts_new_id(world);
        hold->contact.body = body->id;
        hold->contact.s0 = hold->contact.s1 = seed->s;
    }
    dpti_hold_put_seed(hold, seed);
}

void dpti_contacts_forget_sides(struct dpt_world *world, uint32_t segment)
{
    struct holds *before = holds_before(world);
    for (uint32_t i = 0; i < before->count; i++)
        if (before->hold[i].segment == segment)
            before->hold[i].side = 0;
}
