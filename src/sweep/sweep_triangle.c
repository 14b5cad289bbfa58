/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * One moving axis and one triangle (docs/algorithms/sweep.md). Time advances from one separating plane to the next: a
 * division tells when the first end of the axis reaches the plane, and until then the motion is free. If an end that
 * never comes near the triangle would reach the plane soon, the axis is cut in two.
 */
#include "sweep/sweep_triangle.h"

/* A piece of the axis, from one s to another, and the time before which it is free. */
struct motion_piece {
    double from, to;
    double time;
};

/* The ends of a piece at its time, and their velocities per tick. */
struct moving_piece {
    vec3 a, b, va, vb;
};

/* The triangle's own plane: low <= normal.v <= high for all its points v. is_valid: 0 if it is too thin to have one. */
struct face {
    vec3 normal;
    double low, high;
    int is_valid;
};

void dpti_sweep_begin(struct sweep *sweep, const struct motion *motion, double radius,
                      double tolerance, double extent)
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
    double fastest = sqrt(max_of(dot(sweep->da, sweep->da), dot(db, db)));
    double clearance = distance - sweep->no_hit_limit;
    return clearance > 0.0 ? min_of(clearance / fastest, 1.0) : 0.0;
}

static struct moving_piece moving_piece_of(const struct sweep *sweep,
                                           const struct motion_piece *piece)
{
    vec3 a, u;
    dpti_sweep_axis(sweep, piece->time, &a, &u);
    return (struct moving_piece){ along(a, piece->from, u), along(a, piece->to, u),
                                  along(sweep->da, piece->from, sweep->du),
                                  along(sweep->da, piece->to, sweep->du) };
}

/* Rounding in a thin triangle's normal makes the plane less useful, not wrong: low and high belong to that normal. */
static struct face face_of(const vec3 corner[3])
{
    const vec3 edge[3] = { sub(corner[1], corner[0]), sub(corner[2], corner[1]),
                           sub(corner[0], corner[2]) };
    triangle_frame frame;
    struct face face = { .is_valid = triangle_frame_set(edge, &frame) };
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
 * whole triangle must be on or behind the plane. All points of the piece lie between its ends, so the piece is free for
 * as long.
 */
static double plane_duration(const struct moving_piece *moving, vec3 normal, double support,
                             double free_limit)
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

static double face_duration(const struct moving_piece *moving, const struct face *face,
                            double free_limit)
{
    if (!face->is_valid)
        return 0.0;
    return max_of(plane_duration(moving, face->normal, face->high, free_limit),
                  plane_duration(moving, scaled(face->normal, -1.0), -face->low, free_limit));
}

/*
 * Set `piece` to the part of the axis that can come near the triangle, and return 0 if there is none. Parts that stay
 * before or behind the triangle, along the axis' direction at time 1/2, are left out: a far end moves fast when the
 * tool turns, and would end every step early.
 */
static int trim(const struct sweep *sweep, const vec3 corner[3], struct motion_piece *piece)
{
    vec3 x = sweep->middle_direction;
    vec3 a_end = add(sweep->a, sweep->da), u_end = add(sweep->u, sweep->du);
    double c0 = dot(x, corner[0]), c1 = dot(x, corner[1]), c2 = dot(x, corner[2]);
    double margin = 2.0 * sweep->free_limit - sweep->radius;
    double min_along = min_of(c0, min_of(c1, c2)) - margin;
    double max_along = max_of(c0, max_of(c1, c2)) + margin;
    double u_along = dot(x, sweep->u), u_along_end = dot(x, u_end);
    *piece = (struct motion_piece){ 0.0, 1.0, 0.0 };
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

/*
 * Advance the piece's time as far as planes allow, and at least as long as the faster end takes for the distance.
 * Returns 1 if the piece should be cut: its ends reach the plane of the nearest pair much sooner than the pair's own
 * point would. Either they are faster, or rounding tilts the plane, and more so the longer the piece is.
 */
static int advance(const struct sweep *sweep, const vec3 corner[3], const struct face *face,
                   const struct moving_piece *moving, const pair *found, struct motion_piece *piece)
{
    double clearance = sqrt(found->distance2) - sweep->free_limit;
    vec3 normal = direction_of(moving, corner, found);
    double support =
        max_of(dot(normal, corner[0]), max_of(dot(normal, corner[1]), dot(normal, corner[2])));
    double end_height =
        min_of(dot(normal, moving->a), dot(normal, moving->b)) - support - sweep->free_limit;
    double approach_a = -dot(normal, moving->va), approach_b = -dot(normal, moving->vb);
    double approach = approach_a + found->s * (approach_b - approach_a);
    double time_left = 1.0 - piece->time;
    double duration =
        clearance / sqrt(max_of(dot(moving->va, moving->va), dot(moving->vb, moving->vb)));
    duration = max_of(duration, plane_duration(moving, normal, support, sweep->free_limit));
    duration = max_of(duration, face_duration(moving, face, sweep->free_limit));
    piece->time += duration;
    return 4.0 * duration < time_left && 2.0 * duration * approach < clearance &&
           (fabs(approach_b - approach_a) * time_left > sweep->hit_limit - sweep->free_limit ||
            2.0 * end_height < clearance);
}

int dpti_sweep_triangle(const struct sweep *sweep, const vec3 corner[3], double until, double *time,
                        uint32_t *evaluations)
{
    enum { PIECES_MAX = 64 };
    struct motion_piece pieces[PIECES_MAX];
    const struct face face = face_of(corner);
    int count = trim(sweep, corner, pieces), result = SWEEP_FREE;
    while (count) {
        struct motion_piece *piece = &pieces[count - 1];
        if (piece->time > until) {
            count--;
            continue;
        }
        ++*evaluations;
        struct moving_piece moving = moving_piece_of(sweep, piece);
        pair found =
            segment_triangle(moving.a, sub(moving.b, moving.a), corner[0], corner[1], corner[2]);
        if (!(found.distance2 > sweep->hit_limit * sweep->hit_limit)) {
            until = piece->time;
            result = SWEEP_HIT;
            count--;
        } else if (advance(sweep, corner, &face, &moving, &found, piece) && count < PIECES_MAX) {
            pieces[count] = *piece;
            piece->from = pieces[count].to = 0.5 * (piece->from + piece->to);
            count++;
        }
    }
    *time = until;
    return result;
}
