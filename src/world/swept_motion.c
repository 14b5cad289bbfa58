/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/swept_motion.h"

#include "world/body_search.h"
#include "world/persistent_contacts.h"

struct was dpti_motion_place(const struct dpt_world *world, const struct segment *segment)
{
    const struct tool *tool = &world->tools[segment->tool];
    const struct segment_result *result = &segment->result;
    const dpt_pose identity = DPT_POSE_IDENTITY;
    double least = segment->found.exact ? result->lower_bound : result->distance;
    return (struct was){ .pose = tool->free ? identity : tool->pose,
                         .a = segment->a,
                         .b = segment->b,
                         .distance = result->lower_bound,
                         .known = segment->found.body != NULL,
                         .through = least == 0.0,
                         .tick = (uint32_t)world->ticks };
}

/* How far the ends are apart in the tool's frame: not at all, unless it is free or its segments changed. */
static double differ(const struct was *from, const struct was *to)
{
    return length(sub(from->a, to->a)) + length(sub(from->b, to->b));
}

int dpti_motion_is_same(const struct was *from, const struct was *to)
{
    return differ(from, to) == 0.0 && pose_is_same(&from->pose, &to->pose);
}

static struct moment in_world(const struct was *was)
{
    const dpt_pose identity = DPT_POSE_IDENTITY;
    struct frame frame;
    frame_of_pose(&was->pose, &frame);
    return (struct moment){ .tool = identity,
                            .a = frame_to_world(&frame, was->a),
                            .b = frame_to_world(&frame, was->b) };
}

/* From one place to another: with the tool's pose or, where its segments are others, in the world. */
static void moments_of(const struct was *was, const struct was *is, struct moment *from,
                       struct moment *to)
{
    *from = (struct moment){ .tool = was->pose, .a = was->a, .b = was->b };
    *to = (struct moment){ .tool = is->pose, .a = is->a, .b = is->b };
    if (differ(was, is) == 0.0)
        return;
    *from = in_world(was);
    *to = in_world(is);
}

double dpti_motion_between(const struct was *was, const struct was *is)
{
    struct moment from, to;
    moments_of(was, is, &from, &to);
    return dpti_tour_way(&from, &to);
}

void dpti_motion_tell(const struct tour *tour, const struct body *body, dpt_sweep *sweep)
{
    const struct strike *strike = &tour->passage.strike;
    const struct surface *surface = tour->surface;
    int side = dpti_tour_side_before(tour);
    vec3 normal = dpti_surface_feature_normal(surface, strike->triangle, strike->pair.weight);
    double size = length(normal);
    sweep->status = DPT_SWEEP_HIT;
    sweep->time = tour->passage.time;
    sweep->body = body->id;
    sweep->triangle = surface->sources[strike->triangle];
    sweep->s = strike->pair.s;
    vec3_store(frame_to_world(&body->frame, strike->q), sweep->q);
    vec3_store(scaled(frame_turn(&body->frame, normal), size > 0.0 ? side / size : 0.0),
               sweep->normal);
}

/* The side from which the axis came through a sheet. */
static void keep_side(struct dpt_world *world, uint32_t index, const struct body *body,
                      const struct tour *tour)
{
    const struct strike *strike = &tour->passage.strike;
    uint32_t part = surface_part(tour->surface, strike->triangle);
    const struct seed seed = { strike->pair.s, strike->triangle, 1.0f };
    if (dpti_side_is_sheet(tour->surface, part) &&
        !dpti_side_is_border(tour->surface, strike->triangle, strike->pair.weight))
        dpti_contacts_meet(world, index, body, part, dpti_tour_side_before(tour), &seed);
}

/* As far as there is work left for it. */
static int take_tour(struct tour *tour, const struct moment *from, const struct moment *to)
{
    return work_is_spent(tour->work) ? SWEEP_UNFINISHED : dpti_tour_sweep(tour, from, to);
}

static void begin_tour(struct voyage *voyage, uint32_t on_axis)
{
    voyage->on_axis = on_axis;
    voyage->progress.free_until = 0.0;
    voyage->progress.sweep.begun = 0;
}

enum { LEG_STOPPED, LEG_GOES_ON, LEG_BEGAN_THROUGH };

/* Here the budget ended. */
static int stop(struct segment *segment, struct voyage *voyage, const struct body *body)
{
    voyage->body = body->id;
    voyage->sweep = segment->sweep;
    voyage->passed = segment->passed;
    return LEG_STOPPED;
}

/* One body: what met it before segment->sweep.time, and whether the axis went through. */
static int pass_body(struct dpt_world *world, uint32_t index, const struct body *body,
                     struct voyage *voyage, struct moment *from, struct moment *to)
{
    struct segment *segment = &world->segments[index];
    double far = body->added == world->ticks ? 0.0 : segment->was.distance;
    struct tour tour = { .surface = &body->surface,
                         .kernel = &world->kernel,
                         .radius = far > segment->radius ? segment->radius : 0.0,
                         .far = far,
                         .tolerance = 0.5 * TOUR_TOLERANCE * dpti_surface_diagonal(&body->surface),
                         .hint = *world_last(world, index, handle_index(body->id)),
                         .work = &world->work,
                         .progress = &voyage->progress };
    from->body = body->moved == world->ticks ? body->before : body->pose;
    to->body = body->pose;
    if (voyage->body != body->id) {
        if (dpti_tour_is_beyond(&tour, from, to, voyage->way[0].distance))
            return LEG_GOES_ON;
        begin_tour(voyage, 0);
    }
    int result = SWEEP_HIT;
    if (voyage->on_axis)
        tour.passage = voyage->by_surface;
    else
        result = take_tour(&tour, from, to);
    if (result == SWEEP_FREE)
        return LEG_GOES_ON;
    if (result == SWEEP_UNFINISHED)
        return stop(segment, voyage, body);
    if (dpti_tour_began_through(&tour))
        return LEG_BEGAN_THROUGH;
    struct tour axis = tour;
    axis.radius = 0.0;
    if (tour.radius > 0.0) {
        voyage->by_surface = tour.passage;
        if (!voyage->on_axis)
            begin_tour(voyage, 1);
        result = take_tour(&axis, from, to);
    }
    if (result == SWEEP_UNFINISHED)
        return stop(segment, voyage, body);
    if (tour.passage.time < segment->sweep.time)
        dpti_motion_tell(&tour, body, &segment->sweep);
    if (result == SWEEP_HIT) {
        segment->passed = 1;
        keep_side(world, index, body, &axis);
    }
    return LEG_GOES_ON;
}

const struct body *dpti_motion_next_body(struct around *around)
{
    const struct dpt_world *world = around->world;
    while (around->next < around->nearby->count) {
        uint32_t slot = around->nearby->list ? around->nearby->list[around->next] : around->next;
        const struct body *body = &world->bodies[slot];
        double way = body->moved == world->ticks ? body->travelled : 0.0;
        around->next++;
        if (body->slot.used &&
            box_distance(&around->box, &world->boxes[slot]) <= around->reach + way)
            return body;
    }
    return NULL;
}

struct around dpti_motion_around(struct dpt_world *world, uint32_t index, double reach)
{
    const struct track *track = &world->segments[index].found.track;
    double moved = world->travelled_at == world->ticks ? world->travelled : 0.0;
    return (struct around){ .world = world,
                            .box = box_of_axis(track->axis.a, track->axis.b),
                            .reach = reach,
                            .nearby = dpti_near_within(world, index, reach + moved) };
}

void dpti_motion_no_sweep(struct segment *segment, uint32_t status)
{
    segment->sweep = (dpt_sweep){ .size = sizeof segment->sweep,
                                  .status = status,
                                  .segment = segment->sweep.segment,
                                  .triangle = DPT_NONE };
    segment->passed |= status == DPT_SWEEP_NONE;
}

int dpti_motion_take_leg(struct dpt_world *world, uint32_t index, struct around around,
                         struct voyage *voyage)
{
    struct segment *segment = &world->segments[index];
    struct moment from, to;
    const struct body *body;
    moments_of(&segment->was, &voyage->way[0], &from, &to);
    segment->sweep.status = DPT_SWEEP_FREE;
    segment->sweep.time = 1.0;
    if (voyage->body) {
        segment->sweep = voyage->sweep;
        segment->passed |= voyage->passed;
    }
    int result = LEG_GOES_ON;
    while (result == LEG_GOES_ON && (body = dpti_motion_next_body(&around)) != NULL) {
        if (voyage->body && handle_index(body->id) < handle_index(voyage->body))
            continue;
        result = pass_body(world, index, body, voyage, &from, &to);
    }
    if (result != LEG_STOPPED)
        voyage->body = 0;
    if (result == LEG_BEGAN_THROUGH)
        dpti_motion_no_sweep(segment, DPT_SWEEP_NONE);
    return result != LEG_STOPPED;
}
