/* SPDX-License-Identifier: BSD-3-Clause */
#include "tissue/touches.h"

#include <string.h>

#include "deform/spring_state.h"
#include "hull/hull_triangle.h"
#include "nearest/bvh.h"
#include "nearest/pair_features.h"
#include "proxy/proxy.h"
#include "track/deform_state.h"
#include "track/tool_parts.h"

/* Pairs whose points (m) and unit normals differ by no more are one: those of an edge or a corner, of each triangle at it. */
#define TWIN 1e-9

/* The sine of an angle: features of a tip that are not nearest after such a turn cannot hold it. */
#define LEAN_MAX 0.3

/* The share of a tool's radius that a surface is foreseen to move at most: on which side it lies must stay known. */
#define AHEAD_MAX 0.25

/*
 * Units that a tick has time for where a device leaps: 1,024 triangles. Those within the tool's radius beyond what counts
 * without the leap are all looked at.
 */
#define LEAP_WORK (1024u * PAIR_FEATURES)

/* A part of the tool, in the body's frame. */
struct touching_part {
    const struct touch_search *search;
    struct touches *touches;
    vec3 axes[3]; /* for turns */
    uint32_t part;
    uint32_t triangle;
    double radius, clearance;
    vec3 a, u;                 /* of a segment */
    struct hull_place hull;    /* of a tip */
    struct touch_patch *patch; /* NULL: pairs alone */
    int has_more;              /* 1: there was no room for all of its vertices */
    int is_cut;                /* 1: more than is to be looked at */
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

static uint32_t widest_of(const struct touches *touches)
{
    uint32_t widest = 0;
    for (uint32_t i = 1; i < touches->count; i++)
        if (touches->touch[i].gap > touches->touch[widest].gap)
            widest = i;
    return widest;
}

/* Where there is no room, the widest gap makes room. */
static void put(struct touches *touches, const struct touch *touch)
{
    if (touches->count < TOUCHES_MAX) {
        touches->touch[touches->count++] = *touch;
        return;
    }
    touches->is_full = 1;
    const uint32_t widest = widest_of(touches);
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

/* ---- a surface that is fine for the tool ---- */

/* Triangles are fine if their edges are shorter than this share of the tool's radius. */
#define FINE (1.0 / 3.0)

/* Whether touches load the body at their own points: rigid ones are not, and where loads are spread, a patch is there. */
static int is_loaded_at_points(const struct touch_search *search)
{
    return search->springs && !(deform_of(search->body)->def.load_radius > 0.0);
}

/* m2: the square of its longest edge at rest, so that it stays fine, or not, while the surface moves. */
static double longest_edge(const struct touching_part *part)
{
    const struct surface *surface = &part->search->body->surface;
    const float *rest = mesh_floats(surface->mesh, MESH_VERTICES);
    double longest = 0.0;
    for (uint32_t k = 0; k < 3; k++) {
        const vec3 from = vec3_of_float(rest + 3 * (size_t)surface_corner(surface, part->triangle, k));
        const vec3 to = vec3_of_float(rest + 3 * (size_t)surface_corner(surface, part->triangle, (k + 1) % 3));
        longest = max_of(longest, dot(sub(to, from), sub(to, from)));
    }
    return longest;
}

/* `within`, m: from the tool. */
static void add_corner(struct touching_part *part, uint32_t corner, double within)
{
    const struct touch_search *search = part->search;
    const struct frame *frame = &search->body->frame;
    const uint32_t vertex = surface_corner(&search->body->surface, part->triangle, corner);
    if (!dpti_touch_vertex_is_new(search->vertices, part->patch, vertex))
        return;
    const vec3 q = part->v[corner], from = sub(q, part->a), moved = part->moved[corner];
    const double square = dot(part->u, part->u);
    const double s = square > 0.0 ? max_of(0.0, min_of(1.0, dot(from, part->u) / square)) : 0.0;
    const vec3 gap = sub(along(part->a, s, part->u), q);
    const double distance = length(gap), farther = distance > 0.0 ? dot(gap, moved) / distance : 0.0;
    if (!(distance > 0.0 && distance + min_of(farther, 0.0) - part->radius <= within))
        return;
    const struct touch_vertex made = { .vertex = vertex,
                                       .triangle = part->triangle,
                                       .at = frame_to_world(frame, sub(q, moved)),
                                       .normal = frame_turn(frame, scaled(gap, 1.0 / distance)),
                                       .distance = distance,
                                       .gap = distance - part->radius - part->clearance + farther };
    part->has_more |= !dpti_touch_vertex_add(search->vertices, part->patch, &made);
}

/* The touch of the vertices of a list. */
static void put_vertices(const struct touching_part *part, uint32_t first)
{
    const struct touch_search *search = part->search;
    const struct touch_vertex *list = search->vertices->vertex;
    struct touch touch = { .tool_slot = part->patch->tool_slot,
                           .part = part->part,
                           .body_id = search->body->id,
                           .triangle = list[first].triangle,
                           .feature = TOUCH_OF_VERTICES | (uint32_t)(list[first].cube >> 32),
                           .vertices = first + 1,
                           .name = (uint32_t)list[first].cube };
    double distance = 0.0, nearest = HUGE_VAL;
    for (uint32_t i = first + 1; i; i = list[i - 1].next) {
        const struct touch_vertex *vertex = &list[i - 1];
        touch.at = along(touch.at, vertex->share, vertex->at);
        touch.normal = along(touch.normal, vertex->share, vertex->normal);
        touch.gap += vertex->share * vertex->gap;
        distance += vertex->share * vertex->distance;
    }
    for (uint32_t i = first + 1; i; i = list[i - 1].next) {
        const vec3 away = sub(list[i - 1].at, touch.at);
        if (dot(away, away) < nearest)
            touch.triangle = list[i - 1].triangle;
        nearest = min_of(nearest, dot(away, away));
    }
    const double size = length(touch.normal);
    if (!(size > 0.0))
        return;
    touch.normal = scaled(touch.normal, 1.0 / size);
    if (has_twin(part->touches, &touch))
        return;
    dpti_touch_lever(search->proxy, search->at, part->axes, along(touch.at, distance, touch.normal), touch.normal,
                     touch.row);
    put(part->touches, &touch);
}

static void add_of_segment(struct touching_part *part)
{
    const vec3 *v = part->v;
    const int features = part->search->proxy->shape == PROXY_BALL ? 1 : PAIR_FEATURES;
    const double longest = part->patch ? longest_edge(part) : HUGE_VAL;
    if (longest < FINE * FINE * part->radius * part->radius) {
        /* Between corners that touch, the proxy stays outside of a flat triangle. */
        const double within = max_of(part->search->reach, part->patch->near) + longest / (6.0 * part->radius);
        for (uint32_t corner = 0; corner < 3; corner++)
            add_corner(part, corner, within);
        return;
    }
    for (int feature = 0; feature < features; feature++) {
        pair found, on_triangle;
        if (!pair_of_feature(feature, part->a, part->u, v, &found))
            continue;
        const vec3 q = sub(along(part->a, found.s, part->u), found.gap);
        point_triangle(q, v, &on_triangle);
        add_pair(part, (uint32_t)feature, q, found.gap, on_triangle.weight);
    }
}

static void gather_near(struct touching_part *part, const struct tip *tip)
{
    const struct touch_search *search = part->search;
    const struct surface *surface = &search->body->surface;
    struct work work = work_of(search->reach > search->least + part->radius ? LEAP_WORK : WORK_UNLIMITED);
    struct range range;
    int may_touch;
    const uint32_t pairs =
        tip ? tip->hull->corner_count + tip->hull->edge_count + tip->hull->face_count : (uint32_t)PAIR_FEATURES;
    const double reach =
        max_of(search->reach, part->patch ? part->patch->near : 0.0) + part->radius + (tip ? tip->hull->reach : 0.0);
    dpti_range_begin(&range, surface, &search->world->kernel, part->a, part->u, reach, &work);
    while (!part->has_more && !work_is_spent(&work) &&
           (part->triangle = dpti_range_next(&range, &may_touch)) != DPT_NONE) {
        set_corners(part);
        if (tip)
            dpti_hull_features(&part->hull, part->v, search->reach + (1.0 + AHEAD_MAX) * part->radius, add_of_hull,
                               part);
        else
            add_of_segment(part);
        work_spend(&work, pairs);
    }
    work_spend(search->work, work.done);
    part->is_cut |= work_is_spent(&work);
}

/* Where there are too many vertices, every second one counts, or every fourth. */
static void gather_part(struct touching_part *part, const struct tip *tip)
{
    const struct touch_search *search = part->search;
    struct touch_vertices *all = search->vertices;
    const uint32_t count = part->touches->count;
    part->patch = NULL;
    part->has_more = 0;
    if (all && !tip && is_loaded_at_points(search)) {
        part->patch =
            dpti_touch_patch_of(all, (uint32_t)(search->tool - search->world->tools), part->part, search->body->id);
        dpti_touch_patch_begin(all, part->patch);
    }
    gather_near(part, tip);
    while (part->has_more && dpti_touch_patch_thin(all, part->patch)) {
        part->touches->count = count;
        part->has_more = 0;
        gather_near(part, tip);
    }
    part->touches->is_full |= (uint32_t)part->has_more;
    if (!part->patch)
        return;
    const struct dpt_mesh *mesh = search->body->surface.mesh;
    const struct touch_shape shape = { mesh_floats(mesh, MESH_VERTICES), part->radius, search->reach };
    dpti_touch_patch_group(all, part->patch, &shape);
    for (uint32_t i = part->patch->first; i < all->count; i++)
        if (all->vertex[i].is_first)
            put_vertices(part, i);
}

/* A segment, or what is not left out of it. Returns 0 if nothing is. */
static int set_segment(struct touching_part *part, const struct segment *segment)
{
    const struct touch_search *search = part->search;
    const struct frame *body = &search->body->frame;
    part->a = frame_to_local(body, frame_to_world(&search->at->frame, segment->a));
    part->u = sub(frame_to_local(body, frame_to_world(&search->at->frame, segment->b)), part->a);
    if (!(search->left_out > 0.0))
        return 1;
    const double share = search->left_out / length(part->u);
    if (search->tool->piercing == DPT_PIERCING_A)
        part->a = along(part->a, share, part->u);
    part->u = scaled(part->u, 1.0 - share);
    return share < 1.0;
}

int dpti_touches_gather(const struct touch_search *search, struct touches *touches)
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
        } else if (!set_segment(&part, of.segment)) {
            continue;
        }
        gather_part(&part, of.tip);
    }
    return !part.is_cut;
}
