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
 * Let w(s) = max(0, reach - inset - height(s)) be how far the surface is beyond the onset, in m, and n(s) the way out, a
 * unit vector in the body's frame. Each integral is over the axis' length in m, from `from` to `to`; its unit is m^2.
 */
struct region {
    double from, to;      /* s, 0..1 */
    double end_within[2]; /* reach - height there, m */
    vec3 end_normal[2];   /* n there */
    double within;        /* of reach - height, whatever the onset */
    double overlap;       /* of w */
    double square;        /* of w^2, m^3 */
    double moment;        /* of s w */
    vec3 thrust;          /* of w n, in the body's frame */
    vec3 thrust_moment;   /* of s w n, in the body's frame */
    /* The same of depth(s) = max(0, reach - margin - height(s)), how deep the tool's surface is inside. */
    double depth_square; /* of its square, m^3 */
    vec3 depth_thrust;   /* of depth n */
    vec3 depth_moment;   /* of s depth n */
    uint32_t deepest;    /* index of the profile's sample with the least height */
    uint32_t part;       /* of the mesh */
};

/*
 * Add samples to a profile until its integrals are accurate enough, and compute its regions. Returns their number, at
 * most REGION_MAX; further ones are left out. If work or room for samples ends before, profile->is_coarse is 1. The
 * regions then come from fewer samples. Each sample is true, but a region's deepest sample may not be its deepest
 * point.
 */
uint32_t dpti_contact_regions(struct distance_profile *profile, struct region regions[REGION_MAX]);

/*
 * Choose the samples of a region from which the next tick starts: those without which its integrals would change
 * noticeably. Writes at most `max_count`, in order of s. Returns how many.
 */
uint32_t dpti_contact_region_warm_starts(const struct distance_profile *profile,
                                         const struct region *region,
                                         struct warm_start *warm_starts, uint32_t max_count);

#endif
