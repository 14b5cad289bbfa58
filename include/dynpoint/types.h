/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The nouns that all calls share. SI units (m, kg, s, N, Nm, rad), right-handed frames, world axes
 * unless a field says otherwise.
 */
#ifndef DYNPOINT_TYPES_H
#define DYNPOINT_TYPES_H

#include "dynpoint/result.h"

/* No coordinate, length or radius may exceed this, in metres. */
#define DPT_COORDINATE_MAX 1e6

/* Written where there is no triangle, vertex, body or segment to name. */
#define DPT_NONE UINT32_MAX

/* Of an arm, and of a device. */
#define DPT_JOINTS_MAX 8

/*
 * Position and orientation of a frame in the world. A point x of the frame is at
 * position + R(orientation) x in the world.
 *   orientation: quaternion (w, x, y, z), of unit length within 1e-6; it is normalised before use.
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
    DPT_CONTACT_UNKNOWN =
        0, /* not decided: by the budget, on an open sheet of which no side is known, on an axis that crosses more
              than 31 times, or without a mesh */
    DPT_CONTACT_SEPARATED = 1,  /* gap > error_bound */
    DPT_CONTACT_TOUCHING = 2,   /* |gap| <= error_bound */
    DPT_CONTACT_PENETRATING = 3 /* gap < -error_bound */
};

/* Bits of dpt_hit.flags. */
enum {
    DPT_HIT_GAP = 1,     /* `gap` and `depth` are known */
    DPT_HIT_CROSSING = 2 /* the axis crosses the mesh: distance 0, p = q */
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
 *                open sheet of which a side is kept; where DPT_HIT_GAP is set. Within error_bound while the axis is
 *                outside, else within 1e-5 of the mesh's diagonal; at a part with holes an inside that an axis enters and
 *                leaves through holes, between two of at least nine samples, may be missed
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

/* Bits of dpt_contact.flags. */
enum {
    DPT_REGION_CROSSING = 1, /* the axis goes through the surface */
    DPT_REGION_SIDED =
        2, /* an open sheet: the gap is counted from the side that the tool was first on */
    DPT_REGION_COARSE = 4 /* room or work for samples ended before its integrals were as right as
                             usual, or the pair was proven the deepest of the region */
};

/*
 * One region of contact: a stretch of a segment's axis where its surface is within the world's margin of a body,
 * or inside it (docs/algorithms/regions.md). Vectors are in world axes.
 *
 *   id          the same from tick to tick while the region lives; never 0
 *   triangle    of the deepest pair: the source file's number
 *   contact     DPT_CONTACT_... of its gap
 *   s0, s1      the stretch, in 0..1 of the segment
 *   s, p, q     the deepest pair: p on the axis, q on the mesh nearest to it
 *   weight      of the triangle's corners, as dpt_mesh_triangle has them, at q: sum 1
 *   normal      unit, the way out at q: from q to p outside, from p to q inside; or smoothed, as the world's def asks.
 *               Zero where there is none
 *   gap         signed distance of the tool's surface at p
 *
 * Integrals over the length of the stretch. With w = margin - gap(s), which is 0 at its ends, and n(s) the way out:
 *   overlap     of w, in m^2
 *   moment      of s w, in m^2: moment / overlap is where the region's middle is
 *   thrust      of w n, in m^2
 *   thrust_moment  of s w n, in m^2
 * They stay continuous in the motion, where a nearest point jumps; when regions join, theirs add up.
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
    DPT_SWEEP_NONE =
        0, /* there was none: a first step, a teleport, a way given up, or the axis was through already */
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

/* Instruction sets of the inner loops. All give the same bits; they differ in speed alone. */
enum {
    DPT_KERNEL_AUTO = 0, /* the widest that this machine has */
    DPT_KERNEL_SCALAR = 1,
    DPT_KERNEL_SSE2 = 2,
    DPT_KERNEL_AVX2 = 3,
    DPT_KERNEL_AVX512 = 4,
    DPT_KERNEL_NEON = 5
};

DPT_BEGIN

/* The kernel's name, "avx2"; "none" for a number that is no kernel. */
DPT_API const char *dpt_kernel_name(uint32_t kernel);

/* What DPT_KERNEL_AUTO comes to on this machine. */
DPT_API uint32_t dpt_kernel_best(void);

DPT_END

#endif
