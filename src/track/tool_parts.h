/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The parts of a tool: its segments, and then its tips. Their nearest pairs over all bodies where the tool's felt frame
 * is; the hits, contacts and life of tips: docs/algorithms/tips.md.
 *
 * With `near_only` some segments need no search: docs/algorithms/near_only.md. What was proven of a segment's distance
 * holds in later ticks, less the motion of its ends and of the bodies. While this bound exceeds the margin and the gap
 * of the tool's nearest segment, the segment is far: its answer is an earlier nearest pair.
 */
#ifndef DPT_TOOL_PARTS_H
#define DPT_TOOL_PARTS_H

#include "track/world_state.h"

/* A tool's tip, from 0. */
static inline struct tip *tool_tip(const struct dpt_world *world, const struct tool *tool, uint32_t number)
{
    return &world->tips[tool->first_tip + number];
}

/* A part of a tool: a segment or a tip, the other one NULL. Parts are numbered from 0, the segments first. */
struct part {
    struct segment *segment;
    struct tip *tip;
};

static inline uint32_t tool_part_count(const struct tool *tool)
{
    return tool->segment_count + tool->tip_count;
}

static inline struct part tool_part(const struct dpt_world *world, const struct tool *tool, uint32_t number)
{
    if (number < tool->segment_count)
        return (struct part){ .segment = &world->segments[tool->first_segment + number] };
    return (struct part){ .tip = tool_tip(world, tool, number - tool->segment_count) };
}

/* m: how far its surface is from its axis, or from its polyhedron. */
static inline double part_radius(struct part part)
{
    return part.tip ? part.tip->hull->radius : part.segment->radius;
}

static inline const dpt_hit *part_hit(struct part part)
{
    return part.tip ? &part.tip->hit : &part.segment->hit;
}

/* The nearest pair of a part and all bodies, by the last search. */
struct part_nearest {
    const struct body *body; /* NULL: no pair */
    uint32_t triangle;       /* place */
    uint32_t is_exact;
    double distance;    /* m */
    double lower_bound; /* m */
};

static inline struct part_nearest part_nearest(struct part part)
{
    if (part.tip) {
        const struct tip_answer *answer = &part.tip->answer;
        return (struct part_nearest){ answer->body, answer->nearest.triangle, answer->is_exact,
                                      answer->nearest.distance, answer->lower_bound };
    }
    const struct body_answer *answer = &part.segment->answer;
    const struct segment_result *result = &part.segment->result;
    return (struct part_nearest){ answer->body, answer->track.nearest.triangle, answer->is_exact, result->distance,
                                  result->lower_bound };
}

/* A box in the world of a tip's polyhedron, where the tool's frame is. */
struct box dpti_tip_box(const struct dpt_hull *hull, const struct frame *tool);

/* The same of a tip, or the box of a segment's axis. */
struct box dpti_part_box(struct part part, const struct frame *tool);

/*
 * The nearest pair of a tip and all bodies, with the tool's frame at `frame`. One body or triangle that was near is
 * tried first; the answer does not change what is remembered.
 */
void dpti_tip_find(const struct dpt_world *world, const struct tip *tip, const struct frame *frame, struct work *work,
                   struct tip_answer *answer);

/* Store this tick's answer of a tip, with the tool's frame at `frame`. */
void dpti_tip_know(const struct dpt_world *world, struct tip *tip, const struct frame *frame,
                   const struct tip_answer *answer);

/* Find the nearest pairs of all tips of a tool where it is, into their answers. */
void dpti_tips_track(struct dpt_world *world, struct tool *tool);

/*
 * Whether a tip is outside of the part that it is nearest to, where that part has an inside and no defects. Elsewhere
 * the tool's segments tell.
 */
int dpti_tip_is_outside(const struct tip *tip);

/*
 * Hits of the tips, from their answers; of a tool that is held away from its device with `device`, the device's frame.
 */
void dpti_tips_write_hits(const struct dpt_world *world, const struct tool *tool, const struct frame *device,
                          struct work *work);

/* Contacts of the tips, from their answers. */
void dpti_tips_find_contacts(struct dpt_world *world, struct tool *tool);

/* How many contacts a tool's tips have; the first `capacity` of them into `contacts`, `stride` bytes apart. */
uint32_t dpti_tips_get_contacts(const struct dpt_world *world, const struct tool *tool, void *contacts,
                                uint32_t capacity, uint32_t stride);

/* Make the hits of the tips stale, at the start of a step that computes them. */
void dpti_tips_clear(struct dpt_world *world, struct tool *tool);

/* Forget what earlier steps know. */
void dpti_tips_forget(struct dpt_world *world, struct tool *tool);

/* Forget a body, by its id, for all tools. */
void dpti_tips_forget_body(struct dpt_world *world, uint32_t body_id);

/* Make room for tips of a tool that has none, behind those of all others. The world must have the capacity. */
struct tip *dpti_tips_add(struct dpt_world *world, struct tool *tool, uint32_t count);

/* Remove the tool's tips; those of other tools move up. */
void dpti_tips_remove(struct dpt_world *world, struct tool *tool);

/* Whether far segments of a tool are left out. */
static inline int far_is_used(const struct dpt_world *world, const struct tool *tool)
{
    return tool->near_only && tool->segment_count > 1 && world->def.method == DPT_METHOD_EXACT;
}

/* The minimum over the segments that were searched for, m: of their surfaces, and of their axes. */
struct min_distance {
    double gap, distance;
};

static inline struct min_distance min_distance_none(void)
{
    return (struct min_distance){ HUGE_VAL, HUGE_VAL };
}

/* Whether a segment whose axis is farther than `distance` is the nearest neither by its surface nor by its axis. */
static inline int min_distance_is_below(const struct min_distance *min, double distance, double radius)
{
    return distance > 0.0 && distance >= min->distance && distance - radius >= min->gap;
}

/* Add a segment; 1 if its surface is the nearest so far. */
static inline int min_distance_take(struct min_distance *min, double distance, double radius)
{
    const int is_nearest = distance - radius < min->gap;
    min->gap = min_of(min->gap, distance - radius);
    min->distance = min_of(min->distance, distance);
    return is_nearest;
}

/* Forget what is proven of a segment's distance. */
void dpti_far_forget(struct segment *segment);

/* With near_only, a segment's pair was found at its axis from `a` to `b`: its result is what is proven from now on. */
void dpti_far_prove(const struct dpt_world *world, struct segment *segment, vec3 a, vec3 b);

/* Forget that of all segments: a body appeared somewhere, or one is gone. */
void dpti_far_forget_all(struct dpt_world *world);

/*
 * A pair with the triangle that was nearest before, for the axis from `a` to `b`, into `track`. It may not be the
 * nearest any more; `lower_bound` m is proven of the distance, and `result` says so.
 */
void dpti_far_pair(const struct body *body, vec3 a, vec3 b, double lower_bound, struct dynamic_point *track,
                   struct segment_result *result);

/* End a segment's answer of the last tick. Returns 0 if its tool or a body has no valid input: it gets no new one. */
int dpti_track_begin(struct dpt_world *world, uint32_t segment_index);

/* Find the nearest pair of a segment, into segment->answer and segment->result. */
void dpti_track_segment(struct dpt_world *world, uint32_t segment_index);

/*
 * The same of all segments of a tool with `near_only`, the one first that was nearest before. Those that are far are
 * not searched for. `all_outside`: the whole tool is known to be outside of everything; else what is known of each
 * segment counts.
 */
void dpti_track_near(struct dpt_world *world, struct tool *tool, int all_outside);

/* Search for the pair of a segment that was left out as far. */
void dpti_track_far(struct dpt_world *world, uint32_t segment_index);

#endif
