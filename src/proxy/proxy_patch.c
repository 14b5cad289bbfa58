/* SPDX-License-Identifier: BSD-3-Clause */
#include "proxy/proxy_patch.h"

#include "proxy/proxy.h"
#include "proxy/proxy_constraints.h"
#include "sweep/sweep_mesh.h"
#include "track/body_search.h"

enum { BYTES_PATCH = 1984 };
typedef char patch_fits[sizeof(struct proxy_patch) <= BYTES_PATCH ? 1 : -1];

/* Beside what is asked for: so many times the reach at first, for the ticks to come; halved down to the least. */
#define SPARE_MOST  8.0
#define SPARE_LEAST 0.25

/* Many leaves are dear: they are worth it where no patch of one block has that much to spare. */
#define SPARE_SMALL 1.0

/* After a list could not be made, none is tried for so many ticks. */
enum { CROWDED_MOTIONS = 8 };

/* How many bodies a look may pass. */
enum { BODIES_MAX = 16 };

/* As multiples of the clearance: so far the nearest pair is looked for. Beside a line pairs are dear. */
#define NEAR      20.0
#define NEAR_LINE 6.0

/* As a multiple of the clearance: beside a line no farther triangles are listed before a motion may meet them. */
#define LISTED_LINE 400.0

uint64_t dpti_patch_bytes(const dpt_world_def *def)
{
    return BYTES_PATCH * (uint64_t)def->max_segments;
}

void dpti_patch_forget(struct proxy_patch *patch)
{
    patch->reach = patch->spare = 0.0;
    patch->crowded = 0;
    patch->body_id = 0;
}

static int is_same(vec3 a, vec3 b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

/* Whether the tool is where it was when the patch was left to searches; else that is where it is now. */
static int was_left_here(const struct proxy_tick *tick, const struct segment *segment, const struct body *body,
                         struct proxy_patch *patch)
{
    const vec3 a = frame_to_local(&body->frame, frame_to_world(&tick->at.frame, segment->a));
    const vec3 b = frame_to_local(&body->frame, frame_to_world(&tick->at.frame, segment->b));
    if (patch->body_id == body->id && is_same(a, patch->still_a) && is_same(sub(b, a), patch->still_u))
        return 1;
    if (!patch->crowded)
        return 0;
    patch->still_a = a;
    patch->still_u = sub(b, a);
    patch->crowded--;
    return 1;
}

void dpti_patch_leave(struct patch_view *view)
{
    view->patch->still_a = view->a;
    view->patch->still_u = view->u;
}

int dpti_patch_begin(struct proxy_tick *tick, struct patch_view *view)
{
    const struct dpt_world *world = tick->world;
    const struct tool *tool = tick->tool;
    struct segment *segment = &world->segments[tool->first_segment];
    const struct body *body = segment->answer.body;
    struct proxy_patch *patch = &world->patches[tool->first_segment];
    if (tool->segment_count != 1 || tool->tip_count || tick->proxy->shape == PROXY_BENT ||
        tick->proxy->state != PROXY_OUTSIDE || !(tick->gap >= 0.5 * tick->min_gap) || patch->is_off ||
        world->def.method != DPT_METHOD_EXACT || world->body_slot_end > BODIES_MAX || !body || !body_is_there(body) ||
        body->surface.motion || was_left_here(tick, segment, body, patch))
        return 0;
    view->patch = patch;
    view->segment = segment;
    view->body = body;
    view->is_ball = tick->proxy->shape == PROXY_BALL;
    view->is_listed = view->is_ball || body->static_friction > 0.0;
    view->near = (view->is_ball ? NEAR : NEAR_LINE) * tick->clearance;
    view->most = view->is_ball ? PATCH_TRIANGLES_MAX : PATCH_BESIDE_LINE_MAX;
    view->a = view->u = (vec3){ 0.0, 0.0, 0.0 };
    view->reach = view->covered = view->wished = 0.0;
    view->room = HUGE_VAL;
    view->count = 0;
    return 1;
}

/* All leaves within reach of the axis, at most so many. 0: there are more, or the work is spent. */
static int fill(struct dpt_world *world, const struct patch_view *view, double reach, uint32_t most)
{
    struct proxy_patch *patch = view->patch;
    const struct surface *surface = &view->body->surface;
    struct range range;
    uint32_t leaf;
    patch->count = 0;
    patch->reach = 0.0;
    dpti_range_begin(&range, surface, &world->kernel, view->a, view->u, reach, &world->work);
    while ((leaf = dpti_range_next_leaf(&range)) != DPT_NONE) {
        if (patch->count == most)
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
        if (fill(world, view, need + spare * reach, spare > SPARE_SMALL ? LANES : PATCH_LEAVES))
            return 1;
        if (work_is_spent(&world->work))
            return 0;
    }
    return 0;
}

/* m: no other body is nearer to the axis. */
static double far_of_others(const struct dpt_world *world, const struct patch_view *view)
{
    const struct box box = box_of_axis(view->world_a, view->world_b);
    double far = HUGE_VAL;
    for (uint32_t i = 0; i < world->body_slot_end; i++)
        if (body_is_there(&world->bodies[i]) && &world->bodies[i] != view->body)
            far = min_of(far, box_distance(&box, &world->boxes[i]));
    return far;
}

/* An axis as the kernels want it, and how far. Points have loops of their own, with squared bounds. */
struct reach_filter {
    const struct kernel *kernel;
    double scale, margin;
    int is_point;
    float x[3], limit;
    struct filter_segment segment;
};

static void reach_filter_set(struct reach_filter *filter, const struct dpt_world *world, const struct patch_view *view,
                             double distance)
{
    const struct surface *surface = &view->body->surface;
    filter->kernel = &world->kernel;
    filter->scale = surface->filter_scale;
    filter->is_point = view->is_ball;
    if (!view->is_ball) {
        const vec3 x = filter_segment_set_axis(&filter->segment, surface, view->a, view->u);
        filter_segment_set_frame(&filter->segment, x);
        filter_segment_set_limit(&filter->segment, surface, distance);
        filter->margin = (double)filter->segment.margin;
        return;
    }
    const vec3 at = scaled(sub(view->a, surface->filter_centre), surface->filter_scale);
    const double size = length(at);
    filter->margin = kernel_margin(size, size) + surface_margin(surface);
    const double limit = distance * surface->filter_scale + filter->margin;
    put_float(at, filter->x);
    filter->limit = (float)(limit * limit * (1.0 + 4.0 * KERNEL_STRETCH));
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

/* Add the triangles of a leaf of the patch that may be within reach. 0: there is no room. */
static int list_leaf(struct dpt_world *world, struct patch_view *view, const struct reach_filter *filter, uint32_t at)
{
    const struct surface *surface = &view->body->surface;
    const uint32_t leaf = view->patch->leaf[at], first = leaf * LANES;
    struct planes planes;
    float bound[LANES];
    work_spend(&world->work, 1);
    uint32_t lanes = lanes_of(surface_triangles(surface) - first) &
                     triangles_within(filter, surface_leaf(surface, leaf, &world->work), &planes, bound);
    view->listed[at] = lanes;
    for (; lanes; lanes &= lanes - 1) {
        const uint32_t lane = first_lane(lanes);
        if (view->count == view->most)
            return 0;
        struct patch_triangle *triangle = &view->list[view->count++];
        *triangle = (struct patch_triangle){ .gap = distance_of_bound(filter, bound[lane]) - view->segment->radius,
                                             .height = HUGE_VAL,
                                             .triangle = first + lane,
                                             .has_face = 1 };
        if (!filter->is_point)
            triangle->normal = unit_of((vec3){ -planes.x[lane], -planes.y[lane], -planes.z[lane] });
    }
    return 1;
}

/* List the triangles of the patch with a gap up to `within`; other bodies are so far. 0: there is no room. */
static int list_all(struct dpt_world *world, struct patch_view *view, double within, double others)
{
    const double radius = view->segment->radius;
    const struct proxy_patch *patch = view->patch;
    struct reach_filter filter;
    view->count = 0;
    memset(view->listed, 0, patch->count * sizeof *view->listed);
    reach_filter_set(&filter, world, view, radius + within);
    for (uint32_t from = 0; from < patch->count; from += LANES) {
        work_spend(&world->work, 1);
        uint32_t leaves = lanes_of(patch->count - from) & boxes_within(&filter, patch->box[from / LANES]);
        for (; leaves; leaves &= leaves - 1)
            if (!list_leaf(world, view, &filter, from + first_lane(leaves)))
                return 0;
    }
    view->reach = within;
    view->covered = view->is_listed ? within : min_of(patch->reach - off_centre(view), others) - radius;
    return 1;
}

/* Patch and list anew, for gaps up to `reach`, or to less where there is no room. 0: there is none for those near. */
static int look_anew(struct proxy_tick *tick, struct patch_view *view, double reach)
{
    struct dpt_world *world = tick->world;
    const double radius = view->segment->radius, least = 2.0 * view->near, others = far_of_others(world, view);
    view->wished = max_of(view->wished, reach);
    if (others <= radius + reach)
        return 0;
    for (reach = min_of(reach, view->room); !cover(world, view, radius + reach, reach); view->room = reach *= 0.5)
        if (reach < least || work_is_spent(&world->work))
            return 0;
    double within = view->is_listed ? reach : min_of(view->wished, LISTED_LINE * tick->clearance);
    for (; !list_all(world, view, within, others); within *= 0.5)
        if (within < least || (view->is_listed && !view->is_ball))
            return 0;
    return 1;
}

void dpti_patch_find(struct dpt_world *world, const struct patch_view *view, struct patch_triangle *triangle)
{
    const struct surface *surface = &view->body->surface;
    pair *found = &triangle->found;
    if (triangle->is_found)
        return;
    if (view->is_ball) {
        dpti_triangle_point_pair(surface, triangle->triangle, view->a, found);
        found->s = 0.0;
    } else {
        *found = dpti_triangle_pair(surface, triangle->triangle, view->a, view->u);
    }
    const double distance = sqrt(found->distance2);
    triangle->gap = distance - view->segment->radius;
    triangle->is_found = 1;
    if (distance > 0.0) {
        triangle->normal = scaled(found->gap, 1.0 / distance);
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

struct patch_way dpti_patch_way(const struct patch_view *view, vec3 to_a, vec3 to_b, double spare)
{
    const double size = view->is_ball ? 0.0 : length(view->u);
    return (struct patch_way){ { view->a, to_a },
                               { add(view->a, view->u), to_b },
                               size > 0.0 ? scaled(view->u, 1.0 / size) : view->u,
                               size,
                               spare };
}

/* The axis moved: what is known of gaps holds, less the way; and a ball's planes are where they were. */
static void weaken(struct patch_view *view, double moved)
{
    view->reach -= moved;
    view->covered -= moved;
    for (uint32_t i = 0; i < view->count; i++) {
        struct patch_triangle *triangle = &view->list[i];
        triangle->gap -= moved;
        if (view->is_ball)
            triangle->gap =
                max_of(triangle->gap, dot(triangle->normal, view->a) - triangle->height - view->segment->radius);
        triangle->is_found = 0;
        triangle->has_face = 1;
    }
}

/* Whether the plane of its last pair proves that a triangle's gap is more than `gap`, where the axis is now. */
static int is_farther(const struct patch_view *view, const struct patch_way *now, const struct patch_triangle *triangle,
                      double gap)
{
    double part[2];
    vec3 v[3];
    surface_corners(&view->body->surface, triangle->triangle, v);
    return !patch_part_beside(now, v, part) ||
           patch_height(now, triangle->normal, part, v) > gap + view->segment->radius;
}

int dpti_patch_look(struct proxy_tick *tick, struct patch_view *view, double reach)
{
    struct dpt_world *world = tick->world;
    const double near = view->near;
    if (work_left(&world->work) < PATCH_WORK)
        return 0;
    const double moved = place_axis(tick, view);
    if (!view->count || view->reach - moved < (view->is_listed ? reach : near) ||
        view->covered - moved < min_of(reach, view->room)) {
        if (!look_anew(tick, view, reach)) {
            view->patch->crowded = CROWDED_MOTIONS;
            view->patch->body_id = view->body->id;
            dpti_patch_leave(view);
            return 0;
        }
    } else if (moved > 0.0) {
        weaken(view, moved);
    }
    const struct patch_way now = dpti_patch_way(view, view->a, add(view->a, view->u), near + view->segment->radius);
    view->nearest = PATCH_TRIANGLES_MAX;
    for (uint32_t i = 0; i < view->count; i++) {
        struct patch_triangle *triangle = &view->list[i];
        triangle->is_held = 0;
        if (triangle->gap > near || (!view->is_ball && !triangle->is_found && is_farther(view, &now, triangle, near)))
            continue;
        dpti_patch_find(world, view, triangle);
        if (triangle->gap <= near && (view->nearest == PATCH_TRIANGLES_MAX ||
                                      is_nearer(&view->body->surface, triangle, &view->list[view->nearest])))
            view->nearest = i;
    }
    tick->gap = view->nearest == PATCH_TRIANGLES_MAX ? near : view->list[view->nearest].gap;
    return 1;
}

/* Add a triangle of the patch that is not listed. 0: there is no room. */
static int list_one(struct patch_view *view, uint32_t at, uint32_t lane)
{
    if (view->count == PATCH_TRIANGLES_MAX)
        return 0;
    view->listed[at] |= 1u << lane;
    view->list[view->count++] = (struct patch_triangle){
        .gap = view->reach, .height = HUGE_VAL, .triangle = view->patch->leaf[at] * LANES + lane, .has_face = 1
    };
    return 1;
}

int dpti_patch_list_met(struct dpt_world *world, struct patch_view *view, const struct sweep *sweep)
{
    static const struct surface_times still = { .tick = 0 };
    const struct surface *surface = &view->body->surface;
    const struct proxy_patch *patch = view->patch;
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
            for (lanes &= lanes_of(surface_triangles(surface) - leaf * LANES) & ~view->listed[at]; lanes;
                 lanes &= lanes - 1)
                if (!list_one(view, at, first_lane(lanes)))
                    return 0;
        }
    }
    return 1;
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
    answer->tick = tick->world->ticks;
    dpti_body_search_result(answer, &segment->result);
    tick->tool->felt_frame = tick->at.frame;
    tick->is_lost = 0;
    return 1;
}
