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

/* A proxy is held by as many points at most as its motion has unknowns; else a segment has one, or its contacts. */
static uint32_t capacity_of(const dpt_world_def *def)
{
    return def->max_segments + HALF_SPACE_DIMENSIONS * def->max_tools + def->max_contacts;
}

uint64_t dpti_loads_bytes(const dpt_world_def *def)
{
    return sizeof(struct load_note) * (uint64_t)capacity_of(def);
}

char *dpti_loads_place(struct dpt_world *world, char *at)
{
    world->loads = (void *)at;
    return at + dpti_loads_bytes(&world->def);
}

void dpti_loads_begin_tick(struct dpt_world *world, int (*keeps)(const struct tool *tool))
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < world->load_count; i++) {
        const struct tool *tool = &world->tools[world->loads[i].tool_slot];
        if (tool->slot.used && keeps(tool))
            world->loads[kept++] = world->loads[i];
    }
    world->load_count = kept;
}

/* Where a note is made: the part of the tool that pushes, and what tells users of the place. */
struct load_place {
    uint32_t segment; /* of the tool */
    uint32_t contact; /* id, or 0 */
    uint32_t source;  /* number of the triangle */
};

static void note(struct dpt_world *world, const struct tool *tool, const struct load_place *place,
                 const struct body *body, vec3 at, vec3 force)
{
    if (world->load_count < capacity_of(&world->def))
        world->loads[world->load_count++] = (struct load_note){ .tool_slot = slot_of(world, tool),
                                                                .segment = place->segment,
                                                                .body_id = body->id,
                                                                .triangle = place->source,
                                                                .contact = place->contact,
                                                                .at = at,
                                                                .force = force,
                                                                .about_body = body->frame.origin };
}

/* Deformable bodies keep their own points: of rigid ones they need but the sum. */
static void note_rigid(const struct dpt_world *world, struct tool *tool, vec3 at, vec3 force)
{
    dpt_wrench *sum = &tool->on_rigid;
    const vec3 torque = cross(sub(at, origin_of(world, tool)), force);
    vec3_store(add(vec3_of(sum->force), force), sum->force);
    vec3_store(add(vec3_of(sum->torque), torque), sum->torque);
}

/* The point of the body's surface, in its frame, that is nearest to a point in the world. */
static vec3 on_surface(const struct dpt_world *world, const struct body *body, uint32_t triangle, vec3 at)
{
    const struct surface surface = surface_view(&body->surface, world_coming_tick(world), 0.0);
    pair nearest;
    dpti_triangle_point_pair(&surface, triangle, frame_to_local(&body->frame, at), &nearest);
    return surface_point(&surface, triangle, nearest.weight);
}

/* A deformable body is pushed at a point, in its frame. */
static void note_deform(const struct dpt_world *world, const struct tool *tool, struct deform *deform,
                        const struct load_point *point)
{
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
    deform->points[deform->point_count++] = *point;
    load->count++;
}

/*
 * A tool pushes a body with `force` (N, on the body, in the world) at the point of a triangle nearest to `at`. Returns
 * where, in the world; on a rigid body `at` itself.
 */
static vec3 push_point(struct dpt_world *world, struct tool *tool, const struct body *body, uint32_t triangle, vec3 at,
                       vec3 force)
{
    struct deform *deform = deform_of(body);
    if (!deform) {
        if (world->deform_count)
            note_rigid(world, tool, at, force);
        return at;
    }
    const vec3 touched = on_surface(world, body, triangle, at);
    const struct load_point point = {
        .triangle = triangle, .at = touched, .middle = touched, .force = frame_turn_back(&body->frame, force)
    };
    note_deform(world, tool, deform, &point);
    return frame_to_world(&body->frame, touched);
}

static void note_point(struct dpt_world *world, struct tool *tool, uint32_t segment, uint32_t body_id,
                       uint32_t triangle, vec3 at, vec3 force)
{
    const struct body *body = world_find_body(world, body_id);
    if (!body || !(dot(force, force) > 0.0))
        return;
    const struct load_place place = { .segment = segment, .source = body->surface.sources[triangle] };
    note(world, tool, &place, body, push_point(world, tool, body, triangle, at, force), force);
}

void dpti_loads_note_push(struct dpt_world *world, struct tool *tool, const struct tool_push *push)
{
    const struct body *body = world_find_body(world, push->body_id);
    if (!deform_of(body)) {
        if (!push->is_part)
            note_point(world, tool, push->part, push->body_id, push->triangle, push->at, push->force);
        return;
    }
    const struct load_place place = { .segment = push->part, .source = body->surface.sources[push->triangle] };
    const vec3 at = on_surface(world, body, push->triangle, push->at),
               normal = frame_turn_back(&body->frame, push->normal);
    const struct load_point point = { .triangle = push->triangle,
                                      .is_narrow = push->is_narrow,
                                      .at = at,
                                      .middle = along(at, -push->depth, normal),
                                      .force = frame_turn_back(&body->frame, push->force),
                                      .normal = normal };
    note_deform(world, tool, deform_of(body), &point);
    if (!push->is_part)
        note(world, tool, &place, body, frame_to_world(&body->frame, point.at), push->force);
}

static void forget_on(const struct dpt_world *world, const struct tool *tool, struct deform *deform)
{
    struct tool_load *load = load_of(world, tool, deform);
    if (!load)
        return;
    const uint32_t first = load->first, count = load->count, last = --deform->tool_count;
    memmove(deform->points + first, deform->points + first + count,
            (deform->point_count - first - count) * sizeof *deform->points);
    deform->point_count -= count;
    memmove(load, load + 1, (size_t)(deform->tools + last - load) * sizeof *load);
    for (uint32_t i = 0; i < last; i++)
        if (deform->tools[i].first > first)
            deform->tools[i].first -= count;
    deform->has_lost_tool &= last > 0;
}

void dpti_loads_forget(struct dpt_world *world, struct tool *tool)
{
    const dpt_wrench none = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.0 } };
    uint32_t kept = 0;
    for (uint32_t i = 0; i < world->load_count; i++)
        if (world->loads[i].tool_slot != slot_of(world, tool))
            world->loads[kept++] = world->loads[i];
    world->load_count = kept;
    tool->on_rigid = none;
    for (uint32_t i = 0; i < world->body_slot_end; i++)
        if (world->bodies[i].slot.used && deform_of(&world->bodies[i]))
            forget_on(world, tool, deform_of(&world->bodies[i]));
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

/*
 * What holds the proxy. What the last motion was solved for is as good where it left no way to go, and costs nothing. Else
 * the answers of this tick and of the next ones must not depend on what is noted: neither a budget nor what friction
 * begins with next. Deformable bodies have the notes among their answers.
 */
static int solve_held(struct proxy_tick *tick)
{
    double left[HALF_SPACE_DIMENSIONS];
    const int is_noted_alone = tick->held == PROXY_HELD_UNKNOWN && !tick->world->deform_count;
    if (tick->is_settled && is_noted_alone)
        return 1;
    const struct work work = tick->world->work;
    const vec3 pull_shift = tick->proxy->pull_shift, pull_turn = tick->proxy->pull_turn;
    const int is_solved = dpti_proxy_solve_held(tick, left);
    if (is_noted_alone) {
        tick->world->work = work;
        tick->proxy->pull_shift = pull_shift;
        tick->proxy->pull_turn = pull_turn;
    }
    return is_solved;
}

void dpti_loads_note_proxy(struct proxy_tick *tick)
{
    const double stiffness = tick->tool->stiffness;
    if (!(stiffness > 0.0) || tick->proxy->state != PROXY_OUTSIDE || !solve_held(tick))
        return;
    for (uint32_t k = 0; k < tick->solved.active_count; k++) {
        const uint32_t space = tick->solved.active[k];
        const struct proxy_triangle *triangle = &tick->triangles[tick->sources[space].triangle];
        const vec3 push = scaled(vec3_of(tick->spaces[space].normal), tick->solved.multiplier[k]);
        note_point(tick->world, tick->tool, triangle->segment, triangle->body_id, triangle->triangle,
                   proxy_touch_of(tick, space), scaled(add(push, pull_at(tick, space)), -stiffness));
    }
}

/* The one point that the law POINT pushes. */
static void note_penetration(struct dpt_world *world, struct tool *tool, const struct segment *segment)
{
    const struct pushing_part *part = &segment->previous_pushing_part;
    const struct penetration *penetration = &segment->felt_penetration;
    const uint32_t number = (uint32_t)(segment - world->segments) - tool->first_segment;
    if (part->body_id)
        note_point(world, tool, number, part->body_id, part->triangle, penetration->at,
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

/* Where on the axis a contact's thrust acts, as one push. */
static double middle_of(const dpt_contact *contact)
{
    const vec3 thrust = vec3_of(contact->thrust);
    const double square = dot(thrust, thrust), moment = dot(vec3_of(contact->thrust_moment), thrust);
    return square > 0.0 ? min_of(max_of(moment / square, contact->s0), contact->s1) : contact->s;
}

/*
 * The samples of a contact, each with its share of the thrust, where a deformable body may need them. They push in one
 * direction, so that all together are one push, in their middle. Returns its force.
 */
static vec3 push_samples(struct dpt_world *world, struct tool *tool, const struct body *body,
                         const struct persistent_contact *persistent, vec3 thrust, vec3 *at)
{
    const struct axis *axis = &world->segments[persistent->segment_index].answer.track.axis;
    const double even = EVEN_SHARE / persistent->warm_start_count;
    vec3 middle = { 0.0, 0.0, 0.0 };
    double sum = 0.0;
    for (uint32_t k = 0; k < persistent->warm_start_count; k++) {
        const struct warm_start *sample = &persistent->warm_starts[k];
        const double share = (double)sample->share + even;
        const vec3 force = scaled(thrust, -share), from = along(axis->a, sample->s, sub(axis->b, axis->a));
        if (!(dot(force, force) > 0.0))
            continue;
        middle = along(middle, share, push_point(world, tool, body, sample->triangle, from, force));
        sum += share;
    }
    *at = scaled(middle, sum > 0.0 ? 1.0 / sum : 0.0);
    return scaled(thrust, -sum);
}

static void note_contact(struct dpt_world *world, struct tool *tool, const struct persistent_contact *persistent)
{
    const dpt_contact *contact = &persistent->contact;
    const struct axis *axis = &world->segments[persistent->segment_index].answer.track.axis;
    const vec3 u = sub(axis->b, axis->a), thrust = thrust_of(contact, length(u));
    const struct load_place place = { persistent->segment_index - tool->first_segment, contact->id, contact->triangle };
    const struct body *body = world_find_body(world, contact->body);
    vec3 at = along(axis->a, middle_of(contact), u), force = scaled(thrust, -1.0);
    if (body && world->deform_count)
        force = push_samples(world, tool, body, persistent, thrust, &at);
    if (body && dot(force, force) > 0.0)
        note(world, tool, &place, body, at, force);
}

static void note_contacts(struct dpt_world *world, struct tool *tool, uint32_t segment_index)
{
    const struct persistent_contacts *contacts = contacts_this_tick(world);
    for (uint32_t i = 0; i < contacts->count; i++) {
        const struct persistent_contact *persistent = &contacts->items[i];
        if (persistent->segment_index == segment_index && !persistent->is_unseen && persistent->contact.gap < 0.0)
            note_contact(world, tool, persistent);
    }
}

void dpti_loads_note_segments(struct dpt_world *world, struct tool *tool)
{
    for (uint32_t i = 0; i < tool->segment_count; i++) {
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
        const vec3 at = frame_to_world(&body->frame, deform->points[i].middle);
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
    const vec3 force = scaled(vec3_of(tool->wrench.force), -1.0);
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
    const uint32_t triangle = track->nearest.triangle;
    const vec3 at = along(track->axis.a, track->nearest.pair.s, sub(track->axis.b, track->axis.a));
    const struct body *body = nearest->answer.body;
    const struct load_place place = { .segment = (uint32_t)(nearest - world->segments) - tool->first_segment,
                                      .source = body->surface.sources[triangle] };
    /* A torque may be alone. */
    const int has_force = dot(force, force) > 0.0;
    note(world, tool, &place, body, has_force ? push_point(world, tool, body, triangle, at, force) : at, force);
}

static int wrench_acts(const dpt_wrench *wrench)
{
    const vec3 force = vec3_of(wrench->force), torque = vec3_of(wrench->torque);
    return dot(force, force) + dot(torque, torque) > 0.0;
}

/* Whether the tool pushes anything in this tick. */
static int has_notes(const struct dpt_world *world, const struct tool *tool)
{
    for (uint32_t i = 0; i < world->load_count; i++)
        if (world->loads[i].tool_slot == slot_of(world, tool))
            return 1;
    return 0;
}

/* What the deformable bodies have of it. */
static void settle_deformable(struct dpt_world *world, struct tool *tool)
{
    vec3 force = vec3_of(tool->on_rigid.force), torque = vec3_of(tool->on_rigid.torque);
    double all = 0.0;
    for (uint32_t i = 0; i < world->body_slot_end; i++) {
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

void dpti_loads_settle(struct dpt_world *world, struct tool *tool)
{
    tool->law_wrench = tool->wrench;
    tool->law_origin = origin_of(world, tool);
    if (wrench_acts(&tool->wrench) && !has_notes(world, tool))
        note_nearest(world, tool);
    if (world->deform_count)
        settle_deformable(world, tool);
}

static int is_deformable(const struct dpt_world *world, const struct load_note *note)
{
    const struct body *body = world_find_body(world, note->body_id);
    return body && deform_of(body);
}

/* By what notes share the rest of a wrench. Only one that is alone has no force. */
static double weight_of(const struct load_note *note)
{
    const double size = length(note->force);
    return size > 0.0 ? size : 1.0;
}

struct load_settlement dpti_loads_settlement(const struct dpt_world *world, const struct tool *tool)
{
    const vec3 wrench_force = vec3_of(tool->law_wrench.force), wrench_torque = vec3_of(tool->law_wrench.torque);
    vec3 force = { 0.0, 0.0, 0.0 }, torque = force;
    double rigid = 0.0, deformable = 0.0;
    struct load_settlement settled = { .scale = 1.0 };
    if (!wrench_acts(&tool->law_wrench))
        return settled;
    for (uint32_t i = 0; i < world->load_count; i++) {
        const struct load_note *note = &world->loads[i];
        if (note->tool_slot != slot_of(world, tool))
            continue;
        *(is_deformable(world, note) ? &deformable : &rigid) += weight_of(note);
        force = add(force, note->force);
        torque = add(torque, cross(sub(note->at, tool->law_origin), note->force));
        settled.count++;
    }
    settled.scale = scale_of(force, wrench_force);
    vec3_store(scaled(along(wrench_force, settled.scale, force), -1.0), settled.rest.force);
    vec3_store(scaled(along(wrench_torque, settled.scale, torque), -1.0), settled.rest.torque);
    settled.deform_share = deformable > 0.0 ? 1.0 / deformable : 0.0;
    settled.rigid_share = !(deformable > 0.0) && rigid > 0.0 ? 1.0 / rigid : 0.0;
    return settled;
}

dpt_wrench dpti_loads_of_note(const struct dpt_world *world, const struct tool *tool,
                              const struct load_settlement *settled, const struct load_note *note)
{
    const double share = weight_of(note) * (is_deformable(world, note) ? settled->deform_share : settled->rigid_share);
    const vec3 force = scaled(vec3_of(settled->rest.force), share);
    const vec3 torque = cross(sub(note->at, tool->law_origin), force);
    dpt_wrench on_body;
    vec3_store(along(force, settled->scale, note->force), on_body.force);
    vec3_store(sub(scaled(vec3_of(settled->rest.torque), share), torque), on_body.torque);
    return on_body;
}
