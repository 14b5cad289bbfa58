/* SPDX-License-Identifier: BSD-3-Clause */
#include "track/far_segment.h"

void dpti_far_forget(struct segment *segment)
{
    segment->proven.distance = 0.0;
}

void dpti_far_forget_all(struct dpt_world *world)
{
    for (uint32_t s = 0; s < world->segment_count; s++)
        dpti_far_forget(&world->segments[s]);
}

double dpti_far_bound(const struct dpt_world *world, struct segment *segment, vec3 a, vec3 b)
{
    struct proven_distance *proven = &segment->proven;
    double moved = max_of(length(sub(a, proven->a)), length(sub(b, proven->b)));
    if (proven->tick != world->ticks)
        moved += world_body_motion(world);
    proven->a = a;
    proven->b = b;
    proven->tick = (uint32_t)world->ticks;
    if (moved > 0.0)
        proven->distance = max_of(0.0, proven->distance - (moved + proven->error));
    return proven->distance;
}

void dpti_far_prove(const struct dpt_world *world, struct segment *segment, vec3 a, vec3 b)
{
    struct proven_distance *proven = &segment->proven;
    proven->a = a;
    proven->b = b;
    proven->distance = segment->result.lower_bound;
    proven->error = segment->answer.error_bound;
    proven->tick = (uint32_t)world->ticks;
}

void dpti_far_pair(const struct body *body, vec3 a, vec3 b, double lower_bound, struct dynamic_point *track,
                   struct segment_result *result)
{
    pair *found = &track->nearest.pair;
    axis_of(&body->surface, &body->frame, a, b, &track->axis);
    const vec3 q = surface_point(&body->surface, track->nearest.triangle, found->weight);
    found->s = nearest_on(track->axis.local_a, track->axis.u, q);
    found->gap = sub(along(track->axis.local_a, found->s, track->axis.u), q);
    found->distance2 = dot(found->gap, found->gap);
    dpti_segment_result_of_pair(&track->axis, found, result);
    result->status = DPT_STATUS_BOUNDED;
    result->lower_bound = min_of(lower_bound, result->lower_bound);
    result->error_bound = result->distance - result->lower_bound;
}
