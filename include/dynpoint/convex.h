/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * libdynpoint_convex: curved tips of tools, such as a cone, an ellipsoid or a needle's bevel, and how deep they are in a
 * mesh (docs/algorithms/convex.md). It uses libccd, and checks each of its answers. Use it for laws without a proxy, or
 * as a second opinion on hulls (hull.h). Hulls are exact, and they work with a proxy.
 *
 * Two promises of the core do not hold for it: its answers may have other bits on another machine, and it allocates from
 * the heap. It prints nothing.
 *
 * Threads: every function may be called from any thread. A dpt_convex_shaper belongs to the thread of its world.
 */
#ifndef DYNPOINT_CONVEX_H
#define DYNPOINT_CONVEX_H

#include "dynpoint/hull.h"
#include "dynpoint/mesh.h"
#include "dynpoint/tool.h"

DPT_BEGIN

/* Shapes. All but the hull lie along z, with their centre at the origin of their own frame. */
enum {
    DPT_CONVEX_KIND_CONE = 0,      /* extent: its base's diameter, 0, its length; at z = -extent[2] / 2 it is a point */
    DPT_CONVEX_KIND_CYLINDER = 1,  /* extent: its diameter, 0, its length */
    DPT_CONVEX_KIND_ELLIPSOID = 2, /* extent: its diameters along x, y and z */
    DPT_CONVEX_KIND_CAPSULE = 3,   /* extent: its diameter, 0, the length between the centres of its ends */
    DPT_CONVEX_KIND_HULL = 4       /* extent: 0, 0, 0; a hull, with its radius */
};

/* Bits of dpt_convex_shape.flags. */
enum {
    DPT_CONVEX_FLAG_BEVEL = 1,  /* a capsule is cut: of it only what lies at bevel.x <= bevel[3] is there */
    DPT_CONVEX_FLAG_OUTSIDE = 2 /* `outside` says where the tool comes from; else it is the shape's centre */
};

/*
 * A curved shape.
 *
 *   kind     DPT_CONVEX_KIND_...
 *   flags    DPT_CONVEX_FLAG_...
 *   pose     of the shape's frame in the tool's frame
 *   extent   m, as said at the kind; those that are not 0 there are above 0 and at most DPT_COORDINATE_MAX. The length
 *            of a capsule may be 0. No extent is more than 1e4 times another
 *   bevel    a plane in the shape's frame: a unit normal, within 1e-6, and its distance from the origin along it, m. It
 *            leaves at least a thousandth of the capsule's extent along the normal. Without its flag: zeros
 *   outside  a point in the tool's frame, m: see dpt_convex_touch. Without its flag: zeros
 *   hull     of DPT_CONVEX_KIND_HULL, else NULL. It must not be flat unless it has a radius
 */
typedef struct dpt_convex_shape {
    uint32_t size; /* sizeof(dpt_convex_shape), set by the caller */
    uint32_t kind;
    uint32_t flags;
    uint32_t reserved; /* 0 */
    dpt_pose pose;
    double extent[3];
    double bevel[4];
    double outside[3];
    const dpt_hull *hull;
    const void *reserved_pointer; /* NULL */
} dpt_convex_shape;

/*
 * Corners of a polyhedron that holds a shape, in the tool's frame: for a dpt_hull, and a tip of it.
 *
 *   sides    of the polygon around z: of a cone 3..63, a cylinder 3..32, an ellipsoid 3..12, a capsule 3..15. 0: 16 for
 *            cones and cylinders, 12 for ellipsoids, 10 for capsules. For a hull 0
 *   corners  3 coordinates each, m; at most `capacity` corners are written; DPT_HULL_CORNERS_MAX are enough
 *   count    how many there are; DPT_E_FULL if that is more than `capacity`. A bevel that makes more than
 *            DPT_HULL_CORNERS_MAX is DPT_E_LIMIT: take fewer sides
 *   error    m: no point of the polyhedron is farther from the shape than that. May be NULL
 *
 * The corners of a hull are its own, and error is 0: its radius is not in them, give it to the dpt_hull_def.
 */
DPT_API dpt_result dpt_convex_corners(const dpt_convex_shape *shape, uint32_t sides, double *corners, uint32_t capacity,
                                      uint32_t *count, double *error);

/*
 * How deep a shape is in a mesh.
 *
 *   status       DPT_STATUS_BOUNDED, or DPT_STATUS_STALE after an error
 *   contact      DPT_CONTACT_PENETRATING if a triangle meets the shape, else DPT_CONTACT_SEPARATED. A shape that is
 *                wholly behind a surface without meeting it counts as separated
 *   triangle     the deepest one's source number; DPT_NONE
 *   candidates   triangles that were near enough to be looked at
 *   met          those that were found to meet the shape. One that cannot be the deepest, but by 1e-4 of the shape's
 *                size, is not looked at
 *   asked        how many answers libccd gave
 *   refused      how many of these did not stand their check
 *   own          how many triangles have an answer of our own, as libccd had none that stood
 *   depth        m: moved by it along `direction`, the shape is out of the triangle, on the side that it came from
 *   error_bound  m: the least such motion is not shorter than depth by more
 *   direction    unit, in the world; 0 if separated
 *   point        of the shape, in the world: the deepest one, against `direction`. Where a face or an edge of the shape
 *                is about equally deep, its middle
 */
typedef struct dpt_convex_contact {
    uint32_t size; /* sizeof(dpt_convex_contact), set by the caller */
    uint32_t status;
    uint32_t contact;
    uint32_t triangle;
    uint32_t candidates;
    uint32_t met;
    uint32_t asked;
    uint32_t refused;
    uint32_t own;
    uint32_t reserved;
    double depth;
    double error_bound;
    double direction[3];
    double point[3];
} dpt_convex_contact;

/*
 * Find how deep a shape is in a mesh.
 *
 *   tool_pose   of the tool's frame in the world; NULL: the identity
 *   body_pose   of the mesh in the world; NULL: the identity
 *   out         set out->size
 *
 * The depth is that of the deepest triangle: of each, the shortest motion that takes the shape out of it.
 *
 * - The side. A triangle has two sides; the shape comes from that on which its `outside` lies, or its centre. It is taken
 *   out towards that side only: the direction never points to the other side of the triangle's plane. If the tool may be
 *   deeper than the shape's centre, set `outside` to a point that stays out, such as one up the tool's shaft. A point that
 *   lies in the plane counts as on the front.
 * - Flat faces. A shape that is over an edge between triangles of one plane, within 1e-3 rad, does not slip out sideways
 *   there: they count as one.
 * - Where it ends. The least motion out of a surface is along its normal only while the shape is less deep than wide. One
 *   that has gone through a thin place may leave sideways. A law with a proxy has no such limit.
 *
 * `error_bound` is about 1e-4 of the shape's size where EPA's answer stood, as for 99 of 100, and as large as the depth for
 * one of our own. While less deep than wide, the depth changes by no more than the shape moves, and the two bounds.
 *
 * DPT_E_MEMORY: there is no memory for the list of near triangles; a failed allocation within libccd is no error, but a
 * refused answer. DPT_E_LIMIT: more than 4,096 triangles are near.
 */
DPT_API dpt_result dpt_convex_touch(const dpt_convex_shape *shape, const dpt_pose *tool_pose, const dpt_mesh *mesh,
                                    const dpt_pose *body_pose, dpt_convex_contact *out);

/* A body that a curved tip feels. The pose is the caller's: a shaper may not ask the world for it. Its size is final. */
typedef struct dpt_convex_body {
    const dpt_mesh *mesh;
    const dpt_pose *pose; /* of the mesh in the world, at the next step; NULL: the identity */
} dpt_convex_body;

/*
 * Lets a tool without a proxy feel a curved tip. Set it up, then
 *
 *     dpt_tool_set_shaper(world, tool, dpt_convex_shape_wrench, &shaper);
 *
 * In each step in which the tool has an answer, the wrench of the tip is added to that of the tool's law, for each of the
 * bodies. Keep the poses up to date; all that it points to must stay where it is.
 *
 *   law        DPT_LAW_POINT: a force of stiffness times depth along the direction, at the point. DPT_LAW_BED: the
 *              gradient of 1/2 K_t depth^2 with K_t = stiffness / 2, as at a free end in docs/algorithms/force.md
 *   stiffness  N/m, 0..1e9
 *   contact    NULL, or where the deepest contact of the last step is put; set its size
 *   body       out: of `bodies`, which one that is; DPT_NONE
 *   errors     out: grows by 1 for each touch that failed, which adds nothing
 *   energy     out: J, what the tip stored in the last step: the sum of 1/2 stiffness depth^2, or with K_t
 *
 * The force is continuous in the depth. Its direction is that of the deepest triangle: where another one takes over it
 * may turn at once, so that a step of the tool by d changes the force by at most stiffness times (d + depth times the
 * turn + error_bound).
 */
typedef struct dpt_convex_shaper {
    uint32_t size; /* sizeof(dpt_convex_shaper), set by the caller */
    uint32_t law;
    dpt_world *world;
    const dpt_convex_shape *shape;
    const dpt_convex_body *bodies;
    dpt_convex_contact *contact;
    dpt_tool tool;
    uint32_t body_count;
    double stiffness;
    uint32_t body;
    uint32_t errors;
    double energy;
} dpt_convex_shaper;

/* A dpt_force_fn; `user` is a dpt_convex_shaper. One that is not valid adds nothing. */
DPT_API void dpt_convex_shape_wrench(void *user, const dpt_force_info *info, double dt, dpt_wrench *wrench);

DPT_END

#endif
