/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * From a nearest pair to contact: on which side of the surface the tool is, its gap, and where and in which direction a
 * force would push it. docs/algorithms/sign.md.
 */
#ifndef DPT_GAP_H
#define DPT_GAP_H

#include "base/penetration.h"
#include "contact/distance_profile.h"
#include "contact/segment_result.h"

/* What the profile of one axis and one body says. */
enum {
    /* the axis is outside and nothing is within the profile's reach */
    CONTACT_NONE,
    /* the profile is complete: its deepest sample has the least height */
    CONTACT_PROFILE,
    /* the axis goes through an open sheet whose side is not known, has too many crossings, or the work was spent */
    CONTACT_UNKNOWN
};

/*
 * Make the profile of a capsule's axis, with arguments as dpti_profile_make has them. `radius` is in m. Returns
 * CONTACT_...; *gap gets the signed distance of the capsule's surface, in m; with CONTACT_UNKNOWN it does not count.
 */
int dpti_contact_find(struct distance_profile *profile, const struct pair_search *nearest,
                      const struct warm_start *warm_starts, uint32_t warm_start_count, double radius, double *gap);

/* Why the contact of a profile is unknown: DPT_HIT_FLAG_... */
uint32_t dpti_contact_why_unknown(const struct distance_profile *profile);

/* The way out at a sample, unit, in the body's frame. `smooth`: 1 for smooth normals, as dpt_world_def has it. */
vec3 dpti_contact_normal(const struct distance_profile *profile, const struct profile_sample *sample, uint32_t smooth);

/* The penetration at the profile's deepest sample, in the world. `body` is the body's frame; `gap` in m. */
struct penetration dpti_contact_penetration(const struct distance_profile *profile, const struct frame *body,
                                            double gap, uint32_t smooth);

/*
 * Set contact and gap of a result that has its nearest pair already. This is for one axis and one body without history
 * and without a budget. Where the contact is unknown the result gets the reason alone.
 */
void dpti_contact_of(const struct surface *surface, const struct kernel *kernel, const struct axis *axis,
                     const struct pair_search *nearest, double radius, struct segment_result *result);

#endif
