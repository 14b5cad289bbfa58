/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A world: bodies, tools, and the step that lets one feel the other. It lives in one block of memory that the caller
 * supplies. Nothing here allocates, waits or locks.
 *
 *     dpt_world_def def;
 *     dpt_world_def_init(&def);
 *     void *block = malloc(dpt_world_bytes(&def));
 *     dpt_world_create(block, dpt_world_bytes(&def), &def, &world);
 *     dpt_body_add(world, mesh, &pose, &body);
 *     dpt_tool_add(world, &segment, 1, &tool);
 *     dpt_step out = { .size = sizeof out };
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
 * Ids of bodies and tools: kind, generation and slot in one number. 0 is no id. A world can add and remove any number of
 * them. The id of a removed body is DPT_E_HANDLE at least until 4,094 more bodies have been added; after that a new body
 * may have it. The same holds for tools.
 */
typedef uint32_t dpt_body;
typedef uint32_t dpt_tool;

/* How far a step goes. */
enum {
    DPT_UNTIL_RESPOND = 0, /* all of it */
    DPT_UNTIL_TRACK = 1,   /* the nearest pair */
    DPT_UNTIL_CONTACT = 2  /* and its sign, gap and contact */
};

/*
 * By what law a tool feels bodies; docs/algorithms/force.md.
 *   POINT  the paper's: a push at the deepest point of each segment, out of the body that it is deepest in
 *   PROXY  a spring to the pose that has gone through nothing: the proxy. The tool's contacts are those of the proxy
 */
enum { DPT_LAW_POINT = 0, DPT_LAW_PROXY = 2 };

/* Which triangles a segment's strip holds. */
enum { DPT_STRIP_KIND_NONE = 0, DPT_STRIP_KIND_SHADOW = 1, DPT_STRIP_KIND_ROUTES = 2 };

/*
 * What a world can hold and how it answers. dpt_world_def_init fills in the defaults, which are given last below.
 *
 * A budget bounds the work of a step, in units: one unit is about one block of 16 boxes or triangles. The count is the
 * same on every machine; another release may need more or fewer. A loop should have a budget: measure what its scene
 * takes with dpt_world_usage.work or `dynpoint replay --json`.
 *
 * If the budget ends a search, the hit is DPT_STATUS_BOUNDED: it has the best pair so far and a true lower bound.
 * Contact is unknown then, and the force fades to zero. The next step goes on with the search, so a tool at rest gets
 * its exact answer after some steps. Contact gets what the searches leave: first the gap and the force, then the
 * contacts, which are DPT_CONTACT_FLAG_COARSE if the budget ends them. With a small budget the contact of a tool at rest
 * may stay unknown. docs/algorithms/budget.md says what a step costs beside its budget.
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
     * Memory for what DPT_METHOD_EXACT has proven in earlier steps, shared by all tools and bodies, at most 2^40. Too
     * little costs time and changes no distance; 0 keeps nothing; 1 MiB.
     */
    uint64_t certificate_bytes;
    double margin;     /* a surface nearer than this to the tool's is in contact, m, >= 0; 0.001 */
    double side_limit; /* of new bodies, see dpt_body_settings; 0 */
    double fade;       /* s, 0..1, see dpt_tool_get_force_report; 0.002 */
    uint32_t max_contacts; /* of all tools together, 0..65535; 0: depth alone, no sides; 32 */
    /*
     * 1: the normals of contacts, and the direction of the force, are interpolated from those at the triangle's corners,
     * so that facets are not felt. Distances and contact are the same. 0: they are the true directions; 0.
     */
    uint32_t smooth_normals;
    /*
     * Which triangles of the nearest body each segment collects in a step, if it is within the margin of that body; see
     * dpt_tool_get_strip. Strips are not part of the budget. DPT_STRIP_KIND_...; DPT_STRIP_KIND_NONE
     *   SHADOW  those under the segment in the direction of its nearest point: as wide as its radius and `strip_width`,
     *           to `strip_depth` beyond the axis
     *   ROUTES  the paper's: routes from the triangles nearest to its ends; each search may visit `strip_search` vertices
     */
    uint32_t strip;
    uint32_t strip_capacity; /* triangles of one strip, 1..2^20; 1024 */
    uint32_t strip_search;   /* at most 2^28; 16384 */
    uint32_t law;            /* DPT_LAW_..., of new tools, see dpt_tool_settings; DPT_LAW_POINT */
    double strip_width;      /* m, >= 0; 0 */
    /* m, >= 0; 0: a quarter of the segment's length, its radius and the margin; 0 */
    double strip_depth;
    /* DPT_METHOD_PAPER only (baseline.h); NULL: its defaults; NULL */
    const dpt_baseline_def *baseline;
    const void *reserved_pointer; /* NULL */
} dpt_world_def;

/* Fill in the first `size` bytes; what dpt_world_def_init calls with its own caller's sizeof. */
DPT_API void dpt_world_def_defaults(dpt_world_def *def, size_t size);

static inline void dpt_world_def_init(dpt_world_def *def)
{
    dpt_world_def_defaults(def, sizeof *def);
}

/*
 * The bytes that a world of this def needs, in this version of the library; docs/performance.md has examples. 0 for a def
 * that is not valid, or whose bytes do not fit into size_t.
 */
DPT_API size_t dpt_world_bytes(const dpt_world_def *def);

/*
 * Make a world in `block`, which is aligned to 8 and of at least dpt_world_bytes(def) bytes. The block must not move
 * while the world is used; a copy of its bytes is no world. There is no destroy: free the block when the world is no
 * longer used. What the def points to is read during the call.
 *
 * DPT_E_UNSUPPORTED: this machine does not have the kernel.
 */
DPT_API dpt_result dpt_world_create(void *block, size_t bytes, const dpt_world_def *def,
                                    dpt_world **world);

/* Forget all earlier steps: every tool is as if it had just been added. Poses, settings and user values stay. */
DPT_API dpt_result dpt_world_reset(dpt_world *world);

/*
 * What a world has used at most at one time since it was created: to choose the capacities of its def by.
 * dpt_world_reset leaves it.
 *   contacts   that one step wanted room for, those that did not fit included
 *   strip      triangles of one strip; where it equals strip_capacity there may have been more
 *   work       units in one step
 */
typedef struct dpt_world_usage {
    uint32_t size; /* sizeof(dpt_world_usage), set by the caller */
    uint32_t bodies;
    uint32_t tools;
    uint32_t segments;
    uint32_t contacts;
    uint32_t strip;
    uint32_t work;
    uint32_t reserved;
} dpt_world_usage;

DPT_API dpt_result dpt_world_get_usage(const dpt_world *world, dpt_world_usage *usage);

/* The kernel that the world uses, DPT_KERNEL_...; DPT_KERNEL_AUTO for NULL. */
DPT_API uint32_t dpt_world_get_kernel(const dpt_world *world);

/*
 * A rigid body is a mesh at a pose; NULL is the identity. The world keeps the pointer: the mesh and its bytes must stay
 * where they are until the body is removed.
 *
 * dpt_body_set_pose moves a body: tools that it passes are swept. dpt_body_teleport jumps, as if the body were removed
 * and added, but it keeps its id. If the pose cannot be used (NULL, not finite, not unit), the call fails and every
 * answer of the world is stale until the body gets a pose that can be used, or is removed.
 *
 * dpt_body_get_pose gives the last pose that could be used. `user` is a value of the caller's own, 0 at first.
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
 * Settings of a body. They may change at any time and count from the next step on. A new body has those of its world's
 * def. To change one field: get, change, set. A field that the caller's struct is too short for stays as it is. A value
 * out of its range is DPT_E_ARGUMENT, and nothing changes.
 */
typedef struct dpt_body_settings {
    uint32_t size;     /* sizeof(dpt_body_settings), set by the caller */
    uint32_t reserved; /* 0 */
    /*
     * How deep a tool may be behind an open sheet of the body before the side it came from is forgotten, m,
     * 0..DPT_COORDINATE_MAX; 0: a quarter of the body's diagonal.
     */
    double side_limit;
    /*
     * Coulomb friction that a tool with DPT_LAW_PROXY feels, force across the surface for one out of it, 0..10: up to
     * `static_friction` a contact sticks; one that slips is held back by `kinetic_friction`, at most the static one; 0, 0.
     */
    double static_friction;
    double kinetic_friction;
} dpt_body_settings;

DPT_API dpt_result dpt_body_set_settings(dpt_world *world, dpt_body body,
                                         const dpt_body_settings *settings);
DPT_API dpt_result dpt_body_get_settings(const dpt_world *world, dpt_body body,
                                         dpt_body_settings *settings);

/* 1 if the world has a body of this id, else 0; any number may be asked about. */
DPT_API int dpt_body_is_valid(const dpt_world *world, dpt_body body);

/*
 * A tool is `count` segments in its own frame, at the identity pose at first. Each step, give a rigid tool its pose, or a
 * free one its segments. Both are motion, which is swept; dpt_tool_teleport jumps. If what is given cannot be used (NULL,
 * not finite, not unit, another count), the call fails and the tool is stale, without a force, until it gets input that
 * can be used.
 *
 * dpt_tool_set_segments places the segments in the world, as many as the tool has; radii may change. The tool is free
 * then. dpt_tool_set_pose and dpt_tool_teleport make it rigid again: the segments given last are taken as those of its
 * own frame.
 *
 * dpt_tool_get_pose gives the last pose that could be used; the identity while the tool is free. `user` is a value of
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
 * Try a motion without moving: from where the tool was last set, to `pose` or to those segments in the world, as in a
 * step, and stop at the first touch. Bodies rest where they were last set. The world does not change, and its budget is
 * not spent; a long turn near a large mesh takes far longer than a step.
 *
 *   clearance  m. A touch is a surface within the radius plus this; if that sum is negative, the axis itself is tested
 *   first      what was met first, as in dpt_tool_get_sweep; may be NULL.
 *              DPT_SWEEP_HIT   at `time`; 0 if something touches at the beginning. The normal is zero if the axis goes
 *                              through it there
 *              DPT_SWEEP_FREE  nothing, and `time` is 1
 *              DPT_SWEEP_NONE  not known, as the tool's or a body's pose cannot be used; `time` is 0
 *   reached    where the tool is at `time`; may be NULL. If that is not 0, the tool is free there. Of segments: `count`
 *              of them, and it may be the array `segments`
 *
 * Errors are those of dpt_tool_set_pose and dpt_tool_set_segments, and leave outputs and the tool as they were. A clearance
 * that is not finite or beyond DPT_COORDINATE_MAX is DPT_E_FINITE.
 */
DPT_API dpt_result dpt_tool_try_pose(const dpt_world *world, dpt_tool tool, const dpt_pose *pose,
                                     double clearance, dpt_sweep *first, dpt_pose *reached);
DPT_API dpt_result dpt_tool_try_segments(const dpt_world *world, dpt_tool tool,
                                         const dpt_segment *segments, uint32_t count,
                                         double clearance, dpt_sweep *first, dpt_segment *reached);

/* Settings of a tool; used as dpt_body_settings. */
typedef struct dpt_tool_settings {
    uint32_t size;    /* sizeof(dpt_tool_settings), set by the caller */
    uint32_t law;     /* DPT_LAW_...; changing it is a teleport to where the tool is */
    double stiffness; /* N/m, 0..1e9; 0: no force */
    /*
     * Of the proxy, Nm/rad, 0..1e9; 0: stiffness times the mean square of the distance of the segments' points from
     * their centre, which is L^2 / 12 for one segment of length L.
     */
    double rotational_stiffness;
} dpt_tool_settings;

DPT_API dpt_result dpt_tool_set_settings(dpt_world *world, dpt_tool tool,
                                         const dpt_tool_settings *settings);
DPT_API dpt_result dpt_tool_get_settings(const dpt_world *world, dpt_tool tool,
                                         dpt_tool_settings *settings);

/*
 * The pose of the tool's proxy, from the last step: of its frame, in the world; of a free tool that of a frame whose
 * origin is end a and whose x axis points to end b. It is the device's pose where nothing is in the way, and
 * with another law than DPT_LAW_PROXY. For a viewer to draw.
 */
DPT_API dpt_result dpt_tool_get_proxy(const dpt_world *world, dpt_tool tool, dpt_pose *pose);

/* As dpt_body_is_valid. */
DPT_API int dpt_tool_is_valid(const dpt_world *world, dpt_tool tool);

/* What one step found, over all tools. */
typedef struct dpt_step {
    uint32_t size;     /* sizeof(dpt_step), set by the caller */
    uint32_t status;   /* the worst of any segment: stale, local, bounded, exact; DPT_STATUS_... */
    uint32_t contact;  /* of any segment: penetrating before touching, unknown, separated */
    uint32_t work;     /* units that were spent; at most the budget, if there is one */
    double distance;   /* the least of any tool; 0 if no tool has an answer */
    uint32_t contacts; /* of all tools */
    uint32_t flags;    /* DPT_STEP_FLAG_... */
} dpt_step;

/* Bits of dpt_step.flags. */
enum {
    /* more contacts wanted room than max_contacts, also those that are kept while nothing is known of them;
       forces and depths count all */
    DPT_STEP_FLAG_CONTACTS_FULL = 1
};

/*
 * One tick of `dt` seconds, above 0 and at most 1e6. After an error all wrenches are zero and every answer is stale.
 * Input that cannot be used is no error of the step: it returns DPT_OK, and the answers concerned are stale.
 *   out   may be NULL
 *
 * The functions below answer for the last step, whatever was set since. They may name a body that was removed since.
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
 * The strip of a segment (counted from 0), and how the segment stands to each of its triangles, as
 * dpt_strip_overlaps tells. There is none if the segment was not within the margin or the world has no strips; and none of
 * routes if no triangles that touch lead from an end's triangle to that of the nearest point.
 *   flags   DPT_STRIP_FLAG_...; may be NULL
 */
DPT_API dpt_result dpt_tool_get_strip(const dpt_world *world, dpt_tool tool, uint32_t segment,
                                      dpt_overlap *overlaps, uint32_t capacity, uint32_t *count,
                                      uint32_t *flags);

/*
 * Why a tool feels no force in the last step. The first of these that holds:
 *   STALE      there is no answer: the tool was added or teleported, or the world reset, since the last step; the step
 *              failed; the tool's or a body's input cannot be used
 *   OFF        the world's `until` ends before the response, or the tool's stiffness is 0
 *   ACTS       it feels one: at least one segment is pushed
 *   UNDECIDED  at least one segment may touch something, but its direction is not known: its contact is
 *              DPT_CONTACT_UNKNOWN, or it goes through a surface that has no sides
 *   FREE       no segment is in anything, or there are no bodies
 *   INSIDE     DPT_LAW_PROXY: the tool began in something, and has not been outside since
 */
enum {
    DPT_FORCE_ACTS = 0,
    DPT_FORCE_FREE = 1,
    DPT_FORCE_STALE = 2,
    DPT_FORCE_UNDECIDED = 3,
    DPT_FORCE_OFF = 4,
    DPT_FORCE_INSIDE = 5
};

/* Bits of dpt_force_report.flags. */
enum {
    /* the wrench is still on its way to what `reason` says, and so need not be zero */
    DPT_FORCE_FLAG_FADING = 1,
    /* DPT_FORCE_ACTS, but another segment is undecided, and its share is missing */
    DPT_FORCE_FLAG_PARTIAL = 2,
    /* the pose that held the proxy is gone, and it moves on to another: the force may change fast */
    DPT_FORCE_FLAG_FOLD = 4,
    /* moving bodies leave the proxy no pose that is free */
    DPT_FORCE_FLAG_SQUEEZED = 8,
    /* the proxy was more than 1 rad from the device, and started again there */
    DPT_FORCE_FLAG_REPLACED = 16
};

/*
 * What a tool feels in the last step.
 *
 *   wrench  force on the tool, and torque about the origin of its frame (of a free tool: about end a of its first
 *           segment), in world axes, before any limits; docs/algorithms/penalty.md. The sum over the tool's segments.
 *           Zero unless `reason` is DPT_FORCE_ACTS or DPT_FORCE_FLAG_FADING is set
 *   reason  DPT_FORCE_...
 *   flags   DPT_FORCE_FLAG_...
 *
 * Fade: a push can end by a decision and not by motion. The side of an open sheet is given up (the tool is deeper than
 * side_limit, a motion could not be followed, the axis is at the sheet's border, there is no room for the contact), or
 * the contact is not known any more. Then the segment's share goes in a straight line, within dpt_world_def.fade seconds
 * of the steps' dt, to what is true; that is zero while nothing is known. It is always between what was felt and what
 * is true. A new decision starts the time again.
 *
 * Zero at once: after an error, a teleport, a reset, input that cannot be used, stiffness 0, and when a rigid tool
 * becomes free or the reverse. The push of a body that is removed or teleported ends at once, too. A push that ends
 * because the tool moves away has come to zero by itself.
 */
typedef struct dpt_force_report {
    uint32_t size; /* sizeof(dpt_force_report), set by the caller */
    uint32_t reason;
    uint32_t flags;
    uint32_t law; /* DPT_LAW_... */
    dpt_wrench wrench;
    double energy;  /* that the law stores, J; 0 with DPT_LAW_POINT */
    double lag;     /* of the proxy, m: how far it still is from where it would come to rest */
    uint64_t folds; /* how many there were since the tool was placed */
} dpt_force_report;

/* On an error DPT_FORCE_STALE and zero. */
DPT_API dpt_result dpt_tool_get_force_report(const dpt_world *world, dpt_tool tool,
                                             dpt_force_report *force);

/* The wrench alone; zero on an error. */
DPT_API dpt_result dpt_tool_get_wrench(const dpt_world *world, dpt_tool tool, dpt_wrench *wrench);

DPT_END

#endif
