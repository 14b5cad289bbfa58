/* SPDX-License-Identifier: BSD-3-Clause */
#include "track/sheet_sides.h"

/* m: a tool that is deeper behind a sheet loses its side. */
static double side_limit(const struct contact_pair *contact_pair)
{
    double limit = contact_pair->body->side_limit;
    return limit > 0.0 ? limit : 0.25 * surface_diagonal(&contact_pair->body->surface);
}

int32_t dpti_sheet_side_to_keep(const struct contact_pair *contact_pair, const struct region *region, double gap)
{
    const struct surface *surface = &contact_pair->body->surface;
    const struct profile_sample *deepest = &contact_pair->profile->sample[region->deepest];
    if (!dpti_side_is_sheet(surface, region->part) || -gap > side_limit(contact_pair) ||
        dpti_side_is_border(surface, deepest->triangle, deepest->weight))
        return 0;
    int32_t kept_side = dpti_sides_get(&contact_pair->sides, region->part);
    if (kept_side || deepest->height == 0.0)
        return kept_side;
    const pair deepest_pair = { .weight = { deepest->weight[0], deepest->weight[1], deepest->weight[2] },
                                .gap = deepest->gap };
    return dpti_side_of_pair(surface, deepest->triangle, &deepest_pair);
}

void dpti_sheet_update_side(const struct contact_pair *contact_pair, struct persistent_contact *persistent)
{
    const struct surface *surface = &contact_pair->body->surface;
    const struct pair_search *nearest = &contact_pair->nearest;
    const double *weight = nearest->pair.weight;
    if (!persistent->side || nearest->pair.distance2 == 0.0 ||
        surface_part(surface, nearest->triangle) != persistent->part)
        return;
    int is_border = dpti_side_is_border(surface, nearest->triangle, weight);
    int is_in_front = persistent->side * dpti_side_of_pair(surface, nearest->triangle, &nearest->pair) > 0;
    if (is_border ? !dpti_profile_lowest_on(contact_pair->profile, persistent->part)
                  : persistent->is_in_front && !is_in_front)
        persistent->side = 0;
    else if (!is_border)
        persistent->is_in_front = (uint32_t)is_in_front;
}

int dpti_sheet_drop_sides(struct contact_pair *contact_pair, const struct region *regions, uint32_t count)
{
    struct sides *sides = &contact_pair->sides, kept_sides = { .count = 0 };
    double limit = side_limit(contact_pair) - contact_pair->radius;
    for (uint32_t k = 0; k < sides->count; k++) {
        int is_too_deep = 0;
        for (uint32_t i = 0; i < count; i++)
            is_too_deep |=
                regions[i].part == sides->part[k] && -contact_pair->profile->sample[regions[i].deepest].height > limit;
        if (!is_too_deep)
            dpti_sides_put(&kept_sides, sides->part[k], sides->side[k]);
    }
    int has_dropped = kept_sides.count < sides->count;
    *sides = kept_sides;
    return has_dropped;
}

int dpti_sheet_still_pushes(const struct contact_pair *contact_pair, uint32_t part)
{
    const struct distance_profile *profile = contact_pair->profile;
    const struct profile_sample *deepest = &profile->sample[profile->deepest];
    return dpti_sides_get(&contact_pair->sides, part) &&
           (deepest->height <= 0.0 || !dpti_side_is_border(profile->surface, deepest->triangle, deepest->weight));
}
