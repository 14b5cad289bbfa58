/* SPDX-License-Identifier: BSD-3-Clause */
#include <stdlib.h>
#include <string.h>

#include "base/frame.h"
#include "base/return_if_error.h"
#include "base/sized.h"
#include "convex/convex_pair.h"
#include "dynpoint/convex.h"
#include "dynpoint/query.h"

/* A triangle has at most so many corners within a box. */
enum { CLIPPED_MAX = 9 };

static double along_axis(vec3 p, int axis)
{
    return axis == 0 ? p.x : axis == 1 ? p.y : p.z;
}

/* What of a polygon lies at sign * p[axis] <= limit (Sutherland and Hodgman, 1974). */
static uint32_t clip_by_plane(const vec3 *in, uint32_t count, int axis, double sign, double limit, vec3 *out)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; i++) {
        const vec3 p = in[i], q = in[(i + 1) % count];
        const double a = limit - sign * along_axis(p, axis);
        const double b = limit - sign * along_axis(q, axis);
        if (a >= 0.0)
            out[kept++] = p;
        if ((a >= 0.0) != (b >= 0.0))
            out[kept++] = along(p, a / (a - b), sub(q, p));
    }
    return kept;
}

/*
 * The part of a triangle within `limit` of the origin along each axis: its corners, in order. Returns how many; 0 where
 * nothing is left. A triangle that lies within has its own corners, as they are.
 */
static uint32_t clip_to_box(const vec3 corner[3], double limit, vec3 clipped[CLIPPED_MAX])
{
    /* Room for one corner more than a convex polygon can have: rounding may cross a plane once more. */
    vec3 from[CLIPPED_MAX + 6], to[CLIPPED_MAX + 6];
    uint32_t count = 3;
    memcpy(from, corner, 3 * sizeof *corner);
    for (int side = 0; side < 6 && count; side++) {
        count = clip_by_plane(from, count, side / 2, side % 2 ? 1.0 : -1.0, limit, to);
        count = count < CLIPPED_MAX ? count : CLIPPED_MAX;
        memcpy(from, to, count * sizeof *to);
    }
    memcpy(clipped, from, count * sizeof *from);
    return count;
}

enum { NEAR_ON_STACK = 256, NEAR_MAX = 4096 };

/*
 * What of a triangle is farther from the shape's centre than that does not count, in the shape's lengths: no exit is
 * longer than 2, so the shape stays within 3. libccd errs where sizes differ by a hundred times.
 */
#define NEARBY 4.0

/* By so much a triangle may rise above another one's plane and be of the same face: the file's rounding of vertices. */
#define LEVEL 1e-5

/* A triangle that is near, in the shape's lengths (convex_pair.h). */
struct near_triangle {
    vec3 corner[CLIPPED_MAX]; /* of what is near of it */
    uint32_t corners;
    uint32_t number;
    vec3 front;    /* unit, towards where the shape comes from; 0: the triangle has no plane */
    vec3 towards;  /* unit, from the triangle's nearest point to the shape's centre, or its front */
    double behind; /* how far the shape reaches behind its plane: no exit is longer */
    double within; /* nor is an exit of it alone */
};

/*
 * Triangles whose normals differ by more than 1e-3 rad are not of one flat face; the cosine. Were more of the surface
 * taken for one piece, a triangle would be deep at once where it is first met, by what lies behind it.
 */
#define ALIKE 0.9999995

/* One question. */
struct touching {
    struct convex_place place;
    struct frame body;
    vec3 outside; /* in the shape's lengths */
    struct near_triangle *triangles;
    vec3 *points; /* of a piece */
    uint32_t count;
    struct convex_tally tally;
    double rounding; /* in the shape's lengths */
};

static vec3 in_lengths(const struct touching *touching, vec3 world)
{
    return scaled(sub(world, touching->place.centre), 1.0 / touching->place.body->size);
}

/* A triangle's plane, and where the shape's centre is from it; `corner` are those of all of it. */
static void set_sides(const struct touching *touching, const vec3 corner[3], struct near_triangle *triangle)
{
    const vec3 across = cross(sub(corner[1], corner[0]), sub(corner[2], corner[0]));
    const double longest = max_of(length(sub(corner[1], corner[0])),
                                  max_of(length(sub(corner[2], corner[0])), length(sub(corner[2], corner[1]))));
    const double origin[6] = { 0.0, 0.0, 0.0, 0.0, 0.0, 0.0 };
    double corners[9], q[3];
    for (int k = 0; k < 3; k++)
        vec3_store(corner[k], corners + 3 * k);
    dpt_segment_triangle(origin, corners, NULL, NULL, q);
    const vec3 nearest = vec3_of(q), from = sub(touching->outside, nearest);
    triangle->towards = unit_of(scaled(nearest, -1.0));
    /* A sliver that is flatter than this has no normal but rounding. */
    if (length(across) > 1e-9 * longest * longest) {
        triangle->front = unit_of(across);
        if (dot(triangle->front, sub(touching->outside, corner[0])) < 0.0)
            triangle->front = scaled(triangle->front, -1.0);
    } else if (length(from) > 0.0)
        triangle->front = unit_of(from);
    else
        triangle->front = (vec3){ 0.0, 0.0, 1.0 };
    if (!(dot(triangle->towards, triangle->towards) > 0.0))
        triangle->towards = triangle->front;
}

/* The least width of a triangle, or of its piece, along a few directions that do not lead behind it. */
static double shallowest_guess(const struct touching *touching, const struct near_triangle *triangle,
                               const struct convex_piece *piece)
{
    const vec3 up = unit_of(touching->outside);
    const vec3 guesses[4] = { triangle->front, triangle->towards, up,
                              unit_of(add(triangle->front, triangle->towards)) };
    double min = HUGE_VAL;
    for (int i = 0; i < 4; i++)
        if (dot(guesses[i], guesses[i]) > 0.0 && dot(guesses[i], triangle->front) >= 0.0)
            min = min_of(min, dpti_convex_width(&touching->place, piece, guesses[i]));
    return min;
}

/* Reads what is near; triangles of which nothing is are left out. */
static dpt_result read_triangles(struct touching *touching, const dpt_mesh *mesh, const uint32_t *numbers)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < touching->count; i++) {
        struct near_triangle *triangle = &touching->triangles[kept];
        double corners[9];
        vec3 corner[3];
        DPT_TRY(dpt_mesh_get_triangle(mesh, numbers[i], corners));
        for (int k = 0; k < 3; k++)
            corner[k] = in_lengths(touching, frame_to_world(&touching->body, vec3_of(corners + 3 * k)));
        triangle->corners = clip_to_box(corner, NEARBY, triangle->corner);
        if (!triangle->corners)
            continue;
        triangle->number = numbers[i];
        set_sides(touching, corner, triangle);
        const struct convex_piece flat = { .points = triangle->corner, .count = triangle->corners };
        triangle->behind = dpti_convex_width(&touching->place, &flat, triangle->front);
        triangle->within = shallowest_guess(touching, triangle, &flat);
        kept++;
    }
    touching->count = kept;
    return DPT_OK;
}

static int by_depth(const void *one, const void *other)
{
    const struct near_triangle *a = one, *b = other;
    if (a->within != b->within)
        return a->within > b->within ? -1 : 1;
    return a->number < b->number ? -1 : a->number > b->number;
}

/* The triangle, and those near it of the same flat face. */
static struct convex_piece piece_of(struct touching *touching, const struct near_triangle *triangle)
{
    struct convex_piece piece = { .points = touching->points, .has_front = 1 };
    const vec3 n = triangle->front;
    double plane = -HUGE_VAL;
    for (uint32_t k = 0; k < triangle->corners; k++)
        plane = max_of(plane, dot(n, triangle->corner[k]));
    piece.front = n;
    for (uint32_t i = 0; i < touching->count; i++) {
        const struct near_triangle *other = &touching->triangles[i];
        int is_level = dot(n, other->front) >= ALIKE;
        for (uint32_t k = 0; k < other->corners; k++)
            is_level &= dot(n, other->corner[k]) <= plane + LEVEL;
        if (!is_level && other != triangle)
            continue;
        for (uint32_t k = 0; k < other->corners; k++)
            touching->points[piece.count++] = other->corner[k];
    }
    return piece;
}

/* The middle of what is about as deep as the deepest point: of points along directions that lean a little. */
static vec3 deepest_point(const struct convex_place *place, vec3 direction)
{
    static const double lean[8][2] = { { 1, 0 },  { 0.7, 0.7 },   { 0, 1 },  { -0.7, 0.7 },
                                       { -1, 0 }, { -0.7, -0.7 }, { 0, -1 }, { 0.7, -0.7 } };
    const vec3 back = scaled(direction, -1.0);
    vec3 across[2], sum = { 0.0, 0.0, 0.0 };
    unit_across(back, across);
    for (int i = 0; i < 8; i++) {
        const vec3 d = along(along(back, 0.02 * lean[i][0], across[0]), 0.02 * lean[i][1], across[1]);
        sum = along(sum, 0.125, dpti_convex_place_support(place, d));
    }
    return along(place->centre, place->body->size, sum);
}

/* 1 if a motion along an exit that is known leaves this piece too: then it is no deeper. */
static int is_left_by(const struct touching *touching, const struct convex_piece *piece,
                      const struct convex_exit *exit_found)
{
    return exit_found->depth > 0.0 && dot(exit_found->direction, piece->front) >= 0.0 &&
           dpti_convex_width(&touching->place, piece, exit_found->direction) <= exit_found->depth + CONVEX_TOLERANCE;
}

static void find_deepest(struct touching *touching, dpt_convex_contact *found)
{
    struct convex_exit deepest = { .depth = -1.0 };
    const double size = touching->place.body->size;
    qsort(touching->triangles, touching->count, sizeof *touching->triangles, by_depth);
    for (uint32_t i = 0; i < touching->count; i++) {
        const struct near_triangle *triangle = &touching->triangles[i];
        const struct convex_piece flat = { .points = triangle->corner, .count = triangle->corners };
        struct convex_exit exit_found;
        if (!(triangle->behind > max_of(0.0, deepest.depth)))
            continue;
        const struct convex_piece piece = piece_of(touching, triangle);
        if (shallowest_guess(touching, triangle, &piece) <= deepest.depth || is_left_by(touching, &piece, &deepest) ||
            !dpti_convex_meets(&touching->place, &flat, triangle->towards, &touching->tally))
            continue;
        dpti_convex_exit(&touching->place, &piece, triangle->towards, &touching->tally, &exit_found);
        found->met++;
        found->own += (uint32_t)exit_found.is_own;
        if (exit_found.depth > deepest.depth) {
            deepest = exit_found;
            found->triangle = triangle->number;
        }
    }
    found->asked = touching->tally.asked;
    found->refused = touching->tally.refused;
    if (found->triangle == DPT_NONE)
        return;
    found->contact = DPT_CONTACT_PENETRATING;
    found->depth = size * deepest.depth;
    found->error_bound = min_of(found->depth, size * (deepest.error + CONVEX_TOLERANCE)) + size * touching->rounding;
    vec3_store(deepest.direction, found->direction);
    vec3_store(deepest_point(&touching->place, deepest.direction), found->point);
}

static dpt_result touch_near(struct touching *touching, const dpt_mesh *mesh, const uint32_t *numbers,
                             dpt_convex_contact *found)
{
    touching->triangles = malloc(touching->count * sizeof *touching->triangles);
    touching->points = malloc(touching->count * CLIPPED_MAX * sizeof *touching->points);
    dpt_result result = DPT_E_MEMORY;
    if (touching->triangles && touching->points)
        result = read_triangles(touching, mesh, numbers);
    if (result == DPT_OK)
        find_deepest(touching, found);
    free(touching->triangles);
    free(touching->points);
    return result;
}

/* List what is near, and ask. */
static dpt_result list_and_touch(struct touching *touching, const dpt_mesh *mesh, const dpt_pose *body_pose,
                                 dpt_convex_contact *found)
{
    const struct convex_place *place = &touching->place;
    uint32_t few[NEAR_ON_STACK], *many = NULL;
    double ends[6];
    for (int k = 0; k < 2; k++)
        vec3_store(frame_to_world(&place->frame, place->body->axis[k]), ends + 3 * k);
    DPT_TRY(dpt_query_triangles(mesh, body_pose, ends, place->body->reach, few, NEAR_ON_STACK, &touching->count));
    found->candidates = touching->count;
    if (!touching->count)
        return DPT_OK;
    if (touching->count > NEAR_MAX)
        return DPT_E_LIMIT;
    if (touching->count <= NEAR_ON_STACK)
        return touch_near(touching, mesh, few, found);
    many = malloc(touching->count * sizeof *many);
    if (!many)
        return DPT_E_MEMORY;
    dpt_result result =
        dpt_query_triangles(mesh, body_pose, ends, place->body->reach, many, touching->count, &touching->count);
    if (result == DPT_OK)
        result = touch_near(touching, mesh, many, found);
    free(many);
    return result;
}

static dpt_result place_shape(const struct convex_body *body, const dpt_pose *tool_pose, const dpt_pose *body_pose,
                              struct touching *touching)
{
    struct frame tool;
    DPT_TRY(frame_of_pose(tool_pose, &tool));
    DPT_TRY(frame_of_pose(body_pose, &touching->body));
    struct convex_place *place = &touching->place;
    place->body = body;
    place->frame.origin = frame_to_world(&tool, body->frame.origin);
    place->frame.x = frame_turn(&tool, body->frame.x);
    place->frame.y = frame_turn(&tool, body->frame.y);
    place->frame.z = frame_turn(&tool, body->frame.z);
    place->centre = frame_to_world(&place->frame, body->centre);
    touching->outside = in_lengths(touching, frame_to_world(&tool, body->outside));
    const double extent = extent_of(place->centre) + extent_of(touching->body.origin) + body->size;
    touching->rounding = 64.0 * DBL_EPSILON * (1.0 + extent / body->size);
    return DPT_OK;
}

dpt_result dpt_convex_touch(const dpt_convex_shape *shape, const dpt_pose *tool_pose, const dpt_mesh *mesh,
                            const dpt_pose *body_pose, dpt_convex_contact *out)
{
    struct convex_body body;
    struct touching touching = { .count = 0 };
    dpt_convex_contact found = { .status = DPT_STATUS_STALE, .contact = DPT_CONTACT_UNKNOWN, .triangle = DPT_NONE };
    const dpt_convex_contact stale = found;
    if (!shape || !mesh || !out)
        return DPT_E_ARGUMENT;
    DPT_TRY(sized_check(out, sizeof found, 0));
    sized_write(out, out->size, &stale, sizeof stale);
    DPT_TRY(dpti_convex_body_of(shape, &body));
    DPT_TRY(place_shape(&body, tool_pose, body_pose, &touching));
    found.status = DPT_STATUS_BOUNDED;
    found.contact = DPT_CONTACT_SEPARATED;
    DPT_TRY(list_and_touch(&touching, mesh, body_pose, &found));
    sized_write(out, out->size, &found, sizeof found);
    return DPT_OK;
}

/* ---- the shaper ---- */

#define STIFFNESS_MAX 1e9

static int is_valid(const dpt_convex_shaper *shaper)
{
    dpt_convex_shaper known;
    return sized_read(shaper, sizeof known, &known, sizeof known) == DPT_OK && shaper->shape &&
           (shaper->bodies || !shaper->body_count) && (shaper->law == DPT_LAW_POINT || shaper->law == DPT_LAW_BED) &&
           shaper->stiffness >= 0.0 && shaper->stiffness <= STIFFNESS_MAX;
}

/* Add a force of `stiffness` times the depth. */
static void push(const dpt_convex_contact *contact, const dpt_pose *tool, double stiffness, dpt_wrench *wrench)
{
    const vec3 force = scaled(vec3_of(contact->direction), stiffness * contact->depth);
    const vec3 arm = sub(vec3_of(contact->point), vec3_of(tool->position));
    vec3_store(add(vec3_of(wrench->force), force), wrench->force);
    vec3_store(add(vec3_of(wrench->torque), cross(arm, force)), wrench->torque);
}

void dpt_convex_shape_wrench(void *user, const dpt_force_info *info, double dt, dpt_wrench *wrench)
{
    dpt_convex_shaper *shaper = user;
    dpt_convex_contact deepest = { .size = sizeof deepest, .contact = DPT_CONTACT_UNKNOWN, .triangle = DPT_NONE };
    dpt_pose tool;
    (void)info;
    (void)dt;
    if (!shaper || !wrench || !is_valid(shaper))
        return;
    /* A bed's end has half of the tool's stiffness (docs/algorithms/force.md). */
    const double stiffness = shaper->law == DPT_LAW_BED ? 0.5 * shaper->stiffness : shaper->stiffness;
    shaper->body = DPT_NONE;
    shaper->energy = 0.0;
    const int has_pose = dpt_tool_get_pose(shaper->world, shaper->tool, &tool) == DPT_OK;
    shaper->errors += (uint32_t)!has_pose;
    for (uint32_t i = 0; has_pose && i < shaper->body_count; i++) {
        const dpt_convex_body *body = &shaper->bodies[i];
        dpt_convex_contact contact = { .size = sizeof contact };
        if (dpt_convex_touch(shaper->shape, &tool, body->mesh, body->pose, &contact) != DPT_OK) {
            shaper->errors++;
            continue;
        }
        if (contact.contact == DPT_CONTACT_PENETRATING) {
            push(&contact, &tool, stiffness, wrench);
            shaper->energy += 0.5 * stiffness * contact.depth * contact.depth;
        }
        if (deepest.status != DPT_STATUS_BOUNDED || contact.depth > deepest.depth) {
            deepest = contact;
            shaper->body = contact.contact == DPT_CONTACT_PENETRATING ? i : DPT_NONE;
        }
    }
    if (shaper->contact && sized_check(shaper->contact, sizeof deepest, 0) == DPT_OK)
        sized_write(shaper->contact, shaper->contact->size, &deepest, sizeof deepest);
}
