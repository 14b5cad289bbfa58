/* SPDX-License-Identifier: BSD-3-Clause */
/* Contact of one segment with all near bodies. */
#ifndef DPT_CONTACTS_H
#define DPT_CONTACTS_H

#include "track/body_search.h"

/*
 * Find the contacts of a segment with all near bodies. `best` is its nearest pair over all bodies, and must be exact.
 * Writes contact and gap into `result`, the penetration at the deepest point (world) into `penetration`, what the
 * force uses into the segment, and the contacts into the world's list for this tick. Where the contact with any body
 * is unknown, `result`, `penetration` and the segment's force stay as they are.
 */
void dpti_contacts_find(struct dpt_world *world, uint32_t segment_index, const struct body_answer *best,
                        struct segment_result *result, struct penetration *penetration);

/* Set no contact for a segment that is outside of everything and beyond the margin. Its gap is not known. */
void dpti_contacts_set_none(struct segment *segment);

#endif
