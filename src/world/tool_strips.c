/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/tool_strips.h"

#include "base/return_if_error.h"
#include "base/sized.h"
#include "nearest/nearest_pair.h"

/* Bytes of dpt_world_bytes for each segment, beside the strip itself. */
enum { BYTES_SEGMENT_STRIP = 640 };
typedef char segment_strip_fits[sizeof(struct segment_strip) <= BYTES_SEGMENT_STRIP ? 1 : -1];

dpt_strip_def dpti_strips_def(const dpt_world_def *def)
{
    return (dpt_strip_def){ .size = sizeof(dpt_strip_def),
                            .capacity = def->strip_capacity,
                            .search = def->strip == DPT_STRIP_KIND_ROUTES ? def->strip_search : 0 };
}

uint64_t dpti_strips_bytes(const dpt_world_def *def)
{
    const dpt_strip_def strip = dpti_strips_def(def);
    return def->strip ? (BYTES_SEGMENT_STRIP + (uint64_t)dpt_strip_bytes(&strip)) * def->max_segments : 0;
}

/* The strips of all segments lie behind the array of segment_strips. */
char *dpti_strips_place(struct dpt_world *world, char *at)
{
    const dpt_strip_def def = dpti_strips_def(&world->def);
    if (!world->def.strip)
        return at;
    const size_t bytes = dpt_strip_bytes(&def);
    world->segment_strips = (void *)at;
    at += BYTES_SEGMENT_STRIP * (size_t)world->def.max_segments;
    for (uint32_t i = 0; i < world->def.max_segments; i++, at += bytes)
        dpt_strip_create(at, bytes, &def, &world->segment_strips[i].strip);
    dpti_strips_forget(world, 0, world->def.max_segments);
    return at;
}

void dpti_strips_forget(struct dpt_world *world, uint32_t first, uint32_t end)
{
    for (uint32_t i = first; world->def.strip && i < end; i++) {
        struct segment_strip *segment_strip = &world->segment_strips[i];
        dpti_strip_clear(segment_strip->strip, NULL);
        dpti_strip_forget(segment_strip->strip);
        segment_strip->end_triangle[0] = segment_strip->end_triangle[1] = DPT_NONE;
        segment_strip->body_slot = DPT_NONE;
    }
}

void dpti_strips_forget_body(struct dpt_world *world, uint32_t slot)
{
    for (uint32_t i = 0; world->def.strip && i < world->segment_count; i++)
        if (world->segment_strips[i].body_slot == slot)
            dpti_strips_forget(world, i, i + 1);
}

void dpti_strips_note_vertices(struct dpt_world *world, uint32_t slot)
{
    for (uint32_t i = 0; world->def.strip && i < world->segment_count; i++)
        if (world->segment_strips[i].body_slot == slot)
            dpti_strip_forget(world->segment_strips[i].strip);
}

void dpti_strips_remove(struct dpt_world *world, uint32_t first, uint32_t end)
{
    uint32_t segments_moved = world->segment_count - end;
    if (!world->def.strip)
        return;
    dpti_strips_forget(world, first, end);
    for (uint32_t i = 0; i < segments_moved; i++) {
        const struct segment_strip moved_strip = world->segment_strips[end + i];
        world->segment_strips[end + i] = world->segment_strips[first + i];
        world->segment_strips[first + i] = moved_strip;
    }
}

/* From the nearest point to the axis, in the body's frame. If the axis crosses the surface: its exit direction. */
static vec3 direction_to_axis(const struct segment *segment, const struct segment_strip *segment_strip)
{
    const struct pair_search *nearest = &segment->answer.track.nearest;
    if (nearest->pair.distance2 > 0.0)
        return nearest->pair.gap;
    vec3 exit_direction = frame_turn_back(&segment_strip->frame, segment->penetration.direction);
    return dot(exit_direction, exit_direction) > 0.0
               ? exit_direction
               : dpti_surface_face_normal(&segment_strip->surface, nearest->triangle);
}

/* The side of an open sheet to which the tool would be pushed; without a penetration, the side on which it is. */
static int32_t side_of_tool(const struct segment *segment, const struct segment_strip *segment_strip, uint32_t triangle,
                            vec3 to_axis)
{
    if (!dpti_side_is_sheet(&segment_strip->surface, surface_part(&segment_strip->surface, triangle)))
        return 1;
    vec3 exit_direction = frame_turn_back(&segment_strip->frame, segment->penetration.direction);
    if (!(dot(exit_direction, exit_direction) > 0.0))
        exit_direction = to_axis;
    return dot(exit_direction, dpti_surface_face_normal(&segment_strip->surface, triangle)) < 0.0 ? -1 : 1;
}

/* Fill a strip by shadow. `direction` from the surface to the axis, in the body's frame; begins at `triangle`. */
static void put_shadow(const struct dpt_world *world, struct segment_strip *segment_strip, vec3 direction,
                       uint32_t triangle)
{
    const dpt_world_def *def = &world->def;
    double depth = def->strip_depth;
    if (depth == 0.0)
        depth = 0.25 * length(segment_strip->u) + segment_strip->radius + def->margin;
    if (!(dot(direction, direction) > 0.0))
        return;
    struct shadow_volume volume;
    dpti_shadow_volume_of(segment_strip->a, segment_strip->u, direction, segment_strip->radius + def->strip_width,
                          depth, &volume);
    dpti_strip_shadow(segment_strip->strip, &segment_strip->surface, &volume, triangle);
}

/* The place of the triangle nearest to an end of the axis: 0 is a, 1 is b. */
static uint32_t nearest_to_end(const struct dpt_world *world, const struct segment_strip *segment_strip, int end)
{
    const struct axis point = { .local_a = end ? add(segment_strip->a, segment_strip->u) : segment_strip->a };
    struct pair_search nearest;
    struct work work = work_of(WORK_UNLIMITED); /* strips are not part of the budget */
    dpti_dynamic_point_once(&segment_strip->surface, &world->kernel, DPT_METHOD_TREE, &point,
                            segment_strip->end_triangle[end], &work, &nearest);
    return nearest.triangle;
}

/*
 * Fill a strip by routes. It stays empty if no route leads from end to end, as when an end is nearest to another
 * part, and is marked full if the search has too little room.
 */
static void put_routes(const struct dpt_world *world, struct segment_strip *segment_strip, uint32_t triangle)
{
    for (int end = 0; end < 2; end++)
        segment_strip->end_triangle[end] = nearest_to_end(world, segment_strip, end);
    if (segment_strip->end_triangle[0] == DPT_NONE || segment_strip->end_triangle[1] == DPT_NONE)
        return;
    if (dpti_strip_routes(segment_strip->strip, segment_strip->surface.mesh, segment_strip->end_triangle[0],
                          segment_strip->end_triangle[1], triangle) == DPT_E_FULL)
        dpti_strip_set_full(segment_strip->strip);
}

void dpti_strips_find(struct dpt_world *world, uint32_t segment_index)
{
    const struct segment *segment = &world->segments[segment_index];
    const struct segment_result *result = &segment->result;
    const struct body *body = segment->answer.body;
    struct segment_strip *segment_strip = &world->segment_strips[segment_index];
    if (!body)
        return;
    if (result->contact != DPT_CONTACT_PENETRATING && !(result->distance - segment->radius <= world->def.margin))
        return;
    const struct axis *axis = &segment->answer.track.axis;
    const int is_other = segment_strip->body_slot != handle_index(body->id);
    if (is_other)
        segment_strip->end_triangle[0] = segment_strip->end_triangle[1] = DPT_NONE;
    const int was_near = !is_other && world_was_last_tick(world, segment_strip->tick);
    segment_strip->is_new = !was_near;
    segment_strip->a_last = was_near ? segment_strip->a : axis->local_a;
    segment_strip->u_last = was_near ? segment_strip->u : axis->u;
    segment_strip->tick = world->ticks;
    segment_strip->body_slot = handle_index(body->id);
    segment_strip->surface = body->surface;
    segment_strip->frame = body->frame;
    segment_strip->radius = segment->radius;
    segment_strip->a = axis->local_a;
    segment_strip->u = axis->u;
    const uint32_t triangle = segment->answer.track.nearest.triangle;
    vec3 to_axis = direction_to_axis(segment, segment_strip);
    segment_strip->side = side_of_tool(segment, segment_strip, triangle, to_axis);
    if (world->def.strip == DPT_STRIP_KIND_SHADOW)
        put_shadow(world, segment_strip, to_axis, triangle);
    else
        put_routes(world, segment_strip, triangle);
}

dpt_result dpt_tool_get_strip(const dpt_world *world, dpt_tool tool, uint32_t segment, dpt_overlap *overlaps,
                              uint32_t capacity, uint32_t *count, uint32_t *flags)
{
    if (count)
        *count = 0;
    if (flags)
        *flags = 0;
    if (!world || !count || (!overlaps && capacity))
        return DPT_E_ARGUMENT;
    if (capacity)
        DPT_TRY(sized_check(overlaps, sizeof *overlaps, 1));
    const struct tool *owner = world_find_tool(world, tool);
    if (!owner)
        return DPT_E_HANDLE;
    if (segment >= owner->segment_count)
        return DPT_E_ARGUMENT;
    if (!world->def.strip)
        return DPT_OK;
    const struct segment_strip *segment_strip = &world->segment_strips[owner->first_segment + segment];
    dpt_strip_get_triangles(segment_strip->strip, count, flags);
    if (!*count)
        return DPT_OK; /* its body may be gone, with its vertices */
    /* Vertices may have moved since: the strip is of the last step. */
    const struct surface surface = surface_view(&segment_strip->surface, world_coming_tick(world), 0.0);
    const struct strip_tool tool_at = { segment_strip->a, segment_strip->u, segment_strip->radius,
                                        segment_strip->side };
    dpti_strip_overlaps(segment_strip->strip, &surface, &segment_strip->frame, &tool_at, overlaps, capacity);
    return DPT_OK;
}
