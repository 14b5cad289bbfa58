/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * From which side a tool came to an open sheet: what a region keeps of it for the next tick, and where it is dropped.
 * docs/algorithms/sign.md.
 */
#ifndef DPT_SHEET_SIDES_H
#define DPT_SHEET_SIDES_H

#include "contact/contact_integrals.h"
#include "world/persistent_contacts.h"

/* The side of an open sheet that a region keeps for the next tick, or 0. */
int32_t dpti_sheet_side_to_keep(const struct contact_pair *contact_pair,
                                const struct region *region, double gap);

/* Sides of sheets that it is too deep behind are dropped; 1 if there was one. */
int dpti_sheet_drop_sides(struct contact_pair *contact_pair, const struct region *regions,
                          uint32_t count);

/*
 * The tool was pushed back through this sheet in the last tick: is it still, or has it come away from it? Not where
 * the side is dropped, nor where the axis has come off at a border.
 */
int dpti_sheet_still_pushes(const struct contact_pair *contact_pair, uint32_t part);

/*
 * Of a sheet whose contact the budget left undecided: what the nearest pair tells of the axis' side. At a border it
 * tells none, and then, unless there is a point behind, the axis may go round it. One that was in front, and went
 * through nothing, has gone round it when it is behind.
 */
void dpti_sheet_update_side(const struct contact_pair *contact_pair,
                            struct persistent_contact *persistent);

#endif
