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
    struct strike strike;
    struct motion motion; /* in which it was */
    double time;          /* of it, or up to which it is free */
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
    struct sweep sweep;
    tour->motion = (struct motion){ from->a, from->b, sub(to->a, from->a), sub(to->b, from->b) };
    sweep_begin(&sweep, &tour->motion, tour->radius + bend, tour->tolerance, tree_extent(tree));
    double start = t0 > 0.0 ? 0.0 : sweep_start(&sweep, tour->far);
    int result = SWEEP_FREE;
    if (start < 1.0)
        result = sweep_mesh(tree, &tour->world->kernel, &sweep, start, tour->hint,
                            tour->most ? tour->most - tour->work : 0, &tour->strike, &tour->work);
    double part = result == SWEEP_FREE ? 1.0 : tour->strike.time;
    tour->time = t0 + part * (t1 - t0);
    return result;
}

/* From one moment to another, whose ends these are. */
static int sweep_between(struct tour *tour, const struct moment *from, const struct ends *at_from,
                         const struct moment *to, const struct ends *at_to, double t0, double t1,
                         int halves)
{
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

/* Where the segment was, and where it is; of a free tool, or one whose segments changed, in the world. */
static void moments_of(const struct dpt_world *world, const struct segment *segment,
                       struct moment *from, struct moment *to)
{
    const struct tool *tool = &world->tools[segment->tool];
    const struct was *was = &segment->was;
    const dpt_pose identity = DPT_POSE_IDENTITY;
    *from = (struct moment){ .tool = was->pose, .a = was->a, .b = was->b };
    *to = (struct moment){ .tool = tool->free ? identity : tool->pose,
                           .a = segment->a,
                           .b = segment->b };
    if (length(sub(from->a, to->a)) + length(sub(from->b, to->b)) == 0.0)
        return;
    struct frame before;
    frame_of_pose(&was->pose, &before);
    *from = (struct moment){ .tool = identity,
                             .a = frame_to_world(&before, was->a),
                             .b = frame_to_world(&before, was->b) };
    *to = (struct moment){ .tool = identity,
                           .a = frame_to_world(&tool->frame, segment->a),
                           .b = frame_to_world(&tool->frame, segment->b) };
}

/* The side of the struck feature on which the point that struck it was when the motion began. */
static int side_before(const struct tour *tour)
{
    const struct strike *strike = &tour->strike;
    const struct motion *motion = &tour->motion;
    vec3 way = along(motion->da, strike->pair.s, sub(motion->db, motion->da));
    vec3 back = along(strike->pair.gap, -strike->time, way);
    return side_of_way(&tour->body->tree, strike->triangle, strike->pair.weight, back);
}

static void tell(const struct tour *tour, struct segment *segment)
{
    const struct strike *strike = &tour->strike;
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
    const struct strike *strike = &tour->strike;
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
    tour->time = 0.0;
    if (!world->def.budget || world->left)
        result = sweep_between(tour, from, &at_from, to, &at_to, 0.0, 1.0, HALVES_MOST);
    segment->hit.work += tour->work;
    if (world->def.budget)
        world->left -= tour->work;
    return result;
}

/* One body: what the surface met before segment->sweep.time, and whether the axis went on, and through. */
static void pass_body(struct dpt_world *world, uint32_t index, const struct body *body,
                      struct moment *from, struct moment *to)
{
    struct segment *segment = &world->segments[index];
    double diagonal = tree_diagonal(&body->tree), radius = segment->radius;
    struct tour tour = { .world = world,
                         .body = body,
                         .radius = segment->was.distance > radius ? radius : 0.0,
                         .far = segment->was.distance,
                         .tolerance = 0.5 * TRAVEL_TOLERANCE * diagonal,
                         .hint = *world_last(world, index, handle_index(body->id)) };
    from->body = body->moved == world->ticks ? body->before : body->pose;
    to->body = body->pose;
    struct moment middle = middle_of(from, to);
    struct ends at_from = ends_at(from), at_to = ends_at(to), at_middle = ends_at(&middle);
    double motion = faster(sub(at_to.a, at_from.a), sub(at_to.b, at_from.b));
    double bend = bend_between(from, &at_from, &middle, &at_middle, to, &at_to);
    double now = segment->hit.lower_bound;
    int turns = body_turn_cosine(from, to) < TURN_COSINE;
    if (!turns &&
        segment->was.distance + now > motion + 2.0 * (bend + tour.radius + 2.0 * tour.tolerance))
        return;
    int result = take_tour(world, segment, &tour, from, to);
    if (result == SWEEP_FREE)
        return;
    if (tour.time >= segment->sweep.time) {
        segment->met.passed = 1;
        return;
    }
    struct tour axis = tour;
    int through = result;
    axis.radius = 0.0;
    if (result == SWEEP_HIT && tour.radius > 0.0)
        through = take_tour(world, segment, &axis, from, to);
    segment->sweep.time = tour.time;
    if (through == SWEEP_UNFINISHED) {
        segment->sweep.status = DPT_SWEEP_UNFINISHED;
        segment->met.passed = 1;
        return;
    }
    segment->sweep.status = DPT_SWEEP_HIT;
    tell(&tour, segment);
    if (through == SWEEP_HIT) {
        segment->met.passed = 1;
        keep_side(&axis, segment);
    }
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

void travel_find(struct dpt_world *world, uint32_t index)
{
    struct segment *segment = &world->segments[index];
    if (!segment->was.known || segment->was.distance == 0.0)
        return;
    struct moment from, to;
    moments_of(world, segment, &from, &to);
    vec3 a = segment->found.track.axis.a, b = segment->found.track.axis.b;
    struct box box = box_of_axis(a, b);
    double reach = way_of_tool(&from, &to) + segment->radius;
    const uint32_t *list = NULL;
    uint32_t count = world->body_end;
    double moved = world->travelled_at == world->ticks ? world->travelled : 0.0;
    segment->sweep.status = DPT_SWEEP_FREE;
    segment->sweep.time = 1.0;
    if (segment->hit.lower_bound > reach + moved + segment->hit.error_bound)
        return;
    if (count > 1)
        count = bodies_within(world, index, reach + moved, &list);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t slot = list ? list[i] : i;
        const struct body *body = &world->bodies[slot];
        double by = body->moved == world->ticks ? body->travelled : 0.0;
        if (body->slot.used && box_distance(&box, &world->boxes[slot]) <= reach + by)
            pass_body(world, index, body, &from, &to);
    }
}

void travel_end(struct dpt_world *world, uint32_t index)
{
    struct segment *segment = &world->segments[index];
    const struct tool *tool = &world->tools[segment->tool];
    const dpt_pose identity = DPT_POSE_IDENTITY;
    if (segment->sweep.status == DPT_SWEEP_UNFINISHED)
        return;
    segment->was = (struct was){ .pose = tool->free ? identity : tool->pose,
                                 .a = segment->a,
                                 .b = segment->b,
                                 .distance = segment->hit.lower_bound,
                                 .known = segment->found.body != NULL };
}
