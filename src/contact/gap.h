/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * From a nearest pair to contact: on which side the tool is, its gap, and where a force would push it.
 * docs/algorithms/sign.md.
 */
#ifndef DPT_GAP_H
#define DPT_GAP_H

#include "base/penetration.h"
#include "contact/distance_profile.h"
#include "contact/segment_result.h"

/* What a profile tells of one body. */
enum {
    CONTACT_NONE,    /* the axis is outside and nothing is within the profile's reach */
    CONTACT_PROFILE, /* its least height is the profile's deepest sample */
    CONTACT_UNKNOWN /* it goes through an open sheet of which no side is kept, or more often than can be told */
};

/* The gap of a capsule of this radius, in *gap; the rest as dpti_profile_make. */
int dpti_contact_find(struct distance_profile *profile, const struct pair_search *nearest,
                      const struct warm_start *warm_starts, uint32_t warm_start_count,
                      double radius, double *gap);

/* The way out at a sample, in the body's frame; `smooth` as dpt_world_def has it. */
vec3 dpti_contact_normal(const struct distance_profile *profile,
                         const struct profile_sample *sample, uint32_t smooth);

/* The push at the profile's deepest sample, in the world. */
struct penetration dpti_contact_penetration(const struct distance_profile *profile,
                                            const struct frame *body, double gap, uint32_t smooth);

/* Contact and gap of one axis and one body without a past, into a result that has the pair. */
void dpti_contact_of(const struct surface *surface, const struct kernel *kernel,
                     const struct axis *axis, const struct pair_search *nearest, double radius,
                     struct segment_result *result);

#endif
