/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A turn is cut in halves until each piece is so nearly straight that the radius can take up the difference. Most ticks
 * end before that: what is farther from the axis, before and after, than the motion is long cannot have been met.
 */
#include "travel.h"

#include "bodies.h"
#include "sweep.h"

/* Of the mesh's diagonal: half for the sweep, a quarter for the arcs, which grows the radius, and as much by which they
 * are truly off. */
#define TRAVEL_TOLERANCE 1e-6

enum { HALVES_MOST = 10 };

/* A tool and a body at one time. */
struct moment {
    dpt_pose tool, body;
    vec3 a, b; /* in the tool's frame */
};

struct ends {
    vec3 a, b;
};

/* One segment past one body. */
struct tour {
    const struct dpt_world *world;
    const struct body *body;
    double radius;
    double far;       /* nothing is nearer than that to the axis where the tour begins */
    double tolerance; /* half of what a hit may be off */
    uint32_t hint;
    uint32_t most; /* units of work; 0: what it takes */
    uint32_t work;
    struct voyage *voyage; /* where it began, or goes on */
    struct passage passage;
};

/* In the world. */
static struct ends tool_ends(const struct moment *moment)
{
    struct frame tool;
    frame_of_pose(&moment->tool, &tool);
    return (struct ends){ frame_to_world(&tool, moment->a), frame_to_world(&tool, moment->b) };
}

/* In the body's frame. */
static struct ends ends_at(const struct moment *moment)
{
    struct ends ends = tool_ends(moment);
    struct frame body;
    frame_of_pose(&moment->body, &body);
    return (struct ends){ frame_to_local(&body, ends.a), frame_to_local(&body, ends.b) };
}

static struct moment middle_of(const struct moment *from, const struct moment *to)
{
    return (struct moment){ pose_middle(&from->tool, &to->tool),
                            pose_middle(&from->body, &to->body), scaled(add(from->a, to->a), 0.5),
                            scaled(add(from->b, to->b), 0.5) };
}

static double faster(vec3 da, vec3 db)
{
    return larger(length(da), length(db));
}

static struct ends between(const struct ends *from, const struct ends *to)
{
    return (struct ends){ scaled(add(from->a, to->a), 0.5), scaled(add(from->b, to->b), 0.5) };
}

/* How far the way bends away from the straight one, with a quarter to spare for what is not an even arc. */
static double bend_of(const struct ends *from, const struct ends *middle, const struct ends *to)
{
    struct ends straight = between(from, to);
    return 1.25 * faster(sub(middle->a, straight.a), sub(middle->b, straight.b));
}

/* The cosine of half of what a body may turn, 0.25, before its way is cut whatever the bend. */
#define TURN_COSINE 0.9922

static double body_turn_cosine(const struct moment *from, const struct moment *to)
{
    double cosine = 0.0;
    for (int k = 0; k < 4; k++)
        cosine += from->body.orientation[k] * to->body.orientation[k];
    return fabs(cosine);
}

/*
 * The same of one part of a tour. A turn of the tool alone is an arc, farthest off in the middle; seen from a body that
 * turns, a straight way can bend to one side and back, so it is looked at in the quarters too.
 */
static double bend_between(const struct moment *from, const struct ends *at_from,
                           const struct moment *middle, const struct ends *at_middle,
                           const struct moment *to, const struct ends *at_to)
{
    double bend = bend_of(at_from, at_middle, at_to);
    int turns = 0;
    for (int k = 0; k < 4; k++)
        turns |= from->body.orientation[k] != to->body.orientation[k];
    if (!turns)
        return bend;
    struct ends straight = between(at_from, at_to);
    for (int half = 0; half < 2; half++) {
        struct moment quarter = half ? middle_of(middle, to) : middle_of(from, middle);
        struct ends at_quarter = ends_at(&quarter);
        struct ends chord = between(&straight, half ? at_to : at_from);
        double off = faster(sub(at_quarter.a, chord.a), sub(at_quarter.b, chord.b));
        bend = larger(bend, 1.25 * off);
    }
    return bend;
}

static int sweep_straight(struct tour *tour, const struct ends *from, const struct ends *to,
                          double bend, double t0, double t1)
{
    const struct tree *tree = &tour->body->tree;
    struct passage *passage = &tour->passage;
    struct sweep sweep;
    passage->motion = (struct motion){ from->a, from->b, sub(to->a, from->a), sub(to->b, from->b) };
    sweep_begin(&sweep, &passage->motion, tour->radius + bend, tour->tolerance, tree_extent(tree));
    double start = t0 > 0.0 ? 0.0 : sweep_start(&sweep, tour->far);
    int result = sweep_mesh(tree, &tour->world->kernel, &sweep, start, tour->hint,
                            tour->most ? tour->most - tour->work : 0, &tour->voyage->progress,
                            &passage->strike, &tour->work);
    passage->time = t0 + passage->strike.time * (t1 - t0);
    if (result == SWEEP_FREE)
        tour->voyage->free_until = t1;
    return result;
}

/* From one moment to another, whose ends these are; what is behind is not swept again. */
static int sweep_between(struct tour *tour, const struct moment *from, const struct ends *at_from,
                         const struct moment *to, const struct ends *at_to, double t0, double t1,
                         int halves)
{
    if (t1 <= tour->voyage->free_until)
        return SWEEP_FREE;
    struct moment middle = middle_of(from, to);
    struct ends at_middle = ends_at(&middle);
    double bend = bend_between(from, at_from, &middle, &at_middle, to, at_to);
    int straight = bend <= 0.5 * tour->tolerance && body_turn_cosine(from, to) >= TURN_COSINE;
    if (straight || halves == 0)
        return sweep_straight(tour, at_from, at_to, bend, t0, t1);
    double half = 0.5 * (t0 + t1);
    int result = sweep_between(tour, from, at_from, &middle, &at_middle, t0, half, halves - 1);
    if (result != SWEEP_FREE)
        return result;
    if (tour->most && tour->work >= tour->most)
        return SWEEP_UNFINISHED;
    return sweep_between(tour, &middle, &at_middle, to, at_to, half, t1, halves - 1);
}

static struct was place_of(const struct dpt_world *world, const struct segment *segment)
{
    const struct tool *tool = &world->tools[segment->tool];
    const dpt_pose identity = DPT_POSE_IDENTITY;
    return (struct was){ .pose = tool->free ? identity : tool->pose,
                         .a = segment->a,
                         .b = segment->b,
                         .distance = segment->hit.lower_bound,
                         .known = segment->found.body != NULL };
}

/* How far the ends are apart in the tool's frame: not at all, unless it is free or its segments changed. */
static double differ(const struct was *from, const struct was *to)
{
    return length(sub(from->a, to->a)) + length(sub(from->b, to->b));
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

/* The side of the struck feature on which the point that struck it was when the motion began. */
static int side_before(const struct tour *tour)
{
    const struct strike *strike = &tour->passage.strike;
    const struct motion *motion = &tour->passage.motion;
    vec3 way = along(motion->da, strike->pair.s, sub(motion->db, motion->da));
    vec3 back = along(strike->pair.gap, -strike->time, way);
    return side_of_way(&tour->body->tree, strike->triangle, strike->pair.weight, back);
}

static void tell(const struct tour *tour, struct segment *segment)
{
    const struct strike *strike = &tour->passage.strike;
    const struct tree *tree = &tour->body->tree;
    int side = side_before(tour);
    vec3 normal = side_feature_normal(tree, strike->triangle, strike->pair.weight);
    double size = length(normal);
    dpt_sweep *sweep = &segment->sweep;
    sweep->body = tour->body->id;
    sweep->triangle = tree->sources[strike->triangle];
    sweep->s = strike->pair.s;
    vec3_store(frame_to_world(&tour->body->frame, strike->q), sweep->q);
    vec3_store(scaled(frame_turn(&tour->body->frame, normal), size > 0.0 ? side / size : 0.0),
               sweep->normal);
}

/* The side from which the axis came through a sheet. */
static void keep_side(const struct tour *tour, struct segment *segment)
{
    const struct strike *strike = &tour->passage.strike;
    const struct tree *tree = &tour->body->tree;
    uint32_t part = side_part(tree, strike->triangle);
    segment->met.body = tour->body->id;
    segment->met.part = part;
    segment->met.side = 0;
    segment->met.s = strike->pair.s;
    segment->met.triangle = strike->triangle;
    if (side_is_sheet(tree, part) && !side_is_border(tree, strike->triangle, strike->pair.weight))
        segment->met.side = side_before(tour);
}

/* Within what is left of the budget. */
static int take_tour(struct dpt_world *world, struct segment *segment, struct tour *tour,
                     const struct moment *from, const struct moment *to)
{
    int result = SWEEP_UNFINISHED;
    struct ends at_from = ends_at(from), at_to = ends_at(to);
    tour->most = world->left;
    tour->work = 0;
    tour->passage.time = tour->voyage->free_until;
    if (!world->def.budget || world->left)
        result = sweep_between(tour, from, &at_from, to, &at_to, 0.0, 1.0, HALVES_MOST);
    segment->hit.work += tour->work;
    if (world->def.budget)
        world->left -= tour->work;
    return result;
}

static void begin_tour(struct voyage *voyage, uint32_t on_axis)
{
    voyage->on_axis = on_axis;
    voyage->free_until = 0.0;
    voyage->progress.begun = 0;
}

/* What is nowhere nearer, before and after, than half of the way was not met. */
static int is_beyond(const struct tour *tour, const struct moment *from, const struct moment *to)
{
    struct moment middle = middle_of(from, to);
    struct ends at_from = ends_at(from), at_to = ends_at(to), at_middle = ends_at(&middle);
    double motion = faster(sub(at_to.a, at_from.a), sub(at_to.b, at_from.b));
    double bend = bend_between(from, &at_from, &middle, &at_middle, to, &at_to);
    return body_turn_cosine(from, to) >= TURN_COSINE &&
           tour->far + tour->voyage->to.distance >
               motion + 2.0 * (bend + tour->radius + 2.0 * tour->tolerance);
}

/* Here the budget ended. */
static int stop(struct segment *segment, struct voyage *voyage, const struct body *body,
                double time)
{
    voyage->body = body->id;
    voyage->sweep = segment->sweep;
    segment->sweep.time = time;
    segment->sweep.status = DPT_SWEEP_UNFINISHED;
    segment->met.passed = 1;
    return 0;
}

/*
 * One body: what the surface met before segment->sweep.time, and whether the axis went on, and through. 0 where the
 * budget ended.
 */
static int pass_body(struct dpt_world *world, uint32_t index, const struct body *body,
                     struct voyage *voyage, struct moment *from, struct moment *to)
{
    struct segment *segment = &world->segments[index];
    double diagonal = tree_diagonal(&body->tree), radius = segment->radius;
    struct tour tour = { .world = world,
                         .body = body,
                         .radius = segment->was.distance > radius ? radius : 0.0,
                         .far = segment->was.distance,
                         .tolerance = 0.5 * TRAVEL_TOLERANCE * diagonal,
                         .hint = *world_last(world, index, handle_index(body->id)),
                         .voyage = voyage };
    from->body = body->moved == world->ticks ? body->before : body->pose;
    to->body = body->pose;
    if (voyage->body != body->id) {
        if (is_beyond(&tour, from, to))
            return 1;
        begin_tour(voyage, 0);
    }
    int result = SWEEP_HIT;
    if (voyage->on_axis)
        tour.passage = voyage->surface;
    else
        result = take_tour(world, segment, &tour, from, to);
    if (result == SWEEP_FREE)
        return 1;
    if (tour.passage.time >= segment->sweep.time) {
        segment->met.passed = 1;
        return 1;
    }
    if (result == SWEEP_UNFINISHED)
        return stop(segment, voyage, body, tour.passage.time);
    struct tour axis = tour;
    axis.radius = 0.0;
    if (tour.radius > 0.0) {
        voyage->surface = tour.passage;
        if (!voyage->on_axis)
            begin_tour(voyage, 1);
        result = take_tour(world, segment, &axis, from, to);
    }
    if (result == SWEEP_UNFINISHED)
        return stop(segment, voyage, body, tour.passage.time);
    segment->sweep.time = tour.passage.time;
    segment->sweep.status = DPT_SWEEP_HIT;
    tell(&tour, segment);
    if (result == SWEEP_HIT) {
        segment->met.passed = 1;
        keep_side(&axis, segment);
    }
    return 1;
}

/* No point of the tool was farther away from where it is now than that, the arc of a turn included. */
static double way_of_tool(const struct moment *from, const struct moment *to)
{
    const dpt_pose middle_pose = pose_middle(&from->tool, &to->tool);
    const struct moment middle = { .tool = middle_pose,
                                   .a = scaled(add(from->a, to->a), 0.5),
                                   .b = scaled(add(from->b, to->b), 0.5) };
    struct ends at_first = tool_ends(from), at_last = tool_ends(to), at_middle = tool_ends(&middle);
    return faster(sub(at_last.a, at_first.a), sub(at_last.b, at_first.b)) +
           bend_of(&at_first, &at_middle, &at_last);
}

/* The bodies that a motion may have met. */
struct around {
    const struct dpt_world *world;
    struct box box;
    double reach;
    const uint32_t *list;
    uint32_t count;
};

static double way_of_body(const struct dpt_world *world, const struct body *body)
{
    return body->moved == world->ticks ? body->travelled : 0.0;
}

/* The one in the first slot from `slot` on, or NULL: in this order, whatever that of the list is. */
static const struct body *body_from(const struct around *around, uint32_t slot)
{
    const struct dpt_world *world = around->world;
    const struct body *first = NULL;
    uint32_t before = DPT_NONE;
    for (uint32_t i = around->list ? 0 : slot; i < around->count; i++) {
        uint32_t at = around->list ? around->list[i] : i;
        const struct body *body = &world->bodies[at];
        if (at < slot || at >= before || !body->slot.used ||
            box_distance(&around->box, &world->boxes[at]) >
                around->reach + way_of_body(world, body))
            continue;
        first = body;
        before = at;
        if (!around->list)
            break;
    }
    return first;
}

static struct around around_of(struct dpt_world *world, uint32_t index, double reach)
{
    const struct track *track = &world->segments[index].found.track;
    double moved = world->travelled_at == world->ticks ? world->travelled : 0.0;
    struct around around = { .world = world, .reach = reach, .count = world->body_end };
    around.box = box_of_axis(track->axis.a, track->axis.b);
    if (around.count > 1)
        around.count = bodies_within(world, index, reach + moved, &around.list);
    return around;
}

static int is_still(const struct around *around)
{
    const struct dpt_world *world = around->world;
    const struct body *body = NULL;
    if (world->travelled_at == world->ticks)
        for (body = body_from(around, 0); body && body->moved != world->ticks;)
            body = body_from(around, handle_index(body->id) + 1);
    return !body;
}

/* From where the segment was to voyage->to, or on from where that was stopped; 0 where the budget ended. */
static int sail(struct dpt_world *world, uint32_t index, const struct around *around,
                struct voyage *voyage)
{
    struct segment *segment = &world->segments[index];
    struct moment from, to;
    uint32_t slot = 0;
    moments_of(&segment->was, &voyage->to, &from, &to);
    if (voyage->body) {
        slot = handle_index(voyage->body);
        segment->sweep = voyage->sweep;
        segment->met.passed = segment->sweep.status == DPT_SWEEP_HIT;
    }
    const struct body *body;
    while ((body = body_from(around, slot)) != NULL) {
        if (!pass_body(world, index, body, voyage, &from, &to))
            return 0;
        voyage->body = 0;
        slot = handle_index(body->id) + 1;
    }
    return 1;
}

static double reach_of(const struct was *from, const struct was *to)
{
    struct moment first, last;
    moments_of(from, to, &first, &last);
    return way_of_tool(&first, &last);
}

/*
 * An earlier tick's motion that the budget stopped is finished first, unless a body has moved since. 1 when there is
 * nothing more to be done in this tick.
 */
static int finish(struct dpt_world *world, uint32_t index, struct voyage *voyage,
                  const struct was *now)
{
    struct segment *segment = &world->segments[index];
    const struct was *to = &voyage->to;
    double reach = reach_of(&segment->was, to) + reach_of(to, now) + segment->radius;
    struct around around = around_of(world, index, reach);
    if (voyage->radius != segment->radius || !is_still(&around)) {
        voyage->body = 0;
        return 0;
    }
    if (!sail(world, index, &around, voyage) || segment->sweep.status == DPT_SWEEP_HIT ||
        (differ(to, now) == 0.0 && pose_is_same(&to->pose, &now->pose)))
        return 1;
    segment->was = *to;
    return 0;
}

void travel_find(struct dpt_world *world, uint32_t index)
{
    struct segment *segment = &world->segments[index];
    struct voyage fresh, *voyage = world->def.budget ? &world->voyages[index] : &fresh;
    if (!world->def.budget || !segment->was.known)
        voyage->body = 0;
    if (!segment->was.known || (segment->was.through && !voyage->body))
        return;
    const struct was now = place_of(world, segment);
    double reach = reach_of(&segment->was, &now) + segment->radius;
    double moved = world->travelled_at == world->ticks ? world->travelled : 0.0;
    segment->sweep.status = DPT_SWEEP_FREE;
    segment->sweep.time = 1.0;
    if (segment->hit.lower_bound > reach + moved + segment->hit.error_bound) {
        voyage->body = 0;
        return;
    }
    if (voyage->body) {
        if (finish(world, index, voyage, &now))
            return;
        reach = reach_of(&segment->was, &now) + segment->radius;
    }
    voyage->to = now;
    voyage->radius = segment->radius;
    struct around around = around_of(world, index, reach);
    if (!sail(world, index, &around, voyage) && !is_still(&around))
        voyage->body = 0;
}

/* Where a budget left nothing proven of the nearest pair, the sweep may tell. */
static int is_through(const struct segment *segment)
{
    int swept = segment->sweep.status != DPT_SWEEP_NONE && !segment->met.passed;
    return segment->hit.lower_bound == 0.0 &&
           (segment->found.exact || segment->hit.distance == 0.0 || !swept);
}

void travel_end(struct dpt_world *world, uint32_t index)
{
    struct segment *segment = &world->segments[index];
    if (segment->sweep.status == DPT_SWEEP_UNFINISHED)
        return;
    segment->was = place_of(world, segment);
    segment->was.through = (uint32_t)is_through(segment);
}
