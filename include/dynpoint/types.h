/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Types that all headers share. They are plain values; any thread may use its own. Units are SI (m, kg, s, N, Nm, rad).
 * Frames are right-handed. Vectors are in world axes unless a field says otherwise.
 */
#ifndef DYNPOINT_TYPES_H
#define DYNPOINT_TYPES_H

#include "dynpoint/result.h"

/* The largest size of a coordinate, a length or a radius, in m. */
#define DPT_COORDINATE_MAX 1e6

/* Stands for no triangle, vertex, segment or link. No body or tool has the id 0. */
#define DPT_NONE UINT32_MAX

/* The most joints that an arm or a device has. This number never changes. */
#define DPT_JOINTS_MAX 8

/*
 * Position and orientation of a frame in the world. A point x of the frame is at position + R(orientation) x in the
 * world.
 *
 *   position      m
 *   orientation   quaternion (w, x, y, z), of unit length within 1e-6; it is normalised before use. q and -q are the
 *                 same orientation
 */
typedef struct dpt_pose {
    double position[3];
    double orientation[4];
} dpt_pose;

/* clang-format off */
/* The identity pose, as an initialiser. */
#define DPT_POSE_IDENTITY { { 0.0, 0.0, 0.0 }, { 1.0, 0.0, 0.0, 0.0 } }
/* clang-format on */

/*
 * A capsule: all points within `radius` of the axis AB, in m. Radius 0 is a line segment. If A = B, it is a ball or a
 * point, which is not an error.
 */
typedef struct dpt_segment {
    double a[3];
    double b[3];
    double radius;
} dpt_segment;

/* Force (N), and torque (Nm) about a stated point, both in world axes. */
typedef struct dpt_wrench {
    double force[3];
    double torque[3];
} dpt_wrench;

/* How a nearest pair is found. */
enum {
    DPT_METHOD_EXACT = 0, /* box tree, with proofs kept from earlier ticks; exact */
    DPT_METHOD_TREE = 1,  /* box tree, started from the last answer; exact */
    DPT_METHOD_BRUTE = 2, /* every triangle in double; exact and slow, to check the others */
    DPT_METHOD_PAPER = 3  /* the paper's dynamic points by descent; local; in worlds only */
};

/* How far an answer can be trusted. */
enum {
    DPT_STATUS_STALE = 0,   /* there was no valid input: ignore the rest of the answer */
    DPT_STATUS_LOCAL = 1,   /* found without proof; lower_bound is 0 */
    DPT_STATUS_BOUNDED = 2, /* a pair, and lower_bound: a budget ended the search, or near_only */
    DPT_STATUS_EXACT = 3    /* proven within error_bound */
};

/* Whether the tool's surface touches the mesh. */
enum {
    /* not decided: dpt_hit.flags says why; or there is no mesh, or it was not asked for */
    DPT_CONTACT_UNKNOWN = 0,
    DPT_CONTACT_SEPARATED = 1,  /* gap > error_bound; of a far segment no gap is told */
    DPT_CONTACT_TOUCHING = 2,   /* |gap| <= error_bound */
    DPT_CONTACT_PENETRATING = 3 /* gap < -error_bound */
};

/* Bits of dpt_hit.flags. */
enum {
    DPT_HIT_FLAG_GAP = 1,      /* `gap` and `depth` are known */
    DPT_HIT_FLAG_CROSSING = 2, /* the axis crosses the mesh: distance 0, p = q */
    /* Why contact is unknown; several may be set: */
    DPT_HIT_FLAG_BUDGET = 4,         /* a budget ended first; later ticks go on */
    DPT_HIT_FLAG_NO_SIDE = 8,        /* the axis crosses an open sheet and has no side of it yet */
    DPT_HIT_FLAG_CROSSINGS_FULL = 16 /* the axis crosses a mesh more often than there is room for */
};

/*
 * The nearest pair of one tool axis and the meshes.
 *
 *   status       DPT_STATUS_...
 *   contact      DPT_CONTACT_...
 *   flags        DPT_HIT_FLAG_...
 *   triangle     source number of the triangle that holds q
 *   segment      index of the tool's segment, from 0
 *   body         the body's id in a world; 0 in a stateless query
 *   work         number of 16-lane blocks (boxes or triangles) that the search evaluated
 *   distance     from the axis (not the capsule's surface) to the mesh, unsigned, m; 0 if the axis crosses the mesh
 *   s            of p, in 0..1: p = a + s (b - a)
 *   p, q         nearest points of the axis and of the mesh, in the world
 *   gap          signed distance of the capsule's surface, m (below); valid if DPT_HIT_FLAG_GAP is set
 *   depth        max(0, -gap)
 *   error_bound  |distance - true distance| <= error_bound
 *   lower_bound  <= true distance
 *
 * The gap is the minimum of sd - radius along the axis. sd is the signed distance of a point to the mesh: negative
 * inside a part that has an inside, and behind an open sheet if the tool's side of it is known. The gap is within
 * error_bound while the axis is outside, else within 1e-5 of the mesh's diagonal. If a part has holes, an axis may
 * enter and leave its inside through them between two samples. Such an inside is missed.
 */
typedef struct dpt_hit {
    uint32_t size; /* the caller's sizeof(dpt_hit); in an array, set that of the first item */
    uint32_t status;
    uint32_t contact;
    uint32_t flags;
    uint32_t triangle;
    uint32_t segment;
    uint32_t body;
    uint32_t work;
    double distance;
    double gap;
    double depth;
    double s;
    double p[3];
    double q[3];
    double error_bound;
    double lower_bound;
} dpt_hit;

/* clang-format off */
/* An empty hit with its size set, as an initialiser. */
#ifdef __cplusplus
#define DPT_HIT_INIT { sizeof(dpt_hit), 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, { 0, 0, 0 }, { 0, 0, 0 }, 0, 0 }
#else
#define DPT_HIT_INIT { .size = (uint32_t)sizeof(dpt_hit) }
#endif
/* clang-format on */

#endif
