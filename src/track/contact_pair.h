/* SPDX-License-Identifier: BSD-3-Clause */
/* Contact of one segment and one body: gap, contacts and sides of sheets. */
#ifndef DPT_CONTACT_PAIR_H
#define DPT_CONTACT_PAIR_H

#include "track/world_state.h"

/*
 * Find the contact of a pair whose `world`, `body`, `segment_index`, `radius`, `axis`, `nearest` and `profile` are
 * set. Puts its contacts into the world's list for this tick, or carries over last tick's where the contact is
 * unknown. Returns CONTACT_...; with CONTACT_PROFILE, `*gap` is the segment's gap over this body, in m.
 */
int dpti_contact_pair_find(struct contact_pair *contact_pair, double *gap);

#endif
