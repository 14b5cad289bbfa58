/* SPDX-License-Identifier: BSD-3-Clause */
/* The exact nearest pair of a hull's polyhedron and a surface, by the box tree: docs/algorithms/tips.md. */
#ifndef DPT_HULL_SEARCH_H
#define DPT_HULL_SEARCH_H

#include "hull/hull_triangle.h"
#include "nearest/bvh.h"

/* So many planes rule out what is not near a hull. */
enum { HULL_PLANES = 4 };

/* The normals of these, unit: along `toward`, from the hull to the surface, and of the faces that look that way most. */
void dpti_hull_planes(const struct hull_place *place, vec3 toward, vec3 planes[HULL_PLANES],
                      double supports[HULL_PLANES]);

/* The nearest pair of a hull and a surface, in the surface's frame. */
struct hull_nearest {
    struct hull_pair found;
    uint32_t triangle;  /* place; DPT_NONE: no pair is nearer than the limit */
    double distance;    /* m, of the polyhedron */
    double error_bound; /* m, of the distance */
};

/*
 * m: the error bound of a distance between hull and surface, as that of an axis (nearest/nearest_pair.h); `tool` and
 * `body` are the frames that the place was made of.
 */
double dpti_hull_error(const struct hull_place *place, const struct surface *surface, const struct frame *tool,
                       const struct frame *body);

/*
 * Find the nearest pair.
 *
 *   hint   a triangle that is likely to be near, by its place, or DPT_NONE; it changes the time, and of triangles that
 *          are as near which one is found
 *   limit  m; HUGE_VAL: none. A pair that is not nearer need not be found
 *
 * Returns 1 if the pair is proven. 0: the work is spent; `nearest` has the best pair so far, or none.
 */
int dpti_hull_search(const struct surface *surface, const struct kernel *kernel, const struct hull_place *place,
                     uint32_t hint, double limit, struct work *work, struct hull_nearest *nearest);

#endif
