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

/* The nearest point of one body to an axis, if any is within `limit` m. Returns 0 where a budget ended the search. */
static int search_body(struct dpt_world *world, const struct body *body, vec3 a, vec3 b, double limit,
                       struct pair_search *nearest)
{
    *nearest = (struct pair_search){ .pair = { .distance2 = limit * limit } };
    pair_search_begin(nearest, DPT_NONE);
    const vec3 local = frame_to_local(&body->frame, a);
    return dpti_bvh_search(&body->surface, &world->kernel, local, sub(frame_to_local(&body->frame, b), local),
                           &world->work, nearest);
}

struct beside dpti_beside(struct dpt_world *world, const struct tool *tool, const struct frame *frame, double limit)
{
    const struct segment *segment = &world->segments[tool->first_segment];
    const vec3 a = frame_to_world(frame, segment->a), b = frame_to_world(frame, segment->b);
    const struct box box = box_of_axis(a, b);
    struct beside beside = { .gap = limit, .triangle = DPT_NONE };
    for (uint32_t slot = 0; slot < world->body_slot_end; slot++) {
        const struct body *body = &world->bodies[slot];
        const double least = beside.gap + segment->radius;
        struct pair_search nearest;
        if (!body_is_there(body) || !(box_distance(&box, &world->boxes[slot]) <= least) ||
            dpti_is_inserted_in(world, tool, body->id))
            continue;
        if (!search_body(world, body, a, b, least, &nearest))
            return (struct beside){ .gap = -HUGE_VAL, .triangle = DPT_NONE };
        const double gap = sqrt(nearest.pair.distance2) - segment->radius;
        if (nearest.triangle == DPT_NONE || !(gap < beside.gap))
            continue;
        beside = (struct beside){ .gap = gap, .body_id = body->id, .triangle = nearest.triangle };
    }
    return beside;
}

int dpti_is_clear_of(struct dpt_world *world, const struct body *body, vec3 a, vec3 b, double radius)
{
    struct pair_search nearest;
    return search_body(world, body, a, b, radius, &nearest) && nearest.triangle == DPT_NONE;
}

/* As a share of the tool's radius: a tool is dented no more than tissue may dent it (docs/algorithms/tissue.md). */
#define ASIDE 0.1

int dpti_is_on_line(const struct proxy_tick *tick, const struct channel_line *host, const struct channel_line *line)
{
    const double radius = tick->world->segments[tick->tool->first_segment].radius;
    const vec3 at_mouth = cross(sub(line->mouth, host->mouth), host->axis);
    const double leaning = length(cross(line->axis, host->axis)) * dpti_shaft_length(tick->world, tick->tool);
    return dot(line->axis, host->axis) > 0.0 && length(at_mouth) + leaning <= ASIDE * radius + tick->clearance;
}

double dpti_channel_offset(const struct channel_line *host, const struct channel_line *line)
{
    return dot(sub(host->mouth, line->mouth), line->axis);
}

/* As multiples of the clearance: so far before its first wall the tip is out of a body that deforms. */
#define OUT 8.0

double dpti_channel_mouth_place(const struct proxy_tick *tick, const struct channel *channel)
{
    if (!dpti_channel_body(tick->world, channel)->surface.motion)
        return 0.0;
    return channel->wall_count ? channel->walls[0].from - tick->clearance : HUGE_VAL;
}

double dpti_channel_way_out(const struct proxy_tick *tick, const struct channel *channel)
{
    if (!dpti_channel_body(tick->world, channel)->surface.motion)
        return 0.0;
    return channel->wall_count ? channel->walls[0].from - OUT * tick->clearance : HUGE_VAL;
}

/* The cosine of the largest turn from a tool to the channel that it enters. */
#define ALIGNED 0.9

int dpti_is_at_mouth(const struct proxy_tick *tick, const struct channel *channel, const struct channel_line *line)
{
    const vec3 tip = frame_to_world(&tick->at.frame, dpti_tip_point(tick->world, tick->tool));
    const vec3 from = sub(tip, along(line->mouth, dpti_channel_mouth_place(tick, channel), line->axis));
    const vec3 direction = frame_turn(&tick->at.frame, dpti_tip_direction(tick->world, tick->tool));
    return dot(direction, line->axis) >= ALIGNED && length(cross(from, line->axis)) <= channel->radius &&
           fabs(dot(from, line->axis)) <= 2.0 * channel->radius;
}

/* As a multiple of the clearance: so near before its mouth the tip is at a hole. */
#define AT_MOUTH 4.0

int dpti_is_at_own_hole(const struct proxy_tick *tick, const struct channel *channel)
{
    const struct dpt_world *world = tick->world;
    const struct insertion *insertion = insertion_of(world, tick->tool);
    if (!insertion->count || !channel->body_id || world_find_tool(world, channel->tool_id) != tick->tool ||
        dpti_is_inserted_in(world, tick->tool, channel->body_id))
        return 0;
    const struct channel_line host = dpti_channel_line(world, &world->channels[insertion->in[0].channel]);
    const struct channel_line line = dpti_channel_line(world, channel);
    const double place = insertion->in[0].place + dpti_channel_offset(&host, &line);
    return dpti_is_on_line(tick, &host, &line) &&
           fabs(place - dpti_channel_mouth_place(tick, channel)) <= AT_MOUTH * tick->clearance;
}
