/* SPDX-License-Identifier: BSD-3-Clause */
#include "proxy/proxy_patch.h"

#include "proxy/patch_sides.h"
#include "proxy/patch_tips.h"
#include "sweep/sweep_mesh.h"
#include "track/body_search.h"

/* After a list could not be made, none is tried for so many ticks that begin elsewhere than the one before. */
enum { CROWDED_TICKS = 8 };

/* How many bodies a look may pass. */
enum { BODIES_MAX = 16 };

/* As multiples of the clearance: so far nearest pairs are looked for. Beside a line pairs are dear. */
#define NEAR      20.0
#define NEAR_LINE 6.0

/* As a multiple of the clearance: beside a line no farther triangles are listed before a motion may meet them. */
#define LISTED_LINE 400.0

/* With tips a longer way is left to sweeps, which are cheaper there. */
#define REACH_TIPS 400.0

static int is_same(vec3 a, vec3 b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

/* Where the tool's first segment is. */
static struct patch_place place_of(const struct patch_view *view)
{
    const struct frame *body = &view->body->frame;
    const vec3 a = frame_to_local(body, view->axes[0].a);
    return (struct patch_place){ a, sub(frame_to_local(body, view->axes[0].b), a), view->body->id, 0 };
}

/* The ends of a segment, or of a tip's axis, where the tool is at a pose. */
static void ends_at(const struct patch_view *view, struct part part, const struct proxy_pose *at, vec3 *a, vec3 *b)
{
    *a = frame_to_world(&at->frame, part.tip ? part.tip->hull->axis_a : part.segment->a);
    *b = view->is_ball ? *a : frame_to_world(&at->frame, part.tip ? part.tip->hull->axis_b : part.segment->b);
}

/*
 * Whether the tool is where it was left to searches; else that is where it is now, for as long as it is crowded there.
 * is_again: asked once more in the same tick, which counts once.
 */
static int was_left_here(const struct patch_view *view, int is_again)
{
    struct proxy_patch *first = view->first;
    const struct patch_place now = place_of(view);
    if (first->still.body_id == now.body_id && is_same(first->still.a, now.a) && is_same(first->still.u, now.u))
        return 1;
    if (!first->crowded)
        return 0;
    if (is_again)
        return 1;
    first->still = now;
    first->crowded--;
    return 1;
}

/* The body that is nearest to the tool, by the last answers; NULL: there is none. */
static const struct body *nearest_body(const struct dpt_world *world, const struct tool *tool)
{
    const struct body *nearest = NULL;
    double least = HUGE_VAL;
    for (uint32_t i = 0; i < tool_part_count(tool); i++) {
        const struct part part = tool_part(world, tool, i);
        const struct part_nearest known = part_nearest(part);
        const double gap = known.lower_bound - part_radius(part);
        if (!known.body || (nearest && !(gap < least)))
            continue;
        nearest = known.body;
        least = gap;
    }
    return nearest;
}

void dpti_patch_leave(struct patch_view *view)
{
    view->first->still = place_of(view);
}

/* m: how far the farther end went, or any corner of a tip. */
static double way_of_part(const struct patch_view *view, const struct patch_axis *axis, const struct proxy_pose *to,
                          vec3 to_a, vec3 to_b)
{
    if (axis->part.tip)
        return dpti_patch_tip_moved(axis->part.tip, &view->placed, &to->frame);
    const double way = length(sub(to_a, axis->a));
    return view->is_ball ? way : max_of(way, length(sub(to_b, axis->b)));
}

/* Put the axes where the tool is. Returns how far they moved, m. */
static double place_axes(struct patch_view *view, const struct proxy_pose *at)
{
    double moved = 0.0;
    for (uint32_t i = 0; i < view->axis_count; i++) {
        struct patch_axis *axis = &view->axes[i];
        vec3 a, b;
        ends_at(view, axis->part, at, &a, &b);
        moved = max_of(moved, way_of_part(view, axis, at, a, b));
        axis->a = a;
        axis->b = b;
    }
    view->placed = at->frame;
    return moved;
}

double dpti_patch_moved(const struct patch_view *view, const struct proxy_pose *to)
{
    double moved = 0.0;
    for (uint32_t i = 0; i < view->axis_count; i++) {
        const struct patch_axis *axis = &view->axes[i];
        vec3 a, b;
        ends_at(view, axis->part, to, &a, &b);
        moved = max_of(moved, way_of_part(view, axis, to, a, b));
    }
    return moved;
}

int dpti_patch_begin(struct proxy_tick *tick, struct patch_view *view)
{
    const struct dpt_world *world = tick->world;
    const struct tool *tool = tick->tool;
    view->first = patches_of(world, tool->first_segment);
    if (tool_part_count(tool) > PATCH_AXES_MAX || tick->proxy->state != PROXY_OUTSIDE ||
        !(tick->gap >= 0.5 * tick->min_gap) || view->first->is_off || world->def.method != DPT_METHOD_EXACT ||
        world->body_slot_end > BODIES_MAX)
        return 0;
    view->body = nearest_body(world, tool);
    if (!view->body || !body_is_there(view->body) || view->body->surface.motion)
        return 0;
    view->is_ball = tick->proxy->shape == PROXY_BALL;
    view->has_tips = tool->tip_count > 0;
    view->axis_count = tool_part_count(tool);
    view->placed = tick->at.frame;
    for (uint32_t i = 0; i < view->axis_count; i++) {
        struct patch_axis *axis = &view->axes[i];
        axis->part = tool_part(world, tool, i);
        ends_at(view, axis->part, &tick->at, &axis->a, &axis->b);
    }
    tick->is_left = was_left_here(view, tick->is_left);
    if (tick->is_left)
        return 0;
    view->near = (view->is_ball ? NEAR : NEAR_LINE) * tick->clearance;
    view->reach = view->covered = view->wished = 0.0;
    view->room = view->trust = HUGE_VAL;
    view->longest = 0.0;
    view->again_count = 0;
    view->is_made = 0;
    view->side_count = view->tip_count = view->count = 0;
    return 1;
}

/* An axis as the kernels want it, and how far. Points have loops of their own, with squared bounds. */
struct reach_filter {
    const struct kernel *kernel;
    double scale, margin;
    int is_point;
    float x[3], limit;
    struct filter_segment segment;
    float plane[HULL_PLANES][3], height[HULL_PLANES]; /* of a tip */
};

static void reach_filter_set(struct reach_filter *filter, const struct dpt_world *world, const struct patch_side *side,
                             int is_point, double distance)
{
    const struct surface *surface = &side->body->surface;
    filter->kernel = &world->kernel;
    filter->scale = surface->filter_scale;
    filter->is_point = is_point;
    if (!is_point) {
        const vec3 x = filter_segment_set_axis(&filter->segment, surface, side->a, side->u);
        filter_segment_set_frame(&filter->segment, x);
        filter_segment_set_limit(&filter->segment, surface, distance);
        filter->margin = (double)filter->segment.margin;
        return;
    }
    const vec3 at = scaled(sub(side->a, surface->filter_centre), surface->filter_scale);
    const double size = length(at);
    filter->margin = kernel_margin(size, size) + surface_margin(surface);
    const double limit = distance * surface->filter_scale + filter->margin;
    put_float(at, filter->x);
    filter->limit = (float)(limit * limit * (1.0 + 4.0 * KERNEL_STRETCH));
}

/* The planes of a tip: what lies beyond one of them is farther than it, by more than `distance`, m. */
static void reach_filter_set_planes(struct reach_filter *filter, const struct patch_side *side, double distance)
{
    const struct surface *surface = &side->body->surface;
    const double size = length(sub(side->a, surface->filter_centre)) + length(side->u) + side->spread + distance;
    const double extent = size * surface->filter_scale, margin = kernel_margin(extent, extent);
    for (int i = 0; i < HULL_PLANES; i++) {
        const vec3 n = side->tip->plane[i];
        const double at = (side->tip->support[i] + distance - dot(n, surface->filter_centre)) * surface->filter_scale;
        put_float(n, filter->plane[i]);
        filter->height[i] = (float)(at + KERNEL_STRETCH * fabs(at) + margin + filter->margin);
    }
}

/* Those of a leaf that are beyond none. */
static uint32_t triangles_this_side(const struct reach_filter *filter, const float *rows, uint32_t lanes)
{
    float support[LANES];
    for (int i = 0; i < HULL_PLANES && lanes; i++)
        lanes &= filter->kernel->common_triangles(rows, filter->plane[i], filter->height[i], support);
    return lanes;
}

static uint32_t boxes_within(const struct reach_filter *filter, const float *rows)
{
    struct planes planes;
    float bound[LANES];
    return filter->is_point ? filter->kernel->point_boxes(rows, filter->x, filter->limit, bound)
                            : filter->kernel->boxes(rows, &filter->segment, &planes, bound);
}

/* planes: those that gave the bounds; of points none */
static uint32_t triangles_within(const struct reach_filter *filter, const float *rows, struct planes *planes,
                                 float *bound)
{
    return filter->is_point ? filter->kernel->point_triangles(rows, filter->x, filter->limit, bound)
                            : filter->kernel->triangles(rows, &filter->segment, planes, bound);
}

/* m: no triangle with this bound is nearer. */
static double distance_of_bound(const struct reach_filter *filter, float bound)
{
    const double size = filter->is_point ? sqrt((double)bound) : (double)bound;
    const double far = size * (1.0 - 4.0 * KERNEL_STRETCH) - filter->margin;
    return far > 0.0 ? far / filter->scale : 0.0;
}

/* Add the triangles of a leaf of a patch that may be within reach. 0: there is no room. */
static int list_leaf(struct dpt_world *world, struct patch_view *view, struct patch_side *side,
                     const struct reach_filter *filter, uint32_t at, double within, uint32_t most)
{
    const struct surface *surface = &side->body->surface;
    const uint32_t leaf = side->patch->leaf[at], first = leaf * LANES;
    const float *rows = surface_leaf(surface, leaf, &world->work);
    struct planes planes;
    float bound[LANES];
    work_spend(&world->work, 1);
    uint32_t lanes = lanes_of(surface_triangles(surface) - first);
    if (side->tip)
        lanes = triangles_this_side(filter, rows, lanes);
    if (lanes)
        lanes &= triangles_within(filter, rows, &planes, bound);
    side->listed[at] = lanes;
    for (; lanes; lanes &= lanes - 1) {
        const uint32_t lane = first_lane(lanes);
        if (view->count == most)
            return 0;
        struct patch_triangle *triangle = &view->list[view->count++];
        *triangle =
            (struct patch_triangle){ .gap = distance_of_bound(filter, bound[lane]) - side->spread - side->radius,
                                     .height = HUGE_VAL,
                                     .triangle = first + lane,
                                     .has_face = 1,
                                     .side = (uint16_t)(side - view->sides) };
        if (side->tip)
            view->count -= !dpti_patch_tip_list(side, triangle, within);
        else if (!filter->is_point)
            triangle->normal = unit_of((vec3){ -planes.x[lane], -planes.y[lane], -planes.z[lane] });
    }
    return 1;
}

/* List the triangles of a patch with a gap up to `within`. 0: there is no room. */
static int list_side(struct dpt_world *world, struct patch_view *view, struct patch_side *side, double within,
                     uint32_t most)
{
    const struct proxy_patch *patch = side->patch;
    struct reach_filter filter;
    memset(side->listed, 0, patch->count * sizeof *side->listed);
    if (side->tip)
        dpti_patch_tip_planes(side, &view->placed);
    reach_filter_set(&filter, world, side, view->is_ball, side->spread + side->radius + within);
    if (side->tip)
        reach_filter_set_planes(&filter, side, side->radius + within);
    for (uint32_t from = 0; from < patch->count; from += LANES) {
        work_spend(&world->work, 1);
        uint32_t leaves = lanes_of(patch->count - from) & boxes_within(&filter, patch->box[from / LANES]);
        for (; leaves; leaves &= leaves - 1)
            if (!list_leaf(world, view, side, &filter, from + first_lane(leaves), within, most))
                return 0;
    }
    return 1;
}

/* List the triangles of all sides likewise; other bodies are so far. */
static int list_all(struct dpt_world *world, struct patch_view *view, double within, double others)
{
    const uint32_t room =
        view->is_ball || view->has_tips ? PATCH_TRIANGLES_MAX : PATCH_BESIDE_LINE_MAX * view->side_count;
    const uint32_t most = room < PATCH_TRIANGLES_MAX ? room : PATCH_TRIANGLES_MAX;
    view->count = 0;
    view->reach = within;
    view->covered = view->is_listed ? within : others;
    for (uint32_t i = 0; i < view->side_count; i++) {
        struct patch_side *side = &view->sides[i];
        if (!list_side(world, view, side, within, most))
            return 0;
        if (!view->is_listed)
            view->covered = min_of(view->covered, side->patch->reach - patch_off_centre(side) - side->radius);
    }
    return 1;
}

/* Patches and list anew, for gaps up to `reach`, or to less where there is no room. 0: there is none for those near. */
static int look_anew(struct proxy_tick *tick, struct patch_view *view, double reach)
{
    struct dpt_world *world = tick->world;
    const double least = 2.0 * view->near;
    double others;
    view->is_made = 0;
    view->wished = max_of(view->wished, reach);
    reach = dpti_patch_find_sides(world, view, min_of(reach, view->room), least, &others);
    if (!(reach > 0.0))
        return 0;
    view->is_listed = view->is_ball || view->has_tips;
    double within = view->is_listed ? reach : min_of(view->wished, LISTED_LINE * tick->clearance);
    within = min_of(within, others);
    for (; !list_all(world, view, within, others); within *= 0.5)
        if (within < least || (view->is_listed && !view->is_ball && !view->has_tips))
            return 0;
    view->is_made = 1;
    return 1;
}

void dpti_patch_find(struct dpt_world *world, const struct patch_view *view, struct patch_triangle *triangle)
{
    const struct patch_side *side = patch_side_of(view, triangle);
    const struct surface *surface = &side->body->surface;
    pair *found = &triangle->found;
    if (triangle->is_found)
        return;
    if (view->is_ball) {
        dpti_triangle_point_pair(surface, triangle->triangle, side->a, found);
        found->s = 0.0;
    } else {
        *found = dpti_triangle_pair(surface, triangle->triangle, side->a, side->u);
    }
    const double distance = sqrt(found->distance2);
    triangle->gap = distance - side->radius;
    triangle->is_found = 1;
    if (distance > 0.0) {
        triangle->normal = scaled(found->gap, 1.0 / distance);
        triangle->height = dot(triangle->normal, side->a) - distance;
    }
    work_spend(&world->work, 1);
}

struct patch_way dpti_patch_way(const struct patch_side *side, int is_ball, vec3 to_a, vec3 to_b, double spare)
{
    const double size = is_ball ? 0.0 : length(side->u);
    return (struct patch_way){ { side->a, to_a },
                               { add(side->a, side->u), to_b },
                               size > 0.0 ? scaled(side->u, 1.0 / size) : side->u,
                               size,
                               spare };
}

/* The axes moved: what is known of gaps holds, less the way; and a ball's planes are where they were. */
static void weaken(struct patch_view *view, double moved)
{
    view->reach -= moved;
    view->covered -= moved;
    for (uint32_t i = 0; i < view->side_count; i++)
        view->sides[i].moved = dpti_patch_place_side(view, &view->sides[i]);
    for (uint32_t i = 0; i < view->count; i++) {
        struct patch_triangle *triangle = &view->list[i];
        const struct patch_side *side = patch_side_of(view, triangle);
        triangle->gap -= side->moved;
        if (view->is_ball)
            triangle->gap = max_of(triangle->gap, dot(triangle->normal, side->a) - triangle->height - side->radius);
        triangle->is_found = 0;
        triangle->has_face = 1;
    }
}

/* Whether the plane of its last pair proves that a triangle's gap is more than `gap`, where the axis is now. */
static int is_farther(const struct patch_side *side, const struct patch_way *now, const struct patch_triangle *triangle,
                      double gap)
{
    double part[2];
    vec3 v[3];
    surface_corners(&side->body->surface, triangle->triangle, v);
    return !patch_part_beside(now, v, part) || patch_height(now, triangle->normal, part, v) > gap + side->radius;
}

/* The pairs of those near, and the nearest of a side. */
static void find_near(struct proxy_tick *tick, struct patch_view *view, uint32_t number)
{
    struct patch_side *side = &view->sides[number];
    const double near = view->near;
    const struct patch_way now =
        dpti_patch_way(side, view->is_ball, side->a, add(side->a, side->u), near + side->radius);
    side->nearest = PATCH_TRIANGLES_MAX;
    for (uint32_t i = 0; i < view->count; i++)
        if (view->list[i].side == number)
            view->list[i].is_held = 0;
    if (side->tip) {
        dpti_patch_tip_find_near(tick, view, number);
        return;
    }
    for (uint32_t i = 0; i < view->count; i++) {
        struct patch_triangle *triangle = &view->list[i];
        if (triangle->side != number || triangle->gap > near ||
            (!view->is_ball && !triangle->is_found && is_farther(side, &now, triangle, near)))
            continue;
        dpti_patch_find(tick->world, view, triangle);
        if (triangle->gap <= near && (side->nearest == PATCH_TRIANGLES_MAX ||
                                      patch_is_nearer(&side->body->surface, triangle, &view->list[side->nearest])))
            side->nearest = i;
    }
}

int dpti_patch_look(struct proxy_tick *tick, struct patch_view *view, double reach)
{
    struct dpt_world *world = tick->world;
    if (work_left(&world->work) < PATCH_WORK || (view->has_tips && reach > REACH_TIPS * tick->clearance))
        return 0;
    const double moved = place_axes(view, &tick->at);
    if (!view->is_made || view->reach - moved < (view->is_listed ? reach : view->near) ||
        view->covered - moved < min_of(reach, view->room)) {
        if (!look_anew(tick, view, reach)) {
            view->first->crowded = CROWDED_TICKS;
            dpti_patch_leave(view);
            return 0;
        }
    } else if (moved > 0.0) {
        weaken(view, moved);
    }
    tick->gap = view->near;
    for (uint32_t i = 0; i < view->side_count; i++) {
        find_near(tick, view, i);
        if (view->sides[i].nearest != PATCH_TRIANGLES_MAX)
            tick->gap = min_of(tick->gap, view->list[view->sides[i].nearest].gap);
    }
    return 1;
}

/* Add a triangle of the patch that is not listed. 0: there is no room. */
static int list_one(struct patch_view *view, uint32_t number, uint32_t at, uint32_t lane)
{
    struct patch_side *side = &view->sides[number];
    if (view->count == PATCH_TRIANGLES_MAX)
        return 0;
    side->listed[at] |= 1u << lane;
    view->list[view->count++] = (struct patch_triangle){ .gap = view->reach,
                                                         .height = HUGE_VAL,
                                                         .triangle = side->patch->leaf[at] * LANES + lane,
                                                         .has_face = 1,
                                                         .side = (uint16_t)number };
    return 1;
}

int dpti_patch_list_met(struct dpt_world *world, struct patch_view *view, uint32_t number, const struct sweep *sweep)
{
    static const struct surface_times still = { .tick = 0 };
    const struct patch_side *side = &view->sides[number];
    const struct surface *surface = &side->body->surface;
    const struct proxy_patch *patch = side->patch;
    struct sweep_progress progress = { .until = 1.0 };
    struct mesh_sweep search = { .surface = surface,
                                 .kernel = &world->kernel,
                                 .sweep = sweep,
                                 .times = &still,
                                 .work = &world->work,
                                 .progress = &progress };
    dpti_sweep_aim(&search);
    for (uint32_t from = 0; from < patch->count; from += LANES) {
        work_spend(&world->work, 1);
        uint32_t leaves = lanes_of(patch->count - from) & dpti_sweep_open_boxes(&search, patch->box[from / LANES]);
        for (; leaves; leaves &= leaves - 1) {
            const uint32_t at = from + first_lane(leaves), leaf = patch->leaf[at];
            work_spend(&world->work, 1);
            uint32_t lanes = dpti_sweep_open_triangles(&search, surface_leaf(surface, leaf, &world->work));
            for (lanes &= lanes_of(surface_triangles(surface) - leaf * LANES) & ~side->listed[at]; lanes;
                 lanes &= lanes - 1)
                if (!list_one(view, number, at, first_lane(lanes)))
                    return 0;
        }
    }
    return 1;
}

/* The side at which a part is nearest; NULL: none is near. */
static const struct patch_side *nearest_side(const struct patch_view *view, uint32_t number)
{
    const struct patch_side *nearest = NULL;
    for (uint32_t i = 0; i < view->side_count; i++) {
        const struct patch_side *side = &view->sides[i];
        if (side->number == number && side->nearest != PATCH_TRIANGLES_MAX &&
            (!nearest || view->list[side->nearest].found.distance2 < view->list[nearest->nearest].found.distance2))
            nearest = side;
    }
    return nearest;
}

static void answer_one(struct proxy_tick *tick, const struct patch_view *view, const struct patch_side *side)
{
    struct segment *segment = side->part.segment;
    struct body_answer *answer = &segment->answer;
    struct dynamic_point *track = &answer->track;
    const struct patch_axis *axis = &view->axes[side->number];
    const struct patch_triangle *nearest = &view->list[side->nearest];
    uint32_t *last =
        world_last_triangle(tick->world, tick->tool->first_segment + side->number, handle_index(side->body->id));
    axis_of(&side->body->surface, &side->body->frame, axis->a, axis->b, &track->axis);
    pair_search_begin(&track->nearest, nearest->triangle);
    track->nearest.pair = nearest->found;
    track->last = DPT_NONE;
    for (uint32_t i = 0; i < view->count; i++)
        if (patch_side_of(view, &view->list[i]) == side && view->list[i].triangle == *last && view->list[i].is_found) {
            track->last = *last;
            track->last_pair = view->list[i].found;
        }
    dpti_dynamic_point_settle(track);
    *last = track->nearest.triangle;
    answer->body = side->body;
    answer->lower_bound = HUGE_VAL;
    answer->error_bound = track->axis.error;
    answer->is_exact = 1;
    answer->is_far = answer->work = 0;
    answer->tick = tick->world->ticks;
    segment->last_body_slot = handle_index(side->body->id);
    dpti_body_search_result(answer, &segment->result);
    if (far_is_used(tick->world, tick->tool))
        dpti_far_prove(tick->world, segment, axis->a, axis->b);
}

int dpti_patch_answer(struct proxy_tick *tick, const struct patch_view *view)
{
    uint32_t answered = 0;
    for (uint32_t i = 0; i < view->axis_count; i++) {
        const struct patch_side *side = nearest_side(view, i);
        if (side && side->tip)
            dpti_patch_tip_answer(tick->world, side, &view->placed, &view->list[side->nearest]);
        else if (side)
            answer_one(tick, view, side);
        answered += side != NULL;
    }
    tick->tool->felt_frame = tick->at.frame;
    tick->is_lost = 0;
    return answered == view->axis_count;
}
