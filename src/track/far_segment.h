/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Segments of a tool with `near_only` that need no search: docs/algorithms/near_only.md. What was proven of a segment's
 * distance holds in later ticks, less the motion of its ends and of the bodies. While that is beyond the margin, and no
 * less than the gap of the tool's nearest segment, the segment is far: its answer is a pair that was nearest before.
 */
#ifndef DPT_FAR_SEGMENT_H
#define DPT_FAR_SEGMENT_H

#include "track/world_state.h"

/* Whether far segments of a tool are left out. */
static inline int far_is_used(const struct dpt_world *world, const struct tool *tool)
{
    return tool->near_only && tool->segment_count > 1 && world->def.method == DPT_METHOD_EXACT;
}

/* The least of the segments that were searched for, m: of their surfaces, and of their axes. */
struct least_distance {
    double gap, distance;
};

static inline struct least_distance least_none(void)
{
    return (struct least_distance){ HUGE_VAL, HUGE_VAL };
}

/* Whether a segment of that radius whose axis is farther than `distance` is neither the nearest by its surface nor its axis. */
static inline int least_is_below(const struct least_distance *least, double distance, double radius)
{
    return distance > 0.0 && distance >= least->distance && distance - radius >= least->gap;
}

/* Take another one; 1 if its surface is the nearest. */
static inline int least_take(struct least_distance *least, double distance, double radius)
{
    const int is_nearest = distance - radius < least->gap;
    least->gap = min_of(least->gap, distance - radius);
    least->distance = min_of(least->distance, distance);
    return is_nearest;
}

/* Nothing is proven of the segment any more. */
void dpti_far_forget(struct segment *segment);

/* The same of all segments: a body appeared somewhere, or one is gone. */
void dpti_far_forget_all(struct dpt_world *world);

/* m: the proven lower bound of the distance between the axis from `a` to `b` and all bodies; 0 if nothing is known. */
double dpti_far_bound(const struct dpt_world *world, struct segment *segment, vec3 a, vec3 b);

/* The segment was searched for at its axis from `a` to `b`: its result is what is proven from now on. */
void dpti_far_prove(const struct dpt_world *world, struct segment *segment, vec3 a, vec3 b);

/*
 * A pair with the triangle that was nearest before, for the axis from `a` to `b`, into `track`. It may not be the nearest
 * any more; `lower_bound` m is proven of the distance, and `result` says so.
 */
void dpti_far_pair(const struct body *body, vec3 a, vec3 b, double lower_bound, struct dynamic_point *track,
                   struct segment_result *result);

#endif
