/* SPDX-License-Identifier: BSD-3-Clause */
#include "contact/segment_result.h"

void dpti_segment_result_of_pair(const struct axis *axis, const pair *found, struct segment_result *result)
{
    const double distance = sqrt(found->distance2);
    *result = (struct segment_result){
        .p = along(axis->a, found->s, sub(axis->b, axis->a)),
        .s = found->s,
        .distance = distance,
        .lower_bound = max_of(0.0, distance - axis->error),
        .error_bound = axis->error,
        .status = DPT_STATUS_EXACT,
        .contact = DPT_CONTACT_UNKNOWN,
    };
}

uint32_t dpti_contact_of_gap(double gap, double error)
{
    if (fabs(gap) <= error)
        return DPT_CONTACT_TOUCHING;
    return gap > 0.0 ? DPT_CONTACT_SEPARATED : DPT_CONTACT_PENETRATING;
}

void dpti_segment_result_set_gap(struct segment_result *result, double gap, double error)
{
    result->has_gap = 1;
    result->gap = gap;
    result->contact = dpti_contact_of_gap(gap, error);
}

void dpti_segment_result_write(const struct segment_result *result, const struct surface *surface,
                               const struct frame *body, uint32_t id, const struct pair_search *nearest, dpt_hit *hit)
{
    hit->status = result->status;
    hit->contact = result->contact;
    hit->flags = (nearest->pair.distance2 == 0.0 ? DPT_HIT_FLAG_CROSSING : 0u) |
                 (result->has_gap ? DPT_HIT_FLAG_GAP : 0u) | result->unknown;
    hit->body = id;
    hit->triangle = surface->sources[nearest->triangle];
    hit->work = result->work;
    hit->distance = result->distance;
    hit->s = result->s;
    vec3_store(result->p, hit->p);
    vec3_store(sub(result->p, frame_turn(body, nearest->pair.gap)), hit->q);
    hit->error_bound = result->error_bound;
    hit->lower_bound = result->lower_bound;
    hit->gap = result->has_gap ? result->gap : 0.0;
    hit->depth = hit->gap < 0.0 ? -hit->gap : 0.0;
}
