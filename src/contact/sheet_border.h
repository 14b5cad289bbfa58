/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The push behind an open sheet, near its border: there the way back through the sheet ends at once, and the push
 * must have come to nothing by then. docs/algorithms/penalty.md.
 */
#ifndef DPT_SHEET_BORDER_H
#define DPT_SHEET_BORDER_H

#include "contact/gap.h"

/* What was seen of a sheet's border: none is within `clear` of a point, in the body's frame. */
struct border_view {
    vec3 centre;
    double clear_radius; /* 0: nothing was seen */
    uint32_t body;       /* its id */
    uint32_t part;       /* of its mesh */
    uint32_t has_border; /* some of it is just there */
    uint32_t reserved;
};

/*
 * A push that was made at the profile's deepest sample, behind a sheet whose side is kept. Away from its border it
 * stays as it is, bit for bit. `view` is of the last tick's, and of this one's then. Samples are taken; the profile
 * stays as it was. 1 where a border was so near that the point was looked for: then `found` is where it is.
 */
int dpti_sheet_border_reduce(struct distance_profile *profile, const struct frame *body,
                             uint32_t id, double radius, uint32_t smooth, struct border_view *view,
                             struct penetration *penetration, struct warm_start *found);

#endif
