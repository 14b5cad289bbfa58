/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/sheet_sides.h"

/* Deeper than that a tool is no longer behind the sheet that it came through. */
static double side_limit(const struct meeting *meeting)
{
    double limit = meeting->body->side_limit;
    return limit > 0.0 ? limit : 0.25 * dpti_surface_diagonal(&meeting->body->surface);
}

int32_t dpti_sheet_side_of_region(const struct meeting *meeting, const struct region *region,
                                  double gap)
{
    const struct surface *surface = &meeting->body->surface;
    const struct sample *deepest = &meeting->profile->sample[region->deepest];
    if (!dpti_side_is_sheet(surface, region->part) || -gap > side_limit(meeting) ||
        dpti_side_is_border(surface, deepest->triangle, deepest->weight))
        return 0;
    int32_t kept = dpti_sides_get(&meeting->sides, region->part);
    if (kept || deepest->height == 0.0)
        return kept;
    const pair found = { .weight = { deepest->weight[0], deepest->weight[1], deepest->weight[2] },
                         .gap = deepest->gap };
    return dpti_side_of_pair(surface, deepest->triangle, &found);
}

void dpti_sheet_keep_side(const struct meeting *meeting, struct hold *hold)
{
    const struct surface *surface = &meeting->body->surface;
    const struct pair_search *nearest = &meeting->nearest;
    const double *weight = nearest->pair.weight;
    if (!hold->side || nearest->pair.distance2 == 0.0 ||
        surface_part(surface, nearest->triangle) != hold->part)
        return;
    int border = dpti_side_is_border(surface, nearest->triangle, weight);
    int front = hold->side * dpti_side_of_pair(surface, nearest->triangle, &nearest->pair) > 0;
    if (border ? !dpti_profile_lowest_on(meeting->profile, hold->part) : hold->front && !front)
        hold->side = 0;
    else if (!border)
        hold->front = (uint32_t)front;
}

int dpti_sheet_drop_sides(struct meeting *meeting, const struct region *regions, uint32_t count)
{
    struct sides *sides = &meeting->sides, kept = { .count = 0 };
    double limit = side_limit(meeting) - meeting->radius;
    for (uint32_t k = 0; k < sides->count; k++) {
        int deep = 0;
        for (uint32_t i = 0; i < count; i++)
            deep |= regions[i].part == sides->part[k] &&
                    -meeting->profile->sample[regions[i].deepest].height > limit;
        if (!deep)
            dpti_sides_put(&kept, sides->part[k], sides->side[k]);
    }
    int dropped = kept.count < sides->count;
    *sides = kept;
    return dropped;
}

int dpti_sheet_keeps_push(const struct meeting *meeting, uint32_t part)
{
    const struct profile *profile = meeting->profile;
    const struct sample *deepest = &profile->sample[profile->deepest];
    return dpti_sides_get(&meeting->sides, part) &&
           (deepest->height <= 0.0 ||
            !dpti_side_is_border(profile->surface, deepest->triangle, deepest->weight));
}
