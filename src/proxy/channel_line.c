/* SPDX-License-Identifier: BSD-3-Clause */
#include "proxy/channel_line.h"

#include "proxy/proxy.h"
#include "track/tool_parts.h"

struct channel_line dpti_channel_line(const struct dpt_world *world, const struct channel *channel)
{
    const struct body *body = dpti_channel_body(world, channel);
    return (struct channel_line){ frame_to_world(&body->frame, channel->mouth),
                                  frame_turn(&body->frame, channel->axis) };
}

vec3 dpti_tip_point(const struct dpt_world *world, const struct tool *tool)
{
    const struct segment *segment = &world->segments[tool->first_segment];
    return tool->piercing == DPT_PIERCING_A ? segment->a : segment->b;
}

vec3 dpti_tip_direction(const struct dpt_world *world, const struct tool *tool)
{
    const struct segment *segment = &world->segments[tool->first_segment];
    const vec3 u = unit_of(sub(segment->b, segment->a));
    return tool->piercing == DPT_PIERCING_A ? scaled(u, -1.0) : u;
}

double dpti_shaft_length(const struct dpt_world *world, const struct tool *tool)
{
    const struct segment *segment = &world->segments[tool->first_segment];
    return length(sub(segment->b, segment->a));
}

struct quaternion dpti_turn_along(const struct dpt_world *world, const struct tool *tool,
                                  const struct channel_line *line, struct quaternion turn)
{
    const vec3 now = quaternion_turn(turn, dpti_tip_direction(world, tool));
    return quaternion_unit(quaternion_product(quaternion_of_turn(now, line->axis), turn));
}

struct proxy_pose dpti_pose_on_line(const struct dpt_world *world, const struct tool *tool,
                                    const struct channel_line *line, double place, struct quaternion turn)
{
    const vec3 tip = along(line->mouth, place, line->axis);
    dpt_pose pose;
    vec3_store(sub(tip, quaternion_turn(turn, dpti_tip_point(world, tool))), pose.position);
    quaternion_store(turn, pose.orientation);
    return dpti_proxy_pose_of(proxy_of(world, tool), &pose);
}

double dpti_device_place(const struct dpt_world *world, const struct tool *tool, const struct channel_line *line,
                         vec3 device_centre)
{
    return dot(sub(device_centre, line->mouth), line->axis) + 0.5 * dpti_shaft_length(world, tool);
}

double dpti_stiffness_on(const struct tool *tool, const struct body *body)
{
    return body->stiffness > 0.0 ? tool->stiffness * body->stiffness / (tool->stiffness + body->stiffness)
                                 : tool->stiffness;
}

/* m: the distance of an axis from one body, at most `limit`. */
static double distance_to(struct dpt_world *world, const struct body *body, vec3 a, vec3 b, double limit)
{
    struct pair_search nearest = { .pair = { .distance2 = limit * limit } };
    pair_search_begin(&nearest, DPT_NONE);
    const vec3 local = frame_to_local(&body->frame, a);
    if (!dpti_bvh_search(&body->surface, &world->kernel, local, sub(frame_to_local(&body->frame, b), local),
                         &world->work, &nearest))
        return -HUGE_VAL;
    return sqrt(nearest.pair.distance2);
}

double dpti_gap_beside(struct dpt_world *world, const struct tool *tool, const struct frame *frame, double limit)
{
    const struct segment *segment = &world->segments[tool->first_segment];
    const vec3 a = frame_to_world(frame, segment->a), b = frame_to_world(frame, segment->b);
    const struct box box = box_of_axis(a, b);
    double least = limit + segment->radius;
    for (uint32_t slot = 0; slot < world->body_slot_end; slot++) {
        const struct body *body = &world->bodies[slot];
        if (body_is_there(body) && box_distance(&box, &world->boxes[slot]) <= least &&
            !dpti_is_inserted_in(world, tool, body->id))
            least = min_of(least, distance_to(world, body, a, b, least));
    }
    return least - segment->radius;
}
