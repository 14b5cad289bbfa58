/* SPDX-License-Identifier: BSD-3-Clause */
#include "proxy/proxy_channel.h"

#include "insertion/channel_points.h"
#include "insertion/region_law.h"
#include "proxy/channel_line.h"
#include "proxy/patch_sides.h"
#include "proxy/proxy.h"
#include "proxy/proxy_force.h"
#include "proxy/proxy_motion.h"
#include "proxy/proxy_put.h"
#include "proxy/tissue_channel.h"
#include "proxy/tool_loads.h"

/* The most times that a motion which comes too near to another body is shortened: first a little, then more. */
enum { SHORTEN_LITTLE = 4, SHORTEN_MAX = 12 };
#define SHORTER_LITTLE 0.9
#define SHORTER        0.7

/* m: places that are nearer are the same. */
#define SAME_PLACE 1e-12

static struct channel *channel_in(const struct dpt_world *world, const struct insertion *insertion, uint32_t i)
{
    return &world->channels[insertion->in[i].channel];
}

static const struct body *body_in(const struct dpt_world *world, const struct insertion *insertion, uint32_t i)
{
    return dpti_channel_body(world, channel_in(world, insertion, i));
}

/* The tool is out of its channels, put at its device: bodies leave it no pose on its line. */
static void lose_channels(struct proxy_tick *tick)
{
    dpti_insertion_forget(tick->world, tick->tool);
    dpti_patches_forget(tick->world, tick->tool);
    tick->proxy->flags |= DPT_FORCE_FLAG_SQUEEZED;
    dpti_proxy_put_again(tick);
}

/* A body that was added or teleported may be round it: it is not where the tool is, or the tool loses its channels. */
static int is_undoubted(struct proxy_tick *tick)
{
    struct proxy *proxy = tick->proxy;
    if (proxy->state != PROXY_DOUBTED)
        return 1;
    /* Bodies have moved while it was not stepped: nothing of their way is known. */
    if (!(proxy->gap > -HUGE_VAL) ||
        !(dpti_beside(tick->world, tick->tool, &tick->at.frame, tick->clearance).gap >= tick->min_gap))
        return 0;
    proxy->state = PROXY_OUTSIDE;
    proxy->has_home = 0;
    return 1;
}

/*
 * Go with the host, past all other bodies and their motion. If one comes to the tip, the tip goes back before it along its
 * line, to the mouth at most.
 */
static int carry_with_host(struct proxy_tick *tick)
{
    const struct dpt_world *world = tick->world;
    struct insertion *insertion = insertion_of(world, tick->tool);
    const struct body *host = body_in(world, insertion, 0);
    const struct channel_line line = dpti_channel_line(world, channel_in(world, insertion, 0));
    struct quaternion turn = tick->at.turn;
    struct proxy_pose to = tick->at;
    double place = insertion->in[0].place;
    insertion->carried = (struct displacement){ { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.0 }, 0.0 };
    if (!tick->is_before)
        return 1;
    if (body_has_moved(world, host)) {
        const struct quaternion turned =
            quaternion_product(quaternion_unit(quaternion_of(host->pose.orientation)),
                               quaternion_inverse(quaternion_unit(quaternion_of(host->previous_pose.orientation))));
        turn = dpti_turn_along(world, tick->tool, &line, quaternion_unit(quaternion_product(turned, turn)));
        to = dpti_pose_on_line(world, tick->tool, &line, place, turn);
        insertion->carried = dpti_proxy_displacement(tick->proxy, &tick->at, &to);
        /* A device without torque turns with the tool about the origin: there it is felt. */
        if (tick->tool->lock_rotation)
            insertion->carried.shift = sub(to.frame.origin, tick->at.frame.origin);
    }
    int status = dpti_proxy_sweep(tick, &to).status;
    if (status == SWEEP_HIT) {
        /* The host and another body have moved by so much towards each other at most. */
        const double back = 2.0 * world_body_motion(world) + tick->clearance;
        place = max_of(place - back, min_of(place, 0.0));
        to = dpti_pose_on_line(world, tick->tool, &line, place, turn);
        status = dpti_proxy_sweep(tick, &to).status;
    }
    if (status != SWEEP_FREE)
        return 0;
    insertion->in[0].place = place;
    tick->at = to;
    tick->is_before = 0;
    return 1;
}

/* Bodies that moved have moved the other channels along the line at most. */
static int follow_others(const struct proxy_tick *tick, const struct channel_line *host)
{
    const struct dpt_world *world = tick->world;
    struct insertion *insertion = insertion_of(world, tick->tool);
    const struct inserted *first = &insertion->in[0];
    for (uint32_t i = 1; i < insertion->count; i++) {
        struct inserted *in = &insertion->in[i];
        const struct channel_line line = dpti_channel_line(world, channel_in(world, insertion, i));
        if (!dpti_is_on_line(tick, host, &line))
            return 0;
        in->place = first->place + dpti_channel_offset(host, &line);
        in->slid = in->place - in->last - (first->place - first->last);
    }
    return 1;
}

/* A hole of its own in a body that deforms, in which it is not: it is where the body has it. */
static int is_other_hole_in_tissue(const struct proxy_tick *tick, const struct channel *channel)
{
    const struct dpt_world *world = tick->world;
    return channel->body_id && channel->point_count && world_find_tool(world, channel->tool_id) == tick->tool &&
           dpti_channel_body(world, channel)->surface.motion &&
           !dpti_is_inserted_in(world, tick->tool, channel->body_id);
}

/* At another hole of its own on the line the tip meets no wall: it is in that, too. */
static void enter_holes(struct proxy_tick *tick, const struct channel_line *host)
{
    struct dpt_world *world = tick->world;
    struct insertion *insertion = insertion_of(world, tick->tool);
    for (uint32_t i = 0; i < world->def.max_channels && insertion->count < INSERTION_CHANNELS_MAX; i++) {
        struct channel *channel = &world->channels[i];
        if (is_other_hole_in_tissue(tick, channel) && !dpti_tissue_hole_find(tick, channel))
            continue;
        if (!dpti_is_at_own_hole(tick, channel))
            continue;
        const struct channel_line line = dpti_channel_line(world, channel);
        dpti_insertion_add(world, tick->tool, channel, insertion->in[0].place + dpti_channel_offset(host, &line));
        dpti_proxy_forget_triangles(tick->proxy, channel->body_id);
    }
}

static struct shaft shaft_of(const struct dpt_world *world, const struct body *body, const struct channel *channel,
                             const struct inserted *in)
{
    const struct pierce_law law = dpti_shaft_law(world, body, channel, in->anchor);
    struct shaft shaft = { .friction = law.shaft_friction,
                           .viscosity = law.shaft_viscosity,
                           .stiffness = law.shaft_stiffness,
                           .inside = dpti_channel_inside(channel, in->anchor),
                           .anchor = in->anchor,
                           .last = in->last };
    if (!(shaft.stiffness > 0.0))
        shaft.stiffness = max_of(law.shaft_friction, 1.0) / SHAFT_STRETCH;
    return shaft;
}

/* What acts along the line of a tool's channels. */
static struct balance balance_of(const struct proxy_tick *tick, const struct insertion *insertion, double dt)
{
    const struct dpt_world *world = tick->world;
    const struct channel_line host = dpti_channel_line(world, channel_in(world, insertion, 0));
    const double stiffness = dpti_stiffness_on(tick->tool, body_in(world, insertion, 0));
    struct balance balance = { .stiffness = stiffness > 0.0 ? stiffness : 1.0,
                               .device = dpti_device_place(world, tick->tool, &host, tick->device.centre),
                               .dt = dt,
                               .count = insertion->count };
    for (uint32_t i = 0; i < insertion->count; i++) {
        const struct channel *channel = channel_in(world, insertion, i);
        const struct body *body = body_in(world, insertion, i);
        const struct channel_line line = dpti_channel_line(world, channel);
        balance.parts[i] =
            (struct balance_part){ .shaft = shaft_of(world, body, channel, &insertion->in[i]),
                                   .offset = i ? dpti_channel_offset(&host, &line) : 0.0,
                                   .uncut = dpti_channel_uncut(channel),
                                   .cutting = cutting_force(dpti_cutting_law(world, body, channel), channel->radius) };
    }
    return balance;
}

/* The place before the next wall of any channel, and that channel's number. */
static double stop_of(const struct proxy_tick *tick, const struct insertion *insertion, const struct balance *balance,
                      uint32_t *number)
{
    double least = HUGE_VAL;
    for (uint32_t i = 0; i < insertion->count; i++) {
        const double stop =
            dpti_channel_stop(channel_in(tick->world, insertion, i), tick->clearance) - balance->parts[i].offset;
        if (stop < least) {
            least = stop;
            *number = i;
        }
    }
    return least;
}

/*
 * Whether the tool has its gap at a pose on its way, or that which it had: bodies that moved may have left it less.
 * *beside: what is nearest there.
 */
static int has_room(struct proxy_tick *tick, const struct proxy_pose *pose, struct beside *beside)
{
    *beside = dpti_beside(tick->world, tick->tool, &pose->frame, tick->clearance);
    if (beside->gap >= tick->min_gap)
        return 1;
    const double had = dpti_beside(tick->world, tick->tool, &tick->at.frame, tick->clearance).gap;
    return had > 0.0 && beside->gap >= had;
}

/*
 * Go along the line towards a place, past all bodies in whose channels the tool is not. Returns where it came, and notes
 * which body stopped it. Where a budget did, it waits.
 */
static double go_along(struct proxy_tick *tick, const struct channel_line *line, double from, double to)
{
    struct insertion *insertion = insertion_of(tick->world, tick->tool);
    const struct quaternion turn = tick->at.turn;
    const struct proxy_pose goal = dpti_pose_on_line(tick->world, tick->tool, line, to, turn);
    if (to == from)
        return from;
    const struct tool_sweep sweep = dpti_proxy_sweep(tick, &goal);
    struct beside beside = { .gap = HUGE_VAL };
    double share = sweep.time, place = from;
    tick->is_waiting = sweep.status == SWEEP_UNFINISHED;
    for (int k = 0; k < SHORTEN_MAX && share > 0.0; k++) {
        if (k > 0 || sweep.status == SWEEP_HIT)
            share *= k < SHORTEN_LITTLE ? SHORTER_LITTLE : SHORTER;
        const struct proxy_pose at = dpti_pose_on_line(tick->world, tick->tool, line, from + share * (to - from), turn);
        struct beside there;
        if (has_room(tick, &at, &there)) {
            tick->at = at;
            place = from + share * (to - from);
            break;
        }
        beside = there;
        tick->is_waiting |= !(there.gap > -HUGE_VAL);
    }
    /* The shortest way is swept with all work of the tick. */
    tick->proxy->trust = tick->is_waiting && place == from ? tick->clearance : HUGE_VAL;
    tick->tool->has_changed |= (uint32_t)tick->is_waiting;
    if (tick->is_waiting)
        return place;
    insertion->stopped_by = sweep.status == SWEEP_HIT ? sweep.body_id : beside.body_id;
    insertion->stopped_at = sweep.status == SWEEP_HIT ? sweep.triangle : beside.triangle;
    return place;
}

/* The tip has come to a place: what friction and cutting took there. `cutting`: of all channels, N. */
static void note_forces(const struct dpt_world *world, struct insertion *insertion, struct balance *balance,
                        double place, double cutting)
{
    insertion->energy = 0.0;
    for (uint32_t i = 0; i < insertion->count; i++) {
        struct balance_part *part = &balance->parts[i];
        struct inserted *in = &insertion->in[i];
        const double at = place + part->offset;
        in->friction = shaft_resistance(&part->shaft, at, balance->dt);
        in->tip = at >= part->uncut - SAME_PLACE ? min_of(part->cutting, cutting) : 0.0;
        cutting -= in->tip;
        shaft_follow(&part->shaft, at);
        in->anchor = part->shaft.anchor;
        part->shaft.inside = dpti_channel_inside(channel_in(world, insertion, i), in->anchor);
        in->place = in->last = at;
        insertion->energy += shaft_energy(&part->shaft, at);
    }
}

/* A wall stops the tip, which pushes it with insertion->push. */
static void push_wall(struct proxy_tick *tick, struct insertion *insertion, uint32_t number)
{
    struct channel *channel = channel_in(tick->world, insertion, number);
    const struct body *body = body_in(tick->world, insertion, number);
    const double stiffness = dpti_stiffness_on(tick->tool, body_in(tick->world, insertion, 0));
    insertion->in[number].tip = insertion->push;
    if (channel->open_count == channel->wall_count ||
        channel->walls[channel->open_count].from - tick->clearance > channel->limit || !(tick->tool->stiffness > 0.0))
        return;
    const struct pierce_law *law = region_law(tick->world, body, channel->walls[channel->open_count].region);
    if (!pierce_law_is_any(law) || !(insertion->push >= rupture_force(law, channel->radius, stiffness)))
        return;
    channel->open_count++;
    insertion->is_dropping = 1;
    insertion->push = 0.0; /* It opens no other wall. */
    tick->proxy->flags |= DPT_FORCE_FLAG_RUPTURE;
}

/* Leave the channels from which the tip has come out. */
static void leave_channels(struct proxy_tick *tick, struct insertion *insertion)
{
    for (uint32_t i = insertion->count; i-- > 0;)
        if (insertion->in[i].place <= dpti_channel_way_out(tick, channel_in(tick->world, insertion, i)) + SAME_PLACE)
            dpti_insertion_drop(insertion, i);
    if (!insertion->count)
        dpti_patches_forget(tick->world, tick->tool);
}

/*
 * J: of the other bodies on the tool, half of what their forces do now: once with those of the last tick, and once with
 * those of this one. The host does the rest.
 */
static double half_of_others_work(const struct insertion *insertion)
{
    double sum = 0.0;
    for (uint32_t i = 1; i < insertion->count; i++)
        sum += 0.5 * insertion->in[i].slid * (insertion->in[i].friction + insertion->in[i].tip);
    return sum;
}

/* m: how far along the line a body that moved has moved its point at the tip. */
static double moved_along(const struct proxy_tick *tick, const struct body *body, uint32_t triangle,
                          const struct channel_line *line)
{
    const vec3 tip = frame_to_world(&tick->at.frame, dpti_tip_point(tick->world, tick->tool));
    return body_has_moved(tick->world, body) ? dot(dpti_body_carried(tick->world, body, triangle, tip), line->axis)
                                             : 0.0;
}

/* J: half of what the push on the body that stops the tip does, by that body's motion against the host's. */
static double half_of_stop_work(const struct proxy_tick *tick, const struct channel_line *line)
{
    const struct dpt_world *world = tick->world;
    const struct insertion *insertion = insertion_of(world, tick->tool);
    const struct body *body = insertion->stopped_by ? world_find_body(world, insertion->stopped_by) : NULL;
    if (!body || !(world_body_motion(world) > 0.0))
        return 0.0;
    const double moved = moved_along(tick, body, insertion->stopped_at, line);
    const struct channel *host = channel_in(world, insertion, 0);
    return -0.5 * insertion->push * (moved - moved_along(tick, body_in(world, insertion, 0), host->triangle, line));
}

static void go_to_balance(struct proxy_tick *tick, const struct channel_line *line, double allowed, double dt)
{
    struct insertion *insertion = insertion_of(tick->world, tick->tool);
    struct balance balance = balance_of(tick, insertion, dt);
    const double from = insertion->in[0].place;
    uint32_t stopping = 0;
    double cutting, low = HUGE_VAL;
    const double wanted = dpti_balance_solve(&balance, &cutting);
    const double stop = stop_of(tick, insertion, &balance, &stopping);
    for (uint32_t i = 0; i < insertion->count; i++)
        low = min_of(low, dpti_channel_way_out(tick, channel_in(tick->world, insertion, i)) - balance.parts[i].offset);
    const double goal = max_of(min_of(wanted, stop), min_of(low, stop));
    const double to = min_of(max_of(goal, from - allowed), from + allowed);
    const double place = go_along(tick, line, from, min_of(to, stop));
    const int is_limited = fabs(goal - to) > SAME_PLACE && fabs(place - to) <= SAME_PLACE;
    tick->proxy->lag = is_limited ? fabs(goal - to) : 0.0;
    tick->proxy->last_motion = fabs(place - from);
    insertion->others_work += half_of_others_work(insertion);
    note_forces(tick->world, insertion, &balance, place, cutting);
    insertion->others_work += half_of_others_work(insertion);
    for (uint32_t i = 0; i < insertion->count; i++) {
        struct channel *channel = channel_in(tick->world, insertion, i);
        channel->deepest = max_of(channel->deepest, insertion->in[i].place);
    }
    if (insertion->is_dropping)
        tick->proxy->flags |= DPT_FORCE_FLAG_RUPTURE;
    insertion->is_dropping = insertion->is_dropping && (is_limited || tick->is_waiting);
    insertion->push = 0.0;
    if (wanted > place && !is_limited && !tick->is_waiting)
        insertion->push =
            max_of(0.0, balance.stiffness * (balance.device - place) - dpti_balance_friction(&balance, place));
    if (place >= stop - SAME_PLACE && !insertion->stopped_by && !tick->is_waiting)
        push_wall(tick, insertion, stopping);
    insertion->others_work += half_of_stop_work(tick, line);
    leave_channels(tick, insertion);
}

/*
 * Beside bodies that give way: where the last step with tissue has led the tool. Without such a step, with the points of its
 * channels, and then along them as beside rigid bodies.
 */
static void follow_tissue(struct proxy_tick *tick, double allowed, double dt)
{
    struct insertion *insertion = insertion_of(tick->world, tick->tool);
    const int is_ended = tick->has_end;
    memset(&insertion->carried, 0, sizeof insertion->carried);
    insertion->others_work = 0.0;
    insertion->stopped_by = 0;
    tick->has_end = 0;
    if (!dpti_proxy_go_with_tissue(tick, is_ended)) {
        lose_channels(tick);
        return;
    }
    dpti_tissue_channels_update(tick, allowed);
    const struct channel_line line = dpti_channel_line(tick->world, channel_in(tick->world, insertion, 0));
    enter_holes(tick, &line);
    tick->device = dpti_proxy_device_in_channel(tick->tool, tick->proxy, tick->at.turn);
    tick->proxy->lag = 0.0;
    if (is_ended) {
        dpti_tissue_channels_rupture(tick);
        leave_channels(tick, insertion);
    } else {
        go_to_balance(tick, &line, allowed, dt);
        dpti_tissue_channels_balanced(tick, allowed);
    }
    dpti_proxy_find_nearest(tick);
    tick->proxy->owed = 0.0;
    tick->proxy->flags |= DPT_FORCE_FLAG_INSERTED;
}

void dpti_proxy_follow_channel(struct proxy_tick *tick, double allowed, double dt)
{
    const struct dpt_world *world = tick->world;
    struct insertion *insertion = insertion_of(world, tick->tool);
    tick->is_lost = 1;
    if (!is_undoubted(tick)) {
        lose_channels(tick);
        return;
    }
    if (tick->has_end || dpti_is_inserted_in_tissue(world, tick->tool)) {
        follow_tissue(tick, allowed, dt);
        return;
    }
    if (!carry_with_host(tick)) {
        lose_channels(tick);
        return;
    }
    const struct channel_line line = dpti_channel_line(world, channel_in(world, insertion, 0));
    if (!follow_others(tick, &line)) {
        lose_channels(tick);
        return;
    }
    insertion->others_work = half_of_stop_work(tick, &line);
    insertion->stopped_by = 0;
    enter_holes(tick, &line);
    tick->device = dpti_proxy_device_in_channel(tick->tool, tick->proxy, tick->at.turn);
    go_to_balance(tick, &line, allowed, dt);
    if (world->deform_count)
        dpti_tissue_channels_balanced(tick, allowed);
    dpti_proxy_find_nearest(tick);
    tick->proxy->owed = 0.0;
    tick->proxy->flags |= DPT_FORCE_FLAG_INSERTED;
}

/*
 * Whether the tool, its tip at a hole, comes nearer to the device by going in as far as it may; and what is felt
 * changes by no more than `allowed` on the way to the mouth. *rest: what is left of that for the way in.
 */
static int is_worth_entering(struct proxy_tick *tick, const struct channel *channel, const struct channel_line *line,
                             const struct proxy_pose *mouth, double allowed, double dt, double *rest)
{
    const double mouth_place = dpti_channel_mouth_place(tick, channel);
    struct insertion trial = { .count = 1 };
    const struct coupling *coupling = &tick->proxy->coupling;
    const struct proxy_pose device = tick->device;
    const struct displacement now = dpti_proxy_displacement(tick->proxy, &device, &tick->at);
    double cutting;
    trial.in[0].channel = (uint32_t)(channel - tick->world->channels);
    trial.in[0].anchor = trial.in[0].last = mouth_place;
    tick->device = dpti_proxy_device_in_channel(tick->tool, tick->proxy, mouth->turn);
    const struct displacement there = dpti_proxy_displacement(tick->proxy, &tick->device, mouth);
    const struct displacement changed = displacement_sum(&there, -1.0, &now);
    const struct balance balance = balance_of(tick, &trial, dt);
    *rest = allowed - displacement_norm(coupling, &changed);
    const double place = min_of(min_of(dpti_balance_solve(&balance, &cutting), mouth_place + *rest),
                                dpti_channel_stop(channel, tick->clearance));
    const struct proxy_pose to =
        dpti_pose_on_line(tick->world, tick->tool, line, max_of(place, mouth_place), mouth->turn);
    const struct displacement then = dpti_proxy_displacement(tick->proxy, &tick->device, &to);
    tick->device = device;
    return *rest > 0.0 && place > mouth_place && displacement_norm(coupling, &then) < displacement_norm(coupling, &now);
}

/* Go to the mouth of a hole, and in. */
static int enter(struct proxy_tick *tick, struct channel *channel, double allowed, double dt)
{
    if (dpti_channel_body(tick->world, channel)->surface.motion && !dpti_tissue_hole_find(tick, channel))
        return 0;
    const double mouth_place = dpti_channel_mouth_place(tick, channel);
    const struct channel_line line = dpti_channel_line(tick->world, channel);
    if (!dpti_is_at_mouth(tick, channel, &line))
        return 0;
    const struct proxy_pose from = tick->at;
    const struct quaternion turn = dpti_turn_along(tick->world, tick->tool, &line, from.turn);
    const struct proxy_pose mouth = dpti_pose_on_line(tick->world, tick->tool, &line, mouth_place, turn);
    double met, rest;
    if (!is_worth_entering(tick, channel, &line, &mouth, allowed, dt, &rest))
        return 0;
    if (dpti_proxy_move(tick, &mouth, &met) < 1.0) {
        tick->at = from;
        dpti_proxy_find_nearest(tick);
        return 0;
    }
    dpti_insertion_add(tick->world, tick->tool, channel, mouth_place);
    tick->has_end = 0;
    dpti_patches_forget(tick->world, tick->tool);
    dpti_proxy_forget_triangles(tick->proxy, channel->body_id);
    tick->proxy->is_behind |= dpti_channel_body(tick->world, channel)->stiffness > 0.0;
    dpti_proxy_follow_channel(tick, rest, dt);
    return 1;
}

int dpti_proxy_enter_channel(struct proxy_tick *tick, double allowed, double dt)
{
    const struct dpt_world *world = tick->world;
    if (!tick->tool->piercing || tick->tool->is_free || tick->proxy->state != PROXY_OUTSIDE || tick->is_before ||
        tick->is_waiting)
        return 0;
    for (uint32_t i = 0; i < world->def.max_channels; i++) {
        struct channel *channel = &world->channels[i];
        if (channel->body_id && world_find_tool(world, channel->tool_id) == tick->tool &&
            enter(tick, channel, allowed, dt))
            return 1;
    }
    return 0;
}

/* Note where each channel's body is pushed: along the line by what it takes, and all else by the host. */
static void note_loads(struct proxy_tick *tick, vec3 force)
{
    struct dpt_world *world = tick->world;
    const struct insertion *insertion = insertion_of(world, tick->tool);
    const struct channel_line line = dpti_channel_line(world, channel_in(world, insertion, 0));
    const vec3 tip = frame_to_world(&tick->at.frame, dpti_tip_point(world, tick->tool));
    struct tool_push push = { .normal = scaled(line.axis, -1.0), .is_narrow = 1 };
    vec3 rest = force;
    if (insertion->stopped_by) {
        push.body_id = insertion->stopped_by;
        push.triangle = insertion->stopped_at;
        push.at = along(tip, world->segments[tick->tool->first_segment].radius, line.axis);
        push.force = scaled(line.axis, insertion->push);
        rest = sub(rest, push.force);
        dpti_loads_note_push(world, tick->tool, &push);
    }
    for (uint32_t i = insertion->count; i-- > 0;) {
        const struct inserted *in = &insertion->in[i];
        const struct channel *channel = channel_in(world, insertion, i);
        push.body_id = channel->body_id;
        push.triangle = channel->triangle;
        push.at = along(tip, -0.5 * min_of(dpti_channel_inside(channel, in->place), in->place), line.axis);
        push.force = i ? scaled(line.axis, in->friction + in->tip) : rest;
        rest = sub(rest, push.force);
        dpti_loads_note_push(world, tick->tool, &push);
    }
}

void dpti_proxy_feel_channel(struct proxy_tick *tick)
{
    struct proxy *proxy = tick->proxy;
    const struct dpt_world *world = tick->world;
    const struct insertion *insertion = insertion_of(world, tick->tool);
    const struct body *host = body_in(world, insertion, 0);
    const struct channel_line line = dpti_channel_line(world, channel_in(world, insertion, 0));
    const double k = tick->tool->stiffness;
    const struct displacement away = dpti_proxy_displacement(proxy, &tick->device, &tick->at);
    const struct displacement pulled = dpti_proxy_pulled(&away);
    const int gives_way = dpti_is_inserted_in_tissue(world, tick->tool);
    const double yielded =
        host->stiffness > 0.0 && !gives_way ? dot(pulled.shift, line.axis) * (k / (k + host->stiffness)) : 0.0;
    memset(&proxy->yielded, 0, sizeof proxy->yielded);
    proxy->yielded.shift = scaled(line.axis, yielded);
    proxy->yielded_energy = 0.5 * host->stiffness * yielded * yielded + insertion->energy;
    const struct displacement felt = displacement_sum(&pulled, -1.0, &proxy->yielded);
    const struct displacement mean = displacement_sum(&felt, 1.0, &proxy->felt);
    proxy->body_work =
        0.5 * k * displacement_dot(&proxy->coupling, &mean, &insertion->carried) + insertion->others_work;
    if (k > 0.0 && proxy->state == PROXY_OUTSIDE)
        note_loads(tick, scaled(felt.shift, -k));
}
