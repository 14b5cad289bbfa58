/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A motion is halved until, in each piece, corners move so nearly in straight lines that a little more clearance covers
 * the rest. A plane that has both ends of all corners' motions on one side and a triangle on the other then keeps them
 * apart at all times between. A piece that no plane parts from some triangle is halved as well, until it is shorter than
 * the tolerance: there the hull may touch.
 */
#include "hull/hull_sweep.h"

#include "hull/separate.h"
#include "nearest/range_search.h"

#include <string.h>

enum { HALVINGS_MAX = 40, PLANES = SWEEP_DIRECTIONS_MAX + 2 };

/* A place of a hull during a motion, in the body's frame then. */
struct instant {
    struct placement placement;
    vec3 corner[HULL_CORNERS_MAX];
    vec3 a, b; /* the hull's axis */
    double time;
};

/* A piece of a motion: its two ends' corners in one list, and the planes that are tried first. */
struct piece {
    const struct instant *from, *to;
    vec3 corner[2 * HULL_CORNERS_MAX];
    uint32_t corner_count;
    double motion; /* m: of the corner that moves most */
    double apart;  /* m: what a plane must part them by */
    vec3 plane[PLANES];
    double support[PLANES];
    uint32_t plane_count;
};

static void set_instant(struct instant *instant, const struct dpt_hull *hull)
{
    struct frame tool, body;
    frame_of_pose(&instant->placement.tool, &tool);
    frame_of_pose(&instant->placement.body, &body);
    for (uint32_t i = 0; i < hull->corner_count; i++)
        instant->corner[i] = frame_to_local(&body, frame_to_world(&tool, hull->corner[i]));
    instant->a = frame_to_local(&body, frame_to_world(&tool, hull->axis_a));
    instant->b = frame_to_local(&body, frame_to_world(&tool, hull->axis_b));
}

static void set_middle(const struct instant *from, const struct instant *to,
                       const struct dpt_hull *hull, struct instant *middle)
{
    middle->placement.tool = pose_middle(&from->placement.tool, &to->placement.tool);
    middle->placement.body = pose_middle(&from->placement.body, &to->placement.body);
    middle->time = 0.5 * (from->time + to->time);
    set_instant(middle, hull);
}

/* m: how far corners move at most. */
static double motion_between(const struct dpt_hull *hull, const struct instant *from,
                             const struct instant *to)
{
    double most = 0.0;
    for (uint32_t i = 0; i < hull->corner_count; i++)
        most = max_of(most, length(sub(to->corner[i], from->corner[i])));
    return most;
}

/* The corners of a straight motion in its middle. */
static void set_chord(const struct dpt_hull *hull, const struct instant *from,
                      const struct instant *to, struct instant *chord)
{
    for (uint32_t i = 0; i < hull->corner_count; i++)
        chord->corner[i] = scaled(add(from->corner[i], to->corner[i]), 0.5);
}

/* Of the deviation in the middle: for paths that are no even arc. */
#define UNEVEN 1.25

/*
 * m: how far the corners' paths deviate from straight ones. Seen from a body that turns, a path can deviate to one side
 * and then to the other, so the quarters count too.
 */
static double deviation_between(const struct dpt_hull *hull, const struct instant *from,
                                const struct instant *middle, const struct instant *to)
{
    struct instant straight, quarter, chord;
    set_chord(hull, from, to, &straight);
    double most = motion_between(hull, &straight, middle);
    if (memcmp(from->placement.body.orientation, to->placement.body.orientation,
               sizeof from->placement.body.orientation) == 0)
        return UNEVEN * most;
    for (int half = 0; half < 2; half++) {
        set_middle(half ? middle : from, half ? to : middle, hull, &quarter);
        set_chord(hull, half ? &straight : from, half ? to : &straight, &chord);
        most = max_of(most, motion_between(hull, &chord, &quarter));
    }
    return UNEVEN * most;
}

/* A body that turns by more than 0.25 rad is cut in any case. This is the cosine of half that angle. */
#define HALF_TURN_COSINE_MIN 0.9922

static int body_turns_little(const struct placement *from, const struct placement *to)
{
    double cosine = 0.0;
    for (int k = 0; k < 4; k++)
        cosine += from->body.orientation[k] * to->body.orientation[k];
    return fabs(cosine) >= HALF_TURN_COSINE_MIN;
}

static double vertex_time(const struct hull_sweep *sweep, double time)
{
    return sweep->tick_from + time * (1.0 - sweep->tick_from);
}

/* m: no vertex moves farther in the sweep. */
static double surface_motion_of(const struct hull_sweep *sweep)
{
    const struct surface_motion *motion = sweep->surface->motion;
    return sweep->tick
               ? (1.0 - sweep->tick_from) * (double)motion->step[motion->first[motion->levels]] /
                     sweep->surface->filter_scale
               : 0.0;
}

/* The newest plane takes the place of the last one, where there is no room. */
static void add_plane(struct piece *piece, vec3 n)
{
    if (piece->plane_count == PLANES)
        piece->plane_count--;
    piece->support[piece->plane_count] = support_of(piece->corner, piece->corner_count, n);
    piece->plane[piece->plane_count++] = n;
}

static void set_piece(const struct hull_sweep *sweep, const struct instant *from,
                      const struct instant *to, double deviation, struct piece *piece)
{
    const uint32_t count = sweep->hull->corner_count;
    memcpy(piece->corner, from->corner, count * sizeof *piece->corner);
    memcpy(piece->corner + count, to->corner, count * sizeof *piece->corner);
    piece->from = from;
    piece->to = to;
    piece->corner_count = 2 * count;
    piece->motion = motion_between(sweep->hull, from, to);
    piece->apart = max_of(0.0, sweep->hull->radius + sweep->clearance) + deviation;
    piece->plane_count = 0;
    for (uint32_t i = 0; i < sweep->direction_count; i++)
        add_plane(piece, sweep->directions[i]);
}

/* The corners of a triangle during a piece: 3, or 6 where it moves. */
static uint32_t corners_during(const struct hull_sweep *sweep, const struct piece *piece,
                               uint32_t triangle, vec3 v[6])
{
    surface_corners(sweep->surface, triangle, v);
    if (!sweep->tick)
        return 3;
    for (int k = 0; k < 2; k++) {
        const double time = vertex_time(sweep, (k ? piece->to : piece->from)->time);
        const struct surface then = surface_view(sweep->surface, sweep->tick, time);
        surface_corners(&then, triangle, v + 3 * (size_t)k);
    }
    return 6;
}

/* Whether a plane parts the piece from a triangle; one that is found is tried first from now on. */
static int is_parted(const struct hull_sweep *sweep, struct piece *piece, uint32_t triangle)
{
    vec3 v[6], n = { 0.0, 0.0, 0.0 };
    const uint32_t count = corners_during(sweep, piece, triangle, v);
    for (uint32_t i = piece->plane_count; i-- > 0;) {
        n = piece->plane[i];
        if (-support_of(v, count, scaled(n, -1.0)) - piece->support[i] > piece->apart)
            return 1;
    }
    work_spend(sweep->work, 1);
    if (!dpti_separate(piece->corner, piece->corner_count, v, count, piece->apart, &n))
        return 0;
    add_plane(piece, n);
    return 1;
}

enum { PIECE_FREE, PIECE_TOUCHES, PIECE_UNFINISHED };

/* Whether planes part a piece from all triangles. sweep->triangle is tried first; at the end it is one that may touch. */
static int test_piece(struct hull_sweep *sweep, struct piece *piece)
{
    const struct instant *from = piece->from;
    struct range range;
    uint32_t triangle;
    int may_touch;
    if (work_is_spent(sweep->work))
        return PIECE_UNFINISHED;
    if (sweep->triangle != DPT_NONE && !is_parted(sweep, piece, sweep->triangle))
        return PIECE_TOUCHES;
    dpti_range_begin(&range, sweep->surface, sweep->kernel, from->a, sub(from->b, from->a),
                     sweep->hull->reach + piece->motion + piece->apart + surface_motion_of(sweep),
                     sweep->work);
    while ((triangle = dpti_range_next(&range, &may_touch)) != DPT_NONE)
        if (!is_parted(sweep, piece, triangle)) {
            sweep->triangle = triangle;
            return PIECE_TOUCHES;
        }
    return range.level > sweep->surface->levels ? PIECE_FREE : PIECE_UNFINISHED;
}

/* Of the hull's size: no piece is longer, so that few triangles are near it. */
#define PIECE_LENGTH_MAX 0.5

static double piece_length_max(const struct dpt_hull *hull)
{
    return PIECE_LENGTH_MAX * (length(sub(hull->axis_b, hull->axis_a)) + hull->reach);
}

/* A piece between two instants: is it free, may it touch, or is it to be halved at `middle`? */
enum { PIECE_HALVED = PIECE_UNFINISHED + 1 };

static int sweep_piece(struct hull_sweep *sweep, const struct instant *from,
                       const struct instant *to, struct instant *middle)
{
    struct piece piece;
    set_middle(from, to, sweep->hull, middle);
    const double deviation = deviation_between(sweep->hull, from, middle, to);
    set_piece(sweep, from, to, deviation, &piece);
    if (!body_turns_little(&from->placement, &to->placement) ||
        piece.motion + deviation > piece_length_max(sweep->hull))
        return PIECE_HALVED;
    const int status = test_piece(sweep, &piece);
    return status == PIECE_TOUCHES && piece.motion + deviation > sweep->tolerance ? PIECE_HALVED
                                                                                  : status;
}

/* Where the pieces end that are still to be swept, the last one first. */
struct pending {
    struct placement placement;
    double time;
};

static struct instant instant_of(const struct hull_sweep *sweep, const struct placement *placement,
                                 double time)
{
    struct instant made = { .placement = *placement, .time = time };
    set_instant(&made, sweep->hull);
    return made;
}

int dpti_hull_sweep(struct hull_sweep *sweep, const struct placement *from,
                    const struct placement *to)
{
    struct pending pending[HALVINGS_MAX + 1] = { { *to, 1.0 } };
    struct instant at = instant_of(sweep, from, 0.0);
    sweep->time = 0.0;
    for (int count = 1; count > 0;) {
        const struct pending *next = &pending[count - 1];
        const struct instant end = instant_of(sweep, &next->placement, next->time);
        struct instant middle;
        const int status = sweep_piece(sweep, &at, &end, &middle);
        if (status == PIECE_UNFINISHED)
            return SWEEP_UNFINISHED;
        if (status == PIECE_TOUCHES || (status == PIECE_HALVED && count > HALVINGS_MAX))
            return SWEEP_HIT;
        if (status == PIECE_HALVED) {
            pending[count++] = (struct pending){ middle.placement, middle.time };
            continue;
        }
        at = end;
        sweep->time = end.time;
        count--;
    }
    return SWEEP_FREE;
}

double dpti_hull_displacement(const struct dpt_hull *hull, const dpt_pose *from, const dpt_pose *to)
{
    struct instant first = { .placement = { .tool = *from, .body = DPT_POSE_IDENTITY } };
    struct instant last = { .placement = { .tool = *to, .body = DPT_POSE_IDENTITY } };
    struct instant middle;
    set_instant(&first, hull);
    set_instant(&last, hull);
    set_middle(&first, &last, hull, &middle);
    return motion_between(hull, &first, &last) + deviation_between(hull, &first, &middle, &last);
}
