/* SPDX-License-Identifier: BSD-3-Clause */
#include "contact/gap.h"

int dpti_contact_find(struct distance_profile *profile, const struct pair_search *nearest,
                      const struct warm_start *warm_starts, uint32_t warm_start_count, double radius, double *gap)
{
    *gap = sqrt(nearest->pair.distance2) - radius;
    if (!dpti_profile_make(profile, nearest, warm_starts, warm_start_count))
        return CONTACT_NONE;
    if (profile->is_full || profile->is_cut || profile->is_sideless)
        return CONTACT_UNKNOWN;
    if (profile->sample[profile->deepest].height < 0.0)
        *gap = profile->sample[profile->deepest].height - radius;
    return CONTACT_PROFILE;
}

uint32_t dpti_contact_why_unknown(const struct distance_profile *profile)
{
    return (profile->is_cut ? DPT_HIT_FLAG_BUDGET : 0u) | (profile->is_sideless ? DPT_HIT_FLAG_NO_SIDE : 0u) |
           (profile->is_full ? DPT_HIT_FLAG_CROSSINGS_FULL : 0u);
}

vec3 dpti_contact_normal(const struct distance_profile *profile, const struct profile_sample *sample, uint32_t smooth)
{
    if (!smooth)
        return sample->normal;
    vec3 normal = dpti_surface_smooth_normal(profile->surface, sample->triangle, sample->weight);
    double agreement = dot(normal, sample->normal);
    return agreement != 0.0 ? scaled(normal, agreement < 0.0 ? -1.0 : 1.0) : sample->normal;
}

struct penetration dpti_contact_penetration(const struct distance_profile *profile, const struct frame *body,
                                            double gap, uint32_t smooth)
{
    const struct axis *axis = profile->axis;
    const struct profile_sample *deepest = &profile->sample[profile->deepest];
    return (struct penetration){ frame_turn(body, dpti_contact_normal(profile, deepest, smooth)),
                                 along(axis->a, deepest->s, sub(axis->b, axis->a)), max_of(0.0, -gap) };
}

void dpti_contact_of(const struct surface *surface, const struct kernel *kernel, const struct axis *axis,
                     const struct pair_search *nearest, double radius, struct segment_result *result)
{
    const struct sides no_sides = { .count = 0 };
    struct distance_profile profile;
    double gap;
    profile.surface = surface;
    profile.kernel = kernel;
    profile.axis = axis;
    profile.sides = &no_sides;
    profile.point_cache = NULL;
    profile.contacts_wanted = profile.ends_wanted = 0;
    profile.reach = radius;
    profile.tolerance = PROFILE_DEPTH_SHARE * surface_diagonal(surface);
    profile.work = work_of(WORK_UNLIMITED);
    if (dpti_contact_find(&profile, nearest, NULL, 0, radius, &gap) != CONTACT_UNKNOWN)
        dpti_segment_result_set_gap(result, gap, result->error_bound);
    else
        result->unknown = dpti_contact_why_unknown(&profile);
}
