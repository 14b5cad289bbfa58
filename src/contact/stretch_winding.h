/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The winding numbers of an axis between its crossings: away from holes one of them and the crossings tell the others
 * (docs/algorithms/winding.md, "Away from holes").
 */
#ifndef DPT_STRETCH_WINDING_H
#define DPT_STRETCH_WINDING_H

#include "contact/profile_samples.h"

/*
 * Find the winding number of each stretch of a profile whose crossings and holes are known; WINDING_UNKNOWN where a hole
 * is near, or where rounding may have missed a crossing. Parts of a stretch that are far from its holes become winding
 * ranges. If the work is spent, the profile is cut. Returns 1 if all stretches are known.
 */
int dpti_stretch_windings_find(struct distance_profile *profile);

#endif
