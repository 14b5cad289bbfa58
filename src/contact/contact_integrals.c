/* SPDX-License-Identifier: BSD-3-Clause */
#include "contact/contact_integrals.h"

#include "contact/deepest_point.h"

/*
 * Accepted error estimates, as shares of the overlap: of all spans together, and of one span, whose own estimate may be
 * far off. A sample that changes the integrals by less than ERROR_IGNORED is no warm start.
 */
#define ERROR_SUM_MAX  0.008
#define ERROR_SPAN_MAX 0.001
#define ERROR_IGNORED  0.001

enum {
    REFINE_MAX = PROFILE_SAMPLES, /* samples added */
    SPANS_WITHIN_MIN = 12,        /* no span is wider than this part of all that is within reach */
    CHEAP_SAMPLE_WORK = 40        /* units for a sample, on average */
};

/* Add the integrals over what of a piece is within reach by more than `inset`. */
static void integrate(struct region_integrals *sum, struct profile_piece piece, double inset, double axis_length)
{
    piece.w0 -= inset;
    piece.w1 -= inset;
    if (!clip_to_reach(&piece))
        return;
    const double width = (piece.s1 - piece.s0) * axis_length, w0 = piece.w0, w1 = piece.w1;
    const double overlap = 0.5 * (w0 + w1) * width;
    const double moment = (piece.s0 * (2.0 * w0 + w1) + piece.s1 * (w0 + 2.0 * w1)) * (width / 6.0);
    sum->overlap += overlap;
    sum->moment += moment;
    sum->square += (w0 * w0 + w0 * w1 + w1 * w1) * (width / 3.0);
    sum->thrust = along(sum->thrust, overlap, piece.normal);
    sum->thrust_moment = along(sum->thrust_moment, moment, piece.normal);
}

/* Add the integrals over a piece, all of it within reach, to its region. */
static void integrate_piece(struct region *region, const struct profile_piece *piece,
                            const struct distance_profile *profile)
{
    region->within += 0.5 * (piece->w0 + piece->w1) * ((piece->s1 - piece->s0) * profile->axis_length);
    region->end_within[1] = piece->w1;
    region->end_normal[1] = piece->normal;
    integrate(&region->beyond_onset, *piece, profile->inset, profile->axis_length);
    if (profile->ends_wanted)
        integrate(&region->depth, *piece, profile->margin, profile->axis_length);
}

/*
 * 1: no more work goes into the integrals. In the middle of a thick or spiky body each search costs hundreds of units,
 * so their work is limited. Where samples are cheap, many are needed, and the limit is half as high again.
 */
static int must_stop_refining(const struct distance_profile *profile)
{
    uint32_t extra = profile->work.done < CHEAP_SAMPLE_WORK * profile->sample_count ? PROFILE_WORK_MAX / 2 : 0;
    return profile->is_cut || profile->work.done >= PROFILE_WORK_MAX + extra;
}

/* An end counts by itself, as much as half of the axis does. */
static int is_wanted_end(const struct distance_profile *profile, const struct profile_sample *sample)
{
    return profile->ends_wanted && (sample->s == 0.0 || sample->s == 1.0) && sample->height < profile->reach;
}

/* Search for the samples that decide on much and only descended: a descent may have been trapped. */
static void confirm_samples(struct distance_profile *profile)
{
    double area = 0.0;
    for (uint32_t i = 0; i + 1 < profile->sample_count; i++)
        area += span_at(profile, i)->area;
    for (uint32_t i = 0; i < profile->sample_count && !must_stop_refining(profile); i++) {
        const struct profile_sample *sample = &profile->sample[i];
        double from = i ? sample[-1].s : sample->s;
        double to = i + 1 < profile->sample_count ? sample[1].s : sample->s;
        double sample_area = 0.5 * (profile->reach - sample->height) * (to - from);
        if (!sample->is_exact && sample->triangle != DPT_NONE &&
            (sample_area > PROFILE_SEARCH_SHARE * area || is_wanted_end(profile, sample)))
            dpti_profile_add_sample(profile, sample->s, 1);
    }
}

/* Where the next sample goes. */
struct next_sample {
    double s;
    /* Index of the span that the sample divides because it is too wide, or DPT_NONE. */
    uint32_t wide_span;
};

/* Sums and maxima over spans. They are added in order of s, so they do not depend on the order of the samples taken. */
struct span_totals {
    double area, error, max_error; /* m */
    double width, max_width;       /* of spans within reach, in s */
    /* Indices of spans; loose_end_at may be DPT_NONE. */
    uint32_t max_error_at, max_width_at, loose_end_at;
};

/*
 * The totals of all spans. before[i] gets those of the spans before span i; entries before the first change are reused.
 */
static struct span_totals sum_spans(struct distance_profile *profile, struct span_totals before[PROFILE_SAMPLES])
{
    uint32_t first = profile->unchanged_count ? profile->unchanged_count - 1 : 0;
    struct span_totals totals = first ? before[first] : (struct span_totals){ .loose_end_at = DPT_NONE };
    for (uint32_t i = first; i + 1 < profile->sample_count; i++) {
        const struct span *span = span_at(profile, i);
        double width = profile->sample[i + 1].s - profile->sample[i].s;
        before[i] = totals;
        totals.area += span->area;
        totals.error += span->error_estimate;
        totals.width += span->area > 0.0 ? width : 0.0;
        if (span->error_estimate > totals.max_error) {
            totals.max_error = span->error_estimate;
            totals.max_error_at = i;
        }
        if (span->area > 0.0 && width > totals.max_width) {
            totals.max_width = width;
            totals.max_width_at = i;
        }
        if (span->has_loose_end)
            totals.loose_end_at = i;
    }
    if (profile->sample_count)
        before[profile->sample_count - 1] = totals;
    profile->unchanged_count = profile->sample_count;
    return totals;
}

/*
 * Find where the next sample goes. Wide spans come first, as they hide what their ends do not show: one is too wide if
 * it exceeds both the reach and a twelfth of all that is within reach. Then come ends of regions, then error estimates.
 * Returns 0 if no sample is needed.
 */
static int find_next_sample(const struct distance_profile *profile, const struct span_totals *totals,
                            struct next_sample *next)
{
    double reach = profile->axis_length > 0.0 ? profile->reach / profile->axis_length : 1.0;
    const struct profile_sample *sample = profile->sample;
    next->wide_span = DPT_NONE;
    if (totals->max_width > max_of(reach, totals->width / SPANS_WITHIN_MIN)) {
        next->wide_span = totals->max_width_at;
        next->s = 0.5 * (sample[totals->max_width_at].s + sample[totals->max_width_at + 1].s);
    } else if (totals->loose_end_at != DPT_NONE) {
        next->s = dpti_span_next_sample(profile, totals->loose_end_at);
    } else if (totals->error > ERROR_SUM_MAX * totals->area || totals->max_error > ERROR_SPAN_MAX * totals->area) {
        next->s = dpti_span_next_sample(profile, totals->max_error_at);
    } else {
        return 0;
    }
    return 1;
}

/* Add samples until the integrals are accurate enough. Returns 0 if work or room ended before. */
static int refine_integrals(struct distance_profile *profile)
{
    struct span_totals before[PROFILE_SAMPLES];
    struct next_sample next;
    double from, to;
    confirm_samples(profile);
    profile->unchanged_count = 0;
    for (int steps = 0; steps < REFINE_MAX && !must_stop_refining(profile); steps++) {
        const struct span_totals totals = sum_spans(profile, before);
        if (!find_next_sample(profile, &totals, &next))
            return 1;
        int is_predicted =
            next.wide_span != DPT_NONE && !dpti_profile_find_undecided(profile, next.wide_span, &from, &to);
        uint32_t at = dpti_profile_add_sample(profile, next.s, 1);
        if (at == DPT_NONE)
            return 0;
        /* The surface does not follow the samples' tangents, so what they ruled out must be searched. */
        if (is_predicted && profile->sample[at].height >= profile->reach)
            dpti_profile_search_undecided(profile, profile->sample[at - 1].s, profile->sample[at + 1].s);
    }
    return 0;
}

static uint32_t part_of_sample(const struct distance_profile *profile, uint32_t i)
{
    uint32_t triangle = profile->sample[i].triangle;
    return triangle == DPT_NONE ? DPT_NONE : surface_part(profile->surface, triangle);
}

/* Regions under construction, from piece to piece. */
struct region_builder {
    const struct distance_profile *profile;
    struct region *regions; /* room for REGION_MAX */
    uint32_t count;
    int is_open;       /* the last region continues with the next piece */
    int has_integrals; /* 0: only what tells where the regions are, and their deepest samples */
};

/* Add a piece, whose exit direction is that of the profile's sample `sample`, to the last region or to a new one. */
static void add_region_piece(struct region_builder *builder, uint32_t sample, struct profile_piece piece)
{
    const struct distance_profile *profile = builder->profile;
    uint32_t part = part_of_sample(profile, sample);
    double from = piece.s0, to = piece.s1;
    if (!clip_to_reach(&piece)) {
        builder->is_open = 0;
        return;
    }
    struct region *region = &builder->regions[builder->count ? builder->count - 1 : 0];
    if (!builder->is_open || piece.s0 > from || (part != DPT_NONE && part != region->part)) {
        if (builder->count == REGION_MAX)
            return;
        region = &builder->regions[builder->count++];
        *region = (struct region){ .from = piece.s0,
                                   .end_within = { piece.w0 },
                                   .end_normal = { piece.normal },
                                   .deepest = sample,
                                   .part = part };
    }
    if (profile->sample[sample].height < profile->sample[region->deepest].height)
        region->deepest = sample;
    region->to = piece.s1;
    if (builder->has_integrals)
        integrate_piece(region, &piece, profile);
    builder->is_open = piece.s1 >= to;
}

/* Compute the regions from the samples, with or without integrals. Returns their number. */
static uint32_t build_regions(struct distance_profile *profile, int has_integrals, struct region regions[REGION_MAX])
{
    struct region_builder builder = { .profile = profile, .regions = regions, .has_integrals = has_integrals };
    for (uint32_t i = 0; i + 1 < profile->sample_count; i++) {
        const struct profile_sample *from = &profile->sample[i], *to = from + 1;
        const struct span *span = span_at(profile, i);
        uint32_t left = from->triangle == DPT_NONE ? i + 1 : i;
        uint32_t right = to->triangle == DPT_NONE ? i : i + 1;
        add_region_piece(&builder, left,
                         (struct profile_piece){ from->s, span->s, span->w0, span->w, profile->sample[left].normal });
        add_region_piece(&builder, right,
                         (struct profile_piece){ span->s, to->s, span->w, span->w1, profile->sample[right].normal });
    }
    return builder.count;
}

/* 1: a sample of the region is within reach. A region that comes from a bend alone has none. */
static int has_sample(const struct distance_profile *profile, const struct region *region)
{
    const struct profile_sample *deepest = &profile->sample[region->deepest];
    return deepest->s >= region->from && deepest->s <= region->to && deepest->height < profile->reach;
}

/* Prove that a region's deepest sample is its deepest point, or add the sample that is. */
static void prove_deepest(struct distance_profile *profile, const struct region *region)
{
    struct profile_sample *deepest = &profile->sample[region->deepest];
    if (deepest->height < 0.0) {
        dpti_profile_prove_deepest(profile, region->from, region->to);
        return;
    }
    uint32_t nearer = dpti_profile_add_nearest(profile, region->from, region->to, deepest->height);
    if (profile->is_cut)
        return;
    if (nearer != DPT_NONE)
        deepest = &profile->sample[nearer];
    deepest->is_exact = deepest->is_proven = 1;
    /* Of samples that are as deep, as all of an axis without length are, any may be the region's deepest. */
    for (uint32_t i = 0; i < profile->sample_count; i++)
        profile->sample[i].is_proven |= profile->sample[i].s >= region->from && profile->sample[i].s <= region->to &&
                                        profile->sample[i].height <= deepest->height;
}

/* Add a sample to the first region without one, or prove the first that lacks a proof. Returns 0 if all are done. */
static int improve_region(struct distance_profile *profile, const struct region *regions, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        double middle = 0.5 * (regions[i].from + regions[i].to);
        if (!has_sample(profile, &regions[i]))
            return dpti_profile_add_sample(profile, middle, 1) != DPT_NONE;
        if (!profile->sample[regions[i].deepest].is_proven) {
            prove_deepest(profile, &regions[i]);
            return 1;
        }
    }
    return 0;
}

uint32_t dpti_contact_regions(struct distance_profile *profile, struct region regions[REGION_MAX])
{
    dpti_profile_find_reach(profile);
    profile->is_coarse = !refine_integrals(profile);
    uint32_t count = build_regions(profile, 1, regions), kept_count = 0;
    int has_changed = 0;
    for (int steps = 0; steps < 2 * REGION_MAX && !profile->is_cut; steps++) {
        if (!improve_region(profile, regions, count))
            break;
        count = build_regions(profile, 0, regions);
        has_changed = 1;
    }
    if (has_changed)
        count = build_regions(profile, 1, regions);
    profile->is_coarse |= profile->is_cut;
    for (uint32_t i = 0; i < count; i++)
        if (has_sample(profile, &regions[i]))
            regions[kept_count++] = regions[i];
    return kept_count;
}

/* A span's integral of w n over s, m. If one end is a mark, the exit direction is that of the other end. */
static vec3 thrust_between(const struct profile_sample *from, const struct profile_sample *to, const struct span *span)
{
    const struct profile_sample *left = from->triangle == DPT_NONE ? to : from;
    const struct profile_sample *right = to->triangle == DPT_NONE ? from : to;
    return along(scaled(left->normal, area_within_reach(from->s, span->w0, span->s, span->w)),
                 area_within_reach(span->s, span->w, to->s, span->w1), right->normal);
}

/* What is known of how much the integrals show of a sample, m; threshold by threshold the same is asked again. */
struct removal {
    const struct profile_sample *before; /* the sample kept before it; NULL: nothing is known */
    double error, change;                /* change < 0: not known */
};

/*
 * 1: without `sample`, the integrals over s from `before` to the sample after it would change by more than `threshold`,
 * in m. All spans have been computed by then.
 */
static int is_worth_keeping(const struct distance_profile *profile, const struct profile_sample *before,
                            const struct profile_sample *sample, double threshold, struct removal *removal)
{
    const struct profile_sample *after = sample + 1;
    if (removal->before == before && (removal->error > threshold || removal->change >= 0.0))
        return removal->error > threshold || removal->error + removal->change > threshold;
    struct span joined, measured;
    const struct span *left_span = &before->span;
    dpti_span_measure(profile, before, after, &joined);
    removal->before = before;
    removal->change = -1.0;
    removal->error = joined.error_estimate + 0.25 * length(sub(before->normal, after->normal)) * joined.area;
    if (removal->error > threshold)
        return 1;
    if (before + 1 != sample) {
        dpti_span_measure(profile, before, sample, &measured);
        left_span = &measured;
    }
    vec3 parts = add(thrust_between(before, sample, left_span), thrust_between(sample, after, &sample->span));
    removal->change = length(sub(thrust_between(before, after, &joined), parts));
    return removal->error + removal->change > threshold;
}

/* Select the samples that change the integrals by more than `threshold`, m. Returns how many; max_count are written. */
static uint32_t select_warm_starts(const struct distance_profile *profile, const struct region *region,
                                   double threshold, struct removal removals[PROFILE_SAMPLES],
                                   struct warm_start *warm_starts, uint32_t max_count)
{
    uint32_t count = 0;
    const struct profile_sample *previous = NULL;
    double share_per_area = region->within > 0.0 ? 0.5 * profile->axis_length / region->within : 0.0;
    for (uint32_t i = 0; i < profile->sample_count; i++) {
        const struct profile_sample *sample = &profile->sample[i];
        if (sample->s > region->to)
            break;
        double next_s = i + 1 < profile->sample_count ? sample[1].s : sample->s;
        int must_keep = !previous || i + 1 == profile->sample_count || i == region->deepest;
        if (!must_keep && !is_worth_keeping(profile, previous, sample, threshold, &removals[i]))
            continue;
        double share = (profile->reach - sample->height) * (next_s - (previous ? previous->s : next_s));
        previous = sample;
        if (sample->s < region->from || sample->height == 0.0 || sample->triangle == DPT_NONE)
            continue;
        if (count < max_count)
            warm_starts[count] = (struct warm_start){ sample->s, sample->triangle, (float)(share * share_per_area) };
        count++;
    }
    return count;
}

uint32_t dpti_contact_region_warm_starts(const struct distance_profile *profile, const struct region *region,
                                         struct warm_start *warm_starts, uint32_t max_count)
{
    enum { THRESHOLD_STEPS = 32 };
    double threshold = profile->axis_length > 0.0 ? ERROR_IGNORED * region->within / profile->axis_length : 0.0;
    struct removal removals[PROFILE_SAMPLES];
    for (uint32_t i = 0; i < profile->sample_count; i++)
        removals[i].before = NULL;
    uint32_t count = select_warm_starts(profile, region, threshold, removals, warm_starts, max_count);
    for (int i = 0; i < THRESHOLD_STEPS && count > max_count; i++) {
        threshold *= 1.25;
        count = select_warm_starts(profile, region, threshold, removals, warm_starts, max_count);
    }
    return count < max_count ? count : max_count;
}
