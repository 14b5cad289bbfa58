/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The deepest point of an axis inside a body is where the distance to the surface is largest. Let D_i(s) be the
 * distance from the axis at s to the triangle of sample i. The surface is nowhere farther than that, and D_i is
 * convex. So between two samples i and j, for any s,
 *
 *     depth <= the largest of  D_i(s_i), D_i(s), D_j(s), D_j(s_j).
 *
 * These four evaluations bound a whole stretch without a search. A stretch whose bound exceeds the deepest sample by no
 * more than the tolerance is done. Of the others the one with the largest bound is split at s.
 */
#include "contact/deepest_point.h"

struct bend dpti_profile_bend(const struct distance_profile *profile, const struct profile_sample *from,
                              const struct profile_sample *to)
{
    double width = to->s - from->s, turn = to->slope - from->slope;
    double offset = fabs(turn) * width > profile->axis->error ? (from->height - to->height + to->slope * width) / turn
                                                              : 0.5 * width;
    /*
     * Tangents that meet a little beyond an end meet at that end. If they meet far beyond it, there is no bend
     * between.
     */
    if (!(offset > -0.25 * width && offset < 1.25 * width))
        offset = 0.5 * width;
    offset = max_of(0.0, min_of(offset, width));
    return (struct bend){ from->s + offset, from->height + from->slope * offset };
}

/*
 * A bound of the depth between sample i and the next, one of which is inside. A bound of at most `enough`, in m, need
 * not be tighter.
 */
static struct depth_bound bound_depth(const struct distance_profile *profile, uint32_t i, double enough)
{
    const struct profile_sample *from = &profile->sample[i], *to = from + 1;
    double width = (to->s - from->s) * profile->axis_length, middle = 0.5 * (from->s + to->s);
    double motion_bound = 0.5 * (width + fabs(from->height) + fabs(to->height));
    if (motion_bound <= enough)
        return (struct depth_bound){ motion_bound, middle, 1, 0 };
    double ends = max_of(-from->height, -to->height);
    if (from->triangle == to->triangle)
        return (struct depth_bound){ ends, middle, 0, 0 };
    double bound = HUGE_VAL, s = middle;
    if (from->height > 0.0) {
        bound = dpti_profile_distance_to(profile, to->triangle, from->s);
    } else if (to->height > 0.0) {
        bound = dpti_profile_distance_to(profile, from->triangle, to->s);
    } else {
        double s_try = dpti_profile_bend(profile, from, to).s;
        double square =
            max_of(profile_square_distance(profile, from, s_try), profile_square_distance(profile, to, s_try));
        if (square <= enough * enough)
            return (struct depth_bound){ max_of(ends, sqrt(square)), s_try, 1, 0 };
        for (int tries = 0; tries < 3 && bound > enough; tries++) {
            double from_distance = dpti_profile_distance_to(profile, from->triangle, s_try);
            double to_distance = from_distance < bound ? dpti_profile_distance_to(profile, to->triangle, s_try) : 0.0;
            if (max_of(from_distance, to_distance) < bound) {
                bound = max_of(from_distance, to_distance);
                s = s_try;
            }
            s_try = 0.5 * (s_try + (from_distance > to_distance ? from->s : to->s));
        }
    }
    double end_gap = 0.125 * (to->s - from->s);
    s = s > from->s + end_gap && s < to->s - end_gap ? s : middle;
    return (struct depth_bound){ min_of(motion_bound, max_of(bound, ends)), s, 0, 0 };
}

/* The index of the lowest sample between two places, in s, or DPT_NONE. With exact_only, of the exact samples. */
static uint32_t lowest_sample(const struct distance_profile *profile, double from, double to, uint32_t exact_only)
{
    uint32_t best = DPT_NONE;
    for (uint32_t i = 0; i < profile->sample_count; i++) {
        const struct profile_sample *sample = &profile->sample[i];
        if (sample->s >= from && sample->s <= to && sample->is_exact >= exact_only &&
            (best == DPT_NONE || sample->height < profile->sample[best].height))
            best = i;
    }
    return best;
}

/*
 * 1: the axis is inside between sample i and the next. Where each sample has its own side, it is enough that one of
 * the two is inside, or that the face at a crossing there says that the axis is inside beyond it.
 */
static int is_stretch_inside(const struct distance_profile *profile, uint32_t i)
{
    const struct profile_sample *from = &profile->sample[i], *to = from + 1;
    uint32_t k = profile_stretch(profile, 0.5 * (from->s + to->s));
    if (profile->sign[k])
        return profile->sign[k] < 0;
    const struct crossing *next = &profile->crossing[k];
    return from->height < 0.0 || to->height < 0.0 || (k > 0 && next[-1].s == from->s && next[-1].side_after < 0) ||
           (k < profile->crossing_count && next->s == to->s && next->side_before < 0);
}

/*
 * The sample that begins the stretch with the largest bound of the depth, of the stretches that overlap min_s to max_s.
 * NULL if no bound exceeds `enough`, in m.
 */
static const struct profile_sample *deepest_stretch(struct distance_profile *profile, double min_s, double max_s,
                                                    double enough)
{
    const struct profile_sample *stretch = NULL;
    double bound = enough;
    for (uint32_t i = 0; i + 1 < profile->sample_count; i++) {
        struct profile_sample *sample = &profile->sample[i];
        if (sample[1].s <= min_s || sample->s >= max_s ||
            (sample->has_depth_bound && !(sample->depth_bound.depth > bound)) || !is_stretch_inside(profile, i))
            continue;
        if (!sample->has_depth_bound || (sample->depth_bound.can_tighten && sample->depth_bound.depth > enough)) {
            sample->depth_bound = bound_depth(profile, i, enough);
            sample->has_depth_bound = 1;
        }
        if (sample->depth_bound.depth > bound) {
            bound = sample->depth_bound.depth;
            stretch = sample;
        }
    }
    return stretch;
}

uint32_t dpti_profile_prove_deepest(struct distance_profile *profile, double from, double to)
{
    enum { DESCENTS_MAX = 16 };
    uint32_t lowest = lowest_sample(profile, from, to, 0);
    int is_full = 0;
    for (int steps = 0; steps < PROFILE_SAMPLES && lowest != DPT_NONE && !profile->is_cut; steps++) {
        const struct profile_sample *stretch = NULL;
        if (!is_full)
            stretch = deepest_stretch(profile, from, to, profile->tolerance - profile->sample[lowest].height);
        /*
         * A descent suffices at first. After many of them a search gets further. If regions follow, they would search
         * for most of these samples anyway.
         */
        int by_search = profile->has_winding_parts || profile->contacts_wanted || steps >= DESCENTS_MAX;
        if (stretch)
            is_full = dpti_profile_add_sample(profile, stretch->depth_bound.s, by_search) == DPT_NONE;
        else if (!profile->sample[lowest].is_exact)
            dpti_profile_add_sample(profile, profile->sample[lowest].s, 1);
        else
            break;
        lowest = lowest_sample(profile, from, to, 0);
    }
    /* If the proof is incomplete, a sample that only descended may seem too deep. */
    if (lowest != DPT_NONE && !profile->sample[lowest].is_exact && lowest_sample(profile, from, to, 1) != DPT_NONE)
        lowest = lowest_sample(profile, from, to, 1);
    if (lowest != DPT_NONE)
        profile->sample[lowest].is_proven = 1;
    return lowest;
}

/* ---- spans between samples ---- */

/*
 * Between two samples the height lies between its chord and its two tangents. Where it bends once, at the edge between
 * two walls, it follows the tangents. Where it curves evenly, it lies a third of the way from them to the chord. The
 * integrals use five sixths of the way from the chord to the tangents. The area between chord and tangents gives an
 * error estimate, which decides where the next sample goes.
 */

/* Differences of two exit directions. A smaller one is ignored; a larger one does not come from one curved wall. */
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
 * 1: one triangle is nearest at both samples. Between them the exit direction turns evenly, except at a sample where
 * other triangles are as near.
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
 * wall to another one about as far away. If `wall` is such a triangle at the span's bend, returns how much the exit
 * direction turns between it and the samples, else 0.
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
 * How far the exit direction may be off between a sample whose span is known and the next, as a length of unit vectors.
 * It is largest where the two tangents are nearly one line, since they do not show where they meet.
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
