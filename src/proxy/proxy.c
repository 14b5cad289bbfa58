/* SPDX-License-Identifier: BSD-3-Clause */
#include "proxy/proxy.h"

#include "base/quaternion.h"
#include "insertion/world_channels.h"
#include "proxy/patch_sides.h"
#include "track/tool_parts.h"

enum { BYTES_PROXY = 1584 };
typedef char proxy_fits[sizeof(struct proxy) <= BYTES_PROXY ? 1 : -1];

/* As a share of the largest diagonal of all bodies, which counts up to PROXY_SCALE_MAX. */
#define CLEARANCE 2e-6

double dpti_proxy_clearance(const struct dpt_world *world)
{
    return CLEARANCE * min_of(world->largest_diagonal, PROXY_SCALE_MAX);
}

uint64_t dpti_proxy_bytes(const dpt_world_def *def)
{
    return def->until == DPT_UNTIL_RESPOND ? BYTES_PROXY * (uint64_t)def->max_tools + dpti_patch_bytes(def) : 0;
}

char *dpti_proxy_place(struct dpt_world *world, char *at)
{
    world->proxies = (void *)at;
    world->patches = (void *)(at + BYTES_PROXY * (size_t)world->def.max_tools);
    return at + dpti_proxy_bytes(&world->def);
}

int dpti_proxy_is_of(const struct dpt_world *world, uint32_t law)
{
    return law == DPT_LAW_PROXY && world->def.until == DPT_UNTIL_RESPOND && world->def.method != DPT_METHOD_PAPER;
}

int dpti_proxy_is_used(const struct dpt_world *world, const struct tool *tool)
{
    return dpti_proxy_is_of(world, tool->law);
}

void dpti_proxy_forget(struct dpt_world *world, struct tool *tool)
{
    if (world->def.until != DPT_UNTIL_RESPOND)
        return;
    struct proxy *proxy = proxy_of(world, tool);
    *proxy = (struct proxy){ .length = proxy->length, .radius = proxy->radius };
    dpti_patches_forget(world, tool);
    dpti_insertion_forget(world, tool);
}

void dpti_proxy_remember(struct proxy *proxy, uint32_t segment, uint32_t body, uint32_t triangle)
{
    uint32_t oldest = 0;
    for (uint32_t i = 0; i < PROXY_MEMORY; i++) {
        const struct proxy_triangle *entry = &proxy->memory[i];
        if (entry->body_id == body && entry->triangle == triangle && entry->segment == segment) {
            proxy->used[i] = ++proxy->clock;
            return;
        }
        if (proxy->used[i] < proxy->used[oldest])
            oldest = i;
    }
    proxy->memory[oldest] = (struct proxy_triangle){ segment, body, triangle };
    proxy->used[oldest] = ++proxy->clock;
}

void dpti_proxy_leave(struct proxy *proxy)
{
    if (proxy->has_home || proxy->state < PROXY_DOUBTED)
        return;
    proxy->end = proxy->pose;
    proxy->home_tick = proxy->tick;
    proxy->has_home = 1;
    proxy->has_been_inside = 0;
}

int dpti_proxy_forget_triangles(struct proxy *proxy, uint32_t body)
{
    int has_any = 0;
    for (uint32_t i = 0; i < PROXY_MEMORY; i++)
        if (proxy->memory[i].body_id == body) {
            proxy->memory[i] = (struct proxy_triangle){ .body_id = 0 };
            proxy->used[i] = 0;
            has_any = 1;
        }
    for (uint32_t i = 0; i < PROXY_CONTACTS_MAX; i++)
        if (proxy->contacts[i].body_id == body)
            proxy->contacts[i] = (struct proxy_contact){ .body_id = 0 };
    return has_any;
}

void dpti_proxy_forget_body(struct dpt_world *world, uint32_t body)
{
    for (uint32_t t = 0; world->def.until == DPT_UNTIL_RESPOND && t < world->tool_slot_end; t++) {
        struct proxy *proxy = &world->proxies[t];
        if (!dpti_proxy_forget_triangles(proxy, body))
            continue;
        proxy->is_released = 1;
        proxy->fade.time_left = 0.0;
    }
}

void dpti_proxy_note_body(struct dpt_world *world, uint32_t slot)
{
    for (uint32_t t = 0; t < world->tool_slot_end; t++) {
        const struct tool *tool = &world->tools[t];
        if (!tool->slot.used || !dpti_proxy_is_used(world, tool))
            continue;
        struct proxy *proxy = &world->proxies[t];
        struct frame frame;
        frame_of_pose(&proxy->pose, &frame);
        for (uint32_t i = 0; proxy->state >= PROXY_DOUBTED && i < tool_part_count(tool); i++) {
            const struct part part = tool_part(world, tool, i);
            const struct box box = dpti_part_box(part, &frame);
            const double away = box_distance(&box, &world->boxes[slot]) - part_radius(part);
            proxy->gap = min_of(proxy->gap, away);
            if (away <= 0.0) {
                dpti_proxy_leave(proxy);
                proxy->state = PROXY_DOUBTED;
            }
        }
    }
}

static struct segment *segment_of(const struct dpt_world *world, const struct tool *tool)
{
    return &world->segments[tool->first_segment];
}

dpt_segment dpti_proxy_given_segment(const struct dpt_world *world, const struct tool *tool)
{
    const struct proxy *proxy = proxy_of(world, tool);
    const struct frame device = tool_device_frame(tool);
    dpt_segment given = { .radius = proxy->radius };
    vec3_store(device.origin, given.a);
    vec3_store(along(device.origin, proxy->length, device.x), given.b);
    return given;
}

void dpti_proxy_set_free(struct dpt_world *world, struct tool *tool, uint32_t is_free)
{
    if (!dpti_proxy_is_used(world, tool))
        return;
    dpti_proxy_forget(world, tool);
    if (is_free)
        return;
    const dpt_pose identity = DPT_POSE_IDENTITY;
    const dpt_segment given = dpti_proxy_given_segment(world, tool);
    struct segment *segment = segment_of(world, tool);
    segment->a = vec3_of(given.a);
    segment->b = vec3_of(given.b);
    segment->radius = given.radius;
    tool->pose = identity;
}

void dpti_proxy_set_segment(struct dpt_world *world, struct tool *tool, const dpt_segment *given)
{
    struct proxy *proxy = proxy_of(world, tool);
    struct segment *segment = segment_of(world, tool);
    const dpt_pose pose = tool->pose;
    const double length_before = proxy->length, radius_before = proxy->radius;
    struct quaternion turn = quaternion_unit(quaternion_of(tool->pose.orientation));
    const vec3 u = sub(vec3_of(given->b), vec3_of(given->a));
    const double size = length(u);
    const vec3 x = quaternion_turn(turn, (vec3){ 1.0, 0.0, 0.0 });
    if (size > 0.0)
        turn = quaternion_unit(quaternion_product(quaternion_of_turn(x, scaled(u, 1.0 / size)), turn));
    quaternion_store(turn, tool->pose.orientation);
    memcpy(tool->pose.position, given->a, sizeof tool->pose.position);
    proxy->length = size;
    proxy->radius = given->radius;
    tool->has_changed |= !pose_is_same(&pose, &tool->pose) || size != length_before || given->radius != radius_before;
    segment->a = (vec3){ 0.0, 0.0, 0.0 };
    segment->tool_slot = (uint32_t)(tool - world->tools);
    if (proxy->state >= PROXY_DOUBTED)
        return;
    segment->b = (vec3){ size, 0.0, 0.0 };
    segment->radius = given->radius;
}

void dpti_proxy_follow_size(struct dpt_world *world, const struct tool *tool, struct proxy *proxy)
{
    struct segment *segment = segment_of(world, tool);
    if (proxy->state < PROXY_DOUBTED) { /* it begins: maybe since a reset, after the size was given */
        segment->b.x = proxy->length;
        segment->radius = proxy->radius;
        return;
    }
    double spare = max_of(0.0, proxy->gap - proxy->min_gap);
    const double length_before = segment->b.x, radius_before = segment->radius;
    segment->b.x = min_of(proxy->length, length_before + spare);
    spare = max_of(0.0, spare - max_of(0.0, segment->b.x - length_before));
    segment->radius = min_of(proxy->radius, radius_before + spare);
    proxy->gap -= max_of(0.0, segment->b.x - length_before) + max_of(0.0, segment->radius - radius_before);
}

int dpti_proxy_has_size(const struct dpt_world *world, const struct tool *tool)
{
    const struct proxy *proxy = proxy_of(world, tool);
    const struct segment *segment = segment_of(world, tool);
    return !tool->is_free || (segment->b.x == proxy->length && segment->radius == proxy->radius);
}

/* Whether a body has moved since the last step, whose answers are asked for. */
static int has_moved_since(const struct dpt_world *world, const struct body *body)
{
    return body->moved_tick == world_coming_tick(world);
}

/* Where it was in the last step. */
static struct frame frame_in_step(const struct dpt_world *world, const struct body *body)
{
    struct frame frame = body->frame;
    if (has_moved_since(world, body))
        frame_of_pose(&body->previous_pose, &frame);
    return frame;
}

/* With one body, without a history. 0: the budget ended the search. */
static int find_pair(const struct dpt_world *world, uint32_t index, uint32_t slot, struct work *work,
                     struct dynamic_point *track)
{
    const struct body *body = &world->bodies[slot];
    struct bvh_traversal traversal;
    traversal.level = 0;
    dpti_dynamic_point_begin(track, &body->surface, *world_last_triangle(world, index, slot), HUGE_VAL, DESCENT_NONE,
                             work);
    return dpti_dynamic_point_prove(track, &body->surface, &world->kernel, NULL, &traversal, work);
}

/* Over all bodies; returns the distance. *is_exact: no budget ended a search. */
static double find_nearest(const struct dpt_world *world, uint32_t index, vec3 a, vec3 b, struct work *work,
                           struct body_answer *best, int *is_exact)
{
    const struct box box = box_of_axis(a, b);
    double distance = HUGE_VAL;
    *is_exact = 1;
    best->body = NULL;
    for (uint32_t i = 0; i < world->body_slot_end && distance > 0.0; i++) {
        const struct body *body = &world->bodies[i];
        struct dynamic_point track;
        if (!body_is_there(body) || (!has_moved_since(world, body) && box_distance(&box, &world->boxes[i]) > distance))
            continue;
        const struct frame frame = frame_in_step(world, body);
        axis_of(&body->surface, &frame, a, b, &track.axis);
        *is_exact &= find_pair(world, index, i, work, &track);
        if (track.nearest.triangle == DPT_NONE || !(sqrt(track.nearest.pair.distance2) < distance))
            continue;
        distance = sqrt(track.nearest.pair.distance2);
        best->track = track;
        best->body = body;
    }
    return distance;
}

/* The pair of a segment that is searched for, of which the budget may have left a bound. */
static void find_hit(const struct dpt_world *world, const struct tool *tool, uint32_t index, struct work *work,
                     struct body_answer *best, struct segment_result *result)
{
    const struct device_axis *axis = &world->segments[index].device;
    const double radius = world->segments[index].radius;
    int is_exact;
    const double distance = find_nearest(world, index, axis->a, axis->b, work, best, &is_exact);
    if (!best->body)
        return;
    dpti_segment_result_of_pair(&best->track.axis, &best->track.nearest.pair, result);
    if (is_exact || !(distance > 0.0))
        return;
    /* Nothing is nearer than it is to the proxy, less what the two are apart. */
    result->status = DPT_STATUS_BOUNDED;
    result->lower_bound = max_of(0.0, proxy_of(world, tool)->gap + radius - axis->apart - result->error_bound);
    result->error_bound = distance - result->lower_bound;
}

static struct device_axis device_axis_of(const struct dpt_world *world, const struct tool *tool,
                                         const struct segment *segment, const struct frame *device)
{
    const vec3 end = tool->is_free ? (vec3){ proxy_of(world, tool)->length, 0.0, 0.0 } : segment->b;
    struct device_axis axis = { .a = frame_to_world(device, segment->a), .b = frame_to_world(device, end) };
    const vec3 proxy_a = frame_to_world(&tool->felt_frame, segment->a);
    const vec3 proxy_b = frame_to_world(&tool->felt_frame, segment->b);
    axis.apart = max_of(length(sub(axis.a, proxy_a)), length(sub(axis.b, proxy_b)));
    return axis;
}

/* The hit of a segment; with `near_only` without a search where what is known of it at the proxy leaves it far. */
static void write_hit(const struct dpt_world *world, const struct tool *tool, uint32_t number, struct work *work,
                      struct min_distance *min)
{
    const uint32_t index = tool->first_segment + number;
    struct segment *segment = &world->segments[index];
    const struct device_axis *axis = &segment->device;
    const double lower_bound = segment->result.lower_bound - axis->apart - segment->answer.error_bound;
    const uint32_t work_before = work->done;
    struct body_answer best = { .body = segment->answer.body, .track = segment->answer.track };
    struct segment_result result;
    segment->answer.is_far =
        far_is_used(world, tool) && best.body && min_distance_is_below(min, lower_bound, segment->radius);
    if (segment->answer.is_far)
        dpti_far_pair(best.body, axis->a, axis->b, lower_bound, &best.track, &result);
    else
        find_hit(world, tool, index, work, &best, &result);
    if (!best.body)
        return;
    /* The proxy was held back: the device is behind a surface, however far that is. */
    result.contact = DPT_CONTACT_PENETRATING;
    result.work = segment->result.work + work->done - work_before;
    const struct frame frame = frame_in_step(world, best.body);
    dpti_segment_result_write(&result, &best.body->surface, &frame, best.body->id, &best.track.nearest, &segment->hit);
    min_distance_take(min, result.distance, segment->radius);
}

int dpti_proxy_is_away(const struct dpt_world *world, const struct tool *tool)
{
    return dpti_proxy_is_used(world, tool) && (proxy_of(world, tool)->is_held || !dpti_proxy_has_size(world, tool));
}

void dpti_proxy_note_device(const struct dpt_world *world, const struct tool *tool)
{
    const struct frame device = tool_device_frame(tool);
    for (uint32_t i = 0; i < tool->segment_count; i++) {
        struct segment *segment = &world->segments[tool->first_segment + i];
        segment->device = device_axis_of(world, tool, segment, &device);
    }
}

void dpti_proxy_write_hits(const struct dpt_world *world, const struct tool *tool, struct work *work)
{
    struct min_distance min = min_distance_none();
    const uint32_t first = tool->closest < tool->segment_count ? tool->closest : 0;
    for (uint32_t i = 0; i < tool->segment_count; i++)
        write_hit(world, tool, (first + i) % tool->segment_count, work, &min);
}
