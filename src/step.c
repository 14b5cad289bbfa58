/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * One tick:
 *
 *     for each tool, for each of its segments
 *         track      the nearest pair over all bodies
 *         contact    its side, gap and direction
 *         respond    the penalty force
 *
 * The body that was nearest last tick is asked first: what it answers bounds the search of the others.
 */
#include "check.h"
#include "paper.h"
#include "respond.h"
#include "world.h"

/* The best answer over all bodies. */
struct found {
    const struct body *body;
    struct axis axis;
    struct nearest nearest;
    uint32_t work;
};

static void ask_body(struct dpt_world *world, uint32_t segment, uint32_t index, vec3 a, vec3 b,
                     struct found *best)
{
    const struct body *body = &world->bodies[index];
    struct axis axis;
    struct nearest nearest;
    uint32_t *last = world_last(world, segment, index);
    double limit2 = best->body ? best->nearest.pair.distance2 : HUGE_VAL;
    axis_of(&body->tree, &body->frame, a, b, &axis);
    const struct keeper keeper = { &world->certificate, world_owner(world, segment, index) };
    track_next(&body->tree, &world->kernel, world->def.method == DPT_METHOD_EXACT ? &keeper : NULL,
               world->def.method, &axis, *last, limit2, &nearest);
    best->work += nearest.work;
    if (nearest.triangle == DPT_NONE || nearest.pair.distance2 >= limit2)
        return;
    *last = nearest.triangle;
    best->body = body;
    best->axis = axis;
    best->nearest = nearest;
}

static void track(struct dpt_world *world, uint32_t segment, vec3 a, vec3 b, struct found *best)
{
    uint32_t first = world->segments[segment].last_body;
    *best = (struct found){ .body = NULL };
    if (first != DPT_NONE)
        ask_body(world, segment, first, a, b, best);
    for (uint32_t i = 0; i < world->body_end; i++)
        if (i != first && world->bodies[i].slot.used)
            ask_body(world, segment, i, a, b, best);
}

/* The exact methods: returns what the segment pushes with. */
static struct push exact_segment(struct dpt_world *world, uint32_t index, vec3 a, vec3 b,
                                 dpt_hit *hit, const struct body **body, vec3 *at)
{
    struct push push = { { 0.0, 0.0, 0.0 }, 0.0 };
    struct segment *segment = &world->segments[index];
    struct found best;
    track(world, index, a, b, &best);
    *body = best.body;
    if (!best.body)
        return push;
    segment->last_body = handle_index(best.body->id);
    track_hit(&best.body->tree, &best.axis, &best.body->frame, &best.nearest, hit);
    hit->body = best.body->id;
    hit->work = best.work;
    *at = vec3_of(hit->p);
    if (world->def.until != DPT_UNTIL_TRACK)
        push = contact_of(&best.body->tree, &best.axis, &best.nearest, segment->radius, hit);
    return push;
}

/* Adds the segment's part to the tool's wrench. */
static void step_segment(struct dpt_world *world, struct tool *tool, uint32_t index, vec3 origin)
{
    struct segment *segment = &world->segments[tool->first + index];
    vec3 a = frame_to_world(&tool->frame, segment->a);
    vec3 b = frame_to_world(&tool->frame, segment->b);
    const struct body *body;
    vec3 at;
    struct push push =
        world->def.method == DPT_METHOD_PAPER
            ? paper_segment(world, tool->first + index, a, b, &segment->hit, &body, &at)
            : exact_segment(world, tool->first + index, a, b, &segment->hit, &body, &at);
    if (push.depth > 0.0 && world->def.until == DPT_UNTIL_RESPOND)
        respond_penalty(&push, &body->frame, world->def.stiffness, at, origin, &tool->wrench);
}

static double surface_distance(const struct segment *segment)
{
    return segment->hit.distance - segment->radius;
}

static void step_tool(struct dpt_world *world, struct tool *tool)
{
    tool_clear(world, tool);
    struct segment *segments = &world->segments[tool->first];
    vec3 origin = tool->free ? segments[0].a : tool->frame.origin;
    for (uint32_t i = 0; i < tool->count; i++) {
        step_segment(world, tool, i, origin);
        if (surface_distance(&segments[i]) < surface_distance(&segments[tool->nearest]))
            tool->nearest = i;
    }
}

/* How grave a contact is: penetrating before touching before unknown before separated. */
static int gravity(uint32_t contact)
{
    switch (contact) {
    case DPT_CONTACT_PENETRATING:
        return 3;
    case DPT_CONTACT_TOUCHING:
        return 2;
    case DPT_CONTACT_UNKNOWN:
        return 1;
    default:
        return 0;
    }
}

static void report(const struct dpt_world *world, dpt_step *out)
{
    int any = 0;
    out->status = DPT_STATUS_EXACT;
    out->contact = DPT_CONTACT_SEPARATED;
    out->work = 0;
    out->distance = 0.0;
    for (uint32_t t = 0; t < world->tool_end; t++) {
        const struct tool *tool = &world->tools[t];
        for (uint32_t i = 0; tool->slot.used && i < tool->count; i++) {
            const dpt_hit *hit = &world->segments[tool->first + i].hit;
            out->work += hit->work;
            if (hit->status < out->status)
                out->status = hit->status;
            if (gravity(hit->contact) > gravity(out->contact))
                out->contact = hit->contact;
            if (hit->status != DPT_STATUS_STALE && (!any || hit->distance < out->distance)) {
                out->distance = hit->distance;
                any = 1;
            }
        }
    }
    if (!any) {
        out->status = DPT_STATUS_STALE;
        out->contact = DPT_CONTACT_UNKNOWN;
    }
}

/* Every body's pose is known. */
static int bodies_are_valid(const struct dpt_world *world)
{
    for (uint32_t i = 0; i < world->body_end; i++)
        if (world->bodies[i].slot.used && !world->bodies[i].valid)
            return 0;
    return 1;
}

dpt_result dpt_world_step(dpt_world *world, double dt, dpt_step *out)
{
    if (!world)
        return DPT_E_ARGUMENT;
    dpt_result result = DPT_OK;
    if (!(dt > 0.0 && within(dt, 1e6)))
        result = DPT_E_ARGUMENT;
    else if (out && out->size < sizeof *out)
        result = DPT_E_SIZE;
    int valid = result == DPT_OK && bodies_are_valid(world);
    for (uint32_t t = 0; t < world->tool_end; t++) {
        struct tool *tool = &world->tools[t];
        if (!tool->slot.used)
            continue;
        if (valid && tool->valid)
            step_tool(world, tool);
        else
            tool_clear(world, tool);
    }
    if (out && result != DPT_E_SIZE)
        report(world, out);
    return result;
}

dpt_result dpt_tool_get_segment_hit(const dpt_world *world, dpt_tool tool, uint32_t segment,
                                    dpt_hit *hit)
{
    if (!world || !hit)
        return DPT_E_ARGUMENT;
    uint32_t size = hit->size;
    if (size < sizeof *hit)
        return DPT_E_SIZE;
    *hit = (dpt_hit){ .size = size, .status = DPT_STATUS_STALE, .triangle = DPT_NONE };
    const struct tool *asked = world_tool(world, tool);
    if (!asked)
        return DPT_E_HANDLE;
    if (segment >= asked->count)
        return DPT_E_ARGUMENT;
    *hit = world->segments[asked->first + segment].hit;
    hit->size = size;
    return DPT_OK;
}

dpt_result dpt_tool_get_hit(const dpt_world *world, dpt_tool tool, dpt_hit *hit)
{
    const struct tool *asked = world ? world_tool(world, tool) : NULL;
    return dpt_tool_get_segment_hit(world, tool, asked ? asked->nearest : 0, hit);
}

dpt_result dpt_tool_get_wrench(const dpt_world *world, dpt_tool tool, dpt_wrench *wrench)
{
    if (!wrench)
        return DPT_E_ARGUMENT;
    memset(wrench, 0, sizeof *wrench);
    const struct tool *asked = world ? world_tool(world, tool) : NULL;
    if (!asked)
        return world ? DPT_E_HANDLE : DPT_E_ARGUMENT;
    *wrench = asked->wrench;
    return DPT_OK;
}
