/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The holes of a mesh of one part, as balls: away from them the side is what it would be if they were closed, and no
 * winding number is needed (docs/algorithms/winding.md, "Away from holes"). Lengths are in m, in the mesh's frame.
 */
#ifndef DPT_HOLES_H
#define DPT_HOLES_H

#include "nearest/bvh.h"

enum { HOLES_MAX = 8 };

/* All edges of a hole lie within its ball; so does a surface that closes it. Holes that are close together share one. */
struct holes {
    uint32_t count; /* 0: not known, or not all that is wrong with the mesh */
    uint32_t reserved;
    struct hole {
        vec3 centre;
        double radius;
    } ball[HOLES_MAX];
};

/*
 * Find the holes of a mesh at rest. They are known if the mesh is one solid part that has no other defect: it does not
 * cut itself, and away from its holes the winding number is about 1 behind its triangles and about 0 in front of them, as
 * far as samples tell. Takes time in proportion to the triangles, and about a millisecond.
 */
void dpti_holes_find(const struct surface *surface, const struct kernel *kernel,
                     struct holes *holes);

/* 1: holes are known, and the axis a + s u is so far from them that its side changes at crossings alone. */
int dpti_holes_are_far_from(const struct holes *holes, vec3 a, vec3 u);

/*
 * 1: what closes a hole is farther from x than `distance`. Where that is the distance to the nearest triangle, and the
 * holes are far from x, the normal there tells the side.
 */
int dpti_holes_are_beyond(const struct holes *holes, vec3 x, double distance);

#endif
