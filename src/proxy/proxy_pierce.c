/* SPDX-License-Identifier: BSD-3-Clause */
/* Where channels begin: a wall that ruptures before the tip, or a tool that is put in. */
#include "proxy/proxy_channel.h"

#include "insertion/region_law.h"
#include "proxy/channel_line.h"
#include "proxy/patch_sides.h"
#include "proxy/proxy.h"
#include "track/tool_parts.h"

/*
 * As a multiple of the clearance: a wall touches the tip that begins so near before it. A tip is held at the clearance
 * from the surface, which is as far along its axis as that leans.
 */
#define TOUCHING 4.0

/* Units that a search for walls may take in a tick, whatever the budget. */
enum { SEARCH_LEAST = 4 };

/* N: the tip's push along its axis, in the open or in channels. */
static double push_of(const struct proxy_tick *tick)
{
    const struct proxy *proxy = tick->proxy;
    if (tool_is_inserted(tick->world, tick->tool))
        return insertion_of(tick->world, tick->tool)->push;
    const vec3 direction = frame_turn(&tick->at.frame, dpti_tip_direction(tick->world, tick->tool));
    const struct displacement away = dpti_proxy_displacement(proxy, &tick->device, &tick->at);
    const struct displacement pulled = dpti_proxy_pulled(&away);
    if (tick->has_ended)
        return -tick->tool->stiffness * dot(proxy->last_pushed.shift, direction);
    return -tick->tool->stiffness * dot(sub(pulled.shift, proxy->yielded.shift), direction);
}

/*
 * The triangle that the tip touches, by its place, or DPT_NONE. Returns 0 where the work does not suffice: of what there is
 * it leaves what a search for walls begins with.
 */
static int find_touched(struct dpt_world *world, const struct body *body, vec3 tip, double reach, uint32_t *triangle)
{
    struct bvh_traversal traversal = { .level = 0 };
    struct pair_search nearest = { .pair = { .distance2 = reach * reach } };
    const struct work before = world->work;
    if (work_left(&world->work) < WORK_COUNTED_ON)
        return 0;
    pair_search_begin(&nearest, DPT_NONE);
    work_limit_to(&world->work, work_left(&world->work) - SEARCH_LEAST);
    const int is_done = dpti_point_search(&body->surface, &world->kernel, frame_to_local(&body->frame, tip), &traversal,
                                          &world->work, &nearest);
    world->work.limit = before.limit;
    *triangle = nearest.triangle;
    return is_done;
}

/* Whether a tool that is in channels is at a hole that it has made in a body: it goes in in the next tick. */
static int is_at_hole_of(const struct proxy_tick *tick, const struct body *body)
{
    const struct dpt_world *world = tick->world;
    for (uint32_t i = 0; i < world->def.max_channels; i++)
        if (world->channels[i].body_id == body->id && dpti_is_at_own_hole(tick, &world->channels[i]))
            return 1;
    return 0;
}

/* Whether the tip may touch a body that can be pierced, and that it is not in. */
static int may_pierce(const struct proxy_tick *tick, uint32_t slot, vec3 tip)
{
    const struct dpt_world *world = tick->world;
    const struct body *body = &world->bodies[slot];
    const struct box box = box_of_axis(tip, tip);
    const double radius = world->segments[tick->tool->first_segment].radius;
    return body_is_there(body) && dpti_body_is_pierced(world, body) &&
           box_distance(&box, &world->boxes[slot]) <= radius + TOUCHING * tick->clearance &&
           !dpti_is_inserted_in(world, tick->tool, body->id) && !is_at_hole_of(tick, body);
}

/* A channel from where a point in the world is, along the tool's axis: nothing of it is known yet. */
static struct channel channel_from(const struct dpt_world *world, const struct tool *tool, const struct frame *frame,
                                   const struct body *body, vec3 mouth, double length)
{
    struct channel channel = { .body_id = body->id };
    channel.mouth = frame_to_local(&body->frame, mouth);
    channel.axis = unit_of(frame_turn_back(&body->frame, frame_turn(frame, dpti_tip_direction(world, tool))));
    channel.radius = world->segments[tool->first_segment].radius;
    channel.length = length;
    return channel;
}

/* Begin to lay it. */
static void begin_search(struct dpt_world *world, const struct tool *tool, const struct frame *frame,
                         const struct body *body, vec3 mouth, double length, struct channel_search *search)
{
    const struct channel channel = channel_from(world, tool, frame, body, mouth, length);
    dpti_channel_search_begin(search, &channel, &body->surface, body_regions_of(world, body)->of_triangle,
                              &world->kernel, &world->work);
}

/*
 * Whether a search that an earlier tick began is for a line at whose mouth the tip still is. A surface that deforms is
 * another one in each tick.
 */
static int is_search_of(const struct proxy_tick *tick, const struct channel_search *search, const struct body *body)
{
    const struct channel *channel = &search->channel;
    if (!search->is_begun || channel->body_id != body->id || body->surface.motion)
        return 0;
    const struct channel_line line = dpti_channel_line(tick->world, channel);
    return dpti_is_at_mouth(tick, channel, &line);
}

/* Whether it is for a body that deforms, and an earlier tick's work did not suffice. */
static int is_in_tissue(const struct channel_search *search, const struct body *body)
{
    return search->channel.body_id == body->id && near_is_under_way(&search->channel.near);
}

/* Of a body that deforms, the walls before the tip, where both are now. Returns 0 if the next tick goes on with it. */
static int search_tissue(struct proxy_tick *tick, const struct body *body, vec3 tip, struct channel_search *search)
{
    struct dpt_world *world = tick->world;
    const struct channel channel =
        channel_from(world, tick->tool, &tick->at.frame, body, tip, dpti_shaft_length(world, tick->tool));
    struct channel_near near = { .margin = 0.0 };
    if (search->channel.body_id == body->id)
        near = search->channel.near;
    const int is_found =
        dpti_channel_search_near(search, &channel, &body->surface, body_regions_of(world, body)->of_triangle,
                                 &world->kernel, &world->work, &near);
    search->channel.near = near;
    return is_found;
}

/* A budget ended a search for walls: the next tick goes on with it. */
static void wait_for_work(struct proxy_tick *tick)
{
    tick->proxy->flags |= DPT_FORCE_FLAG_BEHIND;
    tick->tool->has_changed = 1;
}

static int ruptures(const struct pierce_law *law, double radius, double stiffness, double push)
{
    return pierce_law_is_any(law) && push >= rupture_force(law, radius, stiffness);
}

/*
 * The tip pushes a body: if it touches it and its wall ruptures, a channel begins there. Returns 1 then, and where the
 * search for walls goes on in the next tick: no other body is looked at before.
 */
static int pierce(struct proxy_tick *tick, const struct body *body, double push)
{
    struct dpt_world *world = tick->world;
    const struct tool *tool = tick->tool;
    struct insertion *insertion = insertion_of(world, tool);
    const double radius = world->segments[tool->first_segment].radius;
    const struct channel *first = insertion->count ? &world->channels[insertion->in[0].channel] : NULL;
    const double stiffness = dpti_stiffness_on(tool, first ? dpti_channel_body(world, first) : body);
    if (!(push >= dpti_weakest_rupture(world, body, radius, stiffness)))
        return 0;
    struct channel *channel = dpti_channel_free(world);
    struct channel_search *search = channel_search_of(world, tool);
    const vec3 tip = frame_to_world(&tick->at.frame, dpti_tip_point(world, tool));
    const int is_older = is_search_of(tick, search, body), is_tissue = body->surface.motion != NULL;
    const int is_under_way = is_older || is_in_tissue(search, body);
    uint32_t touched = DPT_NONE;
    /* Without work for that the search itself tells whether it touches. */
    if (!is_under_way && find_touched(world, body, tip, radius + TOUCHING * tick->clearance, &touched) &&
        (touched == DPT_NONE || !ruptures(triangle_law(world, body, touched), radius, stiffness, push)))
        return 0;
    if (!is_older && !is_tissue)
        begin_search(world, tool, &tick->at.frame, body, tip, dpti_shaft_length(world, tool), search);
    if (!(is_tissue ? search_tissue(tick, body, tip, search) : dpti_channel_search_on(search))) {
        wait_for_work(tick);
        return 1;
    }
    const struct channel *found = &search->channel;
    if (!found->wall_count || !(found->walls[0].from > 0.0 && found->walls[0].from <= TOUCHING * tick->clearance) ||
        !ruptures(region_law(world, body, found->walls[0].region), radius, stiffness, push))
        return 0;
    if (!channel || insertion->count == INSERTION_CHANNELS_MAX) {
        tick->proxy->flags |= DPT_FORCE_FLAG_CHANNELS_FULL;
        return 0;
    }
    *channel = *found;
    channel->open_count = 1;
    dpti_channel_open(world, channel, body, tool);
    /* The tip may have moved since the search began: it goes into the hole as into any other. */
    if (!is_older)
        dpti_insertion_add(world, tool, channel, 0.0);
    insertion->is_dropping = 1;
    tick->proxy->flags |= DPT_FORCE_FLAG_RUPTURE;
    if (is_older) {
        tick->tool->has_changed = 1;
        return 1;
    }
    dpti_proxy_forget_triangles(tick->proxy, body->id);
    dpti_patches_forget(world, tool);
    tick->proxy->is_behind |= body->stiffness > 0.0;
    return 1;
}

/* The body that is looked at first: that of a search which goes on. Else two bodies could end each other's for good. */
static uint32_t first_slot(const struct proxy_tick *tick)
{
    const struct channel_search *search = channel_search_of(tick->world, tick->tool);
    if (near_is_under_way(&search->channel.near))
        return handle_index(search->channel.body_id);
    const uint32_t slot = search->is_begun ? handle_index(search->channel.body_id) : 0;
    return is_search_of(tick, search, &tick->world->bodies[slot]) ? slot : 0;
}

void dpti_proxy_pierce(struct proxy_tick *tick)
{
    struct dpt_world *world = tick->world;
    const struct tool *tool = tick->tool;
    if (!tool->piercing || tool->is_free || tick->proxy->state != PROXY_OUTSIDE || tick->is_waiting || tick->is_before)
        return;
    struct insertion *insertion = insertion_of(world, tool);
    insertion->is_dropping = insertion->is_dropping && insertion->count > 0;
    const double push = push_of(tick);
    if (!(push > 0.0))
        return;
    const vec3 tip = frame_to_world(&tick->at.frame, dpti_tip_point(world, tool));
    const struct work before = world->work;
    /* However small the budget, the search goes on by a little: else a wall would hold for good. */
    if (work_left(&world->work) < SEARCH_LEAST)
        world->work.limit = world->work.done + SEARCH_LEAST;
    const uint32_t first = first_slot(tick);
    for (uint32_t i = 0; i < world->body_slot_end; i++) {
        const uint32_t slot = (first + i) % world->body_slot_end;
        if (may_pierce(tick, slot, tip) && pierce(tick, &world->bodies[slot], push))
            break;
    }
    world->work.limit = before.limit;
}

/* The mouth is moved along the line by `way`. */
static void move_mouth(struct channel *channel, double way)
{
    channel->mouth = along(channel->mouth, way, channel->axis);
    channel->entry -= way;
    channel->limit -= way;
    for (uint32_t i = 0; i < channel->wall_count; i++) {
        channel->walls[i].from -= way;
        channel->walls[i].to -= way;
    }
    for (uint32_t i = 0; i < channel->layer_count; i++) {
        channel->layers[i].from -= way;
        channel->layers[i].to -= way;
    }
}

/* A channel of a tool that is put in, from its rear end on. */
struct put_channel {
    struct channel channel;
    const struct body *body;
    double from; /* of its mouth, from the rear end */
};

/* Lay the channel of one body. Returns 0 if the tool does not go into it. */
static int lay_through(struct dpt_world *world, const struct tool *tool, const struct frame *frame,
                       const struct body *body, struct put_channel *put, dpt_result *result)
{
    const double length = dpti_shaft_length(world, tool), clearance = dpti_proxy_clearance(world);
    const vec3 direction = frame_turn(frame, dpti_tip_direction(world, tool));
    const vec3 rear = along(frame_to_world(frame, dpti_tip_point(world, tool)), -length, direction);
    struct channel *channel = &put->channel;
    struct channel_search search;
    begin_search(world, tool, frame, body, rear, 2.0 * length, &search);
    dpti_channel_search_on(&search);
    *channel = search.channel;
    while (channel->open_count < channel->wall_count && channel->walls[channel->open_count].from <= length)
        channel->open_count++;
    if (!channel->open_count)
        return 0;
    for (uint32_t i = 0; i < channel->open_count; i++)
        if (!pierce_law_is_any(region_law(world, body, channel->walls[i].region)))
            *result = DPT_E_ARGUMENT;
    put->body = body;
    put->from = channel->walls[0].from - clearance;
    /* The way out is free: the rear end goes back by as much as the tip is in. */
    if (!(put->from > 0.0) || channel->is_from_inside || channel->limit < length ||
        !dpti_is_clear_of(world, body, rear, along(rear, put->from - length, direction), channel->radius + clearance))
        *result = DPT_E_ARGUMENT;
    channel->length = length;
    move_mouth(channel, put->from);
    channel->limit = min_of(channel->limit, length);
    channel->deepest = length - put->from;
    return 1;
}

/* The tool is in channels that are laid, the outermost first. */
static void put_in(struct dpt_world *world, struct tool *tool, struct put_channel *puts, uint32_t count)
{
    struct proxy *proxy = proxy_of(world, tool);
    for (; count; count--) {
        struct put_channel *first = puts;
        for (uint32_t i = 1; i < count; i++)
            if (puts[i].from < first->from)
                first = &puts[i];
        struct channel *channel = dpti_channel_free(world);
        *channel = first->channel;
        dpti_channel_open(world, channel, first->body, tool);
        dpti_insertion_add(world, tool, channel, channel->deepest);
        *first = puts[count - 1];
    }
    proxy->pose = proxy->device_pose = tool->pose;
    proxy->state = PROXY_OUTSIDE;
    proxy->tick = world->ticks;
    proxy->body_path = world_body_path(world);
    proxy->trust = HUGE_VAL;
    tool->has_changed = 1;
}

/* Undo that. */
static void take_out(struct dpt_world *world, struct tool *tool)
{
    struct insertion *insertion = insertion_of(world, tool);
    for (uint32_t i = 0; i < insertion->count; i++)
        memset(&world->channels[insertion->in[i].channel], 0, sizeof *world->channels);
    dpti_proxy_forget(world, tool);
}

static uint32_t free_channels(const struct dpt_world *world)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < world->def.max_channels; i++)
        count += !world->channels[i].body_id;
    return count;
}

dpt_result dpti_proxy_insert(struct dpt_world *world, struct tool *tool)
{
    struct put_channel puts[INSERTION_CHANNELS_MAX + 1];
    const struct frame frame = tool_device_frame(tool);
    const struct segment *segment = &world->segments[tool->first_segment];
    const struct box box = box_of_axis(frame_to_world(&frame, segment->a), frame_to_world(&frame, segment->b));
    uint32_t count = 0;
    dpt_result result = DPT_OK;
    const struct work before = world->work;
    world->work = work_of(WORK_UNLIMITED);
    for (uint32_t slot = 0; slot < world->body_slot_end && count <= INSERTION_CHANNELS_MAX; slot++) {
        const struct body *body = &world->bodies[slot];
        if (body_is_there(body) && dpti_body_is_pierced(world, body) &&
            box_distance(&box, &world->boxes[slot]) <= segment->radius)
            count += (uint32_t)lay_through(world, tool, &frame, body, &puts[count], &result);
    }
    if (result == DPT_OK && count == 0)
        result = DPT_E_ARGUMENT;
    if (result == DPT_OK && (count > INSERTION_CHANNELS_MAX || count > free_channels(world)))
        result = DPT_E_FULL;
    if (result == DPT_OK)
        put_in(world, tool, puts, count);
    if (result == DPT_OK && !(dpti_beside(world, tool, &frame, 1.0).gap >= dpti_proxy_clearance(world))) {
        take_out(world, tool);
        result = DPT_E_ARGUMENT;
    }
    world->work = before;
    return result;
}
