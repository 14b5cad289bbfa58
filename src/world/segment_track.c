/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/segment_track.h"

#include "world/baseline_method.h"
#include "world/body_search.h"

void dpti_track_segment(struct dpt_world *world, uint32_t segment_index)
{
    struct segment *segment = &world->segments[segment_index];
    const struct tool *tool = &world->tools[segment->tool_slot];
    segment->answer.body = NULL;
    segment->result = (struct segment_result){ .status = DPT_STATUS_STALE };
    if (!tool_is_active(world, tool)) {
        segment->broad_phase.has_axis = 0;
        return;
    }
    vec3 a = frame_to_world(&tool->frame, segment->a);
    vec3 b = frame_to_world(&tool->frame, segment->b);
    if (world->def.method == DPT_METHOD_PAPER) {
        segment->felt_penetration = segment->penetration =
            dpti_baseline_find(world, segment_index, a, b);
        return;
    }
    dpti_body_search_find(world, segment_index, &a, &b, &segment->answer);
    if (!segment->answer.body)
        return;
    segment->last_body_slot = handle_index(segment->answer.body->id);
    dpti_body_search_result(&segment->answer, &segment->result);
}
