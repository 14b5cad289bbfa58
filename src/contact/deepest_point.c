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

struct bend dpti_profile_bend(const struct distance_profile *profile, const struct sample *from,
                              const struct sample *to)
{
    double width = to->s - from->s, turn = to->rise - from->rise;
    double s = fabs(turn) * width > profile->axis->error
                   ? (from->height - to->height + to->rise * width) / turn
                   : 0.5 * width;
    /* Beside an end, the edge is at the end; far from both there is none between. */
    if (!(s > -0.25 * width && s < 1.25 * width))
        s = 0.5 * width;
    s = max_of(0.0, min_of(s, width));
    return (struct bend){ from->s + s, from->height + from->rise * s };
}

/* How deep it can be between two samples of which one is inside; to know that it is not above `least` is enough. */
static struct deep deep_between(const struct distance_profile *profile, uint32_t i, double least)
{
    const struct sample *from = &profile->sample[i], *to = from + 1;
    double width = (to->s - from->s) * profile->size, middle = 0.5 * (from->s + to->s);
    double slope = 0.5 * (width + fabs(from->height) + fabs(to->height));
    if (slope <= least)
        return (struct deep){ slope, middle, 1, 0 };
    double ends = max_of(-from->height, -to->height);
    if (from->triangle == to->triangle)
        return (struct deep){ ends, middle, 0, 0 };
    double bound = HUGE_VAL, s = middle;
    if (from->height > 0.0) {
        bound = dpti_profile_reach(profile, to->triangle, from->s);
    } else if (to->height > 0.0) {
        bound = dpti_profile_reach(profile, from->triangle, to->s);
    } else {
        double at = dpti_profile_bend(profile, from, to).s;
        double square =
            max_of(profile_square_to(profile, from, at), profile_square_to(profile, to, at));
        if (square <= least * least)
            return (struct deep){ max_of(ends, sqrt(square)), at, 1, 0 };
        for (int tries = 0; tries < 3 && bound > least; tries++) {
            double by_from = dpti_profile_reach(profile, from->triangle, at);
            double by_to = by_from < bound ? dpti_profile_reach(profile, to->triangle, at) : 0.0;
            if (max_of(by_from, by_to) < bound) {
                bound = max_of(by_from, by_to);
                s = at;
            }
            at = 0.5 * (at + (by_from > by_to ? from->s : to->s));
        }
    }
    double edge = 0.125 * (to->s - from->s);
    s = s > from->s + edge && s < to->s - edge ? s : middle;
    return (struct deep){ min_of(slope, max_of(bound, ends)), s, 0, 0 };
}

/* The lowest sample from one place to another; of the exact ones, if `exact`. */
static uint32_t lowest(const struct distance_profile *profile, double from, double to,
                       uint32_t exact)
{
    uint32_t best = DPT_NONE;
    for (uint32_t i = 0; i < profile->count; i++) {
        const struct sample *sample = &profile->sample[i];
        if (sample->s >= from && sample->s <= to && sample->exact >= exact &&
            (best == DPT_NONE || sample->height < profile->sample[best].height))
            best = i;
    }
    return best;
}

/* Between samples i and the next the axis is inside; where each sample has its own side, one of them, or the face where it comes or goes. */
static int is_inner(const struct distance_profile *profile, uint32_t i)
{
    const struct sample *from = &profile->sample[i], *to = from + 1;
    uint32_t k = profile_stretch(profile, 0.5 * (from->s + to->s));
    if (profile->sign[k])
        return profile->sign[k] < 0;
    const struct crossing *next = &profile->crossing[k];
    return from->height < 0.0 || to->height < 0.0 ||
           (k > 0 && next[-1].s == from->s && next[-1].after < 0) ||
           (k < profile->crossings && next->s == to->s && next->before < 0);
}

/* The stretch that can be deepest, if it can be deeper than `least`: of those that end and begin within the limits. */
static const struct sample *deepest_stretch(struct distance_profile *profile, double least_s,
                                            double most_s, double least)
{
    const struct sample *most = NULL;
    double bound = least;
    for (uint32_t i = 0; i + 1 < profile->count; i++) {
        struct sample *sample = &profile->sample[i];
        if (sample[1].s <= least_s || sample->s >= most_s ||
            (sample->bounded && !(sample->deep.bound > bound)) || !is_inner(profile, i))
            continue;
        if (!sample->bounded || (sample->deep.coarse && sample->deep.bound > least)) {
            sample->deep = deep_between(profile, i, least);
            sample->bounded = 1;
        }
        if (sample->deep.bound > bound) {
            bound = sample->deep.bound;
            most = sample;
        }
    }
    return most;
}

uint32_t dpti_profile_prove_deepest(struct distance_profile *profile, double from, double to)
{
    enum { DESCENTS = 16 };
    uint32_t low = lowest(profile, from, to, 0);
    int full = 0;
    for (int asked = 0; asked < PROFILE_SAMPLES && low != DPT_NONE && !profile->cut; asked++) {
        const struct sample *most = NULL;
        if (!full)
            most = deepest_stretch(profile, from, to,
                                   profile->tolerance - profile->sample[low].height);
        /*
         * Between samples descent tells enough; where it does not get on, a search does. What counts, regions would search for
         * after all.
         */
        int exact = profile->winding || profile->contacts_wanted || asked >= DESCENTS;
        if (most)
            full = dpti_profile_add_sample(profile, most->deep.s, exact) == DPT_NONE;
        else if (!profile->sample[low].exact)
            dpti_profile_add_sample(profile, profile->sample[low].s, 1);
        else
            break;
        low = lowest(profile, from, to, 0);
    }
    /* Where that did not come to an end, what descent tells may be too deep. */
    if (low != DPT_NONE && !profile->sample[low].exact && lowest(profile, from, to, 1) != DPT_NONE)
        low = lowest(profile, from, to, 1);
    if (low != DPT_NONE)
        profile->sample[low].proven = 1;
    return low;
}
