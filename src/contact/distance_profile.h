/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The distance profile of an axis and a body: the signed distance of the axis' points to the surface, known at samples.
 * It has as few samples as suffice for the least distance, within PROFILE_DEPTH_SHARE of the mesh's diagonal, and for
 * the shape near the surface. docs/algorithms/depth.md, docs/algorithms/contacts.md.
 */
#ifndef DPT_DISTANCE_PROFILE_H
#define DPT_DISTANCE_PROFILE_H

#include "contact/deepest_point.h"
#include "contact/profile_samples.h"

/*
 * Make the profile of an axis. The caller first sets the profile's surface, kernel, axis, sides, point_cache, body,
 * contacts_wanted, reach, tolerance and work.
 *
 *   nearest      the nearest pair of the axis and this body; exact
 *   warm_starts  samples of an earlier tick; may be NULL if there are none
 *
 * Returns 0 when the axis is outside and no surface is within reach: there is no contact then. Returns 1 otherwise. If
 * is_cut, is_full or is_sideless is set then, the profile may have no samples and `deepest` does not count.
 */
int dpti_profile_make(struct distance_profile *profile, const struct pair_search *nearest,
                      const struct warm_start *warm_starts, uint32_t warm_start_count);

/*
 * Put a sample or a mark at both ends of each reach interval, and search the undecided stretches. Afterwards each
 * stretch of the axis within reach has a sample, unless work or room runs out.
 */
void dpti_profile_find_reach(struct distance_profile *profile);

/*
 * Search the undecided stretches between samples from min_s to max_s, and add a sample to each that has surface within
 * reach. At most 16 are searched.
 */
void dpti_profile_search_undecided(struct distance_profile *profile, double min_s, double max_s);

/*
 * Find the undecided stretch between sample i and the next: the axis is outside there, a triangle can be within reach,
 * and neither sample's tangent reaches so far. Returns 0 if there is none, else 1 and its ends *from < *to, in s.
 */
int dpti_profile_find_undecided(const struct distance_profile *profile, uint32_t i, double *from, double *to);

/* ---- where the axis goes through the surface, and where the surface can be within reach ---- */

/*
 * Find all crossings of a profile, in order of s, and its reach intervals, and set is_sideless. If the work is spent
 * before, is_cut is 1; if there are more crossings than PROFILE_CROSSINGS, is_full is 1. The lists are incomplete then.
 */
void dpti_profile_find_crossings(struct distance_profile *profile);

/*
 * The winding numbers of an axis between its crossings: away from holes one of them and the crossings tell the others
 * (docs/algorithms/winding.md, "Away from holes").
 *
 * Find the winding number of each stretch of a profile whose crossings and holes are known; WINDING_UNKNOWN where a
 * hole is near, or where rounding may have missed a crossing. Parts of a stretch that are far from its holes become
 * winding ranges. If the work is spent, the profile is cut. Returns 1 if all stretches are known.
 */
int dpti_stretch_windings_find(struct distance_profile *profile);

#endif
