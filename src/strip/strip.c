/* SPDX-License-Identifier: BSD-3-Clause */
#include "strip/strip_state.h"

#include "base/frame.h"
#include "base/return_if_error.h"
#include "base/sized.h"
#include "nearest/nearest_pair.h"
#include "nearest/segment_triangle.h"

enum { CAPACITY_MAX = 1 << 20, SEARCH_VERTICES_MAX = 1 << 28 };

/* The least power of two that is at least 16 and `minimum`. */
static uint64_t power_of_two_from(uint64_t minimum)
{
    uint64_t power = 16;
    while (power < minimum)
        power *= 2;
    return power;
}

/* The offsets of a strip's arrays in its block, bytes, in their order. */
struct strip_layout {
    uint64_t triangles, walk_triangles, walk_vertices, walk_slots, search_slots, search_queue;
    uint64_t bytes; /* of all */
};

/* Reserve `count` items of `width` bytes at the end. Returns their offset. */
static uint64_t reserve(uint64_t *end, uint64_t count, uint64_t width)
{
    uint64_t begin = *end;
    *end = mesh_aligned(begin + count * width);
    return begin;
}

static uint64_t search_slot_count(const dpt_strip_def *def)
{
    return def->search ? power_of_two_from(2 * (uint64_t)def->search) : 0;
}

static struct strip_layout layout_of(const dpt_strip_def *def)
{
    struct strip_layout layout;
    uint64_t end = mesh_aligned(sizeof(struct dpt_strip)), capacity = def->capacity;
    layout.triangles = reserve(&end, capacity, sizeof(uint32_t));
    layout.walk_triangles = reserve(&end, capacity, sizeof(struct shadow_triangle));
    layout.walk_vertices = reserve(&end, capacity + 2, sizeof(struct shadow_vertex));
    layout.walk_slots = reserve(&end, power_of_two_from(2 * capacity), sizeof(struct shadow_slot));
    layout.search_slots = reserve(&end, search_slot_count(def), sizeof(struct visited_vertex));
    layout.search_queue = reserve(&end, def->search, sizeof(uint32_t));
    layout.bytes = end;
    return layout;
}

/* Read and check the caller's def. */
static dpt_result read_def(const dpt_strip_def *caller_def, dpt_strip_def *def)
{
    *def = (dpt_strip_def){ .size = sizeof *def };
    if (!caller_def)
        return DPT_E_ARGUMENT;
    DPT_TRY(sized_read(caller_def, sizeof *def, def, sizeof *def));
    if (!def->capacity || def->capacity > CAPACITY_MAX || def->search > SEARCH_VERTICES_MAX || def->reserved)
        return DPT_E_ARGUMENT;
    return DPT_OK;
}

size_t dpt_strip_bytes(const dpt_strip_def *caller_def)
{
    dpt_strip_def def;
    if (read_def(caller_def, &def) != DPT_OK)
        return 0;
    uint64_t bytes = layout_of(&def).bytes;
    return bytes <= SIZE_MAX ? (size_t)bytes : 0;
}

dpt_result dpt_strip_create(void *block, size_t bytes, const dpt_strip_def *caller_def, dpt_strip **strip)
{
    dpt_strip_def def;
    if (!block || !strip)
        return DPT_E_ARGUMENT;
    DPT_TRY(read_def(caller_def, &def));
    if ((uintptr_t)block % 8)
        return DPT_E_ALIGN;
    const struct strip_layout layout = layout_of(&def);
    if (bytes < layout.bytes)
        return DPT_E_MEMORY;
    memset(block, 0, (size_t)layout.bytes);
    struct dpt_strip *created = block;
    char *base = block;
    created->def = def;
    created->triangles = (void *)(base + layout.triangles);
    created->walk.triangles = (void *)(base + layout.walk_triangles);
    created->walk.vertices = (void *)(base + layout.walk_vertices);
    created->walk.slots = (void *)(base + layout.walk_slots);
    created->walk.slot_count = (uint32_t)power_of_two_from(2 * (uint64_t)def.capacity);
    created->walk.capacity = def.capacity;
    created->search.slots = (void *)(base + layout.search_slots);
    created->search.queue = (void *)(base + layout.search_queue);
    created->search.slot_count = (uint32_t)search_slot_count(&def);
    created->search.queue_capacity = def.search;
    *strip = created;
    return DPT_OK;
}

void dpti_strip_clear(struct dpt_strip *strip, const struct dpt_mesh *mesh)
{
    strip->mesh = mesh;
    strip->count = 0;
    strip->flags = 0;
}

void dpti_strip_add(struct dpt_strip *strip, uint32_t place)
{
    if (strip->count < strip->def.capacity)
        strip->triangles[strip->count++] = mesh_words(strip->mesh, MESH_SOURCES)[place];
    else
        strip->flags |= DPT_STRIP_FLAG_FULL;
}

void dpti_strip_forget(struct dpt_strip *strip)
{
    strip->walk.mesh = NULL;
}

void dpti_strip_set_full(struct dpt_strip *strip)
{
    strip->flags |= DPT_STRIP_FLAG_FULL;
}

dpt_result dpti_strip_place(const struct dpt_mesh *mesh, uint32_t number, uint32_t *place)
{
    if (number >= mesh->source_triangles)
        return DPT_E_ARGUMENT;
    *place = mesh_words(mesh, MESH_PLACES)[number];
    return *place < mesh->triangles ? DPT_OK : DPT_E_DROPPED;
}

const uint32_t *dpt_strip_get_triangles(const dpt_strip *strip, uint32_t *count, uint32_t *flags)
{
    if (count)
        *count = strip ? strip->count : 0;
    if (flags)
        *flags = strip ? strip->flags : 0;
    return strip ? strip->triangles : NULL;
}

/* Find a route between two places. Its places are written behind the strip's triangles, as far as they fit. */
static dpt_result find_route(struct dpt_strip *strip, uint32_t start, uint32_t goal, struct route *route)
{
    route->places = strip->triangles + strip->count;
    route->capacity = strip->def.capacity - strip->count;
    return dpti_route_find(&strip->search, strip->mesh, start, goal, route);
}

/* Make a route's triangles the strip's: its places, behind the strip's triangles, become source numbers. */
static void append_route(struct dpt_strip *strip, const struct route *route)
{
    const uint32_t *sources = mesh_words(strip->mesh, MESH_SOURCES);
    uint32_t count = route->count < route->capacity ? route->count : route->capacity;
    if (count < route->count)
        strip->flags |= DPT_STRIP_FLAG_FULL;
    for (uint32_t i = 0; i < count; i++)
        route->places[i] = sources[route->places[i]];
    strip->count += count;
}

dpt_result dpt_strip_route(dpt_strip *strip, const dpt_mesh *mesh, uint32_t from, uint32_t to)
{
    struct route route = { .other = NULL };
    uint32_t start, goal;
    if (!strip)
        return DPT_E_ARGUMENT;
    dpti_strip_clear(strip, mesh);
    if (!mesh)
        return DPT_E_ARGUMENT;
    DPT_TRY(dpti_strip_place(mesh, from, &start));
    DPT_TRY(dpti_strip_place(mesh, to, &goal));
    DPT_TRY(find_route(strip, start, goal, &route));
    append_route(strip, &route);
    return DPT_OK;
}

dpt_result dpti_strip_routes(struct dpt_strip *strip, const struct dpt_mesh *mesh, uint32_t a, uint32_t b, uint32_t p)
{
    struct route first = { .other = NULL }, second = { .other = &first };
    dpti_strip_clear(strip, mesh);
    DPT_TRY(find_route(strip, a, p, &first));
    strip->count = first.count < first.capacity ? first.count : first.capacity;
    dpt_result result = find_route(strip, b, p, &second);
    strip->count = 0;
    DPT_TRY(result);
    append_route(strip, &first);
    append_route(strip, &second);
    return DPT_OK;
}

dpt_result dpt_strip_routes(dpt_strip *strip, const dpt_mesh *mesh, uint32_t a, uint32_t b, uint32_t p)
{
    struct route first = { .other = NULL };
    uint32_t start[2], goal;
    if (!strip)
        return DPT_E_ARGUMENT;
    dpti_strip_clear(strip, mesh);
    if (!mesh)
        return DPT_E_ARGUMENT;
    DPT_TRY(dpti_strip_place(mesh, a, &start[0]));
    DPT_TRY(dpti_strip_place(mesh, p, &goal));
    dpt_result result = dpti_strip_place(mesh, b, &start[1]);
    if (result == DPT_OK)
        return dpti_strip_routes(strip, mesh, start[0], start[1], goal);
    /* An error of the first route comes first. */
    DPT_TRY(find_route(strip, start[0], goal, &first));
    return result;
}

void dpti_strip_shadow(struct dpt_strip *strip, const struct surface *surface, const struct shadow_volume *volume,
                       uint32_t place)
{
    dpti_strip_clear(strip, surface->mesh);
    dpti_shadow_walk(&strip->walk, surface, volume, place);
    for (uint32_t i = 0; i < strip->walk.triangle_count; i++)
        strip->triangles[i] = surface->sources[strip->walk.triangles[i].place];
    strip->count = strip->walk.triangle_count;
    strip->flags = strip->walk.flags;
}

/* Lengths of a direction whose square neither overflows nor vanishes. */
static const double LENGTH_MIN = 1e-100, LENGTH_MAX = 1e100;

static dpt_result check_shadow(const dpt_shadow *shadow)
{
    const dpt_segment *segment = &shadow->segment;
    if (!vec3_within(segment->a, DPT_COORDINATE_MAX) || !vec3_within(segment->b, DPT_COORDINATE_MAX) ||
        !(segment->radius >= 0.0 && segment->radius <= DPT_COORDINATE_MAX) ||
        !vec3_within(shadow->direction, LENGTH_MAX) || !within(shadow->width, DPT_COORDINATE_MAX) ||
        !within(shadow->depth, DPT_COORDINATE_MAX))
        return DPT_E_FINITE;
    if (!(shadow->width >= 0.0) || !(shadow->depth >= 0.0) || extent_of(vec3_of(shadow->direction)) < LENGTH_MIN)
        return DPT_E_ARGUMENT;
    return DPT_OK;
}

dpt_result dpt_strip_shadow(dpt_strip *strip, const dpt_mesh *mesh, const dpt_pose *pose, const dpt_shadow *shadow)
{
    if (!strip)
        return DPT_E_ARGUMENT;
    dpti_strip_clear(strip, mesh);
    if (!mesh || !shadow)
        return DPT_E_ARGUMENT;
    dpt_shadow own;
    DPT_TRY(sized_read(shadow, sizeof own, &own, sizeof own));
    shadow = &own;
    uint32_t place;
    struct frame frame;
    struct shadow_volume volume;
    struct surface surface;
    DPT_TRY(check_shadow(shadow));
    DPT_TRY(frame_of_pose(pose, &frame));
    DPT_TRY(dpti_strip_place(mesh, shadow->triangle, &place));
    vec3 a = frame_to_local(&frame, vec3_of(shadow->segment.a));
    vec3 b = frame_to_local(&frame, vec3_of(shadow->segment.b));
    dpti_shadow_volume_of(a, sub(b, a), frame_turn_back(&frame, vec3_of(shadow->direction)),
                          shadow->segment.radius + shadow->width, shadow->depth, &volume);
    dpti_surface_of_mesh(mesh, &surface);
    dpti_strip_shadow(strip, &surface, &volume, place);
    return DPT_OK;
}

/* ---- overlaps ---- */

/*
 * Overlap and nearest pair of a tool with each triangle of a strip. The axis is a + s u, s in 0..1, in the mesh's
 * frame.
 */

/*
 * The distance, m, from the axis to a triangle, a place, that has been moved against its normal by `displacement`, m.
 * *slope gets the derivative by the displacement.
 */
static double distance_when_moved(const struct surface *surface, uint32_t place, vec3 a, vec3 u, vec3 normal,
                                  double displacement, double *slope)
{
    pair found = dpti_triangle_pair(surface, place, along(a, displacement, normal), u);
    double distance = sqrt(found.distance2);
    *slope = dot(found.gap, normal) / distance;
    return distance;
}

/*
 * The least displacement of a triangle, a place, against its normal that frees it of the tool, m; 0 if it is free. The
 * distance is a convex function of the displacement. Newton's method starts where the triangle is wholly below the
 * tool and comes down to the last touch without passing it. If there is no touch, the distance grows again on the way
 * down, or the displacement reaches 0.
 *
 *   normal  unit, on the tool's side
 *   height  of the axis' lower end above the triangle's plane, m
 */
static double exit_distance(const struct surface *surface, uint32_t place, vec3 a, vec3 u, double radius, vec3 normal,
                            double height)
{
    double displacement = radius - height;
    double tolerance = 1e-12 * (fabs(displacement) + radius + length(u));
    for (int i = 0; i < 64 && displacement > 0.0; i++) {
        double slope;
        double clearance = distance_when_moved(surface, place, a, u, normal, displacement, &slope) - radius;
        if (!(clearance > tolerance))
            return displacement;
        if (!(slope > 0.0))
            return 0.0;
        displacement -= clearance / slope;
    }
    return max_of(0.0, displacement);
}

void dpti_strip_overlap(const struct surface *surface, const struct frame *frame, const struct strip_tool *tool,
                        uint32_t place, dpt_overlap *overlap)
{
    const vec3 a = tool->a, u = tool->u;
    const double radius = tool->radius;
    pair found = dpti_triangle_pair(surface, place, a, u);
    vec3 normal = scaled(dpti_surface_face_normal(surface, place), (double)tool->side);
    vec3 q = sub(along(a, found.s, u), found.gap);
    vec3 corner = surface_vertex(surface, surface_corner(surface, place, 0));
    double height = min_of(dot(sub(a, corner), normal), dot(sub(add(a, u), corner), normal));
    double distance = sqrt(found.distance2);
    double displacement = exit_distance(surface, place, a, u, radius, normal, height);
    *overlap = (dpt_overlap){
        .triangle = surface->sources[place],
        .flags = distance > 0.0 ? 0u : DPT_OVERLAP_FLAG_CROSSING,
        .distance = distance,
        .s = found.s,
        .gap = displacement > 0.0 ? -displacement : max_of(0.0, distance - radius),
        .overlap = displacement,
    };
    vec3_store(frame_to_world(frame, q), overlap->q);
    for (int k = 0; k < 3; k++)
        overlap->weight[k] = found.weight[k];
}

void dpti_strip_overlaps(const struct dpt_strip *strip, const struct surface *surface, const struct frame *frame,
                         const struct strip_tool *tool, dpt_overlap *overlaps, uint32_t capacity)
{
    uint32_t count = strip->count < capacity ? strip->count : capacity;
    const uint32_t size = count ? overlaps[0].size : 0;
    const uint32_t *places = count ? mesh_words(strip->mesh, MESH_PLACES) : NULL;
    for (uint32_t i = 0; i < count; i++) {
        dpt_overlap overlap;
        dpti_strip_overlap(surface, frame, tool, places[strip->triangles[i]], &overlap);
        sized_write((char *)overlaps + (size_t)i * size, size, &overlap, sizeof overlap);
    }
}

dpt_result dpt_strip_overlaps(const dpt_strip *strip, const dpt_mesh *mesh, const dpt_pose *pose,
                              const dpt_segment *segment, int32_t side, dpt_overlap *overlaps, uint32_t capacity,
                              uint32_t *count)
{
    if (count)
        *count = 0;
    if (!strip || !mesh || !segment || !count || (!overlaps && capacity) || (side != 1 && side != -1) ||
        (strip->count && strip->mesh != mesh))
        return DPT_E_ARGUMENT;
    if (capacity)
        DPT_TRY(sized_check(overlaps, sizeof *overlaps, 1));
    if (!vec3_within(segment->a, DPT_COORDINATE_MAX) || !vec3_within(segment->b, DPT_COORDINATE_MAX) ||
        !(segment->radius >= 0.0 && segment->radius <= DPT_COORDINATE_MAX))
        return DPT_E_FINITE;
    struct surface surface;
    struct frame frame;
    DPT_TRY(frame_of_pose(pose, &frame));
    dpti_surface_of_mesh(mesh, &surface);
    const vec3 a = frame_to_local(&frame, vec3_of(segment->a));
    const vec3 u = sub(frame_to_local(&frame, vec3_of(segment->b)), a);
    const struct strip_tool tool = { a, u, segment->radius, side };
    dpti_strip_overlaps(strip, &surface, &frame, &tool, overlaps, capacity);
    *count = strip->count;
    return DPT_OK;
}
