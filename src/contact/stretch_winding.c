/* SPDX-License-Identifier: BSD-3-Clause */
#include "contact/stretch_winding.h"

/* Of a stretch that is near a hole, after the first. */
enum { HALVINGS = 3 };

static int is_outside_of_box(const struct distance_profile *profile, double s)
{
    return !surface_box_holds(profile->surface, profile_point(profile, s));
}

static double start_of(const struct distance_profile *profile, uint32_t k)
{
    return k ? profile->crossing[k - 1].s : 0.0;
}

static double end_of(const struct distance_profile *profile, uint32_t k)
{
    return k < profile->crossing_count ? profile->crossing[k].s : 1.0;
}

static int is_far_from_holes(const struct distance_profile *profile, double from, double to)
{
    return dpti_holes_are_far_from(profile->surface->holes, profile_point(profile, from),
                                   scaled(profile->axis->u, to - from));
}

/* By a winding number on the stretch: at an end of the axis where that is outside of the mesh's box, or in the middle. */
static int32_t ask(struct distance_profile *profile, uint32_t k)
{
    const double from = start_of(profile, k), to = end_of(profile, k);
    const int is_free =
        (from == 0.0 && is_outside_of_box(profile, 0.0)) || (to == 1.0 && is_outside_of_box(profile, 1.0));
    return is_free ? 0 : dpti_profile_winding(profile, 0.5 * (from + to));
}

/* 1: in front of each face between two stretches it is outside, and inside behind it. */
static int faces_agree(const struct distance_profile *profile, uint32_t first, uint32_t last)
{
    for (uint32_t k = first; k < last; k++) {
        const struct crossing *crossing = &profile->crossing[k];
        if (crossing->side_before * (profile->winding[k] > 0 ? -1 : 1) < 0 ||
            crossing->side_after * (profile->winding[k + 1] > 0 ? -1 : 1) < 0)
            return 0;
    }
    return 1;
}

/*
 * Count along stretches that are far from holes, from the end that costs nothing, if one does. Where faces contradict
 * the count, as they do where parts overlap, the other end is asked too. Returns 0 if that contradicts: then nothing is
 * known.
 */
static int count(struct distance_profile *profile, uint32_t first, uint32_t last)
{
    int32_t *winding = profile->winding;
    const int is_backward = last == profile->crossing_count && is_outside_of_box(profile, 1.0);
    const uint32_t begin = is_backward ? last : first, end = is_backward ? first : last;
    winding[begin] = ask(profile, begin);
    for (uint32_t k = begin; k != end;) {
        const struct crossing *crossing = &profile->crossing[is_backward ? k - 1 : k];
        const uint32_t next = is_backward ? k - 1 : k + 1;
        winding[next] = !crossing->is_counted ? ask(profile, next)
                        : is_backward         ? winding[k] - crossing->winding
                                              : winding[k] + crossing->winding;
        k = next;
    }
    return begin == end || faces_agree(profile, first, last) || winding[end] == ask(profile, end);
}

/* A part of a stretch that is far from holes joins the range before it, of those from `first` on, or asks. */
static void put_range(struct distance_profile *profile, double from, double to, uint32_t first)
{
    const uint32_t count = profile->winding_range_count;
    if (count > first && profile->winding_range[count - 1].to == from) {
        profile->winding_range[count - 1].to = to;
    } else if (count < PROFILE_WINDING_RANGES) {
        const int32_t winding = dpti_profile_winding(profile, 0.5 * (from + to));
        profile->winding_range[count] = (struct winding_range){ from, to, winding, 0 };
        profile->winding_range_count++;
    }
}

/* Find the ranges of a part of a stretch that is near holes: its halves, down to so many levels. */
static void put_ranges(struct distance_profile *profile, double from, double to, uint32_t first, int levels)
{
    const double middle = 0.5 * (from + to), ends[3] = { from, middle, to };
    for (int i = 0; i < 2; i++)
        if (is_far_from_holes(profile, ends[i], ends[i + 1]))
            put_range(profile, ends[i], ends[i + 1], first);
        else if (levels)
            put_ranges(profile, ends[i], ends[i + 1], first, levels - 1);
}

int dpti_stretch_windings_find(struct distance_profile *profile)
{
    int are_known = 1;
    profile->winding_range_count = 0;
    for (uint32_t first = 0, end = 0; first <= profile->crossing_count; first = end) {
        while (end <= profile->crossing_count &&
               is_far_from_holes(profile, start_of(profile, end), end_of(profile, end)))
            end++;
        if (end > first && count(profile, first, end - 1))
            continue;
        if (end == first) {
            put_ranges(profile, start_of(profile, end), end_of(profile, end), profile->winding_range_count, HALVINGS);
            end++;
        }
        are_known = 0;
        for (uint32_t k = first; k < end; k++)
            profile->winding[k] = WINDING_UNKNOWN;
    }
    return are_known;
}
