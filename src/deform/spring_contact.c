/* SPDX-License-Identifier: BSD-3-Clause */
#include "deform/spring_contact.h"

#include "deform/active_region.h"
#include "deform/spring_step.h"

static vec3 node_row(const float *rows, uint32_t lane)
{
    return (vec3){ (double)rows[lane], (double)rows[LANES + lane], (double)rows[2 * LANES + lane] };
}

static void put_row(float *rows, uint32_t lane, vec3 to)
{
    rows[lane] = (float)to.x;
    rows[LANES + lane] = (float)to.y;
    rows[2 * LANES + lane] = (float)to.z;
}

static struct spring_slice *slice_of(const struct dpt_springs *springs, uint32_t slice)
{
    return springs->state[springs->now] + slice;
}

static vec3 place_of(const struct dpt_springs *springs, uint32_t node)
{
    return node_row(slice_of(springs, node / LANES)->x, node % LANES);
}

/* N: of springs and weight, on a node. */
static vec3 force_on(const struct dpt_springs *springs, uint32_t node)
{
    const struct spring_net *net = &springs->net;
    const uint32_t slice = node / LANES;
    const vec3 at = place_of(springs, node);
    vec3 sum = scaled(vec3_of(springs->def.gravity), (double)net->mass[node]);
    for (uint32_t entry = net->first[slice]; entry < net->first[slice + 1]; entry++) {
        const size_t i = LANES * (size_t)entry + node % LANES;
        const vec3 away = sub(place_of(springs, net->neighbour[i]), at);
        const double rest = (double)net->length[i];
        const double from = max_of(length(away), (double)SPRING_SHORTEST * rest);
        sum = along(sum, springs->def.stiffness * (double)net->stiffness[i] * (1.0 - rest / from), away);
    }
    return sum;
}

void dpti_spring_contact_begin(struct dpt_springs *springs, const struct tool_touch *touch)
{
    struct spring_contact *contact = &springs->contact;
    for (uint32_t slice = 0; slice < springs->net.slices; slice++) {
        if (contact->fixed[slice] && touch->has_moved && !springs->region.is_awake[slice])
            dpti_region_disturb(springs, slice);
        contact->next[slice] = 0;
    }
}

static int is_fixed(const struct dpt_springs *springs, uint32_t node)
{
    return springs->contact.fixed[node / LANES] >> node % LANES & 1;
}

/* What a tool takes of a node's speed against it: the part into it, and of the part along it. */
struct stop {
    vec3 speed, across;
    double into; /* m/s */
};

static struct stop stop_of(const struct dpt_springs *springs, uint32_t node, vec3 normal, vec3 tool_speed)
{
    const struct spring_slice *state = slice_of(springs, node / LANES);
    const vec3 speed = sub(node_row(state->v, node % LANES), tool_speed);
    const double outward = dot(speed, normal);
    return (struct stop){ speed, along(speed, -outward, normal), max_of(-outward, 0.0) };
}

/*
 * On a tool at rest: one step's friction stops the node; or it stands already, and friction holds what pushes it against
 * the tool.
 */
static int is_stuck(const struct dpt_springs *springs, uint32_t node, vec3 normal, const struct tool_touch *touch)
{
    const vec3 still = { 0.0, 0.0, 0.0 };
    const vec3 force = force_on(springs, node);
    const double inward = -dot(force, normal);
    const vec3 across = along(force, inward, normal);
    const struct stop stop = stop_of(springs, node, normal, still);
    return inward > 0.0 && (is_fixed(springs, node) ? length(across) <= touch->static_friction * inward
                                                    : length(stop.across) <= touch->static_friction * stop.into);
}

/* Positions and speeds: of the way along the tool in this step, friction takes the share it takes of the speed. */
static void slide(struct dpt_springs *springs, uint32_t node, vec3 push, vec3 normal, vec3 motion,
                  const struct tool_touch *touch)
{
    struct spring_slice *state = slice_of(springs, node / LANES);
    const uint32_t lane = node % LANES;
    const vec3 tool_speed = scaled(motion, 1.0 / touch->dt);
    const struct stop stop = stop_of(springs, node, normal, tool_speed);
    const double slip = length(stop.across);
    double share = 1.0;
    if (slip > touch->static_friction * stop.into)
        share = min_of(touch->kinetic_friction * stop.into / slip, 1.0);
    const vec3 taken = along(scaled(stop.across, share), -stop.into, normal);
    put_row(state->x, lane, along(add(place_of(springs, node), push), -share * touch->dt, stop.across));
    put_row(state->rest, lane, (vec3){ 0.0, 0.0, 0.0 });
    put_row(state->v, lane, add(tool_speed, sub(stop.speed, taken)));
    springs->contact.moved[node / LANES] = 1;
}

void dpti_spring_contact_hold(struct dpt_springs *springs, uint32_t node, vec3 to, vec3 motion,
                              const struct tool_touch *touch)
{
    const uint32_t slice = node / LANES, lane = node % LANES;
    const uint16_t bit = (uint16_t)(1u << lane);
    struct spring_contact *contact = &springs->contact;
    const vec3 push = sub(to, place_of(springs, node));
    const double depth = length(push);
    springs->vertices.moved[slice] = 1;
    springs->vertices.has_moved = 1;
    if (!(springs->net.mass[node] > 0.0f) || !(depth > 0.0))
        return;
    if (!springs->region.is_awake[slice] && is_fixed(springs, node))
        return;
    const vec3 normal = scaled(push, 1.0 / depth);
    if (!touch->has_moved && is_stuck(springs, node, normal, touch)) {
        contact->next[slice] |= bit;
        put_row(slice_of(springs, slice)->v, lane, (vec3){ 0.0, 0.0, 0.0 });
    } else
        slide(springs, node, push, normal, motion, touch);
}

/* Returns 1 if other nodes of the slice count as fixed now. */
static int set_fixed(struct dpt_springs *springs, uint32_t slice)
{
    struct spring_contact *contact = &springs->contact;
    const uint32_t changed = contact->fixed[slice] ^ contact->next[slice];
    for (uint32_t lane = 0; lane < LANES; lane++) {
        const uint32_t node = LANES * slice + lane;
        if (!(changed >> lane & 1))
            continue;
        const float mass = contact->next[slice] >> lane & 1 ? 0.0f : springs->net.mass[node];
        springs->nodes[slice].per_mass[lane] = mass > 0.0f ? 1.0f / mass : 0.0f;
        if (springs->solve.systems)
            springs->solve.systems[slice].mass[lane] = mass;
    }
    contact->fixed[slice] = contact->next[slice];
    return changed != 0;
}

void dpti_spring_contact_end(struct dpt_springs *springs)
{
    struct spring_contact *contact = &springs->contact;
    int has_moved = 0, has_changed = 0;
    for (uint32_t slice = 0; slice < springs->net.slices; slice++) {
        if (contact->moved[slice]) {
            springs->kernel.spring_points(slice_of(springs, slice), (float)springs->lead,
                                          springs->points[springs->at] + SPRING_POINTS * (size_t)slice);
            if (!springs->region.is_awake[slice])
                dpti_region_disturb(springs, slice);
            contact->moved[slice] = 0;
            has_moved = 1;
        }
        if (springs->region.is_awake[slice])
            has_changed |= set_fixed(springs, slice);
    }
    dpti_region_list(springs);
    if (springs->def.integrator != DPT_INTEGRATOR_IMPLICIT)
        return;
    if (has_changed)
        springs->solve.step = 0.0;
    if (has_moved || has_changed)
        dpti_implicit_forget(springs);
}
