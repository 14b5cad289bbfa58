/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/baseline_method.h"

#include "contact/paper_gap.h"
#include "nearest/paper_descent.h"

/* Sums up what the parts on all bodies found. */
struct gathered {
    struct penetration push; /* of the part with the least gap */
    int any;
    double gap;
    struct body_answer *found;
    struct segment_result *result;
};

/* This tick's dynamic point: a full search where there is none yet. */
static void dynamic_point(const struct dpt_world *world, const struct surface *surface,
                          const struct axis *part, uint32_t *last, struct work *work,
                          struct pair_search *nearest)
{
    *nearest = (struct pair_search){ .pair = { .distance2 = HUGE_VAL }, .triangle = *last };
    if (*last == DPT_NONE)
        dpti_bvh_search(surface, &world->kernel, NULL, part->local_a, part->u, 0.0, work, nearest);
    else
        dpti_paper_descend(surface, &world->kernel, part->local_a, part->u,
                           world->def.baseline->one_step != 0, work, nearest);
    *last = nearest->triangle;
}

static void take_part(struct gathered *sum, const struct dpt_world *world, const struct body *body,
                      uint32_t index, const struct axis *part, const struct pair_search *nearest,
                      double radius)
{
    struct penetration penetration;
    double gap =
        dpti_contact_paper(&body->surface, &body->frame, part, nearest, radius, &penetration);
    double distance = sqrt(nearest->pair.distance2);
    int lower = gap < sum->gap;
    if (!sum->any || distance < sum->result->distance ||
        (distance == sum->result->distance && lower)) {
        dpti_segment_result_of_pair(part, &nearest->pair, sum->result);
        sum->result->s = (index + nearest->pair.s) / world->def.baseline->parts;
        sum->found->body = body;
        sum->found->track.nearest = *nearest;
    }
    if (!sum->any || lower) {
        sum->gap = gap;
        sum->push = penetration;
        sum->any = 1;
    }
}

static void take_body(struct gathered *sum, struct dpt_world *world, uint32_t segment,
                      const struct body *body, vec3 a, vec3 u)
{
    uint32_t parts = world->def.baseline->parts;
    uint32_t *last = world_last(world, segment, handle_index(body->id));
    for (uint32_t k = 0; k < parts; k++) {
        struct axis part;
        struct pair_search nearest;
        axis_of(&body->surface, &body->frame, along(a, (double)k / parts, u),
                along(a, (double)(k + 1) / parts, u), &part);
        dynamic_point(world, &body->surface, &part, &last[k], &world->work, &nearest);
        if (nearest.triangle != DPT_NONE)
            take_part(sum, world, body, k, &part, &nearest, world->segments[segment].radius);
    }
}

struct penetration dpti_paper_segment(struct dpt_world *world, uint32_t index, vec3 a, vec3 b)
{
    struct segment *segment = &world->segments[index];
    struct body_answer *found = &segment->answer;
    struct segment_result *result = &segment->result;
    struct gathered sum = { .found = found, .result = result };
    const uint32_t before = world->work.done;
    vec3 u = sub(b, a);
    for (uint32_t i = 0; i < world->body_end; i++)
        if (world->bodies[i].slot.used)
            take_body(&sum, world, index, &world->bodies[i], a, u);
    if (!sum.any)
        return sum.push;

    axis_of(&found->body->surface, &found->body->frame, a, b, &found->track.axis);
    /* Between 0 and what was found: that is all that a search without proof knows. */
    double rounding = result->error_bound;
    result->work = world->work.done - before;
    result->status = DPT_STATUS_LOCAL;
    result->error_bound = result->distance + rounding;
    result->lower_bound = 0.0;
    if (world->def.until != DPT_UNTIL_TRACK)
        dpti_segment_result_set_gap(result, sum.gap, rounding);
    return sum.push;
}
