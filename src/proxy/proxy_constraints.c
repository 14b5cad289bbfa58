/* SPDX-License-Identifier: BSD-3-Clause */
#include "proxy/proxy_constraints.h"

#include "proxy/proxy.h"
#include "track/tool_parts.h"

static void add_triangle(struct proxy_tick *tick, const struct proxy_triangle *added)
{
    for (uint32_t i = 0; i < tick->triangle_count; i++) {
        const struct proxy_triangle *triangle = &tick->triangles[i];
        if (triangle->body_id == added->body_id && triangle->triangle == added->triangle &&
            triangle->segment == added->segment)
            return;
    }
    if (tick->triangle_count < PROXY_TRIANGLES_MAX && world_find_body(tick->world, added->body_id))
        tick->triangles[tick->triangle_count++] = *added;
}

/* List the remembered triangles, and the nearest one of each part within reach, as far as there is room. */
static void list_triangles(struct proxy_tick *tick, double reach)
{
    const struct tool *tool = tick->tool;
    tick->triangle_count = 0;
    for (uint32_t i = 0; i < PROXY_MEMORY; i++)
        if (tick->proxy->memory[i].body_id)
            add_triangle(tick, &tick->proxy->memory[i]);
    for (uint32_t i = 0; i < tool_part_count(tool) && tick->triangle_count < PROXY_TRIANGLES_MAX; i++) {
        const struct part part = tool_part(tick->world, tool, i);
        const double radius = part_radius(part);
        if (part.segment && part.segment->answer.is_far && !tick->is_lost && !tick->is_before &&
            part.segment->result.lower_bound - radius <= reach)
            dpti_track_far(tick->world, tool->first_segment + i);
        const struct part_nearest nearest = part_nearest(part);
        if (nearest.body && nearest.triangle != DPT_NONE && !(nearest.distance - radius > reach)) {
            const struct proxy_triangle triangle = { i, nearest.body->id, nearest.triangle };
            add_triangle(tick, &triangle);
        }
    }
}

/* An axis in a body's frame. */
static void axis_in_body(const struct proxy_tick *tick, const struct proxy_pose *pose,
                         const struct proxy_triangle *triangle, const struct frame *body, vec3 *a, vec3 *u)
{
    const struct segment *segment = &tick->world->segments[tick->tool->first_segment + triangle->segment];
    *a = frame_to_local(body, frame_to_world(&pose->frame, segment->a));
    *u = sub(frame_to_local(body, frame_to_world(&pose->frame, segment->b)), *a);
}

static double radius_of(const struct proxy_tick *tick, const struct proxy_triangle *triangle)
{
    return part_radius(tool_part(tick->world, tick->tool, triangle->segment));
}

dpt_pose dpti_proxy_body_pose(const struct proxy_tick *tick, const struct body *body)
{
    return tick->is_before && body_has_moved(tick->world, body)
               ? dpti_rigid_sweep_pose(&body->previous_pose, &body->pose, tick->time)
               : body->pose;
}

/* A triangle where its body was when the proxy's pose was proven. */
struct triangle_place {
    const struct body *body;
    const struct frame *frame; /* that of the body, or before it moved in this tick */
    vec3 a, u;                 /* the axis in that frame */
    vec3 v[3];                 /* the corners, at that time */
    double far2;               /* m^2: a point that is farther than that from the first corner is out of reach */
};

/* How far the body has moved since then, at its point q in the place's frame. */
static vec3 carried_since(const struct proxy_tick *tick, uint32_t index, const struct triangle_place *place, vec3 q)
{
    vec3 now = q;
    if (surface_has_moved(&place->body->surface, tick->world->ticks)) {
        pair nearest;
        point_triangle(q, place->v, &nearest);
        now = surface_point(&place->body->surface, tick->triangles[index].triangle, nearest.weight);
    }
    return sub(frame_to_world(&place->body->frame, now), frame_to_world(place->frame, q));
}

/* The number for a constraint with that gap. Without room it replaces the one with the widest gap, if that is wider. */
static uint32_t number_for(struct proxy_tick *tick, double gap)
{
    uint32_t widest = 0;
    if (tick->space_count < HALF_SPACES_MAX)
        return tick->space_count++;
    for (uint32_t i = 1; i < HALF_SPACES_MAX; i++)
        if (tick->sources[i].gap > tick->sources[widest].gap)
            widest = i;
    if (!(tick->sources[widest].gap > gap))
        return HALF_SPACES_MAX;
    /* The last solution may have a contact of that number. */
    tick->is_begun = 0;
    return widest;
}

/* A pair of a triangle that is to become a constraint. */
struct held_pair {
    uint32_t triangle; /* in tick->triangles */
    int feature;       /* as in proxy_source */
    const pair *found;
    vec3 p;               /* its point on the tool, in the frame of the triangle's place */
    double distance, gap; /* m: of the axis or polyhedron, and of the surface */
};

static void add_space(struct proxy_tick *tick, const struct held_pair *held, const struct triangle_place *place)
{
    const struct frame *before = place->frame;
    const uint32_t number = number_for(tick, held->gap);
    if (number == HALF_SPACES_MAX)
        return;
    struct half_space *space = &tick->spaces[number];
    const vec3 normal = frame_turn(before, scaled(held->found->gap, 1.0 / held->distance));
    const vec3 p = frame_to_world(before, held->p);
    const vec3 lever = cross(sub(p, tick->at.centre), normal);
    vec3_store(normal, space->normal);
    for (uint32_t k = 3; k < proxy_unknowns(tick->proxy); k++)
        space->normal[k] = dot(lever, tick->axes[k - 3]) / proxy_rho_of(tick->proxy, k);
    half_space_measure(space, proxy_unknowns(tick->proxy));
    struct proxy_source *source = &tick->sources[number];
    *source = (struct proxy_source){
        .triangle = held->triangle, .feature = held->feature, .s = held->found->s, .gap = held->gap, .p = p
    };
    if (before != &place->body->frame)
        source->carried = carried_since(tick, held->triangle, place, sub(held->p, held->found->gap));
    const double wanted = tick->clearance + (tick->is_before ? tick->lift : 0.0);
    space->bound = wanted - held->gap + dot(normal, source->carried);
}

/*
 * Where an axis is nearly along an edge, their nearest points run far along both when the tool turns by little: that
 * pair tells little of where the motion leads. Points that stay on the axis tell more.
 */
enum { AXIS_POINTS = PROXY_GATHERED_MAX - PAIR_FEATURES, PAIR_POINT = PAIR_FEATURES };

/* The square of the sine below which an axis is nearly along an edge. */
#define NEARLY_ALONG 0.1

static int is_along(vec3 u, vec3 edge)
{
    const vec3 across = cross(u, edge);
    return dot(across, across) < NEARLY_ALONG * dot(u, u) * dot(edge, edge);
}

/* The pair of a feature, or with PAIR_POINT of the axis' point at `s`. */
static int pair_at(int feature, double s, vec3 a, vec3 u, const vec3 v[3], pair *found)
{
    if (feature != PAIR_POINT)
        return pair_of_feature(feature, a, u, v, found);
    point_triangle(along(a, s, u), v, found);
    found->s = s;
    return 1;
}

/* Covers the rounding of squares. */
#define ROUNDED_UP 1.000001

/* Whether the axis' point at s is out of the triangle's reach: most ends are. */
static int is_far(const struct triangle_place *place, double s)
{
    const vec3 offset = sub(along(place->a, s, place->u), place->v[0]);
    return dot(offset, offset) > place->far2;
}

/* Make a constraint of a pair within reach. Returns 0 if there is none. */
static int add_pair(struct proxy_tick *tick, uint32_t index, int feature, double s, double reach,
                    const struct triangle_place *place)
{
    pair found;
    if (feature < PAIR_EDGE)
        s = feature == PAIR_END_A ? 0.0 : 1.0;
    const int is_of_point = feature < PAIR_EDGE || feature == PAIR_POINT;
    if ((is_of_point && is_far(place, s)) || !pair_at(feature, s, place->a, place->u, place->v, &found))
        return 0;
    const double distance = sqrt(found.distance2);
    const double gap = distance - radius_of(tick, &tick->triangles[index]);
    if (!(gap <= reach && distance > 0.0))
        return 0;
    const struct held_pair held = { index, feature, &found, along(place->a, found.s, place->u), distance, gap };
    add_space(tick, &held, place);
    return 1;
}

/* Pairs of neighbouring triangles whose points and unit normals differ by no more are the same. */
#define TWIN 1e-9

/* Whether a constraint of the same tip has the same points, of a triangle beside this one. */
static int has_twin(const struct proxy_tick *tick, uint32_t index, vec3 p, vec3 normal)
{
    const struct proxy_triangle *triangle = &tick->triangles[index];
    for (uint32_t i = 0; i < tick->space_count; i++) {
        const struct proxy_triangle *other = &tick->triangles[tick->sources[i].triangle];
        if (other->segment == triangle->segment && other->body_id == triangle->body_id &&
            extent_of(sub(tick->sources[i].p, p)) <= TWIN &&
            extent_of(sub(vec3_of(tick->spaces[i].normal), normal)) <= TWIN)
            return 1;
    }
    return 0;
}

/* What the gathering of a tip's pairs with a triangle needs. */
struct tip_gather {
    struct proxy_tick *tick;
    uint32_t index;
    double radius;
    const struct triangle_place *place;
    const struct hull_place *hull;
};

/* The sine of the largest turn of a motion: features that are not nearest after such a turn cannot hold the tip. */
#define LEAN_MAX 0.3

static void add_tip_pair(void *user, const struct hull_pair *found)
{
    const struct tip_gather *gather = user;
    struct proxy_tick *tick = gather->tick;
    const vec3 *v = gather->place->v;
    const double distance = sqrt(found->pair.distance2), *weight = found->pair.weight;
    const vec3 q = along(along(scaled(v[0], weight[0]), weight[1], v[1]), weight[2], v[2]);
    const vec3 p = add(q, found->pair.gap);
    if (!(distance > 0.0) || !dpti_hull_pair_is_local(gather->hull, v, found, LEAN_MAX) ||
        has_twin(tick, gather->index, frame_to_world(gather->place->frame, p),
                 frame_turn(gather->place->frame, scaled(found->pair.gap, 1.0 / distance))))
        return;
    const struct held_pair held = { gather->index, (int)found->feature,      &found->pair, p,
                                    distance,      distance - gather->radius };
    add_space(tick, &held, gather->place);
}

static void gather_tip(struct proxy_tick *tick, uint32_t index, const struct tip *tip, double reach,
                       const struct triangle_place *place)
{
    struct hull_place hull;
    struct tip_gather gather = { tick, index, tip->hull->radius, place, &hull };
    hull_place_set(&hull, tip->hull, &tick->at.frame, place->frame);
    dpti_hull_features(&hull, place->v, reach + tip->hull->radius, add_tip_pair, &gather);
}

void dpti_proxy_gather_triangle(struct proxy_tick *tick, uint32_t index, double reach)
{
    const struct proxy_triangle *triangle = &tick->triangles[index];
    const struct body *body = world_find_body(tick->world, triangle->body_id);
    struct triangle_place place = { .body = body, .frame = &body->frame };
    struct frame moved;
    if (tick->is_before && body_has_moved(tick->world, body)) {
        const struct surface then = surface_view(&body->surface, tick->world->ticks, tick->time);
        const dpt_pose pose = dpti_proxy_body_pose(tick, body);
        frame_of_pose(&pose, &moved);
        place.frame = &moved;
        surface_corners(&then, triangle->triangle, place.v);
    } else {
        surface_corners(&body->surface, triangle->triangle, place.v);
    }
    if (proxy_tip_of(tick, triangle)) {
        gather_tip(tick, index, proxy_tip_of(tick, triangle), reach, &place);
        return;
    }
    axis_in_body(tick, &tick->at, triangle, place.frame, &place.a, &place.u);
    const vec3 edge = sub(place.v[1], place.v[0]), other = sub(place.v[2], place.v[0]);
    const double far = reach + radius_of(tick, triangle) + sqrt(max_of(dot(edge, edge), dot(other, other)));
    place.far2 = ROUNDED_UP * far * far;
    if (is_far(&place, nearest_on(place.a, place.u, place.v[0])))
        return;
    const int features = tick->proxy->shape == PROXY_BALL ? 1 : PAIR_FEATURES;
    int is_along_edge = 0;
    for (int feature = 0; feature < features; feature++)
        if (add_pair(tick, index, feature, 0.0, reach, &place) && feature >= PAIR_EDGE) {
            const int corner = feature - PAIR_EDGE;
            is_along_edge |= is_along(place.u, sub(place.v[(corner + 1) % 3], place.v[corner]));
        }
    for (int k = 1; k <= AXIS_POINTS && is_along_edge; k++)
        add_pair(tick, index, PAIR_POINT, k / (AXIS_POINTS + 1.0), reach, &place);
}

void dpti_proxy_gather(struct proxy_tick *tick, double reach)
{
    tick->space_count = 0;
    tick->is_begun = 0;
    list_triangles(tick, reach);
    for (uint32_t i = 0; i < tick->triangle_count; i++)
        dpti_proxy_gather_triangle(tick, i, reach);
    struct work *work = &tick->world->work;
    const uint32_t units = 1 + tick->triangle_count / 2;
    work_spend(work, units < work_left(work) ? units : work_left(work));
}

void dpti_proxy_add_plane(struct proxy_tick *tick, uint32_t triangle, const struct body *body, vec3 p,
                          const pair *plane, double distance)
{
    const struct triangle_place place = { .body = body, .frame = &body->frame };
    const struct held_pair held = { triangle, PAIR_END_A, plane,
                                    p,        distance,   distance - radius_of(tick, &tick->triangles[triangle]) };
    add_space(tick, &held, &place);
}

void dpti_proxy_remember_active(struct proxy_tick *tick)
{
    for (uint32_t k = 0; k < tick->solved.active_count; k++) {
        const struct proxy_triangle held = tick->triangles[tick->sources[tick->solved.active[k]].triangle];
        dpti_proxy_remember(tick->proxy, held.segment, held.body_id, held.triangle);
    }
}

/* The gap of one feature of a tip. Without a pair of points inside both features, another feature counts: no limit. */
static double tip_gap_of(const struct tip *tip, uint32_t feature, const vec3 v[3], const struct proxy_pose *pose,
                         const struct frame *body)
{
    struct hull_place place;
    struct hull_pair found;
    dpti_hull_place_feature(&place, tip->hull, feature, &pose->frame, body);
    return dpti_hull_feature(&place, feature, v, &found) ? sqrt(found.pair.distance2) - tip->hull->radius : HUGE_VAL;
}

double dpti_proxy_gap_of(const struct proxy_tick *tick, uint32_t space, const struct proxy_pose *pose)
{
    const struct proxy_triangle *triangle = &tick->triangles[tick->sources[space].triangle];
    const struct body *body = world_find_body(tick->world, triangle->body_id);
    const struct tip *tip = proxy_tip_of(tick, triangle);
    vec3 a, u, v[3];
    pair found;
    surface_corners(&body->surface, triangle->triangle, v);
    if (tip)
        return tip_gap_of(tip, (uint32_t)tick->sources[space].feature, v, pose, &body->frame);
    axis_in_body(tick, pose, triangle, &body->frame, &a, &u);
    pair_at(tick->sources[space].feature, tick->sources[space].s, a, u, v, &found);
    return sqrt(found.distance2) - radius_of(tick, triangle);
}

/* The gap of a tip and one triangle, where it is below `limit`; else the limit. */
static double tip_gap(const struct tip *tip, const struct surface *surface, uint32_t triangle,
                      const struct proxy_pose *pose, const struct frame *body, double limit)
{
    struct hull_place place;
    struct hull_pair found;
    vec3 v[3];
    surface_corners(surface, triangle, v);
    hull_place_set(&place, tip->hull, &pose->frame, body);
    return dpti_hull_triangle(&place, v, limit + tip->hull->radius, &found)
               ? sqrt(found.pair.distance2) - tip->hull->radius
               : limit;
}

double dpti_proxy_gap_of_remembered(const struct proxy_tick *tick, const struct proxy_pose *pose, double enough)
{
    double min_gap = enough;
    for (uint32_t i = 0; i < PROXY_MEMORY; i++) {
        const struct proxy_triangle *triangle = &tick->proxy->memory[i];
        const struct body *body = triangle->body_id ? world_find_body(tick->world, triangle->body_id) : NULL;
        if (!body)
            continue;
        vec3 a, u;
        struct frame frame;
        const dpt_pose body_pose = dpti_proxy_body_pose(tick, body);
        const struct surface then =
            surface_view(&body->surface, tick->world->ticks, tick->is_before ? tick->time : 1.0);
        frame_of_pose(&body_pose, &frame);
        if (proxy_tip_of(tick, triangle)) {
            min_gap = min_of(min_gap,
                             tip_gap(proxy_tip_of(tick, triangle), &then, triangle->triangle, pose, &frame, min_gap));
            continue;
        }
        axis_in_body(tick, pose, triangle, &frame, &a, &u);
        const pair found = dpti_triangle_pair(&then, triangle->triangle, a, u);
        min_gap = min_of(min_gap, sqrt(found.distance2) - radius_of(tick, triangle));
    }
    return min_gap;
}
