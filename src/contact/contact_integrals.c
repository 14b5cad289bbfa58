/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Between two samples the height follows its chord or its two tangents. Where it bends once, at the edge between two
 * walls, the tangents are exact; where it curves evenly, it lies a third of the way from them to the chord. So it is
 * taken five sixths of the way, and what is left between the two is the doubt that decides where to ask next.
 */
#include "contact/contact_integrals.h"

/*
 * The doubt that is left, of the overlap: of all spans, and of one, whose estimate may be far off. And that below which a
 * sample is not worth keeping.
 */
#define DOUBT_LEFT    0.008
#define DOUBT_ONE     0.001
#define DOUBT_IGNORED 0.001

/* A way out that turns by less is not looked into; by more is not of one curved wall. */
#define TURN_SMALL 0.01
#define TURN_LARGE 0.15

/* What tangents and chord may differ by, of the area, to be nearly one line. */
#define STRAIGHT 0.001

/* How far, of the reach, the surface may be from where a region ends. */
#define END_LEFT 0.04

enum { ASK_MAX = PROFILE_SAMPLES, SPANS_MIN = 12, SAMPLE_CHEAP = 40 };

/* A piece of the profile on which the height is linear and the way out is one sample's. */
struct profile_piece {
    double s0, s1;
    double w0, w1; /* how far within reach */
    vec3 normal;
};

/* Cut off what is beyond reach; 0 if that is all. */
static int clip(struct profile_piece *piece)
{
    double w0 = piece->w0, w1 = piece->w1;
    if (!(w0 > 0.0) && !(w1 > 0.0))
        return 0;
    if (w0 >= 0.0 && w1 >= 0.0)
        return 1;
    double cut = piece->s0 + (piece->s1 - piece->s0) * (w0 / (w0 - w1));
    if (w0 < 0.0) {
        piece->s0 = cut;
        piece->w0 = 0.0;
    } else if (w1 < 0.0) {
        piece->s1 = cut;
        piece->w1 = 0.0;
    }
    return 1;
}

static inline double area_of(double s0, double w0, double s1, double w1)
{
    if (w0 >= 0.0 && w1 >= 0.0)
        return 0.5 * (w0 + w1) * (s1 - s0);
    struct profile_piece piece = { s0, s1, w0, w1, { 0.0, 0.0, 0.0 } };
    return clip(&piece) ? 0.5 * (piece.w0 + piece.w1) * (piece.s1 - piece.s0) : 0.0;
}

static void add_piece(struct region *region, const struct profile_piece *piece, double size)
{
    double width = (piece->s1 - piece->s0) * size;
    double overlap = 0.5 * (piece->w0 + piece->w1) * width;
    double moment =
        (piece->s0 * (2.0 * piece->w0 + piece->w1) + piece->s1 * (piece->w0 + 2.0 * piece->w1)) *
        (width / 6.0);
    region->overlap += overlap;
    region->moment += moment;
    region->thrust = along(region->thrust, overlap, piece->normal);
    region->thrust_moment = along(region->thrust_moment, moment, piece->normal);
    region->to = piece->s1;
}

/* Between a mark and a sample: how far the sample's tangent is within reach where the mark's meets it, or should. */
static double from_mark(const struct distance_profile *profile, const struct sample *from,
                        const struct sample *to, double s)
{
    const struct sample *seen = from->triangle == DPT_NONE ? to : from;
    return profile->reach - seen->height - seen->rise * (s - seen->s);
}

/*
 * Where `at` is, the triangle of `of` is as near as its own. The distance to one triangle is convex along the axis and so no less
 * than its tangent, which mostly tells.
 */
static int is_as_near(const struct distance_profile *profile, const struct sample *of,
                      const struct sample *at)
{
    double reach = fabs(at->height) + profile->axis->error;
    double tangent = of->height + of->rise * (at->s - of->s);
    return !((of->height < 0.0 ? -tangent : tangent) > reach) &&
           dpti_profile_reach(profile, of->triangle, at->s) <= reach;
}

/* One triangle is nearest at both samples: between them the way out turns evenly, or at the sample where others are as near. */
static int is_one_wall(const struct distance_profile *profile, const struct sample *from,
                       const struct sample *to)
{
    return from->triangle == to->triangle || is_as_near(profile, to, from) ||
           is_as_near(profile, from, to);
}

static void span_between(const struct distance_profile *profile, const struct sample *from,
                         const struct sample *to, struct span *span)
{
    struct bend bend = dpti_profile_bend(profile, from, to);
    double width = to->s - from->s, w0 = profile->reach - from->height;
    double w1 = profile->reach - to->height, tangent = profile->reach - bend.height;
    double part = width > 0.0 ? (bend.s - from->s) / width : 0.0;
    double chord = w0 + (w1 - w0) * part;
    int marked = from->triangle == DPT_NONE || to->triangle == DPT_NONE;
    double w = marked ? tangent : chord + (tangent - chord) * (5.0 / 6.0);
    double least = area_of(from->s, w0, to->s, w1);
    double most = area_of(from->s, w0, bend.s, tangent) + area_of(bend.s, tangent, to->s, w1);
    double area = area_of(from->s, w0, bend.s, w) + area_of(bend.s, w, to->s, w1);
    double doubt = 0.25 * fabs(most - least);
    /* No height changes by more than the way: what is short enough is known well enough, also beside a border. */
    double loose = END_LEFT * profile->reach;
    int ends = (w0 > 0.0) != (w1 > 0.0) && fabs(w0) > loose && fabs(w1) > loose;
    span->s = bend.s;
    span->w0 = w0;
    span->w = w;
    span->w1 = w1;
    span->area = area;
    span->error_estimate = marked ? doubt + 0.5 * area : doubt;
    span->loose =
        width * profile->size > loose && (marked ? from_mark(profile, from, to, bend.s) > loose
                                                 : ends && fabs(tangent - chord) > loose);
}

/*
 * A wall may be nearest between two samples and at neither: so when both have just passed from it to another that is about as
 * far. How far the way out would turn between them, if `was` is that wall. `least`: no less than how far the samples'
 * triangles are there.
 */
static double turn_between(const struct distance_profile *profile, const struct sample *from,
                           const struct sample *to, uint32_t was, double least)
{
    if (was == from->triangle || was == to->triangle)
        return 0.0;
    double s = from->span.s, error = profile->axis->error;
    double reach = dpti_profile_reach(profile, was, s);
    const uint32_t own[2] = { from->triangle, to->triangle };
    for (int k = 0; k < 2 && reach <= least + error; k++)
        least = min_of(least, dpti_profile_reach(profile, own[k], s));
    if (reach > least + error)
        return 0.0;
    pair found;
    dpti_triangle_point_pair(profile->surface, was, profile_point(profile, s), &found);
    double distance = sqrt(found.distance2);
    if (!(distance > error && distance < least))
        return 0.0;
    double sign = from->height + to->height < 0.0 ? -1.0 : 1.0;
    vec3 way = scaled(found.gap, sign / distance);
    return max_of(length(sub(way, from->normal)), length(sub(way, to->normal)));
}

/*
 * How far the way out may be off between a sample whose span is known and the next: most where the tangents are nearly one line,
 * and so do not tell where they meet.
 */
static double normal_error(const struct distance_profile *profile, const struct sample *from,
                           const struct sample *to)
{
    double turn = length(sub(from->normal, to->normal)), share = 0.25;
    if (turn > TURN_SMALL && is_one_wall(profile, from, to))
        share = 0.03;
    else if (turn > TURN_LARGE && from->span.error_estimate <= STRAIGHT * from->span.area)
        share = 1.0;
    double doubt = share * turn;
    if (from->was != from->triangle || to->was != to->triangle) {
        double s = from->span.s;
        double least =
            sqrt(min_of(profile_square_to(profile, from, s), profile_square_to(profile, to, s)));
        doubt += 0.25 * max_of(turn_between(profile, from, to, from->was, least),
                               turn_between(profile, from, to, to->was, least));
    }
    return doubt;
}

static void take_span(const struct distance_profile *profile, struct sample *from)
{
    const struct sample *to = from + 1;
    span_between(profile, from, to, &from->span);
    if (from->span.area > 0.0 && from->triangle != DPT_NONE && to->triangle != DPT_NONE)
        from->span.error_estimate += from->span.area * normal_error(profile, from, to);
    from->spanned = 1;
}

/* The same between sample i and the next, worked out once. */
static inline const struct span *span_at(struct distance_profile *profile, uint32_t i)
{
    if (!profile->sample[i].spanned)
        take_span(profile, &profile->sample[i]);
    return &profile->sample[i].span;
}

/* Where another sample tells most: where the surface goes out of reach, or at the bend. */
static double next_sample_place(const struct distance_profile *profile, uint32_t i,
                                const struct span *span)
{
    const struct sample *from = &profile->sample[i], *to = from + 1;
    struct profile_piece piece = { from->s, span->s, span->w0, span->w, { 0.0, 0.0, 0.0 } };
    if (span->w0 < 0.0 && span->w > 0.0 && clip(&piece))
        return piece.s0;
    if (span->w0 > 0.0 && span->w < 0.0 && clip(&piece))
        return piece.s1;
    piece = (struct profile_piece){ span->s, to->s, span->w, span->w1, { 0.0, 0.0, 0.0 } };
    if (span->w < 0.0 && span->w1 > 0.0 && clip(&piece))
        return piece.s0;
    if (span->w > 0.0 && span->w1 < 0.0 && clip(&piece))
        return piece.s1;
    double edge = 0.0625 * (to->s - from->s);
    return span->s > from->s + edge && span->s < to->s - edge ? span->s : 0.5 * (from->s + to->s);
}

/*
 * Integrals are worth so much, and no more: in the middle of a thick or spiky body each search costs hundreds. Half as much
 * again where samples are cheap, as many are needed there.
 */
static int is_tired(const struct distance_profile *profile)
{
    uint32_t more = profile->work.done < SAMPLE_CHEAP * profile->count ? PROFILE_WORK / 2 : 0;
    return profile->cut || profile->work.done >= PROFILE_WORK + more;
}

/* Samples by descent that count for much are searched for: descent may have been trapped. */
static void confirm(struct distance_profile *profile)
{
    double sum = 0.0;
    for (uint32_t i = 0; i + 1 < profile->count; i++)
        sum += span_at(profile, i)->area;
    for (uint32_t i = 0; i < profile->count && !is_tired(profile); i++) {
        const struct sample *sample = &profile->sample[i];
        double from = i ? sample[-1].s : sample->s;
        double to = i + 1 < profile->count ? sample[1].s : sample->s;
        double share = 0.5 * (profile->reach - sample->height) * (to - from);
        if (!sample->exact && sample->triangle != DPT_NONE && share > PROFILE_SHARE * sum)
            dpti_profile_add_sample(profile, sample->s, 1);
    }
}

/*
 * Where another sample is asked. Wide spans hide what their ends do not show: none wider than the reach, or a share of all that
 * is within it.
 */
struct next_sample {
    double s;
    uint32_t wide; /* the span that is too wide, or DPT_NONE */
};

/* What the spans up to one come to, summed in order: what was asked before does not show in the sum. */
struct tally {
    double sum, doubt, most, within, widest;
    uint32_t worst, wide_at, end_at;
};

/* Of all. `before`: of those before each, made anew from the first that changed. */
static struct tally tally_spans(struct distance_profile *profile,
                                struct tally before[PROFILE_SAMPLES])
{
    uint32_t first = profile->same ? profile->same - 1 : 0;
    struct tally all = first ? before[first] : (struct tally){ .end_at = DPT_NONE };
    for (uint32_t i = first; i + 1 < profile->count; i++) {
        const struct span *span = span_at(profile, i);
        double width = profile->sample[i + 1].s - profile->sample[i].s;
        before[i] = all;
        all.sum += span->area;
        all.doubt += span->error_estimate;
        all.within += span->area > 0.0 ? width : 0.0;
        if (span->error_estimate > all.most) {
            all.most = span->error_estimate;
            all.worst = i;
        }
        if (span->area > 0.0 && width > all.widest) {
            all.widest = width;
            all.wide_at = i;
        }
        if (span->loose)
            all.end_at = i;
    }
    if (profile->count)
        before[profile->count - 1] = all;
    profile->same = profile->count;
    return all;
}

/* 0 where there is nothing to ask. */
static int find_next_sample(const struct distance_profile *profile, const struct tally *all,
                            struct next_sample *ask)
{
    double reach = profile->size > 0.0 ? profile->reach / profile->size : 1.0;
    const struct sample *sample = profile->sample;
    ask->wide = DPT_NONE;
    if (all->widest > max_of(reach, all->within / SPANS_MIN)) {
        ask->wide = all->wide_at;
        ask->s = 0.5 * (sample[all->wide_at].s + sample[all->wide_at + 1].s);
    } else if (all->end_at != DPT_NONE) {
        ask->s = next_sample_place(profile, all->end_at, &sample[all->end_at].span);
    } else if (all->doubt > DOUBT_LEFT * all->sum || all->most > DOUBT_ONE * all->sum) {
        ask->s = next_sample_place(profile, all->worst, &sample[all->worst].span);
    } else {
        return 0;
    }
    return 1;
}

/* 0: work or room ended that. */
static int refine(struct distance_profile *profile)
{
    struct tally before[PROFILE_SAMPLES];
    struct next_sample ask;
    double from, to;
    confirm(profile);
    profile->same = 0;
    for (int asked = 0; asked < ASK_MAX && !is_tired(profile); asked++) {
        const struct tally all = tally_spans(profile, before);
        if (!find_next_sample(profile, &all, &ask))
            return 1;
        int told = ask.wide != DPT_NONE && !dpti_profile_is_blind(profile, ask.wide, &from, &to);
        uint32_t at = dpti_profile_add_sample(profile, ask.s, 1);
        if (at == DPT_NONE)
            return 0;
        /* The surface does not go on as a sample told: what is beyond was not looked into. */
        if (told && profile->sample[at].height >= profile->reach)
            dpti_profile_look_between(profile, profile->sample[at - 1].s,
                                      profile->sample[at + 1].s);
    }
    return 0;
}

static uint32_t part_of(const struct distance_profile *profile, uint32_t i)
{
    uint32_t triangle = profile->sample[i].triangle;
    return triangle == DPT_NONE ? DPT_NONE : surface_part(profile->surface, triangle);
}

/* Regions as they are taken, one piece after another. */
struct taking {
    const struct distance_profile *profile;
    struct region *regions;
    uint32_t count;
    int open; /* the last region goes on */
};

static void take_piece(struct taking *taking, uint32_t sample, struct profile_piece piece)
{
    const struct distance_profile *profile = taking->profile;
    uint32_t part = part_of(profile, sample);
    double from = piece.s0, to = piece.s1;
    if (!clip(&piece)) {
        taking->open = 0;
        return;
    }
    struct region *region = &taking->regions[taking->count ? taking->count - 1 : 0];
    if (!taking->open || piece.s0 > from || (part != DPT_NONE && part != region->part)) {
        if (taking->count == REGION_MAX)
            return;
        region = &taking->regions[taking->count++];
        *region = (struct region){ .from = piece.s0, .deepest = sample, .part = part };
    }
    if (profile->sample[sample].height < profile->sample[region->deepest].height)
        region->deepest = sample;
    add_piece(region, &piece, profile->size);
    taking->open = piece.s1 >= to;
}

static uint32_t take_all(struct distance_profile *profile, struct region regions[REGION_MAX])
{
    struct taking taking = { .profile = profile, .regions = regions };
    for (uint32_t i = 0; i + 1 < profile->count; i++) {
        const struct sample *from = &profile->sample[i], *to = from + 1;
        const struct span *span = span_at(profile, i);
        uint32_t left = from->triangle == DPT_NONE ? i + 1 : i;
        uint32_t right = to->triangle == DPT_NONE ? i : i + 1;
        take_piece(&taking, left,
                   (struct profile_piece){ from->s, span->s, span->w0, span->w,
                                           profile->sample[left].normal });
        take_piece(&taking, right,
                   (struct profile_piece){ span->s, to->s, span->w, span->w1,
                                           profile->sample[right].normal });
    }
    return taking.count;
}

/* A region that rests on a bend alone has no sample in it that is within reach. */
static int is_seen(const struct distance_profile *profile, const struct region *region)
{
    const struct sample *deepest = &profile->sample[region->deepest];
    return deepest->s >= region->from && deepest->s <= region->to &&
           deepest->height < profile->reach;
}

/* Its deepest sample is the deepest point. */
static void prove(struct distance_profile *profile, const struct region *region)
{
    struct sample *deepest = &profile->sample[region->deepest];
    if (deepest->height < 0.0) {
        dpti_profile_prove_deepest(profile, region->from, region->to);
        return;
    }
    uint32_t nearer = dpti_profile_approach(profile, region->from, region->to, deepest->height);
    if (profile->cut)
        return;
    if (nearer != DPT_NONE)
        deepest = &profile->sample[nearer];
    deepest->exact = deepest->proven = 1;
}

/* See to the first that has no sample in it, or no proof. Returns 1 if there was one. */
static int improve_one(struct distance_profile *profile, const struct region *regions,
                       uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        double middle = 0.5 * (regions[i].from + regions[i].to);
        if (!is_seen(profile, &regions[i]))
            return dpti_profile_add_sample(profile, middle, 1) != DPT_NONE;
        if (!profile->sample[regions[i].deepest].proven) {
            prove(profile, &regions[i]);
            return 1;
        }
    }
    return 0;
}

uint32_t dpti_contact_regions(struct distance_profile *profile, struct region regions[REGION_MAX])
{
    dpti_profile_find_reach(profile);
    profile->coarse = !refine(profile);
    uint32_t count = take_all(profile, regions), seen = 0;
    for (int asked = 0; asked < 2 * REGION_MAX && !profile->cut; asked++) {
        if (!improve_one(profile, regions, count))
            break;
        count = take_all(profile, regions);
    }
    profile->coarse |= profile->cut;
    for (uint32_t i = 0; i < count; i++)
        if (is_seen(profile, &regions[i]))
            regions[seen++] = regions[i];
    return seen;
}

/* Of the integral over s; where one of the two is a mark, all is the other's. */
static vec3 thrust_between(const struct sample *from, const struct sample *to,
                           const struct span *span)
{
    const struct sample *left = from->triangle == DPT_NONE ? to : from;
    const struct sample *right = to->triangle == DPT_NONE ? from : to;
    return along(scaled(left->normal, area_of(from->s, span->w0, span->s, span->w)),
                 area_of(span->s, span->w, to->s, span->w1), right->normal);
}

/* What a sample between these two tells, of the integral over s, is more than `ignored`. Regions were taken: spans are known. */
static int is_worth(const struct distance_profile *profile, const struct sample *before,
                    const struct sample *sample, const struct sample *after, double ignored)
{
    struct span both, made;
    const struct span *left = &before->span;
    span_between(profile, before, after, &both);
    double doubt =
        both.error_estimate + 0.25 * length(sub(before->normal, after->normal)) * both.area;
    if (doubt > ignored)
        return 1;
    if (before + 1 != sample) {
        span_between(profile, before, sample, &made);
        left = &made;
    }
    vec3 parts =
        add(thrust_between(before, sample, left), thrust_between(sample, after, &sample->span));
    return doubt + length(sub(thrust_between(before, after, &both), parts)) > ignored;
}

/* Those that are worth more than `ignored`; returns how many there are, which may be more than fit. */
static uint32_t warm_starts_worth(const struct distance_profile *profile,
                                  const struct region *region, double ignored,
                                  struct warm_start *warm_starts, uint32_t most)
{
    uint32_t count = 0;
    const struct sample *before = NULL;
    double share_per_area = region->overlap > 0.0 ? 0.5 * profile->size / region->overlap : 0.0;
    for (uint32_t i = 0; i < profile->count; i++) {
        const struct sample *sample = &profile->sample[i];
        if (sample->s > region->to)
            break;
        double after = i + 1 < profile->count ? sample[1].s : sample->s;
        int ends = !before || i + 1 == profile->count || i == region->deepest;
        if (!ends && !is_worth(profile, before, sample, sample + 1, ignored))
            continue;
        double share = (profile->reach - sample->height) * (after - (before ? before->s : after));
        before = sample;
        if (sample->s < region->from || sample->height == 0.0 || sample->triangle == DPT_NONE)
            continue;
        if (count < most)
            warm_starts[count] =
                (struct warm_start){ sample->s, sample->triangle, (float)(share * share_per_area) };
        count++;
    }
    return count;
}

uint32_t dpti_contact_region_warm_starts(const struct distance_profile *profile,
                                         const struct region *region,
                                         struct warm_start *warm_starts, uint32_t most)
{
    enum { COARSER_MAX = 32 };
    double ignored = profile->size > 0.0 ? DOUBT_IGNORED * region->overlap / profile->size : 0.0;
    uint32_t count = warm_starts_worth(profile, region, ignored, warm_starts, most);
    for (int i = 0; i < COARSER_MAX && count > most; i++) {
        ignored *= 1.25;
        count = warm_starts_worth(profile, region, ignored, warm_starts, most);
    }
    return count < most ? count : most;
}
