/* SPDX-License-Identifier: BSD-3-Clause */
/* What lies in the caller's block. */
#ifndef DPT_WORLD_STATE_H
#define DPT_WORLD_STATE_H

#include "base/frame.h"
#include "base/handle.h"
#include "contact/sheet_border.h"
#include "dynpoint/baseline.h"
#include "dynpoint/world.h"
#include "force/fade.h"
#include "nearest/bvh.h"
#include "nearest/dynamic_point.h"
#include "strip/strip_state.h"
#include "sweep/sweep_rigid.h"
#include "world/broad_phase.h"

struct body {
    struct surface surface;
    struct frame frame;
    uint64_t user;
    dpt_pose pose;          /* what the frame is made of */
    dpt_pose previous_pose; /* that of the last tick, if it has moved since */
    double motion_bound;    /* by how far any of its points may have moved then */
    double side_limit;
    struct slot slot;
    uint32_t id;
    uint32_t moved_tick; /* the tick before which it last moved; 0: never */
    uint32_t added_tick; /* the tick before which it came */
};

struct tool {
    struct frame frame;
    uint64_t user;
    dpt_pose pose; /* of a rigid one */
    dpt_wrench wrench;
    double stiffness;
    uint32_t force_reason; /* DPT_FORCE_... */
    uint32_t force_flags;  /* DPT_FORCE_FLAG_... */
    struct slot slot;
    uint32_t first_segment; /* its segments in the world's list */
    uint32_t segment_count;
    uint32_t nearest_segment; /* the segment that speaks for the tool, from 0 */
    uint32_t is_free;         /* segments are in the world; torque is about the first one's end a */
};

/* The nearest pair over all bodies, and what is proven of it. */
struct body_answer {
    const struct body *body; /* NULL: there is none */
    struct track track;
    double lower_bound; /* what is not proven to be as far is no nearer than this */
    double error_bound; /* the error bound, of all bodies that were asked */
    uint32_t is_exact;
    uint32_t work;
};

/* Where a segment was in the last tick. */
struct motion_state {
    dpt_pose pose;        /* of its tool; the identity for a free one */
    vec3 a, b;            /* in the tool's frame */
    double free_distance; /* nothing was nearer to its axis */
    uint32_t is_known;    /* 0: it was nowhere */
    uint32_t is_crossing; /* its axis went through something */
    uint32_t tick;        /* when it came there */
    uint32_t reserved;
};

#define MOTION_STEPS_MAX 8

/*
 * With a budget: legs of one tick each that are still to be swept, and how far the first of them has come. `body` is the id of
 * the one at which it was stopped, or 0; those in slots before it are done.
 */
struct motion_backlog {
    struct motion_state
        motion_ends[MOTION_STEPS_MAX]; /* where the segment was at the end of each */
    uint32_t count;
    uint32_t body_id;
    uint32_t is_on_axis;       /* the body was met by the surface: now the axis is swept */
    uint32_t may_have_crossed; /* the axis may have gone through one that is done */
    uint32_t is_lost;          /* a body moved meanwhile: it cannot be gone on with */
    uint32_t reserved;
    double radius;   /* with which it was begun */
    dpt_sweep sweep; /* what was met of those that are done */
    struct rigid_sweep_result surface_result;
    struct rigid_sweep_progress progress;
};

/* Whose push it is. */
struct pushing_part {
    uint32_t body_id;         /* its id; 0: none */
    uint32_t part;            /* of its mesh */
    uint32_t is_behind_sheet; /* the part is an open sheet, and the tool behind it or through */
};

struct segment {
    vec3 a, b; /* in the tool's frame */
    double radius;
    dpt_hit hit;      /* what users get of the result, written when the tick has no more to add */
    struct fade fade; /* what is felt */
    struct pushing_part pushing_part; /* this tick's */
    struct pushing_part previous_pushing_part;
    struct border_view border;
    uint32_t fading_body_id; /* id of the body whose push fades */
    uint32_t force_reason;   /* DPT_FORCE_...; the last tick's, until this one responds */
    uint32_t
        has_given_up_push; /* this tick a decision ended the push of the last one, not motion */
    struct broad_phase broad_phase;
    struct body_answer answer; /* this tick's */
    struct segment_result result;
    struct penetration penetration;      /* at its deepest point */
    struct penetration felt_penetration; /* as it counts for the force */
    struct motion_state previous;
    dpt_sweep sweep;
    uint32_t may_have_crossed; /* on this tick's way the axis may have gone through something */
    uint32_t last_body_slot;   /* slot of the body that was nearest, or DPT_NONE */
    uint32_t tool_slot;        /* slot of its tool */
    uint32_t reserved;
};

/* With a budget: what is proven of a segment and a body. */
struct distance_bound {
    vec3 a, b;          /* the axis, in the body's frame, when this was last brought up to date */
    double lower_bound; /* nothing of the body was nearer to it than that */
    uint32_t rest_tick; /* the last tick to which it had not moved */
    uint32_t reserved;
};

/* With a budget: a segment's search that it stopped. There are two, one for motion and one for rest. */
struct suspended_search {
    struct bvh_traversal traversal;
    double lower_bound; /* nothing that was visited is nearer */
    uint32_t body_slot; /* slot that it searches */
    uint32_t next_slot; /* slot of the body to go on with, or DPT_NONE; in the first of the two */
};

#define WARM_STARTS_MAX 24

/* A region of contact, and what the next tick takes over from it. */
struct persistent_contact {
    dpt_contact contact;
    uint32_t segment_index; /* in the world's list */
    uint32_t part;          /* of the body's mesh */
    int32_t side;           /* of an open sheet, or 0 */
    uint32_t is_unseen;     /* it is kept, but this tick does not know it */
    uint32_t is_in_front; /* of the sheet whose side it has: all of the axis is known to be there */
    uint32_t warm_start_count;
    struct warm_start warm_starts[WARM_STARTS_MAX];
};

struct persistent_contacts {
    struct persistent_contact *items;
    uint32_t count;
    uint32_t reserved;
};

/* One segment and one body, this tick. */
struct contact_pair {
    struct dpt_world *world;
    const struct body *body;
    uint32_t segment_index;
    double radius;
    struct axis axis;
    struct pair_search nearest;
    struct sides sides;
    struct distance_profile *profile;
};

/* A segment's strip and where it lies, as of this tick. */
struct segment_strip {
    struct dpt_strip *strip;
    struct surface surface; /* of the body */
    struct frame frame;
    vec3 a, u; /* the axis in the body's frame */
    double radius;
    uint32_t body_slot;       /* slot, or DPT_NONE */
    int32_t side;             /* of its triangles on which the tool is: +1, -1 */
    uint32_t end_triangle[2]; /* places nearest to the ends, of a strip of routes; or DPT_NONE */
};

struct dpt_world {
    dpt_world_def def; /* its `baseline` is the next one */
    dpt_baseline_def baseline;
    struct kernel kernel;
    uint32_t kernel_id;
    uint32_t body_slot_end; /* slots from here on were never used */
    uint32_t tool_slot_end;
    uint32_t body_count;
    uint32_t tool_count;
    uint32_t segment_count;
    uint32_t freed_count[2];     /* how many slots of bodies and of tools were freed; may wrap */
    uint32_t invalid_body_count; /* bodies without a valid pose: every answer is stale then */
    struct work work;            /* of this tick, and its budget */
    uint32_t undone_segment;     /* the segment that the budget did not reach */
    dpt_world_usage usage;
    uint32_t ticks;               /* since the last reset; may wrap */
    uint32_t bodies_moved_tick;   /* the tick before which a body last moved */
    double body_motion_max;       /* the most that one moved then */
    uint32_t contacts_index;      /* which of the two is this tick's */
    uint32_t last_contact_id;     /* the last one that was given */
    uint32_t contacts_wanted;     /* this tick's, kept ones and those without room among them */
    uint32_t contacts_overflowed; /* this tick had more than there is room for */
    struct body *bodies;
    struct box *boxes; /* of the bodies, in the world */
    struct tool *tools;
    struct segment *segments;
    struct plane_cache plane_cache;
    uint32_t *
        last_triangles; /* per segment, body slot and part: the place of the last answer, or DPT_NONE */
    uint32_t *near_lists; /* per segment: the slots of the bodies on its two lists */
    struct suspended_search
        *suspended_searches;                /* per segment two; only with a budget, as the proofs */
    struct distance_bound *distance_bounds; /* per segment and body slot */
    struct motion_backlog *motion_backlogs; /* per segment */
    struct point_cache point_cache;         /* only with a budget */
    struct persistent_contacts contacts[2]; /* this tick's and the last one's */
    struct segment_strip *segment_strips;   /* per segment; only with strips */
    struct near_bodies near_bodies;         /* of the segment that is being looked at */
    struct distance_profile profile;        /* of that and the body that is being looked at */
};

/* A high-water mark of dpt_world_usage. */
static inline void world_note_max(uint32_t *mark, uint32_t count)
{
    if (*mark < count)
        *mark = count;
}

/* How many places are kept of one segment. */
static inline size_t world_last_triangle_count(const struct dpt_world *world)
{
    return (size_t)world->def.max_bodies * world->def.baseline->parts;
}

/* The places of a segment's parts on a body. */
static inline uint32_t *world_last_triangles(const struct dpt_world *world, uint32_t segment_index,
                                             uint32_t slot)
{
    return world->last_triangles + world_last_triangle_count(world) * segment_index +
           (size_t)slot * world->def.baseline->parts;
}

/* A segment's two lists, of at most max_bodies slots each. */
static inline uint32_t *world_near_list(const struct dpt_world *world, uint32_t segment_index,
                                        uint32_t list)
{
    return world->near_lists + (size_t)world->def.max_bodies * (2 * (size_t)segment_index + list);
}

/* For motion the first, for rest the second. */
static inline struct suspended_search *
world_suspended_search(const struct dpt_world *world, uint32_t segment_index, int is_resting)
{
    return &world->suspended_searches[2 * (size_t)segment_index + (is_resting != 0)];
}

static inline struct distance_bound *world_distance_bound(const struct dpt_world *world,
                                                          uint32_t segment_index, uint32_t slot)
{
    return world->distance_bounds + (size_t)world->def.max_bodies * segment_index + slot;
}

/* By what name the certificate knows a segment and a body; not 0. */
static inline uint32_t world_plane_owner(const struct dpt_world *world, uint32_t segment_index,
                                         uint32_t slot)
{
    return segment_index * world->def.max_bodies + slot + 1;
}

/* What an id names, or NULL. */
static inline struct tool *world_find_tool(const struct dpt_world *world, dpt_tool tool)
{
    uint32_t slot = handle_index(tool);
    if (slot >= world->tool_slot_end || !handle_fits(tool, HANDLE_TOOL, &world->tools[slot].slot))
        return NULL;
    return &world->tools[slot];
}

static inline struct body *world_find_body(const struct dpt_world *world, dpt_body body)
{
    uint32_t slot = handle_index(body);
    if (slot >= world->body_slot_end || !handle_fits(body, HANDLE_BODY, &world->bodies[slot].slot))
        return NULL;
    return &world->bodies[slot];
}

#endif
