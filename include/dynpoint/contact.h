/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Contacts of a tool and what it met between two steps, as a world (world.h) answers them. Plain structs: any thread may
 * read a copy.
 */
#ifndef DYNPOINT_CONTACT_H
#define DYNPOINT_CONTACT_H

#include "dynpoint/types.h"

DPT_BEGIN

/* Bits of dpt_contact.flags. */
enum {
    DPT_CONTACT_FLAG_CROSSING = 1, /* the axis goes through the surface */
    /* an open sheet: the gap is counted from the side on which the tool was first */
    DPT_CONTACT_FLAG_SIDED = 2,
    /* its integrals or its deepest pair are less accurate than usual: memory or work for samples ended before */
    DPT_CONTACT_FLAG_COARSE = 4
};

/*
 * A contact: a stretch of a segment's axis where its surface is within the world's margin of a body, or inside it
 * (docs/algorithms/contacts.md). Vectors are in world axes.
 *
 *   id          the same from tick to tick while the contact lives; never 0
 *   triangle    of the deepest pair: the source file's number
 *   contact     DPT_CONTACT_... of its gap
 *   s0, s1      the stretch, in 0..1 of the segment
 *   s, p, q     the deepest pair: p on the axis, q on the mesh nearest to it
 *   weight      of the triangle's corners, as dpt_mesh_get_triangle has them, at q: sum 1
 *   normal      unit, the way out at q: from q to p outside, from p to q inside; or smoothed, as the world's def asks.
 *               Zero where there is none
 *   gap         signed distance of the tool's surface at p
 *
 * Integrals over the length of the stretch. With w(s) = max(0, margin - gap(s)) and n(s) the way out:
 *   overlap     of w, in m^2
 *   moment      of s w, in m^2: moment / overlap is where the contact's middle is
 *   thrust      of w n, in m^2
 *   thrust_moment  of s w n, in m^2
 * They stay continuous in the motion, where a nearest point jumps; when contacts join, theirs add up.
 */
typedef struct dpt_contact {
    uint32_t
        size; /* the caller's sizeof(dpt_contact); of an array, the first one's counts for all */
    uint32_t id;
    uint32_t body;
    uint32_t segment;
    uint32_t triangle;
    uint32_t contact;
    uint32_t flags;
    uint32_t reserved;
    double s0;
    double s1;
    double s;
    double gap;
    double p[3];
    double q[3];
    double normal[3];
    double weight[3];
    double overlap;
    double moment;
    double thrust[3];
    double thrust_moment[3];
} dpt_contact;

/* What is known of a motion between two steps. */
enum {
    /* There is none: a first step, a teleport, a motion that was given up, or the axis was through something already. */
    DPT_SWEEP_NONE = 0,
    DPT_SWEEP_FREE = 1,      /* nothing was met */
    DPT_SWEEP_HIT = 2,       /* met, at `time` */
    DPT_SWEEP_UNFINISHED = 3 /* the budget ended it; the next step goes on with it */
};

/*
 * What a segment met first on its way from the last step to this one: its surface or, where that was in contact before,
 * its axis. Ends move along straight lines, rigid tools and bodies along the shortest turn. None is missed; a hit may
 * be within 1e-6 of the mesh's diagonal of a touch.
 *
 *   time      0..1 of the step that is told of
 *   age       how many steps ago that was; 0 is this one. A budget may leave motions unfinished: the oldest is told first
 *   s         of the point of the axis that met
 *   q         where on the mesh, in the world, with the body where it is now
 *   normal    unit, of the mesh there, on the side that the tool came from
 */
typedef struct dpt_sweep {
    uint32_t size; /* sizeof(dpt_sweep), set by the caller */
    uint32_t status;
    uint32_t segment;
    uint32_t body;
    uint32_t triangle;
    uint32_t age;
    double time;
    double s;
    double q[3];
    double normal[3];
} dpt_sweep;

DPT_END

#endif
