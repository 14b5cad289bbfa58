/* SPDX-License-Identifier: BSD-3-Clause */
#include "run/replay_tool.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "base/quaternion.h"
#include "cli/command_options.h"
#include "csv.h"

/* Of the tool's length: rows of a trace with few digits differ by that. */
#define LENGTH_ERROR 1e-4

static dpt_segment segment_of(const struct csv_table *trace, size_t row, double radius)
{
    const double *ends = csv_table_row(trace, row) + 1;
    dpt_segment segment;
    memcpy(segment.a, ends, sizeof segment.a);
    memcpy(segment.b, ends + 3, sizeof segment.b);
    segment.radius = radius;
    return segment;
}

/* From end a to end b of a row. */
static vec3 reach_of(const struct csv_table *trace, size_t row)
{
    const double *ends = csv_table_row(trace, row) + 1;
    return sub(vec3_of(ends + 3), vec3_of(ends));
}

int replay_tool_open(struct replay_tool *tool, const char *path, const struct csv_table *trace)
{
    const double first = length(reach_of(trace, 0));
    tool->length = first;
    for (size_t row = 0; tool->tips.count && row < trace->rows; row++) {
        const double size = length(reach_of(trace, row));
        if (!(fabs(size - first) <= LENGTH_ERROR * first))
            return complain("replay",
                            "%s: tick %.0f: --tip needs a tool of one length; it is %g m, and %g m in the first row",
                            path, csv_table_row(trace, row)[0], size, first);
    }
    for (uint32_t i = 0; i < tool->tips.count; i++) {
        const dpt_result result = tip_shape_make(&tool->tips.shape[i], &tool->blocks[i], &tool->hulls[i]);
        if (result != DPT_OK)
            return complain("replay", "tip %" PRIu32 ": %s", i + 1, dpt_result_text(result));
    }
    return 0;
}

void replay_tool_close(struct replay_tool *tool)
{
    for (uint32_t i = 0; i < tool->tips.count; i++)
        free(tool->blocks[i]);
}

dpt_result replay_tool_add(const struct replay_tool *tool, const struct csv_table *trace, dpt_world *world,
                           dpt_tool *added)
{
    const dpt_segment posed = { .b = { 0.0, 0.0, tool->length }, .radius = tool->radius };
    const dpt_segment segment = tool->tips.count ? posed : segment_of(trace, 0, tool->radius);
    return dpt_tool_add(world, &segment, 1, added);
}

dpt_result replay_tool_add_tips(struct replay_tool *tool, dpt_world *world, dpt_tool added, const dpt_mesh *mesh,
                                const struct force_options *force)
{
    dpt_tip tips[TIP_SHAPES_MAX];
    if (force->law != DPT_LAW_PROXY) {
        tool->curved.bodies[0] = (dpt_convex_body){ .mesh = mesh };
        tool->curved.body_count = 1;
        return curved_tips_attach(&tool->curved, &tool->tips, world, added, force);
    }
    for (uint32_t i = 0; i < tool->tips.count; i++)
        tips[i] = (dpt_tip){ .size = sizeof tips[i], .hull = tool->hulls[i] };
    return dpt_tool_set_tips(world, added, tips, tool->tips.count);
}

double replay_tool_error(const struct replay_tool *tool)
{
    return tool->curved.count ? tool->curved.error : tip_shapes_error(&tool->tips);
}

/* Turned as little as can be from `turn`, or after a jump from not being turned, so that z leads along `reach`. */
static struct quaternion turned_along(struct quaternion turn, vec3 reach)
{
    const vec3 z = { 0.0, 0.0, 1.0 };
    const double size = length(reach);
    if (!(size > 0.0))
        return turn;
    const vec3 along = scaled(reach, 1.0 / size);
    const struct quaternion by = quaternion_of_turn(unit_of(quaternion_turn(turn, z)), along);
    return quaternion_unit(quaternion_product(by, turn));
}

void replay_tool_place(struct replay_tool *tool, const struct csv_table *trace, size_t row, dpt_world *world,
                       dpt_tool added)
{
    static const dpt_pose identity = DPT_POSE_IDENTITY;
    const dpt_segment segment = segment_of(trace, row, tool->radius);
    const int is_jump = trace_is_jump(trace, row);
    curved_tips_begin_tick(&tool->curved);
    if (!tool->tips.count) {
        if (is_jump)
            dpt_tool_teleport(world, added, &identity);
        dpt_tool_set_segments(world, added, &segment, 1);
        return;
    }
    if (is_jump)
        tool->pose = identity;
    const struct quaternion before = quaternion_of(tool->pose.orientation);
    quaternion_store(turned_along(before, reach_of(trace, row)), tool->pose.orientation);
    memcpy(tool->pose.position, segment.a, sizeof segment.a);
    if (is_jump)
        dpt_tool_teleport(world, added, &tool->pose);
    else
        dpt_tool_set_pose(world, added, &tool->pose);
}
