/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * In each piece of a motion a corner's path is nearly a parabola; its deviation is added to the clearance. A plane
 * between hull and triangle may turn during the piece: its normal goes in a straight line from one vector to another.
 * The height of a corner, or of the triangle, along that normal is a polynomial of the third degree in time. Where its
 * Bernstein coefficients are in order, corners and triangle are apart at all times of the piece. The error is of third
 * order in the turn; with a plane at rest it would be of first order. So a tip that rolls and turns on a surface needs
 * few pieces.
 *
 * A piece that no plane separates from some triangle is halved. Once it is shorter than the tolerance, the hull may
 * touch there.
 */
#include "hull/hull_sweep.h"

#include "hull/hull_range.h"
#include "hull/hull_triangle.h"

#include <string.h>

enum { HALVINGS_MAX = 40, PLANES = SWEEP_DIRECTIONS_MAX + 4, COEFFICIENTS = 4 };

/* A place of a hull during a motion, in the body's frame then. */
struct instant {
    struct placement placement;
    vec3 corner[HULL_CORNERS_MAX];
    vec3 a, b; /* the hull's axis */
    double time;
};

/* A plane that may turn during a piece: its normal at both ends, unit, and how high the hull is along it. */
struct turning_plane {
    vec3 from, to;
    double support[COEFFICIENTS]; /* the greatest Bernstein coefficients of all corners */
};

/* The points that hold a corner's path: its ends, and where the tangents there meet. */
enum { PATH_POINTS = 3 };

/* A piece of a motion: what holds its corners' paths, and the planes that are tried first. */
struct piece {
    const struct instant *from, *to;
    vec3 corner[PATH_POINTS * HULL_CORNERS_MAX]; /* at the beginning, at the end, between */
    uint32_t corner_count;
    double motion;       /* m: no point of the hull moves farther from where it begins */
    double displacement; /* m: the same of hull and surface together */
    double apart;        /* m: what a plane must part them by */
    struct turning_plane plane[PLANES];
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

/* The hull at an instant, for its pairs. */
static void place_at(const struct dpt_hull *hull, const struct instant *instant, struct hull_place *place)
{
    struct frame tool, body;
    frame_of_pose(&instant->placement.tool, &tool);
    frame_of_pose(&instant->placement.body, &body);
    hull_place_set(place, hull, &tool, &body);
}

static void set_middle(const struct instant *from, const struct instant *to, const struct dpt_hull *hull,
                       struct instant *middle)
{
    middle->placement.tool = pose_middle(&from->placement.tool, &to->placement.tool);
    middle->placement.body = pose_middle(&from->placement.body, &to->placement.body);
    middle->time = 0.5 * (from->time + to->time);
    set_instant(middle, hull);
}

static int is_same_turn(const double *from, const double *to)
{
    return memcmp(from, to, 4 * sizeof *from) == 0;
}

/*
 * Of the deviation at the quarters: the most that it is elsewhere, for cubic and quartic terms, and half as much again.
 */
#define UNEVEN 2.0

/* m: how far corners' paths deviate from the parabolas through their ends and middles. */
static double deviation_between(const struct dpt_hull *hull, const struct instant *from, const struct instant *middle,
                                const struct instant *to)
{
    struct instant quarter;
    double max = 0.0;
    if (is_same_turn(from->placement.tool.orientation, to->placement.tool.orientation) &&
        is_same_turn(from->placement.body.orientation, to->placement.body.orientation))
        return 0.0;
    for (int half = 0; half < 2; half++) {
        set_middle(half ? middle : from, half ? to : middle, hull, &quarter);
        for (uint32_t i = 0; i < hull->corner_count; i++) {
            const vec3 near = (half ? to : from)->corner[i], far = (half ? from : to)->corner[i];
            const vec3 at = along(along(scaled(near, 0.375), 0.75, middle->corner[i]), -0.125, far);
            max = max_of(max, length(sub(quarter.corner[i], at)));
        }
    }
    return UNEVEN * max;
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
    return sweep->tick ? (1.0 - sweep->tick_from) * (double)motion->step[motion->first[motion->levels]] /
                             sweep->surface->filter_scale
                       : 0.0;
}

static struct turning_plane plane_of(const struct piece *piece, vec3 from, vec3 to)
{
    const uint32_t count = piece->corner_count / PATH_POINTS;
    struct turning_plane plane = { from, to, { -HUGE_VAL, -HUGE_VAL, -HUGE_VAL, -HUGE_VAL } };
    for (uint32_t i = 0; i < count; i++) {
        const vec3 first = piece->corner[i], last = piece->corner[count + i];
        const vec3 bend = piece->corner[2 * count + i];
        const double at[COEFFICIENTS] = { dot(from, first), (dot(to, first) + 2.0 * dot(from, bend)) / 3.0,
                                          (2.0 * dot(to, bend) + dot(from, last)) / 3.0, dot(to, last) };
        for (int k = 0; k < COEFFICIENTS; k++)
            plane.support[k] = max_of(plane.support[k], at[k]);
    }
    return plane;
}

/* The newest plane takes the place of the last one, where there is no room. */
static void add_plane(struct piece *piece, const struct turning_plane *plane)
{
    if (piece->plane_count == PLANES)
        piece->plane_count--;
    piece->plane[piece->plane_count++] = *plane;
}

/*
 * This share of the tolerance is kept as distance. So a pose that was found free is still free when fewer halvings make
 * it.
 */
#define KEPT_APART 0.25

static void set_piece(const struct hull_sweep *sweep, const struct instant *from, const struct instant *middle,
                      const struct instant *to, struct piece *piece)
{
    const uint32_t count = sweep->hull->corner_count;
    const double deviation = deviation_between(sweep->hull, from, middle, to);
    piece->from = from;
    piece->to = to;
    piece->corner_count = PATH_POINTS * count;
    piece->motion = 0.0;
    for (uint32_t i = 0; i < count; i++) {
        const vec3 chord = scaled(add(from->corner[i], to->corner[i]), 0.5);
        const vec3 bend = along(chord, 2.0, sub(middle->corner[i], chord));
        piece->corner[i] = from->corner[i];
        piece->corner[count + i] = to->corner[i];
        piece->corner[2 * count + i] = bend;
        piece->motion = max_of(piece->motion,
                               max_of(length(sub(to->corner[i], from->corner[i])), length(sub(bend, from->corner[i]))));
    }
    piece->motion += deviation;
    piece->displacement = piece->motion + (to->time - from->time) * surface_motion_of(sweep);
    piece->apart = max_of(0.0, sweep->hull->radius + sweep->clearance) + deviation + KEPT_APART * sweep->tolerance;
    piece->plane_count = 0;
    for (uint32_t i = 0; i < sweep->direction_count; i++) {
        const struct turning_plane plane = plane_of(piece, sweep->directions[i], sweep->directions[i]);
        add_plane(piece, &plane);
    }
}

/* A triangle during a piece: its corners at the beginning, and then at the end. */
struct moving_corners {
    vec3 v[6];
    uint32_t count; /* 3: it does not move */
};

static void set_corners(const struct hull_sweep *sweep, const struct piece *piece, uint32_t triangle,
                        struct moving_corners *corners)
{
    corners->count = sweep->tick ? 6 : 3;
    if (!sweep->tick)
        surface_corners(sweep->surface, triangle, corners->v);
    for (int k = 0; k < 2 && sweep->tick; k++) {
        const double time = vertex_time(sweep, (k ? piece->to : piece->from)->time);
        const struct surface then = surface_view(sweep->surface, sweep->tick, time);
        surface_corners(&then, triangle, corners->v + 3 * (size_t)k);
    }
}

/* Whether a plane parts a triangle from the piece's hull: its coefficients are all higher. */
static int plane_parts(const struct piece *piece, const struct turning_plane *plane,
                       const struct moving_corners *corners)
{
    double low[COEFFICIENTS] = { HUGE_VAL, HUGE_VAL, HUGE_VAL, HUGE_VAL };
    for (uint32_t k = 0; k < 3; k++) {
        const vec3 first = corners->v[k], last = corners->v[k + corners->count - 3];
        const double begin = dot(plane->from, first), end = dot(plane->to, last);
        const double middle = 0.5 * (dot(plane->from, last) + dot(plane->to, first));
        const double at[COEFFICIENTS] = { begin, (begin + 2.0 * middle) / 3.0, (2.0 * middle + end) / 3.0, end };
        for (int i = 0; i < COEFFICIENTS; i++)
            low[i] = min_of(low[i], at[i]);
    }
    for (int i = 0; i < COEFFICIENTS; i++)
        if (!(low[i] - plane->support[i] > piece->apart))
            return 0;
    return 1;
}

/* The direction from hull to triangle at one end of a piece; 0: they meet, or are farther apart than needs looking at. */
static vec3 direction_at(const struct hull_sweep *sweep, const struct instant *instant, const vec3 v[3], double limit)
{
    const vec3 none = { 0.0, 0.0, 0.0 };
    struct hull_place place;
    struct hull_pair found;
    place_at(sweep->hull, instant, &place);
    return dpti_hull_triangle(&place, v, limit, &found) ? unit_of(scaled(found.pair.gap, -1.0)) : none;
}

/* The plane across the nearest pairs at both ends of a piece. 0: there is none. */
static int find_turning_plane(const struct hull_sweep *sweep, const struct piece *piece,
                              const struct moving_corners *corners, struct turning_plane *plane)
{
    const double limit = piece->apart + 4.0 * (piece->motion + surface_motion_of(sweep));
    const vec3 from = direction_at(sweep, piece->from, corners->v, limit);
    const vec3 to = direction_at(sweep, piece->to, corners->v + corners->count - 3, limit);
    /* Normals that are far from each other would make a short one between them. */
    if (!(dot(from, to) > 0.5))
        return 0;
    *plane = plane_of(piece, from, to);
    return 1;
}

/* Whether a plane parts the piece from a triangle; one that is found is tried first from now on. */
static int is_parted(const struct hull_sweep *sweep, struct piece *piece, uint32_t triangle)
{
    struct moving_corners corners;
    struct turning_plane plane;
    vec3 n = { 0.0, 0.0, 0.0 };
    set_corners(sweep, piece, triangle, &corners);
    for (uint32_t i = piece->plane_count; i-- > 0;) {
        n = piece->plane[i].from;
        if (plane_parts(piece, &piece->plane[i], &corners))
            return 1;
    }
    work_spend(sweep->work, 1);
    if (dpti_separate(piece->corner, piece->corner_count, corners.v, corners.count, piece->apart, &n)) {
        plane = plane_of(piece, n, n);
        add_plane(piece, &plane);
        return 1;
    }
    if (!find_turning_plane(sweep, piece, &corners, &plane) || !plane_parts(piece, &plane, &corners))
        return 0;
    add_plane(piece, &plane);
    return 1;
}

/* Planes of the piece that do not turn, for whole leaves: those from `first` on. */
static void set_leaf_planes(const struct hull_sweep *sweep, const struct piece *piece, uint32_t first,
                            struct range *range)
{
    const struct instant *from = piece->from;
    const double reach = piece->apart + surface_motion_of(sweep);
    const double size = length(sub(from->a, sweep->surface->filter_centre)) + length(sub(from->b, from->a)) +
                        sweep->hull->reach + piece->motion + reach;
    for (uint32_t i = first; i < piece->plane_count && i < HULL_RANGE_PLANES; i++) {
        const struct turning_plane *plane = &piece->plane[i];
        double max = plane->support[0];
        for (int k = 1; k < COEFFICIENTS; k++)
            max = max_of(max, plane->support[k]);
        if (memcmp(&plane->from, &plane->to, sizeof plane->from) == 0)
            hull_range_set_plane(range, i, plane->from, max + reach, size);
    }
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
                     sweep->hull->reach + piece->motion + piece->apart + surface_motion_of(sweep), sweep->work);
    uint32_t planes = 0;
    for (;;) {
        if (planes < piece->plane_count)
            set_leaf_planes(sweep, piece, planes, &range);
        planes = piece->plane_count;
        triangle = dpti_range_next(&range, &may_touch);
        if (triangle == DPT_NONE)
            break;
        if (!is_parted(sweep, piece, triangle)) {
            sweep->triangle = triangle;
            return PIECE_TOUCHES;
        }
    }
    return range.level > sweep->surface->levels ? PIECE_FREE : PIECE_UNFINISHED;
}

/* The longest piece, as a share of the hull's size: few triangles are near a short one. */
#define PIECE_LENGTH_MAX 0.5

static double piece_length_max(const struct dpt_hull *hull)
{
    return PIECE_LENGTH_MAX * (length(sub(hull->axis_b, hull->axis_a)) + hull->reach);
}

/* A piece between two instants; PIECE_LONG: it is to be halved at `middle` before it can be tested. */
enum { PIECE_LONG = PIECE_UNFINISHED + 1 };

static int sweep_piece(struct hull_sweep *sweep, const struct instant *from, const struct instant *to,
                       struct instant *middle)
{
    struct piece piece;
    set_middle(from, to, sweep->hull, middle);
    set_piece(sweep, from, middle, to, &piece);
    if (!body_turns_little(&from->placement, &to->placement) || piece.motion > piece_length_max(sweep->hull))
        return PIECE_LONG;
    return test_piece(sweep, &piece);
}

/* Where the pieces end that are still to be swept, the last one first. */
struct pending {
    struct placement placement;
    double time;
};

static struct pending pending_of(const struct instant *instant)
{
    return (struct pending){ instant->placement, instant->time };
}

static struct instant instant_of(const struct hull_sweep *sweep, const struct pending *pending)
{
    struct instant made = { .placement = pending->placement, .time = pending->time };
    set_instant(&made, sweep->hull);
    return made;
}

/*
 * Whether a piece that is not parted from sweep->triangle as a whole touches it, by halves: PIECE_TOUCHES, and *until
 * is the end of what is parted. What touches is shorter than the tolerance, or than the wanted share of the whole.
 */
static int touches_alone(const struct hull_sweep *sweep, const struct instant *from, const struct instant *to,
                         struct instant *until)
{
    struct pending pending[HALVINGS_MAX + 1] = { pending_of(to) };
    const double shortest = sweep->resolution * (to->time - from->time);
    struct piece piece;
    *until = *from;
    for (int count = 1; count > 0;) {
        const struct instant end = instant_of(sweep, &pending[count - 1]);
        struct instant middle;
        if (work_is_spent(sweep->work))
            return PIECE_UNFINISHED;
        set_middle(until, &end, sweep->hull, &middle);
        set_piece(sweep, until, &middle, &end, &piece);
        if (is_parted(sweep, &piece, sweep->triangle)) {
            *until = end;
            count--;
        } else if (piece.displacement <= sweep->tolerance || end.time - until->time <= shortest ||
                   count > HALVINGS_MAX) {
            return PIECE_TOUCHES;
        } else {
            pending[count++] = pending_of(&middle);
        }
    }
    return PIECE_FREE;
}

int dpti_hull_sweep(struct hull_sweep *sweep, const struct placement *from, const struct placement *to)
{
    struct pending pending[HALVINGS_MAX + 2] = { { *to, 1.0 } };
    const struct pending begin = { *from, 0.0 };
    struct instant at = instant_of(sweep, &begin);
    int ends_with_hit = 0;
    sweep->time = 0.0;
    for (int count = 1; count > 0;) {
        const struct instant end = instant_of(sweep, &pending[count - 1]);
        struct instant middle;
        struct instant until;
        int status = sweep_piece(sweep, &at, &end, &middle);
        if (status == PIECE_FREE) {
            at = end;
            sweep->time = end.time;
            count--;
            continue;
        }
        if (status == PIECE_TOUCHES)
            status = touches_alone(sweep, &at, &end, &until);
        if (status == PIECE_UNFINISHED)
            return SWEEP_UNFINISHED;
        if (status == PIECE_TOUCHES) {
            if (until.time == at.time)
                return SWEEP_HIT;
            /* Nothing after the touch counts any more. */
            pending[0] = pending_of(&until);
            count = 1;
            ends_with_hit = 1;
            set_middle(&at, &until, sweep->hull, &middle);
        }
        if (count > HALVINGS_MAX)
            return SWEEP_HIT;
        pending[count++] = pending_of(&middle);
    }
    return ends_with_hit ? SWEEP_HIT : SWEEP_FREE;
}

double dpti_hull_displacement(const struct dpt_hull *hull, const dpt_pose *from, const dpt_pose *to)
{
    struct instant first = { .placement = { .tool = *from, .body = DPT_POSE_IDENTITY } };
    struct instant last = { .placement = { .tool = *to, .body = DPT_POSE_IDENTITY } }, middle;
    double max = 0.0;
    set_instant(&first, hull);
    set_instant(&last, hull);
    set_middle(&first, &last, hull, &middle);
    for (uint32_t i = 0; i < hull->corner_count; i++) {
        const vec3 chord = scaled(add(first.corner[i], last.corner[i]), 0.5);
        const vec3 bend = along(chord, 2.0, sub(middle.corner[i], chord));
        max = max_of(max, max_of(length(sub(last.corner[i], first.corner[i])), length(sub(last.corner[i], bend))));
    }
    return max + deviation_between(hull, &first, &middle, &last);
}
