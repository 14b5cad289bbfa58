/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The shadow of a segment as a body: a zonotope, the sum of four segments, u (the axis), e and w across the direction
 * and d along it. w is orthogonal to the other three, which lie in one plane: so it is bounded by four pairs of parallel
 * planes, with the normals w, e, d and the normal of u in that plane.
 */
#ifndef DPT_SHADOW_VOLUME_H
#define DPT_SHADOW_VOLUME_H

#include "base/vec3.h"

enum { SHADOW_SLABS = 4 };

struct shadow_volume {
    vec3 a, u;         /* the axis, in the mesh's frame */
    vec3 d, e, w;      /* unit */
    double half_width; /* of its width */
    double depth;
    double normal[3][SHADOW_SLABS]; /* x, y, z of each */
    double low[SHADOW_SLABS];       /* of (x - a) . normal */
    double high[SHADOW_SLABS];
};

/* `direction` need not be unit. */
void dpti_shadow_volume_of(vec3 a, vec3 u, vec3 direction, double half_width, double depth,
                           struct shadow_volume *volume);

#endif
