/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/tool_force.h"

#include "proxy/proxy_force.h"

static int is_zero(vec3 v)
{
    return v.x == 0.0 && v.y == 0.0 && v.z == 0.0;
}

void dpti_force_forget(struct segment *segment)
{
    segment->energy = segment->body_work = 0.0;
    segment->fade = (struct fade){ .time_left = 0.0 };
    segment->pushing_part = segment->previous_pushing_part = (struct pushing_part){ .body_id = 0 };
    segment->border.clear_radius = 0.0;
    segment->fading_body_id = 0;
    segment->force_reason = DPT_FORCE_STALE;
}

void dpti_force_forget_body(struct segment *segment, uint32_t body_id)
{
    if (segment->border.body == body_id)
        segment->border.clear_radius = 0.0;
    if ((segment->fade.time_left > 0.0 ? segment->fading_body_id : segment->previous_pushing_part.body_id) == body_id)
        dpti_force_forget(segment);
}

/* DPT_FORCE_... of one segment in this tick. */
static uint32_t reason_of(const struct segment *segment)
{
    const struct penetration *penetration = &segment->felt_penetration;
    if (segment->answer.body && segment->result.contact == DPT_CONTACT_UNKNOWN)
        return DPT_FORCE_UNDECIDED;
    if (!(penetration->depth > 0.0))
        return DPT_FORCE_FREE;
    return is_zero(penetration->direction) ? DPT_FORCE_UNDECIDED : DPT_FORCE_ACTS;
}

/*
 * J, in this tick, of the body that pushes a segment, by its wrench about `origin` in the last tick and in this one. Of
 * a bed over several bodies only the one in which the segment is deepest counts.
 */
static double body_work_of(const struct dpt_world *world, const struct segment *segment, vec3 origin,
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
    return 0.5 * (dot(force, dpti_body_carried(world, body, 0, origin)) + dot(torque, dpti_body_turned(body)));
}

void dpti_force_respond(struct dpt_world *world, uint32_t segment_index, double dt, depth_law *push)
{
    struct segment *segment = &world->segments[segment_index];
    const struct tool *tool = &world->tools[segment->tool_slot];
    if (!tool->slot.valid || world->invalid_body_count || tool->stiffness == 0.0) {
        dpti_force_forget(segment);
        return;
    }
    struct fade *fade = &segment->fade;
    dpt_wrench truth = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.0 } };
    const uint32_t reason = reason_of(segment);
    const int became_undecided = reason == DPT_FORCE_UNDECIDED && segment->force_reason != DPT_FORCE_UNDECIDED;
    const int was_felt = !is_zero(vec3_of(fade->felt.force)) || !is_zero(vec3_of(fade->felt.torque));
    segment->energy = 0.0;
    if (reason == DPT_FORCE_ACTS)
        segment->energy = push(world, tool, segment_index, tool_torque_origin(world, tool), &truth);
    if (was_felt && (became_undecided || segment->has_given_up_push)) {
        if (!(fade->time_left > 0.0))
            segment->fading_body_id = segment->previous_pushing_part.body_id;
        fade->time_left = world->def.fade;
    }
    const dpt_wrench last = fade->felt;
    fade_step(fade, &truth, dt);
    segment->body_work = body_work_of(world, segment, tool_torque_origin(world, tool), &last, &fade->felt);
    segment->force_reason = reason;
    segment->previous_pushing_part = segment->pushing_part;
    segment->pushing_part = (struct pushing_part){ .body_id = 0 };
}

void dpti_force_sum(const struct dpt_world *world, struct tool *tool)
{
    vec3 force = { 0.0, 0.0, 0.0 }, torque = force;
    uint32_t acts = 0, undecided = 0, fades = 0;
    for (uint32_t i = 0; i < tool->segment_count; i++) {
        const struct segment *segment = &world->segments[tool->first_segment + i];
        force = add(force, vec3_of(segment->fade.felt.force));
        torque = add(torque, vec3_of(segment->fade.felt.torque));
        acts |= segment->force_reason == DPT_FORCE_ACTS;
        undecided |= segment->force_reason == DPT_FORCE_UNDECIDED;
        fades |= segment->fade.time_left > 0.0;
        tool->energy += segment->energy;
        tool->body_work += segment->body_work;
    }
    vec3_store(force, tool->wrench.force);
    vec3_store(torque, tool->wrench.torque);
    if (world->def.until != DPT_UNTIL_RESPOND || tool->stiffness == 0.0)
        tool->force_reason = DPT_FORCE_OFF;
    else
        tool->force_reason = acts ? DPT_FORCE_ACTS : undecided ? DPT_FORCE_UNDECIDED : DPT_FORCE_FREE;
    tool->force_flags = (fades ? DPT_FORCE_FLAG_FADING : 0u) | (acts && undecided ? DPT_FORCE_FLAG_PARTIAL : 0u);
}
