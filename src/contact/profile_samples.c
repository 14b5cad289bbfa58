/* SPDX-License-Identifier: BSD-3-Clause */
#include "contact/profile_samples.h"

#include "contact/winding_number.h"
#include "nearest/point_search.h"

double dpti_profile_reach(const struct distance_profile *profile, uint32_t triangle, double s)
{
    const struct surface *surface = profile->surface;
    const uint32_t *corner = surface->corners + 3 * (size_t)triangle;
    return point_distance_upper(profile_point(profile, s),
                                vec3_of_float(surface->positions + 3 * (size_t)corner[0]),
                                vec3_of_float(surface->positions + 3 * (size_t)corner[1]),
                                vec3_of_float(surface->positions + 3 * (size_t)corner[2]));
}

int32_t dpti_sides_get(const struct sides *sides, uint32_t part)
{
    for (uint32_t i = 0; i < sides->count; i++)
        if (sides->part[i] == part)
            return sides->side[i];
    return 0;
}

void dpti_sides_put(struct sides *sides, uint32_t part, int32_t side)
{
    if (sides->count == SIDES_MAX || dpti_sides_get(sides, part))
        return;
    sides->part[sides->count] = part;
    sides->side[sides->count++] = side;
}

vec3 dpti_profile_exit_direction(const struct distance_profile *profile, uint32_t triangle,
                                 const double weight[3])
{
    uint32_t part = surface_part(profile->surface, triangle);
    vec3 normal = dpti_surface_feature_normal(profile->surface, triangle, weight);
    double size = length(normal);
    double side = dpti_sides_get(profile->sides, part);
    if (side == 0.0 && (surface_part_flags(profile->surface, part) & MESH_PART_SOLID))
        side = 1.0;
    return size > 0.0 ? scaled(normal, side / size) : (vec3){ 0.0, 0.0, 0.0 };
}

int dpti_profile_is_inside(struct distance_profile *profile, double s)
{
    const struct surface *surface = profile->surface;
    vec3 x = profile_point(profile, s);
    if (x.x < surface->box_min.x || x.y < surface->box_min.y || x.z < surface->box_min.z ||
        x.x > surface->box_max.x || x.y > surface->box_max.y || x.z > surface->box_max.z)
        return 0;
    const struct cached_point *known =
        profile->point_cache ? dpti_point_cache_find(profile->point_cache, profile->body, x) : NULL;
    if (known && known->side)
        return known->side < 0;
    double winding = HUGE_VAL;
    if (!work_is_spent(&profile->work))
        winding = dpti_winding_number(profile->surface, profile->kernel, x, &profile->work);
    profile->cut |= winding == HUGE_VAL;
    struct cached_point *entry = profile->point_cache && winding != HUGE_VAL
                                     ? dpti_point_cache_put(profile->point_cache, profile->body, x)
                                     : NULL;
    if (entry)
        entry->side = winding > 0.5 ? -1 : 1;
    return winding > 0.5;
}

int dpti_profile_side_of(struct distance_profile *profile, double s, uint32_t triangle,
                         const pair *found)
{
    uint32_t part = surface_part(profile->surface, triangle),
             flags = surface_part_flags(profile->surface, part);
    int kept = dpti_sides_get(profile->sides, part);
    if (kept && dpti_side_is_border(profile->surface, triangle, found->weight))
        return 1;
    if (kept)
        return kept * dpti_side_of_pair(profile->surface, triangle, found);
    if (flags & MESH_PART_WINDING)
        return dpti_profile_is_inside(profile, s) ? -1 : 1;
    if (flags & MESH_PART_BURIED)
        return -1;
    return flags & MESH_PART_SOLID ? dpti_side_of_pair(profile->surface, triangle, found) : 1;
}

/* There is work left for a search. */
static int may_begin(struct distance_profile *profile)
{
    profile->cut |= (uint32_t)work_is_spent(&profile->work);
    return !work_is_spent(&profile->work);
}

/* A triangle that was found before, unless another is nearer: then 0. */
static int take_nearer(const struct distance_profile *profile, vec3 x, uint32_t triangle,
                       struct pair_search *nearest)
{
    pair found;
    dpti_triangle_point_pair(profile->surface, triangle, x, &found);
    if (found.distance2 > nearest->pair.distance2)
        return 0;
    nearest->pair = found;
    nearest->triangle = triangle;
    return 1;
}

static void search(struct distance_profile *profile, vec3 x, struct pair_search *nearest)
{
    struct point_cache *cache = profile->point_cache;
    const struct cached_point *known =
        cache ? dpti_point_cache_find(cache, profile->body, x) : NULL;
    struct bvh_traversal traversal;
    uint32_t triangle;
    traversal.depth = 0;
    if (known && known->triangle != DPT_NONE) {
        take_nearer(profile, x, known->triangle, nearest);
        return;
    }
    if (!may_begin(profile))
        return;
    if (cache && dpti_point_cache_resume(cache, profile->body, x, &triangle, &traversal))
        take_nearer(profile, x, triangle, nearest);
    int done = dpti_point_search(profile->surface, profile->kernel, x, &traversal, &profile->work,
                                 nearest);
    profile->cut |= !done;
    if (cache && !done)
        dpti_point_cache_suspend(cache, profile->body, x, nearest->triangle, &traversal);
    struct cached_point *entry =
        cache && done ? dpti_point_cache_put(cache, profile->body, x) : NULL;
    if (entry)
        entry->triangle = nearest->triangle;
}

/* Of the descents to a point the first is kept, so that what follows from it is the same in the next tick. */
static void descend_to(struct distance_profile *profile, const struct axis *point,
                       struct pair_search *nearest)
{
    struct cached_point *entry =
        profile->point_cache
            ? dpti_point_cache_put(profile->point_cache, profile->body, point->local_a)
            : NULL;
    int goes_on = entry && entry->descent != DPT_NONE &&
                  take_nearer(profile, point->local_a, entry->descent, nearest);
    if (!may_begin(profile))
        return;
    dpti_track_descend(profile->surface, point, &profile->work, nearest);
    profile->cut |= (uint32_t)work_is_spent(&profile->work);
    if (entry && (goes_on || entry->descent == DPT_NONE))
        entry->descent = nearest->triangle;
}

/* The nearest triangle of a point, by descent or by search, as far as there is work left for it. */
static void improve(struct distance_profile *profile, const struct axis *point, int exact,
                    struct pair_search *nearest)
{
    if (exact)
        search(profile, point->local_a, nearest);
    else
        descend_to(profile, point, nearest);
}

void dpti_profile_take_sample(struct distance_profile *profile, double s, uint32_t triangle,
                              int exact, struct sample *sample)
{
    struct axis point;
    struct pair_search nearest;
    point.local_a = profile_point(profile, s);
    point.u = (vec3){ 0.0, 0.0, 0.0 };
    point.error = profile->axis->error;
    pair_search_begin(&nearest, triangle);
    dpti_triangle_point_pair(profile->surface, triangle, point.local_a, &nearest.pair);
    improve(profile, &point, exact, &nearest);
    const pair *found = &nearest.pair;
    double distance = sqrt(found->distance2);
    int sign = profile->sign[profile_stretch(profile, s)];
    if (!sign)
        sign = dpti_profile_side_of(profile, s, nearest.triangle, found);
    vec3 normal = distance > 1e3 * point.error
                      ? scaled(found->gap, sign / distance)
                      : dpti_profile_exit_direction(profile, nearest.triangle, found->weight);
    sample->s = s;
    sample->height = sign * distance;
    sample->normal = normal;
    sample->rise = dot(normal, profile->axis->u);
    sample->gap = found->gap;
    memcpy(sample->weight, found->weight, sizeof sample->weight);
    sample->triangle = nearest.triangle;
    sample->was = triangle;
    sample->exact = (uint32_t)exact;
    sample->proven = sample->bounded = sample->spanned = 0;
}

/* Sample i is another, and so is the span before it. */
static void note_change(struct distance_profile *profile, uint32_t i)
{
    if (i < profile->same)
        profile->same = i;
}

/* Make room: of those between two of their own triangle, which tell least, the one whose neighbours are nearest. */
static int drop_sample(struct distance_profile *profile)
{
    double least = HUGE_VAL;
    uint32_t drop = DPT_NONE;
    for (uint32_t i = 1; i + 1 < profile->count; i++) {
        const struct sample *sample = &profile->sample[i];
        double width = sample[1].s - sample[-1].s;
        if (sample[-1].triangle == sample->triangle && sample[1].triangle == sample->triangle &&
            i != profile->deepest && !sample->proven && sample->height != 0.0 && width < least) {
            least = width;
            drop = i;
        }
    }
    if (drop == DPT_NONE)
        return 0;
    struct sample *here = &profile->sample[drop];
    here[-1].bounded = here[-1].spanned = 0;
    note_change(profile, drop);
    profile->count--;
    memmove(here, here + 1, (profile->count - drop) * sizeof *here);
    profile->deepest -= profile->deepest > drop;
    return 1;
}

uint32_t dpti_profile_put_sample(struct distance_profile *profile, const struct sample *sample)
{
    uint32_t i = profile->count;
    while (i > 0 && profile->sample[i - 1].s >= sample->s)
        i--;
    struct sample *here = &profile->sample[i];
    if (i < profile->count && here->s == sample->s) {
        note_change(profile, i);
        if (i)
            here[-1].bounded = here[-1].spanned = 0;
        uint32_t was = here->was;
        if (sample->exact || !here->exact)
            *here = *sample;
        here->was = was;
        here->bounded = here->spanned = 0;
        return i;
    }
    if (profile->count == PROFILE_SAMPLES)
        return drop_sample(profile) ? dpti_profile_put_sample(profile, sample) : DPT_NONE;
    if (i)
        here[-1].bounded = here[-1].spanned = 0;
    note_change(profile, i);
    memmove(here + 1, here, (profile->count - i) * sizeof *here);
    *here = *sample;
    profile->count++;
    profile->deepest += i <= profile->deepest;
    return i;
}

/* Of the sample beside s: where a search begins. */
static uint32_t nearest_triangle(const struct distance_profile *profile, double s)
{
    const struct sample *sample = profile->sample;
    uint32_t right = 0;
    while (right < profile->count && sample[right].s < s)
        right++;
    uint32_t left = right;
    while (right < profile->count && sample[right].triangle == DPT_NONE)
        right++;
    while (left > 0 && sample[left - 1].triangle == DPT_NONE)
        left--;
    if (left > 0 && (right == profile->count || s - sample[left - 1].s <= sample[right].s - s))
        return sample[left - 1].triangle;
    return right < profile->count ? sample[right].triangle : 0;
}

int dpti_profile_share_triangle(struct distance_profile *profile, uint32_t i, uint32_t triangle)
{
    struct sample *sample = &profile->sample[i];
    if (sample->exact || sample->triangle == DPT_NONE || sample->triangle == triangle ||
        !(dpti_profile_reach(profile, triangle, sample->s) < fabs(sample->height)))
        return 0;
    struct sample better;
    dpti_profile_take_sample(profile, sample->s, triangle, 0, &better);
    if (profile->cut)
        return 0;
    dpti_profile_put_sample(profile, &better);
    return 1;
}

uint32_t dpti_profile_add_sample(struct distance_profile *profile, double s, int exact)
{
    struct sample sample;
    dpti_profile_take_sample(profile, s, nearest_triangle(profile, s), exact, &sample);
    uint32_t at = profile->cut ? DPT_NONE : dpti_profile_put_sample(profile, &sample);
    if (at == DPT_NONE)
        return at;
    for (uint32_t i = at; i > 0 && dpti_profile_share_triangle(profile, i - 1, sample.triangle);
         i--)
        ;
    for (uint32_t i = at + 1;
         i < profile->count && dpti_profile_share_triangle(profile, i, sample.triangle); i++)
        ;
    return at;
}

uint32_t dpti_profile_approach(struct distance_profile *profile, double from, double to,
                               double reach)
{
    const struct axis *axis = profile->axis;
    struct axis piece = { .local_a = profile_point(profile, from),
                          .u = scaled(axis->u, to - from),
                          .error = axis->error };
    struct pair_search nearest;
    struct bvh_traversal traversal;
    pair_search_begin(&nearest, DPT_NONE);
    nearest.pair.distance2 = reach * reach;
    traversal.depth = 0;
    if (may_begin(profile)) {
        profile->cut |= !dpti_bvh_traverse(profile->surface, profile->kernel, NULL, piece.local_a,
                                           piece.u, 0.0, &traversal, &profile->work, &nearest);
    }
    if (nearest.triangle == DPT_NONE || profile->cut)
        return DPT_NONE;
    struct sample sample;
    dpti_profile_take_sample(profile, from + nearest.pair.s * (to - from), nearest.triangle, 0,
                             &sample);
    sample.exact = 1;
    return dpti_profile_put_sample(profile, &sample);
}

const struct sample *dpti_profile_lowest_on(const struct distance_profile *profile, uint32_t part)
{
    const struct sample *lowest = NULL;
    for (uint32_t i = 0; i < profile->count; i++) {
        const struct sample *sample = &profile->sample[i];
        if (sample->height < (lowest ? lowest->height : 0.0) &&
            surface_part(profile->surface, sample->triangle) == part)
            lowest = sample;
    }
    return lowest;
}
