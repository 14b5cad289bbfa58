/* SPDX-License-Identifier: BSD-3-Clause */
#include "contact/distance_profile.h"

#include "contact/crossings.h"

static int in_reach_interval(const struct distance_profile *profile, double s)
{
    for (uint32_t i = 0; i < profile->reach_intervals; i++)
        if (s >= profile->reach_from[i] && s <= profile->reach_to[i])
            return 1;
    return 0;
}

/* Which side each stretch between crossings is on. What its ends do not tell, a search in its middle does. */
static void find_sides(struct distance_profile *profile, const struct pair_search *nearest)
{
    for (uint32_t k = 0; k <= profile->crossings; k++)
        profile->sign[k] = 0;
    if (profile_by_sample(profile))
        return;
    if (!profile->crossings) {
        profile->sign[0] =
            dpti_profile_side_of(profile, nearest->pair.s, nearest->triangle, &nearest->pair);
        return;
    }
    for (uint32_t k = 0; k <= profile->crossings; k++) {
        const struct crossing *here = &profile->crossing[k];
        int before = k ? here[-1].after : 0, after = k < profile->crossings ? here->before : 0;
        double from = k ? here[-1].s : 0.0, to = k < profile->crossings ? here->s : 1.0;
        int sign = before ? before : after;
        if (before * after < 0 || !sign) {
            struct sample middle;
            dpti_profile_take_sample(profile, 0.5 * (from + to), nearest->triangle, 1, &middle);
            sign = middle.height < 0.0 ? -1 : 1;
        }
        profile->sign[k] = sign;
    }
}

static void put_crossing_samples(struct distance_profile *profile)
{
    for (uint32_t k = 0; k < profile->crossings; k++) {
        const struct crossing *crossing = &profile->crossing[k];
        struct sample sample = {
            .s = crossing->s, .triangle = crossing->triangle, .was = crossing->triangle, .exact = 1
        };
        memcpy(sample.weight, crossing->weight, sizeof sample.weight);
        sample.normal = dpti_profile_exit_direction(profile, crossing->triangle, crossing->weight);
        sample.rise = dot(sample.normal, profile->axis->u);
        dpti_profile_put_sample(profile, &sample);
    }
}

/* Through holes an axis comes and goes without a crossing: so there are samples every so often. */
static void put_winding_samples(struct distance_profile *profile)
{
    enum { PIECES = 8 };
    for (int i = 1; i < PIECES && profile->winding; i++) {
        double s = (double)i / PIECES;
        if (!profile->sign[profile_stretch(profile, s)])
            dpti_profile_add_sample(profile, s, 1);
    }
}

/* Stretches that are inside have a sample at an end that is free, and one in the middle. */
static void put_inner_samples(struct distance_profile *profile)
{
    for (uint32_t k = 0; k <= profile->crossings; k++) {
        if (profile->sign[k] > 0)
            continue;
        double from = k ? profile->crossing[k - 1].s : 0.0;
        double to = k < profile->crossings ? profile->crossing[k].s : 1.0;
        int any = 0;
        for (uint32_t i = 0; i < profile->count; i++)
            any |= profile->sample[i].s > from && profile->sample[i].s < to;
        if (!k && !(any && profile->sample[0].s == 0.0))
            dpti_profile_add_sample(profile, 0.0, 1);
        if (!any && to > from)
            dpti_profile_add_sample(profile, 0.5 * (from + to), 1);
        if (k == profile->crossings && profile->sample[profile->count - 1].s < 1.0)
            dpti_profile_add_sample(profile, 1.0, 1);
    }
}

/*
 * An axis that is not within reach: outside as a whole, if its nearest point is. Through a hole in a part an end may be inside,
 * though; what passes two holes between its ends is taken for outside.
 */
static int is_outside(struct distance_profile *profile, const struct pair_search *nearest)
{
    if (dpti_profile_side_of(profile, nearest->pair.s, nearest->triangle, &nearest->pair) < 0)
        return 0;
    return !profile->winding ||
           !(dpti_profile_is_inside(profile, 0.0) || dpti_profile_is_inside(profile, 1.0));
}

int dpti_profile_make(struct distance_profile *profile, const struct pair_search *nearest,
                      const struct warm_start *warm_starts, uint32_t warm_start_count)
{
    const struct axis *axis = profile->axis;
    double distance = sqrt(nearest->pair.distance2);
    profile->size = length(axis->u);
    profile->full = 0;
    profile->cut = 0;
    profile->sideless = 0;
    profile->crossings = 0;
    profile->reach_intervals = 0;
    profile->count = 0;
    profile->deepest = 0;
    profile->same = 0;
    profile->winding = profile->surface->moments != NULL;
    int is_far = distance > profile->reach;
    if (is_far && !profile->sides->count && is_outside(profile, nearest))
        return 0;
    if (is_far && !profile_by_sample(profile)) {
        profile->sign[0] = -1;
    } else {
        dpti_profile_find_crossings(profile);
        if (profile->full || profile->cut || profile->sideless)
            return 1;
        find_sides(profile, nearest);
    }
    put_crossing_samples(profile);
    if (!profile->crossings) {
        struct sample sample;
        dpti_profile_take_sample(profile, nearest->pair.s, nearest->triangle, 0, &sample);
        sample.exact = 1;
        dpti_profile_put_sample(profile, &sample);
    }
    for (uint32_t i = 0; i < warm_start_count; i++) {
        int sign = profile->sign[profile_stretch(profile, warm_starts[i].s)];
        if (sign > 0 && !in_reach_interval(profile, warm_starts[i].s))
            continue;
        /* A budget is for the depth first: regions search for those that count. */
        int counts = warm_starts[i].share > PROFILE_SHARE && profile->work.done < PROFILE_WORK;
        int exact = profile->winding || (counts && !profile->point_cache);
        struct sample sample;
        dpti_profile_take_sample(profile, warm_starts[i].s, warm_starts[i].triangle, exact,
                                 &sample);
        dpti_profile_put_sample(profile, &sample);
    }
    for (uint32_t i = 1; i < profile->count; i++)
        dpti_profile_share_triangle(profile, i, profile->sample[i - 1].triangle);
    for (uint32_t i = profile->count - 1; i > 0; i--)
        dpti_profile_share_triangle(profile, i - 1, profile->sample[i].triangle);
    put_inner_samples(profile);
    put_winding_samples(profile);
    profile->deepest = dpti_profile_prove_deepest(profile, 0.0, 1.0);
    return 1;
}

/* How far from a sample within reach the surface goes out of it, if it goes on as there, and half as far again. */
static double exit_beyond(const struct distance_profile *profile, const struct sample *sample,
                          double sign)
{
    double rise = sign * sample->rise;
    double room = 0.25 * profile->reach, left = profile->reach - sample->height;
    if (!(left > 0.0))
        return 0.0;
    return rise > 0.0 ? max_of(room / profile->size, 1.5 * left / rise) : HUGE_VAL;
}

int dpti_profile_is_blind(const struct distance_profile *profile, uint32_t i, double *from,
                          double *to)
{
    const struct sample *left = &profile->sample[i], *right = left + 1;
    double middle = 0.5 * (left->s + right->s);
    if (!(profile->sign[profile_stretch(profile, middle)] > 0 &&
          in_reach_interval(profile, middle)))
        return 0;
    *from = left->s + exit_beyond(profile, left, 1.0);
    *to = right->s - exit_beyond(profile, right, -1.0);
    return *to > *from;
}

/* First those that have nothing in them, then what is beside a sample that is within reach. */
void dpti_profile_look_between(struct distance_profile *profile, double first, double last)
{
    enum { BLIND_MAX = 16 };
    uint32_t asked = 0;
    double from, to;
    for (int beside = 0; beside < 2; beside++)
        for (uint32_t i = 0; i + 1 < profile->count && asked < BLIND_MAX && !profile->cut;) {
            const struct sample *here = &profile->sample[i];
            int in = here->height < profile->reach || here[1].height < profile->reach;
            int blind = in == beside && here->s >= first && here[1].s <= last &&
                        dpti_profile_is_blind(profile, i, &from, &to);
            asked += (uint32_t)blind;
            if (!blind || dpti_profile_approach(profile, from, to, profile->reach) == DPT_NONE)
                i++;
        }
}

/* Outside of the zones an axis that is outside is beyond reach. Where a side is each sample's own, samples tell. */
void dpti_profile_find_reach(struct distance_profile *profile)
{
    struct sample beyond = { .height = profile->reach, .triangle = DPT_NONE };
    for (uint32_t i = 0; i < profile->reach_intervals; i++) {
        const double ends[2] = { profile->reach_from[i], profile->reach_to[i] };
        for (int k = 0; k < 2; k++) {
            int sign = profile->sign[profile_stretch(profile, ends[k])];
            beyond.s = ends[k];
            if (ends[k] <= 0.0 || ends[k] >= 1.0 || !sign)
                dpti_profile_add_sample(profile, ends[k], 1);
            else if (sign > 0)
                dpti_profile_put_sample(profile, &beyond);
        }
    }
    dpti_profile_look_between(profile, 0.0, 1.0);
}
