/* SPDX-License-Identifier: BSD-3-Clause */
/* Contact of one segment with all bodies that are near. */
#ifndef DPT_CONTACTS_H
#define DPT_CONTACTS_H

#include "world/body_search.h"

/*
 * Contact and gap of a segment whose nearest pair `best` is exact, into `result`, and the push at its deepest
 * point; its regions into the world.
 */
void dpti_contacts_find(struct dpt_world *world, uint32_t segment_index,
                        const struct body_answer *best, struct segment_result *result,
                        struct penetration *penetration);

#endif
