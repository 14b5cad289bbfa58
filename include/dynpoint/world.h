/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A world: bodies, tools, and the tick that lets one feel the other. It lives in one block of memory
 * that the caller brings; after dpt_world_create nothing allocates, waits or locks.
 *
 *     dpt_world_def def;
 *     dpt_world_def_init(&def);
 *     void *block = malloc(dpt_world_bytes(&def));
 *     dpt_world_create(block, dpt_world_bytes(&def), &def, &world);
 *     dpt_body_add(world, mesh, &pose, &body);
 *     dpt_tool_add(world, &segment, 1, &tool);
 *     for each tick:
 *         dpt_tool_set_pose(world, tool, &device_pose);
 *         dpt_world_step(world, dt, &out);
 *         dpt_tool_get_wrench(world, tool, &wrench);
 *
 * Threads: a world and all calls on it belong to one thread at a time, getters too. Different worlds may run in different
 * threads, and share meshes. dpt_world_def_defaults and dpt_world_bytes may be called from any thread.
 */
#ifndef DYNPOINT_WORLD_H
#define DYNPOINT_WORLD_H

#include "dynpoint/contact.h"
#include "dynpoint/kernel.h"
#include "dynpoint/mesh.h"
#include "dynpoint/strip.h"
#include "dynpoint/types.h"

DPT_BEGIN

typedef struct dpt_world dpt_world;
typedef struct dpt_baseline_def dpt_baseline_def;

/*
 * Ids: kind, generation and slot in one number; 0 is null. The slot that was freed longest ago is used first, and its
 * generations come round: a removed body's id is DPT_E_HANDLE for the next 4,094 bodies that are added, at least, and
 * so is a tool's for tools. There may be any number of them in a world's life.
 */
typedef uint32_t dpt_body;
typedef uint32_t dpt_tool;

/* How far a step goes. */
enum {
    DPT_UNTIL_RESPOND = 0, /* all of it */
    DPT_UNTIL_TRACK = 1,   /* the nearest pair */
    DPT_UNTIL_CONTACT = 2  /* and its sign, gap and contact */
};

/* Which triangles a segment's strip holds. */
enum { DPT_STRIP_KIND_NONE = 0, DPT_STRIP_KIND_SHADOW = 1, DPT_STRIP_KIND_ROUTES = 2 };

/*
 * What a world can hold and how it answers. dpt_world_def_init fills in the defaults, given last.
 *
 * A budget bounds the work of a step, in 16-lane blocks, the same count on every machine. Where it ends a
 * search, the answer is DPT_STATUS_BOUNDED: the best pair so far and a lower bound that is true; contact is
 * unknown and the force fades to zero. What was proven is kept and the next step goes on from there, so that a tool at
 * rest, while no other moves, has its exact answer after as many steps as the budget goes into a search. Contact gets
 * what a step has left: first the gap and the force, then the contacts, which are DPT_CONTACT_FLAG_COARSE where that ends
 * them.
 * A tool at rest comes to both after some steps, from a budget of about 200 on; with less, contact may stay unknown
 * and the force zero beside a pair that is exact. Beside the budget there are a triangle a segment and body, and what
 * docs/algorithms/budget.md names.
 */
typedef struct dpt_world_def {
    uint32_t size;         /* sizeof(dpt_world_def), set by dpt_world_def_init */
    uint32_t max_bodies;   /* 1..65535; 16 */
    uint32_t max_tools;    /* 1..65535; 4 */
    uint32_t max_segments; /* of all tools together, 1..65535; 16 */
    uint32_t method;       /* DPT_METHOD_...; DPT_METHOD_EXACT */
    uint32_t kernel;       /* DPT_KERNEL_...; DPT_KERNEL_AUTO */
    uint32_t until;        /* DPT_UNTIL_...; DPT_UNTIL_RESPOND */
    uint32_t budget;       /* of a step, DPT_METHOD_EXACT only, see above; 0: unlimited */
    double stiffness;      /* of new tools, see dpt_tool_settings; 500 */
    /*
     * DPT_METHOD_EXACT's memory of what it proved in earlier ticks, 272 bytes for 16 separating planes; all
     * tools and bodies share it. Too little costs time, never truth; 0 keeps nothing; at most 2^40; 1 MiB.
     */
    uint64_t certificate_bytes;
    double margin;     /* within which a surface counts as in contact, m, >= 0; 0.001 */
    double side_limit; /* of new bodies, see dpt_body_settings; 0 */
    double
        fade; /* over which a force that a decision ends goes, s, 0..1, see dpt_tool_get_force_report; 0.002 */
    uint32_t max_contacts; /* of all tools together, 0..65535; 0: depth alone, no sides; 32 */
    /*
     * 1: the way out of a contact's deepest pair, and of the force, is interpolated from the normals at the triangle's
     * corners, so that facets are not felt; distances and contact are the same. 0: the true one.
     */
    uint32_t smooth_normals;
    /*
     * Each segment within the margin of its nearest body has a strip of that body's triangles in each tick, if this
     * is not DPT_STRIP_KIND_NONE: of up to `strip_capacity` triangles, 1024. DPT_STRIP_KIND_SHADOW: those under the segment, widened by
     * `strip_width` beyond its radius, along its way to the surface, to `strip_depth`; 0 is a quarter of its length,
     * its radius and the margin. DPT_STRIP_KIND_ROUTES: the paper's, from the triangles nearest to its ends; each search may
     * visit `strip_search` vertices, 16384. Strips are no part of the budget.
     */
    uint32_t strip;
    uint32_t strip_capacity;
    uint32_t strip_search;
    uint32_t reserved;  /* 0 */
    double strip_width; /* m, >= 0; 0 */
    double strip_depth; /* m, >= 0; 0 */
    const dpt_baseline_def
        *baseline;                /* of DPT_METHOD_PAPER (baseline.h); NULL: its defaults; NULL */
    const void *reserved_pointer; /* NULL */
} dpt_world_def;

/* Fill in the first `size` bytes; what dpt_world_def_init calls with its own caller's sizeof. */
DPT_API void dpt_world_def_defaults(dpt_world_def *def, size_t size);

static inline void dpt_world_def_init(dpt_world_def *def)
{
    dpt_world_def_defaults(def, sizeof *def);
}

/*
 * The bytes that a world of this def needs, in this version of the library; docs/performance.md says what they come to.
 * 0 for a def that is not valid; whether its kernel is there, dpt_world_create tells.
 */
DPT_API size_t dpt_world_bytes(const dpt_world_def *def);

/*
 * Make a world in `block`, aligned to 8 and of at least dpt_world_bytes(def). There is no destroy:
 * give the block back when the world is no longer used.
 */
DPT_API dpt_result dpt_world_create(void *block, size_t bytes, const dpt_world_def *def,
                                    dpt_world **world);

/* Forget what was learnt from earlier ticks: every tool is as if just added. Poses stay. */
DPT_API dpt_result dpt_world_reset(dpt_world *world);

/*
 * What a world has held, and what it can hold (its def): to choose capacities by. Each is the most at one time since the
 * world was created; dpt_world_reset leaves it.
 *   contacts   those that one step wanted room for, those that did not fit too
 *   strip      triangles of one segment's strip; as many as strip_capacity, and there may have been more
 */
typedef struct dpt_world_usage {
    uint32_t size; /* sizeof(dpt_world_usage), set by the caller */
    uint32_t bodies;
    uint32_t tools;
    uint32_t segments;
    uint32_t contacts;
    uint32_t strip;
    uint32_t work; /* 16-lane blocks in one step */
    uint32_t reserved;
} dpt_world_usage;

DPT_API dpt_result dpt_world_get_usage(const dpt_world *world, dpt_world_usage *usage);

/* The kernel that the world uses, DPT_KERNEL_...; DPT_KERNEL_AUTO for NULL. */
DPT_API uint32_t dpt_world_get_kernel(const dpt_world *world);

/*
 * A rigid body: a mesh at a pose (NULL: identity). The mesh is kept, not copied, and never owned.
 *
 * dpt_body_set_pose moves the body: tools that it passes are swept. dpt_body_teleport jumps: as if the body were removed
 * and added at once, with the same id. A pose that cannot be used, NULL too, makes every answer of the world stale until
 * the body has a valid one or is removed: nobody knows what the tools would meet.
 *
 * dpt_body_get_pose gives the last one that could be used. `user` is the caller's own, 0 at first.
 */
DPT_API dpt_result dpt_body_add(dpt_world *world, const dpt_mesh *mesh, const dpt_pose *pose,
                                dpt_body *body);
DPT_API dpt_result dpt_body_remove(dpt_world *world, dpt_body body);
DPT_API dpt_result dpt_body_set_pose(dpt_world *world, dpt_body body, const dpt_pose *pose);
DPT_API dpt_result dpt_body_teleport(dpt_world *world, dpt_body body, const dpt_pose *pose);
DPT_API dpt_result dpt_body_get_pose(const dpt_world *world, dpt_body body, dpt_pose *pose);
DPT_API dpt_result dpt_body_set_user(dpt_world *world, dpt_body body, uint64_t user);
DPT_API dpt_result dpt_body_get_user(const dpt_world *world, dpt_body body, uint64_t *user);

/*
 * What may be set of a body at any time. dpt_body_get_settings fills in what counts now, so that a field can be changed
 * and the rest kept; a body that is added has what its world's def says. What is out of range is DPT_E_ARGUMENT, and
 * changes nothing.
 */
typedef struct dpt_body_settings {
    uint32_t size;     /* sizeof(dpt_body_settings), set by the caller */
    uint32_t reserved; /* 0 */
    /*
     * How deep a tool may be behind an open sheet of the body before the side it came from is forgotten, m,
     * 0..DPT_COORDINATE_MAX; 0: a quarter of the body's diagonal.
     */
    double side_limit;
} dpt_body_settings;

DPT_API dpt_result dpt_body_set_settings(dpt_world *world, dpt_body body,
                                         const dpt_body_settings *settings);
DPT_API dpt_result dpt_body_get_settings(const dpt_world *world, dpt_body body,
                                         dpt_body_settings *settings);

/* 1 for the id of a body that is there; any number may be asked about, and any world but one that is gone. */
DPT_API int dpt_body_is_valid(const dpt_world *world, dpt_body body);

/*
 * A tool of `count` segments, given in its own frame, at the identity pose. Set the pose of a rigid
 * tool each tick, or the segments of a free one; both move the tool, a teleport jumps. Input that cannot
 * be used makes the tool stale, its force zero, until valid input comes.
 *
 * dpt_tool_set_segments: as many as the tool has, in the world; radii may change too. Torque is then
 * about the first segment's end a. dpt_tool_set_pose makes it rigid again: the segments given last are those of its own
 * frame then.
 *
 * dpt_tool_get_pose gives the last one that could be used; the identity while the segments are in the world. `user` is
 * the caller's own, 0 at first.
 */
DPT_API dpt_result dpt_tool_add(dpt_world *world, const dpt_segment *segments, uint32_t count,
                                dpt_tool *tool);
DPT_API dpt_result dpt_tool_remove(dpt_world *world, dpt_tool tool);
DPT_API dpt_result dpt_tool_set_pose(dpt_world *world, dpt_tool tool, const dpt_pose *pose);
DPT_API dpt_result dpt_tool_set_segments(dpt_world *world, dpt_tool tool,
                                         const dpt_segment *segments, uint32_t count);
DPT_API dpt_result dpt_tool_teleport(dpt_world *world, dpt_tool tool, const dpt_pose *pose);
DPT_API dpt_result dpt_tool_get_pose(const dpt_world *world, dpt_tool tool, dpt_pose *pose);
DPT_API dpt_result dpt_tool_set_user(dpt_world *world, dpt_tool tool, uint64_t user);
DPT_API dpt_result dpt_tool_get_user(const dpt_world *world, dpt_tool tool, uint64_t *user);

/*
 * Try a motion and stop at the first touch, without moving: from where the tool was last set to `pose`, or to those
 * segments in the world, as in a step; bodies rest where they were last set. The world stays as it is, and nothing of its
 * budget is spent: a long turn near a large mesh takes milliseconds.
 *
 *   clearance  a touch is a surface within the tool's radius and this; m. Where the two add up to less than 0: the axis
 *   first      what was met first, as in dpt_tool_get_sweep; may be NULL. DPT_SWEEP_HIT at time 0 where something
 *              touches already: its normal is zero if the axis is through. DPT_SWEEP_FREE: nothing, and time is 1.
 *              DPT_SWEEP_NONE, and time 0: the tool's or a body's pose is not valid, nobody knows
 *   reached    where the tool is at that time: farther from all bodies than a touch if the time is not 0; may be NULL.
 *              Of segments `count`, and `segments` itself may be given
 *
 * Errors are those of dpt_tool_set_pose and dpt_tool_set_segments, and leave outputs and the tool as they were.
 */
DPT_API dpt_result dpt_tool_try_pose(const dpt_world *world, dpt_tool tool, const dpt_pose *pose,
                                     double clearance, dpt_sweep *first, dpt_pose *reached);
DPT_API dpt_result dpt_tool_try_segments(const dpt_world *world, dpt_tool tool,
                                         const dpt_segment *segments, uint32_t count,
                                         double clearance, dpt_sweep *first, dpt_segment *reached);

/* What may be set of a tool at any time; as dpt_body_settings. */
typedef struct dpt_tool_settings {
    uint32_t size;     /* sizeof(dpt_tool_settings), set by the caller */
    uint32_t reserved; /* 0 */
    double stiffness;  /* of the penalty force, N/m, 0..1e9 */
} dpt_tool_settings;

DPT_API dpt_result dpt_tool_set_settings(dpt_world *world, dpt_tool tool,
                                         const dpt_tool_settings *settings);
DPT_API dpt_result dpt_tool_get_settings(const dpt_world *world, dpt_tool tool,
                                         dpt_tool_settings *settings);

/* As dpt_body_is_valid. */
DPT_API int dpt_tool_is_valid(const dpt_world *world, dpt_tool tool);

/* What one tick found, over all tools. */
typedef struct dpt_step {
    uint32_t size;   /* sizeof(dpt_step), set by the caller */
    uint32_t status; /* the least DPT_STATUS_... of any tool */
    uint32_t
        contact; /* the gravest DPT_CONTACT_... of any tool: penetrating, touching, unknown, ... */
    uint32_t work;     /* 16-lane blocks looked at; at most the budget, if there is one */
    double distance;   /* the least of any tool; 0 when no tool has an answer */
    uint32_t contacts; /* of all tools */
    uint32_t flags;    /* DPT_STEP_... */
} dpt_step;

/* Bits of dpt_step.flags. */
enum {
    /* more contacts wanted room than max_contacts, those that live on while nothing is known of them among
       them; forces and depths count all */
    DPT_STEP_FLAG_CONTACTS_FULL = 1
};

/*
 * One tick of `dt` seconds, above 0 and at most 1e6. With an error the wrenches are zero and every answer is stale.
 *   out   may be NULL
 */
DPT_API dpt_result dpt_world_step(dpt_world *world, double dt, dpt_step *out);

/* The nearest pair of a tool and all bodies, from the last step. */
DPT_API dpt_result dpt_tool_get_hit(const dpt_world *world, dpt_tool tool, dpt_hit *hit);

/* The same of one segment of the tool, from 0. */
DPT_API dpt_result dpt_tool_get_segment_hit(const dpt_world *world, dpt_tool tool, uint32_t segment,
                                            dpt_hit *hit);

/*
 * The tool's contacts, from the last step: up to `capacity`, the segments in order; of a segment the bodies one after
 * another, in no stated order, along each from the segment's end a. *count is how many there are, which may be more
 * than fit. contacts[0].size must be set unless capacity is 0; contacts may be NULL then.
 */
DPT_API dpt_result dpt_tool_get_contacts(const dpt_world *world, dpt_tool tool,
                                         dpt_contact *contacts, uint32_t capacity, uint32_t *count);

/* What a segment of the tool, from 0, met between the last two steps. */
DPT_API dpt_result dpt_tool_get_sweep(const dpt_world *world, dpt_tool tool, uint32_t segment,
                                      dpt_sweep *sweep);

/*
 * The triangles of a segment's strip, from 0, of the last step, and how the segment stands to each: as
 * dpt_strip_overlaps, the tool's side being that on which it is. None where the segment was not within the margin, or the
 * world has no strips; of routes none where no way leads from an end's triangle to that of the nearest point.
 *   flags   DPT_STRIP_FLAG_FULL, ...; may be NULL
 */
DPT_API dpt_result dpt_tool_get_strip(const dpt_world *world, dpt_tool tool, uint32_t segment,
                                      dpt_overlap *overlaps, uint32_t capacity, uint32_t *count,
                                      uint32_t *flags);

/*
 * Why a tool feels no force, of the last step; the first of these that is so:
 *   STALE      no step has answered: the tool was added or teleported, or the world reset, after the last one; that one
 *              failed; the tool's or a body's input cannot be used
 *   OFF        the world's `until` ends before the response, or the tool's stiffness is 0
 *   ACTS       it feels one: a segment at least is pushed
 *   UNDECIDED  a segment at least may touch something, but nobody knows which way it would be pushed: its contact is
 *              DPT_CONTACT_UNKNOWN (the budget ended, it goes through an open sheet of which no side is known, ...),
 *              or it goes through a surface that has no sides
 *   FREE       no segment is in anything; there may be no bodies
 */
enum {
    DPT_FORCE_ACTS = 0,
    DPT_FORCE_FREE = 1,
    DPT_FORCE_STALE = 2,
    DPT_FORCE_UNDECIDED = 3,
    DPT_FORCE_OFF = 4
};

/* Bits of dpt_force_report.flags. */
enum {
    /* the wrench is on its way from that of an earlier step to what `reason` says, and so need not be zero */
    DPT_FORCE_FLAG_FADING = 1,
    /* DPT_FORCE_ACTS, but the share of another segment is missing: of that one it is undecided */
    DPT_FORCE_FLAG_PARTIAL = 2
};

/*
 * What a tool feels, of the last step.
 *
 *   wrench  force on the tool and torque about the origin of its frame, in world axes, before any limits: the
 *           penalty of docs/algorithms/penalty.md, summed over the tool's segments. Zero where `reason` is not
 *           DPT_FORCE_ACTS and DPT_FORCE_FLAG_FADING is not set
 *   reason  DPT_FORCE_...
 *   flags   DPT_FORCE_FLAG_...
 *
 * The push of a segment can end by a decision, not by motion: the side of an open sheet is given up (too deep for
 * side_limit, a motion that was not followed, the axis at the sheet's border, no room for the contact), or its
 * contact is not known any more. Its share then goes in a straight line, in `fade` seconds of the steps' dt, from
 * what was felt to what is true, which is zero while nothing is known. What is felt is always between the two, and
 * each step takes the share of the way that it has of the time left; so where contact comes to be known again, what
 * is true is felt when the rest of that time is over. A new decision begins anew. Directions are the world's; torque
 * goes as it was about the tool's origin, so that the line of action moves with the tool.
 *
 * Zero at once: after an error, a teleport, a reset, input that cannot be used, stiffness 0, and
 * dpt_tool_set_segments of a tool that was rigid or the reverse, as the torque is about another origin then. The push
 * of a body that is removed or teleported, too, also while it fades: what is no more there pushes no more. A push
 * that ends because the tool moves away does not fade: it has come to zero by then.
 */
typedef struct dpt_force_report {
    uint32_t size; /* sizeof(dpt_force_report), set by the caller */
    uint32_t reason;
    uint32_t flags;
    uint32_t reserved;
    dpt_wrench wrench;
} dpt_force_report;

/* On error stale and zero. */
DPT_API dpt_result dpt_tool_get_force_report(const dpt_world *world, dpt_tool tool,
                                             dpt_force_report *force);

/* Its wrench alone; zero on error. */
DPT_API dpt_result dpt_tool_get_wrench(const dpt_world *world, dpt_tool tool, dpt_wrench *wrench);

DPT_END

#endif
