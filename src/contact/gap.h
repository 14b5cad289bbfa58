/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The result of a segment, handed from stage to stage: its nearest pair with bounds, then its gap. The pair itself
 * stays in the body's frame, with the triangle's place. A dpt_hit is written once, at the end.
 */
#ifndef DPT_GAP_H
#define DPT_GAP_H

#include "base/penetration.h"
#include "contact/distance_profile.h"
#include "nearest/dynamic_point.h"

/* Lengths in m. */
struct segment_result {
    vec3 p;   /* the nearest point of the axis, in the world */
    double s; /* where on the axis, 0..1 */
    double distance;
    double lower_bound, error_bound;
    double gap;       /* if has_gap */
    uint32_t has_gap; /* 1: the gap is known */
    uint32_t status;  /* DPT_STATUS_... */
    uint32_t contact; /* DPT_CONTACT_... */
    uint32_t unknown; /* DPT_HIT_FLAG_...: why contact is unknown */
    uint32_t work;    /* units (base/work.h) */
};

/* Start a result from an exact nearest pair, within the axis' error bound. Contact is unknown, and work is 0. */
void dpti_segment_result_of_pair(const struct axis *axis, const pair *found, struct segment_result *result);

/* Set the gap, in m, known within `error`, and the contact that follows from it. */
void dpti_segment_result_set_gap(struct segment_result *result, double gap, double error);

/* DPT_CONTACT_... of a gap that is known within `error`. */
uint32_t dpti_contact_of_gap(double gap, double error);

/*
 * Write a result into a hit, all but its size and segment. `nearest` is the pair with `surface`; `body` is the body's
 * frame and `id` its id. The hit gets the triangle's source number.
 */
void dpti_segment_result_write(const struct segment_result *result, const struct surface *surface,
                               const struct frame *body, uint32_t id, const struct pair_search *nearest, dpt_hit *hit);

/*
 * From a nearest pair to contact: on which side of the surface the tool is, its gap, and where and in which direction a
 * force would push it. docs/algorithms/sign.md.
 */

/* What the profile of one axis and one body tells about contact. */
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
 * CONTACT_...; *gap gets the signed distance of the capsule's surface, in m; with CONTACT_UNKNOWN it is meaningless.
 */
int dpti_contact_find(struct distance_profile *profile, const struct pair_search *nearest,
                      const struct warm_start *warm_starts, uint32_t warm_start_count, double radius, double *gap);

/* Why the contact of a profile is unknown: DPT_HIT_FLAG_... */
uint32_t dpti_contact_why_unknown(const struct distance_profile *profile);

/* The exit direction at a sample, unit, in the body's frame. `smooth`: 1 for smooth normals, as in dpt_world_def. */
vec3 dpti_contact_normal(const struct distance_profile *profile, const struct profile_sample *sample, uint32_t smooth);

/* The penetration at a sample, in the world. `body` is the body's frame; `depth` in m. */
struct penetration dpti_contact_penetration(const struct distance_profile *profile, const struct frame *body,
                                            const struct profile_sample *sample, double depth, uint32_t smooth);

/*
 * Set contact and gap of a result that has its nearest pair already. This is for one axis and one body without history
 * and without a budget. Where the contact is unknown the result gets the reason alone.
 */
void dpti_contact_of(const struct surface *surface, const struct kernel *kernel, const struct axis *axis,
                     const struct pair_search *nearest, double radius, struct segment_result *result);

/* ---- the paper's gap, kept as a baseline: docs/algorithms/paper.md ---- */

/*
 * The paper's signed gap of one part of a segment, in m. The sign is that of the triangle's own plane. A part that
 * crosses the triangle is as deep as its lower end is below that plane. *penetration gets the penetration in the world;
 * `body` is the body's frame.
 */
double dpti_contact_paper(const struct surface *surface, const struct frame *body, const struct axis *part,
                          const struct pair_search *nearest, double radius, struct penetration *penetration);

#endif
