/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Points that a channel and its body share: docs/algorithms/insertion.md. A rigid body keeps its own. Of one that
 * deforms each is a mean of points of its surface: where lines through it, along the channel and across, meet that on
 * both sides. The shares are those of the straight line between two of them, so that they sum up to 1 and none is below
 * 0: where the surface moves as one, or stretches evenly, the point does likewise.
 */
#ifndef DPT_CHANNEL_POINTS_H
#define DPT_CHANNEL_POINTS_H

#include "insertion/channel.h"

/* Where a point is, in the body's frame. */
vec3 dpti_channel_point_at(const struct surface *surface, const struct channel_point *point);

/*
 * Add a point at `at`, in the body's frame, which is at `place` of the line. Does nothing where there is no room, where
 * the point is not within a surface that deforms, or where a budget ends the search.
 */
void dpti_channel_add_point(struct channel *channel, const struct surface *surface, const struct kernel *kernel,
                            vec3 at, double place, struct work *work);

/* The first point: on the surface, where the channel enters it, at channel->triangle. */
void dpti_channel_add_entry(struct channel *channel, const struct surface *surface);

/* The place of the next point that a tip which has come deeper makes. */
double dpti_channel_next_point(const struct channel *channel);

/*
 * m: of the shaft that a point holds across, where its bristles' anchor is at a place: from the point to the next one.
 * The first holds the rim of the hole, too: from the rupture on, but while the tip goes in or out again by and by.
 */
double dpti_channel_held_by(const struct channel *channel, uint32_t number, double anchor);

/* Of the mean of all points: the share of one, by what each holds. */
double dpti_channel_share(const struct channel *channel, uint32_t number, double anchor);

/* Where all points are, in the body's frame. */
void dpti_channel_points_at(const struct channel *channel, const struct surface *surface, vec3 at[CHANNEL_POINTS_MAX]);

/* Where a tip is by that mean: all in the body's frame. */
double dpti_channel_mean_place(const struct channel *channel, const vec3 at[CHANNEL_POINTS_MAX], double anchor,
                               vec3 tip, vec3 axis);

/*
 * Of a channel in a body that has deformed, find the line's mouth and direction again: from its last point, and towards
 * that from the first one if they are not too near.
 */
void dpti_channel_follow(struct channel *channel, const struct surface *surface);

/*
 * Find walls and layers again along a line that was changed, from the place `from` on. What was open stays open, and
 * layers that the tip has gone into keep their regions: a line that slides over their border is not of another law by
 * that. regions: as in struct channel_search. If the work is spent before the end they stay as they were. Returns 0 then.
 */
int dpti_channel_lay_again(struct channel *channel, const struct surface *surface, const uint8_t *regions,
                           const struct kernel *kernel, double from, struct work *work);

/* The next wall opens. */
void dpti_channel_open_wall(struct channel *channel);

#endif
