/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * How far a body's surface is from each point of an axis: the signed distance along the tool, as few samples as tell
 * its least value within DEPTH_SHARE of the mesh's diagonal, and its shape near the surface.
 * docs/algorithms/depth.md, docs/algorithms/contacts.md.
 */
#ifndef DPT_DISTANCE_PROFILE_H
#define DPT_DISTANCE_PROFILE_H

#include "contact/deepest_point.h"

/*
 * Make the profile of an axis. `nearest` is the axis' nearest pair with this body where that is known exactly, or
 * NULL. `seeds` are places of an earlier tick. Returns 0 when the axis is outside and nothing is within reach:
 * there is no contact then. Where it is cut, full or sideless, it may have no samples.
 *
 * First the caller sets surface, kernel, axis, sides, memo, regions, body, reach, tolerance and work.
 */
int dpti_profile_make(struct distance_profile *profile, const struct pair_search *nearest,
                      const struct warm_start *warm_starts, uint32_t warm_start_count);

/* Mark where the surface comes within reach and goes out of it, so that samples are wherever it is within. */
void dpti_profile_find_reach(struct distance_profile *profile);

/* Search between two samples for surface within reach that no sample tells of, where the axis is outside. */
void dpti_profile_search_undecided(struct distance_profile *profile, double min_s, double max_s);

/* Outside, and within a zone: between sample i and the next there is a stretch of which the two do not tell. Which. */
int dpti_profile_find_undecided(const struct distance_profile *profile, uint32_t i, double *from,
                                double *to);

#endif
