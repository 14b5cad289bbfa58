/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The nouns that all calls share: plain values, without functions. SI units (m, kg, s, N, Nm, rad), right-handed frames, world axes
 * unless a field says otherwise.
 */
#ifndef DYNPOINT_TYPES_H
#define DYNPOINT_TYPES_H

#include "dynpoint/result.h"

/* No coordinate, length or radius may exceed this, in metres. */
#define DPT_COORDINATE_MAX 1e6

/* In place of a triangle, vertex, segment or link where there is none. No body or tool has the id 0. */
#define DPT_NONE UINT32_MAX

/* The most joints of an arm or a device. It never changes. */
#define DPT_JOINTS_MAX 8

/*
 * Position and orientation of a frame in the world. A point x of the frame is at
 * position + R(orientation) x in the world.
 *   orientation: quaternion (w, x, y, z), of unit length within 1e-6; it is normalised before use. q and -q are the
 *   same orientation.
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
 * A capsule: all points within `radius` of the axis AB. Radius 0 is a line segment; a zero length is
 * a ball or a point, and not an error.
 */
typedef struct dpt_segment {
    double a[3];
    double b[3];
    double radius;
} dpt_segment;

/* Force, and torque about a stated point, both in world axes. */
typedef struct dpt_wrench {
    double force[3];
    double torque[3];
} dpt_wrench;

/* How a nearest pair is found. */
enum {
    DPT_METHOD_EXACT = 0, /* the tree, spared by what was proven in earlier ticks; exact */
    DPT_METHOD_TREE = 1,  /* box tree, started from the last answer; exact */
    DPT_METHOD_BRUTE = 2, /* every triangle in double; exact, slow, the yardstick */
    DPT_METHOD_PAPER = 3  /* dynamic points by neighbour descent; local; worlds only */
};

/* What is known of an answer. */
enum {
    DPT_STATUS_STALE = 0,   /* no valid input: nothing else in the answer counts */
    DPT_STATUS_LOCAL = 1,   /* found without proof; lower_bound is 0 */
    DPT_STATUS_BOUNDED = 2, /* the best pair so far, with a true lower bound */
    DPT_STATUS_EXACT = 3    /* proven within error_bound */
};

/* How the tool's surface stands to the mesh. */
enum {
    /*
     * Not decided: the budget ended before, no side of an open sheet is known, the axis crosses too often, or there is no
     * mesh.
     */
    DPT_CONTACT_UNKNOWN = 0,
    DPT_CONTACT_SEPARATED = 1,  /* gap > error_bound */
    DPT_CONTACT_TOUCHING = 2,   /* |gap| <= error_bound */
    DPT_CONTACT_PENETRATING = 3 /* gap < -error_bound */
};

/* Bits of dpt_hit.flags. */
enum {
    DPT_HIT_FLAG_GAP = 1,     /* `gap` and `depth` are known */
    DPT_HIT_FLAG_CROSSING = 2 /* the axis crosses the mesh: distance 0, p = q */
};

/*
 * The nearest pair of one tool axis and the meshes, at the pose that was given.
 *
 *   distance     unsigned, from the axis (not the capsule's surface) to the mesh; 0 when it crosses
 *   s            in 0..1: p = a + s (b - a)
 *   p, q         nearest points on the axis and on the mesh, in the world
 *   triangle     the source file's number of the triangle that holds q
 *   gap          signed distance of the capsule's surface: the least of sd - radius along the axis, sd being
 *                the distance of a point to the mesh, negative inside a part that has an inside and behind an
 *                open sheet of which a side is kept; where DPT_HIT_FLAG_GAP is set. Within error_bound while the axis is
 *                outside, else within 1e-5 of the mesh's diagonal. Where a part has holes, an axis may enter and leave
 *                its inside through them between two samples: then that inside is missed
 *   depth        max(0, -gap)
 *   error_bound  |distance - true distance| <= error_bound
 *   lower_bound  <= true distance
 *   work         16-lane blocks that the search looked at (boxes or triangles)
 */
typedef struct dpt_hit {
    uint32_t size; /* the caller's sizeof(dpt_hit); of an array, the first one's counts for all */
    uint32_t status;
    uint32_t contact;
    uint32_t flags;
    uint32_t triangle;
    uint32_t segment; /* of a tool with several: which one, from 0 */
    uint32_t body;    /* the body's id in a world; 0 in a stateless query */
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
/* An empty hit that knows its size, as an initialiser. */
#ifdef __cplusplus
#define DPT_HIT_INIT { sizeof(dpt_hit), 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, { 0, 0, 0 }, { 0, 0, 0 }, 0, 0 }
#else
#define DPT_HIT_INIT { .size = (uint32_t)sizeof(dpt_hit) }
#endif
/* clang-format on */

#endif
