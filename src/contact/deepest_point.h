/* SPDX-License-Identifier: BSD-3-Clause */
/* How deep the axis of a profile is: docs/algorithms/depth.md. */
#ifndef DPT_DEEPEST_POINT_H
#define DPT_DEEPEST_POINT_H

#include "contact/profile_samples.h"

/*
 * Prove the deepest point of the inner part of an axis between two places, `from` and `to`, s in 0..1. Adds samples
 * until no point there can be deeper than the lowest sample by more than profile->tolerance, and confirms that sample
 * by a search. If work or room for samples ends before, the lowest exact sample is taken. Returns its index, or
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

#endif
