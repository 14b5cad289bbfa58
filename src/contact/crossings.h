/* SPDX-License-Identifier: BSD-3-Clause */
/* Where the axis of a profile goes through the surface, and where it is within reach. */
#ifndef DPT_CROSSINGS_H
#define DPT_CROSSINGS_H

#include "contact/profile_samples.h"

/*
 * All crossings and zones, as far as there is work left for them, and whether the axis goes through an open sheet without a
 * side.
 */
void dpti_profile_find_crossings(struct distance_profile *profile);

#endif
