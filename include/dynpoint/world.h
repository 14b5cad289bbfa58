/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A world: bodies (body.h), tools (tool.h), and the step that computes what the tools feel. It lives in one block of
 * memory that the caller supplies. Nothing here allocates, waits or locks.
 *
 *     dpt_world_def def;
 *     dpt_world_def_init(&def);
 *     void *block = malloc(dpt_world_bytes(&def));
 *     dpt_world_create(block, dpt_world_bytes(&def), &def, &world);
 *     dpt_body_add(world, mesh, &pose, &body);
 *     dpt_tool_add(world, &segment, 1, &tool);
 *     for each tick:
 *         dpt_tool_set_pose(world, tool, &device_pose);
 *         dpt_world_step(world, dt, NULL);
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
 * needs with dpt_world_info.work or `dynpoint replay --json`.
 *
 * If the budget ends a search, the hit is DPT_STATUS_BOUNDED: it has the best pair so far and a true lower bound.
 * Contact is unknown then, and the force fades to zero. The next step continues the search, so a tool at rest gets
 * its exact answer after some steps. Units that the searches leave are spent on contact: first on the gap and the
 * force, then on the contacts, which are DPT_CONTACT_FLAG_COARSE if the budget ends them. With a small budget the
 * contact of a tool at rest may stay unknown. docs/algorithms/budget.md says what a step costs beside its budget.
 * Contact that is solved together with tissue (dpt_bodies_step_springs) has as many units again.
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
    double fade;       /* s, 0..1, see dpt_tool_get_force_info; 0.002 */
    /*
     * Of all tools together, 0..65535. 0: none are listed (dpt_tool_get_contacts returns DPT_E_FULL), and a tick takes
     * about half the time. The force of DPT_LAW_PROXY is the same. Those of POINT and BED are, too, on closed meshes,
     * within rounding. On open sheets they lose the side from which a tool came: while the axis goes through a sheet
     * there is no force (DPT_FORCE_UNDECIDED), and beyond it none pushes the tool back. DPT_LAW_BED has its loads
     * (dpt_tool_get_loads) at the nearest pair. Ask for what you read or show, 32 say; 0
     */
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
     * takes as long. `dynpoint run` has the same default. 0: unlimited; 4000
     */
    uint32_t sweep_budget;
    uint32_t max_tips; /* of all tools together (tip.h), 0..65535; 4 */
    /*
     * Holes that tools may make in bodies, of all tools together, 0..65535 (insertion.h). 0: nothing is pierced; 0
     */
    uint32_t max_channels;
    uint32_t reserved; /* 0 */
} dpt_world_def;

/* Fill in the first `size` bytes; what dpt_world_def_init calls with its own caller's sizeof. */
DPT_API void dpt_world_def_defaults(dpt_world_def *def, size_t size);

static inline void dpt_world_def_init(dpt_world_def *def)
{
    dpt_world_def_defaults(def, sizeof *def);
}

/*
 * The bytes that a world of this def needs, in this version of the library; docs/measurements.md has examples. 0 for a
 * def that is not valid, or whose bytes do not fit into size_t.
 */
DPT_API size_t dpt_world_bytes(const dpt_world_def *def);

/*
 * Make a world in `block`, which is aligned to 8 and of at least dpt_world_bytes(def) bytes. The block must not move
 * while the world is used; a copy of its bytes is no world. What the def points to is read during the call.
 *
 * DPT_E_UNSUPPORTED: this machine does not have the kernel.
 */
DPT_API dpt_result dpt_world_create(void *block, size_t bytes, const dpt_world_def *def, dpt_world **world);

/* Forget all earlier steps: every tool is as if it had just been added. Poses, settings and user values stay. */
DPT_API dpt_result dpt_world_reset(dpt_world *world);

/*
 * The most that a world has used at one time since it was created, to choose the capacities of the def by, and its kernel.
 * dpt_world_reset leaves both as they are.
 *   contacts   contacts of one step, those that did not fit included
 *   strip      triangles of one strip; if it equals strip_capacity there may have been more
 *   work       units in one step
 *   kernel     that it uses, DPT_KERNEL_...; never DPT_KERNEL_AUTO
 */
typedef struct dpt_world_info {
    uint32_t size; /* sizeof(dpt_world_info), set by the caller */
    uint32_t bodies;
    uint32_t tools;
    uint32_t segments;
    uint32_t contacts;
    uint32_t strip;
    uint32_t work;
    uint32_t kernel;
} dpt_world_info;

DPT_API dpt_result dpt_world_get_info(const dpt_world *world, dpt_world_info *info);

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
    DPT_STEP_FLAG_CONTACTS_FULL = 1,
    /* A body that gives way was held where it was since the step before: new positions of it, or a step of its springs, were
       refused, as the call that made them has returned (body.h, springs.h). All else is as if it had not moved. */
    DPT_STEP_FLAG_BODY_HELD = 2
};

/*
 * One tick of `dt` seconds, above 0 and at most 1e6. After an error all wrenches are zero and every answer is stale.
 * Input that cannot be used is no error of the step: it returns DPT_OK, and the answers concerned are stale.
 *
 * A tool that stands still, with all that it depends on, is not searched for again: its answers stay, and their
 * `work` is 0. Its force goes on, with fades and dampers (docs/algorithms/rest.md).
 *
 *   out   may be NULL. Otherwise the step finds the hits of tools that a proxy holds back, too, which no force needs
 *         (dpt_tool_get_hit)
 */
DPT_API dpt_result dpt_world_step(dpt_world *world, double dt, dpt_step *out);

DPT_END

#endif
