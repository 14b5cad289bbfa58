/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The deepest point of an axis inside a body is where the distance to the surface is largest. Between two samples the
 * surface is no farther than each of their two triangles; the distance to one triangle is convex along the axis. So
 * for any s between them
 *
 *     depth <= the largest of  D_i(s_i), D_i(s), D_j(s), D_j(s_j),
 *
 * four evaluations that bound a whole stretch without a search. Stretches whose bound is not above the deepest
 * sample by more than the tolerance are done; of the others the one with the largest bound is split there.
 */
#include "contact/deepest_point.h"

struct bend dpti_profile_bend(const struct distance_profile *profile,
                              const struct profile_sample *from, const struct profile_sample *to)
{
    double width = to->s - from->s, turn = to->slope - from->slope;
    double s = fabs(turn) * width > profile->axis->error
                   ? (from->height - to->height + to->slope * width) / turn
                   : 0.5 * width;
    /* Beside an end, the edge is at the end; far from both there is none between. */
    if (!(s > -0.25 * width && s < 1.25 * width))
        s = 0.5 * width;
    s = max_of(0.0, min_of(s, width));
    return (struct bend){ from->s + s, from->height + from->slope * s };
}

/* How deep it can be between two samples of which one is inside; to know that it is not above `least` is enough. */
static struct depth_bound bound_depth(const struct distance_profile *profile, uint32_t i,
                                      double least)
{
    const struct profile_sample *from = &profile->sample[i], *to = from + 1;
    double width = (to->s - from->s) * profile->axis_length, middle = 0.5 * (from->s + to->s);
    double slope = 0.5 * (width + fabs(from->height) + fabs(to->height));
    if (slope <= least)
        return (struct depth_bound){ slope, middle, 1, 0 };
    double ends = max_of(-from->height, -to->height);
    if (from->triangle == to->triangle)
        return (struct depth_bound){ ends, middle, 0, 0 };
    double bound = HUGE_VAL, s = middle;
    if (from->height > 0.0) {
        bound = dpti_profile_distance_to(profile, to->triangle, from->s);
    } else if (to->height > 0.0) {
        bound = dpti_profile_distance_to(profile, from->triangle, to->s);
    } else {
        double at = dpti_profile_bend(profile, from, to).s;
        double square = max_of(profile_square_distance(profile, from, at),
                               profile_square_distance(profile, to, at));
        if (square <= least * least)
            return (struct depth_bound){ max_of(ends, sqrt(square)), at, 1, 0 };
        for (int tries = 0; tries < 3 && bound > least; tries++) {
            double by_from = dpti_profile_distance_to(profile, from->triangle, at);
            double by_to =
                by_from < bound ? dpti_profile_distance_to(profile, to->triangle, at) : 0.0;
            if (max_of(by_from, by_to) < bound) {
                bound = max_of(by_from, by_to);
                s = at;
            }
            at = 0.5 * (at + (by_from > by_to ? from->s : to->s));
        }
    }
    double edge = 0.125 * (to->s - from->s);
    s = s > from->s + edge && s < to->s - edge ? s : middle;
    return (struct depth_bound){ min_of(slope, max_of(bound, ends)), s, 0, 0 };
}

/* The lowest sample from one place to another; of the exact ones, if `exact`. */
static uint32_t lowest_sample(const struct distance_profile *profile, double from, double to,
                              uint32_t exact)
{
    uint32_t best = DPT_NONE;
    for (uint32_t i = 0; i < profile->sample_count; i++) {
        const struct profile_sample *sample = &profile->sample[i];
        if (sample->s >= from && sample->s <= to && sample->is_exact >= exact &&
            (best == DPT_NONE || sample->height < profile->sample[best].height))
            best = i;
    }
    return best;
}

/* Between samples i and the next the axis is inside; where each sample has its own side, one of them, or the face where it comes or goes. */
static int is_stretch_inside(const struct distance_profile *profile, uint32_t i)
{
    const struct profile_sample *from = &profile->sample[i], *to = from + 1;
    uint32_t k = profile_stretch(profile, 0.5 * (from->s + to->s));
    if (profile->sign[k])
        return profile->sign[k] < 0;
    const struct crossing *next = &profile->crossing[k];
    return from->height < 0.0 || to->height < 0.0 ||
           (k > 0 && next[-1].s == from->s && next[-1].side_after < 0) ||
           (k < profile->crossing_count && next->s == to->s && next->side_before < 0);
}

/* The stretch that can be deepest, if it can be deeper than `least`: of those that end and begin within the limits. */
static const struct profile_sample *deepest_stretch(struct distance_profile *profile,
                                                    double least_s, double most_s, double least)
{
    const struct profile_sample *most = NULL;
    double bound = least;
    for (uint32_t i = 0; i + 1 < profile->sample_count; i++) {
        struct profile_sample *sample = &profile->sample[i];
        if (sample[1].s <= least_s || sample->s >= most_s ||
            (sample->has_depth_bound && !(sample->depth_bound.depth > bound)) ||
            !is_stretch_inside(profile, i))
            continue;
        if (!sample->has_depth_bound ||
            (sample->depth_bound.can_tighten && sample->depth_bound.depth > least)) {
            sample->depth_bound = bound_depth(profile, i, least);
            sample->has_depth_bound = 1;
        }
        if (sample->depth_bound.depth > bound) {
            bound = sample->depth_bound.depth;
            most = sample;
        }
    }
    return most;
}

uint32_t dpti_profile_prove_deepest(struct distance_profile *profile, double from, double to)
{
    enum { DESCENTS_MAX = 16 };
    uint32_t low = lowest_sample(profile, from, to, 0);
    int full = 0;
    for (int asked = 0; asked < PROFILE_SAMPLES && low != DPT_NONE && !profile->is_cut; asked++) {
        const struct profile_sample *most = NULL;
        if (!full)
            most = deepest_stretch(profile, from, to,
                                   profile->tolerance - profile->sample[low].height);
        /*
         * Between samples descent tells enough; where it does not get on, a search does. What counts, regions would search for
         * after all.
         */
        int exact = profile->has_winding_parts || profile->contacts_wanted || asked >= DESCENTS_MAX;
        if (most)
            full = dpti_profile_add_sample(profile, most->depth_bound.s, exact) == DPT_NONE;
        else if (!profile->sample[low].is_exact)
            dpti_profile_add_sample(profile, profile->sample[low].s, 1);
        else
            break;
        low = lowest_sample(profile, from, to, 0);
    }
    /* Where that did not come to an end, what descent tells may be too deep. */
    if (low != DPT_NONE && !profile->sample[low].is_exact &&
        lowest_sample(profile, from, to, 1) != DPT_NONE)
        low = lowest_sample(profile, from, to, 1);
    if (low != DPT_NONE)
        profile->sample[low].is_proven = 1;
    return low;
}
