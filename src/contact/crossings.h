/* SPDX-License-Identifier: BSD-3-Clause */
/* Where the axis of a profile goes through the surface, and where the surface can be within reach. */
#ifndef DPT_CROSSINGS_H
#define DPT_CROSSINGS_H

#include "contact/profile_samples.h"

/*
 * Find all crossings of a profile, in order of s, and its reach intervals, and set is_sideless. If the work is spent
 * before, is_cut is 1; if there are more crossings than PROFILE_CROSSINGS, is_full is 1. The lists are incomplete then.
 */
void dpti_profile_find_crossings(struct distance_profile *profile);

#endif
