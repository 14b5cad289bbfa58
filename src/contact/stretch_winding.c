/* SPDX-License-Identifier: BSD-3-Clause */
#include "contact/stretch_winding.h"

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

static int is_far_from_holes(const struct distance_profile *profile, uint32_t k)
{
    const double from = start_of(profile, k), to = end_of(profile, k);
    return dpti_holes_are_far_from(profile->surface->holes, profile_point(profile, from),
                                   scaled(profile->axis->u, to - from));
}

/* By a winding number on the stretch: at an end of the axis where that is outside of the mesh's box, or in the middle. */
static int32_t ask(struct distance_profile *profile, uint32_t k)
{
    const double from = start_of(profile, k), to = end_of(profile, k);
    const int is_free = (from == 0.0 && is_outside_of_box(profile, 0.0)) ||
                        (to == 1.0 && is_outside_of_box(profile, 1.0));
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

int dpti_stretch_windings_find(struct distance_profile *profile)
{
    int are_known = 1;
    for (uint32_t first = 0; first <= profile->crossing_count;) {
        uint32_t end = first;
        while (end <= profile->crossing_count && is_far_from_holes(profile, end))
            end++;
        if (end == first || !count(profile, first, end - 1)) {
            end += end == first;
            are_known = 0;
            for (uint32_t k = first; k < end; k++)
                profile->winding[k] = WINDING_UNKNOWN;
        }
        first = end;
    }
    return are_known;
}
