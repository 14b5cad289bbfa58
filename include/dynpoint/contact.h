/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The contacts of a tool, and the first touch of its motion between two steps. A world gives both (world.h).
 *
 * Threads: these are plain structs; any thread may read a copy.
 */
#ifndef DYNPOINT_CONTACT_H
#define DYNPOINT_CONTACT_H

#include "dynpoint/types.h"

DPT_BEGIN

/* Bits of dpt_contact.flags. */
enum {
    DPT_CONTACT_FLAG_CROSSING = 1, /* the axis goes through the surface */
    /* with an open sheet: the gap counts from the side where the tool was when the contact began */
    DPT_CONTACT_FLAG_SIDED = 2,
    /* the integrals or the deepest pair are less accurate than usual: memory or work for samples ran out */
    DPT_CONTACT_FLAG_COARSE = 4
};

/*
 * A contact: a stretch of a segment's axis along which the tool's surface is within the world's margin of a body, or
 * inside the body (docs/algorithms/contacts.md). Points are in the world, vectors in world axes.
 *
 *   id             the same from tick to tick while the contact lasts; never 0
 *   body           id of the body
 *   segment        index of the tool's segment, from 0
 *   triangle       source number of the triangle of the deepest pair
 *   contact        DPT_CONTACT_... of the gap
 *   flags          DPT_CONTACT_FLAG_...
 *   s0, s1         ends of the stretch: p = a + s (b - a), s in 0..1
 *   s, p, q        the deepest pair: the point p of the axis at s, and the point q of the mesh nearest to it
 *   weight         weights of the triangle's corners at q, in the order of dpt_mesh_get_triangle; their sum is 1
 *   normal         exit direction at q, unit: from q to p outside, from p to q inside; smoothed if the world's def says
 *                  so; 0 if there is none
 *   gap            signed distance of the tool's surface at p, m
 *
 * Integrals over the length of the stretch, in m^2. With w(s) = max(0, onset - gap(s)), where the onset is the margin
 * unless the world's def says otherwise, and n(s) the exit direction:
 *
 *   overlap        of w
 *   moment         of s w: moment / overlap is the s of the contact's middle
 *   thrust         of w n
 *   thrust_moment  of s w n
 *   square         of w^2, in m^3: twice what a bed of springs of 1 N/m^2 stores
 *
 * At s0 and s1:
 *
 *   end_gap        the gap, m: the margin, except where the stretch ends with the segment
 *   end_normal     the exit direction
 *
 * The integrals are continuous in the motion, even where a nearest point jumps. When contacts join, their integrals add
 * up.
 */
typedef struct dpt_contact {
    uint32_t size; /* the caller's sizeof(dpt_contact); in an array, set that of the first item */
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
    double square;
    double end_gap[2];
    double end_normal[2][3];
} dpt_contact;

/* The result of sweeping a motion between two steps. */
enum {
    /*
     * no motion was swept: a first step, a teleport, a motion given up, or the axis crossed a surface at its beginning
     */
    DPT_SWEEP_NONE = 0,
    DPT_SWEEP_FREE = 1,      /* the segment touched nothing */
    DPT_SWEEP_HIT = 2,       /* the segment touched a mesh, at `time` */
    DPT_SWEEP_UNFINISHED = 3 /* the budget ran out; the next step continues the sweep */
};

/*
 * The first touch of a segment on its motion from the last step to this one. The segment's surface is swept; its axis,
 * if its surface was in contact at the beginning. Ends of free segments move along straight lines, rigid tools and
 * bodies along the shortest turn. No touch is missed. A hit may be reported where the segment comes within 1e-6 of the
 * mesh's diagonal without a touch.
 *
 *   status    DPT_SWEEP_...
 *   segment   index of the tool's segment, from 0
 *   body      id of the body touched
 *   triangle  its source number
 *   time      of the touch, in 0..1 of the motion
 *   age       how many steps ago the motion was; 0 is this step. With a budget, motions may wait: the oldest comes
 *             first
 *   s         of the point of the axis that touched, in 0..1
 *   q         the point of the mesh, in the world, at the body's present pose
 *   normal    of the mesh at q, unit, in world axes, on the side that the tool came from
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
