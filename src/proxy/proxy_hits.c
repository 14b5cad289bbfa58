/* SPDX-License-Identifier: BSD-3-Clause */
/* The hits of a tool with a proxy: its nearest pairs where the device is, not where the proxy was held back. */
#include "proxy/proxy_step.h"

#include "proxy/proxy_free.h"
#include "track/far_segment.h"

/* With one body, without a history. 0: the budget ended the search. */
static int find_pair(struct dpt_world *world, uint32_t index, uint32_t slot, struct dynamic_point *track)
{
    const struct body *body = &world->bodies[slot];
    struct bvh_traversal traversal;
    traversal.level = 0;
    dpti_dynamic_point_begin(track, &body->surface, *world_last_triangles(world, index, slot), HUGE_VAL, DESCENT_NONE,
                             &world->work);
    return dpti_dynamic_point_prove(track, &body->surface, &world->kernel, NULL, &traversal, &world->work);
}

/* Over all bodies; returns the distance. *is_exact: no budget ended a search. */
static double find_nearest(struct dpt_world *world, uint32_t index, vec3 a, vec3 b, struct body_answer *best,
                           int *is_exact)
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

/* The pair of a segment that is searched for, of which the budget may have left a bound. */
static void find_hit(struct dpt_world *world, uint32_t index, const struct proxy *proxy, vec3 a, vec3 b, double apart,
                     struct body_answer *best, struct segment_result *result)
{
    const double radius = world->segments[index].radius;
    int is_exact;
    const double distance = find_nearest(world, index, a, b, best, &is_exact);
    if (!best->body)
        return;
    dpti_segment_result_of_pair(&best->track.axis, &best->track.nearest.pair, result);
    if (is_exact || !(distance > 0.0))
        return;
    /* Nothing is nearer than it is to the proxy, less what the two are apart. */
    const double least = proxy->gap + radius - apart - result->error_bound;
    result->status = DPT_STATUS_BOUNDED;
    result->lower_bound = max_of(0.0, least);
    result->error_bound = distance - result->lower_bound;
}

/* The hit of a segment; with `near_only` without a search where what is known of it at the proxy leaves it far. */
static void write_hit(struct dpt_world *world, const struct tool *tool, uint32_t number, const struct frame *device,
                      struct least_distance *nearest)
{
    const struct proxy *proxy = &world->proxies[tool - world->tools];
    const uint32_t index = tool->first_segment + number;
    struct segment *segment = &world->segments[index];
    const vec3 end = tool->is_free ? (vec3){ proxy->length, 0.0, 0.0 } : segment->b;
    const vec3 a = frame_to_world(device, segment->a), b = frame_to_world(device, end);
    const vec3 proxy_a = frame_to_world(&tool->felt_frame, segment->a);
    const vec3 proxy_b = frame_to_world(&tool->felt_frame, segment->b);
    const double apart = max_of(length(sub(a, proxy_a)), length(sub(b, proxy_b)));
    const double least = segment->result.lower_bound - apart - segment->answer.error_bound;
    const uint32_t work_before = world->work.done;
    struct body_answer best = { .body = segment->answer.body, .track = segment->answer.track };
    struct segment_result result;
    segment->answer.is_far = far_is_used(world, tool) && best.body && least_is_below(nearest, least, segment->radius);
    if (segment->answer.is_far)
        dpti_far_pair(best.body, a, b, least, &best.track, &result);
    else
        find_hit(world, index, proxy, a, b, apart, &best, &result);
    if (!best.body)
        return;
    /* The proxy was held back: the device is behind a surface, however far that is. */
    result.contact = DPT_CONTACT_PENETRATING;
    result.work = segment->result.work + world->work.done - work_before;
    dpti_segment_result_write(&result, &best.body->surface, &best.body->frame, best.body->id, &best.track.nearest,
                              &segment->hit);
    least_take(nearest, result.distance, segment->radius);
}

int dpti_proxy_is_away(const struct dpt_world *world, const struct tool *tool)
{
    return dpti_proxy_is_used(world, tool) &&
           (world->proxies[tool - world->tools].is_held || !dpti_proxy_has_size(world, tool));
}

void dpti_proxy_write_hits(struct dpt_world *world, struct tool *tool)
{
    const struct frame device = tool_device_frame(tool);
    struct least_distance nearest = least_none();
    const uint32_t first = tool->closest < tool->segment_count ? tool->closest : 0;
    for (uint32_t i = 0; i < tool->segment_count; i++)
        write_hit(world, tool, (first + i) % tool->segment_count, &device, &nearest);
}
