/* SPDX-License-Identifier: BSD-3-Clause */
/* The winding number of the solid parts of a mesh around a point (docs/algorithms/winding.md). */
#ifndef DPT_WINDING_NUMBER_H
#define DPT_WINDING_NUMBER_H

#include "nearest/bvh.h"

/* The largest error of the answer. */
#define WINDING_ERROR 0.01

/*
 * The generalised winding number of the parts that are MESH_PART_SOLID, as they are wound in the file. Above 1/2 the
 * point is inside of the material. Of a single closed part it is 1 inside and 0 outside; near a hole it lies between.
 *
 *   x      in the mesh's frame, m
 *   work   is spent in blocks of 16 lanes; if what is left does not suffice, the answer is HUGE_VAL
 *
 * It is 0 for a mesh without moments, which is one without a part that is MESH_PART_WINDING, and for an x that is not
 * finite. Time grows with the logarithm of the number of triangles.
 */
double dpti_winding_number(const struct surface *surface, const struct kernel *kernel, vec3 x, struct work *work);

/*
 * The holes of a mesh, as balls. Away from holes the rounded winding number changes only at crossings, whatever other
 * defects the mesh has (docs/algorithms/winding.md, "Away from holes"). Lengths are in m, in the mesh's frame.
 */

enum { HOLES_MAX = 152 };

struct hole {
    uint16_t centre[3], radius; /* in units */
};

/*
 * A rim is where a surface ends: the sum of the directed edges of the solid parts' triangles. The rims within a ball
 * are no longer, together, than a circle of the ball's radius. Holes that are close together share a ball.
 */
struct holes {
    uint32_t count;
    uint32_t normals_tell; /* away from holes the normal of the nearest triangle tells the side */
    uint32_t has_sheets;   /* 1: some parts are neither solid nor buried; near them, their sides count */
    uint32_t reserved;
    vec3 origin; /* of the balls */
    double unit; /* m */
    struct hole ball[HOLES_MAX];
};

static inline vec3 hole_centre(const struct holes *holes, uint32_t i)
{
    const uint16_t *centre = holes->ball[i].centre;
    const vec3 steps = { centre[0], centre[1], centre[2] };
    return along(holes->origin, holes->unit, steps);
}

static inline double hole_radius(const struct holes *holes, uint32_t i)
{
    return holes->unit * holes->ball[i].radius;
}

/*
 * Find the holes of a mesh that has moments, whose sides only winding numbers give. Returns 0 for a deforming body with
 * holes: then they cannot be known. Takes time in proportion to the triangles, more for rims, and about a millisecond.
 */
int dpti_holes_find(const struct surface *surface, const struct kernel *kernel, struct holes *holes);

/* 1: the axis a + s u is so far from all holes that its winding number, rounded, changes at crossings alone. */
int dpti_holes_are_far_from(const struct holes *holes, vec3 a, vec3 u);

/* 1: what closes a hole is farther from x than `distance`. */
int dpti_holes_are_beyond(const struct holes *holes, vec3 x, double distance);

#endif
