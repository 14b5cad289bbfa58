/* SPDX-License-Identifier: BSD-3-Clause */
#include "contact/distance_profile.h"

#include "contact/winding_number.h"
#include "nearest/point_search.h"

double profile_reach(const struct profile *profile, uint32_t triangle, double s)
{
    const struct surface *surface = profile->surface;
    const uint32_t *corner = surface->corners + 3 * (size_t)triangle;
    return point_reach(profile_point(profile, s),
                       vec3_of_float(surface->positions + 3 * (size_t)corner[0]),
                       vec3_of_float(surface->positions + 3 * (size_t)corner[1]),
                       vec3_of_float(surface->positions + 3 * (size_t)corner[2]));
}

static uint32_t flags_of(const struct profile *profile, uint32_t part)
{
    return surface_part_flags(profile->surface, part);
}

int32_t sides_get(const struct sides *sides, uint32_t part)
{
    for (uint32_t i = 0; i < sides->count; i++)
        if (sides->part[i] == part)
            return sides->side[i];
    return 0;
}

void sides_put(struct sides *sides, uint32_t part, int32_t side)
{
    if (sides->count == SIDES_MOST || sides_get(sides, part))
        return;
    sides->part[sides->count] = part;
    sides->side[sides->count++] = side;
}

vec3 profile_way_out(const struct profile *profile, uint32_t triangle, const double weight[3])
{
    uint32_t part = surface_part(profile->surface, triangle);
    vec3 normal = surface_feature_normal(profile->surface, triangle, weight);
    double size = length(normal);
    double side = sides_get(profile->sides, part);
    if (side == 0.0 && (flags_of(profile, part) & MESH_PART_SOLID))
        side = 1.0;
    return size > 0.0 ? scaled(normal, side / size) : (vec3){ 0.0, 0.0, 0.0 };
}

/* A point outside of the box sees all of the mesh in one half of its view. */
static int is_inside_by_winding(struct profile *profile, double s)
{
    const struct surface *surface = profile->surface;
    vec3 x = profile_point(profile, s);
    if (x.x < surface->box_min.x || x.y < surface->box_min.y || x.z < surface->box_min.z ||
        x.x > surface->box_max.x || x.y > surface->box_max.y || x.z > surface->box_max.z)
        return 0;
    const struct memo_entry *known =
        profile->memo ? memo_find(profile->memo, profile->body, x) : NULL;
    if (known && known->side)
        return known->side < 0;
    double winding = HUGE_VAL;
    if (profile_spare(profile))
        winding = winding_number(profile->surface, profile->kernel, x, profile_spare(profile),
                                 &profile->work);
    profile->cut |= winding == HUGE_VAL;
    struct memo_entry *entry =
        profile->memo && winding != HUGE_VAL ? memo_put(profile->memo, profile->body, x) : NULL;
    if (entry)
        entry->side = winding > 0.5 ? -1 : 1;
    return winding > 0.5;
}

/* Of a point of the axis whose nearest pair this is: +1 outside, -1 inside. */
static int side_of(struct profile *profile, double s, uint32_t triangle, const pair *found)
{
    uint32_t part = surface_part(profile->surface, triangle), flags = flags_of(profile, part);
    int kept = sides_get(profile->sides, part);
    if (kept && side_is_border(profile->surface, triangle, found->weight))
        return 1;
    if (kept)
        return kept * side_of_pair(profile->surface, triangle, found);
    if (flags & MESH_PART_WINDING)
        return is_inside_by_winding(profile, s) ? -1 : 1;
    if (flags & MESH_PART_BURIED)
        return -1;
    return flags & MESH_PART_SOLID ? side_of_pair(profile->surface, triangle, found) : 1;
}

/* Begin a search within what work there is left, or none. */
static int begin(struct profile *profile, struct nearest *nearest)
{
    uint32_t left = profile_spare(profile);
    nearest->most = profile->most == UINT32_MAX ? 0 : left;
    profile->cut |= !left;
    return left > 0;
}

/* A triangle that was found before, unless another is nearer: then 0. */
static int take_nearer(const struct profile *profile, vec3 x, uint32_t triangle,
                       struct nearest *nearest)
{
    pair found;
    tree_point(profile->surface, triangle, x, &found);
    if (found.distance2 > nearest->pair.distance2)
        return 0;
    nearest->pair = found;
    nearest->triangle = triangle;
    return 1;
}

static void search(struct profile *profile, vec3 x, struct nearest *nearest)
{
    struct memo *memo = profile->memo;
    const struct memo_entry *known = memo ? memo_find(memo, profile->body, x) : NULL;
    struct walk walk;
    uint32_t triangle;
    walk.at = 0;
    if (known && known->triangle != DPT_NONE) {
        take_nearer(profile, x, known->triangle, nearest);
        return;
    }
    if (!begin(profile, nearest))
        return;
    if (memo && memo_resume(memo, profile->body, x, &triangle, &walk))
        take_nearer(profile, x, triangle, nearest);
    int done = point_search(profile->surface, profile->kernel, x, &walk, nearest);
    profile->work += nearest->work;
    profile->cut |= !done;
    if (memo && !done)
        memo_pause(memo, profile->body, x, nearest->triangle, &walk);
    struct memo_entry *entry = memo && done ? memo_put(memo, profile->body, x) : NULL;
    if (entry)
        entry->triangle = nearest->triangle;
}

/* Of the descents to a point the first is kept, so that what follows from it is the same in the next tick. */
static void descend(struct profile *profile, const struct axis *point, struct nearest *nearest)
{
    struct memo_entry *entry =
        profile->memo ? memo_put(profile->memo, profile->body, point->local_a) : NULL;
    int goes_on = entry && entry->descent != DPT_NONE &&
                  take_nearer(profile, point->local_a, entry->descent, nearest);
    if (!begin(profile, nearest))
        return;
    track_slide(profile->surface, point, nearest);
    profile->work += nearest->work;
    profile->cut |= nearest->most && nearest->work >= nearest->most;
    if (entry && (goes_on || entry->descent == DPT_NONE))
        entry->descent = nearest->triangle;
}

/* The nearest triangle of a point, by descent or by search, as far as there is work left for it. */
static void improve(struct profile *profile, const struct axis *point, int exact,
                    struct nearest *nearest)
{
    if (exact)
        search(profile, point->local_a, nearest);
    else
        descend(profile, point, nearest);
}

/* From a triangle near a point of the axis, by descent; `exact` by search. What is cached of it is not cleared: flags tell. */
static void take_sample(struct profile *profile, double s, uint32_t triangle, int exact,
                        struct sample *sample)
{
    struct axis point;
    struct nearest nearest;
    point.local_a = profile_point(profile, s);
    point.u = (vec3){ 0.0, 0.0, 0.0 };
    point.error = profile->axis->error;
    nearest_begin(&nearest, triangle);
    tree_point(profile->surface, triangle, point.local_a, &nearest.pair);
    improve(profile, &point, exact, &nearest);
    const pair *found = &nearest.pair;
    double distance = sqrt(found->distance2);
    int sign = profile->sign[profile_stretch(profile, s)];
    if (!sign)
        sign = side_of(profile, s, nearest.triangle, found);
    vec3 normal = distance > 1e3 * point.error
                      ? scaled(found->gap, sign / distance)
                      : profile_way_out(profile, nearest.triangle, found->weight);
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
static void note_change(struct profile *profile, uint32_t i)
{
    if (i < profile->same)
        profile->same = i;
}

/* Make room: of those between two of their own triangle, which tell least, the one whose neighbours are nearest. */
static int drop_sample(struct profile *profile)
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

/* In order of s; of two at one place the exact one, or the newer, stays. Returns its index, or DPT_NONE. */
static uint32_t put_sample(struct profile *profile, const struct sample *sample)
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
        return drop_sample(profile) ? put_sample(profile, sample) : DPT_NONE;
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
static uint32_t nearest_triangle(const struct profile *profile, double s)
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

/* Is the triangle of a new sample nearer to the one at i than its own? Then that one begins there. */
static int tell(struct profile *profile, uint32_t i, uint32_t triangle)
{
    struct sample *sample = &profile->sample[i];
    if (sample->exact || sample->triangle == DPT_NONE || sample->triangle == triangle ||
        !(profile_reach(profile, triangle, sample->s) < fabs(sample->height)))
        return 0;
    struct sample better;
    take_sample(profile, sample->s, triangle, 0, &better);
    if (profile->cut)
        return 0;
    put_sample(profile, &better);
    return 1;
}

uint32_t profile_ask(struct profile *profile, double s, int exact)
{
    struct sample sample;
    take_sample(profile, s, nearest_triangle(profile, s), exact, &sample);
    uint32_t at = profile->cut ? DPT_NONE : put_sample(profile, &sample);
    if (at == DPT_NONE)
        return at;
    for (uint32_t i = at; i > 0 && tell(profile, i - 1, sample.triangle); i--)
        ;
    for (uint32_t i = at + 1; i < profile->count && tell(profile, i, sample.triangle); i++)
        ;
    return at;
}

static int in_zone(const struct profile *profile, double s)
{
    for (uint32_t i = 0; i < profile->zones; i++)
        if (s >= profile->zone_from[i] && s <= profile->zone_to[i])
            return 1;
    return 0;
}

/* Which side each stretch between crossings is on. What its ends do not tell, a search in its middle does. */
static void find_sides(struct profile *profile, const struct nearest *nearest)
{
    for (uint32_t k = 0; k <= profile->crossings; k++)
        profile->sign[k] = 0;
    if (profile_by_sample(profile))
        return;
    if (!profile->crossings) {
        profile->sign[0] = side_of(profile, nearest->pair.s, nearest->triangle, &nearest->pair);
        return;
    }
    for (uint32_t k = 0; k <= profile->crossings; k++) {
        const struct crossing *here = &profile->crossing[k];
        int before = k ? here[-1].after : 0, after = k < profile->crossings ? here->before : 0;
        double from = k ? here[-1].s : 0.0, to = k < profile->crossings ? here->s : 1.0;
        int sign = before ? before : after;
        if (before * after < 0 || !sign) {
            struct sample middle;
            take_sample(profile, 0.5 * (from + to), nearest->triangle, 1, &middle);
            sign = middle.height < 0.0 ? -1 : 1;
        }
        profile->sign[k] = sign;
    }
}

static void put_crossing_samples(struct profile *profile)
{
    for (uint32_t k = 0; k < profile->crossings; k++) {
        const struct crossing *crossing = &profile->crossing[k];
        struct sample sample = {
            .s = crossing->s, .triangle = crossing->triangle, .was = crossing->triangle, .exact = 1
        };
        memcpy(sample.weight, crossing->weight, sizeof sample.weight);
        sample.normal = profile_way_out(profile, crossing->triangle, crossing->weight);
        sample.rise = dot(sample.normal, profile->axis->u);
        put_sample(profile, &sample);
    }
}

/* Through holes an axis comes and goes without a crossing: so there are samples every so often. */
static void put_winding_samples(struct profile *profile)
{
    enum { PIECES = 8 };
    for (int i = 1; i < PIECES && profile->winding; i++) {
        double s = (double)i / PIECES;
        if (!profile->sign[profile_stretch(profile, s)])
            profile_ask(profile, s, 1);
    }
}

/* Stretches that are inside have a sample at an end that is free, and one in the middle. */
static void put_inner_samples(struct profile *profile)
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
            profile_ask(profile, 0.0, 1);
        if (!any && to > from)
            profile_ask(profile, 0.5 * (from + to), 1);
        if (k == profile->crossings && profile->sample[profile->count - 1].s < 1.0)
            profile_ask(profile, 1.0, 1);
    }
}

uint32_t profile_approach(struct profile *profile, double from, double to, double reach)
{
    const struct axis *axis = profile->axis;
    struct axis piece = { .local_a = profile_point(profile, from),
                          .u = scaled(axis->u, to - from),
                          .error = axis->error };
    struct nearest nearest;
    struct walk walk;
    nearest_begin(&nearest, DPT_NONE);
    nearest.pair.distance2 = reach * reach;
    walk.at = 0;
    if (begin(profile, &nearest)) {
        profile->cut |= !tree_walk(profile->surface, profile->kernel, NULL, piece.local_a, piece.u,
                                   0.0, &walk, &nearest);
        profile->work += nearest.work;
    }
    if (nearest.triangle == DPT_NONE || profile->cut)
        return DPT_NONE;
    struct sample sample;
    take_sample(profile, from + nearest.pair.s * (to - from), nearest.triangle, 0, &sample);
    sample.exact = 1;
    return put_sample(profile, &sample);
}

/*
 * An axis that is not within reach: outside as a whole, if its nearest point is. Through a hole in a part an end may be inside,
 * though; what passes two holes between its ends is taken for outside.
 */
static int is_outside(struct profile *profile, const struct nearest *nearest)
{
    if (side_of(profile, nearest->pair.s, nearest->triangle, &nearest->pair) < 0)
        return 0;
    return !profile->winding ||
           !(is_inside_by_winding(profile, 0.0) || is_inside_by_winding(profile, 1.0));
}

int profile_make(struct profile *profile, const struct nearest *nearest, const struct seed *seeds,
                 uint32_t seed_count)
{
    const struct axis *axis = profile->axis;
    double distance = sqrt(nearest->pair.distance2);
    profile->size = length(axis->u);
    profile->work = 0;
    profile->full = 0;
    profile->cut = 0;
    profile->sideless = 0;
    profile->crossings = 0;
    profile->zones = 0;
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
        profile_cross(profile);
        if (profile->full || profile->cut || profile->sideless)
            return 1;
        find_sides(profile, nearest);
    }
    put_crossing_samples(profile);
    if (!profile->crossings) {
        struct sample sample;
        take_sample(profile, nearest->pair.s, nearest->triangle, 0, &sample);
        sample.exact = 1;
        put_sample(profile, &sample);
    }
    for (uint32_t i = 0; i < seed_count; i++) {
        int sign = profile->sign[profile_stretch(profile, seeds[i].s)];
        if (sign > 0 && !in_zone(profile, seeds[i].s))
            continue;
        /* A budget is for the depth first: regions search for those that count. */
        int counts = seeds[i].share > PROFILE_SHARE && profile->work < PROFILE_WORK;
        int exact = profile->winding || (counts && !profile->memo);
        struct sample sample;
        take_sample(profile, seeds[i].s, seeds[i].triangle, exact, &sample);
        put_sample(profile, &sample);
    }
    for (uint32_t i = 1; i < profile->count; i++)
        tell(profile, i, profile->sample[i - 1].triangle);
    for (uint32_t i = profile->count - 1; i > 0; i--)
        tell(profile, i - 1, profile->sample[i].triangle);
    put_inner_samples(profile);
    put_winding_samples(profile);
    profile->deepest = profile_prove(profile, 0.0, 1.0);
    return 1;
}

/* How far from a sample within reach the surface goes out of it, if it goes on as there, and half as far again. */
static double way_beyond(const struct profile *profile, const struct sample *sample, double sign)
{
    double rise = sign * sample->rise;
    double room = 0.25 * profile->reach, left = profile->reach - sample->height;
    if (!(left > 0.0))
        return 0.0;
    return rise > 0.0 ? larger(room / profile->size, 1.5 * left / rise) : HUGE_VAL;
}

int profile_is_blind(const struct profile *profile, uint32_t i, double *from, double *to)
{
    const struct sample *left = &profile->sample[i], *right = left + 1;
    double middle = 0.5 * (left->s + right->s);
    if (!(profile->sign[profile_stretch(profile, middle)] > 0 && in_zone(profile, middle)))
        return 0;
    *from = left->s + way_beyond(profile, left, 1.0);
    *to = right->s - way_beyond(profile, right, -1.0);
    return *to > *from;
}

/* First those that have nothing in them, then what is beside a sample that is within reach. */
void profile_look(struct profile *profile, double first, double last)
{
    enum { BLIND_MOST = 16 };
    uint32_t asked = 0;
    double from, to;
    for (int beside = 0; beside < 2; beside++)
        for (uint32_t i = 0; i + 1 < profile->count && asked < BLIND_MOST && !profile->cut;) {
            const struct sample *here = &profile->sample[i];
            int in = here->height < profile->reach || here[1].height < profile->reach;
            int blind = in == beside && here->s >= first && here[1].s <= last &&
                        profile_is_blind(profile, i, &from, &to);
            asked += (uint32_t)blind;
            if (!blind || profile_approach(profile, from, to, profile->reach) == DPT_NONE)
                i++;
        }
}

/* Outside of the zones an axis that is outside is beyond reach. Where a side is each sample's own, samples tell. */
void profile_enclose(struct profile *profile)
{
    struct sample beyond = { .height = profile->reach, .triangle = DPT_NONE };
    for (uint32_t i = 0; i < profile->zones; i++) {
        const double ends[2] = { profile->zone_from[i], profile->zone_to[i] };
        for (int k = 0; k < 2; k++) {
            int sign = profile->sign[profile_stretch(profile, ends[k])];
            beyond.s = ends[k];
            if (ends[k] <= 0.0 || ends[k] >= 1.0 || !sign)
                profile_ask(profile, ends[k], 1);
            else if (sign > 0)
                put_sample(profile, &beyond);
        }
    }
    profile_look(profile, 0.0, 1.0);
}
