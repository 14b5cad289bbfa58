/* SPDX-License-Identifier: BSD-3-Clause */
/* How deep the axis of a profile is: docs/algorithms/depth.md. */
#ifndef DPT_DEEPEST_POINT_H
#define DPT_DEEPEST_POINT_H

#include "contact/profile_samples.h"

/*
 * From one place of the axis, inside, to another: split it until nothing can be deeper than the lowest sample by more than
 * the tolerance, and confirm that one by a search. Returns it, or DPT_NONE if there is no sample.
 */
uint32_t dpti_profile_prove_deepest(struct distance_profile *profile, double from, double to);

/* What the profile is between two samples: the heights' two tangents meet at `s`, `height`. */
struct bend {
    double s, height;
};
struct bend dpti_profile_bend(const struct distance_profile *profile,
                              const struct profile_sample *from, const struct profile_sample *to);

#endif
