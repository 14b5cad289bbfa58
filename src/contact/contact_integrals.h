/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Regions: the stretches of an axis on which the tool's surface is within the margin or inside, and the integrals over
 * them. A region becomes a dpt_contact. docs/algorithms/contacts.md.
 */
#ifndef DPT_CONTACT_INTEGRALS_H
#define DPT_CONTACT_INTEGRALS_H

#include "contact/distance_profile.h"

/* Regions of one profile. */
enum { REGION_MAX = 16 };

/*
 * Over a stretch of the axis, per m of its length, with a depth w(s) >= 0 in m, and n(s) the exit direction, a unit
 * vector in the body's frame.
 */
struct region_integrals {
    double overlap;     /* of w, m^2 */
    double moment;      /* of s w, m^2 */
    double square;      /* of w^2, m^3 */
    vec3 thrust;        /* of w n, m^2 */
    vec3 thrust_moment; /* of s w n, m^2 */
};

struct region {
    double from, to;                      /* s, 0..1 */
    double end_within[2];                 /* reach - height there, m */
    vec3 end_normal[2];                   /* n there */
    double within;                        /* integral of reach - height, m^2 */
    struct region_integrals beyond_onset; /* w = max(0, reach - inset - height) */
    struct region_integrals depth;        /* w = max(0, reach - margin - height): inside the tool's surface */
    uint32_t deepest;                     /* index of the profile's sample with the least height */
    uint32_t part;                        /* of the mesh */
};

/*
 * Add samples to a profile until its integrals are accurate enough, and compute its regions. Returns their number, at
 * most REGION_MAX; further ones are left out. If work or room runs out first, profile->is_coarse is 1: the regions come
 * from fewer samples. Each sample is correct, but a region's deepest sample may not be its deepest point.
 */
uint32_t dpti_contact_regions(struct distance_profile *profile, struct region regions[REGION_MAX]);

/*
 * Choose the samples of a region from which the next tick starts: those without which its integrals would change
 * noticeably. Writes at most `max_count`, in order of s. Returns how many.
 */
uint32_t dpti_contact_region_warm_starts(const struct distance_profile *profile, const struct region *region,
                                         struct warm_start *warm_starts, uint32_t max_count);

#endif
