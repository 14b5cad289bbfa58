/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Whether a hull whose corners go on straight lines, from one place to another, passes a triangle at a distance. Between
 * the two it is the hull of its corners then. Points are in the frame of the triangle's mesh, in m: docs/algorithms/tips.md.
 */
#ifndef DPT_HULL_PASS_H
#define DPT_HULL_PASS_H

#include "hull/hull_triangle.h"

struct hull_pass {
    const struct dpt_hull *hull;
    const struct frame *from, *to, *body; /* where its frame is before and after, and that of the mesh */
    const vec3 *corner;                   /* all corners before, and then after */
    double moved;                         /* m: no corner moves farther */
    double apart;                         /* m: the distance, of the polyhedron */
};

/* The least height of all these corners over a triangle along a unit vector. */
static inline double hull_height(const vec3 *corner, uint32_t count, vec3 n, const vec3 v[3])
{
    return -support_of(corner, count, scaled(n, -1.0)) - support_of(v, 3, n);
}

/*
 * A plane that turns on the way: its normal, to the hull, goes straight from one unit vector to another. The height of a
 * place that moves evenly is a polynomial of the second degree in time, of which these are the Bernstein coefficients.
 */
enum { HULL_TURN_DEGREES = 3 };
struct hull_turn {
    vec3 from, to;
    double low[HULL_TURN_DEGREES]; /* m: the least of all corners */
};

struct hull_turn dpti_hull_turn_of(const struct hull_pass *pass, vec3 from, vec3 to);

/* Whether it keeps a triangle at the distance from the hull, at all times. */
int dpti_hull_turn_parts(const struct hull_turn *turn, const vec3 v[3], double apart);

/* Whether the two are so far apart at the end; n as below. */
int dpti_hull_ends_apart(const struct hull_pass *pass, const vec3 v[3], vec3 *n);

/*
 * 1: a plane proves that it does, which may turn on the way. 0: it does not, or none was found.
 *   n   in: a direction from the hull to the triangle to begin with; out: that of the plane, unit; 0 of one that turns
 */
int dpti_hull_passes(const struct hull_pass *pass, const vec3 v[3], vec3 *n);

#endif
