/* SPDX-License-Identifier: BSD-3-Clause */
/* How deep the axis of a profile is: docs/algorithms/depth.md. */
#ifndef DPT_DEEPEST_POINT_H
#define DPT_DEEPEST_POINT_H

#include "contact/profile_samples.h"

/*
 * Prove the deepest point of the inner part of an axis between two places, `from` and `to`, s in 0..1. Adds samples
 * until no point there can be deeper than the lowest sample by more than profile->tolerance, and confirms that sample
 * by a search. If work or room for samples runs out first, the lowest exact sample is taken. Returns its index, or
 * DPT_NONE if there is no sample between the two places.
 */
uint32_t dpti_profile_prove_deepest(struct distance_profile *profile, double from, double to);

/* Where the tangents of the height at two samples meet: at s, 0..1, with this height in m. */
struct bend {
    double s, height;
};

/* The bend between two samples; at one of them, or halfway, where the tangents do not meet between them. */
struct bend dpti_profile_bend(const struct distance_profile *profile, const struct profile_sample *from,
                              const struct profile_sample *to);

/* ---- spans: the height between a sample of a profile and the next, with an error estimate ---- */

/* A piece of the profile on which the height is linear and the exit direction is that of one sample. */
struct profile_piece {
    double s0, s1;
    double w0, w1; /* reach - height at s0 and s1, m */
    vec3 normal;   /* the exit direction, in the body's frame */
};

/* Cut off the part of a piece that is beyond reach. Returns 0 if nothing is left. */
static inline int clip_to_reach(struct profile_piece *piece)
{
    double w0 = piece->w0, w1 = piece->w1;
    if (!(w0 > 0.0) && !(w1 > 0.0))
        return 0;
    if (w0 >= 0.0 && w1 >= 0.0)
        return 1;
    double zero = piece->s0 + (piece->s1 - piece->s0) * (w0 / (w0 - w1));
    if (w0 < 0.0) {
        piece->s0 = zero;
        piece->w0 = 0.0;
    } else if (w1 < 0.0) {
        piece->s1 = zero;
        piece->w1 = 0.0;
    }
    return 1;
}

/* The integral over s of the positive part of w, which is linear from w0 at s0 to w1 at s1. */
static inline double area_within_reach(double s0, double w0, double s1, double w1)
{
    if (w0 >= 0.0 && w1 >= 0.0)
        return 0.5 * (w0 + w1) * (s1 - s0);
    struct profile_piece piece = { s0, s1, w0, w1, { 0.0, 0.0, 0.0 } };
    return clip_to_reach(&piece) ? 0.5 * (piece.w0 + piece.w1) * (piece.s1 - piece.s0) : 0.0;
}

/* Compute the span between two samples, or a sample and a mark, but for the error of its exit directions. */
void dpti_span_measure(const struct distance_profile *profile, const struct profile_sample *from,
                       const struct profile_sample *to, struct span *span);

/* Compute the span between a sample and the next, with the error of its exit directions. */
void dpti_span_store(const struct distance_profile *profile, struct profile_sample *from);

/*
 * The place s between sample i, whose span is known, and the next where another sample improves the span most: where
 * the surface goes out of reach, or at the bend.
 */
double dpti_span_next_sample(const struct distance_profile *profile, uint32_t i);

/* The span between sample i and the next, computed once. */
static inline const struct span *span_at(struct distance_profile *profile, uint32_t i)
{
    if (!profile->sample[i].has_span)
        dpti_span_store(profile, &profile->sample[i]);
    return &profile->sample[i].span;
}

#endif
