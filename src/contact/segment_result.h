/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What is known of a segment, from stage to stage: its nearest pair with bounds, then its gap. The pair itself stays in
 * the body's frame, its triangle a place; a dpt_hit is written once, at the end.
 */
#ifndef DPT_SEGMENT_RESULT_H
#define DPT_SEGMENT_RESULT_H

#include "nearest/dynamic_point.h"

struct segment_result {
    vec3 p;   /* the nearest point of the axis, in the world */
    double s; /* where on the axis */
    double distance;
    double lower_bound, error_bound;
    double gap;       /* where it is known */
    uint32_t has_gap; /* 1: it is */
    uint32_t status;  /* DPT_STATUS_... */
    uint32_t contact; /* DPT_CONTACT_... */
    uint32_t work;    /* units (base/work.h) */
};

/* Of a nearest pair that is exact, within the axis' error bound: no contact yet, and no work. */
void dpti_segment_result_of_pair(const struct axis *axis, const pair *found,
                                 struct segment_result *result);

/* Its gap, known within `error`. */
void dpti_segment_result_set_gap(struct segment_result *result, double gap, double error);

/* DPT_CONTACT_... of a gap that is known within `error`. */
uint32_t dpti_contact_of_gap(double gap, double error);

/* Into a hit, all but its size and segment. The pair is with `surface`, whose body has this frame and id. */
void dpti_segment_result_write(const struct segment_result *result, const struct surface *surface,
                               const struct frame *body, uint32_t id,
                               const struct pair_search *nearest, dpt_hit *hit);

#endif
