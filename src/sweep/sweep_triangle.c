/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * One moving axis and one triangle (docs/algorithms/sweep.md). Time advances from one separating plane to the next:
 * divisions tell when the first end of the axis meets the first corner in the plane's direction, and until then the
 * motion is free. If an end that never comes near the triangle would end this soon, the axis is cut in two. If a corner
 * that never comes near the axis would, the triangle is cut.
 */
#include "sweep/sweep_triangle.h"

#include <string.h>

/* A piece of the axis, from one s to another, a piece of the triangle, and the time before which they are free. */
struct motion_piece {
    double from, to;
    double time;
    double weight[3][3]; /* of the piece's corners, by the triangle's */
};

/* The ends of a piece at its time, and their velocities per tick; likewise the corners of the triangle's piece. */
struct moving_piece {
    vec3 a, b, va, vb;
    vec3 corner[3], shift[3];
    int is_moving;
};

/* The triangle's own plane: low <= normal.v <= high for all its points v. is_valid: 0 if it is too thin to have one. */
struct face {
    vec3 normal;
    double low, high;
    int is_known, is_valid;
};

void dpti_sweep_begin(struct sweep *sweep, const struct motion *motion, double radius, double tolerance, double extent)
{
    const double unit = 0x1p-53;
    extent = max_of(extent, max_of(extent_of(motion->a), extent_of(motion->b)));
    extent = max_of(extent, extent_of(add(motion->a, motion->da)));
    extent = max_of(extent, extent_of(add(motion->b, motion->db)));
    tolerance = max_of(tolerance, 2048.0 * unit * (extent + radius));
    sweep->a = motion->a;
    sweep->u = sub(motion->b, motion->a);
    sweep->da = motion->da;
    sweep->du = sub(motion->db, motion->da);
    sweep->radius = radius;
    sweep->hit_limit = radius + 0.5 * tolerance;
    sweep->free_limit = radius + 128.0 * unit * (extent + radius);
    sweep->no_hit_limit = radius + tolerance;
    sweep->reach[0] = sweep->reach[1] = 0.0;
    sweep->surface_speed = 0.0;
    sweep->directions = NULL;
    sweep->direction_count = 0;
    vec3 middle = along(sweep->u, 0.5, sweep->du);
    double size = length(middle);
    sweep->middle_direction = size > 1e-120 ? scaled(middle, 1.0 / size) : (vec3){ 0.0, 0.0, 0.0 };
}

void dpti_sweep_axis(const struct sweep *sweep, double time, vec3 *a, vec3 *u)
{
    *a = along(sweep->a, time, sweep->da);
    *u = along(sweep->u, time, sweep->du);
}

double dpti_sweep_start(const struct sweep *sweep, double distance)
{
    vec3 db = add(sweep->da, sweep->du);
    double fastest = sqrt(max_of(dot(sweep->da, sweep->da), dot(db, db))) + sweep->surface_speed;
    double clearance = distance - sweep->no_hit_limit;
    return clearance > 0.0 ? min_of(clearance / fastest, 1.0) : 0.0;
}

void dpti_moving_triangle_at(const struct moving_triangle *triangle, double time, vec3 corner[3])
{
    for (int k = 0; k < 3; k++)
        corner[k] = triangle->is_moving ? along(triangle->corner[k], time, triangle->shift[k]) : triangle->corner[k];
}

/* The sum of the three, weighted. A weight of 1 gives its corner bit for bit. */
static vec3 weighted(const double weight[3], const vec3 of[3])
{
    for (int k = 0; k < 3; k++)
        if (weight[k] == 1.0)
            return of[k];
    return along(along(scaled(of[0], weight[0]), weight[1], of[1]), weight[2], of[2]);
}

static void moving_piece_of(const struct sweep *sweep, const struct moving_triangle *triangle,
                            const struct motion_piece *piece, struct moving_piece *moving)
{
    vec3 a, u;
    dpti_sweep_axis(sweep, piece->time, &a, &u);
    moving->a = along(a, piece->from, u);
    moving->b = along(a, piece->to, u);
    moving->va = along(sweep->da, piece->from, sweep->du);
    moving->vb = along(sweep->da, piece->to, sweep->du);
    moving->is_moving = triangle->is_moving;
    if (!triangle->is_moving)
        return;
    vec3 corner[3];
    dpti_moving_triangle_at(triangle, piece->time, corner);
    for (int k = 0; k < 3; k++) {
        moving->corner[k] = weighted(piece->weight[k], corner);
        moving->shift[k] = weighted(piece->weight[k], triangle->shift);
    }
}

/* Rounding in a thin triangle's normal makes the plane less useful, not wrong: low and high belong to that normal. */
static struct face face_of(const vec3 corner[3])
{
    const vec3 edge[3] = { sub(corner[1], corner[0]), sub(corner[2], corner[1]), sub(corner[0], corner[2]) };
    triangle_frame frame;
    struct face face = { .is_known = 1, .is_valid = triangle_frame_set(edge, &frame) };
    if (!face.is_valid)
        return face;
    face.normal = scaled(frame.z, 1.0 / length(frame.z));
    double c0 = dot(face.normal, corner[0]), c1 = dot(face.normal, corner[1]);
    double c2 = dot(face.normal, corner[2]);
    face.low = min_of(c0, min_of(c1, c2));
    face.high = max_of(c0, max_of(c1, c2));
    return face;
}

/*
 * How long both ends stay in front of the plane normal.x = support by more than free_limit; 0 if they are not now. The
 * whole triangle must be on or behind the plane, and at rest. All points of the piece lie between its ends, so the
 * piece is free for as long.
 */
static double plane_duration(const struct moving_piece *moving, vec3 normal, double support, double free_limit)
{
    double a = dot(normal, moving->a) - support - free_limit;
    double b = dot(normal, moving->b) - support - free_limit;
    double approach_a = -dot(normal, moving->va), approach_b = -dot(normal, moving->vb);
    double duration = HUGE_VAL;
    if (!(a > 0.0 && b > 0.0))
        return 0.0;
    if (approach_a > 0.0)
        duration = a / approach_a;
    if (approach_b > 0.0)
        duration = min_of(duration, b / approach_b);
    return duration;
}

/* The same of a triangle that moves: how long each end stays in front of each corner, along the normal. */
static double corners_duration(const struct moving_piece *moving, vec3 normal, double free_limit)
{
    const double end[2] = { dot(normal, moving->a) - free_limit, dot(normal, moving->b) - free_limit };
    const double rise[2] = { dot(normal, moving->va), dot(normal, moving->vb) };
    double duration = HUGE_VAL;
    for (int k = 0; k < 3; k++) {
        const double height = dot(normal, moving->corner[k]);
        const double speed = dot(normal, moving->shift[k]);
        for (int e = 0; e < 2; e++) {
            if (!(end[e] > height))
                return 0.0;
            if (speed > rise[e])
                duration = min_of(duration, (end[e] - height) / (speed - rise[e]));
        }
    }
    return duration;
}

static double face_duration(const struct moving_piece *moving, const struct face *face, double free_limit)
{
    if (!face->is_valid)
        return 0.0;
    if (moving->is_moving)
        return max_of(corners_duration(moving, face->normal, free_limit),
                      corners_duration(moving, scaled(face->normal, -1.0), free_limit));
    return max_of(plane_duration(moving, face->normal, face->high, free_limit),
                  plane_duration(moving, scaled(face->normal, -1.0), -face->low, free_limit));
}

/*
 * Set `piece` to the part of the axis that can come near the triangle, and return 0 if there is none. Parts that stay
 * before or behind the triangle, along the axis' direction at time 1/2, are left out: a far end moves fast when the
 * tool turns, and would end every step early.
 */
static int trim(const struct sweep *sweep, const struct moving_triangle *triangle, struct motion_piece *piece)
{
    vec3 x = sweep->middle_direction;
    vec3 a_end = add(sweep->a, sweep->da), u_end = add(sweep->u, sweep->du);
    double margin = 2.0 * sweep->free_limit - sweep->radius + max_of(sweep->reach[0], sweep->reach[1]);
    double min_along = HUGE_VAL, max_along = -HUGE_VAL;
    for (int k = 0; k < 3; k++) {
        const double from = dot(x, triangle->corner[k]);
        const double to = triangle->is_moving ? from + dot(x, triangle->shift[k]) : from;
        min_along = min_of(min_along, min_of(from, to));
        max_along = max_of(max_along, max_of(from, to));
    }
    min_along -= margin;
    max_along += margin;
    double u_along = dot(x, sweep->u), u_along_end = dot(x, u_end);
    *piece = (struct motion_piece){ .to = 1.0, .weight = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } } };
    if (!(u_along > 0.0 && u_along_end > 0.0))
        return 1;
    double a_along = dot(x, sweep->a), a_along_end = dot(x, a_end);
    double from = min_of((min_along - a_along) / u_along, (min_along - a_along_end) / u_along_end);
    double to = max_of((max_along - a_along) / u_along, (max_along - a_along_end) / u_along_end);
    if (from > 1.0 || to < 0.0 || from > to)
        return 0;
    piece->from = max_of(from, 0.0);
    piece->to = min_of(to, 1.0);
    return 1;
}

/* v without its component along u; v itself if u is 0. */
static vec3 across(vec3 v, vec3 u)
{
    double uu = dot(u, u);
    return uu > 0.0 ? along(v, -dot(v, u) / uu, u) : v;
}

/*
 * The unit direction from the triangle to the axis. Rounding tilts a short gap vector; over the length of the axis or
 * of an edge the tilt may be more than the gap. If the pair lies inside the axis or inside an edge, the direction is
 * made orthogonal to it.
 */
static vec3 direction_of(const struct moving_piece *moving, const vec3 corner[3], const pair *found)
{
    const double *w = found->weight;
    vec3 u = sub(moving->b, moving->a), e = { 0.0, 0.0, 0.0 }, n = found->gap;
    if (!(found->s > 0.0 && found->s < 1.0))
        u = e;
    for (int k = 0; k < 3; k++)
        if (w[k] == 0.0 && w[(k + 1) % 3] > 0.0 && w[(k + 2) % 3] > 0.0)
            e = sub(corner[(k + 2) % 3], corner[(k + 1) % 3]);
    vec3 edge_across = across(across(e, u), u);
    if (!(dot(edge_across, edge_across) > 0x1p-80 * dot(e, e)))
        edge_across = (vec3){ 0.0, 0.0, 0.0 };
    for (int k = 0; k < 2; k++)
        n = across(across(n, edge_across), u);
    double size = length(n), distance = sqrt(found->distance2);
    return size > 0.5 * distance ? scaled(n, 1.0 / size) : scaled(found->gap, 1.0 / distance);
}

/* m per tick: how fast a point of the axis' piece and one of the triangle's come nearer at most. */
static double max_approach(const struct moving_piece *moving)
{
    double square = max_of(dot(moving->va, moving->va), dot(moving->vb, moving->vb));
    if (!moving->is_moving)
        return sqrt(square);
    square = 0.0;
    for (int k = 0; k < 3; k++) {
        const vec3 a = sub(moving->va, moving->shift[k]), b = sub(moving->vb, moving->shift[k]);
        square = max_of(square, max_of(dot(a, a), dot(b, b)));
    }
    return sqrt(square);
}

/* What to do with a piece after its time has advanced: nothing, or cut it in two, the triangle between two corners. */
enum cut_kind { CUT_NONE, CUT_AXIS, CUT_TRIANGLE };

struct cut {
    enum cut_kind what;
    int fast, slow; /* the corners */
};

/* The corner whose velocity along the normal is greatest and the one with the least; how far these are apart. */
static double spread_of_corners(const struct moving_piece *moving, vec3 normal, struct cut *cut)
{
    double speed[3];
    int fast = 0, slow = 0;
    for (int k = 0; k < 3; k++)
        speed[k] = moving->is_moving ? dot(normal, moving->shift[k]) : 0.0;
    for (int k = 1; k < 3; k++) {
        fast = speed[k] > speed[fast] ? k : fast;
        slow = speed[k] < speed[slow] ? k : slow;
    }
    cut->fast = fast;
    cut->slow = slow;
    return speed[fast] - speed[slow];
}

/* The velocity of the triangle's point of a pair. */
static vec3 shift_of_pair(const struct moving_piece *moving, const pair *found)
{
    return moving->is_moving ? weighted(found->weight, moving->shift) : (vec3){ 0.0, 0.0, 0.0 };
}

/*
 * Advance the piece's time as far as planes allow, and at least as long as the fastest points take for the distance.
 * Returns what should be cut: the plane of the nearest pair is met much sooner than by the pair's own points. Either
 * other points are faster, or rounding tilts the plane, and more so the longer the piece is.
 */
static struct cut advance(const struct sweep *sweep, const vec3 corner[3], struct face *face,
                          const struct moving_piece *moving, const pair *found, struct motion_piece *piece)
{
    struct cut cut = { .what = CUT_NONE };
    double clearance = sqrt(found->distance2) - sweep->free_limit;
    double time_left = 1.0 - piece->time;
    double duration = clearance / max_approach(moving);
    if (duration > time_left) {
        piece->time += duration;
        return cut;
    }
    vec3 normal = direction_of(moving, corner, found);
    double support = max_of(dot(normal, corner[0]), max_of(dot(normal, corner[1]), dot(normal, corner[2])));
    double end_height = min_of(dot(normal, moving->a), dot(normal, moving->b)) - support - sweep->free_limit;
    double approach_a = -dot(normal, moving->va), approach_b = -dot(normal, moving->vb);
    double approach = approach_a + found->s * (approach_b - approach_a) + dot(normal, shift_of_pair(moving, found));
    duration = max_of(duration, moving->is_moving ? corners_duration(moving, normal, sweep->free_limit)
                                                  : plane_duration(moving, normal, support, sweep->free_limit));
    if (!(duration > time_left)) {
        if (moving->is_moving || !face->is_known)
            *face = face_of(corner);
        duration = max_of(duration, face_duration(moving, face, sweep->free_limit));
    }
    piece->time += duration;
    if (!(4.0 * duration < time_left && 2.0 * duration * approach < clearance))
        return cut;
    const double thickness = sweep->hit_limit - sweep->free_limit;
    const double axis_spread = fabs(approach_b - approach_a);
    const double corner_spread = spread_of_corners(moving, normal, &cut);
    if (corner_spread > axis_spread && corner_spread * time_left > thickness)
        cut.what = CUT_TRIANGLE;
    else if (axis_spread * time_left > thickness || 2.0 * end_height < clearance)
        cut.what = CUT_AXIS;
    return cut;
}

/* Cut a piece in two: `piece` keeps the part that is looked at later, `other` gets the rest. */
static void cut_axis(struct motion_piece *piece, struct motion_piece *other)
{
    *other = *piece;
    piece->from = other->to = 0.5 * (piece->from + piece->to);
}

static void cut_triangle(struct motion_piece *piece, const struct cut *cut, struct motion_piece *other)
{
    double *fast = piece->weight[cut->fast], *slow = piece->weight[cut->slow];
    double middle[3];
    for (int k = 0; k < 3; k++)
        middle[k] = 0.5 * (fast[k] + slow[k]);
    *other = *piece;
    memcpy(fast, middle, sizeof middle);
    memcpy(other->weight[cut->slow], middle, sizeof middle);
}

int dpti_sweep_triangle(const struct sweep *sweep, const struct moving_triangle *triangle, double until, double *time,
                        uint32_t *evaluations)
{
    enum { PIECES_MAX = 64 };
    struct motion_piece pieces[PIECES_MAX];
    struct moving_piece moving;
    struct face face = { .is_known = 0 };
    const vec3 *corner = triangle->is_moving ? moving.corner : triangle->corner;
    int count = trim(sweep, triangle, pieces), result = SWEEP_FREE;
    while (count) {
        struct motion_piece *piece = &pieces[count - 1];
        if (piece->time > until) {
            count--;
            continue;
        }
        ++*evaluations;
        moving_piece_of(sweep, triangle, piece, &moving);
        pair found = segment_triangle(moving.a, sub(moving.b, moving.a), corner[0], corner[1], corner[2]);
        if (!(found.distance2 > sweep->hit_limit * sweep->hit_limit)) {
            until = piece->time;
            result = SWEEP_HIT;
            count--;
            continue;
        }
        const struct cut cut = advance(sweep, corner, &face, &moving, &found, piece);
        if (cut.what == CUT_NONE || count == PIECES_MAX)
            continue;
        if (cut.what == CUT_AXIS)
            cut_axis(piece, &pieces[count]);
        else
            cut_triangle(piece, &cut, &pieces[count]);
        count++;
    }
    *time = until;
    return result;
}

/* m: farther than this from the line of the axis, at the place s, nothing is touched. */
static double limit_at(const struct sweep *sweep, double s)
{
    return sweep->free_limit + sweep->reach[0] + s * (sweep->reach[1] - sweep->reach[0]);
}

/*
 * Whether the ends of a piece, as it is at time 1/2, stay in front of the triangle from time 0 to 1, each by its limit:
 * in the direction of the pair that is nearest then.
 */
static int stays_in_front(const struct moving_piece *moving, const vec3 corner[3], const pair *found, double limit_a,
                          double limit_b)
{
    const vec3 normal = direction_of(moving, corner, found);
    const double height_a = dot(normal, moving->a) - limit_a, rise_a = dot(normal, moving->va);
    const double height_b = dot(normal, moving->b) - limit_b, rise_b = dot(normal, moving->vb);
    for (int k = 0; k < 3; k++) {
        const double height = dot(normal, corner[k]);
        const double rise = moving->is_moving ? dot(normal, moving->shift[k]) : 0.0;
        if (!(height_a - height > 0.5 * fabs(rise_a - rise) && height_b - height > 0.5 * fabs(rise_b - rise)))
            return 0;
    }
    return 1;
}

int dpti_sweep_may_touch_triangle(const struct sweep *sweep, const struct moving_triangle *triangle)
{
    enum { PAIRS_MAX = 4 };
    struct motion_piece pieces[PAIRS_MAX + 1];
    struct moving_piece moving;
    const vec3 *corner = triangle->is_moving ? moving.corner : triangle->corner;
    int count = trim(sweep, triangle, pieces);
    pieces[0].time = 0.5;
    for (int pairs = 0; count; pairs++) {
        struct motion_piece *piece = &pieces[count - 1];
        if (pairs == PAIRS_MAX)
            return 1;
        moving_piece_of(sweep, triangle, piece, &moving);
        const vec3 u = sub(moving.b, moving.a);
        const pair found = segment_triangle(moving.a, u, corner[0], corner[1], corner[2]);
        const double limit = limit_at(sweep, piece->from + found.s * (piece->to - piece->from));
        if (!(found.distance2 > limit * limit))
            return 1;
        if (stays_in_front(&moving, corner, &found, limit_at(sweep, piece->from), limit_at(sweep, piece->to))) {
            count--;
            continue;
        }
        cut_axis(piece, &pieces[count++]);
    }
    return 0;
}
