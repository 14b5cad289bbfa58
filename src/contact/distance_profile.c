/* SPDX-License-Identifier: BSD-3-Clause */
#include "contact/distance_profile.h"

#include "contact/crossings.h"
#include "contact/holes.h"
#include "contact/stretch_winding.h"

/* 1: a triangle may be within reach of the axis at s. */
static int is_in_reach_interval(const struct distance_profile *profile, double s)
{
    for (uint32_t i = 0; i < profile->reach_interval_count; i++)
        if (s >= profile->reach_from[i] && s <= profile->reach_to[i])
            return 1;
    return 0;
}

/*
 * The side of an axis that crosses nothing, at its nearest pair. With no hole near, it is the same all along the axis,
 * and outside where one end is out of the mesh's box.
 */
static int side_of_axis(struct distance_profile *profile, const struct pair_search *nearest)
{
    const struct surface *surface = profile->surface;
    if (!profile_has_side_per_sample(profile) && surface->moments &&
        !(surface_box_holds(surface, profile_point(profile, 0.0)) &&
          surface_box_holds(surface, profile_point(profile, 1.0))))
        return 1;
    return dpti_profile_side_of(profile, nearest->pair.s, nearest->triangle, &nearest->pair);
}

/* Find the side of each stretch by its winding number, where that is known and decides. */
static void find_sides_by_winding(struct distance_profile *profile)
{
    const uint32_t has_sheets = profile->surface->holes->has_sheets;
    profile->has_winding_parts = !dpti_stretch_windings_find(profile) || has_sheets;
    profile->has_windings = 1;
    if (has_sheets)
        return;
    for (uint32_t k = 0; k <= profile->crossing_count; k++)
        if (profile->winding[k] != WINDING_UNKNOWN)
            profile->sign[k] = profile->winding[k] > 0 ? -1 : 1;
}

/*
 * Find the side of each stretch between crossings. Where the crossings at its ends do not know it, or disagree, a
 * search in its middle decides.
 */
static void find_sides(struct distance_profile *profile, const struct pair_search *nearest)
{
    const struct holes *holes = profile->surface->holes;
    for (uint32_t k = 0; k <= profile->crossing_count; k++)
        profile->sign[k] = 0;
    if (profile->surface->moments && holes && (profile->has_winding_parts || !holes->normals_tell)) {
        find_sides_by_winding(profile);
        return;
    }
    if (profile_has_side_per_sample(profile))
        return;
    if (!profile->crossing_count) {
        profile->sign[0] = side_of_axis(profile, nearest);
        return;
    }
    for (uint32_t k = 0; k <= profile->crossing_count; k++) {
        const struct crossing *here = &profile->crossing[k];
        int before = k ? here[-1].side_after : 0, after = k < profile->crossing_count ? here->side_before : 0;
        double from = k ? here[-1].s : 0.0, to = k < profile->crossing_count ? here->s : 1.0;
        int sign = before ? before : after;
        if (before * after < 0 || !sign) {
            struct profile_sample middle;
            dpti_profile_take_sample(profile, 0.5 * (from + to), nearest->triangle, 1, &middle);
            sign = middle.height < 0.0 ? -1 : 1;
        }
        profile->sign[k] = sign;
    }
}

/* Put a sample of height 0 at each crossing. */
static void put_crossing_samples(struct distance_profile *profile)
{
    for (uint32_t k = 0; k < profile->crossing_count; k++) {
        const struct crossing *crossing = &profile->crossing[k];
        struct profile_sample sample = {
            .s = crossing->s, .triangle = crossing->triangle, .start_triangle = crossing->triangle, .is_exact = 1
        };
        memcpy(sample.weight, crossing->weight, sizeof sample.weight);
        sample.normal = dpti_profile_exit_direction(profile, crossing->triangle, crossing->weight);
        sample.slope = dot(sample.normal, profile->axis->u);
        dpti_profile_put_sample(profile, &sample);
    }
}

/* Through a hole an axis goes in and out without a crossing. So there is a sample every eighth of its length. */
static void put_winding_samples(struct distance_profile *profile)
{
    enum { WINDING_PIECES = 8 };
    for (int i = 1; i < WINDING_PIECES && profile->has_winding_parts; i++) {
        double s = (double)i / WINDING_PIECES;
        if (!profile->sign[profile_stretch(profile, s)])
            dpti_profile_add_sample(profile, s, 1);
    }
}

/* Give each stretch that may be inside a sample at an end of the axis, and one in its middle if it has none. */
static void put_inner_samples(struct distance_profile *profile)
{
    for (uint32_t k = 0; k <= profile->crossing_count; k++) {
        if (profile->sign[k] > 0)
            continue;
        double from = k ? profile->crossing[k - 1].s : 0.0;
        double to = k < profile->crossing_count ? profile->crossing[k].s : 1.0;
        int has_sample = 0;
        for (uint32_t i = 0; i < profile->sample_count; i++)
            has_sample |= profile->sample[i].s > from && profile->sample[i].s < to;
        if (!k && !(has_sample && profile->sample[0].s == 0.0))
            dpti_profile_add_sample(profile, 0.0, 1);
        if (!has_sample && to > from)
            dpti_profile_add_sample(profile, 0.5 * (from + to), 1);
        if (k == profile->crossing_count && profile->sample[profile->sample_count - 1].s < 1.0)
            dpti_profile_add_sample(profile, 1.0, 1);
    }
}

/*
 * 1: an axis is outside, with no surface within reach. Its nearest point decides. On a part with holes its ends must be
 * outside too: one may lie inside through a hole. An axis that passes through two holes between its ends is taken for
 * outside.
 */
static int is_outside(struct distance_profile *profile, const struct pair_search *nearest)
{
    if (side_of_axis(profile, nearest) < 0)
        return 0;
    return !profile->has_winding_parts ||
           !(dpti_profile_is_inside(profile, 0.0) || dpti_profile_is_inside(profile, 1.0));
}

int dpti_profile_make(struct distance_profile *profile, const struct pair_search *nearest,
                      const struct warm_start *warm_starts, uint32_t warm_start_count)
{
    const struct axis *axis = profile->axis;
    double distance = sqrt(nearest->pair.distance2);
    profile->axis_length = length(axis->u);
    profile->is_full = 0;
    profile->is_cut = 0;
    profile->is_sideless = 0;
    profile->crossing_count = 0;
    profile->reach_interval_count = 0;
    profile->sample_count = 0;
    profile->deepest = 0;
    profile->unchanged_count = 0;
    const struct holes *holes = profile->surface->holes;
    profile->has_windings = 0;
    profile->has_winding_parts = profile->surface->moments && !(holes && !holes->has_sheets &&
                                                                dpti_holes_are_far_from(holes, axis->local_a, axis->u));
    int is_far = distance > profile->reach;
    if (is_far && !profile->sides->count && is_outside(profile, nearest))
        return 0;
    if (is_far && !profile_has_side_per_sample(profile)) {
        profile->sign[0] = -1;
    } else {
        dpti_profile_find_crossings(profile);
        if (profile->is_full || profile->is_cut || profile->is_sideless)
            return 1;
        find_sides(profile, nearest);
    }
    put_crossing_samples(profile);
    if (!profile->crossing_count) {
        struct profile_sample sample;
        dpti_profile_take_sample(profile, nearest->pair.s, nearest->triangle, 0, &sample);
        sample.is_exact = 1;
        dpti_profile_put_sample(profile, &sample);
    }
    for (uint32_t i = 0; i < warm_start_count; i++) {
        int sign = profile->sign[profile_stretch(profile, warm_starts[i].s)];
        if (sign > 0 && !is_in_reach_interval(profile, warm_starts[i].s))
            continue;
        /* A budget goes to the depth first: the regions search for important samples later. */
        int is_important = warm_starts[i].share > PROFILE_SEARCH_SHARE && profile->work.done < PROFILE_WORK_MAX;
        int by_search = profile->has_winding_parts || (is_important && !profile->point_cache);
        struct profile_sample sample;
        dpti_profile_take_sample(profile, warm_starts[i].s, warm_starts[i].triangle, by_search, &sample);
        dpti_profile_put_sample(profile, &sample);
    }
    for (uint32_t i = 1; i < profile->sample_count; i++)
        dpti_profile_share_triangle(profile, i, &profile->sample[i - 1]);
    for (uint32_t i = profile->sample_count - 1; i > 0; i--)
        dpti_profile_share_triangle(profile, i - 1, &profile->sample[i]);
    put_inner_samples(profile);
    put_winding_samples(profile);
    profile->deepest = dpti_profile_prove_deepest(profile, 0.0, 1.0);
    return 1;
}

/*
 * How far beyond a sample, in s, the surface is taken to be within reach: as far as its tangent stays within reach and
 * half as far again, at least a quarter of the reach. 0 for a sample that is not within reach; HUGE_VAL if the height
 * does not grow in this direction.
 *
 *   sign  the direction along the axis: +1 or -1
 */
static double exit_beyond(const struct distance_profile *profile, const struct profile_sample *sample, double sign)
{
    double slope = sign * sample->slope;
    double min_length = 0.25 * profile->reach, reach_left = profile->reach - sample->height;
    if (!(reach_left > 0.0))
        return 0.0;
    return slope > 0.0 ? max_of(min_length / profile->axis_length, 1.5 * reach_left / slope) : HUGE_VAL;
}

int dpti_profile_find_undecided(const struct distance_profile *profile, uint32_t i, double *from, double *to)
{
    const struct profile_sample *left = &profile->sample[i], *right = left + 1;
    double middle = 0.5 * (left->s + right->s);
    if (!(profile->sign[profile_stretch(profile, middle)] > 0 && is_in_reach_interval(profile, middle)))
        return 0;
    *from = left->s + exit_beyond(profile, left, 1.0);
    *to = right->s - exit_beyond(profile, right, -1.0);
    return *to > *from;
}

/* Stretches without a sample within reach come first, then those beside one. */
void dpti_profile_search_undecided(struct distance_profile *profile, double min_s, double max_s)
{
    enum { UNDECIDED_MAX = 16 };
    uint32_t searched = 0;
    double from, to;
    for (int pass = 0; pass < 2; pass++)
        for (uint32_t i = 0; i + 1 < profile->sample_count && searched < UNDECIDED_MAX && !profile->is_cut;) {
            const struct profile_sample *here = &profile->sample[i];
            int is_within = here->height < profile->reach || here[1].height < profile->reach;
            int is_undecided = is_within == pass && here->s >= min_s && here[1].s <= max_s &&
                               dpti_profile_find_undecided(profile, i, &from, &to);
            searched += (uint32_t)is_undecided;
            if (!is_undecided || dpti_profile_add_nearest(profile, from, to, profile->reach) == DPT_NONE)
                i++;
        }
}

/*
 * Beyond a reach interval an axis that is outside is out of reach, so its end is a mark. An end that is inside, or at
 * an end of the axis, or whose side is not known, gets a sample.
 */
void dpti_profile_find_reach(struct distance_profile *profile)
{
    struct profile_sample beyond = { .height = profile->reach, .triangle = DPT_NONE };
    for (uint32_t i = 0; i < profile->reach_interval_count; i++) {
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
    dpti_profile_search_undecided(profile, 0.0, 1.0);
}
