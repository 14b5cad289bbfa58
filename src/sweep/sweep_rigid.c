/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A turn is halved until each part deviates from a straight motion by so little that a larger radius covers it. Most
 * ticks need no sweep: a body that was farther away, before and after, than the motion is long was not touched.
 */
#include "sweep/sweep_rigid.h"

#include "nearest/nearest_pair.h"

enum { HALVINGS_MAX = 10, PIECE_TRIANGLES = 16 };

struct ends {
    vec3 a, b;
};

/* The segment's ends in the world. */
static struct ends tool_ends(const struct placement *placement)
{
    struct frame tool;
    frame_of_pose(&placement->tool, &tool);
    return (struct ends){ frame_to_world(&tool, placement->a), frame_to_world(&tool, placement->b) };
}

/* The segment's ends in the body's frame. */
static struct ends ends_at(const struct placement *placement)
{
    struct ends ends = tool_ends(placement);
    struct frame body;
    frame_of_pose(&placement->body, &body);
    return (struct ends){ frame_to_local(&body, ends.a), frame_to_local(&body, ends.b) };
}

static struct placement middle_of(const struct placement *from, const struct placement *to)
{
    return (struct placement){ pose_middle(&from->tool, &to->tool), pose_middle(&from->body, &to->body),
                               scaled(add(from->a, to->a), 0.5), scaled(add(from->b, to->b), 0.5) };
}

/* A placement on the way, its ends in the body's frame, and its time. */
struct waypoint {
    const struct placement *placement;
    struct ends ends;
    double time;
};

static struct waypoint waypoint_of(const struct placement *placement, double time)
{
    return (struct waypoint){ placement, ends_at(placement), time };
}

static double max_length(vec3 da, vec3 db)
{
    return max_of(length(da), length(db));
}

static struct ends midpoint_of(const struct ends *from, const struct ends *to)
{
    return (struct ends){ scaled(add(from->a, to->a), 0.5), scaled(add(from->b, to->b), 0.5) };
}

/* How far the path of each end deviates from its chord, m. */
struct deviation {
    double a, b;
};

static double max_deviation(struct deviation deviation)
{
    return max_of(deviation.a, deviation.b);
}

/* A quarter more than in the middle, for paths that are no even arc. */
static struct deviation deviation_of(const struct ends *from, const struct ends *middle, const struct ends *to)
{
    struct ends straight = midpoint_of(from, to);
    return (struct deviation){ 1.25 * length(sub(middle->a, straight.a)), 1.25 * length(sub(middle->b, straight.b)) };
}

/* A body that turns by more than 0.25 rad is cut in any case. This is the cosine of half that angle. */
#define HALF_TURN_COSINE_MIN 0.9922

static double body_turn_cosine(const struct placement *from, const struct placement *to)
{
    double cosine = 0.0;
    for (int k = 0; k < 4; k++)
        cosine += from->body.orientation[k] * to->body.orientation[k];
    return fabs(cosine);
}

/*
 * The deviation of one part of a rigid sweep, in the body's frame. If only the tool turns, the path is an arc, which
 * deviates most in its middle. Seen from a body that turns, a path can deviate to one side and then to the other, so
 * the quarters count too.
 */
static struct deviation deviation_between(const struct waypoint *from, const struct waypoint *middle,
                                          const struct waypoint *to)
{
    struct deviation deviation = deviation_of(&from->ends, &middle->ends, &to->ends);
    int body_turns = 0;
    for (int k = 0; k < 4; k++)
        body_turns |= from->placement->body.orientation[k] != to->placement->body.orientation[k];
    if (!body_turns)
        return deviation;
    struct ends straight = midpoint_of(&from->ends, &to->ends);
    for (int half = 0; half < 2; half++) {
        struct placement quarter =
            half ? middle_of(middle->placement, to->placement) : middle_of(from->placement, middle->placement);
        struct ends at_quarter = ends_at(&quarter);
        struct ends chord = midpoint_of(&straight, half ? &to->ends : &from->ends);
        deviation.a = max_of(deviation.a, 1.25 * length(sub(at_quarter.a, chord.a)));
        deviation.b = max_of(deviation.b, 1.25 * length(sub(at_quarter.b, chord.b)));
    }
    return deviation;
}

/* m: no vertex moves farther in the sweep. */
static double surface_motion_max(const struct rigid_sweep *sweep)
{
    const struct surface_motion *motion = sweep->surface->motion;
    return sweep->tick ? (1.0 - sweep->tick_from) * (double)motion->step[motion->first[motion->levels]] /
                             sweep->surface->filter_scale
                       : 0.0;
}

/* A time of the sweep, as one of the vertices' motion. */
static double vertex_time(const struct rigid_sweep *sweep, double time)
{
    return sweep->tick_from + time * (1.0 - sweep->tick_from);
}

/* A piece of the motion: from one waypoint to another, as a straight motion with a deviation. */
struct piece {
    const struct waypoint *from, *to;
    struct deviation deviation;
    struct sweep sweep;
    struct surface_times times;
};

/* Returns the straight motion. added: to the radius, m */
static struct motion begin_piece(const struct rigid_sweep *sweep, struct piece *piece, double added)
{
    const struct ends *from = &piece->from->ends, *to = &piece->to->ends;
    const struct motion motion = { from->a, from->b, sub(to->a, from->a), sub(to->b, from->b) };
    dpti_sweep_begin(&piece->sweep, &motion, sweep->radius + added, sweep->tolerance,
                     dpti_surface_extent(sweep->surface));
    piece->sweep.directions = sweep->directions;
    piece->sweep.direction_count = sweep->direction_count;
    piece->sweep.surface_speed = (piece->to->time - piece->from->time) * surface_motion_max(sweep);
    piece->times = (struct surface_times){ sweep->tick, vertex_time(sweep, piece->from->time),
                                           vertex_time(sweep, piece->to->time) };
    return motion;
}

/* beside: how far the axis may be from its straight motion, m */
static struct mesh_sweep search_of(const struct rigid_sweep *sweep, const struct piece *piece, double beside)
{
    const double distance = sweep->distance_before - beside;
    return (struct mesh_sweep){ .surface = sweep->surface,
                                .kernel = sweep->kernel,
                                .sweep = &piece->sweep,
                                .times = &piece->times,
                                .from = piece->from->time > 0.0 ? 0.0 : dpti_sweep_start(&piece->sweep, distance),
                                .work = sweep->work,
                                .progress = &sweep->progress->sweep };
}

static int sweep_straight(struct rigid_sweep *sweep, struct piece *piece)
{
    struct rigid_sweep_result *result = &sweep->result;
    result->motion = begin_piece(sweep, piece, max_deviation(piece->deviation));
    struct mesh_sweep search = search_of(sweep, piece, 0.0);
    int status = dpti_sweep_mesh(&search, sweep->hint, &result->impact);
    result->from = piece->from->time;
    result->time = piece->from->time + result->impact.time * (piece->to->time - piece->from->time);
    return status;
}

/*
 * Whether a piece that still deviates much may touch the surface, grown by the deviation. `halvings` made the piece. A
 * piece that began before free_until was tested before its first half was.
 */
static int test_piece(struct rigid_sweep *sweep, struct piece *piece, uint32_t halvings)
{
    struct rigid_sweep_progress *progress = sweep->progress;
    if (piece->from->time < progress->free_until || halvings < progress->tested)
        return SWEEP_HIT;
    uint32_t leaf = progress->leaves - 1;
    begin_piece(sweep, piece, 0.0);
    piece->sweep.reach[0] = piece->deviation.a;
    piece->sweep.reach[1] = piece->deviation.b;
    struct mesh_sweep search = search_of(sweep, piece, max_deviation(piece->deviation));
    int status = dpti_sweep_may_touch(&search, &leaf);
    if (status == SWEEP_HIT) {
        progress->tested = halvings + 1;
        progress->leaves = leaf + 1;
    }
    return status;
}

/* m: a piece that is no longer touches a few triangles, where they are as large as on a square. */
static double piece_length_max(const struct surface *surface)
{
    return PIECE_TRIANGLES / (surface->filter_scale * sqrt((double)surface_triangles(surface)));
}

/*
 * After a test of the piece: whether the leaf that it may touch is as long as the piece, as where slivers stand side by
 * side. Then shorter pieces would touch as many triangles.
 */
static int touches_long_leaf(const struct rigid_sweep *sweep, double length, uint32_t halvings)
{
    const struct rigid_sweep_progress *progress = sweep->progress;
    if (progress->tested != halvings + 1 || !progress->leaves)
        return 0;
    return length <= dpti_surface_leaf_length(sweep->surface, progress->leaves - 1);
}

/* Sweep the motion between two waypoints. Times before progress->free_until are not swept again. */
static int sweep_between(struct rigid_sweep *sweep, const struct waypoint *from, const struct waypoint *to,
                         uint32_t halvings)
{
    struct rigid_sweep_progress *progress = sweep->progress;
    if (to->time <= progress->free_until)
        return SWEEP_FREE;
    const struct placement middle_placement = middle_of(from->placement, to->placement);
    const struct waypoint middle = waypoint_of(&middle_placement, 0.5 * (from->time + to->time));
    struct piece piece = { .from = from, .to = to, .deviation = deviation_between(from, &middle, to) };
    const int turns_little = body_turn_cosine(from->placement, to->placement) >= HALF_TURN_COSINE_MIN;
    const int deviates_little = turns_little && max_deviation(piece.deviation) <= 0.5 * sweep->tolerance;
    const double length = max_length(sub(to->ends.a, from->ends.a), sub(to->ends.b, from->ends.b));
    int is_straight = halvings == HALVINGS_MAX || (deviates_little && length <= piece_length_max(sweep->surface));
    int status = SWEEP_HIT;
    if (turns_little && !is_straight) {
        status = test_piece(sweep, &piece, halvings);
        is_straight = status == SWEEP_HIT && deviates_little && touches_long_leaf(sweep, length, halvings);
        if (is_straight && work_is_spent(sweep->work))
            return SWEEP_UNFINISHED;
    }
    if (is_straight)
        status = sweep_straight(sweep, &piece);
    if (status == SWEEP_FREE) {
        progress->free_until = to->time;
        progress->tested = 0;
    }
    if (status != SWEEP_HIT || is_straight)
        return status;
    if (work_is_spent(sweep->work))
        return SWEEP_UNFINISHED;
    status = sweep_between(sweep, from, &middle, halvings + 1);
    if (status != SWEEP_FREE)
        return status;
    if (work_is_spent(sweep->work))
        return SWEEP_UNFINISHED;
    return sweep_between(sweep, &middle, to, halvings + 1);
}

int dpti_rigid_sweep_find(struct rigid_sweep *sweep, const struct placement *from, const struct placement *to)
{
    const struct waypoint first = waypoint_of(from, 0.0), last = waypoint_of(to, 1.0);
    sweep->result.time = sweep->progress->free_until;
    return sweep_between(sweep, &first, &last, 0);
}

int dpti_rigid_sweep_cannot_meet(const struct rigid_sweep *sweep, const struct placement *from,
                                 const struct placement *to, double distance_after)
{
    const struct placement middle_placement = middle_of(from, to);
    const struct waypoint first = waypoint_of(from, 0.0), last = waypoint_of(to, 1.0);
    const struct waypoint middle = waypoint_of(&middle_placement, 0.5);
    double motion =
        max_length(sub(last.ends.a, first.ends.a), sub(last.ends.b, first.ends.b)) + surface_motion_max(sweep);
    double deviation = max_deviation(deviation_between(&first, &middle, &last));
    if (motion == 0.0 && deviation == 0.0)
        return 1;
    return body_turn_cosine(from, to) >= HALF_TURN_COSINE_MIN &&
           sweep->distance_before + distance_after >
               motion + 2.0 * (deviation + sweep->radius + 2.0 * sweep->tolerance);
}

int dpti_rigid_sweep_side_before(const struct rigid_sweep *sweep)
{
    const struct impact *impact = &sweep->result.impact;
    const struct motion *motion = &sweep->result.motion;
    const struct surface then = surface_view(sweep->surface, sweep->tick, vertex_time(sweep, sweep->result.time));
    const struct surface first = surface_view(sweep->surface, sweep->tick, vertex_time(sweep, sweep->result.from));
    vec3 displacement = along(motion->da, impact->pair.s, sub(motion->db, motion->da));
    vec3 back = along(impact->pair.gap, -impact->time, displacement);
    /* As seen from the point of the surface, which moves too. */
    if (sweep->tick)
        back = add(back, sub(surface_point(&then, impact->triangle, impact->pair.weight),
                             surface_point(&first, impact->triangle, impact->pair.weight)));
    return dpti_side_of_arrival(&then, impact->triangle, impact->pair.weight, back);
}

int dpti_rigid_sweep_began_touching(const struct rigid_sweep *sweep)
{
    return sweep->result.time == 0.0 && sweep->distance_before == 0.0;
}

double dpti_rigid_sweep_displacement(const struct placement *from, const struct placement *to)
{
    const dpt_pose middle_pose = pose_middle(&from->tool, &to->tool);
    const struct placement middle = { .tool = middle_pose,
                                      .a = scaled(add(from->a, to->a), 0.5),
                                      .b = scaled(add(from->b, to->b), 0.5) };
    struct ends at_first = tool_ends(from), at_last = tool_ends(to), at_middle = tool_ends(&middle);
    return max_length(sub(at_last.a, at_first.a), sub(at_last.b, at_first.b)) +
           max_deviation(deviation_of(&at_first, &at_middle, &at_last));
}

dpt_pose dpti_rigid_sweep_pose(const dpt_pose *from, const dpt_pose *to, double time)
{
    dpt_pose low = *from, high = *to, pose;
    double t0 = 0.0, t1 = 1.0, cosine = 0.0, square = 0.0;
    if (time <= 0.0 || time >= 1.0)
        return time <= 0.0 ? *from : *to;
    for (int k = 0; k < HALVINGS_MAX; k++) {
        const double middle_time = 0.5 * (t0 + t1);
        const dpt_pose middle = pose_middle(&low, &high);
        *(time < middle_time ? &t1 : &t0) = middle_time;
        *(time < middle_time ? &high : &low) = middle;
    }
    const double part = (time - t0) / (t1 - t0);
    for (int k = 0; k < 3; k++)
        pose.position[k] = low.position[k] + part * (high.position[k] - low.position[k]);
    for (int k = 0; k < 4; k++)
        cosine += low.orientation[k] * high.orientation[k];
    for (int k = 0; k < 4; k++) {
        const double end = (cosine < 0.0 ? -1.0 : 1.0) * high.orientation[k];
        pose.orientation[k] = low.orientation[k] + part * (end - low.orientation[k]);
        square += pose.orientation[k] * pose.orientation[k];
    }
    for (int k = 0; k < 4; k++)
        pose.orientation[k] /= sqrt(square);
    return pose;
}
