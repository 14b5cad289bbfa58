/* SPDX-License-Identifier: BSD-3-Clause */
#include "proxy/tool_loads.h"

#include "proxy/proxy.h"
#include "proxy/proxy_friction.h"
#include "track/deform_state.h"
#include "track/persistent_contacts.h"

/* What loads may be scaled by: damping, a fade and yielding surfaces make the wrench another than the points' sum. */
#define SCALE_MAX 4.0

static uint32_t slot_of(const struct dpt_world *world, const struct tool *tool)
{
    return (uint32_t)(tool - world->tools);
}

/* The load of a tool on a body; NULL if it has none in this tick. */
static struct tool_load *load_of(const struct dpt_world *world, const struct tool *tool, const struct deform *deform)
{
    for (uint32_t i = 0; i < deform->tool_count; i++)
        if (deform->tools[i].tool_slot == slot_of(world, tool))
            return &deform->tools[i];
    return NULL;
}

/* The point, in the world, that the torque is about. With a proxy it is the device's origin, also of a free tool. */
static vec3 origin_of(const struct dpt_world *world, const struct tool *tool)
{
    return dpti_proxy_is_used(world, tool) ? vec3_of(tool->pose.position) : tool_torque_origin(world, tool);
}

/* Rigid bodies keep no points: the sum of what is done to them is enough. */
static void note_rigid(const struct dpt_world *world, struct tool *tool, vec3 at, vec3 force)
{
    dpt_wrench *sum = &tool->on_rigid;
    const vec3 torque = cross(sub(at, origin_of(world, tool)), force);
    vec3_store(add(vec3_of(sum->force), force), sum->force);
    vec3_store(add(vec3_of(sum->torque), torque), sum->torque);
}

/* A tool pushes a body with `force` (N, on the body, in the world) at the point of a triangle nearest to `at`. */
static void note_point(struct dpt_world *world, struct tool *tool, uint32_t body_id, uint32_t triangle, vec3 at,
                       vec3 force)
{
    struct body *body = world_find_body(world, body_id);
    struct deform *deform = body ? deform_of(body) : NULL;
    if (!(dot(force, force) > 0.0))
        return;
    if (body && !deform)
        note_rigid(world, tool, at, force);
    if (!deform)
        return;
    struct tool_load *load = load_of(world, tool, deform);
    if (deform->point_count == deform->def.max_points) {
        /* The tool's other points take what this one lacks, if there are any. */
        deform->has_lost_tool |= !load;
        return;
    }
    if (!load) {
        load = &deform->tools[deform->tool_count++];
        *load = (struct tool_load){ .tool_slot = slot_of(world, tool), .first = deform->point_count };
    }
    struct load_point *point = &deform->points[deform->point_count++];
    pair nearest;
    dpti_triangle_point_pair(&body->surface, triangle, frame_to_local(&body->frame, at), &nearest);
    point->triangle = triangle;
    point->at = surface_point(&body->surface, triangle, nearest.weight);
    point->force = frame_turn_back(&body->frame, force);
    load->count++;
}

/* What friction pulls a contact with, in m. */
static vec3 pull_at(const struct proxy_tick *tick, uint32_t space)
{
    vec3 sum = { 0.0, 0.0, 0.0 };
    for (uint32_t i = 0; i < tick->contact_count; i++)
        for (int d = 0; d < 2 && tick->contact_spaces[i] == space; d++)
            sum = along(sum, tick->contacts[i].pull[d], vec3_of(tick->contacts[i].across[d]));
    return sum;
}

void dpti_loads_note_proxy(struct proxy_tick *tick)
{
    double left[HALF_SPACE_DIMENSIONS];
    const double stiffness = tick->tool->stiffness;
    if (!tick->world->deform_count || !(stiffness > 0.0) || tick->proxy->state != PROXY_OUTSIDE ||
        !dpti_proxy_solve_held(tick, left))
        return;
    for (uint32_t k = 0; k < tick->solved.active_count; k++) {
        const uint32_t space = tick->solved.active[k];
        const struct proxy_triangle *triangle = &tick->triangles[tick->sources[space].triangle];
        const vec3 push = scaled(vec3_of(tick->spaces[space].normal), tick->solved.multiplier[k]);
        note_point(tick->world, tick->tool, triangle->body_id, triangle->triangle, proxy_touch_of(tick, space),
                   scaled(add(push, pull_at(tick, space)), -stiffness));
    }
}

/* The one point that the law POINT pushes. */
static void note_penetration(struct dpt_world *world, struct tool *tool, const struct segment *segment)
{
    const struct pushing_part *part = &segment->previous_pushing_part;
    const struct penetration *penetration = &segment->felt_penetration;
    if (part->body_id)
        note_point(world, tool, part->body_id, part->triangle, penetration->at,
                   scaled(penetration->direction, -tool->stiffness * penetration->depth));
}

/* Of a contact's thrust: what its samples take in equal parts. A contact of one sample may have no other share. */
#define EVEN_SHARE 0.1

/*
 * What a contact pushes the tool with, but for its size. The thrust counts from the world's onset: that of a contact
 * which does not reach it is zero, and its depth counts, over its stretch.
 */
static vec3 thrust_of(const dpt_contact *contact, double axis_length)
{
    const vec3 thrust = vec3_of(contact->thrust);
    const double stretch = max_of((contact->s1 - contact->s0) * axis_length, -contact->gap);
    return dot(thrust, thrust) > 0.0 ? thrust : scaled(vec3_of(contact->normal), -contact->gap * stretch);
}

/* The samples of a segment's contacts, each with its share of the contact's thrust. */
static void note_contacts(struct dpt_world *world, struct tool *tool, uint32_t segment_index)
{
    const struct persistent_contacts *contacts = contacts_this_tick(world);
    const struct axis *axis = &world->segments[segment_index].answer.track.axis;
    for (uint32_t i = 0; i < contacts->count; i++) {
        const struct persistent_contact *persistent = &contacts->items[i];
        const dpt_contact *contact = &persistent->contact;
        if (persistent->segment_index != segment_index || persistent->is_unseen || !(contact->gap < 0.0))
            continue;
        const double even = EVEN_SHARE / persistent->warm_start_count;
        for (uint32_t k = 0; k < persistent->warm_start_count; k++) {
            const struct warm_start *sample = &persistent->warm_starts[k];
            note_point(world, tool, contact->body, sample->triangle, along(axis->a, sample->s, sub(axis->b, axis->a)),
                       scaled(thrust_of(contact, length(sub(axis->b, axis->a))), -((double)sample->share + even)));
        }
    }
}

void dpti_loads_note_segments(struct dpt_world *world, struct tool *tool)
{
    for (uint32_t i = 0; world->deform_count && i < tool->segment_count; i++) {
        const struct segment *segment = &world->segments[tool->first_segment + i];
        if (segment->force_reason != DPT_FORCE_ACTS)
            continue;
        if (tool->law == DPT_LAW_BED)
            note_contacts(world, tool, tool->first_segment + i);
        else
            note_penetration(world, tool, segment);
    }
}

/* What the points of a tool on a body sum up to, on the body, in world axes; the torque about load->origin. */
static dpt_wrench sum_points(const struct body *body, const struct tool_load *load, double *size)
{
    const struct deform *deform = deform_of(body);
    vec3 force = { 0.0, 0.0, 0.0 }, torque = force;
    dpt_wrench sum;
    *size = 0.0;
    for (uint32_t i = load->first; i < load->first + load->count; i++) {
        const vec3 push = frame_turn(&body->frame, deform->points[i].force);
        const vec3 at = frame_to_world(&body->frame, deform->points[i].at);
        force = add(force, push);
        torque = add(torque, cross(sub(at, load->origin), push));
        *size += length(push);
    }
    vec3_store(force, sum.force);
    vec3_store(torque, sum.torque);
    return sum;
}

/* The factor that makes the points' forces about as large as the wrench; 1 where they do not oppose it. */
static double scale_of(vec3 points, vec3 wrench)
{
    const double square = dot(points, points), scale = -dot(points, wrench);
    return square > 0.0 && scale > 0.0 ? min_of(scale / square, SCALE_MAX) : 1.0;
}

/* A wrench on a body, in world axes about a tool's origin, as the body knows it whatever pose it is given later. */
static void set_whole(const struct body *body, struct tool_load *load, vec3 force, vec3 torque)
{
    const struct frame *frame = &body->frame;
    const vec3 about = add(torque, cross(sub(load->origin, frame->origin), force));
    vec3_store(frame_turn_back(frame, force), load->whole.force);
    vec3_store(frame_turn_back(frame, about), load->whole.torque);
}

/* Of the body's forces: `whole` becomes scale times their sum, and `share` of what the wrench is beyond that. */
static void settle_body(struct body *body, struct tool_load *load, double scale, double share, const dpt_wrench *rest)
{
    const struct deform *deform = deform_of(body);
    double size;
    const dpt_wrench sum = sum_points(body, load, &size);
    for (uint32_t i = load->first; i < load->first + load->count; i++)
        deform->points[i].force = scaled(deform->points[i].force, scale);
    set_whole(body, load, along(scaled(vec3_of(sum.force), scale), share * size, vec3_of(rest->force)),
              along(scaled(vec3_of(sum.torque), scale), share * size, vec3_of(rest->torque)));
}

/*
 * A wrench that no point gives: a proxy is on its way after what held it is gone (a fold), or the force fades. What is
 * nearest takes it.
 */
static void note_nearest(struct dpt_world *world, struct tool *tool)
{
    const struct segment *nearest = NULL;
    for (uint32_t i = 0; i < tool->segment_count; i++) {
        const struct segment *segment = &world->segments[tool->first_segment + i];
        if (segment->answer.body && segment->answer.track.nearest.triangle != DPT_NONE &&
            (!nearest || segment->result.distance < nearest->result.distance))
            nearest = segment;
    }
    if (!nearest)
        return;
    const struct dynamic_point *track = &nearest->answer.track;
    note_point(world, tool, nearest->answer.body->id, track->nearest.triangle,
               along(track->axis.a, track->nearest.pair.s, sub(track->axis.b, track->axis.a)),
               scaled(vec3_of(tool->wrench.force), -1.0));
}

/* Whether the tool touches anything in this tick. */
static int has_points(const struct dpt_world *world, const struct tool *tool)
{
    const vec3 on_rigid = vec3_of(tool->on_rigid.force);
    for (uint32_t i = 0; i < world->body_slot_end; i++) {
        const struct body *body = &world->bodies[i];
        if (body->slot.used && deform_of(body) && load_of(world, tool, deform_of(body)))
            return 1;
    }
    return dot(on_rigid, on_rigid) > 0.0;
}

void dpti_loads_settle(struct dpt_world *world, struct tool *tool)
{
    if (world->deform_count && !has_points(world, tool))
        note_nearest(world, tool);
    vec3 force = vec3_of(tool->on_rigid.force), torque = vec3_of(tool->on_rigid.torque);
    double all = 0.0;
    for (uint32_t i = 0; world->deform_count && i < world->body_slot_end; i++) {
        struct body *body = &world->bodies[i];
        struct tool_load *load = body->slot.used && deform_of(body) ? load_of(world, tool, deform_of(body)) : NULL;
        double size;
        if (!load)
            continue;
        load->origin = origin_of(world, tool);
        const dpt_wrench sum = sum_points(body, load, &size);
        force = add(force, vec3_of(sum.force));
        torque = add(torque, vec3_of(sum.torque));
        all += size;
    }
    if (!(all > 0.0))
        return;
    const double scale = scale_of(force, vec3_of(tool->wrench.force));
    dpt_wrench rest;
    vec3_store(scaled(along(vec3_of(tool->wrench.force), scale, force), -1.0), rest.force);
    vec3_store(scaled(along(vec3_of(tool->wrench.torque), scale, torque), -1.0), rest.torque);
    for (uint32_t i = 0; i < world->body_slot_end; i++) {
        struct body *body = &world->bodies[i];
        struct tool_load *load = body->slot.used && deform_of(body) ? load_of(world, tool, deform_of(body)) : NULL;
        if (load)
            settle_body(body, load, scale, 1.0 / all, &rest);
    }
}
