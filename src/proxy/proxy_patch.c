/* SPDX-License-Identifier: BSD-3-Clause */
#include "proxy/proxy_patch.h"

#include "proxy/proxy.h"
#include "proxy/proxy_constraints.h"
#include "track/body_search.h"

enum { BYTES_PATCH = 3712 };
typedef char patch_fits[sizeof(struct proxy_patch) <= BYTES_PATCH ? 1 : -1];

/* Beside what is asked for: so many times the reach at first, for the ticks to come; halved down to the least. */
#define SPARE_MOST  8.0
#define SPARE_LEAST 0.25

/* After there was no room, it is not tried for so many ticks. */
enum { CROWDED_TICKS = 32 };

/* Units of work that a look may take, so that it is not begun with less; and how many bodies it may pass. */
enum { LOOK_WORK = 512, BODIES_MAX = 16 };

/* As a share of the clearance: a plane must leave that much between the tool and a triangle behind it. */
#define CERTIFIED 0.9

/* Unit normals that differ by no more, and gaps, as a share of the clearance, are the same. */
#define TWIN 1e-9

uint64_t dpti_patch_bytes(const dpt_world_def *def)
{
    return BYTES_PATCH * (uint64_t)def->max_segments;
}

void dpti_patch_forget(struct proxy_patch *patch)
{
    patch->reach = patch->spare = 0.0;
    patch->crowded = 0;
}

int dpti_patch_begin(struct proxy_tick *tick, struct patch_view *view)
{
    const struct dpt_world *world = tick->world;
    const struct tool *tool = tick->tool;
    struct segment *segment = &world->segments[tool->first_segment];
    const struct body *body = segment->answer.body;
    struct proxy_patch *patch = &world->patches[tool->first_segment];
    if (tool->segment_count != 1 || tool->tip_count || tick->proxy->shape != PROXY_BALL || tick->is_before ||
        tick->proxy->state != PROXY_OUTSIDE || !(tick->gap >= 0.5 * tick->min_gap) || patch->is_off ||
        world->def.method != DPT_METHOD_EXACT || world->body_slot_end > BODIES_MAX || !body || !body_is_there(body) ||
        body->surface.motion || body_has_moved(world, body) || (int32_t)(world->ticks - patch->crowded) < 0)
        return 0;
    view->patch = patch;
    view->segment = segment;
    view->body = body;
    view->a = view->u = (vec3){ 0.0, 0.0, 0.0 };
    view->reach = 0.0;
    view->count = 0;
    return 1;
}

/* All leaves within reach of the axis. 0: there is no room for them, or the work is spent. */
static int fill(struct dpt_world *world, const struct patch_view *view, double reach)
{
    struct proxy_patch *patch = view->patch;
    const struct surface *surface = &view->body->surface;
    struct range range;
    uint32_t leaf;
    patch->count = 0;
    patch->reach = 0.0;
    dpti_range_begin(&range, surface, &world->kernel, view->a, view->u, reach, &world->work);
    while ((leaf = dpti_range_next_leaf(&range)) != DPT_NONE) {
        if (patch->count == PATCH_LEAVES)
            return 0;
        const float *rows = surface_node(surface, 1, leaf / LANES, &world->work);
        float *box = patch->box[patch->count / LANES];
        for (uint32_t row = 0; row < MESH_BOX_WORDS; row += LANES)
            box[row + patch->count % LANES] = rows[row + leaf % LANES];
        patch->leaf[patch->count++] = leaf;
    }
    if (work_is_spent(&world->work))
        return 0;
    patch->a = view->a;
    patch->b = add(view->a, view->u);
    patch->reach = reach;
    patch->body_id = view->body->id;
    return 1;
}

/* m: how far the axis is from that about which the patch lies. */
static double off_centre(const struct patch_view *view)
{
    return max_of(length(sub(view->a, view->patch->a)), length(sub(add(view->a, view->u), view->patch->b)));
}

/* See that the patch has all triangles within `need` of the axis. */
static int cover(struct dpt_world *world, const struct patch_view *view, double need, double reach)
{
    struct proxy_patch *patch = view->patch;
    if (patch->reach > 0.0 && patch->body_id == view->body->id && off_centre(view) + need <= patch->reach)
        return 1;
    double spare = patch->spare > 0.0 ? min_of(SPARE_MOST, 1.5 * patch->spare) : SPARE_MOST;
    for (; spare >= SPARE_LEAST; spare *= 0.5) {
        patch->spare = spare;
        if (fill(world, view, need + spare * reach))
            return 1;
        if (work_is_spent(&world->work))
            return 0;
    }
    patch->crowded = world->ticks + CROWDED_TICKS;
    return 0;
}

/* Whether no other body is within `need` of the axis. */
static int is_alone(const struct dpt_world *world, const struct patch_view *view, double need)
{
    const struct box box = box_of_axis(view->world_a, view->world_b);
    for (uint32_t i = 0; i < world->body_slot_end; i++)
        if (body_is_there(&world->bodies[i]) && &world->bodies[i] != view->body &&
            box_distance(&box, &world->boxes[i]) <= need)
            return 0;
    return 1;
}

/* A point as the kernels want it, and the limit: a squared bound above it is farther than the distance. */
struct point_filter {
    float x[3], limit;
    double margin;
};

static struct point_filter point_filter_of(const struct surface *surface, vec3 x, double distance)
{
    struct point_filter filter;
    const vec3 at = scaled(sub(x, surface->filter_centre), surface->filter_scale);
    const double size = length(at);
    filter.margin = kernel_margin(size, size) + surface_margin(surface);
    const double limit = distance * surface->filter_scale + filter.margin;
    put_float(at, filter.x);
    filter.limit = (float)(limit * limit * (1.0 + 4.0 * KERNEL_STRETCH));
    return filter;
}

/* m: no triangle with this squared bound is nearer. */
static double distance_of_bound(const struct surface *surface, const struct point_filter *filter, float bound)
{
    const double far = sqrt((double)bound) * (1.0 - 4.0 * KERNEL_STRETCH) - filter->margin;
    return far > 0.0 ? far / surface->filter_scale : 0.0;
}

/* Add the triangles of a leaf that may be within reach. 0: there is no room. */
static int list_leaf(struct dpt_world *world, struct patch_view *view, const struct point_filter *filter, uint32_t leaf)
{
    const struct surface *surface = &view->body->surface;
    const uint32_t first = leaf * LANES;
    float bound[LANES];
    work_spend(&world->work, 1);
    uint32_t lanes =
        lanes_of(surface_triangles(surface) - first) &
        world->kernel.point_triangles(surface_leaf(surface, leaf, &world->work), filter->x, filter->limit, bound);
    for (; lanes; lanes &= lanes - 1) {
        const uint32_t lane = first_lane(lanes);
        if (view->count == PATCH_TRIANGLES_MAX)
            return 0;
        view->list[view->count++] =
            (struct patch_triangle){ .gap = distance_of_bound(surface, filter, bound[lane]) - view->segment->radius,
                                     .height = HUGE_VAL,
                                     .triangle = first + lane,
                                     .has_face = 1 };
    }
    return 1;
}

/* List the triangles with a gap up to `reach`. */
static int list_all(struct dpt_world *world, struct patch_view *view, double reach)
{
    const struct surface *surface = &view->body->surface;
    const double need = view->segment->radius + reach;
    float bound[LANES];
    view->count = 0;
    if (!is_alone(world, view, need) || !cover(world, view, need, reach))
        return 0;
    const struct proxy_patch *patch = view->patch;
    const struct point_filter filter = point_filter_of(surface, view->a, need);
    for (uint32_t from = 0; from < patch->count; from += LANES) {
        work_spend(&world->work, 1);
        uint32_t leaves = lanes_of(patch->count - from) &
                          world->kernel.point_boxes(patch->box[from / LANES], filter.x, filter.limit, bound);
        for (; leaves; leaves &= leaves - 1)
            if (!list_leaf(world, view, &filter, patch->leaf[from + first_lane(leaves)]))
                return 0;
    }
    view->reach = reach;
    return 1;
}

/* Find a triangle's nearest pair. */
static void find_pair(struct dpt_world *world, const struct patch_view *view, struct patch_triangle *triangle)
{
    if (triangle->is_found)
        return;
    dpti_triangle_point_pair(&view->body->surface, triangle->triangle, view->a, &triangle->found);
    triangle->found.s = 0.0;
    const double distance = sqrt(triangle->found.distance2);
    triangle->gap = distance - view->segment->radius;
    triangle->is_found = 1;
    if (distance > 0.0) {
        triangle->normal = scaled(triangle->found.gap, 1.0 / distance);
        triangle->height = dot(triangle->normal, view->a) - distance;
    }
    work_spend(&world->work, 1);
}

/* Whether one triangle is nearer than another, both of pairs that are found. Of equal ones that of the lower source. */
static int is_nearer(const struct surface *surface, const struct patch_triangle *one,
                     const struct patch_triangle *other)
{
    return one->found.distance2 < other->found.distance2 ||
           (one->found.distance2 == other->found.distance2 &&
            surface->sources[one->triangle] < surface->sources[other->triangle]);
}

/* Put the view's axis where the tool is. Returns how far it moved, m. */
static double place_axis(const struct proxy_tick *tick, struct patch_view *view)
{
    const struct frame *body = &view->body->frame;
    const vec3 a = view->a, b = add(view->a, view->u);
    view->world_a = frame_to_world(&tick->at.frame, view->segment->a);
    view->world_b = frame_to_world(&tick->at.frame, view->segment->b);
    view->a = frame_to_local(body, view->world_a);
    view->u = sub(frame_to_local(body, view->world_b), view->a);
    return max_of(length(sub(view->a, a)), length(sub(add(view->a, view->u), b)));
}

/* m: at x the tool's surface is that far in front of the plane of the last pair that was found, at least. */
static double gap_of_plane(const struct patch_view *view, const struct patch_triangle *triangle, vec3 x)
{
    return dot(triangle->normal, x) - triangle->height - view->segment->radius;
}

/* The axis moved: what is known of gaps holds, less the way; and the planes are where they were. */
static void weaken(struct patch_view *view, double moved)
{
    view->reach -= moved;
    for (uint32_t i = 0; i < view->count; i++) {
        struct patch_triangle *triangle = &view->list[i];
        triangle->gap = max_of(triangle->gap - moved, gap_of_plane(view, triangle, view->a));
        triangle->is_found = 0;
        triangle->has_face = 1;
    }
}

int dpti_patch_look(struct proxy_tick *tick, struct patch_view *view, double reach)
{
    struct dpt_world *world = tick->world;
    const double near = PATCH_NEAR * tick->clearance;
    if (work_left(&world->work) < LOOK_WORK)
        return 0;
    const double moved = place_axis(tick, view);
    if (!view->count || view->reach - moved < reach) {
        double within = reach;
        for (; !list_all(world, view, within); within *= 0.5)
            if (view->count < PATCH_TRIANGLES_MAX || within < 2.0 * near)
                return 0;
    } else if (moved > 0.0) {
        weaken(view, moved);
    }
    view->nearest = PATCH_TRIANGLES_MAX;
    for (uint32_t i = 0; i < view->count; i++) {
        struct patch_triangle *triangle = &view->list[i];
        triangle->is_held = 0;
        if (triangle->gap > near)
            continue;
        find_pair(world, view, triangle);
        if (triangle->gap <= near && (view->nearest == PATCH_TRIANGLES_MAX ||
                                      is_nearer(&view->body->surface, triangle, &view->list[view->nearest])))
            view->nearest = i;
    }
    tick->gap = view->nearest == PATCH_TRIANGLES_MAX ? near : view->list[view->nearest].gap;
    return 1;
}

/*
 * The plane of a triangle's own face, where the ball is in front of it by the clearance, and it leaves more at the end of
 * the motion than that across the pair. At a concave edge it lets the ball go to where it touches; the pair's plane is that
 * of the edge, and would hold it half way there.
 */
static int face_plane(const struct proxy_tick *tick, const struct patch_view *view,
                      const struct patch_triangle *triangle, vec3 motion, pair *plane, double *distance)
{
    const double *weight = triangle->found.weight, radius = view->segment->radius;
    vec3 v[3];
    if (!triangle->has_face || (weight[0] > 0.0 && weight[1] > 0.0 && weight[2] > 0.0))
        return 0;
    surface_corners(&view->body->surface, triangle->triangle, v);
    const vec3 face = cross(sub(v[1], v[0]), sub(v[2], v[0]));
    const double size = length(face);
    if (!(size > 0.0))
        return 0;
    vec3 normal = scaled(face, 1.0 / size);
    double height = dot(normal, sub(view->a, v[0]));
    normal = scaled(normal, height < 0.0 ? -1.0 : 1.0);
    /* Rounding tilts the normal of a sliver: as far as that, its corners may be in front. */
    height = fabs(height) - fabs(dot(normal, sub(v[1], v[0]))) - fabs(dot(normal, sub(v[2], v[0])));
    if (height - radius < tick->clearance ||
        height + dot(normal, motion) <= *distance + dot(triangle->found.gap, motion) / *distance)
        return 0;
    *distance = height;
    plane->gap = scaled(normal, height);
    return 1;
}

/* Whether a constraint has the same plane. */
static int has_twin(const struct proxy_tick *tick, vec3 normal, double gap)
{
    for (uint32_t i = 0; i < tick->space_count; i++)
        if (fabs(tick->sources[i].gap - gap) <= TWIN * tick->clearance &&
            extent_of(sub(vec3_of(tick->spaces[i].normal), normal)) <= TWIN)
            return 1;
    return 0;
}

int dpti_patch_hold(struct proxy_tick *tick, struct patch_view *view, uint32_t i, vec3 motion)
{
    struct patch_triangle *triangle = &view->list[i];
    const struct frame *frame = &view->body->frame;
    find_pair(tick->world, view, triangle);
    triangle->is_held = 1;
    triangle->space = HALF_SPACES_MAX;
    pair plane = triangle->found;
    double distance = sqrt(plane.distance2);
    if (!(distance > 0.0))
        return 0;
    face_plane(tick, view, triangle, frame_turn_back(frame, motion), &plane, &distance);
    const double gap = distance - view->segment->radius;
    if (has_twin(tick, frame_turn(frame, scaled(plane.gap, 1.0 / distance)), gap))
        return 1;
    if (tick->space_count == HALF_SPACES_MAX)
        return 0;
    triangle->space = (uint16_t)tick->space_count;
    tick->triangles[tick->triangle_count++] =
        (struct proxy_triangle){ .segment = 0, .body_id = view->body->id, .triangle = triangle->triangle };
    dpti_proxy_add_plane(tick, tick->triangle_count - 1, view->body, view->a, &plane, distance);
    return 1;
}

int dpti_patch_prefer_pairs(struct proxy_tick *tick, struct patch_view *view)
{
    const vec3 none = { 0.0, 0.0, 0.0 };
    int has_changed = 0;
    for (uint32_t k = 0; k < tick->solved.active_count; k++)
        for (uint32_t i = 0; i < view->count; i++) {
            struct patch_triangle *triangle = &view->list[i];
            if (!triangle->is_held || !triangle->has_face || triangle->space != tick->solved.active[k] ||
                !(triangle->gap > tick->sources[triangle->space].gap + 0.1 * tick->clearance))
                continue;
            triangle->has_face = 0;
            has_changed = 1;
        }
    if (!has_changed)
        return 0;
    tick->space_count = tick->triangle_count = 0;
    for (uint32_t i = 0; i < view->count; i++)
        if (view->list[i].is_held && !dpti_patch_hold(tick, view, i, none))
            return 0;
    return 1;
}

/* The planes that hold, and how high above the origin a triangle may rise along them. */
struct certificate {
    uint32_t count;
    vec3 normal[HALF_SPACE_DIMENSIONS];
    double height[HALF_SPACE_DIMENSIONS];
};

static int is_behind(const struct certificate *certificate, const vec3 v[3])
{
    for (uint32_t k = 0; k < certificate->count; k++) {
        const vec3 n = certificate->normal[k];
        if (max_of(dot(n, v[0]), max_of(dot(n, v[1]), dot(n, v[2]))) <= certificate->height[k])
            return 1;
    }
    return 0;
}

uint32_t dpti_patch_hold_obstacles(struct proxy_tick *tick, struct patch_view *view, vec3 motion)
{
    const vec3 y = frame_turn_back(&view->body->frame, motion), to = add(view->a, y);
    const double size = length(y), kept = view->segment->radius + CERTIFIED * tick->clearance;
    struct certificate certificate = { .count = tick->solved.active_count };
    uint32_t added = 0;
    for (uint32_t k = 0; k < certificate.count; k++) {
        const vec3 n = frame_turn_back(&view->body->frame, vec3_of(tick->spaces[tick->solved.active[k]].normal));
        certificate.normal[k] = n;
        certificate.height[k] = min_of(dot(n, view->a), dot(n, to)) - kept;
    }
    for (uint32_t i = 0; i < view->count; i++) {
        struct patch_triangle *triangle = &view->list[i];
        vec3 v[3];
        if (triangle->is_held || triangle->gap - size > tick->clearance)
            continue;
        if (!triangle->is_found && min_of(triangle->gap, gap_of_plane(view, triangle, to)) >= tick->clearance)
            continue;
        surface_corners(&view->body->surface, triangle->triangle, v);
        if (is_behind(&certificate, v))
            continue;
        find_pair(tick->world, view, triangle);
        if (triangle->gap - size > tick->clearance || gap_of_plane(view, triangle, to) >= tick->clearance)
            continue;
        if (!dpti_patch_hold(tick, view, i, motion))
            return HALF_SPACES_MAX;
        added++;
    }
    return added;
}

int dpti_patch_answer(struct proxy_tick *tick, const struct patch_view *view)
{
    struct segment *segment = view->segment;
    struct body_answer *answer = &segment->answer;
    struct dynamic_point *track = &answer->track;
    if (view->nearest == PATCH_TRIANGLES_MAX)
        return 0;
    const struct patch_triangle *nearest = &view->list[view->nearest];
    uint32_t *last = world_last_triangle(tick->world, tick->tool->first_segment, handle_index(view->body->id));
    axis_of(&view->body->surface, &view->body->frame, view->world_a, view->world_b, &track->axis);
    pair_search_begin(&track->nearest, nearest->triangle);
    track->nearest.pair = nearest->found;
    track->last = DPT_NONE;
    for (uint32_t i = 0; i < view->count; i++)
        if (view->list[i].triangle == *last && view->list[i].is_found) {
            track->last = *last;
            track->last_pair = view->list[i].found;
        }
    dpti_dynamic_point_settle(track);
    *last = track->nearest.triangle;
    answer->lower_bound = HUGE_VAL;
    answer->error_bound = track->axis.error;
    answer->is_exact = 1;
    answer->is_far = answer->work = 0;
    dpti_body_search_result(answer, &segment->result);
    tick->tool->felt_frame = tick->at.frame;
    tick->is_lost = 0;
    return 1;
}
