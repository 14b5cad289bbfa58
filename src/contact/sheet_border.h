/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The penetration of an open sheet near its border. Beyond the border the point that is pushed counts as in front of
 * the sheet, so its depth must have come to zero there. docs/algorithms/penalty.md.
 */
#ifndef DPT_SHEET_BORDER_H
#define DPT_SHEET_BORDER_H

#include "contact/gap.h"

/* What the last search for a sheet's border found: no border within clear_radius of `centre`. */
struct border_view {
    vec3 centre;         /* in the body's frame */
    double clear_radius; /* m; 0: there was no search */
    uint32_t body;       /* its id */
    uint32_t part;       /* of its mesh */
    uint32_t has_border; /* 1: the border is at clear_radius */
    uint32_t reserved;
};

/*
 * Reduce the penetration at the profile's deepest sample, behind a sheet whose side is known, if the sheet's border is
 * near. Otherwise it stays the same, bit for bit.
 *
 *   body         the body's frame; `id` its id
 *   view         last tick's, then this tick's
 *   penetration  in the world; gets the point of the axis with the largest reduced depth
 *   found        gets that point, for the next tick to start from; only if 1 is returned
 *
 * Returns 1 where a border is so near that the point was searched for. The profile itself stays the same. Its work is
 * not part of a budget.
 */
int dpti_sheet_border_reduce(struct distance_profile *profile, const struct frame *body, uint32_t id, double radius,
                             uint32_t smooth, struct border_view *view, struct penetration *penetration,
                             struct warm_start *found);

#endif
