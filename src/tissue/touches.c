/* SPDX-License-Identifier: BSD-3-Clause */
#include "tissue/touches.h"

#include <string.h>

#include "deform/spring_state.h"
#include "hull/hull_triangle.h"
#include "nearest/bvh.h"
#include "nearest/pair_features.h"
#include "proxy/proxy.h"
#include "track/tool_parts.h"

/* Pairs whose points (m) and unit normals differ by no more are one: those of an edge or a corner, of each triangle at it. */
#define TWIN 1e-9

/* The sine of an angle: features of a tip that are not nearest after such a turn cannot hold it. */
#define LEAN_MAX 0.3

/* The share of a tool's radius that a surface is foreseen to move at most: on which side it lies must stay known. */
#define AHEAD_MAX 0.25

/* A part of the tool, in the body's frame. */
struct touching_part {
    const struct touch_search *search;
    struct touches *touches;
    vec3 axes[3]; /* for turns */
    uint32_t part;
    uint32_t triangle;
    double radius, clearance;
    vec3 a, u;              /* of a segment */
    struct hull_place hull; /* of a tip */
    vec3 v[3], moved[3]; /* corners of the triangle where they are foreseen, and how far that is from where they are */
};

/* How far a vertex is foreseen to move. */
static vec3 foreseen_motion(const struct touching_part *part, uint32_t vertex)
{
    const struct dpt_springs *springs = part->search->springs;
    const struct spring_vertices *vertices = &springs->vertices;
    const struct spring_slice *state = springs->state[springs->now];
    const double most = AHEAD_MAX * part->radius;
    vec3 moved = { 0.0, 0.0, 0.0 };
    for (size_t k = 4 * (size_t)vertex; k < 4 * (size_t)vertex + (vertices->nodes ? 4 : 1); k++) {
        const uint32_t node = vertices->nodes ? vertices->nodes[k] : vertex, lane = node % LANES;
        const float *v = state[node / LANES].v + lane;
        const double weight = vertices->nodes ? (double)vertices->weights[k] : 1.0;
        moved =
            along(moved, weight * part->search->ahead, (vec3){ (double)v[0], (double)v[LANES], (double)v[2 * LANES] });
    }
    const double way = length(moved);
    return way > most ? scaled(moved, most / way) : moved;
}

static void set_corners(struct touching_part *part)
{
    const struct surface *surface = &part->search->body->surface;
    surface_corners(surface, part->triangle, part->v);
    for (uint32_t k = 0; k < 3 && part->search->springs; k++) {
        part->moved[k] = foreseen_motion(part, surface_corner(surface, part->triangle, k));
        part->v[k] = add(part->v[k], part->moved[k]);
    }
}

static int has_twin(const struct touches *touches, const struct touch *touch)
{
    for (uint32_t i = 0; i < touches->count; i++) {
        const struct touch *other = &touches->touch[i];
        if (fabs(other->gap - touch->gap) <= 2.0 * TWIN && other->tool_slot == touch->tool_slot &&
            other->part == touch->part && other->body_id == touch->body_id &&
            extent_of(sub(other->at, touch->at)) <= TWIN && extent_of(sub(other->normal, touch->normal)) <= TWIN)
            return 1;
    }
    return 0;
}

/* Where there is no room, the widest gap makes room. */
static void put(struct touches *touches, const struct touch *touch)
{
    uint32_t widest = 0;
    if (touches->count < TOUCHES_MAX) {
        touches->touch[touches->count++] = *touch;
        return;
    }
    touches->is_full = 1;
    for (uint32_t i = 1; i < touches->count; i++)
        if (touches->touch[i].gap > touches->touch[widest].gap)
            widest = i;
    if (touches->touch[widest].gap > touch->gap)
        touches->touch[widest] = *touch;
}

void dpti_touch_lever(const struct proxy *proxy, const struct proxy_pose *at, const vec3 axes[3], vec3 place,
                      vec3 along, double lever[TOUCH_DIMENSIONS])
{
    const vec3 turned = cross(sub(place, at->centre), along);
    memset(lever, 0, TOUCH_DIMENSIONS * sizeof *lever);
    vec3_store(along, lever);
    for (uint32_t k = 3; k < proxy_unknowns(proxy); k++)
        lever[k] = dot(turned, axes[k - 3]) / proxy_rho_of(proxy, k);
}

/* A pair with q on the triangle and p = q + gap on the axis or the polyhedron, in the body's frame. */
static void add_pair(const struct touching_part *part, uint32_t feature, vec3 q, vec3 gap, const double weight[3])
{
    const struct touch_search *search = part->search;
    const struct frame *frame = &search->body->frame;
    const double distance = length(gap);
    vec3 moved = { 0.0, 0.0, 0.0 };
    for (int k = 0; k < 3; k++)
        moved = along(moved, weight[k], part->moved[k]);
    const double farther = distance > 0.0 ? dot(gap, moved) / distance : 0.0;
    /* A surface that leaves the tool touches it still. */
    if (!(distance > 0.0 && distance + min_of(farther, 0.0) - part->radius <= search->reach))
        return;
    struct touch touch = { .tool_slot = (uint32_t)(search->tool - search->world->tools),
                           .part = part->part,
                           .body_id = search->body->id,
                           .triangle = part->triangle,
                           .feature = feature,
                           .at = frame_to_world(frame, sub(q, moved)),
                           .normal = frame_turn(frame, scaled(gap, 1.0 / distance)),
                           .weight = { weight[0], weight[1], weight[2] },
                           .gap = distance - part->radius - part->clearance + farther };
    if (has_twin(part->touches, &touch))
        return;
    dpti_touch_lever(search->proxy, search->at, part->axes, along(touch.at, distance, touch.normal), touch.normal,
                     touch.row);
    put(part->touches, &touch);
}

static void add_of_hull(void *user, const struct hull_pair *found)
{
    const struct touching_part *part = user;
    const double *weight = found->pair.weight;
    const vec3 *v = part->v;
    if (dpti_hull_pair_is_local(&part->hull, v, found, LEAN_MAX))
        add_pair(part, found->feature, along(along(scaled(v[0], weight[0]), weight[1], v[1]), weight[2], v[2]),
                 found->pair.gap, weight);
}

static void add_of_segment(const struct touching_part *part)
{
    const vec3 *v = part->v;
    const int features = part->search->proxy->shape == PROXY_BALL ? 1 : PAIR_FEATURES;
    for (int feature = 0; feature < features; feature++) {
        pair found, on_triangle;
        if (!pair_of_feature(feature, part->a, part->u, v, &found))
            continue;
        const vec3 q = sub(along(part->a, found.s, part->u), found.gap);
        point_triangle(q, v, &on_triangle);
        add_pair(part, (uint32_t)feature, q, found.gap, on_triangle.weight);
    }
}

static void gather_part(struct touching_part *part, const struct tip *tip)
{
    const struct touch_search *search = part->search;
    const struct surface *surface = &search->body->surface;
    struct work work = work_of(WORK_UNLIMITED);
    struct range range;
    int may_touch;
    const uint32_t pairs =
        tip ? tip->hull->corner_count + tip->hull->edge_count + tip->hull->face_count : (uint32_t)PAIR_FEATURES;
    const double reach = search->reach + part->radius + (tip ? tip->hull->reach : 0.0);
    dpti_range_begin(&range, surface, &search->world->kernel, part->a, part->u, reach, &work);
    while ((part->triangle = dpti_range_next(&range, &may_touch)) != DPT_NONE) {
        set_corners(part);
        if (tip)
            dpti_hull_features(&part->hull, part->v, search->reach + (1.0 + AHEAD_MAX) * part->radius, add_of_hull,
                               part);
        else
            add_of_segment(part);
        work_spend(&work, pairs);
    }
    work_spend(search->work, work.done);
}

void dpti_touches_gather(const struct touch_search *search, struct touches *touches)
{
    const struct frame *body = &search->body->frame;
    struct touching_part part = { .search = search,
                                  .touches = touches,
                                  .clearance = dpti_proxy_clearance(search->world) };
    dpti_proxy_turn_axes(search->proxy, search->at, part.axes);
    for (part.part = 0; part.part < tool_part_count(search->tool); part.part++) {
        const struct part of = tool_part(search->world, search->tool, part.part);
        part.radius = part_radius(of);
        if (of.tip) {
            hull_place_set(&part.hull, of.tip->hull, &search->at->frame, body);
            part.a = part.hull.a;
            part.u = part.hull.u;
        } else {
            part.a = frame_to_local(body, frame_to_world(&search->at->frame, of.segment->a));
            part.u = sub(frame_to_local(body, frame_to_world(&search->at->frame, of.segment->b)), part.a);
        }
        gather_part(&part, of.tip);
    }
}
