/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Between two samples the height lies between its chord and its two tangents. Where it bends once, at the edge between
 * two walls, it follows the tangents. Where it curves evenly, it lies a third of the way from them to the chord. The
 * integrals use five sixths of the way from the chord to the tangents. The area between chord and tangents gives an
 * error estimate, which decides where the next sample goes.
 */
#include "contact/spans.h"

#include "contact/deepest_point.h"

/* Differences of two unit ways out. A smaller one is ignored; a larger one does not come from one curved wall. */
#define TURN_SMALL 0.01
#define TURN_LARGE 0.15

/* If chord and tangents differ by at most this share of the area, the tangents are nearly one line. */
#define STRAIGHT_SHARE 0.001

/* How far the height at the end of a region may differ from the reach, as a share of the reach. */
#define END_SHARE 0.04

/* For a span between a mark and a sample: how far the sample's tangent is still within reach at s. */
static double reach_left_at_mark(const struct distance_profile *profile, const struct profile_sample *from,
                                 const struct profile_sample *to, double s)
{
    const struct profile_sample *sample = from->triangle == DPT_NONE ? to : from;
    return profile->reach - sample->height - sample->slope * (s - sample->s);
}

/*
 * 1: at sample `here` the triangle of `other` is as near as the sample's own. The distance to one triangle is convex
 * along the axis, so it is never below its tangent. The tangent alone mostly rules it out.
 */
static int is_as_near(const struct distance_profile *profile, const struct profile_sample *other,
                      const struct profile_sample *here)
{
    double limit = fabs(here->height) + profile->axis->error;
    return !(profile_tangent_distance(other, here->s) > limit) &&
           dpti_profile_distance_to(profile, other->triangle, here->s) <= limit;
}

/*
 * 1: one triangle is nearest at both samples. Between them the way out turns evenly, except at a sample where other
 * triangles are as near.
 */
static int is_one_wall(const struct distance_profile *profile, const struct profile_sample *from,
                       const struct profile_sample *to)
{
    return from->triangle == to->triangle || is_as_near(profile, to, from) || is_as_near(profile, from, to);
}

void dpti_span_measure(const struct distance_profile *profile, const struct profile_sample *from,
                       const struct profile_sample *to, struct span *span)
{
    struct bend bend = dpti_profile_bend(profile, from, to);
    double width = to->s - from->s, w0 = profile->reach - from->height;
    double w1 = profile->reach - to->height, tangent = profile->reach - bend.height;
    double share = width > 0.0 ? (bend.s - from->s) / width : 0.0;
    double chord = w0 + (w1 - w0) * share;
    int has_mark = from->triangle == DPT_NONE || to->triangle == DPT_NONE;
    double w = has_mark ? tangent : chord + (tangent - chord) * (5.0 / 6.0);
    double chord_area = area_within_reach(from->s, w0, to->s, w1);
    double tangent_area =
        area_within_reach(from->s, w0, bend.s, tangent) + area_within_reach(bend.s, tangent, to->s, w1);
    double area = area_within_reach(from->s, w0, bend.s, w) + area_within_reach(bend.s, w, to->s, w1);
    double error = 0.25 * fabs(tangent_area - chord_area);
    /* The height changes by no more than the length along the axis, so a short span has no loose end. */
    double end_tolerance = END_SHARE * profile->reach;
    int is_partly_within = (w0 > 0.0) != (w1 > 0.0) && fabs(w0) > end_tolerance && fabs(w1) > end_tolerance;
    span->s = bend.s;
    span->w0 = w0;
    span->w = w;
    span->w1 = w1;
    span->area = area;
    span->error_estimate = has_mark ? error + 0.5 * area : error;
    span->has_loose_end = width * profile->axis_length > end_tolerance &&
                          (has_mark ? reach_left_at_mark(profile, from, to, bend.s) > end_tolerance
                                    : is_partly_within && fabs(tangent - chord) > end_tolerance);
}

/*
 * A wall may be nearest between two samples and at neither of them: for example when both have just passed from that
 * wall to another one about as far away. If `wall` is such a triangle at the span's bend, returns how much the way out
 * turns between it and the samples, else 0.
 *
 *   wall          place of a triangle
 *   max_distance  the nearer of the samples' triangles is no farther than this at the bend, m
 */
static double hidden_wall_turn(const struct distance_profile *profile, const struct profile_sample *from,
                               const struct profile_sample *to, uint32_t wall, double max_distance)
{
    if (wall == from->triangle || wall == to->triangle)
        return 0.0;
    double s = from->span.s, error = profile->axis->error;
    double wall_distance = dpti_profile_distance_to(profile, wall, s);
    const uint32_t own[2] = { from->triangle, to->triangle };
    for (int k = 0; k < 2 && wall_distance <= max_distance + error; k++)
        max_distance = min_of(max_distance, dpti_profile_distance_to(profile, own[k], s));
    if (wall_distance > max_distance + error)
        return 0.0;
    pair found;
    dpti_triangle_point_pair(profile->surface, wall, profile_point(profile, s), &found);
    double distance = sqrt(found.distance2);
    if (!(distance > error && distance < max_distance))
        return 0.0;
    double sign = from->height + to->height < 0.0 ? -1.0 : 1.0;
    vec3 exit_direction = scaled(found.gap, sign / distance);
    return max_of(length(sub(exit_direction, from->normal)), length(sub(exit_direction, to->normal)));
}

/*
 * How far the way out may be off between a sample whose span is known and the next, as a length of unit vectors. It is
 * largest where the two tangents are nearly one line, since they do not show where they meet.
 */
static double normal_error(const struct distance_profile *profile, const struct profile_sample *from,
                           const struct profile_sample *to)
{
    double turn = length(sub(from->normal, to->normal)), factor = 0.25;
    if (turn > TURN_SMALL && is_one_wall(profile, from, to))
        factor = 0.03;
    else if (turn > TURN_LARGE && from->span.error_estimate <= STRAIGHT_SHARE * from->span.area)
        factor = 1.0;
    double error = factor * turn;
    if (from->start_triangle != from->triangle || to->start_triangle != to->triangle) {
        double s = from->span.s;
        double max_distance =
            sqrt(min_of(profile_square_distance(profile, from, s), profile_square_distance(profile, to, s)));
        error += 0.25 * max_of(hidden_wall_turn(profile, from, to, from->start_triangle, max_distance),
                               hidden_wall_turn(profile, from, to, to->start_triangle, max_distance));
    }
    return error;
}

void dpti_span_store(const struct distance_profile *profile, struct profile_sample *from)
{
    const struct profile_sample *to = from + 1;
    dpti_span_measure(profile, from, to, &from->span);
    if (from->span.area > 0.0 && from->triangle != DPT_NONE && to->triangle != DPT_NONE)
        from->span.error_estimate += from->span.area * normal_error(profile, from, to);
    from->has_span = 1;
}

double dpti_span_next_sample(const struct distance_profile *profile, uint32_t i)
{
    const struct profile_sample *from = &profile->sample[i], *to = from + 1;
    const struct span *span = &from->span;
    struct profile_piece piece = { from->s, span->s, span->w0, span->w, { 0.0, 0.0, 0.0 } };
    if (span->w0 < 0.0 && span->w > 0.0 && clip_to_reach(&piece))
        return piece.s0;
    if (span->w0 > 0.0 && span->w < 0.0 && clip_to_reach(&piece))
        return piece.s1;
    piece = (struct profile_piece){ span->s, to->s, span->w, span->w1, { 0.0, 0.0, 0.0 } };
    if (span->w < 0.0 && span->w1 > 0.0 && clip_to_reach(&piece))
        return piece.s0;
    if (span->w > 0.0 && span->w1 < 0.0 && clip_to_reach(&piece))
        return piece.s1;
    double end_gap = 0.0625 * (to->s - from->s);
    return span->s > from->s + end_gap && span->s < to->s - end_gap ? span->s : 0.5 * (from->s + to->s);
}
