/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Hulls: convex polyhedra with rounded edges, the tips of tools (docs/algorithms/tips.md). A hull is all that lies within
 * `radius` of the convex hull of some corners. It lives in memory that the caller supplies, and does not change after it
 * was created.
 *
 *     double corners[3 * DPT_HULL_CORNERS_MAX];
 *     uint32_t count;
 *     dpt_hull_shape shape = { .size = sizeof shape, .kind = DPT_HULL_KIND_BOX, .extent = { 0.03, 0.008, 0.001 } };
 *     dpt_hull_shape_corners(&shape, corners, DPT_HULL_CORNERS_MAX, &count);
 *     dpt_hull_def def = { .size = sizeof def, .corner_count = count, .corners = corners };
 *     void *block = malloc(dpt_hull_bytes(&def));
 *     dpt_hull_create(block, dpt_hull_bytes(&def), &def, &blade);
 *
 * Threads: a hull is read-only; any number of threads and worlds may use one at the same time. All functions may be
 * called from any thread.
 */
#ifndef DYNPOINT_HULL_H
#define DYNPOINT_HULL_H

#include "dynpoint/types.h"

DPT_BEGIN

typedef struct dpt_hull dpt_hull;

/* The most corners that a hull is made of. This number never changes. */
enum { DPT_HULL_CORNERS_MAX = 64 };

/*
 * What a hull is made of.
 *
 *   corner_count  3..DPT_HULL_CORNERS_MAX
 *   corners       3 coordinates each, m, in the tool's frame, at most DPT_COORDINATE_MAX
 *   radius        m, 0..DPT_COORDINATE_MAX: by so much the polyhedron's surface is moved out, and its edges are rounded
 *
 * Corners that lie inside the hull of the others are left out. All corners may lie in one plane: such a hull is a flat
 * polygon, and with a radius a plate with round edges.
 */
typedef struct dpt_hull_def {
    uint32_t size; /* sizeof(dpt_hull_def), set by the caller */
    uint32_t corner_count;
    const double *corners;
    const void *reserved_pointer; /* NULL */
    double radius;
} dpt_hull_def;

/* The bytes that a hull of this def needs; 0 for a def that is not valid. */
DPT_API size_t dpt_hull_bytes(const dpt_hull_def *def);

/*
 * Make a hull in `block`, which is aligned to 8 and of at least dpt_hull_bytes(def) bytes. The corners are copied.
 * A tool uses the block while it has the tip.
 *
 * Corners within 1e-12 of the hull's size of each other count as one, and lie on one face where they are so near to a
 * plane. DPT_E_ARGUMENT: the corners lie on one line; or, without lying in one plane, so near to a line or a plane that
 * their faces cannot be told apart. A hull that is thicker than 1e-3 of its size is always made. DPT_E_MEMORY: the block
 * is too small.
 */
DPT_API dpt_result dpt_hull_create(void *block, size_t bytes, const dpt_hull_def *def, const dpt_hull **hull);

/*
 * What a hull has.
 *
 *   corners, edges, faces  of the polyhedron; a face may have any number of corners; a flat hull has two faces
 *   radius                 m, as given
 *   axis                   the hull lies within `reach` of this segment (m, tool's frame)
 *   reach                  m, of the polyhedron, without the radius
 */
typedef struct dpt_hull_info {
    uint32_t size; /* sizeof(dpt_hull_info), set by the caller */
    uint32_t corners;
    uint32_t edges;
    uint32_t faces;
    double radius;
    double axis[2][3];
    double reach;
} dpt_hull_info;

DPT_API dpt_result dpt_hull_get_info(const dpt_hull *hull, dpt_hull_info *info);

/* A corner of the hull, m, tool's frame; `corner` counts from 0. Corners that were left out are not counted. */
DPT_API dpt_result dpt_hull_get_corner(const dpt_hull *hull, uint32_t corner, double at[3]);

/* The two corners of an edge; `edge` counts from 0. */
DPT_API dpt_result dpt_hull_get_edge(const dpt_hull *hull, uint32_t edge, uint32_t corners[2]);

/*
 * The corners of a face, in order, counter-clockwise as seen from outside; `face` counts from 0.
 *   corners  at most `capacity` are written; may be NULL if capacity is 0
 *   count    how many there are
 */
DPT_API dpt_result dpt_hull_get_face(const dpt_hull *hull, uint32_t face, uint32_t *corners, uint32_t capacity,
                                     uint32_t *count);

/* Shapes that corners can be made for. Each holds the shape that it stands for. */
enum {
    DPT_HULL_KIND_BOX = 0,      /* extent: its lengths along x, y and z, centre at the origin */
    DPT_HULL_KIND_WEDGE = 1,    /* a blade: extent as for a box; at z = -extent[2] / 2 the face is the edge y = 0 */
    DPT_HULL_KIND_CYLINDER = 2, /* along z, centre at the origin: extent[0] its diameter, extent[2] its length */
    DPT_HULL_KIND_CONE = 3      /* as the cylinder, but at z = -extent[2] / 2 it is a point */
};

/*
 * A shape, as corners around the origin of the tool's frame.
 *
 *   kind    DPT_HULL_KIND_...
 *   sides   of a cylinder, 3..32, and a cone, 3..63, whose round side is a polygon around it: it holds the shape and is
 *           larger by at most r (1 / cos(pi / sides) - 1), r the radius: 2 % of r with 16 sides. 0: 16. For others 0
 *   extent  m, 0..DPT_COORDINATE_MAX
 */
typedef struct dpt_hull_shape {
    uint32_t size; /* sizeof(dpt_hull_shape), set by the caller */
    uint32_t kind;
    uint32_t sides;
    uint32_t reserved; /* 0 */
    double extent[3];
} dpt_hull_shape;

/*
 * The corners of a shape.
 *   corners   3 coordinates each; at most `capacity` corners are written
 *   count     how many there are; DPT_E_FULL if that is more than `capacity`
 */
DPT_API dpt_result dpt_hull_shape_corners(const dpt_hull_shape *shape, double *corners, uint32_t capacity,
                                          uint32_t *count);

DPT_END

#endif
