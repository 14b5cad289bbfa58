/* SPDX-License-Identifier: BSD-3-Clause */
#include "proxy/tissue_channel.h"

#include "insertion/channel_points.h"
#include "insertion/region_law.h"
#include "proxy/channel_line.h"
#include "proxy/proxy.h"
#include "proxy/proxy_motion.h"

/* As shares of the way to where a step ended, where all of it is not free. */
static const double shares[] = { 1.0, 0.9, 0.5, 0.1, 0.0 };

static struct channel *channel_in(const struct dpt_world *world, const struct inserted *in)
{
    return &world->channels[in->channel];
}

static vec3 tip_place(const struct proxy_tick *tick)
{
    return frame_to_world(&tick->at.frame, dpti_tip_point(tick->world, tick->tool));
}

static vec3 tip_axis(const struct proxy_tick *tick)
{
    return frame_turn(&tick->at.frame, dpti_tip_direction(tick->world, tick->tool));
}

/* Where a tool goes with its bodies: those that keep their shape lead. */
static struct proxy_pose carried_pose(const struct proxy_tick *tick)
{
    const struct dpt_world *world = tick->world;
    const struct insertion *insertion = insertion_of(world, tick->tool);
    const struct inserted *in = &insertion->in[0];
    for (uint32_t i = 0; i < insertion->count; i++) {
        struct channel *channel = channel_in(world, &insertion->in[i]);
        const struct surface *surface = &dpti_channel_body(world, channel)->surface;
        dpti_channel_follow(channel, surface);
        if (!surface->motion)
            in = &insertion->in[i];
    }
    const struct channel_line line = dpti_channel_line(world, channel_in(world, in));
    return dpti_pose_on_line(world, tick->tool, &line, in->place,
                             dpti_turn_along(world, tick->tool, &line, tick->at.turn));
}

int dpti_proxy_go_with_tissue(struct proxy_tick *tick, int is_ended)
{
    const struct proxy_pose to = is_ended ? dpti_proxy_pose_of(tick->proxy, &tick->end) : carried_pose(tick);
    for (size_t i = 0; i < sizeof shares / sizeof *shares; i++) {
        const dpt_pose pose = dpti_rigid_sweep_pose(&tick->at.pose, &to.pose, shares[i]);
        const struct proxy_pose shorter = shares[i] < 1.0 ? dpti_proxy_pose_of(tick->proxy, &pose) : to;
        if (dpti_proxy_sweep(tick, &shorter).status != SWEEP_FREE)
            continue;
        tick->at = shorter;
        tick->is_before = 0;
        return 1;
    }
    return 0;
}

/* How far bristles along hold before they slip. */
static double stretch_max_of(const struct pierce_law *law, double inside)
{
    const double stretch = law->shaft_stiffness > 0.0 ? law->shaft_friction / law->shaft_stiffness
                                                      : min_of(law->shaft_friction, 1.0) * SHAFT_STRETCH;
    return min_of(stretch, 0.5 * inside);
}

/* m: how far the bristles along are stretched, by the mean of the points. */
static double stretch_of(const struct inserted *in, const struct pierce_law *law, double mean)
{
    const double most = stretch_max_of(law, in->inside);
    return in->is_shared ? min_of(max_of(mean - in->rest, -most), most) : in->place - in->anchor;
}

/* Where the anchor has slipped the shares of points are other ones, and more or less of the shaft is inside. */
static void update_bristles(const struct dpt_world *world, struct inserted *in, const struct channel *channel,
                            const struct body *body, vec3 tip, vec3 axis)
{
    const struct surface *surface = &body->surface;
    const vec3 at = frame_to_local(&body->frame, tip), along_axis = frame_turn_back(&body->frame, axis);
    vec3 points[CHANNEL_POINTS_MAX];
    dpti_channel_points_at(channel, surface, points);
    const double mean = dpti_channel_mean_place(channel, points, in->shared, at, along_axis);
    const struct pierce_law law = dpti_shaft_law(world, body, channel, in->shared);
    const double stretch = stretch_of(in, &law, mean);
    in->anchor = in->place - stretch;
    in->last = in->place;
    if (in->is_shared && !in->has_slipped)
        return;
    in->shared = in->anchor;
    in->inside = dpti_channel_inside(channel, in->anchor);
    in->rest = dpti_channel_mean_place(channel, points, in->shared, at, along_axis) - stretch;
    in->is_shared = 1;
    in->has_slipped = 0;
}

/* The tip has come so deep that it makes another point. */
static void add_points(struct proxy_tick *tick, struct channel *channel, const struct body *body, double place)
{
    const struct channel_line line = dpti_channel_line(tick->world, channel);
    for (double next = dpti_channel_next_point(channel); next <= place; next = dpti_channel_next_point(channel)) {
        const uint32_t count = channel->point_count;
        const vec3 at = frame_to_local(&body->frame, along(line.mouth, next, line.axis));
        dpti_channel_add_point(channel, &body->surface, &tick->world->kernel, at, next, &tick->world->work);
        if (channel->point_count == count)
            return;
    }
}

static void update_channel(struct proxy_tick *tick, struct inserted *in, double allowed)
{
    struct dpt_world *world = tick->world;
    struct channel *channel = channel_in(world, in);
    const struct body *body = dpti_channel_body(world, channel);
    const vec3 tip = tip_place(tick), axis = tip_axis(tick);
    if (!channel->point_count)
        dpti_channel_add_entry(channel, &body->surface);
    if (body->surface.motion) {
        const struct channel_point *last = &channel->points[channel->point_count - 1];
        const vec3 at = frame_to_world(&body->frame, dpti_channel_point_at(&body->surface, last));
        in->place = last->place + dot(sub(tip, at), axis);
        channel->axis = frame_turn_back(&body->frame, axis);
        channel->mouth = frame_to_local(&body->frame, along(tip, -in->place, axis));
        if (!dpti_channel_lay_again(channel, &body->surface, body_regions_of(world, body)->of_triangle, &world->kernel,
                                    in->place - channel->length, &world->work)) {
            channel->limit = min_of(channel->limit, in->place);
            tick->proxy->flags |= DPT_FORCE_FLAG_BEHIND;
            tick->tool->has_changed = 1;
        }
    } else {
        const struct channel_line line = dpti_channel_line(world, channel);
        in->place = dot(sub(tip, line.mouth), line.axis);
    }
    update_bristles(world, in, channel, body, tip, axis);
    add_points(tick, channel, body, in->place);
    channel->deepest = max_of(channel->deepest, in->place);
    in->pace = max_of(0.0, allowed);
    in->slid = 0.0;
}

void dpti_tissue_channels_update(struct proxy_tick *tick, double allowed)
{
    struct insertion *insertion = insertion_of(tick->world, tick->tool);
    for (uint32_t i = 0; i < insertion->count; i++)
        update_channel(tick, &insertion->in[i], allowed);
}

void dpti_tissue_channels_rupture(struct proxy_tick *tick)
{
    struct dpt_world *world = tick->world;
    struct insertion *insertion = insertion_of(world, tick->tool);
    int is_paced = 0, has_opened = 0;
    for (uint32_t i = 0; i < insertion->count; i++) {
        struct inserted *in = &insertion->in[i];
        struct channel *channel = channel_in(world, in);
        const struct body *body = dpti_channel_body(world, channel);
        is_paced |= in->is_paced != 0;
        if (!(in->push > 0.0) || channel->open_count == channel->wall_count ||
            channel->walls[channel->open_count].from - tick->clearance > channel->limit)
            continue;
        const struct pierce_law *law = region_law(world, body, channel->walls[channel->open_count].region);
        if (!pierce_law_is_any(law) || !(in->push >= rupture_force(law, channel->radius, tick->tool->stiffness)))
            continue;
        dpti_channel_open_wall(channel);
        has_opened = 1;
    }
    insertion->is_dropping = (uint32_t)(has_opened || (insertion->is_dropping && is_paced));
    if (insertion->is_dropping)
        tick->proxy->flags |= DPT_FORCE_FLAG_RUPTURE;
    insertion->energy = 0.0;
}

void dpti_tissue_channels_balanced(struct proxy_tick *tick, double allowed)
{
    struct insertion *insertion = insertion_of(tick->world, tick->tool);
    for (uint32_t i = 0; i < insertion->count; i++) {
        struct inserted *in = &insertion->in[i];
        struct channel *channel = channel_in(tick->world, in);
        const struct body *body = dpti_channel_body(tick->world, channel);
        if (!channel->point_count)
            dpti_channel_add_entry(channel, &body->surface);
        in->is_shared = 0;
        update_bristles(tick->world, in, channel, body, tip_place(tick), tip_axis(tick));
        add_points(tick, channel, body, in->place);
        in->pace = max_of(0.0, allowed);
    }
}

/* The cosine of the largest turn from a tool to the hole that it enters. */
#define ALIGNED 0.9

/* As a multiple of the radius: so far along a slanted hole the tip may be from its entry, at the mouth. */
#define SLANTED 4.0

/* What is left of the hole for a tip is its entry, as deeper points hold it by and by: it goes in as it points. */
int dpti_tissue_hole_find(struct proxy_tick *tick, struct channel *channel)
{
    struct dpt_world *world = tick->world;
    const struct body *body = dpti_channel_body(world, channel);
    const struct surface *surface = &body->surface;
    const struct channel_point *first = &channel->points[0], *last = &channel->points[channel->point_count - 1];
    const vec3 tip = frame_to_local(&body->frame, tip_place(tick));
    const vec3 axis = frame_turn_back(&body->frame, tip_axis(tick));
    dpti_channel_follow(channel, surface);
    const vec3 entry = add(dpti_channel_point_at(surface, first), first->offset), from = sub(tip, entry);
    if (!(dot(axis, channel->axis) >= ALIGNED) || length(cross(from, axis)) > channel->radius)
        return 0;
    const double at_entry = last->place + dot(sub(entry, dpti_channel_point_at(surface, last)), axis);
    /* What holds a tool in other channels does not let it go aside: there the hole gives way. */
    const int is_in = tool_is_inserted(world, tick->tool);
    if (is_in && fabs(dot(from, axis)) > SLANTED * channel->radius)
        return 0;
    channel->axis = axis;
    channel->mouth = is_in ? along(tip, -at_entry - dot(from, axis), axis) : along(entry, -at_entry, axis);
    return dpti_channel_lay_again(channel, surface, body_regions_of(world, body)->of_triangle, &world->kernel,
                                  at_entry + dot(from, axis) - channel->length, &world->work);
}
