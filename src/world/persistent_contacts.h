/* SPDX-License-Identifier: BSD-3-Clause */
/* Regions of contact that live from tick to tick: docs/algorithms/contacts.md. */
#ifndef DPT_PERSISTENT_CONTACTS_H
#define DPT_PERSISTENT_CONTACTS_H

#include "world/world_state.h"

/* Its share of dpt_world_bytes. */
uint64_t dpti_persistent_contacts_bytes(const dpt_world_def *def);

/* Place its memory at `at`; returns where it ends. */
char *dpti_persistent_contacts_place(struct dpt_world *world, char *at);

static inline struct persistent_contacts *contacts_this_tick(struct dpt_world *world)
{
    return &world->contacts[world->contacts_index];
}

static inline struct persistent_contacts *contacts_last_tick(struct dpt_world *world)
{
    return &world->contacts[1 - world->contacts_index];
}

static inline int persistent_contact_is_of(const struct persistent_contact *persistent,
                                           uint32_t segment_index, const struct body *body)
{
    return persistent->segment_index == segment_index &&
           (!body || persistent->contact.body == body->id);
}

/* A tick begins: what was now is before. */
void dpti_persistent_contacts_begin_tick(struct dpt_world *world);

/* A tick without an answer: none is seen. The next one takes them up again. */
void dpti_persistent_contacts_set_unseen(struct dpt_world *world);

/* All of them, and the numbers that they were given. */
void dpti_persistent_contacts_reset(struct dpt_world *world);

/*
 * On this tick's way the axis may have gone through something; then nobody knows that it is in front. A way that is
 * not finished tells in a later tick.
 */
void dpti_persistent_contacts_note_motion(struct dpt_world *world, uint32_t segment_index);

/* A segment of which nothing is known this tick: its regions live on, unseen. */
void dpti_persistent_contacts_carry_over(struct dpt_world *world, uint32_t segment_index);

/* `body`, or with NULL all of them: nothing is known of them in this tick. */
void dpti_persistent_contacts_carry_over_body(struct dpt_world *world, uint32_t segment_index,
                                              const struct body *body);

/* Keep one of them, unseen. */
void dpti_persistent_contacts_carry_over_one(struct dpt_world *world,
                                             const struct persistent_contact *previous);

/* A new one, not yet filled in; NULL where there is no room. */
struct persistent_contact *dpti_persistent_contacts_add(struct dpt_world *world);

/* A number for a new one. */
uint32_t dpti_persistent_contacts_new_id(struct dpt_world *world);

/* Before the others; of two at one place the new one stays, and where there is no room the last one goes. */
void dpti_persistent_contact_put_warm_start(struct persistent_contact *persistent,
                                            const struct warm_start *warm_start);

/*
 * The motion met a sheet from this side: it is kept where none is of that part. Before dpti_contacts_find or
 * dpti_persistent_contacts_carry_over.
 */
void dpti_persistent_contacts_put_side(struct dpt_world *world, uint32_t segment_index,
                                       const struct body *body, uint32_t part, int side,
                                       const struct warm_start *warm_start);

/* As by a teleport: the sides of a segment's regions of the last tick. */
void dpti_persistent_contacts_forget_sides(struct dpt_world *world, uint32_t segment_index);

/* Forget those of the segments from `first` to before `end`, and of a body or, with DPT_NONE, of all. */
void dpti_persistent_contacts_forget(struct dpt_world *world, uint32_t first, uint32_t end,
                                     uint32_t slot);

/* The same, and the segments behind them move up. */
void dpti_persistent_contacts_remove(struct dpt_world *world, uint32_t first, uint32_t end);

#endif
