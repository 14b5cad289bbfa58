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
