/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The side from which a tool came to an open sheet: what a contact keeps for the next tick, and when it is dropped.
 * docs/algorithms/sign.md. Sides: +1 in front of the sheet's triangles, -1 behind, 0 not known.
 */
#ifndef DPT_SHEET_SIDES_H
#define DPT_SHEET_SIDES_H

#include "contact/contact_integrals.h"
#include "track/persistent_contacts.h"

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
