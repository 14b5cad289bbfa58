/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The penetration of an open sheet near its border. A pushed point beyond the border counts as in front of the sheet.
 * So its depth must fall to zero towards the border. docs/algorithms/penalty.md.
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
 * Reduce the depth of an axis behind a sheet whose side is known, if the sheet's border is near.
 *
 *   body    the body's id
 *   view    last tick's, then this tick's
 *   depth   in: that of the profile's deepest sample, m. out: the largest reduced depth
 *   pushed  out: the sample with that depth
 *
 * Returns 1 if the border is so near that the sample was searched for. Otherwise depth and sample are unchanged. The
 * profile stays the same. The work is not part of a budget.
 */
int dpti_sheet_border_reduce(struct distance_profile *profile, uint32_t body, double radius, struct border_view *view,
                             double *depth, struct profile_sample *pushed);

#endif
