/* SPDX-License-Identifier: BSD-3-Clause */
/* The hits of a tool with a proxy: its nearest pairs where the device is, not where the proxy was held back. */
#include "world/proxy_step.h"

#include "world/proxy_free.h"

/* With one body, without a history. 0: the budget ended the search. */
static int find_pair(struct dpt_world *world, uint32_t index, uint32_t slot,
                     struct dynamic_point *track)
{
    const struct body *body = &world->bodies[slot];
    struct bvh_traversal traversal;
    traversal.level = 0;
    dpti_dynamic_point_begin(track, &body->surface, *world_last_triangles(world, index, slot),
                             HUGE_VAL, DESCENT_NONE, &world->work);
    return dpti_dynamic_point_prove(track, &body->surface, &world->kernel, NULL, &traversal,
                                    &world->work);
}

/* Over all bodies; returns the distance. *is_exact: no budget ended a search. */
static double find_nearest(struct dpt_world *world, uint32_t index, vec3 a, vec3 b,
                           struct body_answer *best, int *is_exact)
{
    const struct box box = box_of_axis(a, b);
    double distance = HUGE_VAL;
    *is_exact = 1;
    best->body = NULL;
    for (uint32_t i = 0; i < world->body_slot_end && distance > 0.0; i++) {
        const struct body *body = &world->bodies[i];
        struct dynamic_point track;
        if (!body_is_there(body) || box_distance(&box, &world->boxes[i]) > distance)
            continue;
        axis_of(&body->surface, &body->frame, a, b, &track.axis);
        *is_exact &= find_pair(world, index, i, &track);
        if (track.nearest.triangle == DPT_NONE || !(sqrt(track.nearest.pair.distance2) < distance))
            continue;
        distance = sqrt(track.nearest.pair.distance2);
        best->track = track;
        best->body = body;
    }
    return distance;
}

static void write_hit(struct dpt_world *world, const struct tool *tool, uint32_t number,
                      const struct frame *device)
{
    const struct proxy *proxy = &world->proxies[tool - world->tools];
    struct segment *segment = &world->segments[tool->first_segment + number];
    const vec3 end = tool->is_free ? (vec3){ proxy->length, 0.0, 0.0 } : segment->b;
    const vec3 a = frame_to_world(device, segment->a), b = frame_to_world(device, end);
    const vec3 proxy_a = frame_to_world(&tool->frame, segment->a);
    const vec3 proxy_b = frame_to_world(&tool->frame, segment->b);
    const uint32_t work_before = world->work.done;
    struct body_answer best;
    struct segment_result result;
    int is_exact;
    const double distance =
        find_nearest(world, tool->first_segment + number, a, b, &best, &is_exact);
    if (!best.body)
        return;
    dpti_segment_result_of_pair(&best.track.axis, &best.track.nearest.pair, &result);
    if (!is_exact && distance > 0.0) {
        /* Nothing is nearer than it is to the proxy, less what the two are apart. */
        const double apart = max_of(length(sub(a, proxy_a)), length(sub(b, proxy_b)));
        const double least = proxy->gap + segment->radius - apart - result.error_bound;
        result.status = DPT_STATUS_BOUNDED;
        result.lower_bound = max_of(0.0, least);
        result.error_bound = distance - result.lower_bound;
    }
    /* The proxy was held back: the device is behind a surface, however far that is. */
    result.contact = DPT_CONTACT_PENETRATING;
    result.work = segment->result.work + world->work.done - work_before;
    dpti_segment_result_write(&result, &best.body->surface, &best.body->frame, best.body->id,
                              &best.track.nearest, &segment->hit);
}

int dpti_proxy_is_away(const struct dpt_world *world, const struct tool *tool)
{
    return dpti_proxy_is_used(world, tool) &&
           (world->proxies[tool - world->tools].is_held || !dpti_proxy_has_size(world, tool));
}

void dpti_proxy_write_hits(struct dpt_world *world, struct tool *tool)
{
    struct frame device;
    if (!dpti_proxy_is_away(world, tool))
        return;
    frame_of_pose(&tool->pose, &device);
    for (uint32_t i = 0; i < tool->segment_count; i++)
        write_hit(world, tool, i, &device);
}
