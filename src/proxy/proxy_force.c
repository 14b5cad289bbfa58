/* SPDX-License-Identifier: BSD-3-Clause */
#include "proxy/proxy_force.h"

#include "base/wrench_limit.h"
#include "force/friction.h"
#include "force/yield.h"
#include "proxy/proxy.h"
#include "proxy/proxy_constraints.h"
#include "proxy/proxy_friction.h"

static const struct displacement none = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.0 }, 0.0 };

static const struct body *body_of(const struct proxy_tick *tick, uint32_t space)
{
    return world_find_body(tick->world, tick->triangles[tick->sources[space].triangle].body_id);
}

/* Whether a body that may hold the proxy has a stiffness of its own. */
static int may_yield(const struct proxy_tick *tick)
{
    for (uint32_t i = 0; i < PROXY_MEMORY; i++) {
        const uint32_t id = tick->proxy->memory[i].body_id;
        const struct body *body = id ? world_find_body(tick->world, id) : NULL;
        if (body && body->stiffness > 0.0)
            return 1;
    }
    return 0;
}

/* The largest compliance that counts: so soft a surface gives no force. */
#define COMPLIANCE_MAX 1e30

/* Two constraints of unit normals whose cosine is below this hold the tool at different places. */
#define ALIKE 0.9

/*
 * How many of the active constraints are the same contact as one of them, itself included. A tool that rests where flat
 * triangles meet is held by several, and the surface yields there once.
 */
static double share_of_contact(const struct proxy_tick *tick, uint32_t i)
{
    const uint32_t n = proxy_unknowns(tick->proxy);
    const double *own = tick->spaces[tick->solved.active[i]].normal;
    double sum = 1.0;
    for (uint32_t k = 0; k < tick->solved.active_count; k++) {
        const double *other = tick->spaces[tick->solved.active[k]].normal;
        if (k == i || body_of(tick, tick->solved.active[k]) != body_of(tick, tick->solved.active[i]))
            continue;
        const double cosine = product_of(own, other, n) / (norm_of(own, n) * norm_of(other, n));
        if (cosine > ALIKE)
            sum += (min_of(cosine, 1.0) - ALIKE) / (1.0 - ALIKE);
    }
    return sum;
}

/* What friction pulls with is reduced as the normal force that it depends on. */
static void yield_pulls(const struct proxy_tick *tick, const double *share, double *yielded)
{
    for (uint32_t i = 0; i < tick->contact_count; i++)
        for (uint32_t k = 0; k < tick->solved.active_count; k++)
            if (tick->solved.active[k] == tick->contact_spaces[i])
                dpti_friction_add(&tick->contacts[i], 1.0 - share[k], yielded);
}

void dpti_proxy_yield(struct proxy_tick *tick)
{
    struct proxy *proxy = tick->proxy;
    const uint32_t n = proxy_unknowns(proxy);
    const double k = tick->tool->stiffness;
    double wanted[HALF_SPACE_DIMENSIONS], yielded[HALF_SPACE_DIMENSIONS] = { 0.0 };
    double compliance[HALF_SPACE_DIMENSIONS], share[HALF_SPACE_DIMENSIONS];
    proxy->yielded = none;
    proxy->yielded_energy = 0.0;
    if (!(k > 0.0) || !may_yield(tick))
        return;
    if (!dpti_proxy_solve_held(tick, wanted))
        return;
    for (uint32_t i = 0; i < tick->solved.active_count; i++) {
        const double stiffness = body_of(tick, tick->solved.active[i])->stiffness;
        compliance[i] = stiffness > 0.0 ? min_of(k / stiffness * share_of_contact(tick, i), COMPLIANCE_MAX) : 0.0;
    }
    const double stored = dpti_yield(tick->spaces, &tick->solved, n, compliance, share, yielded);
    yield_pulls(tick, share, yielded);
    proxy->yielded_energy = k * stored;
    proxy->yielded = dpti_proxy_of_unknowns(proxy, tick->axes, yielded);
}

void dpti_proxy_wait(struct proxy_tick *tick)
{
    struct proxy *proxy = tick->proxy;
    const uint32_t n = proxy_unknowns(proxy);
    double wanted[HALF_SPACE_DIMENSIONS] = { 0.0 };
    const int is_solved = dpti_proxy_solve_held(tick, wanted);
    const double *left = is_solved ? tick->solved.y : wanted;
    const double size = norm_of(left, n);
    if (size < PROXY_MOTION_SMALL * tick->clearance || size < PROXY_CONVERGED * norm_of(wanted, n))
        return;
    const struct displacement remaining = dpti_proxy_of_unknowns(proxy, tick->axes, left);
    proxy->yielded = displacement_sum(&proxy->yielded, -1.0, &remaining);
    proxy->lag = size;
    proxy->flags |= DPT_FORCE_FLAG_BEHIND;
    proxy->is_behind = 1;
}

void dpti_proxy_end_force(struct proxy *proxy)
{
    proxy->is_behind = 0;
    proxy->felt = none;
    memset(&proxy->fade, 0, sizeof proxy->fade);
}

/* Whether the proxy has reached its device after it waited, and more is still felt than may end in one tick. */
static int is_pulled_back(const struct proxy *proxy)
{
    return proxy->is_behind && displacement_norm(&proxy->coupling, &proxy->felt) > proxy->pace;
}

/*
 * What is felt of a proxy that waits, or has waited, changes no faster than of one that does not. While it has far to
 * go, it is not known which surfaces will hold it in the end, and what is felt does not grow.
 */
static struct displacement in_pace(struct proxy *proxy, const struct displacement *felt)
{
    const struct coupling *coupling = &proxy->coupling;
    const int is_waiting = (proxy->flags & DPT_FORCE_FLAG_BEHIND) != 0;
    const double now = displacement_norm(coupling, felt);
    const double last = displacement_norm(coupling, &proxy->felt);
    if (!proxy->is_behind)
        return *felt;
    const int is_far = proxy->lag > proxy->pace && now > last;
    const double share = is_far ? last / now : 1.0;
    const struct displacement goal = displacement_sum(&none, share, felt);
    const struct displacement grown = displacement_sum(&goal, -1.0, &proxy->felt);
    const double size = displacement_norm(coupling, &grown);
    proxy->is_behind = is_waiting || is_far || size > proxy->pace;
    if (proxy->is_behind)
        proxy->flags |= DPT_FORCE_FLAG_BEHIND;
    if (!(size > proxy->pace))
        return goal;
    return displacement_sum(&proxy->felt, proxy->pace / size, &grown);
}

static uint32_t reason_of(const struct tool *tool, const struct proxy *proxy)
{
    if (tool->stiffness == 0.0)
        return DPT_FORCE_OFF;
    if (proxy->state == PROXY_DOUBTED)
        return DPT_FORCE_UNDECIDED;
    if (proxy->state != PROXY_OUTSIDE)
        return DPT_FORCE_INSIDE;
    return proxy->is_held || is_pulled_back(proxy) ? DPT_FORCE_ACTS : DPT_FORCE_FREE;
}

/*
 * A locked tool's turn is held by a very large stiffness, so a tiny turn on the way from a fold would give a huge
 * torque. Its torque is limited to what its force could give anywhere on the tool.
 */
static void limit_torque(const struct tool *tool, const struct proxy *proxy, vec3 centre, vec3 origin,
                         dpt_wrench *wrench)
{
    const vec3 force = vec3_of(wrench->force), from_origin = cross(sub(centre, origin), force);
    const vec3 torque = sub(vec3_of(wrench->torque), from_origin);
    const double max_torque = length(force) * proxy->extent, size = length(torque);
    if (tool->lock_rotation && size > max_torque)
        vec3_store(along(from_origin, max_torque / size, torque), wrench->torque);
}

/* 1 + the cosine of two axes that are nearly opposite: there the spin between them is not defined. */
#define OPPOSITE 0.1

/* The spring and the damper. */
static dpt_wrench wrench_of(struct tool *tool, struct proxy *proxy, double dt)
{
    const struct proxy_pose at = dpti_proxy_pose_of(proxy, &proxy->pose);
    const struct proxy_pose device = proxy->flags & DPT_FORCE_FLAG_INSERTED
                                         ? dpti_proxy_device_in_channel(tool, proxy, at.turn)
                                         : dpti_proxy_pose_of(proxy, &tool->pose);
    const struct displacement away = dpti_proxy_displacement(proxy, &device, &at);
    const struct displacement pulled = dpti_proxy_pulled(&away);
    const struct displacement goal = displacement_sum(&pulled, -1.0, &proxy->yielded);
    const struct displacement felt = in_pace(proxy, &goal);
    vec3 spin_axis = { 0.0, 0.0, 0.0 };
    dpt_wrench wrench;
    if (proxy->coupling.spin_rho > 0.0)
        spin_axis = scaled(add(device.axis, at.axis), 1.0 / max_of(1.0 + dot(device.axis, at.axis), OPPOSITE));
    if (tool->damping > 0.0) {
        const struct displacement damped =
            coupling_damped(&proxy->coupling, &felt, &proxy->felt, tool->damping / tool->stiffness, dt);
        wrench = coupling_wrench(&proxy->coupling, &damped, spin_axis, device.centre, device.frame.origin);
    }
    /* A damper whose force is no finite number is left out. */
    if (!(tool->damping > 0.0) || !wrench_is_finite(&wrench))
        wrench = coupling_wrench(&proxy->coupling, &felt, spin_axis, device.centre, device.frame.origin);
    limit_torque(tool, proxy, device.centre, device.frame.origin, &wrench);
    const double rotational = proxy->coupling.stiffness * proxy->coupling.rho * proxy->coupling.rho;
    tool->energy =
        coupling_energy(&proxy->coupling, &felt) + proxy->yielded_energy + rotational * dpti_proxy_stored_beyond(&away);
    proxy->felt = felt;
    return wrench;
}

/* m: from the tool's origin to its centre, at a pose of the device. */
static vec3 lever_at(const struct proxy *proxy, const dpt_pose *pose)
{
    const struct proxy_pose device = dpti_proxy_pose_of(proxy, pose);
    return sub(device.centre, device.frame.origin);
}

/*
 * A fade takes so long that what is felt changes by no more than in a fold (proxy->pace). What fades is about the centre:
 * a turn of the device does not change it.
 */
static void fade_in_pace(const struct tool *tool, struct proxy *proxy, const dpt_wrench *truth, double dt)
{
    struct fade *fade = &proxy->fade;
    const double rho = proxy->coupling.rho, limit = proxy->coupling.stiffness * proxy->pace;
    if (!(fade->time_left > 0.0) || !(limit > 0.0))
        return;
    const vec3 lever = lever_at(proxy, &tool->pose);
    const vec3 force = vec3_of(fade->felt.force);
    const vec3 turned = cross(sub(lever, lever_at(proxy, &proxy->last_device_pose)), force);
    vec3_store(add(vec3_of(fade->felt.torque), turned), fade->felt.torque);
    const vec3 way = sub(vec3_of(truth->force), force);
    const vec3 turn = sub(sub(vec3_of(truth->torque), vec3_of(fade->felt.torque)), cross(lever, way));
    const double size = sqrt(dot(way, way) + (rho > 0.0 ? dot(turn, turn) / (rho * rho) : 0.0));
    fade->time_left = max_of(fade->time_left, dt * size / limit);
}

void dpti_proxy_respond(struct dpt_world *world, struct tool *tool, double dt)
{
    struct proxy *proxy = proxy_of(world, tool);
    struct fade *fade = &proxy->fade;
    dpt_wrench truth = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.0 } };
    const uint32_t last_reason = proxy->reason;
    tool->energy = tool->body_work = 0.0;
    tool->force_reason = proxy->reason = reason_of(tool, proxy);
    if (proxy->reason == DPT_FORCE_ACTS) {
        truth = wrench_of(tool, proxy, dt);
        tool->body_work = proxy->body_work;
    } else {
        proxy->felt = none;
        proxy->is_behind = (proxy->flags & DPT_FORCE_FLAG_BEHIND) != 0;
    }
    if ((proxy->reason == DPT_FORCE_UNDECIDED || proxy->reason == DPT_FORCE_INSIDE) && last_reason == DPT_FORCE_ACTS)
        fade->time_left = world->def.fade;
    if (proxy->reason == DPT_FORCE_OFF)
        fade->time_left = 0.0;
    fade_in_pace(tool, proxy, &truth, dt);
    fade_step(fade, &truth, dt);
    tool->wrench = fade->felt;
    tool->force_flags = proxy->flags | (fade->time_left > 0.0 ? DPT_FORCE_FLAG_FADING : 0u);
}

/* How far vertices moved the point of a triangle that is nearest to x now, in the body's frame. */
static vec3 moved_by_vertices(const struct surface *surface, uint32_t tick, uint32_t triangle, vec3 x)
{
    const struct surface last = surface_view(surface, tick, 0.0);
    pair nearest;
    dpti_triangle_point_pair(surface, triangle, x, &nearest);
    return sub(surface_point(surface, triangle, nearest.weight), surface_point(&last, triangle, nearest.weight));
}

vec3 dpti_body_carried(const struct dpt_world *world, const struct body *body, uint32_t triangle, vec3 at)
{
    struct frame before;
    vec3 local = frame_to_local(&body->frame, at);
    frame_of_pose(&body->previous_pose, &before);
    if (surface_has_moved(&body->surface, world->ticks))
        local = sub(local, moved_by_vertices(&body->surface, world->ticks, triangle, local));
    return sub(at, frame_to_world(&before, local));
}

vec3 dpti_body_turned(const struct body *body)
{
    return quaternion_rotation_vector(quaternion_product(
        quaternion_of(body->pose.orientation), quaternion_inverse(quaternion_of(body->previous_pose.orientation))));
}

/* The body of a constraint, if it moved before this tick, else NULL. */
static const struct body *moved_body(const struct proxy_tick *tick, uint32_t space)
{
    const struct body *body = world_find_body(tick->world, tick->triangles[tick->sources[space].triangle].body_id);
    return body && body_has_moved(tick->world, body) ? body : NULL;
}

/* m: how far the body moved what the tool touches. */
static vec3 carried(const struct proxy_tick *tick, uint32_t space, const struct body *body)
{
    return dpti_body_carried(tick->world, body, tick->triangles[tick->sources[space].triangle].triangle,
                             proxy_touch_of(tick, space));
}

/* m^2: work by unit of stiffness, of the normal forces and of friction. */
static double work_of_contacts(const struct proxy_tick *tick)
{
    double sum = 0.0;
    for (uint32_t k = 0; k < tick->solved.active_count; k++) {
        const uint32_t space = tick->solved.active[k];
        const struct body *body = moved_body(tick, space);
        if (body)
            sum += tick->solved.multiplier[k] * dot(vec3_of(tick->spaces[space].normal), carried(tick, space, body));
    }
    for (uint32_t i = 0; i < tick->contact_count; i++) {
        const struct friction_contact *contact = &tick->contacts[i];
        const struct body *body = moved_body(tick, tick->contact_spaces[i]);
        if (!body)
            continue;
        const vec3 moved = carried(tick, tick->contact_spaces[i], body);
        for (int d = 0; d < 2; d++)
            sum += contact->pull[d] * dot(vec3_of(contact->across[d]), moved);
        sum += contact->torsion * dot(vec3_of(contact->normal), dpti_body_turned(body));
    }
    return sum;
}

double dpti_proxy_body_work(struct proxy_tick *tick)
{
    const struct proxy *proxy = tick->proxy;
    double wanted[HALF_SPACE_DIMENSIONS];
    if (!(tick->tool->stiffness > 0.0) || !(world_body_motion(tick->world) > 0.0) || proxy->state != PROXY_OUTSIDE)
        return 0.0;
    const struct displacement left = dpti_proxy_displacement(proxy, &tick->at, &tick->goal);
    const struct displacement pulled = dpti_proxy_pulled(&left);
    const struct displacement now = displacement_sum(&pulled, 1.0, &proxy->yielded);
    if (!dpti_proxy_solve_held(tick, wanted))
        return 0.0;
    /* Of a proxy that waits, contacts hold only a part of the displacement. */
    for (uint32_t k = 0; k < proxy_unknowns(proxy) && proxy->is_behind; k++)
        wanted[k] -= tick->solved.y[k];
    const double size = norm_of(wanted, proxy_unknowns(proxy));
    if (!(size > 0.0))
        return 0.0;
    /* The mean of this tick's force and the last one's. */
    const double mean =
        0.5 * (displacement_norm(&proxy->coupling, &now) + displacement_norm(&proxy->coupling, &proxy->felt)) / size;
    return mean * tick->tool->stiffness * work_of_contacts(tick);
}
