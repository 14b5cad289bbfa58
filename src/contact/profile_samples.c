/* SPDX-License-Identifier: BSD-3-Clause */
#include "contact/profile_samples.h"

#include <string.h>

#include "contact/winding_number.h"
#include "nearest/bvh.h"

/* The set of a point. The hash is the same on every machine: it decides what the cache still holds, and so the work. */
static struct cached_point *set_of(const struct point_cache *cache, uint32_t body, vec3 x)
{
    const double at[3] = { x.x, x.y, x.z };
    uint64_t hash = body;
    for (int k = 0; k < 3; k++) {
        uint64_t bits;
        memcpy(&bits, &at[k], sizeof bits);
        hash = (hash ^ bits) * 0x9e3779b97f4a7c15u;
        hash ^= hash >> 32;
    }
    return cache->entries + POINT_CACHE_WAYS * (size_t)(hash % cache->sets);
}

static int is_same(vec3 a, vec3 b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

static int is_entry_of(const struct cached_point *entry, uint32_t body, vec3 x)
{
    return entry->body == body + 1 && is_same(entry->x, x);
}

/* Move entry `index` of a set to the front, the ones before it back by one, and mark it as used in this tick. */
static struct cached_point *move_to_front(const struct point_cache *cache, struct cached_point *set, int index)
{
    struct cached_point entry = set[index];
    memmove(set + 1, set, (size_t)index * sizeof *set);
    entry.tick = cache->tick;
    set[0] = entry;
    return set;
}

const struct cached_point *dpti_point_cache_find(const struct point_cache *cache, uint32_t body, vec3 x)
{
    struct cached_point *set = set_of(cache, body, x);
    for (int i = 0; i < POINT_CACHE_WAYS; i++)
        if (is_entry_of(&set[i], body, x))
            return move_to_front(cache, set, i);
    return NULL;
}

struct cached_point *dpti_point_cache_put(const struct point_cache *cache, uint32_t body, vec3 x)
{
    struct cached_point *set = set_of(cache, body, x);
    for (int i = 0; i < POINT_CACHE_WAYS; i++)
        if (is_entry_of(&set[i], body, x))
            return move_to_front(cache, set, i);
    const struct cached_point *oldest = &set[POINT_CACHE_WAYS - 1];
    if (oldest->body && oldest->tick == cache->tick)
        return NULL;
    move_to_front(cache, set, POINT_CACHE_WAYS - 1);
    set[0] = (struct cached_point){
        .x = x, .body = body + 1, .triangle = DPT_NONE, .descent = DPT_NONE, .tick = cache->tick
    };
    return set;
}

int dpti_point_cache_resume(const struct point_cache *cache, uint32_t body, vec3 x, uint32_t *triangle,
                            struct bvh_traversal *traversal)
{
    if (cache->body != body + 1 || !is_same(cache->x, x))
        return 0;
    *triangle = cache->triangle;
    *traversal = cache->traversal;
    return 1;
}

void dpti_point_cache_suspend(struct point_cache *cache, uint32_t body, vec3 x, uint32_t triangle,
                              const struct bvh_traversal *traversal)
{
    cache->body = body + 1;
    cache->x = x;
    cache->triangle = triangle;
    cache->traversal = *traversal;
}

void dpti_point_cache_forget(struct point_cache *cache, uint32_t body)
{
    for (size_t i = 0; i < POINT_CACHE_WAYS * (size_t)cache->sets; i++)
        if (body == DPT_NONE || cache->entries[i].body == body + 1)
            cache->entries[i].body = 0;
    if (body == DPT_NONE || cache->body == body + 1)
        cache->body = 0;
}

/* ---- samples ---- */

double dpti_profile_distance_to(const struct distance_profile *profile, uint32_t triangle, double s)
{
    const struct surface *surface = profile->surface;
    const uint32_t *corner = surface->corners + 3 * (size_t)triangle;
    return point_distance_upper(profile_point(profile, s), vec3_of_float(surface->positions + 3 * (size_t)corner[0]),
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

vec3 dpti_profile_exit_direction(const struct distance_profile *profile, uint32_t triangle, const double weight[3])
{
    uint32_t part = surface_part(profile->surface, triangle);
    vec3 normal = dpti_surface_feature_normal(profile->surface, triangle, weight);
    double normal_length = length(normal);
    double side = dpti_sides_get(profile->sides, part);
    if (side == 0.0 && (surface_part_flags(profile->surface, part) & MESH_PART_SOLID))
        side = 1.0;
    return normal_length > 0.0 ? scaled(normal, side / normal_length) : (vec3){ 0.0, 0.0, 0.0 };
}

int32_t dpti_profile_winding(struct distance_profile *profile, double s)
{
    const struct surface *surface = profile->surface;
    vec3 x = profile_point(profile, s);
    if (!surface_box_holds(surface, x))
        return 0;
    const struct cached_point *cached =
        profile->point_cache ? dpti_point_cache_find(profile->point_cache, profile->body, x) : NULL;
    if (cached && cached->has_winding)
        return cached->winding;
    double winding = HUGE_VAL;
    if (!work_is_spent(&profile->work))
        winding = dpti_winding_number(profile->surface, profile->kernel, x, &profile->work);
    if (winding == HUGE_VAL) {
        profile->is_cut = 1;
        return 0;
    }
    const int32_t rounded = (int32_t)-floor(0.5 - winding);
    struct cached_point *entry =
        profile->point_cache ? dpti_point_cache_put(profile->point_cache, profile->body, x) : NULL;
    if (entry) {
        entry->winding = rounded;
        entry->has_winding = 1;
    }
    return rounded;
}

/* The winding number of the stretch, or the part of a stretch, that holds s; or WINDING_UNKNOWN. */
static int32_t known_winding(const struct distance_profile *profile, double s)
{
    int32_t winding = profile->winding[profile_stretch(profile, s)];
    for (uint32_t i = 0; i < profile->winding_range_count && winding == WINDING_UNKNOWN; i++)
        if (s >= profile->winding_range[i].from && s <= profile->winding_range[i].to)
            winding = profile->winding_range[i].winding;
    return winding;
}

int dpti_profile_is_inside(struct distance_profile *profile, double s)
{
    const int32_t known = profile->has_windings ? known_winding(profile, s) : WINDING_UNKNOWN;
    return (known != WINDING_UNKNOWN ? known : dpti_profile_winding(profile, s)) > 0;
}

int dpti_profile_side_of(struct distance_profile *profile, double s, uint32_t triangle, const pair *found)
{
    uint32_t part = surface_part(profile->surface, triangle), flags = surface_part_flags(profile->surface, part);
    int side = dpti_sides_get(profile->sides, part);
    if (side && dpti_side_is_border(profile->surface, triangle, found->weight))
        return 1;
    if (side)
        return side * dpti_side_of_pair(profile->surface, triangle, found);
    const struct holes *holes = profile->surface->holes;
    const int is_told_by_normal = holes && holes->normals_tell && !profile->has_winding_parts &&
                                  dpti_holes_are_beyond(holes, profile_point(profile, s), sqrt(found->distance2));
    if ((flags & MESH_PART_WINDING) && !is_told_by_normal)
        return dpti_profile_is_inside(profile, s) ? -1 : 1;
    if (flags & MESH_PART_BURIED)
        return -1;
    return flags & MESH_PART_SOLID ? dpti_side_of_pair(profile->surface, triangle, found) : 1;
}

/* 1: work is left for a search. If not, the profile is cut. */
static int has_work_left(struct distance_profile *profile)
{
    profile->is_cut |= (uint32_t)work_is_spent(&profile->work);
    return !work_is_spent(&profile->work);
}

/* Make a triangle, a place, the nearest to x, in the body's frame. Returns 0 if the one in *nearest is nearer. */
static int take_if_nearer(const struct distance_profile *profile, vec3 x, uint32_t triangle,
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

/* Search for the nearest triangle of x, in the body's frame, from the one in *nearest; or take it from the cache. */
static void search_point(struct distance_profile *profile, vec3 x, struct pair_search *nearest)
{
    struct point_cache *cache = profile->point_cache;
    const struct cached_point *cached = cache ? dpti_point_cache_find(cache, profile->body, x) : NULL;
    struct bvh_traversal traversal;
    uint32_t triangle;
    traversal.level = 0;
    if (cached && cached->triangle != DPT_NONE) {
        take_if_nearer(profile, x, cached->triangle, nearest);
        return;
    }
    if (!has_work_left(profile))
        return;
    if (cache && dpti_point_cache_resume(cache, profile->body, x, &triangle, &traversal))
        take_if_nearer(profile, x, triangle, nearest);
    int is_done = dpti_point_search(profile->surface, profile->kernel, x, &traversal, &profile->work, nearest);
    profile->is_cut |= !is_done;
    if (cache && !is_done)
        dpti_point_cache_suspend(cache, profile->body, x, nearest->triangle, &traversal);
    struct cached_point *entry = cache && is_done ? dpti_point_cache_put(cache, profile->body, x) : NULL;
    if (entry)
        entry->triangle = nearest->triangle;
}

/*
 * Descend from the triangle in *nearest. The cache holds the end of the first descent to each point, so that the next
 * tick gets the same answer, and all that follows from it.
 */
static void descend_to_point(struct distance_profile *profile, const struct axis *point, struct pair_search *nearest)
{
    struct cached_point *entry =
        profile->point_cache ? dpti_point_cache_put(profile->point_cache, profile->body, point->local_a) : NULL;
    int is_continued =
        entry && entry->descent != DPT_NONE && take_if_nearer(profile, point->local_a, entry->descent, nearest);
    if (!has_work_left(profile))
        return;
    dpti_dynamic_point_descend(profile->surface, point, &profile->work, nearest);
    profile->is_cut |= (uint32_t)work_is_spent(&profile->work);
    if (entry && (is_continued || entry->descent == DPT_NONE))
        entry->descent = nearest->triangle;
}

/* Find the nearest triangle of a point, by search or by descent, as far as there is work left. */
static void find_nearest(struct distance_profile *profile, const struct axis *point, int by_search,
                         struct pair_search *nearest)
{
    if (by_search)
        search_point(profile, point->local_a, nearest);
    else
        descend_to_point(profile, point, nearest);
}

void dpti_profile_take_sample(struct distance_profile *profile, double s, uint32_t triangle, int by_search,
                              struct profile_sample *sample)
{
    struct axis point;
    struct pair_search nearest;
    point.local_a = profile_point(profile, s);
    point.u = (vec3){ 0.0, 0.0, 0.0 };
    point.error = profile->axis->error;
    pair_search_begin(&nearest, triangle);
    dpti_triangle_point_pair(profile->surface, triangle, point.local_a, &nearest.pair);
    find_nearest(profile, &point, by_search, &nearest);
    const pair *found = &nearest.pair;
    double distance = sqrt(found->distance2);
    int sign = profile->sign[profile_stretch(profile, s)];
    if (!sign)
        sign = dpti_profile_side_of(profile, s, nearest.triangle, found);
    vec3 normal = distance > 1e3 * point.error ? scaled(found->gap, sign / distance)
                                               : dpti_profile_exit_direction(profile, nearest.triangle, found->weight);
    sample->s = s;
    sample->height = sign * distance;
    sample->normal = normal;
    sample->slope = dot(normal, profile->axis->u);
    sample->gap = found->gap;
    memcpy(sample->weight, found->weight, sizeof sample->weight);
    sample->triangle = nearest.triangle;
    sample->start_triangle = triangle;
    sample->is_exact = (uint32_t)by_search;
    sample->is_proven = sample->has_depth_bound = sample->has_span = 0;
}

/* Note that sample i and the span before it have changed. */
static void mark_changed(struct distance_profile *profile, uint32_t i)
{
    if (i < profile->unchanged_count)
        profile->unchanged_count = i;
}

/*
 * Make room for a sample: of those between two others with their own triangle, which show least, drop the one whose
 * neighbours are nearest to each other. Returns 0 if there is none.
 */
static int drop_sample(struct distance_profile *profile)
{
    double min_width = HUGE_VAL;
    uint32_t dropped = DPT_NONE;
    for (uint32_t i = 1; i + 1 < profile->sample_count; i++) {
        const struct profile_sample *sample = &profile->sample[i];
        double width = sample[1].s - sample[-1].s;
        if (sample[-1].triangle == sample->triangle && sample[1].triangle == sample->triangle &&
            i != profile->deepest && !sample->is_proven && sample->height != 0.0 && width < min_width) {
            min_width = width;
            dropped = i;
        }
    }
    if (dropped == DPT_NONE)
        return 0;
    struct profile_sample *here = &profile->sample[dropped];
    here[-1].has_depth_bound = here[-1].has_span = 0;
    mark_changed(profile, dropped);
    profile->sample_count--;
    memmove(here, here + 1, (profile->sample_count - dropped) * sizeof *here);
    profile->deepest -= profile->deepest > dropped;
    return 1;
}

uint32_t dpti_profile_put_sample(struct distance_profile *profile, const struct profile_sample *sample)
{
    uint32_t i = profile->sample_count;
    while (i > 0 && profile->sample[i - 1].s >= sample->s)
        i--;
    struct profile_sample *here = &profile->sample[i];
    if (i < profile->sample_count && here->s == sample->s) {
        mark_changed(profile, i);
        if (i)
            here[-1].has_depth_bound = here[-1].has_span = 0;
        uint32_t start_triangle = here->start_triangle;
        if (sample->is_exact || !here->is_exact)
            *here = *sample;
        here->start_triangle = start_triangle;
        here->has_depth_bound = here->has_span = 0;
        return i;
    }
    if (profile->sample_count == PROFILE_SAMPLES)
        return drop_sample(profile) ? dpti_profile_put_sample(profile, sample) : DPT_NONE;
    if (i)
        here[-1].has_depth_bound = here[-1].has_span = 0;
    mark_changed(profile, i);
    memmove(here + 1, here, (profile->sample_count - i) * sizeof *here);
    *here = *sample;
    profile->sample_count++;
    profile->deepest += i <= profile->deepest;
    return i;
}

/* The place of the triangle of the nearest sample to s, from which to start; 0 if there is none. */
static uint32_t triangle_beside(const struct distance_profile *profile, double s)
{
    const struct profile_sample *sample = profile->sample;
    uint32_t right = 0;
    while (right < profile->sample_count && sample[right].s < s)
        right++;
    uint32_t left = right;
    while (right < profile->sample_count && sample[right].triangle == DPT_NONE)
        right++;
    while (left > 0 && sample[left - 1].triangle == DPT_NONE)
        left--;
    if (left > 0 && (right == profile->sample_count || s - sample[left - 1].s <= sample[right].s - s))
        return sample[left - 1].triangle;
    return right < profile->sample_count ? sample[right].triangle : 0;
}

int dpti_profile_share_triangle(struct distance_profile *profile, uint32_t i, const struct profile_sample *other)
{
    struct profile_sample *sample = &profile->sample[i];
    const double distance = fabs(sample->height);
    if (sample->is_exact || sample->triangle == DPT_NONE || sample->triangle == other->triangle ||
        profile_tangent_distance(other, sample->s) >= distance ||
        !(dpti_profile_distance_to(profile, other->triangle, sample->s) < distance))
        return 0;
    struct profile_sample improved;
    dpti_profile_take_sample(profile, sample->s, other->triangle, 0, &improved);
    if (profile->is_cut)
        return 0;
    dpti_profile_put_sample(profile, &improved);
    return 1;
}

uint32_t dpti_profile_add_sample(struct distance_profile *profile, double s, int by_search)
{
    struct profile_sample sample;
    dpti_profile_take_sample(profile, s, triangle_beside(profile, s), by_search, &sample);
    uint32_t index = profile->is_cut ? DPT_NONE : dpti_profile_put_sample(profile, &sample);
    if (index == DPT_NONE)
        return index;
    for (uint32_t i = index; i > 0 && dpti_profile_share_triangle(profile, i - 1, &sample); i--)
        ;
    for (uint32_t i = index + 1; i < profile->sample_count && dpti_profile_share_triangle(profile, i, &sample); i++)
        ;
    return index;
}

uint32_t dpti_profile_add_nearest(struct distance_profile *profile, double from, double to, double limit)
{
    const struct axis *axis = profile->axis;
    struct axis piece = { .local_a = profile_point(profile, from),
                          .u = scaled(axis->u, to - from),
                          .error = axis->error };
    struct pair_search nearest;
    pair_search_begin(&nearest, DPT_NONE);
    nearest.pair.distance2 = limit * limit;
    if (has_work_left(profile)) {
        profile->is_cut |=
            !dpti_bvh_search(profile->surface, profile->kernel, piece.local_a, piece.u, &profile->work, &nearest);
    }
    if (nearest.triangle == DPT_NONE || profile->is_cut)
        return DPT_NONE;
    struct profile_sample sample;
    dpti_profile_take_sample(profile, from + nearest.pair.s * (to - from), nearest.triangle, 0, &sample);
    sample.is_exact = 1;
    return dpti_profile_put_sample(profile, &sample);
}

const struct profile_sample *dpti_profile_lowest_on(const struct distance_profile *profile, uint32_t part)
{
    const struct profile_sample *lowest = NULL;
    for (uint32_t i = 0; i < profile->sample_count; i++) {
        const struct profile_sample *sample = &profile->sample[i];
        if (sample->height < (lowest ? lowest->height : 0.0) &&
            surface_part(profile->surface, sample->triangle) == part)
            lowest = sample;
    }
    return lowest;
}
