/* SPDX-License-Identifier: BSD-3-Clause */
#include "proxy/body_work.h"

#include "proxy/proxy_constraints.h"
#include "proxy/proxy_friction.h"

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

static vec3 turned(const struct body *body)
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
        sum += contact->torsion * dot(vec3_of(contact->normal), turned(body));
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
    const struct displacement now = displacement_sum(&left, 1.0, &proxy->yielded);
    if (!dpti_proxy_solve_held(tick, wanted))
        return 0.0;
    /* Of a proxy that waits, the contacts hold but a part of the way. */
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

double dpti_segment_body_work(const struct dpt_world *world, const struct segment *segment, vec3 origin,
                              const dpt_wrench *last, const dpt_wrench *now)
{
    const struct body *body =
        segment->pushing_part.body_id ? world_find_body(world, segment->pushing_part.body_id) : NULL;
    if (!body || !body_has_moved(world, body))
        return 0.0;
    const vec3 force = add(vec3_of(last->force), vec3_of(now->force));
    if (surface_has_moved(&body->surface, world->ticks))
        return 0.5 *
               dot(force, dpti_body_carried(world, body, segment->pushing_part.triangle, segment->felt_penetration.at));
    const vec3 torque = add(vec3_of(last->torque), vec3_of(now->torque));
    return 0.5 * (dot(force, dpti_body_carried(world, body, 0, origin)) + dot(torque, turned(body)));
}
