/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * One axis in motion, one triangle: from plane to plane through time (docs/algorithms/sweep.md). A
 * plane that lies between them is passed by an end of the axis at a time that is a quotient, and
 * until then the motion is free. Where an end that has nothing to do with the triangle makes that
 * soon, the axis is cut in two.
 */
#include "sweep/sweep_triangle.h"

/* Of the axis, from one s to another: free before `time`. */
struct motion_piece {
    double from, to;
    double time;
};

/* A piece at its time, and the velocities of its ends. */
struct stretch {
    vec3 a, b, va, vb;
};

/* The triangle's own plane, where it has one: low <= normal.v <= high for all of it. */
struct face {
    vec3 normal;
    double low, high;
    int is;
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
    sweep->touch = radius + 0.5 * tolerance;
    sweep->clear = radius + 128.0 * unit * (extent + radius);
    sweep->beyond = radius + tolerance;
    vec3 middle = along(sweep->u, 0.5, sweep->du);
    double size = length(middle);
    sweep->middle = size > 1e-120 ? scaled(middle, 1.0 / size) : (vec3){ 0.0, 0.0, 0.0 };
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
    double room = distance - sweep->beyond;
    return room > 0.0 ? min_of(room / fastest, 1.0) : 0.0;
}

static struct stretch stretch_of(const struct sweep *sweep, const struct motion_piece *piece)
{
    vec3 a, u;
    dpti_sweep_axis(sweep, piece->time, &a, &u);
    return (struct stretch){ along(a, piece->from, u), along(a, piece->to, u),
                             along(sweep->da, piece->from, sweep->du),
                             along(sweep->da, piece->to, sweep->du) };
}

/*
 * Rounding in a thin triangle's normal costs use, not truth: low and high are those of this normal.
 */
static struct face face_of(const vec3 corner[3])
{
    const vec3 edge[3] = { sub(corner[1], corner[0]), sub(corner[2], corner[1]),
                           sub(corner[0], corner[2]) };
    flat f;
    struct face face = { .is = flatten(edge, &f) };
    if (!face.is)
        return face;
    face.normal = scaled(f.z, 1.0 / length(f.z));
    double c0 = dot(face.normal, corner[0]), c1 = dot(face.normal, corner[1]);
    double c2 = dot(face.normal, corner[2]);
    face.low = min_of(c0, min_of(c1, c2));
    face.high = max_of(c0, max_of(c1, c2));
    return face;
}

/*
 * How long both ends stay farther than `clear` beyond normal.x = support, where all of the triangle
 * is at or below it: all of the piece is between its ends, and so it is free for as long. 0 where
 * they are not beyond it.
 */
static double plane_lasts(const struct stretch *s, vec3 normal, double support, double clear)
{
    double a = dot(normal, s->a) - support - clear, b = dot(normal, s->b) - support - clear;
    double fall_a = -dot(normal, s->va), fall_b = -dot(normal, s->vb);
    double lasts = HUGE_VAL;
    if (!(a > 0.0 && b > 0.0))
        return 0.0;
    if (fall_a > 0.0)
        lasts = a / fall_a;
    if (fall_b > 0.0)
        lasts = min_of(lasts, b / fall_b);
    return lasts;
}

static double face_lasts(const struct stretch *s, const struct face *face, double clear)
{
    if (!face->is)
        return 0.0;
    return max_of(plane_lasts(s, face->normal, face->high, clear),
                  plane_lasts(s, scaled(face->normal, -1.0), -face->low, clear));
}

/*
 * The piece of the axis that can come near at all: what stays before or behind the triangle, along
 * the axis half way, is left out. A far end moves fast when the tool turns; it must not count. 0
 * when nothing is left.
 */
static int trim(const struct sweep *sweep, const vec3 corner[3], struct motion_piece *piece)
{
    vec3 x = sweep->middle, end = add(sweep->a, sweep->da), along_end = add(sweep->u, sweep->du);
    double c0 = dot(x, corner[0]), c1 = dot(x, corner[1]), c2 = dot(x, corner[2]);
    double margin = 2.0 * sweep->clear - sweep->radius;
    double low = min_of(c0, min_of(c1, c2)) - margin, high = max_of(c0, max_of(c1, c2)) + margin;
    double grows = dot(x, sweep->u), grows_end = dot(x, along_end);
    *piece = (struct motion_piece){ 0.0, 1.0, 0.0 };
    if (!(grows > 0.0 && grows_end > 0.0))
        return 1;
    double at = dot(x, sweep->a), at_end = dot(x, end);
    double from = min_of((low - at) / grows, (low - at_end) / grows_end);
    double to = max_of((high - at) / grows, (high - at_end) / grows_end);
    if (from > 1.0 || to < 0.0 || from > to)
        return 0;
    piece->from = max_of(from, 0.0);
    piece->to = min_of(to, 1.0);
    return 1;
}

/* v without its part along u, where u has a direction. */
static vec3 across(vec3 v, vec3 u)
{
    double uu = dot(u, u);
    return uu > 0.0 ? along(v, -dot(v, u) / uu, u) : v;
}

/*
 * The unit direction from the triangle to the axis. A short gap leans by its rounding, which over
 * the length of what it is to separate may be more than itself: where the pair lies inside of the
 * axis or of an edge, that is taken out.
 */
static vec3 normal_of(const struct stretch *s, const vec3 corner[3], const pair *found)
{
    const double *w = found->weight;
    vec3 u = sub(s->b, s->a), e = { 0.0, 0.0, 0.0 }, n = found->gap;
    if (!(found->s > 0.0 && found->s < 1.0))
        u = e;
    for (int k = 0; k < 3; k++)
        if (w[k] == 0.0 && w[(k + 1) % 3] > 0.0 && w[(k + 2) % 3] > 0.0)
            e = sub(corner[(k + 2) % 3], corner[(k + 1) % 3]);
    vec3 beside = across(across(e, u), u);
    if (!(dot(beside, beside) > 0x1p-80 * dot(e, e)))
        beside = (vec3){ 0.0, 0.0, 0.0 };
    for (int k = 0; k < 2; k++)
        n = across(across(n, beside), u);
    double size = length(n), distance = sqrt(found->distance2);
    return size > 0.5 * distance ? scaled(n, 1.0 / size) : scaled(found->gap, 1.0 / distance);
}

/*
 * Go on in time as far as planes allow, and at least as long as the faster end takes for the
 * distance. 1: and cut the piece, since its ends pass the plane of the nearest pair much sooner
 * than the pair's own point would: they are faster, or rounding tilts the plane, by more the longer
 * the piece.
 */
static int advance(const struct sweep *sweep, const vec3 corner[3], const struct face *face,
                   const struct stretch *s, const pair *found, struct motion_piece *piece)
{
    double room = sqrt(found->distance2) - sweep->clear;
    vec3 normal = normal_of(s, corner, found);
    double support =
        max_of(dot(normal, corner[0]), max_of(dot(normal, corner[1]), dot(normal, corner[2])));
    double high = min_of(dot(normal, s->a), dot(normal, s->b)) - support - sweep->clear;
    double fall_a = -dot(normal, s->va), fall_b = -dot(normal, s->vb);
    double fall = fall_a + found->s * (fall_b - fall_a), rest = 1.0 - piece->time;
    double lasts = room / sqrt(max_of(dot(s->va, s->va), dot(s->vb, s->vb)));
    lasts = max_of(lasts, plane_lasts(s, normal, support, sweep->clear));
    lasts = max_of(lasts, face_lasts(s, face, sweep->clear));
    piece->time += lasts;
    return 4.0 * lasts < rest && 2.0 * lasts * fall < room &&
           (fabs(fall_b - fall_a) * rest > sweep->touch - sweep->clear || 2.0 * high < room);
}

int dpti_sweep_pair(const struct sweep *sweep, const vec3 corner[3], double until, double *time,
                    uint32_t *asked)
{
    enum { PIECES = 64 };
    struct motion_piece pieces[PIECES];
    const struct face face = face_of(corner);
    int count = trim(sweep, corner, pieces), result = SWEEP_FREE;
    while (count) {
        struct motion_piece *piece = &pieces[count - 1];
        if (piece->time > until) {
            count--;
            continue;
        }
        ++*asked;
        struct stretch s = stretch_of(sweep, piece);
        pair found = segment_triangle(s.a, sub(s.b, s.a), corner[0], corner[1], corner[2]);
        if (!(found.distance2 > sweep->touch * sweep->touch)) {
            until = piece->time;
            result = SWEEP_HIT;
            count--;
        } else if (advance(sweep, corner, &face, &s, &found, piece) && count < PIECES) {
            pieces[count] = *piece;
            piece->from = pieces[count].to = 0.5 * (piece->from + piece->to);
            count++;
        }
    }
    *time = until;
    return result;
}
