/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The structs that lie in a world's block.
 *
 * How things are numbered in src/world: an `id` is the public handle of a body or tool, a `slot` its place in the
 * world's array. A `segment_index` counts the segments of all tools. A `triangle` is a place: the index in the file's
 * order (mesh/surface.h); only what users get has source numbers.
 */
#ifndef DPT_WORLD_STATE_H
#define DPT_WORLD_STATE_H

#include "base/frame.h"
#include "base/handle.h"
#include "contact/sheet_border.h"
#include "contact/winding_number.h"
#include "dynpoint/baseline.h"
#include "dynpoint/body.h"
#include "dynpoint/tool.h"
#include "force/bed.h"
#include "force/fade.h"
#include "force/rupture.h"
#include "force/spring.h"
#include "hull/hull_search.h"
#include "nearest/bvh.h"
#include "nearest/dynamic_point.h"
#include "strip/strip_state.h"
#include "sweep/sweep_rigid.h"
#include "track/broad_phase.h"

struct body {
    struct surface surface;
    struct holes holes; /* of the surface, if it refers to them */
    struct frame frame;
    uint64_t user;
    dpt_pose pose; /* the frame is made of it */
    /* The pose in the last tick, if the body has moved since. */
    dpt_pose previous_pose;
    double motion_bound; /* m: since then, no point of it has moved farther */
    double side_limit;   /* m; 0: a quarter of the mesh's diagonal */
    struct slot slot;
    uint32_t id;
    uint32_t moved_tick; /* the tick before which it last moved; 0: never */
    uint32_t added_tick; /* the tick before which it was added or teleported */
    double diagonal;     /* m: of its surface's box */
    double static_friction, kinetic_friction;
    double stiffness;   /* N/m, of the surface; 0: rigid */
    uint32_t unfelt;    /* 1: tools ignore it */
    uint32_t held_tick; /* the tick before which it was last held where it was; 0: never */
    struct pierce_law pierce;
};

struct tool {
    struct frame felt_frame; /* where a tick looks for bodies: at the proxy or, without one, at the device */
    uint64_t user;
    dpt_pose pose; /* the identity for a free tool */
    dpt_wrench wrench;
    double stiffness;            /* N/m */
    double rotational_stiffness; /* Nm/rad; 0: by its shape */
    double damping;              /* Ns/m, of the proxy */
    dpt_force_fn shape;          /* NULL: none */
    void *shape_user;
    double energy;    /* J, of this tick */
    double body_work; /* J, in this tick: of moving bodies on it */
    uint32_t law;     /* DPT_LAW_... */
    uint32_t lock_rotation;
    uint32_t force_reason; /* DPT_FORCE_... */
    uint32_t force_flags;  /* DPT_FORCE_FLAG_... */
    struct slot slot;
    uint32_t first_segment, segment_count; /* index in the world's segments; its others follow */
    uint32_t first_tip;                    /* index in the world's tips; its others follow */
    uint32_t tip_count;
    /* The segment whose hit is the tool's; counts from first_segment, and tips go on from segment_count. */
    uint32_t nearest_segment;
    /* Its segments are given in the world, and its torque is about end a of the first one. */
    uint32_t is_free;
    uint32_t has_changed; /* since the last step, in what it depends on (rest.h) */
    uint32_t search;      /* how this tick finds its answers and its force: a row of world/step.c */
    uint32_t force;
    uint32_t still_ticks;   /* in a row, up to the last */
    uint32_t near_only;     /* segments that are far are not searched for (tool_parts.h) */
    uint32_t has_late_hits; /* those of the last step are found when they are read (tool_results.c) */
    uint32_t closest;       /* the segment, from 0, that was nearest in the last search; with near_only */
    /*
     * Its wrench on rigid bodies in this tick, about the origin of its torque. Only with deformable bodies in the
     * world.
     */
    dpt_wrench on_rigid;
    /* Of the last step that had an answer, before any shaper: the wrench, and the point in the world that it is about. */
    dpt_wrench law_wrench;
    vec3 law_origin;
    uint32_t piercing; /* DPT_PIERCING_... */
};

/* Where a tool pushes a body: src/proxy/tool_loads.c. */
struct load_note {
    uint32_t tool_slot;
    uint32_t segment; /* of the tool, from 0; tips go on from its segment_count */
    uint32_t body_id;
    uint32_t triangle; /* source number */
    uint32_t contact;  /* id; 0: the law does not push by contacts */
    uint32_t reserved;
    vec3 at;         /* in the world */
    vec3 force;      /* on the body, in the world; as the law has it, before a fade or a damper */
    vec3 about_body; /* the origin of the body's frame, in the world */
};

/* The nearest pair of a tip and all bodies. */
struct tip_answer {
    const struct body *body; /* NULL: no pair */
    struct hull_nearest nearest;
    vec3 p, q; /* in the world */
    double lower_bound;
    uint32_t is_exact;
    uint32_t reserved;
};

/* A convex part of a tool, in the tool's frame. */
struct tip {
    const struct dpt_hull *given; /* in a frame of its own */
    const struct dpt_hull *hull;  /* the same at `pose`: itself, or the world's tip_hulls has it */
    dpt_pose pose;                /* where it is in the tool's frame */
    dpt_pose wanted;              /* and where it goes */
    double trust;                 /* m: the longest motion of the tip that is tried at once */
    vec3 home_a, home_b;          /* its axis in the tool's frame where the tool was given it */
    struct tip_answer answer;     /* this tick's */
    struct frame answer_frame;    /* where the tool's frame was for it */
    uint32_t answer_tick;         /* in which it was found */
    uint32_t reserved;
    dpt_hit hit;
    dpt_contact contact;    /* id 0: it has none */
    uint32_t last_body_id;  /* the nearest in the last search; 0: none */
    uint32_t last_triangle; /* place, on that body */
};

enum { PROXY_MEMORY = 8, PROXY_CONTACTS_MAX = 6 };

/* A triangle that a proxy remembers. */
struct proxy_triangle {
    uint32_t segment;  /* of the tool, from 0; tips go on from its segment_count */
    uint32_t body_id;  /* 0: the entry is empty */
    uint32_t triangle; /* place */
};

/* A contact of a proxy with a body that has friction. */
struct proxy_contact {
    vec3 slip;            /* m, in the world: from where it stuck to where it is */
    double s;             /* on the segment, 0..1 */
    vec3 at;              /* where the surface touches, in the tool's frame */
    uint32_t body_id;     /* 0: the entry is empty */
    uint32_t segment;     /* of the tool, from 0; tips go on from its segment_count */
    double turned;        /* rad, about the normal: from where it stuck */
    uint32_t is_slipping; /* in the last motion */
    uint32_t age;         /* ticks in which it has held nothing */
    uint32_t has_slipped; /* in any motion of this tick */
    uint32_t reserved;
};

/* What is known about the place of a proxy. */
enum {
    PROXY_NONE,    /* it starts at the device's pose */
    PROXY_PLACED,  /* it was put at the device's pose, perhaps inside a body */
    PROXY_DOUBTED, /* it has gone through nothing, but a body may have appeared around it */
    PROXY_OUTSIDE  /* it is outside of everything, and came there by free motion */
};

/* How a tool can turn: a ball not at all, a straight one about two axes. */
enum { PROXY_BALL, PROXY_STRAIGHT, PROXY_BENT };

/* Of a tool with DPT_LAW_PROXY. */
struct proxy {
    dpt_pose pose;        /* of the tool's frame */
    dpt_pose device_pose; /* the device's, in the last tick */
    vec3 centre;          /* of the segments, in the tool's frame */
    vec3 axis;            /* unit, of a straight tool, in its frame */
    struct coupling coupling;
    double extent;         /* m: how far the segments' points are from the centre, at most */
    double gap;            /* m: the tool's surface is at least so far from all bodies of the last tick */
    double min_gap;        /* m: the least that is allowed */
    double trust;          /* m: the longest motion that is tried at once */
    double last_motion;    /* m */
    double owed;           /* m: the motion of the last tick that the budget prevented */
    double lag;            /* m */
    double tip_motion;     /* m: how far tips moved in the tool's frame in the last tick, at most */
    double length, radius; /* m: of a free tool, the device's */
    /*
     * The parts of the displacement from the device to the proxy that are not felt: what surfaces yield, and the motion
     * that only a budget ended. Then the energy that the surfaces store, J.
     */
    struct displacement yielded;
    double yielded_energy;
    double body_work; /* J, in this tick */
    /* The pull of friction in the last tick: m, and about the centre m^2. Times the stiffness this is N and Nm. */
    vec3 pull_shift, pull_turn;
    struct displacement felt; /* the rest of it, in the last tick; 0: no force */
    struct fade fade;
    uint64_t folds;
    uint32_t flags;      /* DPT_FORCE_FLAG_... of this tick */
    uint32_t reason;     /* DPT_FORCE_... of this tick */
    uint8_t state;       /* PROXY_... */
    uint8_t shape;       /* PROXY_BALL, ... */
    uint8_t is_held;     /* it is not where the device is */
    uint8_t is_released; /* a body that it remembers was removed or teleported: its push ends at once */
    uint8_t is_behind;   /* a budget makes it wait, or the felt force has not caught up since */
    uint8_t reserved[3];
    struct proxy_triangle memory[PROXY_MEMORY];
    struct proxy_contact contacts[PROXY_CONTACTS_MAX];
    /* From here on a tick may change it although it stands still. */
    struct displacement last_felt; /* that of the last tick, and where the device was in it */
    dpt_pose last_device_pose;
    /*
     * The end of its last step with tissue (src/tissue), and its motion in that; without one since the world's last
     * step, where it was before that. While it is put or doubted, its home: from there it has a side of each surface.
     */
    dpt_pose end;
    struct displacement end_motion;
    struct displacement pushed, last_pushed; /* over the stiffness: with a damper not what is felt */
    double stored, last_stored;              /* J, then by surfaces that yield */
    uint16_t sticking, slipping;             /* contacts with friction */
    uint8_t is_ended;                        /* there was such a step since the world's last one */
    uint8_t is_led; /* friction held it there, so the proxy follows that pose, not the device */
    uint8_t is_sliding, has_home;
    double pace;                 /* m: after a wait, how far the felt displacement may change in this tick */
    uint32_t used[PROXY_MEMORY]; /* the clock when each triangle of `memory` was used last */
    uint32_t clock;
    uint32_t tick;           /* the world's, of its last step */
    uint32_t home_tick;      /* of the pose at home */
    uint8_t is_still;        /* the last tick left it as it was */
    uint8_t has_been_inside; /* since it left its home, by contact */
    float free_turn[3];      /* of the device's orientation, w >= 0, when the proxy was there last */
    double body_path;        /* m: of the world, in its last step */
};

/* The nearest pair over all bodies, and what is proven about it. */
struct body_answer {
    const struct body *body; /* NULL: no pair */
    struct dynamic_point track;
    double lower_bound; /* m: the distance is at least the smaller of this and the pair's */
    double error_bound; /* m: the largest of the searched bodies */
    uint32_t is_exact;
    uint32_t work;   /* units */
    uint32_t is_far; /* it was not searched for (tool_parts.h) */
    uint32_t tick;   /* in which it was found */
};

/* What is known of a segment's distance from all bodies, with near_only. */
struct proven_distance {
    vec3 a, b;           /* the ends of the axis, in the world */
    double distance;     /* m: no body is nearer to it; 0: nothing is known */
    double error;        /* m: of lengths near it */
    uint32_t tick;       /* up to which the motion of bodies is counted */
    uint32_t is_outside; /* at the end of that tick it was outside of everything */
};

/* A segment at the end of a tick: one end of a motion. */
struct motion_state {
    dpt_pose pose;        /* of its tool; the identity for a free one */
    vec3 a, b;            /* in the tool's frame */
    double free_distance; /* m: no body was nearer to the axis */
    uint32_t is_known;    /* 0: the segment had no valid answer, so no motion begins here */
    uint32_t is_crossing; /* the axis is known to touch or cross a surface */
    uint32_t tick;        /* in which it came there */
    uint32_t reserved;
};

#define MOTION_STEPS_MAX 8

/*
 * The motion steps, of one tick each, that still have to be swept, and the progress of the first.
 * Bodies in lower slots than that of `body_id` are swept already.
 */
struct motion_backlog {
    struct motion_state motion_ends[MOTION_STEPS_MAX]; /* the segment at the end of each step */
    uint32_t count;
    uint32_t body_id;          /* the body at which the budget ended the sweep; 0: none */
    uint32_t is_on_axis;       /* the tool's surface has met that body: now the axis is swept */
    uint32_t may_have_crossed; /* the axis may have gone through a body that is swept already */
    uint32_t is_lost;          /* a near body moved meanwhile: the sweep cannot be continued */
    uint32_t reserved;
    double radius;   /* of the segment when the sweep of the first step began */
    dpt_sweep sweep; /* the first hit with the bodies that are swept already */
    struct rigid_sweep_result surface_result;
    struct rigid_sweep_progress progress;
};

/* The part of a body that pushes a segment. */
struct pushing_part {
    uint32_t body_id; /* 0: none */
    uint32_t part;    /* of its mesh */
    /* The part is an open sheet whose side is known, and the deepest point is not in front of it. */
    uint32_t is_behind_sheet;
    uint32_t triangle; /* place: the nearest to the deepest point */
};

/* For worlds without contacts: the samples of a segment's last profile with a body that decide its depth. */
enum { DEPTH_SAMPLES_MAX = 16 };
struct depth_samples {
    uint32_t body_id; /* 0: there are none */
    uint32_t count;
    struct warm_start at[DEPTH_SAMPLES_MAX];
};

/* A segment where the device was in the last step. */
struct device_axis {
    vec3 a, b;    /* in the world */
    double apart; /* m: no point of it is farther from where it was at the proxy */
};

struct segment {
    vec3 a, b; /* in the tool's frame */
    double radius;
    dpt_hit hit;                      /* as users get it; written from `result` when the tick adds nothing more */
    struct fade fade;                 /* the wrench that is felt */
    double energy;                    /* J: that its law stores in this tick */
    double body_work;                 /* J, in this tick: of the body that pushes it */
    struct pushing_part pushing_part; /* this tick's */
    struct pushing_part previous_pushing_part;
    struct border_view border;
    uint32_t fading_body_id; /* the body whose push fades */
    uint32_t force_reason;   /* DPT_FORCE_...; last tick's until this tick responds */
    /* A decision, not the motion, ended the previous part's push in this tick. */
    uint32_t has_given_up_push;
    struct broad_phase broad_phase;
    struct proven_distance proven;
    struct body_answer answer;           /* this tick's */
    struct device_axis device;           /* this tick's, where a proxy is held away from it */
    struct segment_result result;        /* this tick's */
    struct penetration penetration;      /* at the deepest point, in the world */
    struct penetration felt_penetration; /* the force uses it: reduced near a sheet's border */
    struct bed_depth bed_depth;          /* for DPT_LAW_BED */
    struct depth_samples depth_samples;
    uint32_t contact_work; /* units that the last tick's contact took in all; 0: it was not decided, or had none */
    struct motion_state previous; /* where the next motion to be swept begins */
    dpt_sweep sweep;
    uint32_t may_have_crossed; /* in this tick's motion the axis may have gone through a surface */
    uint32_t last_body_slot;   /* the body that was nearest in the last tick, or DPT_NONE */
    uint32_t tool_slot;
    uint32_t still_triangle; /* place: the nearest at the end of the last tick */
    double still_distance2;  /* m^2: and how far it was */
};

/* With a budget: the distance that is proven between a segment and a body. */
struct distance_bound {
    vec3 a, b;            /* the axis, in the body's frame, at the last update */
    double lower_bound;   /* m: no point of the body was nearer to that axis */
    uint32_t rest_tick;   /* the last tick in which neither the axis had moved in the body's frame nor its vertices */
    float surface_motion; /* m: how far vertices have moved since the last update, at most */
};

/* With a budget: a search that the budget ended. A segment has two: one of its motion, one of its rest. */
struct suspended_search {
    struct bvh_traversal traversal; /* level 0: no search is suspended */
    double lower_bound;             /* m: nothing that the search has excluded is nearer */
    uint32_t body_slot;             /* the body that it searches */
    /* The body to begin the next tick with, or DPT_NONE; used in the first of the two. */
    uint32_t next_slot;
};

#define WARM_STARTS_MAX 24

/* A contact, and what the next tick takes over from it. */
struct persistent_contact {
    dpt_contact contact;
    uint32_t segment_index; /* in the world's segments */
    uint32_t part;          /* of the body's mesh */
    /* The side of the open sheet from which the tool came: +1 in front, -1 behind; 0: none is known. */
    int32_t side;
    uint32_t is_unseen; /* carried over: this tick does not know the contact */
    uint32_t warm_start_count;
    uint32_t is_in_front; /* the whole axis is known to be on `side` of the sheet */
    struct warm_start warm_starts[WARM_STARTS_MAX];
};

struct persistent_contacts {
    struct persistent_contact *items;
    uint32_t count;
    uint32_t reserved;
};

/* One segment and one body, in this tick. */
struct contact_pair {
    struct dpt_world *world;
    const struct body *body;
    uint32_t segment_index;
    double radius;
    struct axis axis;
    struct pair_search nearest;  /* the nearest pair of the two */
    struct sides sides;          /* of the body's open sheets, from the last tick */
    struct bed_depth *bed_depth; /* NULL: the tool's law needs none */
    struct distance_profile *profile;
};

/* A segment's strip, and the pose for which it was made in this tick. */
struct segment_strip {
    struct dpt_strip *strip;
    struct surface surface; /* of the body */
    struct frame frame;     /* of the body */
    vec3 a, u;              /* the axis in the body's frame: a + s u */
    vec3 a_last, u_last;    /* where it was in the step before; as now, if it is new */
    int is_new;             /* 1: it was not near this body in the step before */
    uint32_t tick;          /* of the last step in which it was near a body */
    double radius;
    uint32_t body_slot;       /* or DPT_NONE */
    int32_t side;             /* on which the tool is: +1 in front of the triangles, -1 behind */
    uint32_t end_triangle[2]; /* of a strip of routes: the nearest to the ends, or DPT_NONE */
};

struct dpt_world {
    dpt_world_def def; /* its `baseline` points to the next field */
    dpt_baseline_def baseline;
    struct kernel kernel;
    uint32_t body_slot_end, tool_slot_end; /* slots from here on were never used */
    uint32_t body_count;
    uint32_t unfelt_body_count; /* of them, those that tools do not find */
    uint32_t deform_count;      /* of them, those with vertices of their own */
    uint32_t tool_count, segment_count, tip_count;
    uint32_t freed_count[2];      /* slots of bodies [0] and tools [1] freed so far; may wrap */
    uint32_t invalid_body_count;  /* without a valid pose; above 0 every answer is stale */
    struct work work;             /* this tick's, with its budget */
    uint32_t sweep_work_left;     /* units that the sweeps of this tick may still take */
    uint32_t undone_segment;      /* index of the first segment that the budget left undone */
    dpt_world_info usage;         /* with the kernel */
    uint64_t steps;               /* since it was created, that succeeded */
    double time;                  /* s: the sum of their dt */
    uint32_t ticks;               /* the number of the present tick, from 1 on, or of the last one; may wrap */
    uint32_t bodies_moved_tick;   /* the tick before which a body last moved */
    uint32_t bodies_put_tick;     /* the tick before which a body was last added, removed, teleported, or felt or not */
    double body_motion_max;       /* m: the largest motion_bound of the bodies that moved then */
    double body_motion_before;    /* m: the sum of that over earlier ticks */
    double largest_diagonal;      /* m: of all bodies */
    uint32_t contacts_index;      /* which of `contacts` is this tick's */
    uint32_t last_contact_id;     /* the newest id of a contact */
    uint32_t contacts_wanted;     /* contacts of this tick, carried over and dropped ones included */
    uint32_t contacts_overflowed; /* this tick had more than max_contacts */
    uint32_t has_changed;         /* bodies or their settings have, since the last step (rest.h) */
    struct body *bodies;          /* by slot */
    struct box *boxes;            /* of the bodies, in the world, by slot */
    struct tool *tools;           /* by slot */
    struct segment *segments;     /* of all tools, without gaps */
    struct tip *tips;             /* likewise */
    struct dpt_hull *tip_hulls;   /* one a tip: its hull, where that is moved in the tool's frame */
    struct plane_cache plane_cache;
    /* Per segment and body slot: the place of the triangle of the last answer, or DPT_NONE. */
    uint32_t *last_triangles;
    uint32_t *part_triangles; /* the same of the paper's method alone, of each part of a segment (baseline_method.h) */
    uint32_t *near_lists;     /* per segment: two lists of body slots (broad_phase.h) */
    struct suspended_search *suspended_searches; /* only with a budget: two per segment */
    struct distance_bound *distance_bounds;      /* likewise: per segment and body slot */
    struct point_cache point_cache;              /* likewise */
    struct motion_backlog *motion_backlogs;      /* per segment */
    struct persistent_contacts contacts[2];      /* this tick's and last tick's */
    struct segment_strip *segment_strips;        /* per segment; only with strips */
    struct proxy *proxies;                       /* one a tool; only where the world responds */
    struct proxy_patch *patches;                 /* likewise, one a segment */
    struct channel *channels;                    /* def.max_channels of them; NULL: nothing can be pierced */
    struct piercing_tool *piercing_tools;        /* one a tool, with channels alone */
    struct body_regions *body_regions;           /* one a body, with channels alone */
    uint32_t last_channel_id;
    struct load_note *loads; /* of the last step; a tool's in the order of its law */
    uint32_t load_count;
    struct near_bodies near_bodies;  /* of the segment in work */
    struct distance_profile profile; /* of the segment and body in work */
};

/* 1 if a tool's answers can be known: its input and that of all bodies can be used. */
static inline int tool_is_active(const struct dpt_world *world, const struct tool *tool)
{
    return tool->slot.used && tool->slot.valid && !world->invalid_body_count;
}

/* Where the device is, whether a proxy is away from it or not. */
static inline struct frame tool_device_frame(const struct tool *tool)
{
    struct frame frame;
    frame_of_pose(&tool->pose, &frame);
    return frame;
}

/* The point, in the world, that the torque of a tool without a proxy is about. */
static inline vec3 tool_torque_origin(const struct dpt_world *world, const struct tool *tool)
{
    return tool->is_free ? world->segments[tool->first_segment].a : tool->felt_frame.origin;
}

/* 1 if anything has changed since the last step that the tool's answers depend on (rest.h). */
static inline int tool_has_changed(const struct dpt_world *world, const struct tool *tool)
{
    return world->has_changed || tool->has_changed;
}

/* 1 if there is a body in this slot that tools can find. */
static inline int body_is_there(const struct body *body)
{
    return body->slot.used && !body->unfelt;
}

/* The tick to which changes between steps belong, such as the motion of a body. */
static inline uint32_t world_coming_tick(const struct dpt_world *world)
{
    return world->ticks + 1;
}

/* 1 if that was the tick before the present one. */
static inline int world_was_last_tick(const struct dpt_world *world, uint32_t tick)
{
    return tick + 1 == world->ticks;
}

/* 1 if a body moved before this tick, from a pose that it had in the last one. */
static inline int body_has_moved(const struct dpt_world *world, const struct body *body)
{
    return body->moved_tick == world->ticks && body->added_tick != world->ticks;
}

/* m: how far any point of a body moved before this tick, at most. */
static inline double world_body_motion(const struct dpt_world *world)
{
    return world->bodies_moved_tick == world->ticks ? world->body_motion_max : 0.0;
}

/* m: no point of any body has moved farther since the world began, but for those added since. */
static inline double world_body_path(const struct dpt_world *world)
{
    return world->body_motion_before + world->body_motion_max;
}

/*
 * Limit a sweep to the work that this tick's sweeps have left. Returns the work before, for world_end_sweep. Without it
 * a sweep may take all that is left of the tick's work.
 */
static inline struct work world_begin_sweep(struct dpt_world *world)
{
    const struct work before = world->work;
    work_limit_to(&world->work, world->sweep_work_left);
    return before;
}

static inline void world_end_sweep(struct dpt_world *world, const struct work *before)
{
    const uint32_t spent = world->work.done - before->done;
    world->sweep_work_left -= spent < world->sweep_work_left ? spent : world->sweep_work_left;
    world->work.limit = before->limit;
}

/* Raise a high-water mark of dpt_world_info to `count`. */
static inline void world_note_max(uint32_t *mark, uint32_t count)
{
    if (*mark < count)
        *mark = count;
}

/* The last triangle of a segment on the body in a slot. */
static inline uint32_t *world_last_triangle(const struct dpt_world *world, uint32_t segment_index, uint32_t slot)
{
    return world->last_triangles + (size_t)world->def.max_bodies * segment_index + slot;
}

/* One of a segment's two near lists, 0 or 1: room for max_bodies slots. */
static inline uint32_t *world_near_list(const struct dpt_world *world, uint32_t segment_index, uint32_t list)
{
    return world->near_lists + (size_t)world->def.max_bodies * (2 * (size_t)segment_index + list);
}

/* A segment's suspended search of its motion or of its rest. */
static inline struct suspended_search *world_suspended_search(const struct dpt_world *world, uint32_t segment_index,
                                                              int is_resting)
{
    return &world->suspended_searches[2 * (size_t)segment_index + (is_resting != 0)];
}

static inline struct distance_bound *world_distance_bound(const struct dpt_world *world, uint32_t segment_index,
                                                          uint32_t slot)
{
    return world->distance_bounds + (size_t)world->def.max_bodies * segment_index + slot;
}

/* The owner of the planes of a segment and a body in the plane cache; never 0. */
static inline uint32_t world_plane_owner(const struct dpt_world *world, uint32_t segment_index, uint32_t slot)
{
    return segment_index * world->def.max_bodies + slot + 1;
}

/* The tool with this id, or NULL. */
static inline struct tool *world_find_tool(const struct dpt_world *world, dpt_tool tool)
{
    uint32_t slot = handle_index(tool);
    if (slot >= world->tool_slot_end || !handle_fits(tool, HANDLE_TOOL, &world->tools[slot].slot))
        return NULL;
    return &world->tools[slot];
}

/* The body with this id, or NULL. */
static inline struct body *world_find_body(const struct dpt_world *world, dpt_body body)
{
    uint32_t slot = handle_index(body);
    if (slot >= world->body_slot_end || !handle_fits(body, HANDLE_BODY, &world->bodies[slot].slot))
        return NULL;
    return &world->bodies[slot];
}

#endif
