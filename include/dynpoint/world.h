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
 * Threads: a world and all calls on it belong to one thread at a time, getters too. Different worlds may run in
 * different threads, and share meshes. dpt_world_def_defaults and dpt_world_bytes may be called from any thread.
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
 * Ids of bodies and tools: kind, generation and slot in one number. 0 is no id. A world can add and remove any number
 * of bodies and tools. After a body was removed, calls with its id return DPT_E_HANDLE at least until 4,094 more bodies
 * have been added; after that a new body may have the id. The same holds for tools.
 */
typedef uint32_t dpt_body;
typedef uint32_t dpt_tool;

/* Which stages a step computes. */
enum {
    DPT_UNTIL_RESPOND = 0, /* all: nearest pair, contacts, force */
    DPT_UNTIL_TRACK = 1,   /* the nearest pair alone */
    DPT_UNTIL_CONTACT = 2  /* the nearest pair, its sign and gap, and the contacts */
};

/*
 * By what law a tool feels bodies; docs/algorithms/force.md.
 *   POINT  the paper's: a push at the deepest point of each segment, out of the body that it is deepest in
 *   BED    the gradient of an energy along the tool and at its ends: smooth, and without net work on closed paths
 *   PROXY  a spring to the pose that has gone through nothing: the proxy. Contacts and strips are those at the proxy,
 *          hits those at the device's pose, and no sweep is reported. Only in worlds that respond (DPT_UNTIL_RESPOND),
 *          and not with DPT_METHOD_PAPER: there the law changes nothing
 */
enum { DPT_LAW_POINT = 0, DPT_LAW_BED = 1, DPT_LAW_PROXY = 2 };

/* How a segment's strip is chosen; see dpt_world_def.strip. */
enum { DPT_STRIP_KIND_NONE = 0, DPT_STRIP_KIND_SHADOW = 1, DPT_STRIP_KIND_ROUTES = 2 };

/*
 * What a world can hold and how it answers. dpt_world_def_init fills in the defaults, which are given last below.
 *
 * A budget bounds the work of a step, in units: one unit is about one block of 16 boxes or triangles. The count is the
 * same on every machine; another release may need more or fewer. A loop should have a budget. Measure what its scene
 * needs with dpt_world_usage.work or `dynpoint replay --json`.
 *
 * If the budget ends a search, the hit is DPT_STATUS_BOUNDED: it has the best pair so far and a true lower bound.
 * Contact is unknown then, and the force fades to zero. The next step continues the search, so a tool at rest gets
 * its exact answer after some steps. Units that the searches leave are spent on contact: first on the gap and the
 * force, then on the contacts, which are DPT_CONTACT_FLAG_COARSE if the budget ends them. With a small budget the
 * contact of a tool at rest may stay unknown. docs/algorithms/budget.md says what a step costs beside its budget.
 */
typedef struct dpt_world_def {
    uint32_t size;         /* sizeof(dpt_world_def), set by dpt_world_def_init */
    uint32_t max_bodies;   /* 1..65535; 16 */
    uint32_t max_tools;    /* 1..65535; 4 */
    uint32_t max_segments; /* of all tools together, 1..65535; 16 */
    uint32_t method;       /* DPT_METHOD_...; DPT_METHOD_EXACT */
    uint32_t kernel;       /* DPT_KERNEL_...; DPT_KERNEL_AUTO */
    uint32_t until;        /* DPT_UNTIL_...; DPT_UNTIL_RESPOND */
    uint32_t budget;       /* units of work a step, DPT_METHOD_EXACT only; 0: unlimited; 0 */
    double stiffness;      /* of new tools, see dpt_tool_settings; 500 */
    /*
     * Memory for what DPT_METHOD_EXACT has proven in earlier steps, in bytes, at most 2^40. All tools and bodies share
     * it. Too little costs time but changes no distance. 0: nothing is kept; 1 MiB.
     */
    uint64_t certificate_bytes;
    double margin;     /* contact begins at this distance from the tool's surface, m, >= 0; 0.001 */
    double side_limit; /* of new bodies, see dpt_body_settings; 0 */
    double fade;       /* s, 0..1, see dpt_tool_get_force_report; 0.002 */
    /* Of all tools together, 0..65535. 0: depth alone, no sides; the force of DPT_LAW_PROXY needs no more; 32. */
    uint32_t max_contacts;
    /*
     * 1: the normals of contacts, and the direction of the force, are interpolated from the normals at the triangle's
     * corners, so that facets are not felt. Distances and contact are the same. 0: they are the true directions; 0.
     */
    uint32_t smooth_normals;
    /*
     * Which triangles of the nearest body each segment collects in a step, if it is within the margin of that body; see
     * dpt_tool_get_strip. Strips are not part of the budget. DPT_STRIP_KIND_...; DPT_STRIP_KIND_NONE
     *   SHADOW   the triangles under the segment in the direction of its nearest point: as wide as its radius and
     *            `strip_width`, to `strip_depth` beyond the axis
     *   ROUTES   the paper's strip: routes from the triangles nearest to the segment's ends. Each search visits at most
     *            `strip_search` vertices
     */
    uint32_t strip;
    uint32_t strip_capacity; /* triangles of one strip, 1..2^20; 1024 */
    uint32_t strip_search;   /* vertices, for ROUTES, at most 2^28; 16384 */
    uint32_t law;            /* DPT_LAW_..., of new tools, see dpt_tool_settings; DPT_LAW_PROXY */
    double strip_width;      /* beside the radius, for SHADOW, m, >= 0; 0 */
    /* Beyond the axis, for SHADOW, m, >= 0; 0: a quarter of the segment's length plus its radius and the margin; 0 */
    double strip_depth;
    /* For DPT_METHOD_PAPER only (baseline.h); NULL: its defaults; NULL */
    const dpt_baseline_def *baseline;
    const void *reserved_pointer; /* NULL */
    /*
     * The integrals of contacts count what is nearer to the tool's surface than this, m, at most the margin. 0: what is
     * inside alone; below 0: the margin; -1
     */
    double onset;
    /*
     * Units that the sweeps of a step may take, all segments and proxies together, within `budget`. A motion that needs
     * more is swept further in the next steps: contact is unknown until then, and a proxy is on its way. There is no such
     * limit past a body that moved before this step, as only this step can sweep it, nor for the eighth motion that
     * waits, as a ninth would be given up. Where a motion waits, a proxy may take another way round, and
     * DPT_FORCE_FLAG_BEHIND says that its wrench is a guess. The default is about 1 ms; hardly a motion but a jump
     * takes as long. 0: unlimited; 4000
     */
    uint32_t sweep_budget;
    uint32_t max_tips; /* of all tools together (tip.h), 0..65535; 4 */
} dpt_world_def;

/* Fill in the first `size` bytes; what dpt_world_def_init calls with its own caller's sizeof. */
DPT_API void dpt_world_def_defaults(dpt_world_def *def, size_t size);

static inline void dpt_world_def_init(dpt_world_def *def)
{
    dpt_world_def_defaults(def, sizeof *def);
}

/*
 * The bytes that a world of this def needs, in this version of the library; docs/performance.md has examples. 0 for a
 * def that is not valid, or whose bytes do not fit into size_t.
 */
DPT_API size_t dpt_world_bytes(const dpt_world_def *def);

/*
 * Make a world in `block`, which is aligned to 8 and of at least dpt_world_bytes(def) bytes. The block must not move
 * while the world is used; a copy of its bytes is no world. There is no destroy: free the block when the world is no
 * longer used. What the def points to is read during the call.
 *
 * DPT_E_UNSUPPORTED: this machine does not have the kernel.
 */
DPT_API dpt_result dpt_world_create(void *block, size_t bytes, const dpt_world_def *def, dpt_world **world);

/* Forget all earlier steps: every tool is as if it had just been added. Poses, settings and user values stay. */
DPT_API dpt_result dpt_world_reset(dpt_world *world);

/*
 * The most that a world has used at one time since it was created. Use it to choose the capacities of the def.
 * dpt_world_reset leaves it as it is.
 *   contacts   contacts of one step, those that did not fit included
 *   strip      triangles of one strip; if it equals strip_capacity there may have been more
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
 * where they are until the body is removed. To add a mesh takes microseconds; one with holes is looked through for them,
 * half a millisecond for 50,000 triangles.
 *
 * dpt_body_set_pose moves a body. The motion is swept, so a tool between the old and the new pose is not missed.
 * dpt_body_teleport jumps: nothing is swept, as if the body were removed and added, but it keeps its id. If the pose
 * cannot be used (NULL, not finite, quaternion not of unit length), the call fails, and every answer of the world is
 * stale until the body gets a valid pose or is removed.
 *
 * dpt_body_get_pose returns the last valid pose. `user` is a value of the caller's own, 0 at first.
 */
DPT_API dpt_result dpt_body_add(dpt_world *world, const dpt_mesh *mesh, const dpt_pose *pose, dpt_body *body);
DPT_API dpt_result dpt_body_remove(dpt_world *world, dpt_body body);
DPT_API dpt_result dpt_body_set_pose(dpt_world *world, dpt_body body, const dpt_pose *pose);
DPT_API dpt_result dpt_body_teleport(dpt_world *world, dpt_body body, const dpt_pose *pose);
DPT_API dpt_result dpt_body_get_pose(const dpt_world *world, dpt_body body, dpt_pose *pose);
DPT_API dpt_result dpt_body_set_user(dpt_world *world, dpt_body body, uint64_t user);
DPT_API dpt_result dpt_body_get_user(const dpt_world *world, dpt_body body, uint64_t *user);

/*
 * Settings of a body. They may change at any time and take effect at the next step. A new body has the settings of its
 * world's def. To change one field: get, change, set. A field that the caller's struct is too short for stays as it is.
 * A value out of range is DPT_E_ARGUMENT, and nothing changes.
 */
typedef struct dpt_body_settings {
    uint32_t size; /* sizeof(dpt_body_settings), set by the caller */
    /* 1: to tools it is as if the body were not there. A change is as if it were removed, or added; 0 */
    uint32_t unfelt;
    /*
     * How deep a tool may be behind an open sheet of the body. If it is deeper, the library forgets from which side the
     * tool came. m, 0..DPT_COORDINATE_MAX; 0: a quarter of the body's diagonal.
     */
    double side_limit;
    /*
     * Coulomb friction that a tool with DPT_LAW_PROXY feels: the force across the surface for one out of it, 0..10. Up
     * to `static_friction` a contact sticks. One that slips is held back by `kinetic_friction`, at most the static one;
     * 0, 0.
     */
    double static_friction;
    double kinetic_friction;
    /*
     * Of the surface, N/m, 0..1e9; 0: rigid. DPT_LAW_PROXY: it is in series with the tool's, for the force alone. The
     * proxy stays outside; 0
     */
    double stiffness;
} dpt_body_settings;

DPT_API dpt_result dpt_body_set_settings(dpt_world *world, dpt_body body, const dpt_body_settings *settings);
DPT_API dpt_result dpt_body_get_settings(const dpt_world *world, dpt_body body, dpt_body_settings *settings);

/* 1 if the world has a body with this id, else 0. Any number is allowed. */
DPT_API int dpt_body_is_valid(const dpt_world *world, dpt_body body);

/*
 * A tool is `count` segments in its own frame, at the identity pose at first. Before each step, give a rigid tool its
 * pose, or a free tool its segments. Both move the tool, and the motion is swept; dpt_tool_teleport jumps without a
 * sweep. If the input cannot be used (NULL, not finite, quaternion not of unit length, another count), the call fails,
 * and the tool is stale and has no force until it gets valid input.
 *
 * dpt_tool_set_segments sets the segments in the world frame, as many as the tool has; radii may change. The tool is
 * free then. Several segments with a proxy (DPT_LAW_PROXY) are DPT_E_UNSUPPORTED: move such a tool by its pose.
 * dpt_tool_set_pose and dpt_tool_teleport make it rigid again: the segments set last are taken as segments in its own
 * frame.
 *
 * dpt_tool_get_pose returns the last valid pose, or the identity while the tool is free. `user` is a value of the
 * caller's own, 0 at first.
 */
DPT_API dpt_result dpt_tool_add(dpt_world *world, const dpt_segment *segments, uint32_t count, dpt_tool *tool);
DPT_API dpt_result dpt_tool_remove(dpt_world *world, dpt_tool tool);
DPT_API dpt_result dpt_tool_set_pose(dpt_world *world, dpt_tool tool, const dpt_pose *pose);
DPT_API dpt_result dpt_tool_set_segments(dpt_world *world, dpt_tool tool, const dpt_segment *segments, uint32_t count);
DPT_API dpt_result dpt_tool_teleport(dpt_world *world, dpt_tool tool, const dpt_pose *pose);
DPT_API dpt_result dpt_tool_get_pose(const dpt_world *world, dpt_tool tool, dpt_pose *pose);
DPT_API dpt_result dpt_tool_set_user(dpt_world *world, dpt_tool tool, uint64_t user);
DPT_API dpt_result dpt_tool_get_user(const dpt_world *world, dpt_tool tool, uint64_t *user);

/*
 * Test a motion without moving the tool: from where it was last set to `pose`, or to `segments` in the world frame, up
 * to the first touch. The path is that of a step. Bodies rest where they were last set. The world does not change, and
 * no budget is spent. A long rotation near a large mesh takes far longer than a step.
 *
 *   clearance  m. A surface touches if it is within the radius plus this. If that sum is negative, the axis itself is
 *              tested
 *   first      the first touch, as in dpt_tool_get_sweep; may be NULL.
 *              DPT_SWEEP_HIT   a touch at `time`; 0 if something touches at the beginning. The normal is zero if the
 *                              axis goes through the surface there
 *              DPT_SWEEP_FREE  no touch; `time` is 1
 *              DPT_SWEEP_NONE  unknown, because the tool's or a body's pose cannot be used; `time` is 0
 *   reached    where the tool is at `time`; may be NULL. If `time` is not 0, nothing touches the tool there. With
 *              segments: `count` of them, and it may be the array `segments`
 *
 * Errors are those of dpt_tool_set_pose and dpt_tool_set_segments. They leave outputs and the tool as they were. A
 * clearance that is not finite or beyond DPT_COORDINATE_MAX is DPT_E_FINITE.
 */
DPT_API dpt_result dpt_tool_try_pose(const dpt_world *world, dpt_tool tool, const dpt_pose *pose, double clearance,
                                     dpt_sweep *first, dpt_pose *reached);
DPT_API dpt_result dpt_tool_try_segments(const dpt_world *world, dpt_tool tool, const dpt_segment *segments,
                                         uint32_t count, double clearance, dpt_sweep *first, dpt_segment *reached);

/*
 * Settings of a tool; used like dpt_body_settings. DPT_LAW_PROXY for a free tool of several segments is
 * DPT_E_UNSUPPORTED.
 */
typedef struct dpt_tool_settings {
    uint32_t size;    /* sizeof(dpt_tool_settings), set by the caller */
    uint32_t law;     /* DPT_LAW_...; changing it is a teleport to where the tool is */
    double stiffness; /* N/m, 0..1e9; 0: no force */
    /*
     * Of the proxy, Nm/rad, 0..1e9; 0: stiffness times the mean square of the distance of the segments' points from
     * their centre, which is L^2 / 12 for one segment of length L. It counts as 1e-6 to 1e6 times that. Of points
     * alone, all count alike.
     */
    double rotational_stiffness;
    /*
     * Of the proxy, Ns/m, 0..1e9: a damper beside the spring, in rotation in the same proportion. It takes its speed
     * from the last two steps, and never pulls the tool towards the surface; 0
     */
    double damping;
    /* 1: the proxy does not turn away from the device, for devices that give no torque; 0 */
    uint32_t lock_rotation;
    /*
     * 1: of the tool's segments, those alone are searched for that may be nearest, or within the margin of a body. The
     * hit of each other is DPT_STATUS_BOUNDED, with a pair that was nearest before and a true lower bound, and without a
     * gap; dpt_step.status does not count it. For tools of many segments. With DPT_METHOD_EXACT alone, the others search
     * for all; docs/algorithms/near_only.md; 0
     */
    uint32_t near_only;
} dpt_tool_settings;

DPT_API dpt_result dpt_tool_set_settings(dpt_world *world, dpt_tool tool, const dpt_tool_settings *settings);
DPT_API dpt_result dpt_tool_get_settings(const dpt_world *world, dpt_tool tool, dpt_tool_settings *settings);

/*
 * The pose of the tool's proxy, from the last step: of its frame, in the world; of a free tool that of a frame whose
 * origin is end a and whose x axis points to end b. It is the device's pose where nothing is in the way. For a viewer
 * to draw. Before the first step since the tool was placed it is where the tool was set last. A tool without a proxy
 * has the pose of dpt_tool_get_pose. The identity on an error.
 *
 * While a free tool touches something, its proxy grows only slowly to a greater length or radius.
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
    double distance;   /* smallest distance of any tool, m; 0 if no tool has an answer */
    uint32_t contacts; /* of all tools */
    uint32_t flags;    /* DPT_STEP_FLAG_... */
} dpt_step;

/* Bits of dpt_step.flags. */
enum {
    /* More contacts needed room than max_contacts, those included that are kept while they are unknown. Forces and
       depths include all of them. */
    DPT_STEP_FLAG_CONTACTS_FULL = 1
};

/*
 * One tick of `dt` seconds, above 0 and at most 1e6. After an error all wrenches are zero and every answer is stale.
 * Input that cannot be used is no error of the step: it returns DPT_OK, and the answers concerned are stale.
 *
 * A tool that stands still, with all that it depends on, is not searched for again: its answers stay, and their
 * `work` is 0. Its force goes on, with fades and dampers (docs/algorithms/rest.md).
 *
 *   out   may be NULL
 *
 * The functions below report the last step, whatever was set after it. They may name a body that was removed after it.
 */
DPT_API dpt_result dpt_world_step(dpt_world *world, double dt, dpt_step *out);

/*
 * The nearest pair of a tool and all bodies, from the last step. Where a proxy is held back, the contact is
 * DPT_CONTACT_PENETRATING, and gap and depth are not known.
 */
DPT_API dpt_result dpt_tool_get_hit(const dpt_world *world, dpt_tool tool, dpt_hit *hit);

/* The same of one segment of the tool, from 0. */
DPT_API dpt_result dpt_tool_get_segment_hit(const dpt_world *world, dpt_tool tool, uint32_t segment, dpt_hit *hit);

/*
 * The tool's contacts, from the last step. They are sorted by segment. Within a segment they are grouped by body, in no
 * stated order of bodies. Within a body they run from the segment's end a.
 *   contacts   at most `capacity` are written. contacts[0].size must be set. May be NULL if capacity is 0
 *   count      how many there are, which may be more than `capacity`
 */
DPT_API dpt_result dpt_tool_get_contacts(const dpt_world *world, dpt_tool tool, dpt_contact *contacts,
                                         uint32_t capacity, uint32_t *count);

/* The first touch of a segment of the tool (counted from 0) between the last two steps. A proxy has none. */
DPT_API dpt_result dpt_tool_get_sweep(const dpt_world *world, dpt_tool tool, uint32_t segment, dpt_sweep *sweep);

/*
 * The strip of a segment (counted from 0), and the overlap of the segment with each of its triangles, as
 * dpt_strip_overlaps computes it. The strip is empty if the segment was not within the margin, or if the world has no
 * strips. A strip of routes is also empty if the triangles of the segment's ends and of the nearest point are not
 * connected.
 *   flags   DPT_STRIP_FLAG_...; may be NULL
 */
DPT_API dpt_result dpt_tool_get_strip(const dpt_world *world, dpt_tool tool, uint32_t segment, dpt_overlap *overlaps,
                                      uint32_t capacity, uint32_t *count, uint32_t *flags);

/*
 * Whether a tool feels a force in the last step, and if not, why. The first of these that holds:
 *   STALE      there is no answer: the tool was added or teleported, or the world was reset, after the last step; or
 *              the step failed; or the tool's or a body's input cannot be used
 *   OFF        the world's `until` ends before the response, or the tool's stiffness is 0
 *   ACTS       at least one segment is pushed: there is a force
 *   UNDECIDED  at least one segment may touch something, but the direction of its force is unknown: its contact is
 *              DPT_CONTACT_UNKNOWN, or it goes through a surface that has no sides
 *   FREE       no segment penetrates anything, or there are no bodies
 *   INSIDE     DPT_LAW_PROXY: the tool began inside something, or a body was added or teleported around it, and it has
 *              not been outside since
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
    /* The wrench fades and has not reached its new value, so it may differ from zero whatever `reason` says. */
    DPT_FORCE_FLAG_FADING = 1,
    /* The reason is DPT_FORCE_ACTS, but another segment is undecided, and its part of the wrench is missing. */
    DPT_FORCE_FLAG_PARTIAL = 2,
    /* The pose that held the proxy is gone, and it moves on to another: the force may change fast. */
    DPT_FORCE_FLAG_FOLD = 4,
    /* Moving bodies leave the proxy no free pose, and it starts again at the device. The step's contacts are those before. */
    DPT_FORCE_FLAG_SQUEEZED = 8,
    /* The proxy was more than 1 rad from the device, and starts again there. The step's contacts are those before. */
    DPT_FORCE_FLAG_REPLACED = 16,
    /* A function of the program's own has had the wrench; see dpt_tool_set_shaper. */
    DPT_FORCE_FLAG_SHAPED = 32,
    /*
     * A budget made the proxy wait, or what is felt of it has not caught up since. The wrench is what the surfaces that
     * hold the proxy would give if it had gone on along them, and changes no faster than without a budget:
     * docs/algorithms/force.md.
     */
    DPT_FORCE_FLAG_BEHIND = 64
};

/*
 * What a tool feels in the last step.
 *
 *   wrench  force on the tool, and torque about the origin of its frame (of a free tool: about end a of its first
 *           segment), in world axes, before any limits; docs/algorithms/force.md. With DPT_LAW_POINT it is the sum
 *           over the tool's segments. Zero unless `reason` is DPT_FORCE_ACTS, or DPT_FORCE_FLAG_FADING or _SHAPED
 *           is set
 *   reason  DPT_FORCE_...
 *   flags   DPT_FORCE_FLAG_...
 *
 * Fade: the library itself can end a push while the tool does not move away. It does so if it gives up the side of an
 * open sheet (the tool is deeper than side_limit, a motion could not be followed, the axis is at the sheet's border, or
 * there is no room for the contact), or if the contact becomes unknown. Then the segment's part of the wrench changes
 * in a straight line to its new value, which is zero while the contact is unknown. This takes dpt_world_def.fade
 * seconds, counted by the steps' dt. The wrench is always between the old and the new value. Another such event starts
 * the time again. With a proxy it fades where the proxy has to start again (DPT_FORCE_FLAG_SQUEEZED, _REPLACED), and
 * where a body that was added or teleported may be round it.
 *
 * The wrench is zero at once after an error, a teleport, a reset or input that cannot be used, with stiffness 0, and
 * when a rigid tool becomes free or the reverse. The push of a body that is removed or teleported ends at once, too. If
 * the tool moves away, the push goes to zero by itself.
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
    /* Of the proxy, contacts with friction that stuck in the step, and that slipped. */
    uint32_t sticking;
    uint32_t slipping;
    /* J: what bodies that moved before the step did on the tool, by its contacts; docs/algorithms/passivity.md. */
    double body_work;
} dpt_force_report;

/* On an error, `reason` is DPT_FORCE_STALE and the wrench is zero. */
DPT_API dpt_result dpt_tool_get_force_report(const dpt_world *world, dpt_tool tool, dpt_force_report *force);

/*
 * A function of the program's own that shapes a tool's wrench: a guide, a vibration, another law. It is called in each
 * step in which the tool has an answer, in worlds that respond, after the tool's law.
 *   report  what the law gives
 *   wrench  that of the report; the function changes it. If it is not finite then, it is zero, and the reason is
 *           DPT_FORCE_UNDECIDED
 * It must not call functions on the same world but the getters of the tool's pose and proxy. What energy it gives or
 * takes is its own affair: the report's energy is that of the law. A NULL function ends it. It stays through
 * dpt_world_reset and changes of settings.
 */
typedef void (*dpt_force_fn)(void *user, const dpt_force_report *report, double dt, dpt_wrench *wrench);

DPT_API dpt_result dpt_tool_set_shaper(dpt_world *world, dpt_tool tool, dpt_force_fn shape, void *user);

/* The wrench of dpt_tool_get_force_report alone; zero on an error. */
DPT_API dpt_result dpt_tool_get_wrench(const dpt_world *world, dpt_tool tool, dpt_wrench *wrench);

DPT_END

#endif
