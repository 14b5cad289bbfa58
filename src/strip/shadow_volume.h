/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The shadow of a segment as a solid: a zonotope, the sum of four segments. One lies along u (the axis), one along the
 * direction d, two across it along e and w. w is orthogonal to the other three, which lie in one plane. So the solid is
 * bounded by four pairs of parallel planes, called slabs. Their normals are w, e, d and the normal of u in that plane.
 * All vectors are in the mesh's frame.
 */
#ifndef DPT_SHADOW_VOLUME_H
#define DPT_SHADOW_VOLUME_H

#include "base/vec3.h"

enum { SHADOW_SLABS = 4 };

struct shadow_volume {
    vec3 a, u;         /* the axis: a + s u, s in 0..1 */
    vec3 d, e, w;      /* unit */
    double half_width; /* m, along e and w */
    double depth;      /* m, along d, to both sides */
    /* x, y and z of the slabs' unit normals n, then the limits of (x - a).n of each slab, m. */
    double normal[3][SHADOW_SLABS];
    double low[SHADOW_SLABS];
    double high[SHADOW_SLABS];
};

/* Make the shadow of the axis a + s u. `direction` need not be unit, but not 0; half_width and depth in m, >= 0. */
void dpti_shadow_volume_of(vec3 a, vec3 u, vec3 direction, double half_width, double depth,
                           struct shadow_volume *volume);

#endif
