/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/tool_strips.h"

#include "base/return_if_error.h"
#include "base/sized.h"
#include "nearest/side.h"

/* A share of dpt_world_bytes. */
enum { BYTES_LAID = 512 };
typedef char laid_fits[sizeof(struct laid) <= BYTES_LAID ? 1 : -1];

dpt_strip_def dpti_strips_def(const dpt_world_def *def)
{
    return (dpt_strip_def){ .size = sizeof(dpt_strip_def),
                            .capacity = def->strip_capacity,
                            .search = def->strip == DPT_STRIP_KIND_ROUTES ? def->strip_search : 0 };
}

uint64_t dpti_strips_bytes(const dpt_world_def *def)
{
    const dpt_strip_def strip = dpti_strips_def(def);
    return def->strip ? (BYTES_LAID + (uint64_t)dpt_strip_bytes(&strip)) * def->max_segments : 0;
}

/* The strips of all segments, behind the list of them. */
char *dpti_strips_place(struct dpt_world *world, char *at)
{
    const dpt_strip_def def = dpti_strips_def(&world->def);
    if (!world->def.strip)
        return at;
    const size_t bytes = dpt_strip_bytes(&def);
    world->laid = (void *)at;
    at += BYTES_LAID * (size_t)world->def.max_segments;
    for (uint32_t i = 0; i < world->def.max_segments; i++, at += bytes)
        dpt_strip_create(at, bytes, &def, &world->laid[i].strip);
    dpti_strips_forget(world, 0, world->def.max_segments);
    return at;
}

void dpti_strips_forget(struct dpt_world *world, uint32_t first, uint32_t end)
{
    for (uint32_t i = first; world->def.strip && i < end; i++) {
        struct laid *laid = &world->laid[i];
        dpti_strip_clear(laid->strip, NULL);
        dpti_strip_forget(laid->strip);
        laid->end[0] = laid->end[1] = DPT_NONE;
        laid->body = DPT_NONE;
    }
}

void dpti_strips_forget_body(struct dpt_world *world, uint32_t body)
{
    for (uint32_t i = 0; world->def.strip && i < world->segment_count; i++)
        if (world->laid[i].body == body)
            dpti_strips_forget(world, i, i + 1);
}

void dpti_strips_remove(struct dpt_world *world, uint32_t first, uint32_t end)
{
    uint32_t moved = world->segment_count - end;
    if (!world->def.strip)
        return;
    dpti_strips_forget(world, first, end);
    for (uint32_t i = 0; i < moved; i++) {
        const struct laid up = world->laid[end + i];
        world->laid[end + i] = world->laid[first + i];
        world->laid[first + i] = up;
    }
}

/* From the nearest point to the axis, or where that crosses along its push; in the body's frame. */
static vec3 way_to_axis(const struct segment *segment, const struct laid *laid)
{
    const struct pair_search *nearest = &segment->answer.track.nearest;
    if (nearest->pair.distance2 > 0.0)
        return nearest->pair.gap;
    vec3 push = frame_turn_back(&laid->frame, segment->push.direction);
    return dot(push, push) > 0.0 ? push
                                 : dpti_surface_face_normal(&laid->surface, nearest->triangle);
}

/* Of an open sheet, that to which the tool would be pushed, or on which it is. */
static int32_t side_of_tool(const struct segment *segment, const struct laid *laid, uint32_t place,
                            vec3 to_axis)
{
    if (!dpti_side_is_sheet(&laid->surface, surface_part(&laid->surface, place)))
        return 1;
    vec3 out = frame_turn_back(&laid->frame, segment->push.direction);
    if (!(dot(out, out) > 0.0))
        out = to_axis;
    return dot(out, dpti_surface_face_normal(&laid->surface, place)) < 0.0 ? -1 : 1;
}

static void lay_shadow(const struct dpt_world *world, struct laid *laid, vec3 way, uint32_t place)
{
    const dpt_world_def *def = &world->def;
    double depth = def->strip_depth;
    if (depth == 0.0)
        depth = 0.25 * length(laid->u) + laid->radius + def->margin;
    if (!(dot(way, way) > 0.0))
        return;
    struct shade shade;
    dpti_shade_of(laid->a, laid->u, way, laid->radius + def->strip_width, depth, &shade);
    dpti_strip_shadow(laid->strip, &laid->surface, &shade, place);
}

/* The triangle nearest to an end of the axis. */
static uint32_t nearest_to_end(const struct dpt_world *world, const struct laid *laid, int end)
{
    const struct axis point = { .local_a = end ? add(laid->a, laid->u) : laid->a };
    struct pair_search nearest;
    struct work work = work_of(WORK_UNLIMITED); /* no budget counts strips */
    dpti_track_once(&laid->surface, &world->kernel, DPT_METHOD_TREE, &point, laid->end[end], &work,
                    &nearest);
    return nearest.triangle;
}

/* Nothing where no route leads there, as when an end is nearest to another part; full where the search is too small. */
static void lay_routes(const struct dpt_world *world, struct laid *laid, uint32_t place)
{
    for (int end = 0; end < 2; end++)
        laid->end[end] = nearest_to_end(world, laid, end);
    if (laid->end[0] == DPT_NONE || laid->end[1] == DPT_NONE)
        return;
    if (dpti_strip_routes(laid->strip, laid->surface.mesh, laid->end[0], laid->end[1], place) ==
        DPT_E_FULL)
        dpti_strip_set_full(laid->strip);
}

void dpti_strips_find(struct dpt_world *world, uint32_t index)
{
    const struct segment *segment = &world->segments[index];
    const struct segment_result *result = &segment->result;
    const struct body *body = segment->answer.body;
    struct laid *laid = &world->laid[index];
    if (!body)
        return;
    if (result->contact != DPT_CONTACT_PENETRATING &&
        !(result->distance - segment->radius <= world->def.margin))
        return;
    if (laid->body != handle_index(body->id))
        laid->end[0] = laid->end[1] = DPT_NONE;
    laid->body = handle_index(body->id);
    laid->surface = body->surface;
    laid->frame = body->frame;
    laid->radius = segment->radius;
    laid->a = segment->answer.track.axis.local_a;
    laid->u = segment->answer.track.axis.u;
    const uint32_t place = segment->answer.track.nearest.triangle;
    vec3 to_axis = way_to_axis(segment, laid);
    laid->side = side_of_tool(segment, laid, place, to_axis);
    if (world->def.strip == DPT_STRIP_KIND_SHADOW)
        lay_shadow(world, laid, to_axis, place);
    else
        lay_routes(world, laid, place);
}

dpt_result dpt_tool_get_strip(const dpt_world *world, dpt_tool tool, uint32_t segment,
                              dpt_overlap *overlaps, uint32_t capacity, uint32_t *count,
                              uint32_t *flags)
{
    if (count)
        *count = 0;
    if (flags)
        *flags = 0;
    if (!world || !count || (!overlaps && capacity))
        return DPT_E_ARGUMENT;
    if (capacity)
        DPT_TRY(sized_check(overlaps, sizeof *overlaps, 1));
    const struct tool *asked = world_find_tool(world, tool);
    if (!asked)
        return DPT_E_HANDLE;
    if (segment >= asked->count)
        return DPT_E_ARGUMENT;
    if (!world->def.strip)
        return DPT_OK;
    const struct laid *laid = &world->laid[asked->first + segment];
    dpt_strip_get_triangles(laid->strip, count, flags);
    dpti_strip_overlaps(laid->strip, &laid->surface, &laid->frame, laid->a, laid->u, laid->radius,
                        laid->side, overlaps, capacity);
    return DPT_OK;
}
