/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The pairs between a segment and a triangle that can limit a motion: each end of the segment with the triangle, and the
 * segment with each edge, where the nearest point is inside the segment. A capsule is free of the triangle only if all
 * of them are farther apart than its radius; unless the axis goes through the triangle, the least is the distance.
 */
#ifndef DPT_PAIR_FEATURES_H
#define DPT_PAIR_FEATURES_H

#include "nearest/segment_triangle.h"

enum { PAIR_END_A = 0, PAIR_END_B = 1, PAIR_EDGE = 2, PAIR_FEATURES = 5 };

/*
 * One of them, PAIR_END_A, PAIR_END_B, or PAIR_EDGE + 0..2 for the edge from that corner to the next. The segment is
 * a + s u; found->weight is set for ends alone. Returns 0 where an edge's nearest point is at an end of the segment: the
 * end's pair tells more then.
 */
static inline int pair_of_feature(int feature, vec3 a, vec3 u, const vec3 v[3], pair *found)
{
    if (feature < PAIR_EDGE) {
        point_triangle(feature == PAIR_END_A ? a : add(a, u), v, found);
        found->s = feature == PAIR_END_A ? 0.0 : 1.0;
        return 1;
    }
    const int corner = feature - PAIR_EDGE;
    const vec3 edge = sub(v[(corner + 1) % 3], v[corner]), from = sub(a, v[corner]);
    double t;
    segment_edge(u, 1.0 / dot(u, u), from, edge, &found->s, &t);
    found->gap = sub(along(from, found->s, u), scaled(edge, t));
    found->distance2 = dot(found->gap, found->gap);
    return found->s > 0.0 && found->s < 1.0;
}

#endif
