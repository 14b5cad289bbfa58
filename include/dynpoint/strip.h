/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Strips: the triangles under a tool, in a buffer of fixed capacity. Two kinds: the paper's, made of routes from
 * triangle to triangle (docs/algorithms/routes.md), and the shadow of the tool (docs/algorithms/strip.md). Triangles
 * are named by their numbers in the source. In a world, dpt_world_def.strip does this for every segment in each tick;
 * here it is done without one, in the caller's memory.
 *
 * Threads: a strip belongs to one thread at a time; the meshes that it is filled from may be shared.
 */
#ifndef DYNPOINT_STRIP_H
#define DYNPOINT_STRIP_H

#include "dynpoint/mesh.h"
#include "dynpoint/types.h"

DPT_BEGIN

/* A buffer of triangles, and what the walks need. */
typedef struct dpt_strip dpt_strip;

typedef struct dpt_strip_def {
    uint32_t size;     /* sizeof(dpt_strip_def) */
    uint32_t capacity; /* triangles, 1..2^20 */
    uint32_t
        search; /* vertices that the search for one route may visit, at most 2^28; 0: no routes */
    uint32_t reserved; /* 0 */
} dpt_strip_def;

/* The bytes that a strip needs, in this version of the library. 0 for a def that is not valid. */
DPT_API size_t dpt_strip_bytes(const dpt_strip_def *def);

/* Make an empty strip in `block`, aligned to 8 and of at least dpt_strip_bytes(def). */
DPT_API dpt_result dpt_strip_create(void *block, size_t bytes, const dpt_strip_def *def,
                                    dpt_strip **strip);

/* Bits of a strip's flags. */
enum {
    DPT_STRIP_FLAG_FULL = 1,   /* there is more of it than its capacity */
    DPT_STRIP_FLAG_BORDER = 2, /* a shadow: it ends at an open edge */
    DPT_STRIP_FLAG_NONMANIFOLD =
        4 /* a shadow: it goes on over an edge of three triangles or more, to all of them */
};

/*
 * The triangles of a strip, *count of them; valid until the strip is filled again. For NULL: NULL, and *count is 0.
 *   flags   DPT_STRIP_FLAG_..., may be NULL
 */
DPT_API const uint32_t *dpt_strip_get_triangles(const dpt_strip *strip, uint32_t *count,
                                                uint32_t *flags);

/*
 * The route from one triangle to another, both included. It is a shortest path over triangles that share a vertex; its
 * length less one is the paper's traversal distance. At triangle c the next one is a neighbour that is one step nearer
 * to `to`: first those that share two vertices or three with c, among them the one with the least number (the paper's
 * Figure 6). A route is directed: the way back may be another one.
 *
 * The search starts from both ends and follows the vertices around them. It needs no table.
 *
 *   DPT_E_DROPPED      the compiler dropped one of the two
 *   DPT_E_UNREACHABLE  no triangles lead from one to the other
 *   DPT_E_FULL         the search needs more vertices than def.search
 *
 * On an error the strip is empty. A route of more triangles than the capacity is cut, and flagged.
 */
DPT_API dpt_result dpt_strip_route(dpt_strip *strip, const dpt_mesh *mesh, uint32_t from,
                                   uint32_t to);

/*
 * The paper's strip: the route from a to p and the route from b to p, each triangle once. Give the triangles nearest to
 * the tool's ends as a and b, and the triangle nearest to the tool as p.
 */
DPT_API dpt_result dpt_strip_routes(dpt_strip *strip, const dpt_mesh *mesh, uint32_t a, uint32_t b,
                                    uint32_t p);

/*
 * The shadow of a segment AB: all points
 *
 *     A + t (B - A) + x e + y w + z d,   t in 0..1,  |x|, |y| <= radius + width,  |z| <= depth
 *
 * d is `direction`, made unit. e is the unit vector along the part of B - A that is orthogonal to d, and w = d x e. If
 * that part is shorter than 1e-9 of B - A, e is any unit vector orthogonal to d.
 */
typedef struct dpt_shadow {
    uint32_t size;       /* sizeof(dpt_shadow) */
    uint32_t triangle;   /* where the strip begins: the one that holds the nearest point */
    dpt_segment segment; /* in the world */
    double direction[3]; /* from the tool to the mesh, or back; of a length from 1e-100 to 1e100 */
    double width;        /* beside the radius, m, >= 0 */
    double depth;        /* along the direction, to both sides of the axis, m, >= 0 */
} dpt_shadow;

/*
 * The triangles under the shadow: starting from the first triangle, all that are reached over edges that meet the shadow.
 * Empty if the first triangle does not meet it. Each triangle once, in no stated order; a full strip holds those that
 * were reached first.
 *
 * Filling a strip again for the same shadow costs nothing but the comparison.
 *
 *   pose   of the mesh in the world; NULL is the identity
 */
DPT_API dpt_result dpt_strip_shadow(dpt_strip *strip, const dpt_mesh *mesh, const dpt_pose *pose,
                                    const dpt_shadow *shadow);

/* Bits of dpt_overlap.flags. */
enum { DPT_OVERLAP_FLAG_CROSSING = 1 /* the axis goes through the triangle */ };

/*
 * How a segment stands to one triangle.
 *
 *   distance   unsigned, from the axis; 0 when it crosses
 *   s          in 0..1, of the nearest point p of the axis
 *   q          the nearest point of the triangle, in the world; `weight` of its corners, sum 1
 *   overlap    how far the triangle must be moved, against its normal on the tool's side, until the tool lies free on
 *              it; 0 if it does not touch. Also for a tool that has gone through: the part of the tool that lies over
 *              the triangle, along that normal, counts
 *   gap        -overlap; or, where that is 0, the distance less the radius
 */
typedef struct dpt_overlap {
    uint32_t
        size; /* the caller's sizeof(dpt_overlap); of an array, the first one's counts for all */
    uint32_t triangle;
    uint32_t flags;
    uint32_t reserved;
    double distance;
    double s;
    double q[3];
    double weight[3];
    double gap;
    double overlap;
} dpt_overlap;

/*
 * How a segment stands to the triangles of a strip, in the strip's order, up to `capacity` of them.
 *   mesh     the one that the strip was filled from, else DPT_E_ARGUMENT; it must still be there
 *   side     +1: the tool is on the side that the triangles' normals point to; -1: on the other one, of an open sheet
 *   count    gets how many there are, which may be more than fit
 */
DPT_API dpt_result dpt_strip_overlaps(const dpt_strip *strip, const dpt_mesh *mesh,
                                      const dpt_pose *pose, const dpt_segment *segment,
                                      int32_t side, dpt_overlap *overlaps, uint32_t capacity,
                                      uint32_t *count);

DPT_END

#endif
