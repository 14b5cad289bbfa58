/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Contacts that persist from tick to tick: docs/algorithms/contacts.md. They also hold the side from which the tool
 * came to an open sheet, until it is dropped (docs/algorithms/sign.md). Sides: +1 in front of the sheet's triangles, -1
 * behind, 0 not known.
 */
#ifndef DPT_PERSISTENT_CONTACTS_H
#define DPT_PERSISTENT_CONTACTS_H

#include "contact/contact_integrals.h"
#include "track/world_state.h"

/* Its share of dpt_world_bytes. */
uint64_t dpti_persistent_contacts_bytes(const dpt_world_def *def);

/* Place its memory at `at`; returns where it ends. */
char *dpti_persistent_contacts_place(struct dpt_world *world, char *at);

/* The world's list for this tick. */
static inline struct persistent_contacts *contacts_this_tick(struct dpt_world *world)
{
    return &world->contacts[world->contacts_index];
}

/* The world's list of the last tick. */
static inline struct persistent_contacts *contacts_last_tick(struct dpt_world *world)
{
    return &world->contacts[1 - world->contacts_index];
}

/* Whether a contact is of this segment and this body, or with NULL any body. */
static inline int persistent_contact_is_of(const struct persistent_contact *persistent, uint32_t segment_index,
                                           const struct body *body)
{
    return persistent->segment_index == segment_index && (!body || persistent->contact.body == body->id);
}

/* 1 if a contact is the same in two ticks, except for `is_in_front`, which a motion may have cleared. */
static inline int persistent_contact_is_same(const struct persistent_contact *a, const struct persistent_contact *b)
{
    return !memcmp(a, b, offsetof(struct persistent_contact, is_in_front)) &&
           !memcmp(a->warm_starts, b->warm_starts, sizeof a->warm_starts);
}

/* Start a tick: the current contacts become last tick's, and this tick's list is empty. */
void dpti_persistent_contacts_begin_tick(struct dpt_world *world);

/* End a tick that has no answer: mark its contacts as unseen, so that the next tick can continue them. */
void dpti_persistent_contacts_set_unseen(struct dpt_world *world);

/* Forget all contacts, and begin their ids anew. */
void dpti_persistent_contacts_reset(struct dpt_world *world);

/*
 * Call it after the segment's sweep. If the axis may have gone through a surface in this motion, no contact of the
 * segment is known to be in front of its sheet any longer. An unfinished sweep changes nothing yet.
 */
void dpti_persistent_contacts_note_motion(struct dpt_world *world, uint32_t segment_index);

/* For a segment whose contact is unknown in this tick: note its motion, and carry over its contacts as unseen. */
void dpti_persistent_contacts_carry_over(struct dpt_world *world, uint32_t segment_index);

/* Carry over, as unseen, a segment's contacts with a body, or with NULL all of them. */
void dpti_persistent_contacts_carry_over_body(struct dpt_world *world, uint32_t segment_index, const struct body *body);

/* Carry over one contact of the last tick, as unseen. */
void dpti_persistent_contacts_carry_over_one(struct dpt_world *world, const struct persistent_contact *previous);

/* Add a contact to this tick's list, to be filled in; NULL if the list is full. */
struct persistent_contact *dpti_persistent_contacts_add(struct dpt_world *world);

/* The id for a new contact; never 0. */
uint32_t dpti_persistent_contacts_new_id(struct dpt_world *world);

/* Put a warm start before the others. It replaces one at the same s; if there is no room, the last one is dropped. */
void dpti_persistent_contact_put_warm_start(struct persistent_contact *persistent, const struct warm_start *warm_start);

/*
 * The axis went through the sheet `part` of `body`, coming from `side`, at `warm_start`. Store the side with last
 * tick's contacts, unless one of them has a side of that part already. Call it before dpti_contacts_find or
 * dpti_persistent_contacts_carry_over.
 */
void dpti_persistent_contacts_put_side(struct dpt_world *world, uint32_t segment_index, const struct body *body,
                                       uint32_t part, int side, const struct warm_start *warm_start);

/* Forget the sides of a segment's contacts of the last tick, as a teleport does. */
void dpti_persistent_contacts_forget_sides(struct dpt_world *world, uint32_t segment_index);

/*
 * Forget the contacts and depths of the segments from `first` up to, not including, `end` with the body in `slot`, or
 * with DPT_NONE all.
 */
void dpti_persistent_contacts_forget(struct dpt_world *world, uint32_t first, uint32_t end, uint32_t slot);

/* The same for all bodies, and later segments move up: their contacts get their new indices. */
void dpti_persistent_contacts_remove(struct dpt_world *world, uint32_t first, uint32_t end);

/* The side that the contact of `region` keeps for the next tick, or 0. gap: m, at its deepest sample. */
int32_t dpti_sheet_side_to_keep(const struct contact_pair *contact_pair, const struct region *region, double gap);

/*
 * Drop the pair's sides of sheets behind which the tool is deeper than the side limit. Returns 1 if any was dropped.
 */
int dpti_sheet_drop_sides(struct contact_pair *contact_pair, const struct region *regions, uint32_t count);

/*
 * For the sheet `part` that pushed the tool in the last tick: 1 if it still does, or if motion ended the push. 0 if
 * the push ends by a decision: the side is dropped, or the axis has slid off the sheet at its border.
 */
int dpti_sheet_still_pushes(const struct contact_pair *contact_pair, uint32_t part);

/*
 * For a contact that the budget left undecided: update its side by the nearest pair of axis and body.
 *
 * Off the border, the pair tells on which side the axis is now. If the axis was in front, crossed nothing and is
 * behind now, it has gone round the border, and the side is dropped. On the border the pair tells no side; then the
 * side is dropped unless a sample of the part is behind, because the axis may be going round.
 */
void dpti_sheet_update_side(const struct contact_pair *contact_pair, struct persistent_contact *persistent);

#endif
