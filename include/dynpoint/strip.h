/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Strips: the triangles under a tool, in a buffer of fixed capacity. There are two kinds. The paper's strip is made of
 * routes from triangle to triangle (docs/algorithms/routes.md). The other one is the shadow of the tool
 * (docs/algorithms/strip.md). All triangles here are source numbers. With dpt_world_def.strip a world fills a strip for
 * every segment in each tick. The functions below need no world, and work in the caller's memory.
 *
 * Threads: a strip belongs to one thread at a time. The meshes may be shared.
 */
#ifndef DYNPOINT_STRIP_H
#define DYNPOINT_STRIP_H

#include "dynpoint/mesh.h"
#include "dynpoint/types.h"

DPT_BEGIN

/* Opaque: a buffer of triangles, and the scratch memory of the searches. */
typedef struct dpt_strip dpt_strip;

typedef struct dpt_strip_def {
    uint32_t size;     /* sizeof(dpt_strip_def) */
    uint32_t capacity; /* triangles, 1..2^20 */
    uint32_t search;   /* vertices that one route's search may visit, at most 2^28; 0: no routes */
    uint32_t reserved; /* 0 */
} dpt_strip_def;

/* The bytes that a strip needs in this version of the library; 0 if the def is not valid. */
DPT_API size_t dpt_strip_bytes(const dpt_strip_def *def);

/* Make an empty strip in `block`, which is aligned to 8 and has at least dpt_strip_bytes(def) bytes. */
DPT_API dpt_result dpt_strip_create(void *block, size_t bytes, const dpt_strip_def *def, dpt_strip **strip);

/* Bits of a strip's flags. */
enum {
    DPT_STRIP_FLAG_FULL = 1,   /* the strip has more triangles than its capacity holds */
    DPT_STRIP_FLAG_BORDER = 2, /* of a shadow: it reaches an open edge */
    /* of a shadow: it reaches an edge of three triangles or more, and continues to all of them */
    DPT_STRIP_FLAG_NONMANIFOLD = 4
};

/*
 * Get the triangles of a strip, *count of them. The array is valid until the strip is filled again. A NULL strip gives
 * NULL, and *count is 0.
 *   flags   DPT_STRIP_FLAG_...; may be NULL
 */
DPT_API const uint32_t *dpt_strip_get_triangles(const dpt_strip *strip, uint32_t *count, uint32_t *flags);

/*
 * Fill the strip with the route from one triangle to another, both included. A route is a shortest path over triangles
 * that share a vertex. Its number of triangles less one is the paper's traversal distance. From a triangle c the route
 * goes to a neighbour that is one step nearer to `to`. Neighbours that share two or three vertices with c are
 * preferred; among equals the one with the lowest number is taken (the paper's Figure 6). The route back may be another
 * one.
 *
 * The search starts from both ends, and needs no table.
 *
 *   DPT_E_DROPPED      the compiler dropped one of the two triangles
 *   DPT_E_UNREACHABLE  no path leads from one to the other
 *   DPT_E_FULL         the search needs more vertices than def.search
 *
 * On an error the strip is empty. A route of more triangles than the capacity is cut, with DPT_STRIP_FLAG_FULL.
 */
DPT_API dpt_result dpt_strip_route(dpt_strip *strip, const dpt_mesh *mesh, uint32_t from, uint32_t to);

/*
 * Fill the strip with the paper's strip: the route from a to p and the route from b to p, each triangle once. a and b
 * are the triangles nearest to the tool's ends, p is the triangle nearest to the tool.
 */
DPT_API dpt_result dpt_strip_routes(dpt_strip *strip, const dpt_mesh *mesh, uint32_t a, uint32_t b, uint32_t p);

/*
 * The shadow of a segment AB: all points
 *
 *     A + t (B - A) + x e + y w + z d,   t in 0..1,  |x|, |y| <= radius + width,  |z| <= depth
 *
 * d is `direction`, scaled to unit length. e is the unit vector along the component of B - A that is orthogonal to d,
 * and w = d x e. If that component is shorter than 1e-9 of B - A, e is any unit vector orthogonal to d.
 */
typedef struct dpt_shadow {
    uint32_t size;       /* sizeof(dpt_shadow) */
    uint32_t triangle;   /* the first triangle of the strip: that of the nearest point */
    dpt_segment segment; /* in the world */
    double direction[3]; /* in world axes, to the mesh or back; of length 1e-100..1e100 */
    double width;        /* added to the radius, m, >= 0 */
    double depth;        /* along the direction, to both sides of the axis, m, >= 0 */
} dpt_shadow;

/*
 * Fill the strip with the triangles under a shadow: all that can be reached from the first triangle over edges that
 * meet the shadow. Each triangle occurs once, in no stated order. The strip is empty if the first triangle does not
 * meet the shadow. A full strip holds the triangles that were reached first.
 *
 * Filling a strip again for the same shadow costs only the comparison.
 *
 *   pose   of the mesh in the world; NULL: the identity
 */
DPT_API dpt_result dpt_strip_shadow(dpt_strip *strip, const dpt_mesh *mesh, const dpt_pose *pose,
                                    const dpt_shadow *shadow);

/* Bits of dpt_overlap.flags. */
enum { DPT_OVERLAP_FLAG_CROSSING = 1 /* the axis goes through the triangle */ };

/*
 * The relation of a segment to one triangle.
 *
 *   triangle   source number
 *   flags      DPT_OVERLAP_FLAG_...
 *   distance   from the axis to the triangle, unsigned, m; 0 if the axis crosses it
 *   s          of the nearest point p of the axis, in 0..1
 *   q          the nearest point of the triangle, in the world
 *   weight     weights of the triangle's corners at q; their sum is 1
 *   overlap    how far the triangle must be moved, against its normal on the tool's side, until the tool lies free on
 *              it, m. 0 if the tool does not touch it. For a tool that has gone through, the part of the tool that lies
 *              over the triangle, along that normal, counts
 *   gap        -overlap; if that is 0, the distance less the radius
 */
typedef struct dpt_overlap {
    uint32_t size; /* the caller's sizeof(dpt_overlap); in an array, set that of the first item */
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
 * Get the relations of a segment to the triangles of a strip, in the strip's order, `capacity` of them at most.
 *
 *   mesh      that of the strip, else DPT_E_ARGUMENT; it must still be open
 *   pose      of the mesh in the world; NULL: the identity
 *   segment   in the world
 *   side      1: the tool is on the side to which the triangles' normals point; -1: on the other side of an open sheet
 *   overlaps  set overlaps[0].size: it is the stride of the array
 *   count     becomes the number of triangles in the strip, which may be above `capacity`
 */
DPT_API dpt_result dpt_strip_overlaps(const dpt_strip *strip, const dpt_mesh *mesh, const dpt_pose *pose,
                                      const dpt_segment *segment, int32_t side, dpt_overlap *overlaps,
                                      uint32_t capacity, uint32_t *count);

DPT_END

#endif
