/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The result of a segment, handed from stage to stage: its nearest pair with bounds, then its gap. The pair itself
 * stays in the body's frame, with the triangle's place. A dpt_hit is written once, at the end.
 */
#ifndef DPT_SEGMENT_RESULT_H
#define DPT_SEGMENT_RESULT_H

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

#endif
