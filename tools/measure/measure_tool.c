/* SPDX-License-Identifier: BSD-3-Clause */
#include "measure/measure_tool.h"

#include <string.h>

#include "base/quaternion.h"
#include "scene/tool_spread.h"

void measure_tool_begin(struct measure_tool *tool, const struct scene *scene)
{
    dpt_segment lines[DPT_ARM_SEGMENTS_MAX + SCENE_TIPS_MAX];
    uint32_t count = scene->segment_count;
    memset(tool, 0, sizeof *tool);
    tool->scene = scene;
    memcpy(lines, scene->segments, count * sizeof *lines);
    for (uint32_t i = 0; i < scene->tips.count; i++, count++)
        scene_tips_axis(&scene->tips, i, lines[count].a, lines[count].b);
    tool->rho = tool_spread(lines, count, tool->own_centre);
}

static void lead_whole(struct measure_tool *tool, const double *ends)
{
    const struct scene *scene = tool->scene;
    const vec3 a = vec3_of(ends), z = { 0.0, 0.0, 1.0 };
    const vec3 axis = unit_of(sub(vec3_of(ends + 3), a));
    const int had_axis = !tool->is_jump && dot(vec3_of(tool->axis), vec3_of(tool->axis)) > 0.0;
    struct quaternion turn = { 1.0, { 0.0, 0.0, 0.0 } };
    if (had_axis)
        turn = quaternion_of(tool->pose.orientation);
    if (dot(axis, axis) > 0.0) {
        const struct quaternion by = quaternion_of_turn(had_axis ? vec3_of(tool->axis) : z, axis);
        turn = quaternion_unit(quaternion_product(by, turn));
        vec3_store(axis, tool->axis);
    }
    quaternion_store(turn, tool->pose.orientation);
    vec3_store(a, tool->pose.position);
    for (uint32_t i = 0; i < scene->segment_count; i++) {
        const dpt_segment *own = &scene->segments[i];
        vec3_store(add(a, quaternion_turn(turn, vec3_of(own->a))), tool->segments[i].a);
        vec3_store(add(a, quaternion_turn(turn, vec3_of(own->b))), tool->segments[i].b);
        tool->segments[i].radius = own->radius;
    }
    vec3_store(add(a, quaternion_turn(turn, vec3_of(tool->own_centre))), tool->centre);
}

void measure_tool_lead(struct measure_tool *tool, const struct csv_table *trace, size_t row)
{
    const double *ends = csv_table_row(trace, row) + 1;
    tool->is_jump = trace_is_jump(trace, row);
    if (!tool->scene->has_stylus) {
        lead_whole(tool, ends);
        return;
    }
    dpt_segment *stylus = &tool->segments[0];
    memcpy(stylus->a, ends, sizeof stylus->a);
    memcpy(stylus->b, ends + 3, sizeof stylus->b);
    stylus->radius = tool->scene->stylus.radius;
    memcpy(tool->pose.position, stylus->a, sizeof stylus->a);
    tool->rho = tool_spread(stylus, 1, tool->centre);
}

dpt_result measure_tool_move(const struct measure_tool *tool, dpt_world *world, dpt_tool id)
{
    const dpt_pose identity = DPT_POSE_IDENTITY;
    dpt_result result = DPT_OK;
    if (!tool->scene->has_stylus)
        return tool->is_jump ? dpt_tool_teleport(world, id, &tool->pose) : dpt_tool_set_pose(world, id, &tool->pose);
    if (tool->is_jump)
        result = dpt_tool_teleport(world, id, &identity);
    return result == DPT_OK ? dpt_tool_set_segments(world, id, tool->segments, 1) : result;
}

void measure_tool_weigh(const struct measure_tool *tool, const dpt_wrench *wrench, double weighed[6])
{
    const vec3 force = vec3_of(wrench->force);
    const vec3 arm = sub(vec3_of(tool->pose.position), vec3_of(tool->centre));
    const vec3 torque = add(vec3_of(wrench->torque), cross(arm, force));
    vec3_store(force, weighed);
    vec3_store(scaled(torque, tool->rho > 0.0 ? 1.0 / tool->rho : 0.0), weighed + 3);
}
