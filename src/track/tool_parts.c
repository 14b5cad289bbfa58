/* SPDX-License-Identifier: BSD-3-Clause */
#include "track/tool_parts.h"

#include "base/sized.h"
#include "nearest/nearest_pair.h"
#include "track/body_search.h"
#include "track/persistent_contacts.h"

void dpti_far_forget(struct segment *segment)
{
    segment->proven.distance = 0.0;
}

void dpti_far_forget_all(struct dpt_world *world)
{
    for (uint32_t s = 0; s < world->segment_count; s++)
        dpti_far_forget(&world->segments[s]);
}

/* m: the proven lower bound of the distance between the axis from `a` to `b` and all bodies; 0 if nothing is known. */
static double bound_if_far(const struct dpt_world *world, struct segment *segment, vec3 a, vec3 b)
{
    struct proven_distance *proven = &segment->proven;
    double moved = max_of(length(sub(a, proven->a)), length(sub(b, proven->b)));
    if (proven->tick != world->ticks)
        moved += world_body_motion(world);
    proven->a = a;
    proven->b = b;
    proven->tick = (uint32_t)world->ticks;
    if (moved > 0.0)
        proven->distance = max_of(0.0, proven->distance - (moved + proven->error));
    return proven->distance;
}

void dpti_far_prove(const struct dpt_world *world, struct segment *segment, vec3 a, vec3 b)
{
    struct proven_distance *proven = &segment->proven;
    proven->a = a;
    proven->b = b;
    proven->distance = segment->result.lower_bound;
    proven->error = segment->answer.error_bound;
    proven->tick = (uint32_t)world->ticks;
}

void dpti_far_pair(const struct body *body, vec3 a, vec3 b, double lower_bound, struct dynamic_point *track,
                   struct segment_result *result)
{
    pair *found = &track->nearest.pair;
    axis_of(&body->surface, &body->frame, a, b, &track->axis);
    const vec3 q = surface_point(&body->surface, track->nearest.triangle, found->weight);
    found->s = nearest_on(track->axis.local_a, track->axis.u, q);
    found->gap = sub(along(track->axis.local_a, found->s, track->axis.u), q);
    found->distance2 = dot(found->gap, found->gap);
    dpti_segment_result_of_pair(&track->axis, found, result);
    result->status = DPT_STATUS_BOUNDED;
    result->lower_bound = min_of(lower_bound, result->lower_bound);
    result->error_bound = result->distance - result->lower_bound;
}

int dpti_track_begin(struct dpt_world *world, uint32_t segment_index)
{
    struct segment *segment = &world->segments[segment_index];
    segment->answer.body = NULL;
    segment->answer.is_far = 0;
    segment->result = (struct segment_result){ .status = DPT_STATUS_STALE };
    if (tool_is_active(world, &world->tools[segment->tool_slot]))
        return 1;
    segment->broad_phase.has_axis = 0;
    return 0;
}

static int is_same(vec3 a, vec3 b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

/* Whether the answer is that of this axis, and nothing has changed since. With a budget a search finds out what rests. */
static int is_answered(const struct dpt_world *world, const struct body_answer *answer, vec3 a, vec3 b)
{
    const int is_new =
        answer->tick == world->ticks || (world_was_last_tick(world, answer->tick) && !world->has_changed);
    return answer->body && answer->is_exact && is_new && !world->def.budget && is_same(answer->track.axis.a, a) &&
           is_same(answer->track.axis.b, b);
}

/* Search for the pair of an axis, unless it is known. */
static void track_axis(struct dpt_world *world, uint32_t segment_index, vec3 a, vec3 b)
{
    struct segment *segment = &world->segments[segment_index];
    segment->result = (struct segment_result){ .status = DPT_STATUS_STALE };
    if (is_answered(world, &segment->answer, a, b))
        segment->answer.work = 0;
    else
        dpti_body_search_find(world, segment_index, &a, &b, &segment->answer);
    if (!segment->answer.body)
        return;
    segment->last_body_slot = handle_index(segment->answer.body->id);
    dpti_body_search_result(&segment->answer, &segment->result);
    if (far_is_used(world, &world->tools[segment->tool_slot]))
        dpti_far_prove(world, segment, a, b);
}

void dpti_track_segment(struct dpt_world *world, uint32_t segment_index)
{
    struct segment *segment = &world->segments[segment_index];
    const struct tool *tool = &world->tools[segment->tool_slot];
    if (tool_is_active(world, tool) || dpti_track_begin(world, segment_index))
        track_axis(world, segment_index, frame_to_world(&tool->felt_frame, segment->a),
                   frame_to_world(&tool->felt_frame, segment->b));
}

void dpti_track_far(struct dpt_world *world, uint32_t segment_index)
{
    const struct segment *segment = &world->segments[segment_index];
    track_axis(world, segment_index, segment->answer.track.axis.a, segment->answer.track.axis.b);
}

/* Answer without a search, if the segment is no nearer than those that were searched for. */
static int answer_if_far(struct dpt_world *world, struct segment *segment, vec3 a, vec3 b,
                         const struct min_distance *min, int is_outside)
{
    const struct body *body = segment->answer.body;
    const double distance = bound_if_far(world, segment, a, b);
    if (!is_outside || !body || !min_distance_is_below(min, distance, segment->radius) ||
        !(world->def.until == DPT_UNTIL_TRACK || distance - segment->radius > world->def.margin))
        return 0;
    dpti_far_pair(body, a, b, distance, &segment->answer.track, &segment->result);
    segment->answer.lower_bound = distance;
    segment->answer.error_bound = segment->answer.track.axis.error;
    segment->answer.is_exact = segment->answer.work = 0;
    segment->answer.is_far = 1;
    return 1;
}

void dpti_track_near(struct dpt_world *world, struct tool *tool, int all_outside)
{
    const uint32_t begin = tool->closest < tool->segment_count ? tool->closest : 0;
    struct min_distance min = min_distance_none();
    for (uint32_t k = 0; k < tool->segment_count; k++) {
        const uint32_t number = (begin + k) % tool->segment_count;
        struct segment *segment = &world->segments[tool->first_segment + number];
        const vec3 a = frame_to_world(&tool->felt_frame, segment->a);
        const vec3 b = frame_to_world(&tool->felt_frame, segment->b);
        if (answer_if_far(world, segment, a, b, &min, all_outside || segment->proven.is_outside))
            continue;
        track_axis(world, tool->first_segment + number, a, b);
        if (segment->answer.body && min_distance_take(&min, segment->result.distance, segment->radius))
            tool->closest = number;
    }
}

struct box dpti_tip_box(const struct dpt_hull *hull, const struct frame *tool)
{
    struct box box = box_of_axis(frame_to_world(tool, hull->axis_a), frame_to_world(tool, hull->axis_b));
    const vec3 reach = { hull->reach, hull->reach, hull->reach };
    return (struct box){ sub(box.low, reach), add(box.high, reach) };
}

struct box dpti_part_box(struct part part, const struct frame *tool)
{
    const struct segment *segment = part.segment;
    return segment ? box_of_axis(frame_to_world(tool, segment->a), frame_to_world(tool, segment->b))
                   : dpti_tip_box(part.tip->hull, tool);
}

/* One body, if it is nearer than the answer so far. */
static void try_body(const struct dpt_world *world, const struct tip *tip, const struct frame *frame,
                     const struct body *body, struct work *work, struct tip_answer *answer)
{
    const uint32_t hint = body->id == tip->last_body_id ? tip->last_triangle : DPT_NONE;
    const double limit = answer->body ? answer->nearest.distance : HUGE_VAL;
    struct hull_place place;
    struct hull_nearest found;
    hull_place_set(&place, tip->hull, frame, &body->frame);
    if (!dpti_hull_search(&body->surface, &world->kernel, &place, hint, limit, work, &found))
        answer->is_exact = 0;
    found.error_bound = dpti_hull_error(&place, &body->surface, frame, &body->frame);
    const double error = max_of(found.error_bound, answer->nearest.error_bound);
    if (found.triangle != DPT_NONE) {
        const vec3 q = surface_point(&body->surface, found.triangle, found.found.pair.weight);
        answer->nearest = found;
        answer->body = body;
        answer->q = frame_to_world(&body->frame, q);
        answer->p = frame_to_world(&body->frame, add(q, found.found.pair.gap));
    }
    answer->nearest.error_bound = error;
}

void dpti_tip_find(const struct dpt_world *world, const struct tip *tip, const struct frame *frame, struct work *work,
                   struct tip_answer *answer)
{
    const struct box box = dpti_tip_box(tip->hull, frame);
    const struct body *first = tip->last_body_id ? world_find_body(world, tip->last_body_id) : NULL;
    memset(answer, 0, sizeof *answer);
    answer->is_exact = 1;
    if (first && body_is_there(first))
        try_body(world, tip, frame, first, work, answer);
    for (uint32_t i = 0; i < world->body_slot_end; i++) {
        const struct body *body = &world->bodies[i];
        if (body_is_there(body) && body != first &&
            !(answer->body && box_distance(&box, &world->boxes[i]) > answer->nearest.distance))
            try_body(world, tip, frame, body, work, answer);
    }
    if (answer->body && answer->is_exact)
        answer->lower_bound = max_of(0.0, answer->nearest.distance - answer->nearest.error_bound);
}

/* Whether the answer is that of where the tool is, and nothing else has changed since. */
static int is_known(const struct dpt_world *world, const struct tool *tool, const struct tip *tip)
{
    return tip->answer.body && tip->answer.is_exact && !world->deform_count &&
           (tip->answer_tick == world->ticks ||
            (world_was_last_tick(world, tip->answer_tick) && !world->has_changed)) &&
           memcmp(&tip->answer_frame, &tool->felt_frame, sizeof tool->felt_frame) == 0;
}

void dpti_tip_know(const struct dpt_world *world, struct tip *tip, const struct frame *frame,
                   const struct tip_answer *answer)
{
    tip->answer = *answer;
    tip->answer_frame = *frame;
    tip->answer_tick = world->ticks;
    if (!answer->body)
        return;
    tip->last_body_id = answer->body->id;
    tip->last_triangle = answer->nearest.triangle;
}

void dpti_tips_track(struct dpt_world *world, struct tool *tool)
{
    struct tip_answer answer;
    for (uint32_t i = 0; i < tool->tip_count; i++) {
        struct tip *tip = tool_tip(world, tool, i);
        if (is_known(world, tool, tip))
            continue;
        dpti_tip_find(world, tip, &tool->felt_frame, &world->work, &answer);
        dpti_tip_know(world, tip, &tool->felt_frame, &answer);
    }
}

int dpti_tip_is_outside(const struct tip *tip)
{
    const struct tip_answer *answer = &tip->answer;
    const struct surface *surface = &answer->body->surface;
    const struct hull_nearest *nearest = &answer->nearest;
    const uint32_t flags = surface_part_flags(surface, surface_part(surface, nearest->triangle));
    if (!(nearest->distance > 0.0))
        return 0;
    if (!(flags & MESH_PART_SOLID) || (flags & (MESH_PART_WINDING | MESH_PART_BURIED)))
        return 1;
    return dpti_side_of_pair(surface, nearest->triangle, &nearest->found.pair) > 0;
}

static void write_hit(const struct tip *tip, const struct tip_answer *answer, int is_held, dpt_hit *hit)
{
    const double gap = answer->nearest.distance - tip->hull->radius;
    const int is_apart = answer->nearest.distance > 0.0;
    hit->status = answer->is_exact ? DPT_STATUS_EXACT : DPT_STATUS_BOUNDED;
    hit->flags = is_apart ? 0 : DPT_HIT_FLAG_CROSSING;
    hit->triangle = answer->body->surface.sources[answer->nearest.triangle];
    hit->body = answer->body->id;
    hit->distance = answer->nearest.distance;
    hit->error_bound = answer->is_exact ? answer->nearest.error_bound : answer->nearest.distance - answer->lower_bound;
    hit->lower_bound = answer->lower_bound;
    vec3_store(answer->p, hit->p);
    vec3_store(answer->q, hit->q);
    if (is_held || (answer->is_exact && !is_apart)) {
        hit->contact = DPT_CONTACT_PENETRATING;
    } else if (answer->is_exact) {
        hit->contact = dpti_contact_of_gap(gap, answer->nearest.error_bound);
        hit->flags |= DPT_HIT_FLAG_GAP;
        hit->gap = gap;
        hit->depth = max_of(0.0, -gap);
    } else {
        hit->flags |= DPT_HIT_FLAG_BUDGET;
    }
}

static void begin_hit(const struct tool *tool, uint32_t number, struct tip *tip)
{
    tip->hit = (dpt_hit){ .size = sizeof(dpt_hit),
                          .status = DPT_STATUS_STALE,
                          .triangle = DPT_NONE,
                          .segment = tool->segment_count + number };
}

void dpti_tips_write_hits(const struct dpt_world *world, const struct tool *tool, const struct frame *device,
                          struct work *work)
{
    for (uint32_t i = 0; i < tool->tip_count; i++) {
        struct tip *tip = tool_tip(world, tool, i);
        struct tip_answer at_device;
        begin_hit(tool, i, tip);
        if (device)
            dpti_tip_find(world, tip, device, work, &at_device);
        const struct tip_answer *answer = device ? &at_device : &tip->answer;
        if (answer->body)
            write_hit(tip, answer, device != NULL, &tip->hit);
    }
}

static void fill_contact(struct dpt_world *world, const struct tool *tool, uint32_t number, struct tip *tip)
{
    const struct tip_answer *answer = &tip->answer;
    const struct surface *surface = &answer->body->surface;
    const pair *found = &answer->nearest.found.pair;
    const double distance = answer->nearest.distance, gap = distance - tip->hull->radius;
    const uint32_t id = tip->contact.id && tip->contact.body == answer->body->id
                            ? tip->contact.id
                            : dpti_persistent_contacts_new_id(world);
    tip->contact = (dpt_contact){ .size = sizeof(dpt_contact),
                                  .id = id,
                                  .body = answer->body->id,
                                  .segment = tool->segment_count + number,
                                  .triangle = surface->sources[answer->nearest.triangle],
                                  .contact = distance > 0.0 ? dpti_contact_of_gap(gap, answer->nearest.error_bound)
                                                            : DPT_CONTACT_PENETRATING,
                                  .flags = distance > 0.0 ? 0u : DPT_CONTACT_FLAG_CROSSING,
                                  .gap = gap };
    vec3_store(answer->p, tip->contact.p);
    vec3_store(answer->q, tip->contact.q);
    memcpy(tip->contact.weight, found->weight, sizeof tip->contact.weight);
    const vec3 normal = frame_turn(&answer->body->frame, unit_of(found->gap));
    vec3_store(normal, tip->contact.normal);
    for (int k = 0; k < 2; k++) {
        tip->contact.end_gap[k] = gap;
        vec3_store(normal, tip->contact.end_normal[k]);
    }
}

void dpti_tips_find_contacts(struct dpt_world *world, struct tool *tool)
{
    for (uint32_t i = 0; i < tool->tip_count; i++) {
        struct tip *tip = tool_tip(world, tool, i);
        const struct tip_answer *answer = &tip->answer;
        if (!answer->is_exact && answer->body)
            continue;
        if (answer->body && answer->nearest.distance - tip->hull->radius <= world->def.margin)
            fill_contact(world, tool, i, tip);
        else
            tip->contact.id = 0;
    }
}

uint32_t dpti_tips_get_contacts(const struct dpt_world *world, const struct tool *tool, void *contacts,
                                uint32_t capacity, uint32_t stride)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < tool->tip_count; i++) {
        const struct tip *tip = tool_tip(world, tool, i);
        if (!tip->contact.id)
            continue;
        if (count < capacity)
            sized_write((char *)contacts + (size_t)count * stride, stride, &tip->contact, sizeof tip->contact);
        count++;
    }
    return count;
}

void dpti_tips_clear(struct dpt_world *world, struct tool *tool)
{
    for (uint32_t i = 0; i < tool->tip_count; i++) {
        struct tip *tip = tool_tip(world, tool, i);
        begin_hit(tool, i, tip);
    }
}

void dpti_tips_forget(struct dpt_world *world, struct tool *tool)
{
    dpti_tips_clear(world, tool);
    for (uint32_t i = 0; i < tool->tip_count; i++) {
        struct tip *tip = tool_tip(world, tool, i);
        memset(&tip->answer, 0, sizeof tip->answer);
        tip->last_body_id = tip->contact.id = 0;
    }
}

void dpti_tips_forget_body(struct dpt_world *world, uint32_t body_id)
{
    for (uint32_t i = 0; i < world->tip_count; i++) {
        struct tip *tip = &world->tips[i];
        if (tip->last_body_id == body_id)
            tip->last_body_id = 0;
        if (tip->contact.body == body_id)
            tip->contact.id = 0;
        if (tip->answer.body && tip->answer.body->id == body_id)
            memset(&tip->answer, 0, sizeof tip->answer);
    }
}

void dpti_tips_remove(struct dpt_world *world, struct tool *tool)
{
    const uint32_t end = tool->first_tip + tool->tip_count;
    memmove(&world->tips[tool->first_tip], &world->tips[end], (world->tip_count - end) * sizeof *world->tips);
    memmove(&world->tip_hulls[tool->first_tip], &world->tip_hulls[end],
            (world->tip_count - end) * sizeof *world->tip_hulls);
    for (uint32_t t = 0; t < world->tool_slot_end; t++)
        if (world->tools[t].slot.used && world->tools[t].first_tip >= end)
            world->tools[t].first_tip -= tool->tip_count;
    world->tip_count -= tool->tip_count;
    for (uint32_t i = tool->first_tip; i < world->tip_count; i++)
        if (world->tips[i].hull != world->tips[i].given)
            world->tips[i].hull = &world->tip_hulls[i];
    tool->tip_count = 0;
}

struct tip *dpti_tips_add(struct dpt_world *world, struct tool *tool, uint32_t count)
{
    tool->first_tip = world->tip_count;
    tool->tip_count = count;
    world->tip_count += count;
    return tool_tip(world, tool, 0);
}
