/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Regions: the pieces of a profile where the tool's surface is within the margin or inside, and the integrals over
 * them. docs/algorithms/contacts.md.
 */
#ifndef DPT_CONTACT_INTEGRALS_H
#define DPT_CONTACT_INTEGRALS_H

#include "contact/distance_profile.h"

enum { REGION_MAX = 16 }; /* of one profile */

/*
 * Lengths along the axis are in m. With w(s) = reach - height(s), how far the surface is within reach, and n(s) the
 * way out, all integrals are over the axis' length from `from` to `to`.
 */
struct region {
    double from, to;    /* s */
    double overlap;     /* of w */
    double moment;      /* of s w */
    vec3 thrust;        /* of w n */
    vec3 thrust_moment; /* of s w n */
    uint32_t deepest;   /* sample with the least height */
    uint32_t part;      /* of the mesh */
};

/*
 * Refine the profile for its integrals, and take them. Returns how many regions there are, at most REGION_MAX. Where
 * that cuts the profile, they are of the samples that there are, all true, and what is deepest in a region is not proven.
 */
uint32_t dpti_contact_regions(struct distance_profile *profile, struct region regions[REGION_MAX]);

/* The samples from which a later tick should begin: at most `most` of a region's, in order. Returns how many. */
uint32_t dpti_contact_region_warm_starts(const struct distance_profile *profile,
                                         const struct region *region,
                                         struct warm_start *warm_starts, uint32_t max_count);

#endif
