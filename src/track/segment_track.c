/* SPDX-License-Identifier: BSD-3-Clause */
#include "track/segment_track.h"

#include "track/body_search.h"
#include "track/far_segment.h"

int dpti_track_begin(struct dpt_world *world, uint32_t segment_index)
{
    struct segment *segment = &world->segments[segment_index];
    segment->answer.body = NULL;
    segment->answer.is_far = 0;
    segment->result = (struct segment_result){ .status = DPT_STATUS_STALE };
    if (tool_is_active(world, &world->tools[segment->tool_slot]))
        return 1;
    segment->broad_phase.has_axis = 0;
    return 0;
}

/* Search for the pair of an axis. */
static void track_axis(struct dpt_world *world, uint32_t segment_index, vec3 a, vec3 b)
{
    struct segment *segment = &world->segments[segment_index];
    segment->answer.body = NULL;
    segment->result = (struct segment_result){ .status = DPT_STATUS_STALE };
    dpti_body_search_find(world, segment_index, &a, &b, &segment->answer);
    if (!segment->answer.body)
        return;
    segment->last_body_slot = handle_index(segment->answer.body->id);
    dpti_body_search_result(&segment->answer, &segment->result);
    if (far_is_used(world, &world->tools[segment->tool_slot]))
        dpti_far_prove(world, segment, a, b);
}

void dpti_track_segment(struct dpt_world *world, uint32_t segment_index)
{
    struct segment *segment = &world->segments[segment_index];
    const struct tool *tool = &world->tools[segment->tool_slot];
    if (dpti_track_begin(world, segment_index))
        track_axis(world, segment_index, frame_to_world(&tool->felt_frame, segment->a),
                   frame_to_world(&tool->felt_frame, segment->b));
}

void dpti_track_far(struct dpt_world *world, uint32_t segment_index)
{
    const struct segment *segment = &world->segments[segment_index];
    track_axis(world, segment_index, segment->answer.track.axis.a, segment->answer.track.axis.b);
}

/* Answer without a search, if the segment is no nearer than those that were searched for. */
static int answer_if_far(struct dpt_world *world, struct segment *segment, vec3 a, vec3 b,
                         const struct least_distance *least, int is_outside)
{
    const struct body *body = segment->answer.body;
    const double distance = dpti_far_bound(world, segment, a, b);
    if (!is_outside || !body || !least_is_below(least, distance, segment->radius) ||
        !(world->def.until == DPT_UNTIL_TRACK || distance - segment->radius > world->def.margin))
        return 0;
    dpti_far_pair(body, a, b, distance, &segment->answer.track, &segment->result);
    segment->answer.lower_bound = distance;
    segment->answer.error_bound = segment->answer.track.axis.error;
    segment->answer.is_exact = segment->answer.work = 0;
    segment->answer.is_far = 1;
    return 1;
}

void dpti_track_near(struct dpt_world *world, struct tool *tool, int all_outside)
{
    const uint32_t begin = tool->closest < tool->segment_count ? tool->closest : 0;
    struct least_distance least = least_none();
    for (uint32_t k = 0; k < tool->segment_count; k++) {
        const uint32_t number = (begin + k) % tool->segment_count;
        struct segment *segment = &world->segments[tool->first_segment + number];
        const vec3 a = frame_to_world(&tool->felt_frame, segment->a);
        const vec3 b = frame_to_world(&tool->felt_frame, segment->b);
        if (answer_if_far(world, segment, a, b, &least, all_outside || segment->proven.is_outside))
            continue;
        track_axis(world, tool->first_segment + number, a, b);
        if (segment->answer.body && least_take(&least, segment->result.distance, segment->radius))
            tool->closest = number;
    }
}
